"""A finite problem that the solver gave up on: tried again more gently, and called infeasible only where it is.

Where terms of either sign cancel, the error passes through zero and its logarithm has a pit that IPOPT falls through:
with a floor as large as the error (`optimize.exchange.rows`) it is smooth, and the floor follows the error down. If
that fails too, the limits give way as little as they must: a point found so is a start, and only limits that had to
give way mean that there is no design near.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from linkwright.core.optimize.problem import Limit
from linkwright.core.sections.numeric import Array

from .binding_poses import Pool
from .program import TURN, Program, Solution

LEAST_ERROR = 1e-9
"""An error (m) below this counts as none."""
_SHRINKINGS = 4
_SMALLER = 0.05
_KEPT = 1e-6
"""A limit whose logarithm gives way by no more than this is kept."""


def solved(
    program: Program,
    start: Array,
    materials: Array,
    pool: Pool,
    *,
    error: float = 1e-3,
    turn: float = TURN,
    limits: Sequence[Limit] | None = None,
    push: int | None = None,
    within: tuple[Array, float | Array] | None = None,
) -> Solution:
    """The best design for a pool as `Program.solve` finds it, with gentler trials where that fails.

    A solution that is not `solved` says by `infeasible` whether limits would have to give way.
    """
    first = program.solve(start, materials, pool, error=error, turn=turn, limits=limits, push=push, within=within)
    if first.solved:
        return first
    gentle = _smoothly(program, start, materials, pool, turn, limits, push, within)
    if gentle is not None:
        return gentle
    relaxed = program.solve(start, materials, pool, relax=True, turn=turn, limits=limits, within=within)
    if not relaxed.solved:
        return first
    if any(abs(slack) > _KEPT for slack in relaxed.slacks):
        return replace(first, infeasible=True)
    gentle = _smoothly(program, relaxed.x, materials, pool, turn, limits, push, within)
    return first if gentle is None else gentle


def _smoothly(
    program: Program,
    start: Array,
    materials: Array,
    pool: Pool,
    turn: float,
    limits: Sequence[Limit] | None,
    push: int | None,
    within: tuple[Array, float | Array] | None,
) -> Solution | None:
    """With a floor that follows the error down, until it no longer hides it."""
    scale = program.greatest_error(start, materials, pool)
    best: Solution | None = None
    for _ in range(_SHRINKINGS):
        if scale < LEAST_ERROR:
            break
        found = program.solve(
            start, materials, pool, error=scale, turn=turn, limits=limits, push=push, floor=scale, within=within
        )
        if not found.solved:
            break
        best, start = found, found.x
        if found.error - program.fixed_error > _SMALLER * scale:
            break
        scale = max(found.error - program.fixed_error, _SMALLER * scale)
    return best
