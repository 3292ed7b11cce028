"""How near a link is to yielding, buckling, or bending beyond what linear theory can say.

Stress: normal stress of axial force and of bending in both planes, added up at the corner where they meet (exact for
bending in one plane, safe for round sections bent in two), with torsional shear by von Mises. At both ends of a link
also where transverse shear counts (Jourawski's V Q / (I b)): on the neutral axis, and where web and flange meet, with
what bends there. Of solid and round sections nothing between is worse.

Buckling: each link as an Euler column fixed at its joint and free at its end (effective length 2 L; Gere & Goodno,
Mechanics of Materials, columns), under what presses its far end and its weight, which is spread along it (along a
tapered link it counts as if it were at the far end). Deflection: a link's bending against a tenth of its length,
where linear theory ends.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from linkwright.core.arm.chain.beam import Station
from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.chain.kinematics import parts
from linkwright.core.arm.chain.statics import LinkState, PoseState, solve
from linkwright.core.arm.chain.vectors import Scalar, Vector, add, cross, dot, plus, scale, times
from linkwright.core.arm.compiled.vectorise import Expressions
from linkwright.core.arm.effects.elastic.link_bending import bent_end, in_both_planes
from linkwright.core.arm.errors.model import beam_symbols, symbolic_beams
from linkwright.core.arm.errors.structure import by_structure
from linkwright.core.arm.limits.weakest_poses import climbed
from linkwright.core.sections.numeric import Array, column_of_symbols

from .design import DesignExpressions, Designs, DesignValues
from .figure import Asked, Cut, Figure, Held, PoseFamily, ThroughPoses, Worst

if TYPE_CHECKING:
    from linkwright.core.arm.worst.search import WorstSearch
    from linkwright.core.sections.properties import SectionProperties

STRENGTH_FIELDS = (
    "area",
    "section_modulus_y",
    "section_modulus_z",
    "torsion_modulus",
    "shear_stress_area_y",
    "shear_stress_area_z",
    "junction_modulus_y",
    "junction_shear_area_z",
)
"""The order in which `strength_values` lists each link's section."""
STATIONS = (0.0, 0.25, 0.5, 0.75, 1.0)
"""Where along a link its stress is looked at, as a share of its length from its joint."""
PLANES = 2
"""Each link may buckle towards its height and towards its width: one share of Euler's load for each, as the greater of
both has no derivative where they are equal, and there the lightest links are."""
STRESSES = len(STATIONS) + 2
"""So many stresses each link has: where bending is largest at `STATIONS`, and where shear counts at both ends."""
_SPREAD = (math.pi**2 / 4.0) / 7.837
"""What a weight spread evenly along a column fixed at its foot counts against one at its end: it buckles under
7.837 EI/L^2 where that does under pi^2/4 EI/L^2 (A. G. Greenhill 1881; S. P. Timoshenko & J. M. Gere, Theory of Elastic
Stability, 2nd ed., 1961, art. 2.12)."""
_CLIMBS = 3
"""Climbs for each station of each link, and for each link's compression."""
LARGEST_DEFLECTION = 0.1
"""A link's bending beyond this share of its length is outside linear theory."""


@dataclass(frozen=True)
class StrengthCase(Expressions):
    """Stress, compression and deflection under one load case, as functions of poses.

    From (q, p, s) to: equivalent stresses (Pa; link after link, each at `STATIONS`), the share of Euler's
    load that presses each link in each of `PLANES` (negative in tension), and each link's deflection over its length.
    Rigid links are left out: `links` numbers those that are listed.
    """

    links: tuple[int, ...]


def strength_values(sections: Sequence[SectionProperties | None]) -> Array:
    """Each link's areas and moduli as one row (in the order of `STRENGTH_FIELDS`, link after link); 1 where rigid."""
    rows = [
        [1.0] * len(STRENGTH_FIELDS) if section is None else [float(getattr(section, f)) for f in STRENGTH_FIELDS]
        for section in sections
    ]
    return np.array(rows).ravel()


@by_structure
def strength_case(arm: Arm, load: LoadCase) -> StrengthCase:
    """The strength of an arm's links under a load case."""
    q = column_of_symbols("q", arm.size)
    p = beam_symbols(arm)
    s = column_of_symbols("s", len(STRENGTH_FIELDS) * arm.size)
    state = solve(arm, parts(q), symbolic_beams(arm, p), load)
    links = tuple(index for index, link in enumerate(arm.links) if link.elastic)
    stress = [
        item
        for i in links
        for item in (*_stresses(state.links[i], _entries(s, i)), *_sheared(state.links[i], _entries(s, i)))
    ]
    compression = [share for i in links for share in _compressions(state, i)]
    deflection = [_deflection(state.links[i]) for i in links]
    columns = (ca.vertcat(ca.SX(0, 1), *column) for column in (stress, compression, deflection))
    return StrengthCase((q, p, s), tuple(columns), links)


def _entries(s: Any, link: int) -> tuple[Any, ...]:
    base = len(STRENGTH_FIELDS) * link
    return tuple(s[base + k] for k in range(len(STRENGTH_FIELDS)))


def _magnitude(value: Scalar) -> Scalar:
    """|value|, smooth: a millionth of a newton (or newton metre) in the root keeps derivatives finite at zero."""
    return ca.sqrt(value * value + 1e-12) if isinstance(value, ca.SX) else abs(value)


def _stress(link: LinkState, section: Sequence[Any], share: float) -> Scalar:
    rest = times(1.0 - share, link.beam.length)
    beyond = scale(1.0 - share, link.weight)
    half = scale(0.5, beyond)
    return _stress_of(link, section, rest, beyond, half)


def _stresses(link: LinkState, section: Sequence[Any]) -> list[Scalar]:
    """The stresses at `STATIONS`; of a tapered link each is the greatest of the stations nearest to it."""
    stations = link.beam.taper.stations
    if not stations:
        return [_stress(link, section, share) for share in STATIONS]
    groups: list[Scalar] = [None] * len(STATIONS)
    for at in stations:
        values = [value * ratio for value, ratio in zip(section, _ratios(at), strict=True)]
        rest = 1.0 - at.share
        beyond = scale(at.weight_beyond, link.weight)
        # The lever of the weight beyond is its moment over it, here as a share of the rest of the link.
        half = scale(at.moment_beyond / rest if rest > 0.0 else 0.0, link.weight)
        stress = _stress_of(link, values, times(rest, link.beam.length), beyond, half)
        nearest = min(range(len(STATIONS)), key=lambda k: abs(STATIONS[k] - at.share))
        groups[nearest] = stress if groups[nearest] is None else ca.fmax(groups[nearest], stress)
    return groups


def _ratios(at: Station) -> tuple[float, ...]:
    """In the order of `STRENGTH_FIELDS`."""
    size = (at.area, at.section_modulus_y, at.section_modulus_z, at.torsion_modulus)
    return (*size, at.area, at.area, at.section_modulus_y, at.area)


def _stress_of(link: LinkState, section: Sequence[Any], rest: Scalar, beyond: Vector, half: Vector) -> Scalar:
    """The stress a distance `rest` (m) from the far end; `beyond` is the weight from there on, and `half` what at the
    far end has its moment."""
    area, modulus_y, modulus_z, torsion_modulus, *_ = section
    force: Vector = add(link.force, beyond)
    axial = _magnitude(dot(force, link.along)) / area
    in_height, in_width = _moments(link, rest, half)
    bending = plus(_magnitude(in_height) / modulus_y, _magnitude(in_width) / modulus_z)
    shear = dot(link.moment, link.along) / torsion_modulus
    normal = plus(axial, bending)
    return ca.sqrt(normal * normal + 3.0 * shear * shear + 1e-6)


def _moments(link: LinkState, rest: Scalar, half: Vector) -> tuple[Scalar, Scalar]:
    """The moments (N*m) that bend a link towards its height and width a distance `rest` (m) from its far end."""
    moment = add(link.moment, cross(scale(rest, link.along), add(link.force, half)))
    in_height, in_width = dot(moment, link.width), times(-1.0, dot(moment, link.height))
    if not (isinstance(link.beam.flexural_rigidity_coupling, float) and link.beam.flexural_rigidity_coupling == 0.0):
        # The moments that would bend a symmetric section as much as these bend this one.
        curved = in_both_planes(link, in_height, in_width)
        in_height = times(curved[0], link.beam.flexural_rigidity_height)
        in_width = times(curved[1], link.beam.flexural_rigidity_width)
    return in_height, in_width


def _sheared(link: LinkState, section: Sequence[Any]) -> list[Scalar]:
    """The stresses where shear counts, at the joint and at the far end: a transverse force changes only by the link's
    weight between them."""
    far = (0.0, scale(0.0, link.weight), scale(0.0, link.weight))
    near = (link.beam.length, link.weight, scale(link.beam.taper.balance, link.weight))
    stations = link.beam.taper.stations
    smaller = [value * ratio for value, ratio in zip(section, _ratios(stations[-1]), strict=True)] if stations else None
    return [_sheared_at(link, section, *near), _sheared_at(link, smaller or section, *far)]


def _sheared_at(link: LinkState, section: Sequence[Any], rest: Scalar, beyond: Vector, half: Vector) -> Scalar:
    """The greatest equivalent stress on the neutral axis of bending in height and in width, where both shear stresses
    meet, and where web and flange meet; the rest as in `_stress_of`."""
    area, modulus_y, modulus_z, torsion_modulus, across, along, junction, junction_area = section
    force: Vector = add(link.force, beyond)
    axial = _magnitude(dot(force, link.along)) / area
    in_height, in_width = _moments(link, rest, half)
    by_height, by_width = _magnitude(dot(force, link.height)), _magnitude(dot(force, link.width))
    twisted = _magnitude(dot(link.moment, link.along)) / torsion_modulus
    other = _magnitude(in_width) / modulus_z

    def together(normal: Scalar, shear: Scalar) -> Scalar:
        return normal * normal + 3.0 * shear * shear

    both = ca.sqrt(ca.SX((by_height / along) ** 2 + (by_width / across) ** 2) + 1e-12)
    squares = [
        together(axial + other, by_height / along + twisted),
        together(axial + _magnitude(in_height) / modulus_y, by_width / across + twisted),
        together(axial, both + twisted),
        together(axial + other + _magnitude(in_height) / junction, by_height / junction_area + twisted),
    ]
    return ca.sqrt(reduce(ca.fmax, map(ca.SX, squares)) + 1e-6)


def _compressions(state: PoseState, index: int) -> list[Scalar]:
    link = state.links[index]
    # Stable loads are a convex set, so that a straight line between both Euler loads is on the safe side of it.
    weight = link.weight if link.beam.taper.parts else scale(_SPREAD, link.weight)
    pressing = times(-1.0, dot(add(link.force, weight), link.along))
    length = link.beam.length
    in_height, in_width = link.beam.flexural_rigidity_height, link.beam.flexural_rigidity_width
    assert in_height is not None
    assert in_width is not None
    taper = link.beam.taper
    columns = (times(taper.column_height, in_height), times(taper.column_width, in_width))
    return [pressing * (4.0 / math.pi**2) * length * length / column for column in columns]


def _deflection(link: LinkState) -> Scalar:
    first, second = bent_end(link)
    # A link without length (a wrist's, in Denavit-Hartenberg form) does not bend; it must not divide by zero either.
    length = ca.fmax(ca.SX(link.beam.length), 1e-9)
    return ca.sqrt(ca.SX(plus(times(first, first), times(second, second))) + 1e-24) / length


@dataclass(frozen=True)
class StrengthResult:
    """The worst over poses and load cases, link by link (numbered from 0).

    `stress` in Pa; `safety_factor` is yield strength over stress, None where a material has no yield strength;
    `buckling` is Euler's load over the compression, infinite where nothing presses; `deflection` is each link's
    bending over its length. `poses` are the poses (q) and load cases of the greatest stress.
    """

    links: tuple[int, ...]
    stress: tuple[float, ...]
    safety_factor: tuple[float | None, ...]
    buckling: tuple[float, ...]
    deflection: tuple[float, ...]
    poses: tuple[tuple[tuple[float, ...], int], ...]
    buckling_poses: tuple[tuple[tuple[float, ...], int], ...]

    @property
    def least_safety_factor(self) -> float | None:
        """The least of the links' safety factors; None where one is not known, or no link is elastic."""
        if not self.links or any(factor is None for factor in self.safety_factor):
            return None
        return min(factor for factor in self.safety_factor if factor is not None)

    @property
    def least_buckling(self) -> float | None:
        """The least of the links' factors against buckling; None where nothing presses any link."""
        pressed = [factor for factor in self.buckling if math.isfinite(factor)]
        return min(pressed) if pressed else None


def worst_strength(
    cases: Sequence[StrengthCase], q: Array, p: Array, s: Array, yields: Sequence[float | None]
) -> StrengthResult:
    """The worst strength over poses q (N, n): `yields` are the links' yield strengths (Pa), None where unknown."""
    links = cases[0].links
    count = len(links)
    results = [tuple(np.asarray(out) for out in case.vectorised(q, p, s)) for case in cases]
    stress = np.stack([out[0].reshape(len(q), count, STRESSES).max(axis=2) for out in results])
    compression = np.stack([_weaker(out[1]) for out in results])
    deflection = np.stack([out[2] for out in results])
    greatest = stress.max(axis=(0, 1)) if count else np.zeros(0)
    pressed = compression.max(axis=(0, 1)) if count else np.zeros(0)

    def where(values: Array) -> tuple[tuple[float, ...], int]:
        case, pose = np.unravel_index(int(np.argmax(values)), values.shape)
        return tuple(q[int(pose)].tolist()), int(case)

    factors: list[float | None] = []
    for index, link in enumerate(links):
        strength = yields[link]
        factors.append(None if strength is None else strength / max(float(greatest[index]), 1e-300))
    return StrengthResult(
        links,
        tuple(greatest.tolist()),
        tuple(factors),
        tuple(math.inf if load <= 0.0 else 1.0 / load for load in pressed.tolist()),
        tuple(deflection.max(axis=(0, 1)).tolist()) if count else (),
        tuple(where(stress[:, :, index]) for index in range(count)),
        tuple(where(compression[:, :, index]) for index in range(count)),
    )


def strength_over(
    arm: Arm, cases: Sequence[LoadCase], poses: Array, p: Array, search: WorstSearch | None = None
) -> StrengthResult:
    """The worst strength of the links over poses (N, n) and load cases; with `search` over its whole workspace,
    the poses being where climbs to greater stress and compression start."""
    # The moduli do not depend on Poisson's ratio, so a material without one will do.
    sections = [None if link.section is None else link.section.properties(0.3) for link in arm.links]
    yields = [
        link.material.need("yield_strength", arm.temperature)
        if link.elastic and link.material is not None and link.material.has("yield_strength")
        else None
        for link in arm.links
    ]
    strength = [strength_case(arm, case) for case in cases]
    values = strength_values(sections)
    if search is not None:
        poses = np.vstack([poses, *(_weakest(search, case, poses, p, values) for case in strength)])
    return worst_strength(strength, poses, p, values, yields)


def _weakest(search: WorstSearch, case: StrengthCase, poses: Array, p: Array, s: Array) -> Array:
    """Poses (M, n) of greatest stress at each station of each link, and of greatest compression."""

    def loads(q: Array) -> Array:
        """All stresses and compressions at poses q."""
        stress, compression, _ = case.vectorised(q, p, s)
        return np.hstack([stress, _weaker(compression)])

    return climbed(search, loads, poses, p, _CLIMBS)


def _weaker(compression: Array) -> Array:
    """The share of Euler's load that presses each link (N, L) in the plane where it is greater."""
    return np.reshape(compression, (len(compression), -1, PLANES)).max(axis=2)


class Strength(PoseFamily[StrengthResult]):
    """Stress against yield strength, and compression against Euler's load."""

    name: str = "strengths"

    def prepare(self, problem: Asked) -> tuple[StrengthCase, ...]:
        """The statics of each load case."""
        return tuple(strength_case(problem.arm, load) for load in problem.load_cases)

    def rows(
        self,
        prepared: tuple[StrengthCase, ...],
        group: int,
        pose: tuple[Any, Any],
        design: DesignExpressions,
        held: Held,
    ) -> Iterator[tuple[int, Any]]:
        """Each link's share of Euler's load, and its stress at each station in logarithms."""
        case = prepared[group]
        stress, compression, _ = case.function(pose[0], design.beam_column, design.strength_column)
        for number, limit in enumerate(held.limits):
            for entry, link in enumerate(case.links):
                if limit.name == BUCKLING.name:
                    for plane in range(PLANES):
                        share = compression[PLANES * entry + plane] * limit.value
                        yield number, share - ca.exp(held.slack[number])
                elif limit.name == SAFETY_FACTOR.name:
                    material = design.materials[link]
                    assert material is not None
                    for station in range(STRESSES):
                        share = stress[STRESSES * entry + station] * limit.value
                        share = share / material.allowed_stress
                        yield number, ca.log(share) - held.slack[number]

    def evaluate(self, design: DesignValues) -> StrengthResult:
        """Each link's greatest stress and greatest compression."""
        return strength_over(design.arm, design.load_cases, design.poses, design.p, design.search)

    def values(self, result: StrengthResult) -> Mapping[str, float | None]:
        """The least factors of any link."""
        return {SAFETY_FACTOR.name: result.least_safety_factor, BUCKLING.name: result.least_buckling}

    def of_links(self, result: StrengthResult, name: str) -> Mapping[int, float | None]:
        """The factor of each elastic link."""
        return dict(
            zip(result.links, result.safety_factor if name == SAFETY_FACTOR.name else result.buckling, strict=True)
        )

    def unknown(self, result: StrengthResult | None) -> Mapping[str, str]:
        """A safety factor needs a yield strength."""
        if result is not None and result.least_safety_factor is not None:
            return {}
        return {SAFETY_FACTOR.name: "a link's material has no yield strength, or no link has a section"}

    def warnings(self, arm: Arm, result: StrengthResult) -> list[str]:
        """One line for each link that yields, buckles, or bends beyond a tenth of its length."""
        del arm
        lines: list[str] = []
        for index, link in enumerate(result.links):
            factor, buckling = result.safety_factor[index], result.buckling[index]
            name = f"link {link + 1}"
            if result.deflection[index] > LARGEST_DEFLECTION:
                share = result.deflection[index]
                lines.append(
                    f"{name} bends by {share:.3g} of its length: beyond a tenth, linear theory (and so the error "
                    "printed) means nothing"
                )
            if factor is not None and factor < 1.0:
                lines.append(f"{name} yields: {result.stress[index] / 1e6:.4g} MPa, safety factor {factor:.3g}")
            if math.isfinite(buckling) and buckling < 1.0:
                lines.append(f"{name} buckles: the compression is {1.0 / buckling:.3g} times Euler's load")
        return lines

    def worst(self, prepared: tuple[StrengthCase, ...], problem: Asked, design: DesignValues) -> list[Worst]:
        """Each link's greatest stress and greatest compression."""
        del prepared
        result, worst = self.evaluate(design), list[Worst]()
        shared = next((limit for limit in problem.limits if limit.demands and limit.name == SAFETY_FACTOR.name), None)
        for link, factor, place in zip(result.links, result.safety_factor, result.poses, strict=True):
            # A material without a yield strength has no factor; a limit on it asks for one before.
            value = np.inf if factor is None else factor
            value /= 1.0 if shared is None else shared.share_of(design.arm, link)
            worst.append(Worst(SAFETY_FACTOR.name, value, Cut(*place)))
        for factor, place in zip(result.buckling, result.buckling_poses, strict=True):
            worst.append(Worst(BUCKLING.name, factor, Cut(*place)))
        return worst

    def at_pose(
        self, prepared: tuple[StrengthCase, ...], group: int, q: Array, designs: Designs
    ) -> Mapping[str, Array]:
        """The least factors over the links."""
        strength = prepared[group]
        stress, compression, _ = strength.vectorised(q, designs.p, designs.sections)
        greatest = np.reshape(stress, (len(q), len(strength.links), STRESSES)).max(axis=2)
        yields = designs.allowed_stresses[:, list(strength.links)]
        with np.errstate(divide="ignore"):
            pressed = np.maximum(compression.max(axis=1), 0.0)
            buckling = np.where(pressed > 0.0, 1.0 / np.maximum(pressed, 1e-300), np.inf)
        return {
            SAFETY_FACTOR.name: (yields / np.maximum(greatest, 1e-300)).min(axis=1),
            BUCKLING.name: buckling,
        }


STRENGTHS = Strength()
"""The family of both."""

SAFETY_FACTOR = Figure(
    name="safety_factor",
    synonyms=("stress", "strength", "yield", "max_stress", "safety", "factor_of_safety", "fos"),
    title="safety factor",
    senses=(">=",),
    key="min_safety_factor",
    follows=ThroughPoses(STRENGTHS),
    more_is_better=True,
    note="least, against yield",
    needs=("yield_strength",),
    by=("link", "material"),
)
BUCKLING = Figure(
    name="buckling",
    synonyms=("critical_load", "column_buckling", "euler"),
    title="buckling",
    senses=(">=",),
    key="min_buckling",
    follows=ThroughPoses(STRENGTHS),
    more_is_better=True,
    note="least, Euler's load over the compression",
    # Where nothing presses it is infinite, which no axis can show.
    traded=False,
)
