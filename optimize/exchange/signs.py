"""Whether all terms of an error have one sign, so that it is a posynomial of what a design gives its links.

At a pose the error vector is a sum of terms: a constant, a link's weight, a link's flexibility (the reciprocal of a
rigidity), or the product of one of each. Where no two terms point against each other, the square of its length has no
negative coefficient in weights and flexibilities: with sections whose properties are monomials of their dimensions it
is then convex in the logarithms (Boyd, Kim, Vandenberghe & Hassibi, A tutorial on geometric programming, Optim. Eng. 8
(2007) 67-127). Where terms cancel it may have several minima, and pass through zero between them.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from linkwright.core.arm.errors.model import BEAM_FIELDS, ErrorModel
from linkwright.core.sections.numeric import Array

from .binding_poses import ErrorCut

_WEIGHT = BEAM_FIELDS.index("mass_per_length")
_GROWTH = BEAM_FIELDS.index("thermal_expansion")
_RIGIDITIES = tuple(k for k, name in enumerate(BEAM_FIELDS) if name.endswith("_rigidity") or "_rigidity_" in name)
_NONE = 1e-9
"""A term below this share of the largest counts as none."""
_FARTHEST = 1e-6
"""How far (relative) the sum of the terms may be from the error that they are the terms of."""


def one_signed(model: ErrorModel, cuts: Sequence[ErrorCut], p: Array, *, growth: bool = False) -> bool:
    """Whether no two terms of the error point against each other at any of the poses; `p` is a design's beam values,
    at which the terms are measured. With `growth` what each link grows by is a term of its own, for materials that
    grow by more or less."""
    return all(_agree(_terms(model, cut, p, growth=growth)) for cut in cuts)


def _agree(terms: Array | None) -> bool:
    if terms is None:
        return False
    sizes = np.sqrt((terms * terms).sum(axis=1))
    terms = terms[sizes > _NONE * sizes.max(initial=0.0)]
    products = terms @ terms.T
    return bool(products.min(initial=0.0) >= -_NONE * products.max(initial=0.0))


def _terms(model: ErrorModel, cut: ErrorCut, p: Array, *, growth: bool) -> Array | None:
    """The terms (N, 3) of a pose's error; None where it is no such sum, be it in another zone of a drive."""
    if model.cases[cut.load_case].zones:
        return None
    size, width = model.arm.size, len(BEAM_FIELDS)
    own = p.reshape(size, width)
    weights = [(link, _WEIGHT) for link in range(size) if own[link, _WEIGHT] != 0.0]
    soft = [(link, k) for link in range(size) for k in _RIGIDITIES if own[link, k] != 0.0]
    grown = [(link, _GROWTH) for link in range(size) if growth and own[link, _GROWTH] != 0.0]
    bare = own.copy()
    for link, k in (*weights, *grown):
        bare[link, k] = 0.0
    for link, k in soft:
        bare[link, k] = np.copysign(1e300, own[link, k])

    def error(*present: tuple[int, int]) -> Array:
        design = bare.copy()
        for place in present:
            design[place] = own[place]
        return _vector(model, cut, design.ravel())

    still = error()
    heavy = {weight: error(weight) - still for weight in weights}
    bent = {each: error(each) - still for each in soft}
    both = [error(weight, each) - still - heavy[weight] - bent[each] for weight in weights for each in soft]
    longer = [error(each) - still for each in grown]
    terms = np.array([still, *heavy.values(), *bent.values(), *both, *longer])
    whole = _vector(model, cut, p)
    largest = float(np.abs(terms).sum())
    if not np.all(np.isfinite(terms)) or np.abs(terms.sum(axis=0) - whole).max() > _FARTHEST * largest:
        return None
    return terms


def _vector(model: ErrorModel, cut: ErrorCut, p: Array) -> Array:
    arrays = model.cases[cut.load_case].arrays(np.array([cut.q]), p)
    play = np.array(cut.signs) @ arrays.intervals[0] if len(cut.signs) else 0.0
    return arrays.vector[0] + np.array(cut.shift) + play
