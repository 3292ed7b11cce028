"""Combinations of the stiffness zones in which the drives can be: within each, their wind-up is linear in the loads."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from linkwright.core.arm.chain.chain import Zones
from linkwright.core.arm.effects.functions import wound_up
from linkwright.core.sections.numeric import Array


@dataclass(frozen=True)
class ZoneCombination:
    """The wind-up of drive k is `weights[2k]` times its load over its first stiffness, and `weights[2k + 1]` times what
    it winds up by in its whole first zone, while its load (in parts of a size) is between `least[k]` and `most[k]`.
    `exact`: no bound about the curve, but the curve itself.
    """

    weights: tuple[float, ...]
    least: tuple[float, ...]
    most: tuple[float, ...]
    exact: bool = True


def zone_combinations(zones: Sequence[Zones], greatest: Array, size: float, most: int) -> list[ZoneCombination]:
    """The combinations of `zones` in which drives can be, under loads that none exceeds (`greatest`, N*m), in parts of
    `size`; where there are more than `most`, the ends of a band about the curves of some, which are a bound."""
    by_drive = [_zones_of(zone, float(load), size) for zone, load in zip(zones, greatest, strict=True)]
    while math.prod(len(item) for item in by_drive) > most:
        longest = max(range(len(by_drive)), key=lambda k: len(by_drive[k]))
        if len(by_drive[longest]) <= 2:
            break
        by_drive[longest] = _band(zones[longest], float(greatest[longest]))
    return [
        ZoneCombination(
            tuple(itertools.chain.from_iterable(item.weights for item in pick)),
            tuple(item.least[0] for item in pick),
            tuple(item.most[0] for item in pick),
            all(item.exact for item in pick),
        )
        for pick in itertools.product(*by_drive)
    ]


def _zones_of(zones: Zones, greatest: float, size: float) -> list[ZoneCombination]:
    """The zones of one drive that its load can reach, either way."""
    first_end, first = zones[0]
    combinations = [ZoneCombination((1.0, 0.0), (-first_end / size,), (first_end / size,))]
    for (start, _), (end, stiffness) in itertools.pairwise(zones):
        if start >= greatest:
            break
        slope = first / stiffness
        rest = (float(wound_up(start, zones)) - start / stiffness) * first / first_end
        combinations.append(ZoneCombination((slope, rest), (start / size,), (end / size,)))
        combinations.append(ZoneCombination((slope, -rest), (-end / size,), (-start / size,)))
    return combinations


def _band(zones: Zones, greatest: float) -> list[ZoneCombination]:
    """The ends of the narrowest band about a straight line that holds the whole curve up to the greatest load."""
    first_end, first = zones[0]
    loads = np.array([*(end for end, _ in zones if end < greatest), greatest])
    turned = np.array([float(wound_up(load, zones)) for load in loads])
    slopes = np.linspace((turned / loads).min(), (turned / loads).max(), 201)
    widths = np.abs(turned[None] - slopes[:, None] * loads[None]).max(axis=1)
    best = int(np.argmin(widths))
    away = float(widths[best]) * (1.0 + 1e-12) * first / first_end
    slope = float(slopes[best]) * first
    return [ZoneCombination((slope, side * away), (-math.inf,), (math.inf,), exact=False) for side in (-1.0, 1.0)]
