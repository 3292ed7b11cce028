"""The workplace of the paper: 50 degC, 125 gauss, a sliding rail, and two arms that work together on it.

The paper names all four and computes none. What it does not print (the rail's figures, how far apart the arms stand)
is assumed here, and each table's note says so.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from linkwright.core.arm.chain.chain import Arm, EffectEntry, Joint, Link, LoadCase
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.materials.material import Material
from linkwright.core.sections.numeric import Array
from linkwright.paper.corrected import PaperArm, worst_error
from linkwright.paper.postures import Postures, around
from linkwright.paper.rows import Cell, Column, ExtendedTable
from linkwright.results.figures_in_words import figure, mm

from .warmth import COLD, WARM, growth_of, warmed

CANDIDATES = (
    "aluminium-6061-t6",
    "magnesium-az31b",
    "titanium-ti-6al-4v",
    "stainless-316l",
    "cfrp-quasi-isotropic",
    "steel-s355",
    "cast-iron-gjs-400",
)
"""Materials that an arm could be made of, one of each kind."""
USUAL_EXPANSION = 23.6e-6
"""Of commercially pure aluminium from 20 to 100 degC, 1/K (ASM Handbook 2)."""
LIKE_THE_PAPER = "aluminium-6061-t6"
"""Where the growth of the paper's aluminium comes from: the paper prints no coefficient."""


@dataclass(frozen=True)
class Rail:
    """A rail along x with its carriage, SI; the paper prints none of these figures.

    `clearance` and `straightness` are to either side, `pitch` (rad) as well, `backlash` the drive's total lost motion;
    `stiffness` (N/m) is the drive's, `force` what the process pushes along the rail (N).
    """

    travel: float = 2.0
    clearance: float = 20e-6
    backlash: float = 40e-6
    stiffness: float = 20e6
    straightness: float = 50e-6
    pitch: float = 50e-6
    force: float = 100.0

    def joint(self, parts: frozenset[str], travel: tuple[float, float] | None = None) -> Joint:
        """The slide with these of its errors: clearance, backlash, stiffness."""
        return Joint(
            type="prismatic",
            axis=(1.0, 0.0, 0.0),
            range=travel or (0.0, self.travel),
            clearance=self.clearance if "clearance" in parts else 0.0,
            backlash=self.backlash if "backlash" in parts else 0.0,
            stiffness=self.stiffness if "stiffness" in parts else None,
        )

    def under(self, arm: Arm, parts: frozenset[str], travel: tuple[float, float] | None = None) -> Arm:
        """The arm on this rail, which adds these of its errors; straightness and pitch among them as effects."""
        given = {"straightness": ("rail_straightness", "deviation"), "pitch": ("rail_pitch", "angle")}
        own = tuple(replace(entry, at=tuple(number + 1 for number in entry.at)) for entry in arm.effects)
        effects = tuple(
            EffectEntry(effect, (1,), MappingProxyType({parameter: getattr(self, part)}))
            for part, (effect, parameter) in given.items()
            if part in parts
        )
        return replace(
            arm,
            joints=(self.joint(parts, travel), *arm.joints),
            links=(Link(0.0, mass=0.0), *arm.links),
            effects=(*own, *effects),
        )


EVERY_PART = frozenset({"clearance", "backlash", "stiffness", "straightness", "pitch"})


def heat_table(arms: PaperArm, names: Sequence[str] = CANDIDATES) -> ExtendedTable:
    """Growth at 50 degC beside the elastic error, and which materials 125 gauss leaves."""
    rows: list[tuple[Cell, ...]] = []
    catalogue = load_catalogue(user=False)
    reach = sum(arms.paper.parameters.lengths)
    for made_of in (catalogue.find(name) for name in names):
        elastic = worst_error(replace(arms.arm(made_of=made_of), temperature=WARM))
        both = worst_error(warmed(arms.arm(made_of=made_of)))
        growth = growth_of(made_of, reach) or 0.0
        cells = (1e3 * elastic, 1e3 * growth, growth / elastic, 1e3 * both)
        rows.append((made_of.name, *cells, magnetism(made_of)))
    like = catalogue.find(LIKE_THE_PAPER)
    growth = growth_of(like, reach) or 0.0
    sag = arms.paper.weight_sag + arms.paper.tool_sag
    usual = USUAL_EXPANSION * (WARM - COLD) * reach
    note = (
        f"Round bars of Table II's size, no play. From 20 to 50 °C the paper's arm grows by {mm(growth, 3)} (with the "
        f"coefficient of {like.name}; it prints none): {figure(growth / sag, 2)} times its own {mm(sag, 3)} of elastic "
        f"error, {figure(growth / worst_error(arms.arm()), 2)} times the true one. With the {USUAL_EXPANSION:.3g}/K of "
        f"pure aluminium it is {mm(usual, 2)} and {figure(usual / sag, 2)} times. Growth follows the arm, sag follows "
        "gravity, so that at full stretch they add as the sides of a right angle do (the worst pose is bent a "
        "little). A controller that knows the temperature takes growth out; it cannot take out what it does not "
        "measure. At 125 gauss (12.5 mT) a ferromagnetic link is pulled and magnetised, and what it makes of the "
        "field can deflect the arc: only the others serve."
    )
    columns = (
        Column("material"),
        Column("elastic error at 50 °C", "mm"),
        Column("growth", "mm"),
        Column("growth / elastic"),
        Column("both, worst pose", "mm"),
        Column("at 125 gauss"),
    )
    return ExtendedTable("heat_and_field", "At 50 °C and 125 gauss", columns, tuple(rows), note)


def magnetism(made_of: Material) -> str:
    """Whether a material serves in a strong field, in words; what nobody has stated is not taken for granted."""
    if made_of.magnetic is None:
        return "not stated"
    return "ferromagnetic: no" if made_of.magnetic else "serves"


def rail_table(arms: PaperArm, rail: Rail | None = None) -> ExtendedTable:
    """What a rail under the arm adds to its worst error, part by part and together."""
    given = rail or Rail()
    arm = replace(arms.arm(clearance=(1, 2, 3), backlash=(1, 2, 3)), payload=LoadCase(force=(given.force, 0.0, 0.0)))
    alone = worst_error(arm)
    parts = (
        ("clearance of the carriage", "clearance", f"±{mm(given.clearance)}"),
        ("backlash of the drive", "backlash", mm(given.backlash)),
        ("stiffness of the drive", "stiffness", f"{figure(given.stiffness / 1e6)} N/µm"),
        ("straightness of the rail", "straightness", f"±{mm(given.straightness)}"),
        ("pitch of the carriage", "pitch", f"±{figure(1e6 * given.pitch)} µrad"),
    )
    rows: list[tuple[Cell, ...]] = [("the arm without a rail", "–", 1e3 * alone, 0.0)]
    for name, part, size in parts:
        worst = worst_error(given.under(arm, frozenset({part})))
        rows.append((name, size, 1e3 * worst, _clean(worst - alone)))
    worst = worst_error(given.under(arm, EVERY_PART))
    rows.append(("all of them", "–", 1e3 * worst, _clean(worst - alone)))
    note = (
        "The rail's figures are assumed, those of an ordinary profiled guide with rack and pinion on a welded frame "
        f"(the paper prints none); the process pushes {figure(given.force)} N along it. Pitch costs its angle times "
        "the reach, so that it is the angle of the carriage that has to be bought, not its place. Parts that act "
        "across each other at the worst pose add less together than alone."
    )
    columns = (Column("part"), Column("size"), Column("worst error", "mm"), Column("added", "mm"))
    return ExtendedTable("rail", "The sliding rail", columns, tuple(rows), note)


def _clean(metres: float) -> float:
    """Millimetres, without what lies below a nanometre."""
    return round(1e3 * metres, 6) + 0.0


@dataclass(frozen=True)
class Pair:
    """How far the tips of two arms that hold one point can part, m.

    `points` (P, 2) lie in the shared region; `first`, `second` (P,) are each arm's own worst error there, `together`
    the worst distance between the two tips. Errors fill convex sets; the farthest that two sets part in a direction is
    the one's reach in it plus the other's against it, so that `together` is never more than first + second.
    """

    points: Array
    first: Array
    second: Array
    together: Array


def pair_errors(first: Arm, second: Arm, points: Array, *, postures: int = 512, directions: int = 180) -> Pair:
    """The errors of two planar arms whose tips meet at points (P, 2), over every posture of either.

    Both arms are given in one frame. `directions` is even; between two of them a reach can be up to
    1 - cos(pi / directions) greater. Raises `Unreachable` where either arm cannot reach.
    """
    places = np.column_stack([points, np.zeros(len(points))])
    ways = around(directions)
    one, other = (Postures(arm, postures).farthest(places, ways) for arm in (first, second))
    against = np.roll(other, -(directions // 2), axis=1)
    return Pair(points, one.max(axis=1), other.max(axis=1), (one + against).max(axis=1))


def dual_table(
    arms: PaperArm, rail: Rail | None = None, *, apart: float = 1.2, grid: int = 3, postures: int = 512
) -> ExtendedTable:
    """The worst relative error of two tips on one rail, at points that both arms reach."""
    given = rail or Rail()
    arm = arms.arm(clearance=(1, 2, 3), backlash=(1, 2, 3))
    first, second = (given.under(arm, EVERY_PART, (at, at)) for at in (0.0, apart))
    across = np.linspace(0.2, apart - 0.2, grid)
    points = np.array([(float(x), y) for y in (0.3, 0.5, 0.7) for x in across])
    found = pair_errors(first, second, points, postures=postures)
    rows: list[tuple[Cell, ...]] = [
        (
            f"({figure(1e3 * float(x))}, {figure(1e3 * float(y))})",
            *(1e3 * float(value) for value in (one, other, one + other, both)),
        )
        for (x, y), one, other, both in zip(points, found.first, found.second, found.together, strict=True)
    ]
    worst = (found.first.max(), found.second.max(), (found.first + found.second).max(), found.together.max())
    rows.append(("worst of them", *(1e3 * float(value) for value in worst)))
    note = (
        f"Two of the paper's arms, {mm(apart)} apart on one rail (assumed, as the rail's figures), hold their tips "
        "at one point, carrying arm and welding arm. Each has its own play, sag and carriage; the worst over every "
        "posture of either. Both sag the same way, so that their tips can part by less than the sum of the two "
        "errors: in a direction d by what the one reaches along d and the other against it."
    )
    columns = (
        Column("both tips at, mm"),
        Column("first arm", "mm"),
        Column("second arm", "mm"),
        Column("sum", "mm"),
        Column("worst parting", "mm"),
    )
    return ExtendedTable("dual_arm", "Two arms on one rail", columns, tuple(rows), note)
