"""Figures in which a new design is worse than the given arm: all that can be limited, and bending out of the plane."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from linkwright.core.arm.evaluation import Evaluation
from linkwright.core.arm.figures import Figure, OfKinds
from linkwright.core.arm.figures.tip_stiffness import sideways_rigidities

UNCHANGED = 5e-4
"""Figures that differ by less (relative) count as the same: what four digits still show."""
MUCH_LESS = 0.5
"""A stiffness across the plane below this share of what it was is reported in words."""


@dataclass(frozen=True)
class Worse:
    """A figure that became worse, and its values (SI) of the arm as given and of the design."""

    figure: Figure
    before: float
    after: float


def worse_figures(figures: Mapping[str, Figure], before: Evaluation, after: Evaluation) -> tuple[Worse, ...]:
    """The figures known of both that are worse after than before, each by its sense of better."""
    results: list[Worse] = []
    for figure in figures.values():
        if isinstance(figure.follows, OfKinds):
            continue  # more of them are no worse where nobody counts them
        one, other = figure.value(before), figure.value(after)
        if one is not None and other is not None and _lost(one, other, more_is_better=figure.more_is_better):
            results.append(Worse(figure, one, other))
    return tuple(results)


def _lost(before: float, after: float, *, more_is_better: bool) -> bool:
    loss = before - after if more_is_better else after - before
    finite = [abs(value) for value in (before, after) if math.isfinite(value)]
    return loss > UNCHANGED * max(finite, default=0.0)


def softened_links(before: Evaluation, after: Evaluation) -> tuple[tuple[int, float], ...]:
    """The links (from 0) of a planar arm that bend across its plane much more easily than before, each with its
    flexural rigidity that way over what it was."""
    if before.sideways is None or after.sideways is None:
        return ()
    pairs = zip(sideways_rigidities(before.arm), sideways_rigidities(after.arm), strict=True)
    shares = (other / one if one and other else math.inf for one, other in pairs)
    return tuple((link, share) for link, share in enumerate(shares) if share < MUCH_LESS)
