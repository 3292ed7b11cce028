"""An optimum moved to sizes that a workshop can get: a grid of sizes or the stock tables, certified anew.

Rounding each size to its nearest neighbour seldom gives the best design, and often breaks a limit. The sizes about the
optimum are lists like any other (`optimize.sizes`): the best of all their combinations is searched for, with a bound on
the rest. Lengths are those beside the optimum's, then others as long as that helps.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any

from linkwright.core.arm.evaluation import Evaluation, evaluate
from linkwright.core.arm.figures import broken
from linkwright.core.arm.worst.workspace import Unreachable
from linkwright.core.executors import Executor
from linkwright.core.optimize.choice.combinations import Progress
from linkwright.core.optimize.exchange.exchange import context_of
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.problem_summary import map_of
from linkwright.core.optimize.result import KeptLimit, NotRounded, OptimizationResult, Rounded
from linkwright.core.optimize.run import Log, optimise
from linkwright.core.optimize.sizes.designs_at_once import Table
from linkwright.core.optimize.sizes.listed_search import SearchOutcome
from linkwright.core.optimize.sizes.options import LinkList, columns_of, keeping
from linkwright.core.optimize.sizes.rows import product
from linkwright.core.optimize.sizes.search import CLOSE, ListSearch
from linkwright.core.sections.section import Section
from linkwright.core.units.quantities import InputError, NoAnswer, format_quantity

from .nearest import NoRounding, nearest_design, why_not
from .options import (
    Option,
    Rounding,
    grid_sections,
    length_choices,
    moved_lengths,
    on_grid,
    stock_options,
    why_no_stock,
)

MOST_DESIGNS = 100_000
"""Among so many the one that breaks the limits least is looked for."""
_REACH = 2
"""Multiples of the step to either side of each dimension."""
_CLOSE = 1e-9
"""Of designs that differ by less (relative) either is the best."""
_WIDE = 300
_ROUNDS = 12
_LENGTH_STEPS = (64, 16, 4, 1)


def optimise_rounded(
    problem: Problem,
    rounding: Rounding,
    *,
    log: Log | None = None,
    progress: Progress | None = None,
    notify: Callable[[str], None] | None = None,
    begun: Callable[[Evaluation], None] | None = None,
    executor: Executor | None = None,
) -> OptimizationResult:
    """The best design for a problem, with `rounded` in it, or `not_rounded` where no such design keeps the limits.

    `log`, `progress`, `notify`, `begun` and `executor` as in `optimise`.

    An interrupt (see `optimise`) leaves the optimum, and the best rounded design if there is one yet. Raises `NoAnswer`
    where no design keeps the limits, whatever its sizes.
    """
    if problem.uncertain is not None:
        would_do = "optimise without, then round by hand and ask `evaluate --problem`"
        raise InputError(problem.file, "uncertain", f"goes without --round; {would_do}")
    if not problem.objective.summed:
        message = f"{problem.minimize} goes without --round, which compares designs by errors, masses and costs"
        raise InputError(problem.file, "minimize", message)
    if problem.free_tapers:
        would_do = "workshops' sizes are those of uniform links; leave one of the two out"
        raise InputError(problem.file, "subject_to.taper", f"goes without --round; {would_do}")
    if problem.stepped:
        raise InputError(problem.file, "subject_to.thickness", "in steps goes without --round; leave one of them out")
    if problem.sizes is not None:
        would_do = "they are sizes to be had already, so leave --round out"
        raise InputError(problem.file, "choose.sizes", f"goes without --round; {would_do}")
    settings: Any = {"log": log, "progress": progress, "notify": notify, "begun": begun}
    result = optimise(problem, **settings, executor=executor)
    reason = "interrupted before a design of them was found"
    missing = NotRounded(rounding.text, _length_step(problem, rounding), reason)
    if result.interrupted:
        return replace(result, not_rounded=missing)
    try:
        made = rounded(problem, result, rounding, progress=progress)
    except KeyboardInterrupt:
        return replace(result, interrupted=True, not_rounded=missing)
    except NoRounding as none:
        return replace(result, not_rounded=none.not_rounded)
    except NoAnswer as none:
        return replace(result, not_rounded=replace(missing, reason=str(none)))
    return replace(result, rounded=made, interrupted=made.interrupted)


def rounded(
    problem: Problem, result: OptimizationResult, rounding: Rounding, *, progress: Progress | None = None
) -> Rounded:
    """The best rounded design near a problem's optimum; the best so far where `progress` raises `KeyboardInterrupt`.

    Raises `NoAnswer` where none keeps the limits (`NoRounding` with the nearest), `KeyboardInterrupt` where there is
    none yet.
    """
    began = time.perf_counter()
    # Where the bounds are no multiples themselves, the optimum within those that are is what to round.
    problem_here = replace(problem, arm=result.arm, actuators=None, balances=(), motors=(), base=None)
    drawn = on_grid(problem_here, rounding)
    if drawn != problem_here:
        try:
            result_there = optimise(drawn, progress=progress)
        except NoAnswer as reason:
            raise NoAnswer(f"within bounds that are multiples of the steps: {reason}") from None
        if result_there.interrupted:
            raise KeyboardInterrupt
        problem_here = replace(drawn, arm=result_there.arm)
    else:
        result_there = result
    kept = _kept(problem_here, rounding)
    search = _search(problem_here, rounding, progress)
    beside = len(search.judge.table.lengths)
    best = _best(search, rounding, beside)
    while best.pick is not None:
        after = evaluate(search.judge.table.arm_of(best.pick), problem_here.workspace, problem_here.load_cases)
        if not broken(problem_here.limits, after):
            every, seconds = search.combinations * beside, time.perf_counter() - began
            return replace(_rounded(problem_here, result, rounding, every, best, after, seconds), kept=kept)
        # The last word is that of the evaluation, which looks closer than a search does.
        search.exclude(best.pick)
        best = _best(search, rounding, beside)
    raise NoRounding(_not_rounded(problem_here, result, rounding, search, began))


def _search(problem: Problem, rounding: Rounding, progress: Progress | None) -> ListSearch:
    context, lists = context_of(problem), _lists(problem, rounding)
    lengths = length_choices(problem, problem.arm.lengths, rounding.length_step)
    search = ListSearch(context, lists, progress=progress, table=Table(context.problem, lists, lengths))
    search.named, search.close = "rounded sizes", _CLOSE
    return search


def _best(search: ListSearch, rounding: Rounding, beside: int) -> SearchOutcome:
    """The best of all sizes with each of the choices of lengths `beside` the optimum's, and the bound on those; then
    with others as long as that helps. Raises `KeyboardInterrupt` where one left nothing."""
    judge, bound, stopped = search.judge, math.inf, False
    rounds = 0 if not search.context.problem.free_lengths else _ROUNDS
    try:
        for place in range(beside):
            with suppress(Unreachable):
                bound = min(bound, _at(search, place))
        while rounds and judge.best is not None and _lengths_moved(search, rounding.length_step):
            rounds -= 1
            _at(search, judge.best[0][-1])
        search.tell()
    except KeyboardInterrupt:
        if judge.best is None:
            raise
        stopped = True
    pick, objective = judge.best or (None, math.inf)
    return SearchOutcome(
        pick, objective, -math.inf if stopped else bound, search.parts, search.compared, judge.searched, stopped
    )


def _at(search: ListSearch, place: int) -> float:
    """Look at a choice of lengths; the bound on it."""
    best = search.at(place)
    if best.interrupted:
        raise KeyboardInterrupt
    return best.bound


# ---- what each link can be


def _lists(problem: Problem, rounding: Rounding) -> tuple[LinkList, ...]:
    """The sizes that each link can have, those first that are nearest to the optimum."""
    lists: list[LinkList] = []
    for index, link in enumerate(problem.arm.links):
        if link.section is None:
            continue
        options, _ = keeping(problem, index, _options(problem, index, link.section, rounding))
        options.sort(key=lambda option, index=index: _distance(option, problem, index))
        lists.append(LinkList(index, tuple(options), columns_of(problem, index, options)))
    return tuple(lists)


def _kept(problem: Problem, rounding: Rounding) -> tuple[str, ...]:
    """Why links stay as computed, one sentence each: those without a size in the stock tables. Raises `NoAnswer` where
    they are all."""
    if rounding.step is not None:
        return ()
    elastic = [index for index, link in enumerate(problem.arm.links) if link.section is not None]
    lacking: dict[int, str] = {}
    for index in elastic:
        ranges, shapes, materials = problem.ranges[index], problem.shapes_of(index), problem.materials_of(index)
        if not stock_options(ranges, shapes, materials):
            lacking[index] = f"link {index + 1}: {why_no_stock(ranges, shapes, materials)}"
    if len(lacking) == len(elastic):
        raise NoAnswer(f"{'; '.join(lacking.values())}; `linkwright sections list` has them all")
    return tuple(lacking.values())


def _options(problem: Problem, index: int, section: Section, rounding: Rounding) -> list[Option]:
    materials = problem.materials_of(index)
    material = problem.arm.links[index].material
    assert material is not None
    if rounding.step is None:
        options = stock_options(problem.ranges[index], problem.shapes_of(index), materials)
        return options or [Option(section, material, problem.arm.links[index].section_name)]
    options = [
        Option(grid_section, material) for grid_section in grid_sections(problem, section, rounding.step, _REACH, index)
    ]
    if not options:
        grid = format_quantity(rounding.step, "length")
        raise NoAnswer(f"link {index + 1}: no {section.shape} near the optimum has sizes in steps of {grid}")
    return options


def _distance(option: Option, problem: Problem, index: int) -> float:
    """How far an option is from the optimum: in the logarithms of mass and of bending rigidity."""
    link = problem.arm.links[index]
    assert link.section is not None
    assert link.material is not None
    given, other = (_stiff_and_heavy(item, problem) for item in (Option(link.section, link.material), option))
    return sum(abs(math.log(a / b)) for a, b in zip(other, given, strict=True))


def _stiff_and_heavy(option: Option, problem: Problem) -> tuple[float, float]:
    properties = option.section.properties(0.3)
    values = option.material.at(problem.arm.temperature)
    return (
        float(properties.area) * values.need("density"),
        float(properties.second_moment_y) * values.need("elastic_modulus"),
    )


# ---- which designs to compare


def _few_enough(counts: Sequence[int], lengths: int) -> list[int]:
    """How many options of each group, at most so many, there can be in combinations of all that are few enough."""
    sizes = list(counts)
    while math.prod(sizes) * lengths > MOST_DESIGNS and max(sizes) > 1:
        largest = max(range(len(sizes)), key=lambda k: sizes[k])
        sizes[largest] = max(1, int(0.9 * sizes[largest]))
    return sizes


def _lengths_moved(search: ListSearch, step: float) -> bool:
    """Other lengths, by ever fewer steps (m), each with other options of one link; whether that found a better
    design."""
    judge, better = search.judge, False
    wide = [range(min(len(link_list.options), _WIDE)) for link_list in search.lists]
    for steps in _LENGTH_STEPS:
        while judge.best is not None:
            *pick, place = judge.best[0]
            lengths = moved_lengths(search.context.problem, judge.table.lengths[place], steps * step)
            places = judge.table.add_lengths(lengths)
            trials = ([item if k == free else [pick[k]] for k, item in enumerate(wide)] for free in range(len(wide)))
            offers = [judge.offer(product([*trial, places])) for trial in trials] if places else []
            if not any(offers):
                break
            better = True
    return better


# ---- what came of it


def _rounded(
    problem: Problem,
    result: OptimizationResult,
    rounding: Rounding,
    every: int,
    best: SearchOutcome,
    after: Evaluation,
    seconds: float,
) -> Rounded:
    proven = best.gap is not None and best.gap <= 2.0 * CLOSE
    objective, before = (problem.objective.value(item) for item in (after, result.after))
    assert objective is not None
    assert before is not None
    return Rounded(
        to=rounding.text,
        length_step=_length_step(problem, rounding),
        arm=after.arm,
        evaluation=after,
        error_map=map_of(problem, after),
        objective=objective,
        before=before,
        limits=_limits(problem, result, after),
        compared=every if proven else best.compared,
        searched=best.searched,
        exhaustive=proven,
        seconds=seconds,
        interrupted=best.interrupted,
    )


def _not_rounded(
    problem: Problem, result: OptimizationResult, rounding: Rounding, search: ListSearch, began: float
) -> NotRounded:
    """Why there is none, and the design that breaks the limits least."""
    judge, counts = search.judge, [len(link_list.options) for link_list in search.lists]
    sizes = _few_enough(counts, len(judge.table.lengths))
    picks = product([*map(range, sizes), range(len(judge.table.lengths))])
    judge.offer(picks)
    nearest = nearest_design(judge, picks)
    not_rounded = NotRounded(rounding.text, _length_step(problem, rounding), why_not(judge, rounding))
    if nearest is not None:
        limits = _limits(problem, result, nearest.evaluation)
        proven = nearest.proven and sizes == counts
        not_rounded = replace(
            not_rounded, nearest=nearest.evaluation, excess=nearest.excess, limits=limits, proven=proven
        )
    return replace(not_rounded, seconds=time.perf_counter() - began)


def _limits(problem: Problem, result: OptimizationResult, after: Evaluation) -> tuple[KeptLimit, ...]:
    return tuple(
        KeptLimit(x.name, x.text, x.of(result.after), x.of(after), x.relation, x.value, x.figure)
        for x in problem.limits
    )


def _length_step(problem: Problem, rounding: Rounding) -> float | None:
    return rounding.length_step if problem.free_lengths else None
