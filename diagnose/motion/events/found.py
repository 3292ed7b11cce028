"""Events in a log: pushes on a link and loads for a while, which are no physics of the arm."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects.loads.payload import PAYLOAD
from linkwright.core.diagnose.motion.log import MotionLog
from linkwright.core.diagnose.motion.model.candidates import Candidates
from linkwright.core.diagnose.motion.model.noise import Noise, noise
from linkwright.core.diagnose.motion.model.products import products
from linkwright.core.diagnose.motion.model.rows import LogRows, joint_rows, with_sources
from linkwright.core.diagnose.motion.model.steps import may_differ, tried
from linkwright.core.diagnose.motion.preparation import STRETCH
from linkwright.core.diagnose.motion.result import Event
from linkwright.core.diagnose.result import HALF, FittedParameter
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array

from .changed import Logs, roughly, settled_at, stepped
from .placed import SETTLED, Placed, placed
from .push import PUSH, with_pushes

_PARTS = 40
"""Parts of a log whose median says what is usual."""
_ROUNDS = 3
"""Times that the rest of a log foretells what stands out, until that stands."""
_MOST = 12
"""Events that are sought in the logs at most."""
_DRAWS = 10_000
"""Of a push: an end of its 95 % interval is then good to one part in a hundred of its width."""
_FELT = 0.999
"""Of the square of what is usual: a direction in which a push is no better known no joint feels."""

Span = tuple[int, int]
"""A row, and the one after the last."""


def next_event(
    arm: Arm, pool: Candidates, rows: Sequence[LogRows], seen: Noise, known: Sequence[Event], *, rules: Rules
) -> Event | None:
    """A push or a load in some log beside the events that are `known`, and set aside; None where there is none.

    Rows stand out that are further from what the whole library foretells than any usual row is. What the rest of the
    log foretells of them is held against a push on each link, and against the whole library.

    Args:
        arm: The arm.
        pool: The candidates.
        rows: Those of all logs.
        seen: What the whole library leaves of them.
        known: Events that are set aside.
        rules: What stands out.
    """
    for number, row in enumerate(rows if len(known) < _MOST else ()):
        # An event raises what is usual by what the library makes of it: the first look is less strict.
        least = rules.motion.event
        clean, span, other = seen, _standing_out(row, seen.sizes, (0, 0), least), (0, 0)
        for _ in range(_ROUNDS):
            if span is None or span == other:
                break
            others = [_without(item, span) if k == number else item for k, item in enumerate(rows)]
            clean = noise(pool, products(joint_rows(others), pool.width, near=False))
            span, other = _standing_out(row, clean.sizes, span, least**2), span
        # Beyond where a quarter of it is reached lies what the low-pass makes of it.
        half = None if span is None else _standing_out(row, clean.sizes, span, least**2, HALF**2)
        event = None if half is None else _push(arm, pool, rows, number, half, clean, rules)
        if event is not None:
            return event
    loads = (_load(pool, row, rules) for row in (rows if len(known) < _MOST else ()))
    return next((event for event in loads if event is not None), None)


def _load(pool: Candidates, row: LogRows, rules: Rules) -> Event | None:
    """A load that is taken or left within a log; None where something else explains more, or that not most of it. What
    differs between logs is no event: each is fitted by itself."""
    heard = noise(pool, products(joint_rows([row]), pool.width, near=False))
    clock = row.prepared.motion.time[row.prepared.kept]
    for made in stepped(pool, [row], heard, may_differ(pool), rules=rules):
        within = min(made.change.start.time - clock[0], clock[-1] - made.change.start.time) > STRETCH
        load = within and made.change.effect == PAYLOAD.id and made.within > 1.0 - HALF**2
        for size in made.change.parameters if load else ():
            if size.parameter == "mass" and size.interval[0] * size.interval[1] > 0.0:
                return Event("payload left" if size.value < 0.0 else "payload taken", made.change)
    return None


def set_aside(logs: Sequence[MotionLog], prepared: Sequence[LogRows], event: Event) -> list[MotionLog]:
    """The logs without an event's rows; of a change that lasts, without what comes before it where that is short."""
    made = list[MotionLog]()
    for log, row in zip(logs, prepared, strict=True):
        begin, end = event.change.start, event.change.end
        around = SETTLED / min(row.prepared.cutoff, row.prepared.rate)
        aside = (begin.interval[0] - around, (np.inf if end is None else end.interval[1]) + around)
        if end is None and begin.time - log.time[0] < HALF * (log.time[-1] - begin.time):
            aside = (-np.inf, begin.interval[1] + around)
        here = log.file == event.change.log
        made.append(replace(log, aside=(*log.aside, aside)) if here else log)
    return made


def _standing_out(row: LogRows, sizes: Array, but: Span, least: float, most: float = 0.0) -> Span | None:
    """The rows that stand out most by sizes (W,) of the whole library: by so many times at `least` the square that is
    usual of all `but` some, and by a share of the `most` that any row does."""
    moving = row.prepared.moving
    left = np.square(row.target - row.explained(sizes)) * moving
    part = np.arange(len(left)) * _PARTS // max(len(left), 1)
    part[but[0] : but[1]] = _PARTS
    counts = np.stack([np.bincount(part, each, _PARTS + 1)[:_PARTS] for each in moving.T.astype(float)])
    squares = np.stack([np.bincount(part, each, _PARTS + 1)[:_PARTS] for each in left.T])
    usual = np.array(
        [
            np.median(square[count > 0] / count[count > 0]) if (count > 0).any() else np.inf
            for square, count in zip(squares, counts, strict=True)
        ]
    )
    times = (left / np.maximum(usual, 1e-300)).max(axis=1)
    beyond = times - max(least, most**2 * times.max()) * moving.any(axis=1)
    total = np.concatenate(([0.0], np.cumsum(beyond)))
    stop = int(np.argmax(total - np.minimum.accumulate(total)))
    return (int(np.argmin(total[:stop])), stop) if stop and total[stop] > total[:stop].min() else None


def _without(row: LogRows, span: Span) -> LogRows:
    """The rows of which some do not count."""
    around = int(np.ceil(row.prepared.rate / min(row.prepared.cutoff, row.prepared.rate)))
    kept = row.prepared.kept
    inside = (kept >= kept[span[0]] - around) & (kept <= kept[span[1] - 1] + around)
    return replace(row, prepared=replace(row.prepared, moving=row.prepared.moving & ~inside[:, None]))


def _push(
    arm: Arm, pool: Candidates, rows: Sequence[LogRows], number: int, span: Span, clean: Noise, rules: Rules
) -> Event | None:
    """The push that explains what stands out in a log (its number); None where something else does, or a push would
    load one joint alone, as whatever a drive has of its own does."""
    wider, pushes = with_pushes(pool, arm)
    more = wider.sources[len(pool.sources) :]
    size = np.square(rows[number].target - rows[number].explained(clean.sizes))[slice(*span)].mean(axis=0)
    weights = 1.0 / (1.0 / clean.weights + rules.motion.steady**2 * size)
    logs = Logs(wider, [with_sources(row, more) for row in rows], weights)
    motion, there = logs.between(number, *span)
    steps = list(tried(logs.fitted(motion), [there], [*may_differ(pool), *pushes]))
    likeliest = max(steps, key=lambda item: item.gain)
    if likeliest.gain <= 0.0:
        return None
    # Cut to rows after the low-pass, what is short is far from any push: which it is, the instants tell.
    likely = [step for step in steps if step.gain > HALF * likeliest.gain]
    alone, start, end = roughly(logs, number, logs.fitted(motion, (likeliest,)))
    items = [placed(logs.rows[number], alone, step, start, end) for step in likely]
    best = _likeliest(items, rules)
    if best.step.group.effect is not PUSH or best.step.gain <= np.log(len(steps)) + rules.search.margin:
        return None
    made = settled_at(logs.rows[number], alone, best, rules=rules)
    loaded = np.flatnonzero(np.array(made.change.torque) > rules.motion.event * clean.sigma)
    if made.within <= 1.0 - HALF**2 or len(loaded) < 2:
        return None
    of_link = dict[int, Placed]()
    for item in sorted(items, key=lambda item: item.step.gain):
        if item.step.group.effect is PUSH and item.step.gain > best.step.gain - rules.search.refuted_odds:
            of_link[item.step.group.at[0]] = item
    links, alike = sorted(of_link), tuple(of_link.values())
    change = replace(made.change, parameters=_force(alike, made.change.at))
    end = change.end
    short = end is not None and end.time - change.start.time < rules.motion.collision
    joints = tuple(int(joint) + 1 for joint in loaded)
    return Event("collision" if short else "contact", change, joints, tuple(links))


def _likeliest(items: Sequence[Placed], rules: Rules) -> Placed:
    """The likeliest of what may have acted for a while. Of a push and a load that are as likely it is the push where
    the load would be taken for less time than any load that is looked for."""
    best = max(items, key=lambda item: item.step.gain)
    if best.step.group.effect is not PAYLOAD or best.end is None or best.end.time - best.start.time > STRETCH:
        return best
    alike = (item for item in items if item.step.gain > best.step.gain - rules.search.refuted_odds)
    pushes = (item for item in alike if item.step.group.effect is PUSH)
    return max(pushes, key=lambda item: item.step.gain, default=best)


def _force(alike: Sequence[Placed], at: tuple[int, ...]) -> tuple[FittedParameter, ...]:
    """How large the push is, over all its instants, directions and links that are likely; what no joint feels of it
    does not count."""
    rng = np.random.default_rng(0)
    gain = np.array([item.step.gain for item in alike])
    chance = np.exp(gain - gain.max())
    sizes = list[Array]()
    for item, count in zip(alike, rng.multinomial(_DRAWS, chance / chance.sum()).tolist(), strict=True):
        usual = item.step.group.usual
        scatter, directions = np.linalg.eigh(item.step.covariance / np.outer(usual, usual))
        felt = directions[:, scatter < _FELT]
        numbers = (item.pairs.drawn(count, rng) / usual) @ felt @ felt.T * usual
        sizes.append(np.linalg.norm(numbers.reshape(count, -1, 3).sum(axis=1), axis=1))
    low, size, high = np.quantile(np.concatenate(sizes), (0.025, 0.5, 0.975)).tolist()
    return (FittedParameter("force", "force", at, "force", size, (low, high)),)
