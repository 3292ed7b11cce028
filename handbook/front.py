"""The picture of a trade-off in docs/how-to/tradeoff.md, made by the command that the page shows, and the journal of
what that command solved, kept beside it: with the journal the same command draws the picture again in seconds.

`python -m handbook.front` makes both (ten minutes); one that was stopped is gone on with.
"""

from __future__ import annotations

import gzip
import re
import shlex
from pathlib import Path

from linkwright.cli import run
from linkwright.core.optimize.tradeoff.journal import JOURNAL

from .sources import ROOT

PAGE = ROOT / "docs" / "how-to" / "tradeoff.md"
PICTURE = ROOT / "docs" / "pictures" / "tradeoff.svg"
SOLVED = PICTURE.with_name("tradeoff-journal.jsonl.gz")
WORK = ROOT / "pictures-out"
DRAWN = PICTURE.name
"""The name of the picture in the folder that the command leaves."""


def shown() -> list[str]:
    """The words of the command under which the page shows the picture, without `linkwright`."""
    told = PAGE.read_text(encoding="utf-8").partition("(../pictures/tradeoff.svg)")[0]
    return shlex.split(re.findall(r"^linkwright (tradeoff .+)$", told, re.MULTILINE)[-1])


def asked(words: list[str], folder: Path) -> list[str]:
    """Those words for another folder, going on with what is in it."""
    at = words.index("--out")
    problem = str(ROOT / words[1])
    return [words[0], problem, *words[2:at], *words[at + 2 :], "--out", str(folder), "--resume"]


def unpack(folder: Path) -> None:
    """What was solved when the picture was made, into a folder that the command goes on with."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / JOURNAL).write_bytes(gzip.decompress(SOLVED.read_bytes()))


def main() -> int:
    """Solve, draw, keep both."""
    if not (WORK / JOURNAL).exists():
        WORK.mkdir(exist_ok=True)
        (WORK / JOURNAL).touch()
    status = run(asked(shown(), WORK))
    if status == 0:
        PICTURE.write_bytes((WORK / DRAWN).read_bytes())
        SOLVED.write_bytes(gzip.compress((WORK / JOURNAL).read_bytes(), 9, mtime=0))
    return status


if __name__ == "__main__":
    raise SystemExit(main())
