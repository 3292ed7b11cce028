"""Figures 5 to 9 of the paper as data: what it plots by its conventions, and the truth beside it.

The paper's figures are not digitised: its curves are computed by the conventions that reproduce its tables.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Any

import numpy as np

from linkwright.core.arm.chain.chain import LoadCase
from linkwright.core.arm.errors.model import BEAM_FIELDS
from linkwright.core.arm.figures.strength import LARGEST_DEFLECTION, StrengthResult, strength_over
from linkwright.core.arm.worst.search import WorstSearch
from linkwright.core.arm.worst.workspace import spread
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.sections.numeric import Array
from linkwright.paper.conventions import SQUARE, Conventions, squared
from linkwright.paper.corrected import PaperArm, pose_errors, search_of, worst_error
from linkwright.paper.printed import read_paper, words
from linkwright.results.figures_in_words import figure, mm

YIELD_MATERIAL = "aluminium-6061-t6"
"""Whose yield strength figure 9 takes: the paper prints none."""
_SHARES = np.unique(np.concatenate([np.linspace(-1.0, 1.0, 26) ** power for power in (1, 3)]))
"""Directions of the last link that are looked at, at each place of figure 5, as shares of those that it can have. They
are denser where the elbow is folded and turns fastest."""
_FULL = np.array([math.pi] * 3)
_ALL = (1, 2, 3)


@dataclass(frozen=True)
class Figure:
    """A figure as data: `columns` by name (names carry units), all of one length; NaN where there is nothing.

    `marks` are single values worth pointing at, by name; `remarks` say how it was made and what it shows.
    """

    number: str
    title: str
    columns: Mapping[str, tuple[float, ...]]
    marks: Mapping[str, float]
    remarks: tuple[str, ...]

    def column(self, name: str) -> Array:
        """A column as an array."""
        return np.array(self.columns[name])


def make_figures(*, rings: int = 32, spokes: int = 96, points: int = 25) -> tuple[Figure, ...]:
    """Compute figures 5 to 9; `rings` and `spokes` set how fine figure 5 is, `points` the sweeps."""
    maker = _Maker(rings, spokes, points)
    return (maker.error_map(), maker.around(), maker.clearance(), maker.backlash(), maker.length())


def postures_at(lengths: Sequence[float], radius: Array, angle: Array, share: float) -> Array:
    """Joint angles (2, N, 3), rad, of a planar 3R arm with its tip at polar coordinates (N,): the elbow on either side,
    the last link at that share (-1 to 1) of the directions that it can have there."""
    a, b, c = lengths
    # The elbow is straight at one end of what the last link can do, and folded at the other, in the middle.
    ends = [np.arccos(np.clip((radius**2 + c**2 - far**2) / (2.0 * radius * c), -1.0, 1.0)) for far in (a - b, a + b)]
    last = angle + np.copysign(ends[0] + np.abs(share) * (ends[1] - ends[0]), share)
    x, y = radius * np.cos(angle) - c * np.cos(last), radius * np.sin(angle) - c * np.sin(last)
    elbow = np.arccos(np.clip((x**2 + y**2 - a**2 - b**2) / (2.0 * a * b), -1.0, 1.0))
    made: list[Array] = []
    for second in (elbow, -elbow):
        first = np.arctan2(y, x) - np.arctan2(b * np.sin(second), a + b * np.cos(second))
        q = np.stack([first, second, last - first - second], axis=-1)
        made.append((q + math.pi) % (2.0 * math.pi) - math.pi)
    return np.stack(made)


def _figure(number: str, columns: Mapping[str, Any], marks: Mapping[str, float], **values: str) -> Figure:
    """A figure with its title and remarks, into which the `values` are filled."""
    said = words()["figures"][number]
    frozen = MappingProxyType({name: tuple(np.asarray(column).tolist()) for name, column in columns.items()})
    remarks = tuple(remark.format(**values) for remark in said["remarks"])
    return Figure(number, said["title"], frozen, MappingProxyType(dict(marks)), remarks)


@dataclass(frozen=True)
class _Maker:
    rings: int
    spokes: int
    points: int

    @cached_property
    def conventions(self) -> Conventions:
        return Conventions(read_paper())

    @cached_property
    def arms(self) -> PaperArm:
        return PaperArm(self.conventions.paper)

    def error_map(self) -> Figure:
        arm = self.arms.arm()
        reach = sum(arm.lengths)
        radius = np.repeat(reach * np.linspace(1e-6, 1.0, self.rings + 1), self.spokes)
        angle = np.tile(2.0 * math.pi * np.arange(self.spokes) / self.spokes, self.rings + 1)
        postures = [postures_at(arm.lengths, radius, angle, share) for share in _SHARES]
        columns = {"x_mm": 1e3 * radius * np.cos(angle), "y_mm": 1e3 * radius * np.sin(angle)}
        q = np.concatenate(postures).reshape(-1, 3)
        errors = {"corrected_mm": 1e3 * pose_errors(arm, q), "paper_mm2": self._paper_squares(np.cumsum(q, axis=1))}
        for name, values in errors.items():
            columns[name] = values.reshape(-1, len(radius)).max(axis=0)
        largest, sag = worst_error(arm), self.conventions.printed.sag
        marks = {"corrected_max_mm": 1e3 * largest, "paper_max_mm2": squared(sag)}
        said = {"poses": figure(float(len(q)), 6), "largest": mm(largest), "sag": mm(sag, 3)}
        return _figure("5", columns, marks, **said)

    def _paper_squares(self, absolute: Array) -> Array:
        moved = self.conventions.fitted.at(absolute)
        return 1e6 * (moved * moved).sum(axis=1)

    def around(self) -> Figure:
        angles = np.linspace(0.0, 2.0 * math.pi, 73)
        q = np.stack([angles, np.zeros_like(angles), np.zeros_like(angles)], axis=1)
        turned = np.where(q > math.pi, q - 2.0 * math.pi, q)
        alone = 3.0 * self.conventions.paper.clearance_size
        paper_sag = np.sqrt(self._paper_squares(np.repeat(angles[:, None], 3, axis=1))) * 1e-3
        columns = {
            "shoulder_deg": np.degrees(angles),
            "corrected_clearance_mm": np.full_like(angles, 1e3 * alone),
            "corrected_with_deformation_mm": 1e3 * pose_errors(self.arms.arm(clearance=_ALL), turned),
            "paper_clearance_mm2": np.full_like(angles, squared(SQUARE * alone)),
            "paper_with_deformation_mm2": squared(SQUARE * alone + paper_sag),
        }
        return _figure("6", columns, {})

    def clearance(self) -> Figure:
        sizes = np.geomspace(0.005e-3, 2e-3, self.points)
        ours = [worst_error(self.arms.arm(clearance=_ALL, clearance_size=size)) for size in sizes.tolist()]
        theirs = 3.0 * SQUARE * sizes
        columns = {
            "clearance_mm": 1e3 * sizes,
            "corrected_clearance_mm": 3e3 * sizes,
            "corrected_with_deformation_mm": 1e3 * np.array(ours),
            "paper_clearance_mm2": squared(theirs),
            "paper_with_deformation_mm2": squared(theirs + self.conventions.printed.sag),
        }
        even = worst_error(self.arms.arm()) / 3.0
        return _figure("7", columns, {"clearance_equals_deformation_mm": 1e3 * even}, even=mm(even, 3))

    def backlash(self) -> Figure:
        turns = np.linspace(0.0, 0.01, self.points)
        ours = [worst_error(self.arms.arm(backlash=_ALL, backlash_size=turn)) for turn in turns.tolist()]
        lengths = self.conventions.paper.parameters.lengths
        swing, whole = sum(lengths), sum(sum(lengths[index:]) for index in range(3))
        theirs = SQUARE * swing * turns
        columns = {
            "backlash_rad": turns,
            "corrected_backlash_mm": 1e3 * whole * turns,
            "corrected_with_deformation_mm": 1e3 * np.array(ours),
            "paper_backlash_mm2": squared(theirs),
            "paper_with_deformation_mm2": squared(theirs + self.conventions.printed.sag),
        }
        marks = {"backlash_of_table_IV_rad": self.conventions.paper.backlash_size}
        return _figure("8", columns, marks, times=figure(whole / swing, 3))

    def length(self) -> Figure:
        scales = np.geomspace(1.0, 20.0, self.points)
        swept = _Lengthened(self.arms)
        ours = [swept.worst(scale) for scale in scales.tolist()]
        paper = self.conventions.paper
        breaking, bending = swept.yields_at(), swept.bends_at()
        reach = sum(paper.parameters.lengths)
        columns = {
            "reach_mm": 1e3 * reach * scales,
            "corrected_mm": 1e3 * np.array(ours),
            "paper_mm2": [squared(paper.weight_sag * x**4 + paper.tool_sag * x**3) for x in scales.tolist()],
            "safety_factor": [swept.safety(scale) for scale in scales.tolist()],
        }
        power = math.log(ours[-1] / ours[-2]) / math.log(scales[-1] / scales[-2])
        marks = {"yields_at_reach_mm": 1e3 * reach * breaking, "linear_to_reach_mm": 1e3 * reach * bending}
        said = {
            "power": figure(power, 3),
            "yields": mm(reach * breaking),
            "breaking": figure(breaking, 3),
            "material": YIELD_MATERIAL,
            "strength": figure(1e-6 * swept.strength, 3),
            "bends": mm(reach * bending),
        }
        return _figure("9", columns, marks, **said)


@dataclass(frozen=True)
class _Lengthened:
    """The paper's arm with all its links longer by a factor."""

    arms: PaperArm

    @cached_property
    def _search(self) -> tuple[WorstSearch, Array]:
        return search_of(self.arms.arm())

    @cached_property
    def strength(self) -> float:
        """The yield strength that figure 9 takes, Pa."""
        return load_catalogue(user=False).find(YIELD_MATERIAL).need("yield_strength")

    def _design(self, scale: float) -> Array:
        design = self._search[1].copy()
        design[:: len(BEAM_FIELDS)] *= scale
        return design

    def worst(self, scale: float) -> float:
        """The worst error, m."""
        return self._search[0].worst(self._design(scale), certify=False).error

    def safety(self, scale: float) -> float:
        """The yield strength over the largest stress, over spread poses and the arm held straight out."""
        return self.strength / max(self._strength(scale).stress)

    def _strength(self, scale: float) -> StrengthResult:
        search = self._search[0]
        poses = np.vstack([np.zeros((1, 3)), spread(-_FULL, _FULL, 512)])
        return strength_over(search.arm, (LoadCase(),), poses, self._design(scale))

    def yields_at(self) -> float:
        """The factor at which the first link yields."""
        return _crossing(lambda scale: self.safety(scale) - 1.0)

    def bends_at(self) -> float:
        """The factor at which a link's bending passes a tenth of its length."""
        return _crossing(lambda scale: LARGEST_DEFLECTION - max(self._strength(scale).deflection))


def _crossing(value: Callable[[float], float]) -> float:
    """Where a falling function of the factor changes sign, by bisection between 1 and 100."""
    low, high = 1.0, 100.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if value(middle) > 0.0 else (low, middle)
    return 0.5 * (low + high)
