"""The steps in order: what may be visited, what is to be seen there, which visits, their order, what they promise."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.diagnose.fitting.prepare import nuisances
from linkwright.core.diagnose.instruments.camera import is_camera
from linkwright.core.diagnose.instruments.touched import touched_planes
from linkwright.core.diagnose.instruments.touching import least_touches
from linkwright.core.diagnose.options import Progress
from linkwright.core.diagnose.patterns.library import Candidate, candidates, columns_of
from linkwright.core.diagnose.patterns.pool import VISIBLE, orthonormal
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.residual.observed import Observed
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.diagnose.several.recordings import together
from linkwright.core.sections.numeric import Array

from .design import Patterns, chosen_visits
from .order import in_order, returns_of, with_time
from .plan_request import Asked, seen_axes
from .planned import Planned
from .promise import NEVER, Promise, another_cause, is_asked, middle_size, promised, seen_columns
from .torques import promised_by_torques, torque_rows
from .tried import Tried, tried_visits
from .written import as_read, plan_text, read_plan, to_record

_HELD = (
    "file", "q", "tip", "row", "time", "sides", "payload_mass", "last_moves", "slots", "touches", "bar_at",
    "instrument", "frame", "tool", "branch",
)  # fmt: skip
"""What a plan holds of a recording, beside a camera's orientations."""


class NothingToSee(Exception):
    """Nothing of what was asked for moves anything that the instrument sees."""


def plan(arm: Arm, asked: Asked, tell: Progress, after: Recording | None = None) -> Planned:
    """The visits from which the causes asked for are seen smallest and told from others, in an order to record them.

    `after` is a recording that is there already, or several as one: what it shows counts, and the plan goes on from it.
    An interrupt that `tell` raises once there are as many visits as asked for leaves the best of them so far.
    Raises `NoRoom` where that leaves too few poses, ValueError where the instrument sees nothing of a planar arm,
    `NothingToSee`, and what `arm.errors.model.beams_of` raises.
    """
    began = time.perf_counter()
    axes = seen_axes(asked.instrument, arm)
    tell("collecting poses", 0.0)
    tried = tried_visits(arm, asked)
    patterns = _patterns(arm, asked, tried, axes, after)
    rng = np.random.default_rng(asked.seed)
    returns = returns_of(asked)
    barred: tuple[int, ...] = ()
    while True:
        chosen, back, interrupted = chosen_visits(
            patterns,
            asked.poses - returns,
            (lambda visit: _returned(tried, visit, asked)) if returns else lambda _: (),
            asked.rules.plan,
            rng,
            lambda share: tell("choosing visits", 0.05 + 0.6 * share),
            barred,
            lambda taken, back: _unbalanced(tried, [*taken, *(list(back) * (returns // max(len(back), 1)))]),
        )
        more = _touched_too_seldom(arm, tried, [*chosen, *back], asked)
        if interrupted or set(more) <= set(barred):
            break
        barred = (*barred, *more)
    order = in_order(chosen, back, tried.payload, tried.q, tried.sides, asked)
    recording, promise = _checked(arm, asked, tried, order, axes, after)
    random: list[Promise] = []
    try:
        for k in range(0 if interrupted else asked.rules.plan.rivals):
            tell("comparing with poses at random", 0.7 + 0.3 * k / asked.rules.plan.rivals)
            random.append(_checked(arm, asked, tried, _at_random(tried, asked, returns, rng), axes, after)[1])
    except KeyboardInterrupt:
        interrupted = True
    if not interrupted:
        tell("done", 1.0)
    returned = tuple(k + 1 for k, visit in enumerate(order.tolist()) if visit in back)
    correlation = with_time(tried.q[order], tried.sides[order])
    return Planned(
        arm, asked, recording, axes, promise, tuple(random), returned, correlation, tried.size,
        time.perf_counter() - began, after, interrupted,
    )  # fmt: skip


def _unbalanced(tried: Tried, taken: Sequence[int]) -> Sequence[int]:
    """The visits to those places of a bar which those taken touch oftener than another, and where one is behind by two
    all others: so both ends are touched in pairs."""
    if tried.along is None or tried.label is None:
        return ()
    places, place = np.unique(tried.along, return_inverse=True)
    at = tried.label * len(places) + place.reshape(-1)
    counts = np.bincount(at[list(taken)], minlength=(int(tried.label.max()) + 1) * len(places))
    counts = counts.reshape(-1, len(places))
    unwanted = counts > counts.min(axis=1)[:, None]
    behind = np.ptp(counts, axis=1) >= 2
    if behind.any():
        unwanted |= ~behind[:, None]
    return np.flatnonzero(unwanted.reshape(-1)[at]).tolist()


def _touched_too_seldom(arm: Arm, tried: Tried, visits: Sequence[int], request: Asked) -> tuple[int, ...]:
    """All visits tried to points, planes or bars that those chosen touch, but so seldom that nothing would come of it,
    on a line, or at one place of the bar."""
    if tried.label is None:
        return ()
    planes, flat, chosen = request.instrument == "plane", arm.planar(), np.array(visits, dtype=np.int64)
    least, count = least_touches(planes=planes, flat=flat), int(tried.label.max()) + 1
    label = tried.label[chosen]
    few = [index for index in range(count) if 0 < len(np.unique(tried.q[chosen[label == index]], axis=0)) < least]
    if tried.along is not None:
        along = tried.along[chosen]
        few += [index for index in range(count) if len(np.unique(along[label == index])) == 1]
    if planes:
        reach = touched_planes(tip_position(arm, tried.q[chosen]), label, count, flat=flat)[2]
        size = float(np.linalg.norm(np.ptp(tip_position(arm, tried.q), axis=0)))
        narrow = reach[:, 1] <= request.rules.plan.across_plane * size
        few += [index for index in range(count) if narrow[index] and (label == index).any()]
    return tuple(np.flatnonzero(np.isin(tried.label, few)).tolist())


def _returned(tried: Tried, visit: int, request: Asked) -> Sequence[int]:
    """The pose and sides of a visit under each payload, as numbers of what was tried."""
    same = (tried.q == tried.q[visit]).all(axis=1) & (tried.sides == tried.sides[visit]).all(axis=1)
    return [int(np.flatnonzero(same & (tried.payload == mass))[0]) for mass in request.payloads]


def _at_random(tried: Tried, request: Asked, count: int, rng: np.random.Generator) -> NDArray[np.int64]:
    """As many visits at poses spread over the ranges, under any payload and from any side, in an order of the same
    kind."""
    usable = np.flatnonzero(tried.random) if tried.random.sum() >= request.poses else np.arange(tried.size)
    drawn = rng.permutation(usable)[: request.poses - count + 1].tolist()
    back = list(_returned(tried, drawn[-1], request)) if count else []
    chosen = drawn[: request.poses - count]
    return in_order(chosen, back, tried.payload, tried.q, tried.sides, request)


def _checked(
    arm: Arm, request: Asked, tried: Tried, order: NDArray[np.int64], axes: Sequence[str], after: Recording | None
) -> tuple[Recording, Promise]:
    """The visits as a recording, and what it will show by the file that holds it."""
    made = to_record(arm, tried, order, request)
    with TemporaryDirectory() as folder:
        path = Path(folder) / "plan.csv"
        path.write_text(plan_text(made, arm, axes, torques=bool(request.torque_noise)), encoding="utf-8")
        read = as_read(read_plan(path, arm, rules=request.rules), arm, request)
        # The visits are numbered through, whatever lines stand above them.
        numbers = np.arange(1, read.size + 1)
        read = replace(read, file="", row=numbers, frame=request.frame, tool=request.tool)
    promise = promised(arm, read if after is None else going_on(after, read, arm, request.rules), axes, request)
    # Each recording's torques are looked at by themselves.
    return read, replace(promise, torques=promised_by_torques(arm, read, request))


def going_on(before: Recording, then: Recording, arm: Arm, rules: Rules) -> Recording:
    """A recording and a plan after it, as a diagnosis takes both: of the first what a plan has too."""
    return together([*_as_plans(before), then], arm, rules=rules.residual)


def _as_plans(before: Recording) -> list[Recording]:
    """The readings of each recording with no more than what a plan holds."""
    return [_as_plan(item) for item in before.singles]


def _as_plan(before: Recording) -> Recording:
    held = (*_HELD, *(("orientation", "seat") if is_camera(before) else ()))
    return Recording(**{name: getattr(before, name) for name in held})


def _patterns(arm: Arm, request: Asked, tried: Tried, axes: Sequence[str], after: Recording | None) -> Patterns:
    """What the causes look like at every visit tried. Raises `NothingToSee`."""
    made = to_record(arm, tried, np.arange(tried.size), replace(request, repeats=1))
    there = as_read(made, arm, request)
    observed = _in_any_order(arm, replace(there, frame=request.frame, tool=request.tool), request)
    chosen = _one_of_each(observed, request)
    scale = [_usual(candidate, columns, observed, axes, request) for candidate, columns in chosen]
    beside = nuisances(observed)[0]
    rows = _rows(observed, [beside, *(c * s for (_, c), s in zip(chosen, scale, strict=True))], axes, request)
    known = np.zeros((rows.shape[2],) * 2)
    if after is not None:
        plans = _as_plans(after)
        recorded = _in_any_order(
            arm, plans[0] if len(plans) == 1 else together(plans, arm, rules=request.rules.residual), request
        )
        nuisance_columns = nuisances(recorded)[0]
        seen_columns = [columns_of(recorded, candidate) for candidate, _ in chosen]
        nothing = np.zeros((recorded.rows, recorded.residual.shape[1], 1))
        parts = [
            nothing * s if columns is None or columns.shape[2] != len(s) else columns * s
            for columns, s in zip(seen_columns, scale, strict=True)
        ]
        taken = _rows(recorded, [nuisance_columns], axes, request).reshape(
            len(axes) * recorded.rows, nuisance_columns.shape[2]
        )
        left = _rows(recorded, parts, axes, request).reshape(len(taken), -1)
        base = orthonormal(taken)
        left = left - base @ (base.T @ left)
        known[beside.shape[2] :, beside.shape[2] :] = left.T @ left
    patterns = _to_choose(chosen, rows * np.sqrt(request.repeats), beside.shape[2], known, request)
    return _with_torques(patterns, arm, there, request) if request.torque_noise else patterns


def _with_torques(patterns: Patterns, arm: Arm, tried: Recording, request: Asked) -> Patterns:
    """The same with what the drives' torques show of weights and friction, each asked for beside the causes; no cause
    is mistaken for those."""
    unasked, wanted = (np.sqrt(request.repeats) * row for row in torque_rows(arm, tried, request))
    before, count = unasked.shape[2], wanted.shape[2]
    first, size = patterns.nuisances, patterns.rows.shape[2]

    tip = patterns.rows
    of_tip, of_drives = ((*part.shape[:2],) for part in (tip, unasked))
    seen = [tip[:, :, :first], np.zeros((*of_tip, before)), tip[:, :, first:], np.zeros((*of_tip, count))]
    held = [np.zeros((*of_drives, first)), unasked, np.zeros((*of_drives, size - first)), wanted]
    rows = np.concatenate([np.concatenate(seen, axis=2), np.concatenate(held, axis=2)], axis=1)
    columns = np.concatenate([np.arange(first), np.arange(first, size) + before])
    known = np.zeros((rows.shape[2],) * 2)
    known[np.ix_(columns, columns)] = patterns.known
    added = np.arange(count) + size - first
    return replace(
        patterns,
        rows=rows,
        nuisances=first + before,
        known=known,
        asked=np.concatenate([patterns.asked, added]).astype(np.int64),
        against=np.concatenate([patterns.against, np.zeros((count, patterns.against.shape[1]), dtype=bool)]),
    )


def _in_any_order(arm: Arm, recording: Recording, request: Asked) -> Observed:
    """Readings without what their order tells, which comes later."""
    return observe(arm, replace(recording, time=None, last_moves=None), rules=request.rules)


def _one_of_each(observed: Observed, request: Asked) -> list[tuple[Candidate, Array]]:
    """Each cause with its columns (V, C, d): of its variants with most sizes the one in the middle, and of those asked
    for the first and the last as well."""
    families: dict[object, list[tuple[Candidate, Array]]] = {}
    for candidate, columns in candidates(observed):
        families.setdefault(candidate.family, []).append((candidate, columns))
    chosen: list[tuple[Candidate, Array]] = []
    for variants in families.values():
        most = max(columns.shape[2] for _, columns in variants)
        full = [variant for variant in variants if variant[1].shape[2] == most]
        if is_asked(full[0][0].effect, full[0][0].at, request.effects):
            chosen += [full[k] for k in sorted({0, len(full) // 2, len(full) - 1})]
        elif not request.pairs_only and most <= request.rules.plan.widest_rival:
            chosen.append(full[len(full) // 2])
    return chosen


def _usual(candidate: Candidate, columns: Array, observed: Observed, axes: Sequence[str], request: Asked) -> Array:
    """The middle of each column's usual sizes (d,); of products with unknown weights what is as the scatter is."""
    if len(candidate.sizes) == columns.shape[2]:
        return np.array([middle_size(candidate, name) for name in candidate.sizes])
    rms = np.sqrt(np.mean(np.sum(seen_columns(observed, columns, axes, request.scatter(axes)) ** 2, axis=1), axis=0))
    return 1.0 / np.where(rms > 0.0, rms, 1.0)


def _rows(observed: Observed, parts: Sequence[Array], axes: Sequence[str], request: Asked) -> Array:
    """Columns (V, C, d) one beside another, as the instrument's readings have them, over their scatter."""
    return seen_columns(observed, np.concatenate(parts, axis=2), axes, request.scatter(axes))


def _to_choose(
    chosen: Sequence[tuple[Candidate, Array]], rows: Array, beside: int, known: Array, request: Asked
) -> Patterns:
    """What the choice goes by: causes that the nuisances swallow wherever the arm stands, and pairs that no pose tells,
    are left out. Raises `NothingToSee`."""
    flat = rows.reshape(-1, rows.shape[2])
    base = orthonormal(flat[:, :beside])
    left = flat[:, beside:] - base @ (base.T @ flat[:, beside:])
    total, whole = left.T @ left + known[beside:, beside:], np.sum(flat[:, beside:] ** 2, axis=0)
    rules = request.rules
    seen = total.diagonal() > VISIBLE**2 * (whole + known.diagonal()[beside:])
    starts = np.cumsum([0, *(columns.shape[2] for _, columns in chosen)])
    spans = [np.arange(a, b)[seen[a:b]] for a, b in pairwise(starts.tolist())]
    to_choose = [
        span[span < start + len(item.sizes)] if is_asked(item.effect, item.at, request.effects) else span[:0]
        for span, start, (item, _) in zip(spans, starts[:-1].tolist(), chosen, strict=True)
    ]
    columns = np.concatenate(to_choose or [np.zeros(0)])
    if not len(columns):
        raise NothingToSee
    owner = np.repeat(np.arange(len(chosen)), np.diff(starts)).tolist()
    visible = np.flatnonzero(seen)
    asks = columns.astype(np.int64)
    rivals = [k for k, span in enumerate(spans) if 0 < len(span) <= rules.plan.widest_rival]
    against = np.zeros((len(asks), len(rivals)), dtype=bool)
    for number, rival in enumerate(rivals):
        block = np.linalg.pinv(total[np.ix_(spans[rival], spans[rival])], rcond=1e-9, hermitian=True)
        mixed = total[np.ix_(asks, spans[rival])]
        likeness = np.einsum("ad,de,ae->a", mixed, block, mixed) / total[asks, asks]
        other = np.array([another_cause(chosen[owner[column]][0], chosen[rival][0]) for column in asks.tolist()])
        against[:, number] = other & (likeness < NEVER**2)
    place = np.cumsum(seen) - 1
    whole_rows = np.concatenate([rows[:, :, :beside], rows[:, :, beside + visible]], axis=2)
    inside = np.concatenate([np.arange(beside), beside + visible])
    return Patterns(
        whole_rows,
        beside,
        known[np.ix_(inside, inside)],
        place[asks],
        tuple(slice(int(place[spans[k][0]]), int(place[spans[k][-1]]) + 1) for k in rivals),
        against,
        rules.answer.told,
    )
