"""The best combination looked at more closely: other starts, other lengths, and designs it must not be worse than."""

from __future__ import annotations

import math

import numpy as np

from linkwright.core.arm.figures import OfDesign, Totals, excess
from linkwright.core.arm.worst.workspace import Unreachable
from linkwright.core.optimize.exchange.design import (
    LENGTH,
    TAPER,
    DesignSpace,
    arm_of,
    design_space,
    ladder,
    starting_points,
)
from linkwright.core.optimize.exchange.exchange import badness_of, first_pool
from linkwright.core.optimize.exchange.other_lengths import other_lengths, share_unreached, with_lengths
from linkwright.core.optimize.exchange.program import Ask, Program
from linkwright.core.optimize.exchange.rescue import solved
from linkwright.core.optimize.exchange.totals import carried_mass
from linkwright.core.sections.numeric import Array

from .chooser import Best, Chooser
from .picks import Combination

_FINAL_STARTS = 5
_RUNGS = 24
"""Steps from the lightest sections to the heaviest at which the error is looked at where it may have several minima."""
_NEAR = 0.3
"""How far a descent into one of them may lead, in each of the optimiser's numbers (a third more or less, of a size)."""
_HELD, _HOPEFUL = 0.05, 1.1
"""How far (in its logarithm) a length may move while sizes are found for it; what must not be worse by more then."""
_AT_OTHER_LENGTHS = 6
"""So many combinations are tried with other lengths."""


def polish(chooser: Chooser) -> None:
    """Further starts for the best combination: a better local optimum replaces it."""
    if chooser.best is None:
        return
    pick, space, materials, _, _, _ = chooser.best
    start_count = _FINAL_STARTS if len(space.variables) > 1 else 1
    for number, start in enumerate(starting_points(space, materials, start_count)):
        if chooser.progress is not None:
            chooser.progress(number, start_count, "solving from further starts")
        chooser.finish(pick, start)
    if not chooser.one_signed():
        _descend(chooser, pick, space, materials)


def try_other_lengths(chooser: Chooser) -> None:
    """Descents from other lengths, where those are free and the places to reach stay where they are, each with its
    binding poses, by the best combination and those that came near it."""
    if chooser.best is None:
        return
    pick, space, _, _, exchanged, _ = chooser.best
    near = [item for item in _by_objective(chooser)[:_AT_OTHER_LENGTHS] if item != pick]
    starts = other_lengths(chooser.context, space, exchanged.x, pick.materials)
    for number, start in enumerate(starts):
        if chooser.progress is not None:
            chooser.progress(number, len(starts), "solving from other lengths")
        best, pool, noted = chooser.best, chooser.pool, dict(chooser.candidates)
        try:
            chooser.pool = first_pool(chooser.context, space, start, pick.materials)
        except Unreachable:
            continue
        lengths = space.sections_and_lengths([float(value) for value in start])[1]
        for each in (pick, *near):
            begin = start
            if each.shapes != pick.shapes:
                other = chooser.exchange(each.shapes).space
                begin = starting_points(other, chooser.materials(each), 1)[0]
                begin = with_lengths(other, begin, lengths)
            _finish_near_lengths(chooser, each, begin)
        if chooser.best is best or _reaches_less(chooser, chooser.best, best):
            chooser.best, chooser.pool, chooser.candidates = best, pool, noted


def _reaches_less(chooser: Chooser, one: Best, other: Best) -> bool:
    """Whether a design reaches less of a box or a path than another one does."""
    shares = [share_unreached(chooser.context, item[1], item[4].x, item[0].materials) for item in (one, other)]
    return shares[0] > shares[1]


def _finish_near_lengths(chooser: Chooser, pick: Combination, start: Array) -> None:
    """Sizes for the lengths of a start first, then lengths not far from those, then any: a descent from sizes that
    belong to other lengths leads back to these."""
    assert chooser.pool is not None
    exchange, materials = chooser.exchange(pick.shapes), chooser.materials(pick)
    program = exchange.program(chooser.pool)
    lengths = np.array([variable.name == LENGTH for variable in exchange.space.variables])
    aim = chooser.context.aim
    near = Ask(chooser.context.problem.limits, aim, within=(start, np.where(lengths, _HELD, np.inf)))
    held = solved(program, start, materials, chooser.pool, near)
    if not held.solved:
        return
    hopeful = _HOPEFUL * chooser.objective
    if exchange.objective(program, held, materials, aim) < hopeful:
        done = chooser.finish(pick, held.x, within=np.where(lengths, _NEAR, np.inf), above=hopeful)
        chooser.finish(pick, held.x if done is None else done.x)


def no_worse_than(chooser: Chooser, pick: Combination, x: Array) -> None:
    """Hold the best design against another that may be kept as it is: descents from there that stay near it."""
    space = design_space(chooser.context.problem, pick.shapes)
    materials = chooser.materials(pick)
    exchange = chooser.exchange(pick.shapes)
    chooser.pool = chooser.pool or first_pool(chooser.context, space, x, pick.materials)
    program = exchange.program(chooser.pool)
    known = _badness(chooser, pick, space, program, x, materials)
    if known >= chooser.objective or not _light_enough(chooser, program, x, materials):
        return
    for within in (_NEAR, 0.1 * _NEAR, 1e-4):
        chooser.finish(pick, x, within=within)
        if chooser.objective <= known * (1.0 + 1e-6):
            return


def hold_against_uniform(chooser: Chooser) -> None:
    """Hold the best design against the best with the same shapes and materials and uniform links, where those are
    allowed, so that tapers never make an answer worse."""
    allowed = [link_ranges.taper for link_ranges in chooser.context.problem.ranges if link_ranges.taper is not None]
    if (
        chooser.best is None
        or chooser.pool is None
        or not allowed
        or not all(low <= 1.0 <= high for low, high in allowed)
    ):
        return
    pick, space, materials, _, _, _ = chooser.best
    start = starting_points(space, materials, 1)[0]
    tapers = np.array([variable.name == TAPER for variable in space.variables])
    exchange = chooser.exchange(pick.shapes)
    start = np.where(tapers, 0.0, start)
    plain = exchange.run(materials, pick.materials, chooser.pool, start, within=np.where(tapers, 0.0, np.inf))
    if plain is not None:
        no_worse_than(chooser, pick, plain.x)


def _by_objective(chooser: Chooser) -> list[Combination]:
    """The combinations that have an objective or a bound, best first."""
    values = {
        pick: candidate.objective for pick, candidate in chooser.candidates.items() if candidate.objective is not None
    }
    return sorted(values, key=lambda pick: values[pick])


def _descend(chooser: Chooser, pick: Combination, space: DesignSpace, materials: Array) -> None:
    """Where terms cancel, the error has several minima: into each that shows between light and heavy sections."""
    rungs = ladder(space, materials, _RUNGS)
    errors = [_scanned(chooser, pick, space, rung) for rung in rungs]
    for index, rung in enumerate(rungs):
        if errors[index] <= min(errors[max(index - 1, 0) : index + 2]):
            chooser.finish(pick, rung, within=_NEAR)


def _scanned(chooser: Chooser, pick: Combination, space: DesignSpace, x: Array) -> float:
    """The worst error at poses spread over the workspace: enough to see where it has a minimum."""
    try:
        return chooser.context.search.scanned(chooser.beams(pick, space, x))
    except Unreachable:
        return math.inf


def _badness(
    chooser: Chooser, pick: Combination, space: DesignSpace, program: Program, x: Array, materials: Array
) -> float:
    """The badness of the objective of any design; infinite where it does not reach its workspace."""
    try:
        return badness_of(chooser.context, program, x, arm_of(space, x, pick.materials), materials)
    except Unreachable:
        return math.inf


def _light_enough(chooser: Chooser, program: Program, x: Array, materials: Array) -> bool:
    """Whether a design keeps the limits that cost nothing to look at."""
    carried = carried_mass(chooser.context.problem) + program.space.hung(x)
    totals = Totals(*program.mass_cost_reach(x, materials), carried)
    return all(
        excess(limit, float(limit.figure.follows.value(totals))) <= 1e-6
        for limit in chooser.context.problem.limits
        if isinstance(limit.figure.follows, OfDesign)
    )
