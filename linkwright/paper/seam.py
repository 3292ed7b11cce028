"""Straight seams: whether a planar arm can follow one, and its worst error along and across it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from linkwright.core.arm.chain.branches import way_to
from linkwright.core.arm.chain.chain import Arm as Model
from linkwright.core.arm.worst.seam import SeamCheck, check_seam
from linkwright.core.arm.worst.workspace import Unreachable
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError
from linkwright.face.arm import Arm
from linkwright.face.given import Quantity, in_si
from linkwright.face.result import Result, figure_of
from linkwright.results.document import Description, Paragraph, Value
from linkwright.results.document import table as described_table
from linkwright.results.figures_in_words import figure

from .postures import Postures, around

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go

_TITLE, _ACROSS, _MEASURES = "Error along a seam", "along the seam, mm", ("tangential", "normal", "in all")


@dataclass(frozen=True, repr=False)
class Seam(Result):
    """Whether a planar arm can follow a straight seam, and its worst error along and across it.

    `places` (N,) are distances from the seam's start (mm), `errors` (N, 3) the worst error there (mm): along the seam,
    normal to it, and in any direction.
    """

    _command = "seam"

    arm: Arm
    check: SeamCheck
    places: tuple[float, ...]
    errors: tuple[tuple[float, float, float], ...]

    @property
    def proved(self) -> bool:
        """Whether every point of it can be reached, proved; else poses were found everywhere."""
        return self.check.verdict == "reachable"

    @property
    def table(self) -> pd.DataFrame:
        """A row for each point looked at, and the worst of each column: tangential, normal and in all, mm."""
        import pandas as pd

        return pd.DataFrame(self._rows, columns=[_ACROSS, *(f"{name}, mm" for name in _MEASURES)])

    @property
    def description(self) -> Description:
        """The result as screen and Markdown show it."""
        rows = [(place, *(Value(figure(value)) for value in errors)) for place, *errors in self._rows]
        shown = described_table((_ACROSS, *(f"{name}, mm" for name in _MEASURES)), rows, title=_TITLE)
        return Description(_TITLE, self.headline, (shown, Paragraph(self._note)))

    def plot(self) -> go.Figure:
        """The errors along the seam."""
        lines = [
            {"type": "scatter", "name": f"{name}, mm", "x": self.places, "y": [row[k] for row in self.errors]}
            for k, name in enumerate(_MEASURES)
        ]
        axes = {"xaxis": {"title": {"text": _ACROSS}}, "yaxis": {"title": {"text": "worst error in mm"}}}
        return figure_of({"data": lines, "layout": axes})

    @property
    def headline(self) -> str:
        """Whether the arm can follow it, in a line."""
        proved = "every point can be reached, proved" if self.proved else "poses were found everywhere"
        return f"{self.arm.name}: {proved}"

    def _line(self) -> str:
        return self.headline

    @property
    def _rows(self) -> list[tuple[str, float, float, float]]:
        along, across, total = (max(column) for column in zip(*self.errors, strict=True))
        rows = [(figure(place), *errors) for place, errors in zip(self.places, self.errors, strict=True)]
        return [*rows, ("worst along it", along, across, total)]

    @property
    def _note(self) -> str:
        ends = (self.check.start, self.check.end)
        said = " to ".join(f"({figure(1e3 * point[0])}, {figure(1e3 * point[1])})" for point in ends)
        return (
            f"The seam runs straight from {said} mm. At each point the worst over every posture that holds the tip "
            "there, play where it is worst: along the seam (the weld starts and ends wrong), normal to it (the torch "
            "misses the joint), and in any direction. Each is a worst case of its own, so that they need not meet in "
            "one posture."
        )

    def _content(self) -> Mapping[str, Any]:
        columns = [{"name": _ACROSS, "unit": ""}, *({"name": name, "unit": "mm"} for name in _MEASURES)]
        rows = [[cell if isinstance(cell, str) else float(f"{cell:.10g}") for cell in row] for row in self._rows]
        own = {"key": "seam", "title": _TITLE, "columns": columns, "rows": rows, "note": self._note}
        return {"reachable": self.check.verdict, "proved_to": self.check.proved_to, **own}

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {_TITLE: self.table}


def seam_of(arm: Arm, first: tuple[float, float], last: tuple[float, float], points: int) -> Seam:
    """A seam between two points (m), looked at in `points`. Raises `InputError` for an arm that leaves the plane, and
    `NoAnswer` with the first point that it cannot reach."""
    if not arm.model.planar():
        raise InputError("", "arm", f"{arm.name} leaves the x-y plane; a seam's normal is one direction in it only")
    check = check_seam(way_to(arm.model, arm.model.tip).arm, first, last)
    if check.verdict == "unreachable" and check.first_unreachable is not None:
        raise Unreachable(check.first_unreachable, check.missing)
    places, errors = seam_errors(arm.model, first, last, points=points)
    return Seam(arm, check, tuple((1e3 * places).tolist()), tuple(map(tuple, (1e3 * errors).tolist())))


def seam_errors(
    arm: Model, start: Sequence[float], end: Sequence[float], *, points: int = 9, postures: int = 256
) -> tuple[Array, Array]:
    """Distances along a straight seam (N,), and the worst error there over every posture (N, 3), m: along the seam,
    normal to it, and in any direction.

    Args:
        arm: A planar arm.
        start, end: Two components, m.
        points: How many points are looked at.
        postures: How many postures are sought at each of them.

    Raises:
        Unreachable: Where the arm cannot follow.
    """
    one, other = np.array([*start, 0.0]), np.array([*end, 0.0])
    length = float(np.linalg.norm(other - one))
    along = (other - one) / length
    normal = np.array([-along[1], along[0], 0.0])
    share = np.linspace(0.0, 1.0, points)
    directions = np.vstack([along, -along, normal, -normal, around(180)])
    reach = Postures(arm, postures).farthest(one + share[:, None] * (other - one), directions)
    return share * length, np.column_stack([reach[:, :2].max(axis=1), reach[:, 2:4].max(axis=1), reach.max(axis=1)])


def point_of(given: Sequence[Quantity], key: str) -> tuple[float, float]:
    """A point in the plane, m. Raises `InputError`."""
    if len(given) != 2:
        raise InputError("", key, f"needs two lengths, e.g. 600 mm, 500 mm, not {', '.join(map(str, given))}")
    x, y = (in_si(each, "length", key) for each in given)
    return x, y
