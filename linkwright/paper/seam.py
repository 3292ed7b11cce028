"""Straight seams: whether a planar arm can follow one, and its worst error along and across it, over every posture."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.branches import way_to
from linkwright.core.arm.chain.chain import Arm as Model
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.arm.worst.seam import SeamCheck, check_seam
from linkwright.core.arm.worst.search import WorstSearch
from linkwright.core.arm.worst.workspace import Unreachable, Workspace, pull
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError
from linkwright.face.arm import Arm
from linkwright.face.plain_input import Quantity, in_si
from linkwright.face.result import Result, drawn
from linkwright.output.table_file import frame
from linkwright.results.document import Description, Paragraph, Value
from linkwright.results.document import table as described_table
from linkwright.results.figures_in_words import figure

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go


_HELD = 1e-7
"""How near (m) a posture's tip must be to its point."""
_NEAR = (0.2, 0.05, 0.01, 0.002)
"""How far (rad, m) the postures tried around the best ones lie from them, round after round."""


@dataclass(frozen=True)
class Postures:
    """The postures of an arm at points, and how far its error reaches there; play counts as worst.

    `count` postures are sought at each point, spread over the joint ranges; the best are refined. What is found is
    never more than the truth, and comes near it: postures are sampled, not enclosed.
    """

    arm: Model
    count: int = 256

    @cached_property
    def search(self) -> WorstSearch:
        """The arm's model and its joint ranges; raises `PropertyNeeded` or `MissingProperty` where data lacks."""
        return WorstSearch(error_model(self.arm), Workspace())

    @cached_property
    def design(self) -> Array:
        """The arm's rigidities and lengths."""
        return beam_values(beams_of(self.arm))

    def support(self, q: Array, directions: Array) -> Array:
        """How far the error reaches (m, N x D) at postures q (N, n) in unit directions (D, 3) or (N, D, 3)."""
        case = self.search.model.cases[0]
        arrays = case.arrays(np.ascontiguousarray(q), self.design)
        d = np.broadcast_to(directions, (len(q), *directions.shape[-2:]))
        reach = np.einsum("ni,nmi->nm", arrays.vector, d)
        reach += np.abs(np.einsum("nki,nmi->nkm", arrays.intervals, d)).sum(axis=1)
        for disc, radius in enumerate(case.radii):
            along = np.einsum("ni,nmi->nm", arrays.normals[:, disc], d)
            reach += radius * np.sqrt(np.maximum(1.0 - along * along, 0.0))
        return reach

    def farthest(self, points: Array, directions: Array) -> Array:
        """The support at each point (P, 3) in each direction (D, 3) over all postures found there, (P, D), m.

        Raises `Unreachable` for a point without any posture.
        """
        spread = self.search.poses(self.design, self.count)
        starts = np.tile(spread, (len(points), 1))
        q, owner = self._held(starts, points, np.repeat(np.arange(len(points)), len(spread)))
        for point in range(len(points)):
            if not np.any(owner == point):
                raise Unreachable(tuple(points[point, :2].tolist()), self._missing(starts, points[point]))
        best, at = self._best(q, owner, directions, len(points))
        random = np.random.default_rng(5)
        for near in _NEAR:
            # Near each direction's best posture there may be a better one: the arm has joints to spare.
            seeds = np.unique(at)
            moved = np.repeat(q[seeds], 12, axis=0)
            moved = moved + random.normal(0.0, near, moved.shape)
            tried, owners = self._held(moved, points, np.repeat(owner[seeds], 12))
            q, owner = np.vstack([q[seeds], tried]), np.concatenate([owner[seeds], owners])
            best, at = self._best(q, owner, directions, len(points))
        return best

    def _held(self, starts: Array, points: Array, owner: NDArray[np.intp]) -> tuple[Array, NDArray[np.intp]]:
        """The starts moved so that their tips are at their points, those that can."""
        used = np.array([1.0, 1.0, 0.0 if self.search.model.planar else 1.0])
        lower, upper = self.search.lower, self.search.upper
        q, distance = pull(lambda at: self.search.motion(at, self.design), starts, points[owner], lower, upper, used)
        return q[distance < _HELD], owner[distance < _HELD]

    def _missing(self, starts: Array, point: Array) -> float:
        lower, upper = self.search.lower, self.search.upper
        targets = np.tile(point, (min(len(starts), 64), 1))
        used = np.array([1.0, 1.0, 0.0 if self.search.model.planar else 1.0])
        few = starts[: len(targets)]
        return float(pull(lambda at: self.search.motion(at, self.design), few, targets, lower, upper, used)[1].min())

    def _best(
        self, q: Array, owner: NDArray[np.intp], directions: Array, points: int
    ) -> tuple[Array, NDArray[np.intp]]:
        reach = self.support(q, directions)
        best = np.empty((points, len(directions)))
        at = np.empty((points, len(directions)), dtype=np.intp)
        for point in range(points):
            indices = np.flatnonzero(owner == point)
            first = np.argmax(reach[indices], axis=0)
            at[point] = indices[first]
            best[point] = reach[at[point], np.arange(len(directions))]
        return best, at


def around(count: int) -> Array:
    """Unit vectors (count, 3) evenly around the x-y plane, an even count so that each has its opposite."""
    if count % 2:
        raise ValueError("a direction and its opposite make an even count")
    turn = np.arange(count) * (2.0 * np.pi / count)
    return np.column_stack([np.cos(turn), np.sin(turn), np.zeros(count)])


_TITLE, _ACROSS, _MEASURES = "Error along a seam", "along the seam, mm", ("tangential", "normal", "in all")


@dataclass(frozen=True, repr=False)
class Seam(Result):
    """Whether a planar arm can follow a straight seam, and its worst error along and across it.

    `places` (N,) are distances from the seam's start (mm), `errors` (N, 3) the worst error there (mm): along the seam,
    normal to it, and in any direction.
    """

    _command = "seam"
    _signed = False

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
        return frame(self._rows, [_ACROSS, *(f"{name}, mm" for name in _MEASURES)])

    @property
    def description(self) -> Description:
        """The result as screen and Markdown show it."""
        rows = [(place, *(Value(figure(value)) for value in errors)) for place, *errors in self._rows]
        shown = described_table((_ACROSS, *(f"{name}, mm" for name in _MEASURES)), rows, title=_TITLE)
        return Description(_TITLE, self.headline, (shown, Paragraph(self._note)))

    def plot(self) -> go.Figure:
        """The errors along the seam."""
        lines = {f"{name}, mm": [row[k] for row in self.errors] for k, name in enumerate(_MEASURES)}
        return drawn(self.places, lines, _ACROSS, "worst error in mm", mode="lines+markers")

    @property
    def headline(self) -> str:
        """Whether the arm can follow it, in a line."""
        proved = "every point can be reached, proved" if self.proved else "poses were found everywhere"
        return f"{self.arm.name}: {proved}"

    @property
    def _rows(self) -> list[tuple[str, float, float, float]]:
        along, across, total = (max(column) for column in zip(*self.errors, strict=True))
        rows = [(figure(place), *errors) for place, errors in zip(self.places, self.errors, strict=True)]
        return [*rows, ("worst along it", along, across, total)]

    @property
    def _note(self) -> str:
        ends = (self.check.start, self.check.end)
        text = " to ".join(f"({figure(1e3 * point[0])}, {figure(1e3 * point[1])})" for point in ends)
        return (
            f"The seam runs straight from {text} mm. Each point has the worst over every posture that holds the tip "
            "there, with play where it is worst. Errors are along the seam (the weld starts and ends wrong), normal to "
            "it (the torch misses the joint), and in any direction. Each is a worst case of its own, so that they need "
            "not meet in one posture."
        )

    def _content(self) -> Mapping[str, Any]:
        columns = [{"name": _ACROSS, "unit": ""}, *({"name": name, "unit": "mm"} for name in _MEASURES)]
        rows = [[cell if isinstance(cell, str) else float(f"{cell:.10g}") for cell in row] for row in self._rows]
        content = {"key": "seam", "title": _TITLE, "columns": columns, "rows": rows, "note": self._note}
        return {"reachable": self.check.verdict, "proved_to": self.check.proved_to, **content}

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
    x, y = (in_si(item, "length", key) for item in given)
    return x, y
