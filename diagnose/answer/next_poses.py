"""Which poses to record next: those that tell the names which the data could not tell apart.

Criterion: the smallest non-centrality over all pairs (named effect, alternative), as in T-optimal designs
(A. C. Atkinson & V. V. Fedorov, Biometrika 62 (1975) 57, doi:10.1093/biomet/62.1.57): of the poses, payloads and sides
tried, the one is taken that adds most to the pair least told, again and again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from arm.chain.following import completed
from diagnose.fitting.fit import fit
from diagnose.fitting.prepare import nuisances
from diagnose.instruments.instrument import POINT
from diagnose.patterns.library import columns_of
from diagnose.recording import Recording, since_the_reading_before
from diagnose.residual.observe import observe
from diagnose.residual.observed import Observed
from diagnose.result import NextPose
from diagnose.search.aliases import Rival
from diagnose.search.naming import Namer
from diagnose.several.recordings import Several
from sections.numeric import Array

from .sentences import label_of


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
) -> tuple[tuple[NextPose, ...], str]:
    """Poses worth recording next, and a sentence on what they would decide."""
    asked = [(member, rival.member) for member, rivals in alternatives for rival in rivals[:3]]
    if not asked:
        return (), ""
    rules = namer.prepared.observed.rules.answer
    if not _can_be_tried(namer.prepared.observed):
        return (), (
            "Poses worth recording next are worked out for positions, and for heights and distances from a known place."
        )
    tried = _tried(namer.prepared.observed, seed)
    width = tried.residual.shape[1]
    pairs: list[_Pair] = []
    hopeless: list[str] = []
    for member, other in asked:
        pair = _pair(namer, tried, members, member, other)
        if pair is None:
            continue
        gain = _row_gains(pair, width)
        if float(gain.max(initial=0.0)) < rules.hopeless:
            hopeless.append(pair.label)
        else:
            pairs.append(pair)
    taken = _greedy(pairs, width, rules.taken) if pairs else []
    poses = tuple(_as_pose(tried.recording, row, pairs, width) for row in taken)
    return poses, _note(pairs, hopeless, taken, width, rules.told)


def _greedy(pairs: Sequence[_Pair], width: int, poses: int) -> list[int]:
    taken: list[int] = []
    for _ in range(poses):
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
    return bool((recording.slots == recording.slots[0]).all()) and int(recording.slots.max()) < POINT


def _tried(observed: Observed, seed: int) -> Observed:
    """Readings at random poses within the joint ranges, with each payload on hand and from either side."""
    rng, count = np.random.default_rng(seed), observed.rules.answer.tried
    arm, recording = observed.arm_given, observed.recording
    low = np.array([joint.range[0] for joint in arm.joints])
    high = np.array([joint.range[1] for joint in arm.joints])
    q = completed(arm, np.round(rng.uniform(low, high, (count, arm.size)), 4))
    payload = arm.payload.mass if recording.payload_mass is None else float(recording.payload_mass.max())
    loads = np.array([0.0, payload if payload > 0.0 else 5.0])
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
    own = columns_of(tried, namer.pool.groups[member].candidate)
    known = [m for m in members if m != member and not namer.pool.groups[m].candidate.outside]
    rest = [columns_of(tried, namer.pool.groups[m].candidate) for m in (*known, other)]
    if own is None or any(part is None for part in rest):
        return None
    there = [part for part in rest if part is not None]
    recording = prepared.observed.recording
    # Of several recordings it is the last that goes on: what the others swallow has no part in it.
    last = recording.each[-1] if isinstance(recording, Several) else recording
    own_beside, _ = nuisances(replace(tried, recording=replace(tried.recording, frame=last.frame, tool=last.tool)))
    others = prepared.beside.shape[2] - own_beside.shape[2]
    beside = np.pad(own_beside, ((0, 0), (0, 0), (others, 0)))
    recorded = np.concatenate([prepared.beside, *(prepared.columns[m] for m in (*known, other))], axis=2)
    white = prepared.observed.whitened
    # Least squares sees the recorded rows through their triangular factor alone.
    both = np.column_stack([white(recorded), white(prepared.columns[member] @ sizes)])
    factor: Array = np.linalg.qr(both).R
    names = tuple(_label(namer, number) for number in (member, other))
    return _Pair(
        f"{names[0]} from {names[1]}",
        factor[:, -1],
        tried.whitened(own @ sizes),
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


def _note(pairs: Sequence[_Pair], hopeless: Sequence[str], taken: Sequence[int], width: int, told: float) -> str:
    sentences: list[str] = []
    if pairs:
        before = min(_noncentrality(pair, [], width) for pair in pairs)
        after = min(_noncentrality(pair, taken, width) for pair in pairs)
        enough = "enough" if after >= told else "repeat them"
        sentences.append(
            f"The poses listed raise the smallest non-centrality between names from {before:.1f} to {after:.1f}: "
            f"{enough}."
        )
    sentences += [f"No pose tells {label}: only another sensor would." for label in dict.fromkeys(hopeless)]
    return " ".join(sentences)
