"""Errors, stresses, compressions and inertias at a pose as sums of products of what a design gives its links.

The coefficients are those of the models themselves, read off by differences: an error, say, has one factor a weight
and one a flexibility, so that it is measured with each alone and with each pair. What does not come out as such a sum
at a second design has none (None).

At a pose the error vector is a sum of terms: a constant, a link's weight, a link's flexibility (the reciprocal of a
rigidity), or the product of one of each. Where no two terms point against each other, the square of its length has no
negative coefficient in weights and flexibilities: with sections whose properties are monomials of their dimensions it
is then convex in the logarithms (Boyd, Kim, Vandenberghe & Hassibi, A tutorial on geometric programming, Optim. Eng. 8
(2007) 67-127). Where terms cancel it may have several minima, and pass through zero between them.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from linkwright.core.arm.chain.beam import Beam
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.errors.model import BEAM_FIELDS, ErrorModel
from linkwright.core.arm.figures import Cut
from linkwright.core.arm.figures.strength import PLANES, STATIONS, STRENGTH_FIELDS, STRESSES, StrengthCase
from linkwright.core.arm.limits.modes import SegmentedArm, work_and_inertia
from linkwright.core.optimize.choice.products import EXPANSION, FEATURES, Power, Products
from linkwright.core.optimize.exchange.binding_poses import ErrorCut
from linkwright.core.sections.numeric import Array

WEIGHT = BEAM_FIELDS.index("mass_per_length")
SOFT: Mapping[int, int] = MappingProxyType(
    {
        BEAM_FIELDS.index(field): FEATURES.index(name)
        for field, name in (
            ("axial_rigidity", "stretching"),
            ("flexural_rigidity_height", "bending_height"),
            ("flexural_rigidity_width", "bending_width"),
            ("torsional_rigidity", "twisting"),
            ("shear_rigidity_height", "shear_height"),
            ("shear_rigidity_width", "shear_width"),
        )
    }
)
"""The rigidities among a link's beam values, and the features that are their reciprocals."""
_GROWTH = BEAM_FIELDS.index("thermal_expansion")
_FEATURE: Mapping[int, int] = MappingProxyType({WEIGHT: 0, _GROWTH: EXPANSION, **SOFT})
_RIGID = 1e300
_CLOSE = 1e-6
"""How far (relative to the sum of the terms' sizes) the sum may be from what it is the sum of."""
_NOTHING = 1e-12
"""A term below this share of the largest is left out."""
_APART = (1.7, 0.6, 1.3, 0.8, 1.9)
"""Factors from a design to another one, at which the sum is tried."""


def features_of(p: Array, size: int) -> Array:
    """The links' features (n, K) for beam values p; 1 where a link has none, and of stress."""
    values = p.reshape(size, len(BEAM_FIELDS))
    features = np.ones((size, len(FEATURES)))
    for link in range(size):
        if values[link, WEIGHT] != 0.0:
            features[link, 0] = values[link, WEIGHT]
        for place, feature in SOFT.items():
            if values[link, place] != 0.0:
                features[link, feature] = 1.0 / values[link, place]
    features[:, EXPANSION] = values[:, _GROWTH]
    return features


@dataclass(frozen=True)
class Vectors:
    """A sum of products whose coefficients (3,) are vectors, by their factors; the constant has none."""

    terms: Mapping[Power, Array]

    def value(self, features: Array) -> Array:
        """Its value (3,) for the links' features (n, K)."""
        vector = np.zeros(3)
        for power, c in self.terms.items():
            vector += c * float(np.prod([features[place] for place in power]))
        return vector


def error_vectors(model: ErrorModel, cut: ErrorCut, p: Array) -> Vectors | None:
    """The error (m) at a pose as a sum of products for any materials, read off about a design p; None where it is none,
    or counts from a calibration at another temperature: what materials were like there is no feature."""
    since = model.cases[cut.load_case].load.relative_to
    if since is not None and since.temperature not in (None, model.arm.temperature):
        return None
    return vectors_of(model, cut, p)


def vectors_of(model: ErrorModel, cut: ErrorCut, p: Array) -> Vectors | None:
    """The error (m) at a pose as a sum of products, read off about a design p; None where it is no such sum, be it in
    another zone of a drive."""
    size = model.arm.size
    case = model.cases[cut.load_case]
    if case.zones or lopsided(model.arm, planar=model.planar):
        return None
    values = p.reshape(size, len(BEAM_FIELDS))
    weights = [(link, WEIGHT) for link in range(size) if values[link, WEIGHT] != 0.0]
    soft = [(link, k) for link in range(size) for k in SOFT if values[link, k] != 0.0]
    growing = [(link, _GROWTH) for link in range(size) if values[link, _GROWTH] != 0.0]

    def vectors(designs: Array) -> Array:
        arrays = case.arrays(np.tile(cut.q, (len(designs), 1)), designs)
        play = np.einsum("k,nki->ni", np.array(cut.signs), arrays.intervals) if len(cut.signs) else 0.0
        return arrays.vector + np.array(cut.shift) + play

    present = [(), *((weight,) for weight in (*weights, *soft, *growing)), *itertools.product(weights, soft)]
    designs = designs_with(values, (*weights, *growing), soft, present)
    for number, place in enumerate((*weights, *soft, *growing)):
        designs[-1][place] *= _APART[number % len(_APART)]
    vectors_there = vectors(designs.reshape(len(designs), -1))
    if not np.all(np.isfinite(vectors_there)):
        return None
    features = features_of(p, size)
    terms = _terms(dict(zip(present, vectors_there, strict=False)), features)
    for design, value in zip(designs[-2:], vectors_there[-2:], strict=True):
        there = features_of(design.ravel(), size)
        room = _CLOSE * sum(_sizes(terms, there).values())
        if not np.linalg.norm(Vectors(terms).value(there) - value) <= room:
            return None
    sizes = _sizes(terms, features)
    largest = max(sizes.values(), default=0.0)
    return Vectors({power: c for power, c in terms.items() if not power or sizes[power] > _NOTHING * largest})


def lopsided(arm: Arm, *, planar: bool) -> bool:
    """Whether loads bend a link out of their plane, or twist it from its centroid: what that adds goes with where a
    section's shear centre is too, which is no feature. In a plane only one beside that plane counts."""
    return any(
        link.asymmetry.askew or link.asymmetry.off_width or (link.asymmetry.off_height and not planar)
        for link in arm.links
    )


Place = tuple[int, int]
"""A link, and which of its beam values."""


def designs_with(
    values: Array, none: Sequence[Place], soft: Sequence[Place], present: Sequence[tuple[Place, ...]]
) -> Array:
    """Designs (N + 2, n, B) that have of a design's values `none` and of its flexibilities `soft` only those `present`;
    then twice the design itself."""
    bare = values.copy()
    for place in none:
        bare[place] = 0.0
    for place in soft:
        bare[place] = np.copysign(_RIGID, values[place])
    designs = np.repeat(bare[None], len(present) + 2, axis=0)
    for row, places in zip(designs, present, strict=False):
        for place in places:
            row[place] = values[place]
    designs[-2:] = values
    return designs


def _terms(alone: Mapping[tuple[Place, ...], Array], features: Array) -> dict[Power, Array]:
    """The coefficients of a sum of products, from its values (3,) with nothing, each value alone and each pair."""
    terms: dict[Power, Array] = {}
    for places, value in alone.items():
        term = value.copy()
        if places:
            term -= alone[()]
        if len(places) == 2:
            term -= sum(alone[(place,)] - alone[()] for place in places)
        power = tuple(sorted((link, _FEATURE[k]) for link, k in places))
        terms[power] = term / float(np.prod([features[place] for place in power]))
    return terms


def _sizes(terms: Mapping[Power, Array], features: Array) -> dict[Power, float]:
    """How much each term adds for the links' features."""
    return {power: float(np.linalg.norm(c)) * _size(power, features) for power, c in terms.items()}


def _size(power: Power, features: Array) -> float:
    return float(np.prod([abs(features[place]) for place in power]))


def _agreed(terms: dict[Power, float], trials: Sequence[tuple[Array, float]]) -> Products | None:
    """The sum of the terms that count, where it is what was measured at each of the designs."""
    for features, value in trials:
        sizes = [abs(c) * float(np.prod([abs(features[place]) for place in power])) for power, c in terms.items()]
        if not abs(Products(terms).value(features) - value) <= _CLOSE * sum(sizes):
            return None
    features = trials[0][0]
    sizes = {p: abs(c) * float(np.prod([abs(features[place]) for place in p])) for p, c in terms.items()}
    largest = max(sizes.values(), default=0.0)
    return Products({power: c for power, c in terms.items() if not power or sizes[power] > _NOTHING * largest})


def stress_products(case: StrengthCase, cut: Cut, p: Array) -> dict[tuple[int, int], Products]:
    """For each link's entry and station the share of the yield strength that axial force and bending take, safety left
    out; torsion is left out, and each takes the sign that it has for a design p, so that it is never more."""
    size = len(p) // len(BEAM_FIELDS)
    weights = [k for k in range(size) if p.reshape(size, -1)[k, WEIGHT] != 0.0]
    small = 1e-3

    def forces(designs: Array, counted: int) -> Array:
        sections = np.full((size, len(STRENGTH_FIELDS)), _RIGID)
        sections[:, counted] = 1e-6
        stress, _, _ = case.vectorised(np.tile(cut.q, (len(designs), 1)), designs, sections.ravel())
        return 1e-6 * stress

    designs = np.repeat(p[None], len(weights) + 1, axis=0)
    for number, link in enumerate(weights):
        designs[number + 1, len(BEAM_FIELDS) * link + WEIGHT] *= 1.0 + small
    products: dict[tuple[int, int], Products] = {}
    names = ("stress_axial", "stress_height", "stress_width")
    every = [forces(designs, counted) for counted in range(len(names))]
    for entry, link in enumerate(case.links):
        for station in range(len(STATIONS)):
            terms: dict[Power, float] = {}
            for name, values in zip(names, every, strict=True):
                column = values[:, STRESSES * entry + station]
                factor = (link, FEATURES.index(name))
                slopes = (column[1:] - column[0]) / small
                terms[(factor,)] = float(column[0] - slopes.sum())
                for weight, slope in zip(weights, slopes, strict=True):
                    power = tuple(sorted(((weight, 0), factor)))
                    terms[power] = float(slope) / float(p[len(BEAM_FIELDS) * weight + WEIGHT])
            products[entry, station] = Products(terms)
    return products


def compression_products(case: StrengthCase, cut: Cut, p: Array) -> dict[int, Products]:
    """For each link's entry the share of Euler's load that presses it, in the plane that is weaker for a design p."""
    size = len(p) // len(BEAM_FIELDS)
    values = p.reshape(size, -1)
    weights = [k for k in range(size) if values[k, WEIGHT] != 0.0]
    planes = [BEAM_FIELDS.index(f"flexural_rigidity_{name}") for name in ("height", "width")]
    unit = values.copy()
    unit[:, planes] = 1.0
    designs = np.repeat(unit[None], len(weights) + 1, axis=0)
    designs[:, weights, WEIGHT] = 0.0
    for number, link in enumerate(weights):
        designs[number + 1, link, WEIGHT] = 1.0
    _, shares, _ = case.vectorised(np.tile(cut.q, (len(designs), 1)), designs.reshape(len(designs), -1), _ones(size))
    products: dict[int, Products] = {}
    for entry, link in enumerate(case.links):
        plane = min(range(PLANES), key=lambda k: values[link, planes[k]])
        weaker, pressed = (link, SOFT[planes[plane]]), shares[:, PLANES * entry + plane]
        terms: dict[Power, float] = {(weaker,): float(pressed[0])}
        for number, weight in enumerate(weights):
            terms[tuple(sorted(((weight, 0), weaker)))] = float(pressed[number + 1] - pressed[0])
        products[entry] = Products(terms)
    return products


def _ones(size: int) -> Array:
    return np.ones(size * len(STRENGTH_FIELDS))


def inertia_products(
    arm: Arm, segments: SegmentedArm, cut: Cut, beams: Sequence[Beam], p: Array, frequency: float
) -> tuple[Products, float] | None:
    """(M phi)' F (M phi) omega^2 - phi' M phi for a cut's trial shape (kg m^2), above zero where the frequency (Hz) is
    missed; and phi' M phi of a design p, whose beams are given."""
    if lopsided(arm, planar=False):
        return None
    size = len(beams)
    array = p.reshape(size, len(BEAM_FIELDS))
    weights = [k for k in range(size) if array[k, WEIGHT] != 0.0]
    soft = [(link, k) for link in range(size) for k in SOFT if array[link, k] != 0.0]
    tips = len(segments.ways)
    payloads, shape = cut.more[:tips], cut.more[tips:]
    omega = 2.0 * np.pi * frequency

    def measured(designs: Array) -> tuple[Array, Array]:
        varied: list[Beam] = []
        for k, beam in enumerate(beams):
            values: dict[str, Any] = {
                name: designs[:, k, place] for place, name in enumerate(BEAM_FIELDS) if array[k, place] != 0.0
            }
            varied.append(Beam(**values) if beam.lumped_mass == 0.0 else beam)
        work, inertia = work_and_inertia(arm, segments, cut.q, varied, payloads, shape)
        return omega**2 * np.broadcast_to(work, len(designs)), np.broadcast_to(inertia, len(designs))

    return _inertia_terms(measured, array, weights, soft)


def _inertia_terms(
    measured: Callable[[Array], tuple[Array, Array]],
    given: Array,
    weights: Sequence[int],
    soft: Sequence[tuple[int, int]],
) -> tuple[Products, float] | None:
    size = len(given)
    # Quadratic in the weights for each flexibility: at zero, at one and two of each, at one of each pair.
    steps = [(), *((k,) for k in weights), *((k, k) for k in weights), *itertools.combinations(weights, 2)]
    bare = given.copy()
    bare[weights, WEIGHT] = 0.0
    for place in soft:
        bare[place] = np.copysign(_RIGID, given[place])
    rows: list[Array] = []
    for place in (None, *soft):
        for step in steps:
            row = bare.copy()
            if place is not None:
                row[place] = given[place]
            for link in step:
                row[link, WEIGHT] += given[link, WEIGHT]
            rows.append(row)
    other = given.copy()
    other[weights, WEIGHT] *= np.resize(_APART, len(weights))
    for number, place in enumerate(soft):
        other[place] *= _APART[number % len(_APART)]
    work, inertia = measured(np.array([*rows, given, other]))
    if not np.all(np.isfinite(work)):
        return None
    terms: dict[Power, float] = {}
    features, there = features_of(given.ravel(), size), features_of(other.ravel(), size)

    def add(power: Power, value: float) -> None:
        power = tuple(sorted(power))
        terms[power] = terms.get(power, 0.0) + value / float(np.prod([features[place] for place in power]))

    base = work[: len(steps)]
    for number, place in enumerate((None, *soft)):
        values = dict(zip(steps, work[number * len(steps) : (number + 1) * len(steps)], strict=True))
        if place is not None:
            values = {step: value - base[k] for k, (step, value) in enumerate(values.items())}
        flexible: Power = () if place is None else ((place[0], SOFT[place[1]]),)
        zero = values[()]
        add(flexible, zero)
        for k in weights:
            one, two = values[(k,)] - zero, values[(k, k)] - zero
            add((*flexible, (k, 0)), 2.0 * one - 0.5 * two)
            add((*flexible, (k, 0), (k, 0)), 0.5 * two - one)
        for k, m in itertools.combinations(weights, 2):
            add((*flexible, (k, 0), (m, 0)), values[k, m] - values[(k,)] - values[(m,)] + zero)
    add((), -float(inertia[0]))
    for number, k in enumerate(weights):
        add(((k, 0),), -float(inertia[1 + number] - inertia[0]))
    agreed = _agreed(terms, [(features, float(work[-2] - inertia[-2])), (there, float(work[-1] - inertia[-1]))])
    return None if agreed is None else (agreed, float(inertia[-2]))


__all__ = [
    "Vectors",
    "compression_products",
    "error_vectors",
    "features_of",
    "inertia_products",
    "stress_products",
    "vectors_of",
]


_NONE = 1e-9
"""A term below this share of the largest counts as none."""


def one_signed(model: ErrorModel, cuts: Sequence[ErrorCut], p: Array, *, growth: bool = False) -> bool:
    """Whether no two terms of the error point against each other at any of the poses; `p` is a design's beam values,
    at which the terms are measured. With `growth` what each link grows by is a separate term, for materials that
    grow by more or less."""
    return all(_agree(_error_terms(model, cut, p, growth=growth)) for cut in cuts)


def _agree(terms: Array | None) -> bool:
    if terms is None:
        return False
    sizes = np.sqrt((terms * terms).sum(axis=1))
    terms = terms[sizes > _NONE * sizes.max(initial=0.0)]
    products = terms @ terms.T
    return bool(products.min(initial=0.0) >= -_NONE * products.max(initial=0.0))


def _error_terms(model: ErrorModel, cut: ErrorCut, p: Array, *, growth: bool) -> Array | None:
    """The terms (N, 3) of a pose's error; None where it is no such sum."""
    vectors = vectors_of(model, cut, p)
    if vectors is None:
        return None
    features = features_of(p, model.arm.size)
    still, rest = np.zeros(3), list[Array]()
    for power, c in vectors.terms.items():
        term = c * float(np.prod([features[place] for place in power]))
        if power and (growth or all(k != EXPANSION for _, k in power)):
            rest.append(term)
        else:
            still = still + term
    return np.array([still, *rest])
