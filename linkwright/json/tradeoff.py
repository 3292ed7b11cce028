"""A trade-off as JSON and as CSV. Names carry their units; null, or an empty cell, where a figure cannot be known."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from pathlib import PurePath
from types import MappingProxyType
from typing import Any

from linkwright.as_json import links_json, program_version
from linkwright.screen.tradeoff import slope_factor
from linkwright.words import section_words
from optimize.tradeoff_question import Axis
from optimize.tradeoff_result import Front, Point, Tradeoff

COMMAND = "linkwright tradeoff"
_FIGURES: Mapping[str, tuple[str, float]] = MappingProxyType(
    {
        "max_error": ("max_error_mm", 1e3),
        "upper_bound": ("upper_bound_mm", 1e3),
        "mass": ("mass_kg", 1.0),
        "total_mass": ("total_mass_kg", 1.0),
        "cost": ("cost_EUR", 1.0),
        "reach": ("reach_mm", 1e3),
        "min_safety_factor": ("min_safety_factor", 1.0),
        "min_buckling": ("min_buckling", 1.0),
        "first_frequency": ("first_frequency_Hz", 1.0),
    }
)


def made_by() -> str:
    """The command and the version that write the files."""
    return f"{COMMAND} {program_version()}"


def point_file(result: Tradeoff, point: Point) -> str:
    """Where a point's arm file stands in the output folder."""
    return f"points/{point.number:0{max(2, len(str(len(result.points))))}d}.yaml"


def _figures(point: Point) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, (written, factor) in _FIGURES.items():
        value = point.figures[name]
        found[written] = None if value is None else factor * value
    return found


def _price(result: Tradeoff, point: Point) -> float | None:
    return None if point.slope is None else slope_factor(result)[0] * point.slope


def _axis(axis: Axis, *, log: bool) -> dict[str, Any]:
    better = "more" if axis.more_is_better else "less"
    return {"name": axis.name, "unit": axis.unit, "better": better, "scale": "log" if log else "linear"}


def _front(result: Tradeoff, front: Front) -> dict[str, Any]:
    x, y = result.asked.x, result.asked.y
    points = result.of(front)
    factor = x.factor
    return {
        "name": front.name,
        "points": list(front.points),
        "knee": front.knee,
        "ends": {
            "best_x": {"point": points[0].number, x.name: factor * points[0].x, y.name: y.factor * points[0].y},
            "best_y": {
                "point": points[-1].number,
                x.name: factor * points[-1].x,
                y.name: y.factor * points[-1].y,
                "at_the_limit_on_x": front.capped,
            },
        },
        "straight_line_error": front.error,
        "steps": [list(pair) for pair in front.steps],
        "idle": [[factor * start, factor * end] for start, end in front.idle],
        "not_solved": [factor * value for value in front.failed],
        "complete": front.complete,
        "exhaustive": front.exhaustive,
    }


def tradeoff_json(result: Tradeoff) -> dict[str, Any]:
    """What `tradeoff --json` writes."""
    on_envelope = set(result.envelope.points)
    return {
        "made_by": made_by(),
        "problem": PurePath(result.asked.given.file).name,
        "arm": result.asked.given.arm.name,
        "x": _axis(result.asked.x, log=result.logs[0]),
        "y": _axis(result.asked.y, log=result.logs[1]),
        "by": result.asked.by,
        "subject_to": [limit.text for limit in result.asked.given.limits],
        "accuracy": result.accuracy,
        "price_unit": slope_factor(result)[1],
        "knee_is": "the point farthest from the chord between the ends, axes scaled from 0 to 1 as drawn (Das 1999)",
        "envelope": _front(result, result.envelope),
        "fronts": [_front(result, front) for front in result.fronts],
        "without": [{"name": name, "reason": reason} for name, reason in result.without],
        "points": [
            {
                "number": point.number,
                "front": point.front,
                "on_envelope": point.number in on_envelope,
                "price": _price(result, point),
                **_figures(point),
                "certified": point.certified,
                "converged": point.converged,
                "warnings": list(point.figures["warnings"]),
                "links": links_json(point.arm, point.figures["link_masses"]),
                "arm_file": point_file(result, point),
            }
            for point in result.points
        ],
        "solved": result.solved,
        "resumed": result.resumed,
        "seconds": result.seconds,
    }


def tradeoff_csv(result: Tradeoff) -> str:
    """A row a point."""
    stream = io.StringIO()
    price = f"price_{slope_factor(result)[1].replace('/', '_per_')}"
    size = result.asked.given.arm.size
    heads = ["number", "front", "on_envelope", "knee", *(written for written, _ in _FIGURES.values()), price]
    for link in range(1, size + 1):
        heads += [f"link{link}_{name}" for name in ("length_mm", "section", "material", "mass_kg")]
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow([*heads, "arm_file"])
    knees = {front.knee for front in (*result.fronts, result.envelope)}
    for point in result.points:
        row: list[Any] = [point.number, point.front, int(point.number in result.envelope.points)]
        row += [int(point.number in knees), *_figures(point).values(), _price(result, point)]
        for link, mass in zip(point.arm.links, point.figures["link_masses"], strict=True):
            row += [1e3 * link.length, section_words(link), link.material.name if link.material else "", mass]
        writer.writerow(["" if cell is None else cell for cell in [*row, point_file(result, point)]])
    return stream.getvalue()
