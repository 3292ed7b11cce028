"""Figures 5 to 9 of the paper as data: what it plots by its own conventions, and the truth beside it.

The paper's figures are not digitised: its curves are computed by the conventions that reproduce its tables.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType

import numpy as np

from linkwright.core.arm.chain.chain import LoadCase
from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.arm.errors.model import BEAM_FIELDS
from linkwright.core.arm.figures.strength import LARGEST_DEFLECTION, StrengthResult, strength_over
from linkwright.core.arm.worst.search import WorstSearch
from linkwright.core.arm.worst.workspace import spread
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.sections.numeric import Array
from linkwright.paper.conventions import SQUARE, Conventions, squared
from linkwright.paper.corrected import PaperArm, pose_errors, search_of, worst_error
from linkwright.paper.printed import read_paper
from linkwright.results.figures_in_words import figure, mm

YIELD_MATERIAL = "aluminium-6061-t6"
"""Whose yield strength figure 9 takes: the paper prints none."""
_FULL = np.array([math.pi] * 3)


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


def make_figures(*, poses: int = 2**18, cells: int = 56, points: int = 25) -> tuple[Figure, ...]:
    """Compute figures 5 to 9; `poses` and `cells` (across) set how fine figure 5 is, `points` the sweeps."""
    maker = _Maker(poses, cells, points)
    return (maker.error_map(), maker.around(), maker.clearance(), maker.backlash(), maker.length())


@dataclass(frozen=True)
class _Maker:
    poses: int
    cells: int
    points: int

    @cached_property
    def conventions(self) -> Conventions:
        return Conventions(read_paper())

    @cached_property
    def arms(self) -> PaperArm:
        return PaperArm(self.conventions.paper)

    def error_map(self) -> Figure:
        arm = self.arms.arm()
        q = spread(-_FULL, _FULL, self.poses)
        tips = tip_position(arm, q)[:, :2]
        ours = pose_errors(arm, q)
        theirs = self._paper_squares(np.cumsum(q, axis=1))
        reach = sum(arm.lengths)
        size = 2.0 * reach / self.cells
        cell = np.clip(((tips + reach) / size).astype(int), 0, self.cells - 1)
        flat = cell[:, 1] * self.cells + cell[:, 0]
        columns = {name: list[float]() for name in ("x_mm", "y_mm", "corrected_mm", "paper_mm2")}
        worst, worst_squares = np.full(self.cells**2, np.nan), np.full(self.cells**2, np.nan)
        for values, store in ((1e3 * ours, worst), (theirs, worst_squares)):
            order = np.argsort(values)
            store[flat[order]] = values[order]  # the largest of a cell is written last
        for index in range(self.cells**2):
            row, column = divmod(index, self.cells)
            columns["x_mm"].append(1e3 * ((column + 0.5) * size - reach))
            columns["y_mm"].append(1e3 * ((row + 0.5) * size - reach))
            columns["corrected_mm"].append(float(worst[index]))
            columns["paper_mm2"].append(float(worst_squares[index]))
        largest = worst_error(arm)
        return _figure(
            "5",
            "Position error under deformation, over the workspace",
            columns,
            {"corrected_max_mm": 1e3 * largest, "paper_max_mm2": squared(self.conventions.sag)},
            f"The worst error met at each place of the tip, over {figure(float(self.poses), 6)} poses. True maximum "
            f"{mm(largest)}; the paper prints 0.0015, the square of {mm(self.conventions.sag, 3)}.",
            "Both are worst where the arm is held straight out, and least where it stands or hangs.",
        )

    def _paper_squares(self, absolute: Array) -> Array:
        moved = self.conventions.fitted.at(absolute)
        return 1e6 * (moved * moved).sum(axis=1)

    def around(self) -> Figure:
        angles = np.linspace(0.0, 2.0 * math.pi, 73)
        q = np.stack([angles, np.zeros_like(angles), np.zeros_like(angles)], axis=1)
        turned = np.where(q > math.pi, q - 2.0 * math.pi, q)
        clearance = self.arms.arm(clearance=(1, 2, 3))
        paper_play = 3.0 * SQUARE * self.conventions.paper.clearance_size
        paper_sag = np.sqrt(self._paper_squares(np.repeat(angles[:, None], 3, axis=1))) * 1e-3
        alone = 3.0 * self.conventions.paper.clearance_size
        columns = {
            "shoulder_deg": np.degrees(angles),
            "corrected_clearance_mm": np.full_like(angles, 1e3 * alone),
            "corrected_with_deformation_mm": 1e3 * pose_errors(clearance, turned),
            "paper_clearance_mm2": np.full_like(angles, squared(paper_play)),
            "paper_with_deformation_mm2": (1e3 * (paper_play + paper_sag)) ** 2,
        }
        return _figure(
            "6",
            "Clearance alone and with deformation, the arm straight, turned at the shoulder",
            {name: values.tolist() for name, values in columns.items()},
            {},
            "Clearance alone gives the same worst error in every pose; deformation makes it depend on the pose. The "
            "paper's axes cannot be read, so the pose is taken as the straight arm turning once around.",
        )

    def clearance(self) -> Figure:
        sizes = np.geomspace(0.005e-3, 2e-3, self.points)
        ours = [worst_error(self.arms.arm(clearance=(1, 2, 3), clearance_size=float(size))) for size in sizes]
        theirs = 3.0 * SQUARE * sizes
        columns = {
            "clearance_mm": (1e3 * sizes).tolist(),
            "corrected_clearance_mm": (3e3 * sizes).tolist(),
            "corrected_with_deformation_mm": (1e3 * np.array(ours)).tolist(),
            "paper_clearance_mm2": ((1e3 * theirs) ** 2).tolist(),
            "paper_with_deformation_mm2": ((1e3 * (theirs + self.conventions.sag)) ** 2).tolist(),
        }
        even = worst_error(self.arms.arm()) / 3.0
        return _figure(
            "7",
            "Clearance of all three joints, 0.005 to 2 mm",
            columns,
            {"clearance_equals_deformation_mm": 1e3 * even},
            f"The true error is a straight line: three clearances plus the sag. Below {mm(even, 3)} of clearance "
            "deformation is the larger part. The paper's curves are parabolas of the same straight lines.",
        )

    def backlash(self) -> Figure:
        turns = np.linspace(0.0, 0.01, self.points)
        ours = [worst_error(self.arms.arm(backlash=(1, 2, 3), backlash_size=float(turn))) for turn in turns]
        lengths = self.conventions.paper.parameters.lengths
        swing, whole = sum(lengths), sum(sum(lengths[index:]) for index in range(3))
        theirs = SQUARE * swing * turns
        columns = {
            "backlash_rad": turns.tolist(),
            "corrected_backlash_mm": (1e3 * whole * turns).tolist(),
            "corrected_with_deformation_mm": (1e3 * np.array(ours)).tolist(),
            "paper_backlash_mm2": ((1e3 * theirs) ** 2).tolist(),
            "paper_with_deformation_mm2": ((1e3 * (theirs + self.conventions.sag)) ** 2).tolist(),
        }
        return _figure(
            "8",
            "Backlash of all three drives, to either side",
            columns,
            {"backlash_of_table_IV_rad": self.conventions.paper.backlash_size},
            "The paper sweeps from “0.005 to 0.01mm”, a length for an angle: taken as rad here, from zero on. That "
            "range is ten to twenty times the backlash of its Table IV (0.0005 rad).",
            f"In a serial arm the error is {figure(whole / swing, 3)} times that of the paper's absolute angles "
            "(without its √2).",
        )

    def length(self) -> Figure:
        scales = np.geomspace(1.0, 20.0, self.points)
        swept = _Lengthened(self.arms)
        ours = [swept.worst(float(scale)) for scale in scales]
        paper = self.conventions.paper
        theirs = [squared(paper.weight_sag * scale**4 + paper.tool_sag * scale**3) for scale in scales]
        breaking, bending = swept.yields_at(), swept.bends_at()
        reach = sum(paper.parameters.lengths)
        columns = {
            "reach_mm": (1e3 * reach * scales).tolist(),
            "corrected_mm": (1e3 * np.array(ours)).tolist(),
            "paper_mm2": theirs,
            "safety_factor": [swept.safety(float(scale)) for scale in scales],
        }
        slope = math.log(ours[-1] / ours[-2]) / math.log(scales[-1] / scales[-2])
        return _figure(
            "9",
            "All links lengthened alike, the bars as thick as they are",
            columns,
            {"yields_at_reach_mm": 1e3 * reach * breaking, "linear_to_reach_mm": 1e3 * reach * bending},
            f"The error grows with the power {figure(slope, 3)} of the length, and the paper's square of it with "
            "twice that: the sharp rise is no sign of yielding.",
            f"A link really yields, under the arm's own weight, at a reach of {mm(reach * breaking)} "
            f"({figure(breaking, 3)} times the arm's; {YIELD_MATERIAL}, {figure(1e-6 * swept.strength, 3)} MPa; "
            f"statics of the undeformed arm). From {mm(reach * bending)} on a link bends by more than a tenth of its "
            "length: linear bending, ours as well, ends before anything yields.",
        )


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
        """The factor at which a link's own bending passes a tenth of its length."""
        return _crossing(lambda scale: LARGEST_DEFLECTION - max(self._strength(scale).deflection))


def _crossing(value: Callable[[float], float]) -> float:
    """Where a falling function of the factor changes sign, by bisection between 1 and 100."""
    low, high = 1.0, 100.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if value(middle) > 0.0 else (low, middle)
    return 0.5 * (low + high)


def _figure(
    number: str, title: str, columns: Mapping[str, list[float]], marks: Mapping[str, float], *remarks: str
) -> Figure:
    frozen = MappingProxyType({name: tuple(values) for name, values in columns.items()})
    return Figure(number, title, frozen, MappingProxyType(dict(marks)), remarks)
