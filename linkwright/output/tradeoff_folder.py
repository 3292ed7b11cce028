"""The output folder of a trade-off: report, picture, CSV, JSON, and an arm file for each design."""

from __future__ import annotations

from pathlib import Path

from linkwright.core.materials.catalogue import Catalogue
from linkwright.core.optimize.tradeoff.front import Tradeoff
from linkwright.core.optimize.tradeoff.journal import JOURNAL, LOCK
from linkwright.json.tradeoff import point_file, tradeoff_csv
from linkwright.report.pictures.tradeoff import tradeoff_picture

from .arm_file import arm_file
from .files import REPORT, RESULT, claim_own, made_folder, refuse_strangers, write_each
from .read_back import ReadBack

CSV, PICTURE, POINTS = "tradeoff.csv", "tradeoff.svg", "points"
FILES = (RESULT, REPORT, CSV, PICTURE, POINTS, JOURNAL, LOCK)
"""Everything that a trade-off may write."""


def claim_tradeoff(folder: Path) -> None:
    """Make the output folder, or take an earlier trade-off's again; anything else is refused. Raises `InputError`."""
    claim_own(folder, "tradeoff", FILES)


def write_tradeoff(result: Tradeoff, out: Path, content: str, page: str, catalogue: Catalogue) -> list[Path]:
    """Write the files, result.json last; gives where they are. `catalogue` is that by which the problem was read.
    Raises `InputError`, and `NotAsWritten` at the end."""
    files: dict[str, str | ReadBack] = {
        point_file(result, point): arm_file(point.arm, catalogue) for point in result.points
    }
    _clear_points(out / POINTS, {Path(name).name for name in files})
    files |= {REPORT: page, PICTURE: tradeoff_picture(result), CSV: tradeoff_csv(result), RESULT: content}
    write_each({out / name: text for name, text in files.items()})
    return [out / name for name in (REPORT, PICTURE, CSV, RESULT, POINTS)]


def _clear_points(folder: Path, names: set[str]) -> None:
    """Take the arm files of an earlier trade-off away, where the new ones are not called so."""
    there = made_folder(folder)
    refuse_strangers(folder, {name for name in there if not _numbered(name)}, ())
    for name in there - names:
        (folder / name).unlink()


def _numbered(name: str) -> bool:
    return name.endswith(".yaml") and name.removesuffix(".yaml").isdigit()
