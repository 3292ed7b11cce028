"""The picture of a trade-off in docs/how-to/tradeoff.md, made by the command that the page shows, and the table of its
points, kept beside it. `python -m handbook.front` makes both (ten minutes)."""

from __future__ import annotations

import re
import shlex
import tempfile
from pathlib import Path

import pandas as pd

from linkwright.cli import run
from linkwright.output.tradeoff_folder import CSV
from linkwright.output.tradeoff_folder import PICTURE as DRAWN

from .sources import ROOT

PAGE = ROOT / "docs" / "how-to" / "tradeoff.md"
PICTURE = ROOT / "docs" / "pictures" / DRAWN
TABLE = PICTURE.with_name(CSV)
KEPT = ["number", "front", "on_envelope", "knee", "mass_kg", "max_error_mm"]
"""The columns of the table that are kept."""


def shown() -> list[str]:
    """The words of the command under which the page shows the picture, without `linkwright`."""
    told = PAGE.read_text(encoding="utf-8").partition("(../pictures/tradeoff.svg)")[0]
    return shlex.split(re.findall(r"^linkwright (tradeoff .+)$", told, re.MULTILINE)[-1])


def asked(words: list[str], folder: Path) -> list[str]:
    """Those words for another folder."""
    at = words.index("--out")
    return [words[0], str(ROOT / words[1]), *words[2:at], *words[at + 2 :], "--out", str(folder)]


def main() -> int:
    """Solve, draw, keep both."""
    with tempfile.TemporaryDirectory() as folder:
        status = run(asked(shown(), Path(folder)))
        if status == 0:
            PICTURE.write_bytes((Path(folder) / DRAWN).read_bytes())
            pd.read_csv(Path(folder) / CSV)[KEPT].to_csv(TABLE, index=False, lineterminator="\n")
    return status


if __name__ == "__main__":
    raise SystemExit(main())
