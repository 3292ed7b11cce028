"""An optimum moved to sizes that a workshop can get: a grid of sizes or the stock tables, certified anew.

Rounding each size to its nearest neighbour seldom gives the best design, and often breaks a limit. Here every
combination of the nearest sizes is compared (`optimize.rounding.fixed_sizes`), up to a number; what is beyond that is
reached by exchanging two links at a time among wider choices until nothing improves.
"""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.evaluation import Evaluation, evaluate
from linkwright.core.executors import Executor
from linkwright.core.optimize.choice.combinations import Progress
from linkwright.core.optimize.exchange.design import numeric_beams
from linkwright.core.optimize.exchange.exchange import context_of
from linkwright.core.optimize.journal import Journal
from linkwright.core.optimize.limits import broken
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.result import KeptLimit, NotRounded, OptimizationResult, Rounded
from linkwright.core.optimize.run import Log, optimise
from linkwright.core.units.quantities import InputError, NoAnswer, format_quantity

from .designs_at_once import Group, Table
from .fixed_sizes import RoundSearch
from .nearest import NoRounding, nearest_design, why_not
from .options import (
    Option,
    Rounding,
    allowed_materials,
    allowed_shapes,
    grid_sections,
    length_choices,
    moved_lengths,
    on_grid,
    stock_options,
    why_no_stock,
)

Integers = NDArray[np.intp]

MOST_DESIGNS = 100_000
"""Up to this many combinations of the nearest sizes every one is compared."""
_WIDE = 300
_ROUNDS = 12
_LENGTH_STEPS = (64, 16, 4, 1)


def optimise_rounded(
    problem: Problem,
    rounding: Rounding,
    *,
    log: Log | None = None,
    progress: Progress | None = None,
    told: Callable[[str], None] | None = None,
    begun: Callable[[Evaluation], None] | None = None,
    executor: Executor | None = None,
    journal: Journal | None = None,
) -> OptimizationResult:
    """The best design for a problem, with `rounded` in it, or `not_rounded` where no such design keeps the limits.

    `log`, `progress`, `told`, `begun`, `executor` and `journal` as in `optimise`.

    An interrupt (see `optimise`) leaves the optimum, and the best rounded design if there is one yet. Raises `NoAnswer`
    where no design keeps the limits, whatever its sizes.
    """
    if problem.uncertain is not None:
        would_do = "optimise without, then round by hand and ask `evaluate --problem`"
        raise InputError(problem.file, "uncertain", f"goes without --round; {would_do}")
    if problem.taper is not None:
        would_do = "workshops' sizes are those of uniform links; leave one of the two out"
        raise InputError(problem.file, "subject_to.taper", f"goes without --round; {would_do}")
    if problem.sizes is not None:
        would_do = "they are sizes to be had already, so leave --round out"
        raise InputError(problem.file, "choose.sizes", f"goes without --round; {would_do}")
    settings: Any = {"log": log, "progress": progress, "told": told, "begun": begun}
    result = optimise(problem, **settings, executor=executor, journal=journal)
    reason = "interrupted before a design of them was found"
    missing = NotRounded(rounding.text, _length_step(problem, rounding), reason)
    if result.interrupted:
        return replace(result, not_rounded=missing)
    try:
        made = rounded(problem, result, rounding, progress=progress)
    except KeyboardInterrupt:
        return replace(result, interrupted=True, not_rounded=missing)
    except NoRounding as none:
        return replace(result, not_rounded=none.found)
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
    drawn = replace(on_grid(problem, rounding), arm=result.arm, actuators=None, balances=(), motors=())
    own = replace(problem, arm=result.arm, actuators=None, balances=(), motors=())
    if drawn != own:
        try:
            result_there = optimise(drawn, progress=progress)
        except NoAnswer as reason:
            raise NoAnswer(f"within bounds that are multiples of the steps: {reason}") from None
        if result_there.interrupted:
            raise KeyboardInterrupt
        own = replace(drawn, arm=result_there.arm)
    else:
        result_there = result
    search = _search(own, result_there.after, rounding, progress)
    stopped = not _compared(search)
    while search.best is not None:
        pick, _ = search.best
        made = search.table.arm_of(pick)
        after = evaluate(made, own.workspace, own.load_cases)
        if not broken(own.limits, after):
            made = _rounded(own, result, rounding, search, after, time.perf_counter() - began)
            return replace(made, interrupted=stopped)
        # The last word is that of the evaluation, which looks closer than a search does.
        search.exclude(pick)
        stopped = not _compared(search)
    raise NoRounding(_not_rounded(own, result, rounding, search, began))


def _compared(search: RoundSearch) -> bool:
    """Compare designs; whether that went through to the end. Raises `KeyboardInterrupt` where one left nothing."""
    try:
        _compare(search)
    except KeyboardInterrupt:
        if search.best is None:
            raise
        search.complete = False
        return False
    return True


def _search(problem: Problem, optimum: Evaluation, rounding: Rounding, progress: Progress | None) -> RoundSearch:
    context = context_of(problem)
    groups = _groups(problem, rounding)
    lengths = length_choices(problem, problem.arm.lengths, rounding.length_step)
    search = RoundSearch(context, Table(problem, problem.arm, groups, lengths), rounding, _telling(progress))
    p = numeric_beams(problem.arm, problem.load_cases)
    poses = [(pose.q, pose.load_case) for pose in optimum.worst.poses] if context.uses_error else []
    for family, prepared in context.families:
        if family.bounds_many:
            found = family.worst(prepared, problem, context.search, problem.arm, p)
            poses += [(each.cut.q, family.load_case(each.cut)) for each in found]
    if poses:
        search.add_poses(np.array([q for q, _ in poses]), [case for _, case in poses], p)
    return search


def _telling(progress: Progress | None) -> Callable[[int, int], None] | None:
    if progress is None:
        return None

    def tell(offered: int, searched: int) -> None:
        progress(searched, searched + 1, f"rounding: {offered} designs compared")

    return tell


# ---- what each link can be


def _groups(problem: Problem, rounding: Rounding) -> list[Group]:
    """The links that can be rounded, those of one shape together where they must agree in their dimensions."""
    elastic = [index for index, link in enumerate(problem.arm.links) if link.section is not None]
    together: dict[object, list[int]] = {}
    for index in elastic:
        section = problem.arm.links[index].section
        assert section is not None
        together.setdefault("all" if "size" in problem.same else index, []).append(index)
    return [
        _stock_group(problem, links) if rounding.step is None else _grid_group(problem, links, rounding.step)
        for links in together.values()
    ]


def _grid_group(problem: Problem, links: Sequence[int], step: float) -> Group:
    first = problem.arm.links[links[0]]
    assert first.section is not None
    options: list[tuple[Option, ...]] = []
    near = 0
    for reach in (1, 2):
        for section in grid_sections(problem, first.section, step, reach, links[0]):
            option = tuple(Option(section, problem.arm.links[link].material) for link in links)
            if option not in options:
                options.append(option)
        near = near or len(options)
    if not options:
        grid = format_quantity(step, "length")
        raise NoAnswer(f"link {links[0] + 1}: no {first.section.shape} near the optimum has sizes in steps of {grid}")
    ranked = sorted(options[:near], key=lambda option: _distance(option, problem, links))
    wide = sorted(options[near:], key=lambda option: _distance(option, problem, links))
    return Group(tuple(links), (*ranked, *wide), near)


def _stock_group(problem: Problem, links: Sequence[int]) -> Group:
    shapes = allowed_shapes(problem)
    each = [stock_options(problem, shapes, allowed_materials(problem, problem.arm.links[index])) for index in links]
    if len(links) == 1:
        options = [(option,) for option in each[0]]
    else:
        names = dict.fromkeys(option.stock for option in each[0])
        options = [
            pick for name in names for pick in itertools.product(*[[o for o in own if o.stock == name] for own in each])
        ]
    if not options:
        what = why_no_stock(problem, shapes, allowed_materials(problem, problem.arm.links[links[0]]))
        raise NoAnswer(f"link {links[0] + 1}: {what}; `linkwright sections list` has them all")
    options.sort(key=lambda option: _distance(option, problem, links))
    return Group(tuple(links), tuple(options), len(options))


def _distance(option: tuple[Option, ...], problem: Problem, links: Sequence[int]) -> float:
    """How far an option is from the optimum: in the logarithms of mass and of bending rigidity."""
    total = 0.0
    for each, index in zip(option, links, strict=True):
        link = problem.arm.links[index]
        own, other = _stiff_and_heavy(Option(link.section, link.material), problem), _stiff_and_heavy(each, problem)
        total += sum(abs(math.log(a / b)) for a, b in zip(other, own, strict=True))
    return total


def _stiff_and_heavy(option: Option, problem: Problem) -> tuple[float, float]:
    assert option.section is not None
    assert option.material is not None
    found = option.section.properties(0.3)
    values = option.material.at(problem.arm.temperature)
    return (
        float(found.area) * values.need("density"),
        float(found.second_moment_y) * values.need("elastic_modulus"),
    )


# ---- which designs to compare


def _compare(search: RoundSearch) -> None:
    """Offer the combinations of the nearest sizes, then exchanges of two among the wider ones."""
    groups, lengths = search.table.groups, len(search.table.lengths)
    near, every = [group.near for group in groups], [len(group.options) for group in groups]
    sizes = _few_enough(near, lengths)
    search.complete = search.complete and sizes == near
    search.offer(_product([range(size) for size in sizes], range(lengths)))
    if search.best is None and sum(sizes) < sum(every):
        search.offer(_product([range(size) for size in _few_enough(every, lengths)], range(lengths)))
    for _ in range(_ROUNDS):
        if search.best is None:
            break
        better = _exchanged(search)
        if not (_lengths_moved(search) or better):
            break


def _few_enough(counts: Sequence[int], lengths: int) -> list[int]:
    """How many options of each group, at most so many, there can be in combinations of all that are few enough."""
    sizes = list(counts)
    while math.prod(sizes) * lengths > MOST_DESIGNS and max(sizes) > 1:
        largest = max(range(len(sizes)), key=lambda k: sizes[k])
        sizes[largest] = max(1, int(0.9 * sizes[largest]))
    return sizes


def _exchanged(search: RoundSearch) -> bool:
    """Other options for every two groups, or a group and the lengths, at once; whether that found a better design."""
    assert search.best is not None
    counts = [*(min(len(group.options), _WIDE) for group in search.table.groups), len(search.table.lengths)]
    if len(counts) == 2:
        return search.offer(_product([range(counts[0])], range(counts[1])))
    better = False
    for one, other in itertools.combinations(range(len(counts)), 2):
        pick = search.best[0]
        own = [range(counts[k]) if k in (one, other) else [pick[k]] for k in range(len(counts))]
        better = search.offer(_product(own[:-1], own[-1])) or better
    return better


def _lengths_moved(search: RoundSearch) -> bool:
    """Other lengths, by ever fewer steps, each with other options of one group; whether that found a better design."""
    better, table = False, search.table
    for steps in _LENGTH_STEPS:
        while search.best is not None:
            pick = search.best[0]
            lengths = moved_lengths(search.problem, table.lengths[pick[-1]], steps * search.rounding.length_step)
            places = table.add_lengths(lengths)
            offers = [search.offer(each) for each in _one_group_free(search, pick, places)] if places else []
            if not any(offers):
                break
            better = True
    return better


def _one_group_free(search: RoundSearch, pick: tuple[int, ...], lengths: Sequence[int]) -> list[Integers]:
    """A design's picks with other options of each group in turn, for choices of lengths."""
    wide = [range(min(len(group.options), _WIDE)) for group in search.table.groups]
    return [
        _product([own if k == free else [pick[k]] for k, own in enumerate(wide)], lengths) for free in range(len(wide))
    ]


def _product(options: Sequence[Sequence[int]], lengths: Sequence[int]) -> Integers:
    """Every combination, (N, groups + 1)."""
    axes = np.meshgrid(*[np.array(each, dtype=np.intp) for each in (*options, lengths)], indexing="ij")
    return np.stack([axis.ravel() for axis in axes], axis=1)


# ---- what came of it


def _rounded(
    problem: Problem,
    result: OptimizationResult,
    rounding: Rounding,
    search: RoundSearch,
    after: Evaluation,
    seconds: float,
) -> Rounded:
    objective, before = (problem.objective.value(each) for each in (after, result.after))
    assert objective is not None
    assert before is not None
    return Rounded(
        to=rounding.text,
        length_step=_length_step(problem, rounding),
        arm=after.arm,
        evaluation=after,
        objective=objective,
        before=before,
        limits=_limits(problem, result, after),
        compared=search.offered,
        searched=search.searched,
        exhaustive=search.complete,
        seconds=seconds,
    )


def _not_rounded(
    problem: Problem, result: OptimizationResult, rounding: Rounding, search: RoundSearch, began: float
) -> NotRounded:
    """Why there is none, and the design that breaks the limits least."""
    counts, lengths = [len(group.options) for group in search.table.groups], len(search.table.lengths)
    sizes = _few_enough(counts, lengths)
    found = nearest_design(search, _product([range(size) for size in sizes], range(lengths)))
    told = NotRounded(rounding.text, _length_step(problem, rounding), why_not(search, rounding))
    if found is not None:
        limits = _limits(problem, result, found.evaluation)
        proven = found.proven and sizes == counts
        told = replace(told, nearest=found.evaluation, excess=found.excess, limits=limits, proven=proven)
    return replace(told, seconds=time.perf_counter() - began)


def _limits(problem: Problem, result: OptimizationResult, after: Evaluation) -> tuple[KeptLimit, ...]:
    return tuple(
        KeptLimit(x.name, x.text, x.of(result.after), x.of(after), x.relation, x.value, x.figure)
        for x in problem.limits
    )


def _length_step(problem: Problem, rounding: Rounding) -> float | None:
    return rounding.length_step if problem.link_length is not None else None
