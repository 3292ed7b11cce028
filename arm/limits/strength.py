"""How near a link is to yielding, buckling, or bending beyond what linear theory can say.

Stress: normal stress of axial force and of bending in both planes, added up at the corner where they meet (exact for
bending in one plane, safe for round sections bent in two), with torsional shear by von Mises. Transverse shear
vanishes at the fibre where bending is largest and is left out. Buckling: each link as an Euler column fixed at its
joint and free at its end (effective length 2 L; Gere & Goodno, Mechanics of Materials, columns), under the largest
compression along it. Deflection: a link's own bending against a tenth of its length, where linear theory ends.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from linkwright.core.arm.chain.beam import Station
from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.chain.kinematics import parts
from linkwright.core.arm.chain.statics import LinkState, PoseState, solve
from linkwright.core.arm.chain.vectors import Scalar, Vector, add, cross, dot, plus, scale, times
from linkwright.core.arm.compiled.expressions import Expressions
from linkwright.core.arm.effects.elastic.link_bending import bent_end, in_both_planes
from linkwright.core.arm.errors.model import beam_symbols, symbolic_beams
from linkwright.core.arm.errors.structure import by_structure
from linkwright.core.sections.numeric import Array
from linkwright.core.sections.symbols import column_of_symbols

if TYPE_CHECKING:
    from linkwright.core.sections.properties import SectionProperties


STRENGTH_FIELDS = ("area", "section_modulus_y", "section_modulus_z", "torsion_modulus")
"""The order in which `strength_values` lists each link's section."""
STATIONS = (0.0, 0.25, 0.5, 0.75, 1.0)
"""Where along a link its stress is looked at, as a share of its length from its joint."""
LARGEST_DEFLECTION = 0.1
"""A link's own bending beyond this share of its length is outside linear theory."""


@dataclass(frozen=True)
class StrengthCase(Expressions):
    """Stress, compression and deflection under one load case, as functions of poses.

    From (q, p, s) to: equivalent stresses (Pa; link after link, each at `STATIONS`), the share of Euler's
    load that presses each link (negative in tension), and each link's own deflection over its length. Rigid links are
    left out: `links` numbers those that are listed.
    """

    links: tuple[int, ...]


def strength_values(sections: Sequence[SectionProperties | None]) -> Array:
    """Each link's area and moduli as one row (4 per link, in the order of `STRENGTH_FIELDS`); 1 where rigid."""
    rows = [
        [1.0] * 4 if section is None else [float(getattr(section, f)) for f in STRENGTH_FIELDS] for section in sections
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
    stress = [each for i in links for each in _stresses(state.links[i], _entries(s, i))]
    compression = [_compression(state, i) for i in links]
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
        own = [value * ratio for value, ratio in zip(section, _ratios(at), strict=True)]
        rest = 1.0 - at.share
        beyond = scale(at.weight_beyond, link.weight)
        # The lever of the weight beyond is its moment over it, here as a share of the rest of the link.
        half = scale(at.moment_beyond / rest if rest > 0.0 else 0.0, link.weight)
        stress = _stress_of(link, own, times(rest, link.beam.length), beyond, half)
        nearest = min(range(len(STATIONS)), key=lambda k: abs(STATIONS[k] - at.share))
        groups[nearest] = stress if groups[nearest] is None else ca.fmax(groups[nearest], stress)
    return groups


def _ratios(at: Station) -> tuple[float, ...]:
    """In the order of `STRENGTH_FIELDS`."""
    return tuple(getattr(at, name) for name in STRENGTH_FIELDS)


def _stress_of(link: LinkState, section: Sequence[Any], rest: Scalar, beyond: Vector, half: Vector) -> Scalar:
    """The stress a distance `rest` (m) from the far end; `beyond` is the weight from there on, and `half` what at the
    far end has its moment."""
    area, modulus_y, modulus_z, torsion_modulus = section
    force: Vector = add(link.force, beyond)
    moment = add(link.moment, cross(scale(rest, link.along), add(link.force, half)))
    axial = _magnitude(dot(force, link.along)) / area
    in_height, in_width = dot(moment, link.width), times(-1.0, dot(moment, link.height))
    if not (isinstance(link.beam.flexural_rigidity_coupling, float) and link.beam.flexural_rigidity_coupling == 0.0):
        # The moments that would bend a symmetric section as much as these bend this one.
        curved = in_both_planes(link, in_height, in_width)
        in_height = times(curved[0], link.beam.flexural_rigidity_height)
        in_width = times(curved[1], link.beam.flexural_rigidity_width)
    bending = plus(_magnitude(in_height) / modulus_y, _magnitude(in_width) / modulus_z)
    shear = dot(link.moment, link.along) / torsion_modulus
    normal = plus(axial, bending)
    return ca.sqrt(normal * normal + 3.0 * shear * shear + 1e-6)


def _compression(state: PoseState, index: int) -> Scalar:
    link = state.links[index]
    pressing = times(-1.0, dot(link.base_force, link.along))
    length = link.beam.length
    in_height, in_width = link.beam.flexural_rigidity_height, link.beam.flexural_rigidity_width
    assert in_height is not None
    assert in_width is not None
    taper = link.beam.taper
    weaker = ca.fmin(times(taper.column_height, in_height), times(taper.column_width, in_width))
    return pressing * (4.0 / math.pi**2) * length * length / weaker


def _deflection(link: LinkState) -> Scalar:
    first, second = bent_end(link)
    # A link without length (a wrist's, in Denavit-Hartenberg form) does not bend; it must not divide by zero either.
    length = ca.fmax(ca.SX(link.beam.length), 1e-9)
    return ca.sqrt(ca.SX(plus(times(first, first), times(second, second))) + 1e-24) / length


@dataclass(frozen=True)
class StrengthResult:
    """The worst over poses and load cases, link by link (numbered from 0).

    `stress` in Pa; `safety_factor` is yield strength over stress, None where a material has no yield strength;
    `buckling` is Euler's load over the compression, infinite where nothing presses; `deflection` is each link's own
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
    stress = np.stack([out[0].reshape(len(q), count, len(STATIONS)).max(axis=2) for out in results])
    compression = np.stack([out[1] for out in results])
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
