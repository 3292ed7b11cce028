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

from linkwright.core.arm.errors.model import ErrorModel
from linkwright.core.optimize.exchange.binding_poses import ErrorCut
from linkwright.core.sections.numeric import Array

from .pose_products import features_of, vectors_of
from .products import EXPANSION

_NONE = 1e-9
"""A term below this share of the largest counts as none."""


def one_signed(model: ErrorModel, cuts: Sequence[ErrorCut], p: Array, *, growth: bool = False) -> bool:
    """Whether no two terms of the error point against each other at any of the poses; `p` is a design's beam values,
    at which the terms are measured. With `growth` what each link grows by is a separate term, for materials that
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
