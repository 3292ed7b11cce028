"""Which poses to record next: those that tell the names which the data could not tell apart.

Criterion: the smallest non-centrality over all pairs (named effect, alternative), as in T-optimal designs
(A. C. Atkinson & V. V. Fedorov, Biometrika 62 (1975) 57, doi:10.1093/biomet/62.1.57): of the poses, payloads and sides
tried, the one is taken that adds most to the pair least told, again and again. Tried are poses where the arm may be put
(`arm.avoid.poses.Room`), under payloads that it has carried.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwright.core.arm.avoid.poses import Room, approach, drawn, room_of
from linkwright.core.arm.chain.following import completed
from linkwright.core.diagnose.fitting.fit import fit
from linkwright.core.diagnose.fitting.prepare import nuisances
from linkwright.core.diagnose.instruments.registry import kinds_of
from linkwright.core.diagnose.patterns.library import columns_of
from linkwright.core.diagnose.recording import Recording, since_the_reading_before
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.residual.observed import Observed
from linkwright.core.diagnose.result import NextPose
from linkwright.core.diagnose.rules.answer_rules import AnswerRules
from linkwright.core.diagnose.search.aliases import Rival
from linkwright.core.diagnose.search.naming import Namer
from linkwright.core.diagnose.several.recordings import Several
from linkwright.core.sections.numeric import Array

from .sentences import label_of

_Name = tuple[int, int]
_TRIED, _TAKEN = 150, 6
"""Poses that are tried, and readings that are proposed."""
_HOPELESS = "No pose tells {}. Only another sensor would."
_BEYOND = (
    "No pose in the recorded range tells {}, but some beyond would. Write what to keep clear of (`avoid` in "
    "recording.yaml or the arm file), and such poses are proposed."
)


@dataclass(frozen=True)
class NextPoses:
    """`poses` worth recording next, whether once is `enough` to tell the names that they help to tell, and a `note` on
    that and on where they lie, or on what would help where they do not."""

    poses: tuple[NextPose, ...] = ()
    enough: bool = False
    note: str = ""


@dataclass(frozen=True)
class _Pair:
    """A name against another: the named effect's displacement at recorded and tried readings, and the columns that the
    other name (with nuisances and all other findings) has there; all whitened, the recorded ones as a triangular
    factor of theirs."""

    label: str
    signal: Array
    tried_signal: Array
    columns: Array
    tried_columns: Array


def next_poses(
    namer: Namer, members: Sequence[int], alternatives: Sequence[tuple[int, Sequence[Rival]]], seed: int
) -> NextPoses:
    """Poses worth recording next, by how much they tell names apart; none that would not."""
    asked = [(member, rival.member) for member, rivals in alternatives for rival in rivals[:3]]
    if not asked:
        return NextPoses()
    observed = namer.prepared.observed
    if not _can_be_tried(observed):
        return NextPoses(
            note="Poses worth recording next are worked out for positions, and for heights and distances from a known "
            "place."
        )
    room = room_of(observed.arm_given, observed.recording.q, observed.recording.avoid)
    result = _choice(namer, members, asked, room, seed)
    if result is None:
        return NextPoses(note="What is to be avoided leaves no pose to record next.")
    lost = [pair for pair in result.pairs if pair not in result.helped]
    beyond = _choice(namer, members, lost, Room(), seed) if lost and room.within is not None else None
    notes = [
        (_BEYOND if beyond is not None and item in beyond.helped else _HOPELESS).format(result.pairs[item].label)
        for item in lost
    ]
    if not result.helped:
        return NextPoses(note=" ".join(notes))
    before, after = (result.least(rows) for rows in ([], result.taken))
    enough = after >= observed.rules.answer.told
    better = "" if enough else " better" if after >= 2.0 * before else " slightly better"
    repeat = "" if enough else " Record each several times."
    figures = f"smallest non-centrality {_figure(before)} now, {_figure(after)} with them"
    raised = f"These poses separate the candidates{better} ({figures}).{repeat}"
    return NextPoses(result.poses(), enough, " ".join((raised, *notes, _where(room))))


@dataclass(frozen=True)
class _Choice:
    """Readings `tried` somewhere, those `taken` (by their numbers), all `pairs` of names, and those of them that these
    help to tell."""

    tried: Observed
    taken: Sequence[int]
    pairs: Mapping[_Name, _Pair]
    helped: Mapping[_Name, _Pair]

    def least(self, rows: Sequence[int]) -> float:
        """The smallest non-centrality of the pairs that are helped, with some of the readings tried."""
        width = self.tried.residual.shape[1]
        return min(_noncentrality(pair, rows, width) for pair in self.helped.values())

    def poses(self) -> tuple[NextPose, ...]:
        """The poses taken, each with the pair that it tells most of."""
        width, pairs = self.tried.residual.shape[1], list(self.helped.values())
        return tuple(_as_pose(self.tried.recording, row, pairs, width) for row in self.taken)


def _choice(namer: Namer, members: Sequence[int], names: Sequence[_Name], room: Room, seed: int) -> _Choice | None:
    """The readings to take of those in a room; None where there is no pose."""
    tried = _tried(namer.prepared.observed, room, seed)
    if tried is None:
        return None
    width = tried.residual.shape[1]
    made = {name: _pair(namer, tried, members, *name) for name in dict.fromkeys(names)}
    pairs = {key: pair for key, pair in made.items() if pair is not None}
    taken, helped = _worth_taking(pairs, width, tried.rules.answer)
    return _Choice(tried, taken, pairs, helped)


def _worth_taking(pairs: Mapping[_Name, _Pair], width: int, rules: AnswerRules) -> tuple[list[int], dict[_Name, _Pair]]:
    """The readings to take, and the pairs that they help to tell. Pairs that these together hardly raise, however much
    each would by itself, are left aside one after the other, the least raised first."""
    helped = {key: p for key, p in pairs.items() if float(_row_gains(p, width).max(initial=0.0)) >= rules.hopeless}
    while helped:
        taken = _greedy(list(helped.values()), width, _TAKEN)
        gains = {key: _noncentrality(p, taken, width) - _noncentrality(p, [], width) for key, p in helped.items()}
        least = min(gains, key=lambda gain: gains[gain])
        if gains[least] >= rules.hopeless * len(taken):
            return taken, helped
        del helped[least]
    return [], {}


def _greedy(pairs: Sequence[_Pair], width: int, poses: int) -> list[int]:
    taken: list[int] = []
    for _ in range(min(poses, len(pairs[0].tried_signal) // width)):
        reached = [_noncentrality(pair, taken, width) for pair in pairs]
        weakest = pairs[int(np.argmin(reached))]
        gain = _row_gains(_with_rows(weakest, taken, width), width)
        gain[taken] = -1.0
        taken.append(int(np.argmax(gain)))
    return taken


def _with_rows(pair: _Pair, rows: Sequence[int], width: int) -> _Pair:
    if not rows:
        return pair
    at = (np.array(rows)[:, None] * width + np.arange(width)).reshape(-1)
    return replace(
        pair,
        signal=np.concatenate([pair.signal, pair.tried_signal[at]]),
        columns=np.concatenate([pair.columns, pair.tried_columns[at]]),
    )


def _row_gains(pair: _Pair, width: int) -> Array:
    """How much each tried reading would add to the non-centrality, with the other name fitted to what there is."""
    values = np.linalg.lstsq(pair.columns, pair.signal, rcond=1e-8)[0]
    missed = pair.tried_signal - pair.tried_columns @ values
    return np.sum(missed.reshape(-1, width) ** 2, axis=1)


def _noncentrality(pair: _Pair, rows: Sequence[int], width: int) -> float:
    full = _with_rows(pair, rows, width)
    values = np.linalg.lstsq(full.columns, full.signal, rcond=1e-8)[0]
    return float(np.sum((full.signal - full.columns @ values) ** 2))


def _can_be_tried(observed: Observed) -> bool:
    """Whether it is known what the instrument would read elsewhere: the whole place, or in each row the same of what
    is measured from a place that nobody has to find."""
    recording, view = observed.recording, observed.view
    if recording.slots is None or view is None:
        return True
    if isinstance(recording, Several) or view.names or recording.frame == "free":
        return False
    alike = bool((recording.slots == recording.slots[0]).all())
    return alike and all(kind.elsewhere for kind in kinds_of(recording.slots))


def _tried(observed: Observed, room: Room, seed: int) -> Observed | None:
    """Readings at random poses within the joint ranges that keep to their room, there and where they are come from,
    without payload and with the heaviest that the arm has carried, from either side; None where there is no such
    pose."""
    rng = np.random.default_rng(seed)
    arm, recording = observed.arm_given, observed.recording
    ends = np.array([joint.range for joint in arm.joints])
    run = approach(arm)
    q = drawn(
        room,
        (ends[:, 0], ends[:, 1]),
        lambda low, high: rng.uniform(low, high, (_TRIED, arm.size)),
        lambda points: room.kept(arm, completed(arm, np.round(points, 4)), run),
        _TRIED,
    )
    count = len(q)
    if not count:
        return None
    payload = arm.payload.mass if recording.payload_mass is None else float(recording.payload_mass.max())
    loads = np.unique([0.0, max(payload, 0.0)])
    sides = rng.choice([-1.0, 1.0], count)
    end = 0.0 if recording.time is None else float(recording.time.max())
    later: Array = end + 60.0 * np.arange(1.0, count + 1.0)
    temperature = recording.temperature
    made = Recording(
        file=recording.file,
        q=q,
        tip=np.zeros((count, observed.components)),
        row=np.arange(1, count + 1),
        time=None if recording.time is None else later,
        last_moves=since_the_reading_before(q),
        sides=np.repeat(sides[:, None], arm.size, axis=1),
        payload_mass=rng.choice(loads, count),
        temperature=None if temperature is None else np.full(count, float(np.median(temperature))),
        velocity=None if recording.velocity is None else np.zeros((count, arm.size)),
        acceleration=None if recording.acceleration is None else np.zeros((count, arm.size)),
        joint_side=None if recording.joint_side is None else q.copy(),
        commanded=None if recording.commanded is None else q.copy(),
        base_target=None if recording.base_target is None else np.tile(recording.base_target.mean(axis=0), (count, 1)),
        orientation=np.tile(np.eye(3), (count, 1, 1)) if observed.has_turns else None,
        seat="free" if observed.has_turns else "unused",
        slots=None if recording.slots is None else np.tile(recording.slots[:1], (count, 1)),
        instrument=recording.instrument,
    )
    # A free tool stands where it was found.
    arm = replace(arm, tool=observed.arm.tool)
    return observe(arm, made, scale=observed.scale, rules=observed.rules).softened(observed.softening)


def _pair(namer: Namer, tried: Observed, members: Sequence[int], member: int, other: int) -> _Pair | None:
    prepared = namer.prepared
    sizes = fit(prepared, list(members)).sizes[list(members).index(member)]
    columns = columns_of(tried, namer.pool.groups[member].candidate)
    known = [m for m in members if m != member and not namer.pool.groups[m].candidate.outside]
    rest = [columns_of(tried, namer.pool.groups[m].candidate) for m in (*known, other)]
    if columns is None or any(part is None for part in rest):
        return None
    there = [part for part in rest if part is not None]
    recording = prepared.observed.recording
    # Of several recordings it is the last that goes on: what the others swallow has no part in it.
    last = recording.singles[-1]
    nuisance_columns, _ = nuisances(
        replace(tried, recording=replace(tried.recording, frame=last.frame, tool=last.tool))
    )
    others = prepared.beside.shape[2] - nuisance_columns.shape[2]
    beside = np.pad(nuisance_columns, ((0, 0), (0, 0), (others, 0)))
    recorded = np.concatenate([prepared.beside, *(prepared.columns[m] for m in (*known, other))], axis=2)
    white = prepared.observed.whitened
    # Least squares sees the recorded rows through their triangular factor alone.
    both = np.column_stack([white(recorded), white(prepared.columns[member] @ sizes)])
    factor: Array = np.linalg.qr(both).R
    names = tuple(_label(namer, number) for number in (member, other))
    return _Pair(
        f"{names[0]} from {names[1]}",
        factor[:, -1],
        tried.whitened(columns @ sizes),
        factor[:, :-1],
        tried.whitened(np.concatenate([beside, *there], axis=2)),
    )


def _label(namer: Namer, number: int) -> str:
    candidate = namer.pool.groups[number].candidate
    return label_of(candidate, namer.prepared.observed.recording)


def _as_pose(recording: Recording, row: int, pairs: Sequence[_Pair], width: int) -> NextPose:
    gains = [float(_row_gains(pair, width)[row]) for pair in pairs]
    payload = None if recording.payload_mass is None else float(recording.payload_mass[row])
    side = 1 if recording.sides is None else int(recording.sides[row, 0])
    q = tuple(float(value) for value in recording.q[row])
    return NextPose(q, payload, side, pairs[int(np.argmax(gains))].label)


def _figure(value: float) -> str:
    return f"{value:.1f}" if value >= 1.0 else f"{value:.2f}"


def _where(room: Room) -> str:
    """Where poses were proposed, and what nobody looked at."""
    if room.within is None:
        return (
            "The poses and their approaches keep clear of what is to be avoided, not the ways between. "
            "Nothing else is checked."
        )
    return (
        "No `avoid` regions are given, so the poses stay inside the recorded range. They are not checked for "
        "collisions."
    )
