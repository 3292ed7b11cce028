"""A trade-off as JSON, as CSV, and as a folder: report, picture, and an arm file for each design."""

from __future__ import annotations

import csv
import io
from pathlib import Path, PurePath
from typing import Any

from linkwright.core.materials.catalogue import Catalogue
from linkwright.core.optimize.tradeoff.front import Front, Point, Tradeoff
from linkwright.core.optimize.tradeoff.question import Axis
from linkwright.core.units.workbook import defused
from linkwright.json.design import links_json
from linkwright.json.fields import fields
from linkwright.output.arm_file import arm_file
from linkwright.output.files import REPORT, RESULT, ReadBack, claim_folder, made_folder, refuse_strangers, write_each
from linkwright.report.charts.fronts import slope_factor, tradeoff_picture
from linkwright.results.figures_in_words import section_words


def _written(result: Tradeoff) -> list[tuple[str, str, float]]:
    """The figures that are told of a point: their names, those in the files, and what one SI unit is in their unit."""
    figures = [(figure.name, figure.key, figure.factor) for figure in result.asked.given.figures.values()]
    return [figures[0], ("upper_bound", "upper_bound_mm", 1e3), *figures[1:]]


def point_file(result: Tradeoff, point: Point) -> str:
    """Where a point's arm file stands in the output folder."""
    return f"points/{point.number:0{max(2, len(str(len(result.points))))}d}.yaml"


def _figures(result: Tradeoff, point: Point) -> dict[str, Any]:
    figures: dict[str, Any] = {}
    for name, written, factor in _written(result):
        value = point.figures.get(name)
        figures[written] = None if value is None else factor * value
    return figures


def _price(result: Tradeoff, point: Point) -> float | None:
    return None if point.slope is None else slope_factor(result)[0] * point.slope


def _axis(axis: Axis, *, log: bool) -> dict[str, Any]:
    better = "more" if axis.more_is_better else "less"
    return {"name": axis.name, "unit": axis.unit, "better": better, "scale": "log" if log else "linear"}


def _front_as_json(result: Tradeoff, front: Front) -> dict[str, Any]:
    x, y = result.asked.x, result.asked.y
    points = result.of(front)
    best_x, best_y = (
        {"point": item.number, x.name: x.factor * item.x, y.name: y.factor * item.y} for item in (points[0], points[-1])
    )
    return {
        **fields(front, "name", "points", "knee", "straight_line_error=error", "steps", "complete", "exhaustive"),
        "undecided_points": front.undecided,
        "ends": {"best_x": best_x, "best_y": {**best_y, "at_the_limit_on_x": front.capped}},
        "idle": [[x.factor * start, x.factor * end] for start, end in front.idle],
        "not_solved": [x.factor * value for value in front.failed],
    }


def tradeoff_json(result: Tradeoff) -> dict[str, Any]:
    """What `tradeoff --json` writes."""
    on_envelope = set(result.envelope.points)
    return {
        "problem": PurePath(result.asked.given.file).name,
        "arm": result.asked.given.arm.name,
        "x": _axis(result.asked.x, log=result.logs[0]),
        "y": _axis(result.asked.y, log=result.logs[1]),
        "by": result.asked.by,
        "start": result.start,
        "subject_to": [limit.text for limit in result.asked.given.limits],
        "price_unit": slope_factor(result)[1],
        "knee_is": "the point farthest from the chord between the ends, axes scaled from 0 to 1 as drawn (Das 1999)",
        "envelope": _front_as_json(result, result.envelope),
        "fronts": [_front_as_json(result, front) for front in result.fronts],
        "without": [{"name": name, "reason": reason} for name, reason in result.without],
        "points": [
            {
                **fields(point, "number", "front", "certified", "converged"),
                "on_envelope": point.number in on_envelope,
                "price": _price(result, point),
                **_figures(result, point),
                **fields(point, "unreached_share"),
                "warnings": point.figures["warnings"],
                "links": links_json(point.arm, point.figures["link_masses"]),
                "arm_file": point_file(result, point),
            }
            for point in result.points
        ],
        **fields(result, "accuracy", "solved", "seconds", "interrupted"),
    }


def tradeoff_csv(result: Tradeoff) -> str:
    """A row a point."""
    stream = io.StringIO()
    price = f"price_{slope_factor(result)[1].replace('/', '_per_')}"
    size = result.asked.given.arm.size
    heads = ["number", "front", "on_envelope", "knee", *(key for _, key, _ in _written(result)), price]
    heads.append("unreached_share")
    for link in range(1, size + 1):
        heads += [f"link{link}_{name}" for name in ("length_mm", "section", "material", "mass_kg")]
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow([*heads, "arm_file"])
    knees = {front.knee for front in (*result.fronts, result.envelope)}
    for point in result.points:
        row: list[Any] = [point.number, point.front, int(point.number in result.envelope.points)]
        row += [int(point.number in knees), *_figures(result, point).values(), _price(result, point)]
        row.append(point.unreached_share)
        for link, mass in zip(point.arm.links, point.figures["link_masses"], strict=True):
            row += [1e3 * link.length, section_words(link), link.material.name if link.material else "", mass]
        writer.writerow(["" if cell is None else defused(cell) for cell in [*row, point_file(result, point)]])
    return stream.getvalue()


CSV, PICTURE, POINTS = "tradeoff.csv", "tradeoff.svg", "points"
FILES = (RESULT, REPORT, CSV, PICTURE, POINTS)
"""Everything that a trade-off may write."""


def claim_tradeoff(folder: Path) -> None:
    """Make the output folder, or take an earlier trade-off's again; anything else is refused. Raises `InputError`."""
    claim_folder(folder, "tradeoff", FILES)


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
