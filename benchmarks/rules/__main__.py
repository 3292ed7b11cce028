"""The page of all rules of the diagnosis: python -m benchmarks.rules docs/rules.md"""

from __future__ import annotations

import sys
from pathlib import Path

from benchmarks.rules.page import page

if __name__ == "__main__":
    Path(sys.argv[1]).write_text(page(), encoding="utf-8", newline="\n")
