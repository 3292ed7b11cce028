"""In which order visits are made: payloads in alternating blocks, returns to one pose, nothing that goes with time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from linkwright.core.sections.numeric import Array

from .plan_request import Asked

Rows = NDArray[np.int64]
_RETURNS, _BESIDE = 3, 4
"""Visits to one pose (at the beginning, in the middle, at the end), and how many times as many are planned at least."""


def returns_of(asked: Asked) -> int:
    """How many of the visits asked for go to the one pose that is returned to; none where there are few."""
    count = 2 * len(asked.payloads) if len(asked.payloads) > 1 else _RETURNS
    return count if asked.poses >= _BESIDE * count else 0


def in_order(chosen: Sequence[int], back: Sequence[int], payload: Array, q: Array, sides: Array, asked: Asked) -> Rows:
    """The visits in the order in which to make them, as numbers of what was tried.

    `chosen` and `back` (the one pose to return to, under each payload; none: no returns) are such numbers, `payload`
    (V,), `q` (V, n), `sides` (V, n) of all tried. With several payloads the blocks go through all of them twice, each
    beginning with the return. Of many random orders that one is taken whose time goes least with any joint or side.
    """
    rng = np.random.default_rng(asked.seed)
    several = len(asked.payloads) > 1
    by_payload = [np.array([v for v in chosen if payload[v] == mass], dtype=np.int64) for mass in asked.payloads]
    best, least = np.array(chosen, dtype=np.int64), np.inf
    for _ in range(400):
        parts: list[list[int]] = [[] for _ in range(2 * len(by_payload))]
        for k, visits in enumerate(by_payload):
            mixed = rng.permutation(visits).tolist()
            parts[k], parts[k + len(by_payload)] = mixed[: len(mixed) // 2], mixed[len(mixed) // 2 :]
        rows: list[int] = []
        for k, part in enumerate(parts):
            rows += [back[k % len(by_payload)], *part] if back else part
        if back and not several:
            rows.append(back[0])
        made = np.array(rows, dtype=np.int64)
        duration = with_time(q[made], sides[made])
        if duration < least:
            best, least = made, duration
    return best


def with_time(q: Array, sides: Array) -> float:
    """The largest correlation of the order with any joint's coordinate (N, n) or side (N, n), 0 to 1."""
    both = np.concatenate([q, sides], axis=1)
    both = both - both.mean(axis=0)
    size = np.linalg.norm(both, axis=0)
    moving = size > 1e-9 * max(float(size.max(initial=0.0)), 1e-300)
    time = np.arange(len(q)) - 0.5 * (len(q) - 1)
    length = float(np.linalg.norm(time))
    if not moving.any() or length == 0.0:
        return 0.0
    return float(np.abs(time @ both[:, moving] / (size[moving] * length)).max())
