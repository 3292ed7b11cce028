"""Regions of a disc in which a field is at least so large, with smooth edges: what a contour plot fills."""

from __future__ import annotations

import numpy as np

from linkwright.core.sections.numeric import Array

_Key = tuple[int, int]


def regions(x: Array, y: Array, values: Array, spokes: int, level: float) -> list[Array]:
    """Closed rings (N, 2) around where a field is at least `level`, straight between samples; holes run the other way.

    The samples lie on circles about one middle, `spokes` on each, counterclockwise and from the inside out.
    Those of the first circle are the middle.
    """
    inside = values >= level
    follows: dict[_Key, _Key] = {}

    def crossing(one: int, other: int) -> _Key:
        return (min(one, other), max(one, other))

    def edge(one: int, other: int) -> tuple[_Key, _Key] | None:
        """The part of the outer edge that is inside."""
        ends = [(k, k) if inside[k] else crossing(one, other) for k in (one, other)]
        return (ends[0], ends[1]) if inside[one] or inside[other] else None

    count = len(values) // spokes
    for ring in range(count - 1):
        for spoke in range(spokes):
            beside = (spoke + 1) % spokes
            b, c = (ring + 1) * spokes + spoke, (ring + 1) * spokes + beside
            a, d = (ring * spokes + spoke, ring * spokes + beside) if ring else (0, 0)
            for corners in ((a, b, c), (a, c, d)) if ring else ((a, b, c),):
                sides = list(zip(corners, (*corners[1:], corners[0]), strict=True))
                leaving = [crossing(*side) for side in sides if inside[side[0]] and not inside[side[1]]]
                entering = [crossing(*side) for side in sides if inside[side[1]] and not inside[side[0]]]
                follows.update(zip(leaving, entering, strict=True))
    for spoke in range(spokes):
        kept = edge((count - 1) * spokes + spoke, (count - 1) * spokes + (spoke + 1) % spokes)
        follows.update([kept] if kept is not None else [])

    def place(key: _Key) -> tuple[float, float]:
        one, other = key
        share = 0.0 if one == other else float((level - values[one]) / (values[other] - values[one]))
        return float(x[one] + share * (x[other] - x[one])), float(y[one] + share * (y[other] - y[one]))

    rings: list[Array] = []
    while follows:
        start, here = follows.popitem()
        ring_of = [start]
        while here != start:
            ring_of.append(here)
            here = follows.pop(here)
        rings.append(np.array([place(key) for key in ring_of]))
    return rings
