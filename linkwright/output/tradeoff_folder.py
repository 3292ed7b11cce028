"""The output folder of a trade-off: report, picture, CSV, JSON, and an arm file for each design."""

from __future__ import annotations

from pathlib import Path

from arm.files.write import arm_to_yaml
from linkwright.json.tradeoff import point_file, tradeoff_csv, tradeoff_json
from linkwright.report.contents import page_of
from linkwright.report.origin import Origin, signed
from linkwright.report.pages.tradeoff import tradeoff_report
from linkwright.report.pictures.tradeoff import tradeoff_picture
from optimize.tradeoff.front import Tradeoff
from optimize.tradeoff.journal import JOURNAL, LOCK

from .files import REPORT, RESULT, claim_own, json_text, made_folder, refuse_strangers, write_file, write_folder

CSV, PICTURE, POINTS = "tradeoff.csv", "tradeoff.svg", "points"
FILES = (RESULT, REPORT, CSV, PICTURE, POINTS, JOURNAL, LOCK)
"""Everything that a trade-off may write."""


def claim_tradeoff(folder: Path) -> None:
    """Make the output folder, or take an earlier trade-off's again; anything else is refused. Raises `InputError`."""
    claim_own(folder, "tradeoff", FILES)


def write_tradeoff(result: Tradeoff, out: Path, origin: Origin) -> list[Path]:
    """Write the files, result.json last; gives where they are. Raises `InputError`."""
    _write_points(result, out)
    files = {
        REPORT: signed(page_of(tradeoff_report(result)), origin),
        PICTURE: tradeoff_picture(result),
        CSV: tradeoff_csv(result),
    }
    for name, text in files.items():
        write_file(out / name, text)
    write_folder(out, {RESULT: json_text(tradeoff_json(result))})
    return [out / name for name in (REPORT, PICTURE, CSV, RESULT, POINTS)]


def _write_points(result: Tradeoff, out: Path) -> None:
    files = {point_file(result, point): arm_to_yaml(point.arm) for point in result.points}
    folder = out / POINTS
    there = made_folder(folder)
    refuse_strangers(folder, {name for name in there if not _numbered(name)}, ())
    for name in there - {Path(name).name for name in files}:
        (folder / name).unlink()
    for name, text in files.items():
        write_file(out / name, text)


def _numbered(name: str) -> bool:
    return name.endswith(".yaml") and name.removesuffix(".yaml").isdigit()
