"""What docs/how-to/extending.md shows is what works: every block of Python runs as it stands."""

import re
import subprocess
import sys

import pytest

from tests.test_house import ROOT

BLOCK = re.compile(r"^```python\n(.*?)^```", re.MULTILINE | re.DOTALL)
PAGE = (ROOT / "docs" / "how-to" / "extending.md").read_text(encoding="utf-8")
BLOCKS = BLOCK.findall(PAGE)


def test_all_that_can_be_added_has_an_example():
    """A heading for each row of the table at the top, and a block below each."""
    rows = re.findall(r"^\| an? (\w+) \|", PAGE, re.MULTILINE)
    assert rows == ["shape", "material", "effect", "instrument", "figure", "command", "result"]
    parts = PAGE.split("\n## ")[1:]
    assert [part.split("\n")[0].split()[-1] for part in parts] == rows
    assert all(BLOCK.search(part) for part in parts)


@pytest.mark.parametrize("block", BLOCKS, ids=[f"block {number}" for number in range(1, len(BLOCKS) + 1)])
def test_a_block_runs(block, tmp_path):
    """In a process and a folder of its own: what one registers no other sees."""
    command = [sys.executable, "-c", f"import sys; sys.path.insert(0, {str(ROOT)!r})\n{block}"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "Warning" not in done.stderr
