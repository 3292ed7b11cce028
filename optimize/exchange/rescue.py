"""A finite problem that the solver gave up on: tried again more gently, and called infeasible only where it is.

Where terms of either sign cancel, the error passes through zero and its logarithm has a pit that IPOPT falls through:
with a floor as large as the error (`optimize.exchange.rows`) it is smooth, and the floor follows the error down. If
that fails too, the limits give way as little as they must: a point found so is a start, and only limits that had to
give way mean that there is no design near.
"""

from __future__ import annotations

from dataclasses import replace

from linkwright.core.sections.numeric import Array

from .binding_poses import Pool
from .program import Ask, Program, Solution

LEAST_ERROR = 1e-9
"""An error (m) below this counts as none."""
_SHRINKINGS = 4
_SMALLER = 0.05
_KEPT = 1e-6
"""A limit whose logarithm gives way by no more than this is kept."""


def solved(program: Program, start: Array, materials: Array, pool: Pool, ask: Ask, *, error: float = 1e-3) -> Solution:
    """The best design for a pool as `Program.solve` finds it, with gentler trials where that fails.

    A solution that is not `solved` says by `infeasible` whether limits would have to give way.
    """
    first = program.solve(start, materials, pool, ask, error=error)
    if first.solved or first.infeasible:
        return first
    gentle = _smoothly(program, start, materials, pool, ask)
    if gentle is not None:
        return gentle
    relaxed = program.solve(start, materials, pool, replace(ask, push=None, relax=True))
    if not relaxed.solved:
        return first
    if breaks_limits(relaxed):
        return replace(first, infeasible=True)
    gentle = _smoothly(program, relaxed.x, materials, pool, ask)
    return first if gentle is None else gentle


def breaks_limits(relaxed: Solution) -> bool:
    """Whether a solution in which limits give way as little as they can breaks one."""
    return relaxed.solved and any(abs(slack) > _KEPT for slack in relaxed.slacks)


def _smoothly(program: Program, start: Array, materials: Array, pool: Pool, ask: Ask) -> Solution | None:
    """With a floor that follows the error down, until it no longer hides it."""
    scale = program.greatest_error(start, materials, pool)
    best: Solution | None = None
    for _ in range(_SHRINKINGS):
        if scale < LEAST_ERROR:
            break
        solution = program.solve(start, materials, pool, replace(ask, floor=scale), error=scale)
        if not solution.solved:
            break
        best, start = solution, solution.x
        if solution.error - program.fixed_error > _SMALLER * scale:
            break
        scale = max(solution.error - program.fixed_error, _SMALLER * scale)
    return best
