"""From residuals to a pool: nuisances, weights, outliers and the noise's memory, found beside a first rough model.

All of these need to know roughly what the mismatch is, or a large effect would pass for scatter: so a first search is
made with equal weights, and what it leaves tells the scatter of each axis, the rows that lie far off, and how much of
each reading's noise the next one remembers. Then everything is set up again.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.effects import EFFECTS, Settings
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.patterns.form import FORCE_IN_TIME, SMOOTH, TREND, form_of
from linkwright.core.diagnose.patterns.forms import forms
from linkwright.core.diagnose.patterns.library import Candidate, candidates, columns_of, parameter_of
from linkwright.core.diagnose.patterns.packed import Columns, Packed, packed
from linkwright.core.diagnose.patterns.pool import Pool, exchanged, make_pool
from linkwright.core.diagnose.recording import RejectedRow
from linkwright.core.diagnose.residual.free_origins import of_observed, origin_columns
from linkwright.core.diagnose.residual.nuisances import of_each
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.residual.observed import Observed, rms_length
from linkwright.core.diagnose.residual.orientation import tool_turns
from linkwright.core.diagnose.residual.time_vs_path import JudgedVisits, places, rather_with_time, time_vs_path
from linkwright.core.diagnose.residual.visits import poses
from linkwright.core.diagnose.residual.wander import clock, remembered, still, wander_in, without
from linkwright.core.diagnose.rules.fitting_rules import FittingRules
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.diagnose.search.subsets import Criterion, Products, criterion_for, products
from linkwright.core.sections.numeric import Array

from .left_by_names import Variants, left_by_names
from .noise_left import bad_rows_down, first_scale, independent_share, loudness, memory_of, outliers_of, scatter_of
from .thresholds import at_best, thresholds_of

_PASSES, _ROUGH = 3, 4
"""How often the rough model is made anew where the noise remembers much, and how many patterns are in it at most."""


@dataclass(frozen=True)
class Prepared:
    """A recording ready to be searched: `vector` (n,) is the whitened residual without nuisances, `columns` holds each
    group's displacements (N, C, d) in m and rad, `beside` the nuisances' (N, C, b). `rejected` are rows set aside.

    `independent` is the share of observations that tell something each: readings of one visit share how exactly the arm
    came there. `together` neighbouring visits tell as much as one where what is left goes with time as well as with
    pose: p-values are those of so many fewer. Sizes are held to `width` times the largest that are usual, one standard
    deviation; infinite: only to what is possible."""

    observed: Observed
    vector: Array
    pool: Pool
    columns: Columns
    beside: Array
    beside_names: tuple[str, ...]
    rejected: tuple[RejectedRow, ...]
    independent: float = 1.0
    together: int = 1
    width: float = np.inf

    @cached_property
    def products(self) -> Products:
        """The pool's products with the residual."""
        return products(self.pool, self.vector)

    @cached_property
    def criterion(self) -> Criterion:
        """The criterion for subsets of this pool."""
        count = int(self.independent * len(self.vector)) - self.pool.nuisance.shape[1]
        return criterion_for(self.pool, max(count, 2))

    def library(self) -> NDArray[np.bool_]:
        """Which groups are of the library, and not mere forms."""
        return np.array([not group.candidate.outside for group in self.pool.groups], dtype=bool)

    def unit_of_sizes(self, unit: float) -> float:
        """The scatter `unit` of whitened residuals as it stands against what holds sizes near the usual: neighbours
        that tell as much as one are counted once, or what many readings leave alike would pass for sizes."""
        return unit * float(np.sqrt(self.together))

    @property
    def visits(self) -> NDArray[np.int64]:
        """Which visit each reading belongs to, numbered from 0; neighbours that tell as much as one are one."""
        visit = np.unique(self.observed.block, return_inverse=True)[1].reshape(-1).astype(np.int64)
        return visit // self.together


def nuisances(observed: Observed, *, origins: bool = True) -> tuple[Array, tuple[str, ...]]:
    """What the user does not ask about, (N, C, b): the frame, the tool, the place of a target on the base, how that on
    the tool is turned, the places of an anchor, points and planes that were measured from, and last the arm's fixed
    transforms that its file leaves free (`origins`), which all recordings share."""
    free = list(_frame_and_tool(observed))
    targets = [*_base_target(observed), *_seat(observed)]
    parts = [*(column for _, _, column in free), *(column for _, column in targets)]
    names = [*(name for _, name, _ in free), *(name for name, _ in targets)]
    columns = np.stack(parts, axis=2) if parts else np.zeros((*observed.residual.shape, 0))
    columns, placed_columns = of_each(observed, columns, tuple(names), [setting for setting, _, _ in free])
    if observed.view is not None and observed.view.names:
        placed = np.zeros((*observed.residual.shape, len(observed.view.names)))
        placed[:, : observed.components] = observed.view.beside
        columns, placed_columns = np.concatenate([columns, placed], axis=2), (*placed_columns, *observed.view.names)
    ways = of_observed(observed) if origins else ()
    if not ways:
        return columns, placed_columns
    names = [f"origin of joint {way.joint + 1}, {way.part}" for way in ways]
    return np.concatenate([columns, origin_columns(observed, ways)], axis=2), (*placed_columns, *names)


def _frame_and_tool(observed: Observed) -> Iterator[tuple[str, str, Array]]:
    """What a free frame and a free tool do: the setting that leaves it free, its name and its column (N, C)."""
    for setting, left in (("frame", observed.recording.frame), ("tool", observed.recording.tool)):
        for effect in EFFECTS.values() if left == "free" else ():
            sizes = effect.sizes if effect.recording.free_with == setting else ()
            for size in (size.name for size in sizes if observed.space == 3 or not size.out_of_plane):
                yield setting, f"{effect.id} {size}", observed.signature(effect.id, Settings((), {size: 1.0}))


def _base_target(observed: Observed) -> Iterator[tuple[str, Array]]:
    """Where a target on the base is, by name and column (N, C)."""
    first = observed.components + (observed.arm.size if observed.asked.joint_side else 0)
    for axis in range(3 if observed.recording.base_target is not None else 0):
        column = np.zeros(observed.residual.shape)
        column[:, first + axis] = 1.0
        yield f"base target {'xyz'[axis]}", column


def _seat(observed: Observed) -> Iterator[tuple[str, Array]]:
    """How the target on the tool is turned, by name and column (N, C)."""
    if not observed.asked.turn:
        return
    turns = tool_turns(observed.recording, observed.state, observed.space)
    for k in range(turns.shape[2]):
        column = np.zeros(observed.residual.shape)
        if observed.has_turns:
            column[:, observed.turn_columns] = observed.turns(turns[:, :, k])
        if observed.reads_turns:
            column[:, : observed.components] = observed.of_tip(np.zeros((observed.rows, 3)), turns[:, :, k])
        yield f"seat of the target about {'xyz'[k - turns.shape[2]]}", column


def limits(candidate: Candidate, columns: Array, *, rules: FittingRules = RULES.fitting) -> Array | None:
    """How large each size of a candidate may physically be (d,), None where nobody can say."""
    if candidate.outside or candidate.share:
        return None
    if columns.shape[2] != len(candidate.sizes):
        products = np.full(columns.shape[2], rules.softest)
        products[-1] = parameter_of(EFFECTS[candidate.effect], candidate.sizes[0]).upper
        return products
    parameters = [parameter_of(EFFECTS[candidate.effect], name) for name in candidate.sizes]
    if len(parameters) > rules.many_sizes:
        # A curve of many coefficients: each is of its usual size, or readings that lie close would make them anything.
        return np.array([rules.tether * max(abs(limit) for limit in parameter.typical) for parameter in parameters])
    return np.array([max(abs(parameter.lower), abs(parameter.upper)) for parameter in parameters])


def held_within(
    candidate: Candidate, columns: Array, width: float = np.inf, *, rules: FittingRules = RULES.fitting
) -> Array | None:
    """How far each size (d,) may go where the data say next to nothing of it, None where nobody can say: no further
    than is possible; and of what an axis is off by across itself, which a free frame takes up but for a trace, one
    standard deviation of what holds it is the largest that is usual, as of all sizes `width` times that."""
    most = limits(candidate, columns, rules=rules)
    if most is None or columns.shape[2] != len(candidate.sizes):
        return most
    parameters = [parameter_of(EFFECTS[candidate.effect], name) for name in candidate.sizes]
    usual = np.array([max(abs(limit) for limit in parameter.typical) for parameter in parameters])
    times = np.array([min(width, 1.0) if parameter.across else width for parameter in parameters])
    return np.minimum(most, rules.tether * usual * times)


Patterns = list[tuple[Candidate, Packed]]


def packed_up(patterns: Iterable[tuple[Candidate, Array]]) -> Patterns:
    """Patterns with columns (N, C, d), one after the other, without their zeros."""
    return [(candidate, packed(columns)) for candidate, columns in patterns]


def patterns_of(observed: Observed, options: Options, library: Patterns | None = None) -> Patterns:
    """Everything that could be missing: each candidate (those of the `library`, where they are known already) and form
    with its columns."""
    known = packed_up(candidates(observed, options.without)) if library is None else library
    return [*known, *packed_up(forms(observed))]


def set_up(observed: Observed, patterns: Patterns, rejected: tuple[RejectedRow, ...] = ()) -> Prepared:
    """The pool of patterns for a recording as it stands."""
    beside, names = nuisances(observed)
    # One after the other: all whitened patterns at once are hundreds of megabytes for a long recording.
    white = _whitened(observed, patterns)
    widest = sum(columns.shape[2] for _, columns in patterns)
    pool = make_pool(observed.whitened(beside), white, widest=widest, rules=observed.rules)
    seen = {id(group.candidate) for group in pool.groups}
    columns = Columns(part for candidate, part in patterns if id(candidate) in seen)
    vector = pool.projected(observed.whitened(observed.residual))
    return Prepared(observed, vector, pool, columns, beside, names, rejected)


def exchange(prepared: Prepared, observed: Observed, kept: Sequence[int], patterns: Patterns) -> Prepared:
    """A recording set up again with some of its groups (their numbers) and other patterns in place of the rest, the
    model being another in these alone (`observed`); what is kept is not worked out again."""
    beside, names = nuisances(observed)
    if names != prepared.beside_names or not np.array_equal(beside, prepared.beside):
        held = [(prepared.pool.groups[number].candidate, prepared.columns.parts[number]) for number in kept]
        again = set_up(observed, [*held, *patterns], prepared.rejected)
        return replace(again, independent=prepared.independent, together=prepared.together)
    white = _whitened(observed, patterns)
    pool = exchanged(prepared.pool, kept, white)
    seen = {id(group.candidate) for group in pool.groups}
    columns = [prepared.columns.parts[number] for number in kept]
    columns += [part for candidate, part in patterns if id(candidate) in seen]
    return replace(prepared, observed=observed, pool=pool, columns=Columns(columns))


def _whitened(observed: Observed, patterns: Patterns) -> Iterator[tuple[Candidate, Array, Array | None]]:
    """Patterns as a pool takes them, one at a time."""
    for candidate, part in patterns:
        columns = part.whole()
        yield candidate, observed.whitened(columns), limits(candidate, columns, rules=observed.rules.fitting)


def prepare(
    observed: Observed,
    options: Options,
    noise_floor: float | None = None,
    library: Patterns | None = None,
    named: Sequence[Candidate] | None = None,
) -> Prepared:
    """Find weights, outliers and the noise's memory beside a first rough model, and set everything up with them.

    `noise_floor` (m) is what repeats of a pose differ by, None where there are none; `library` are the patterns of the
    candidates where they are known already; `named` is what an earlier search of the recording found (none: nothing is
    known yet), which is judged by in place of a rough model.
    """
    patterns = patterns_of(observed, options, library)
    observed, left, patterns, rejected, _ = _without_outliers(observed, patterns, noise_floor, named)
    return _with_memory(observed, patterns, left, noise_floor, rejected)


def set_aside_beside(
    named: Sequence[Candidate], observed: Observed, options: Options, noise_floor: float | None = None
) -> tuple[tuple[RejectedRow, ...], tuple[Candidate, ...]]:
    """The rows that lie far off beside what was named, as `prepare` finds them with it, and what was named in the
    shapes that suit the others."""
    effects = {item.effect for item in named if any(each.threshold for each in EFFECTS[item.effect].parameters)}
    others = frozenset(EFFECTS) - effects
    patterns = packed_up(candidates(observed, options.without | others))
    _, _, _, rejected, shaped = _without_outliers(observed, patterns, noise_floor, named)
    return rejected, shaped


def _without_outliers(
    observed: Observed, patterns: Patterns, noise_floor: float | None, named: Sequence[Candidate] | None
) -> tuple[Observed, Array, Patterns, tuple[RejectedRow, ...], tuple[Candidate, ...]]:
    """The readings that do not lie far off, with their scatter, what a rough model (or what was named) leaves of them
    (N, C), their patterns, the rows set aside, and what was named in the shapes that fit."""
    rejected: list[RejectedRow] = []
    left, shaped = observed.residual, tuple[Candidate, ...]()
    for _ in range(_PASSES):
        rough = replace(observed, scale=first_scale(observed))
        if named is None:
            left = _left_by_rough_model(set_up(rough, patterns), noise_floor)
        else:
            left, shaped = left_by_names(rough, _variants(rough, named, patterns), nuisances(rough)[0])
        observed = replace(observed, loud=loudness(left, observed))
        scale = scatter_of(observed.evened(left), rough)
        outlying = outliers_of(replace(observed, scale=scale).scaled(left), observed)
        if not outlying.any():
            observed = replace(observed, scale=scale)
            break
        rejected += [
            RejectedRow(
                int(observed.recording.row[row]),
                "lies far outside the scatter of all other readings",
                tuple(left[row, : observed.components].tolist()),
            )
            for row in np.flatnonzero(outlying).tolist()
        ]
        keep = ~outlying
        many_rejected = len(rejected) > observed.rules.fitting.most_outliers * len(keep)
        observed = observe(
            observed.arm_given,
            observed.recording.kept(keep),
            scale=scatter_of(observed.evened(left)[keep], rough),
            about=observed.about,
            rules=observed.rules,
            loud=observed.loud,
            softening=observed.softening,
        )
        # Lags and loads were worked out with all rows: a bad reading of the tip says nothing against its temperature.
        for number, (candidate, part) in enumerate(patterns):  # one by one: all at once are hundreds of megabytes
            patterns[number] = candidate, part.kept(keep)
        left = left[keep]
        if named is None and not many_rejected:
            break
        # So many have bent the first rough model: what they hid stands out from the next.
    return observed, left, patterns, _in_order(rejected), shaped


def _variants(observed: Observed, named: Sequence[Candidate], patterns: Patterns) -> list[Variants]:
    """Each of what was named, as it was and with the shapes of its family that have a threshold: that may be told by a
    few rows alone, other shapes are told by all."""
    variants: list[Variants] = []
    for candidate in named:
        columns = columns_of(observed, candidate)
        of_family = ((item, part) for item, part in patterns if item.family == candidate.family)
        same = [(item, part.whole()) for item, part in of_family if thresholds_of(item)]
        if columns is not None:
            variants.append([(candidate, columns), *same])
    return variants


def _in_order(rejected: Sequence[RejectedRow]) -> tuple[RejectedRow, ...]:
    """In the order of the file, each row once though several of its numbers may be readings."""
    first = {item.row: item for item in reversed(rejected)}
    return tuple(first[row] for row in sorted(first))


def _with_memory(
    observed: Observed,
    patterns: Patterns,
    left: Array,
    noise_floor: float | None,
    rejected: tuple[RejectedRow, ...] = (),
) -> Prepared:
    """Set up with the noise's memory, first that of what a rough model leaves (N, C).

    Where noise remembers much, a rough model that took readings for independent has taken some of it for physics; so
    the model is made again with the memory found, until that no longer grows.
    """
    prepared = set_up(observed, patterns, rejected)
    wandering, together = _wandering(prepared)
    if wandering is not None:
        del prepared  # one pool at a time
        prepared = set_up(wandering, patterns, rejected)
        return replace(prepared, independent=independent_share(wandering, left, noise_floor))
    memory = memory_of(observed.scaled(left), observed)
    if memory != observed.correlation:
        del prepared
        prepared = set_up(replace(observed, correlation=memory), patterns, rejected)
    rules = observed.rules
    # A memory in a long recording is rather physics that the rough model lacks, and goes with the arm's path.
    much = rules.fitting.much_memory * max(1.0, observed.rows * observed.components / rules.search.many)
    for _ in range(_PASSES if memory > much else 0):
        left = _left_by_rough_model(prepared, noise_floor)
        correlation = memory_of(observed.scaled(left), observed)
        if correlation <= prepared.observed.correlation:
            break
        del prepared
        prepared = set_up(replace(observed, correlation=correlation), patterns, rejected)
    return replace(prepared, independent=independent_share(prepared.observed, left, noise_floor), together=together)


def _wandering(prepared: Prepared) -> tuple[Observed | None, int]:
    """The recording with a random walk below the tip's noise, where that says as much of what goes with time as drift,
    a step, a trend or a period does; None where nothing wanders, and where time and pose go together: what goes with
    the arm's path goes with time as well. There, how many neighbouring visits share what may be either."""
    observed = prepared.observed
    rules, width = observed.rules.fitting, observed.components
    which, loud_with = observed.which, observed.loud_with
    kinds, recordings = 1 + int(loud_with.max()), 1 + int(which.max())
    _, first, visit = np.unique(observed.block, return_index=True, return_inverse=True)
    visit = visit.reshape(-1)
    if len(first) < rules.enough or kinds > recordings:
        return None, 1  # several kinds of numbers wander each in its way
    judging = time_vs_path(observed.recording, observed.arm, poses(observed), first, rules=rules)
    judged_by = judging or JudgedVisits(np.arange(len(first)), None)
    count = np.bincount(visit)

    def means(values: Array) -> Array:
        return np.stack([np.bincount(visit, weights=column) / count for column in values.T], axis=1)

    time = means(clock(observed.recording)[:, None])[judged_by.visit, 0]
    rough = _rough_model(prepared, ("force_in_time",))

    def judged(columns: Array) -> Array:
        tip = observed.scaled(columns)[:, :width]
        if tip.size == 0:
            return np.zeros((len(judged_by.visit), *tip.shape[1:]))
        flat = judged_by.of(means(tip.reshape(len(tip), -1)))
        return flat.reshape(len(flat), *tip.shape[1:])

    beside, left = judged(rough.beside), judged(rough.left)
    whole = left + judged(rough.in_time)
    wander = wander_in(whole, time, which[first][judged_by.visit], beside, rules=rules)
    gain = still(left, beside).likelihood - rough.price
    values = without(whole, beside)
    rather = rules.rather_a_drift if rough.drifts else rules.wander_beyond
    excused = gain > wander.likelihood + rather and not (judging is None and rough.wanders)
    if wander.rate <= 0.0 or excused:
        return None, 1
    if judging is None:
        return None, min(remembered(values), max(1, len(first) // observed.rules.search.least_visits))
    if judging.back is None and not rather_with_time(
        values, places(observed.recording.q[first], observed.arm), rules=rules
    ):
        return None, 1
    size = float(np.mean(count))
    scale = observed.scale.copy()
    scale[:width] *= wander.scatter * np.sqrt(size)
    return replace(observed, scale=scale, wander=wander.rate / size, correlation=0.0), 1


def _with_time_alone(candidate: Candidate) -> bool:
    """Whether a pattern goes with time alone: a form that does, or an instrument's drift."""
    if candidate.outside:
        return form_of(candidate).with_time
    effect = EFFECTS[candidate.effect]
    return effect.recording.of_instrument and "time" in effect.requires


@dataclass(frozen=True)
class _Rough:
    """A rough model: what it leaves (N, C), m and rad, what went with time alone and was taken off (N, C), and the
    price of the patterns that did; the nuisances `beside` (N, C, b), which take up some of either."""

    left: Array
    in_time: Array
    beside: Array
    price: float
    drifts: bool
    """Whether that is an even drift alone, which the library has."""
    wanders: bool
    """Whether that is a smooth course alone, which a walk has too."""


def _left_by_rough_model(prepared: Prepared, noise_floor: float | None) -> Array:
    """What a rough model leaves, (N, C) in m and rad."""
    observed = prepared.observed
    # Noise with a memory wanders too: what merely wanders with time must not be taken off before memory is looked for,
    # unless it is far above what repeats differ by, which no memory makes it. A force that wanders at will takes memory
    # in any case.
    mismatch = rms_length(observed.tip_residual())
    may_wander = noise_floor is not None and mismatch > observed.rules.fitting.far_above * noise_floor
    names = [item.name for item in ((FORCE_IN_TIME,) if may_wander else (SMOOTH, TREND, FORCE_IN_TIME))]
    return _rough_model(prepared, names).left


def _rough_model(prepared: Prepared, besides: Sequence[str]) -> _Rough:
    """The few patterns that explain most, one after the other and forms included but for some, by least squares with
    bad rows weighed down: each is chosen for what it explains of readings with such weights."""
    pool, criterion, observed = prepared.pool, prepared.criterion, prepared.observed
    members, columns = list[int](), [prepared.beside]
    barred = np.array([group.candidate.effect in besides for group in pool.groups], dtype=bool)
    stacked, values, weight = bad_rows_down(observed, columns)
    for _ in range(_ROUGH if pool.groups else 0):
        weighed = observed.whitened(np.sqrt(weight)[:, None] * (observed.residual - stacked @ values))
        given = products(pool, pool.projected(weighed)).beside(pool.columns(members))
        left = np.where(barred, given.rss, np.maximum(given.rss - given.gains(), 1e-12 * given.rss))
        left = np.maximum(left, 1e-300)
        best = int(np.argmin(criterion.count * np.log(np.maximum(left, 1e-300)) + criterion.price))
        if criterion(float(left[best]), [*members, best]) >= criterion(given.rss, members):
            break
        members.append(best)
        taken = [pool.groups[m].candidate for m in members]
        shaped = at_best(observed, taken, [prepared.columns[m] for m in members], prepared.beside)
        columns = [prepared.beside, *(part for _, part in shaped)]
        stacked, values, weight = bad_rows_down(observed, columns)
    at = np.cumsum([part.shape[2] for part in columns])
    in_time, price, kinds = np.zeros(observed.residual.shape), 0.0, list[Candidate]()
    for member, end in zip(members, at[1:].tolist(), strict=True):
        if _with_time_alone(candidate := pool.groups[member].candidate):
            part = prepared.columns[member]
            in_time += part @ values[end - part.shape[2] : end]
            price += float(criterion.price[member])
            kinds.append(candidate)
    drifts = bool(kinds) and not any(kind.outside for kind in kinds)
    wanders = bool(kinds) and all(kind.outside and form_of(kind).wanders for kind in kinds)
    left = observed.residual - stacked @ values
    return _Rough(left, in_time, prepared.beside, price, drifts=drifts, wanders=wanders)
