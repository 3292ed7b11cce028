"""Instruments that touch against a tracker, on an arm of six joints of the second generator.

    python -m benchmarks.instruments.touches [--causes backlash ...] [--sizes 1 2 4 8] [--page docs/recordings.md]

Four sockets from six postures each, two plates from twelve, two bars of 0.5 m from six at either end: with two payloads
and from both sides, twice a visit. MuJoCo plays the arm with one cause at a time (see `against`); the encoders read
where the tip that it has then touches, and each touch is off by 20 um an axis. The tracker reads the sockets' postures.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.blind.generator.thermal import draw_air
from benchmarks.instruments.against import CAUSES, NOISE, arm_of, least, outcome, recorded, titled
from benchmarks.instruments.page import write_table
from benchmarks.multibody.arms import draw_arm, rounded_degrees
from benchmarks.multibody.causes import Stage, draw_cause, possible
from benchmarks.multibody.doses import dosed
from benchmarks.multibody.engine import Machine, jacobians, machine, place
from benchmarks.multibody.session import Plan, Session, Tips, played, with_design
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.diagnosis import diagnose
from linkwright.core.diagnose.instruments.instrument import KINDS, Instrument, Kind
from linkwright.core.diagnose.recording import Recording
from linkwright.core.sections.numeric import Array

FAMILY = "spatial_6r"
TRACKER = "tracker, frame free"
INSTRUMENTS: dict[str, Kind] = {"sockets": "same_point", "plates": "plane", "bars of 0.5 m": "bar"}
HEAVY = 4.0  # kg
BAR = 0.5  # m
_TRIES, _ROUNDS, _MISSED = 2000, 6, 1e-7
"""Postures tried for a touch; times that a session is played to end at what it touches, and how far off (m) it may then
be."""
_FROM, _SPREAD = 0.5, 0.35
"""Shares of the joint ranges about their middles, from which sockets are drawn, and by which postures differ."""


@dataclass(frozen=True)
class Touching:
    """A session whose visits touch something: which of several (v,), where the touch should be (v, 3), m, across what
    it counts (v, k, 3), and how far along its bar (v,), m."""

    stage: Stage
    label: NDArray[np.int64]
    goal: Array
    across: Array
    along: Array | None


def _postures(body: Machine, goals: Array, across: Array, low: Array, high: Array, rng: np.random.Generator) -> Array:
    """Postures (n, m) in which the arm undeformed touches goals (m, 3), counted across (m, k, 3)."""
    q = np.zeros((len(low), len(goals)))
    for k, goal in enumerate(goals):
        for _ in range(_TRIES):
            at = low + (high - low) * (0.5 + _SPREAD * rng.uniform(-1.0, 1.0, len(low)))
            for _ in range(60):
                tip, slope = _undeformed(body, at)
                missed = across[k] @ (tip - goal)
                step = np.linalg.pinv(across[k] @ slope, rcond=1e-3) @ missed
                at = at - step * min(1.0, 0.3 / max(float(np.abs(step).max()), 1e-12))
            if np.abs(missed).max() < 1e-9 and (at > low).all() and (at < high).all():
                q[:, k] = at
                break
        else:
            raise ValueError(f"nothing reaches {goal}; another seed")
    return rounded_degrees(q)


def _undeformed(body: Machine, q: Array) -> tuple[Array, Array]:
    """Where the tip (3,) of the arm without loads is at joint angles, and how it moves with them (3, n)."""
    x = np.zeros(body.size)
    x[list(body.drive)] = q
    place(body, x)
    site = body.site("tip")
    return body.data.site_xpos[site].copy(), jacobians(body, site)[0][:, list(body.drive)]


def _session(poses: Array, rng: np.random.Generator) -> tuple[Session, NDArray[np.int64]]:
    """Every pose (n, m) under two payloads from both sides, in random order; and which pose each visit is of."""
    count = poses.shape[1]
    sense = np.where(rng.random(poses.shape) < 0.5, 1.0, -1.0)
    chosen: list[tuple[int, float, float]] = []
    for payload in (0.0, HEAVY):
        block = [(k, payload, side) for k in range(count) for side in (1.0, -1.0)]
        chosen += [block[k] for k in rng.permutation(len(block))]
    number = np.array([k for k, _, _ in chosen], dtype=np.int64)
    time = np.round(np.linspace(0.0, 4.0 * 3600.0, len(chosen)), 0)
    payload = np.array([each for _, each, _ in chosen])
    session = Session(
        "full",
        poses[:, number],
        sense[:, number] * np.array([side for _, _, side in chosen]),
        payload,
        time,
        draw_air(float(time[-1]), 3.0, rng),
        time - time[np.where(payload > 0.0, len(chosen) // 2, 0)],
        (0,) * len(chosen),
        2,
    )
    return session, number


def touching(kind: Kind, seed: int) -> tuple[Arm, Touching]:
    """The arm as its file has it, read again, and a session of it that touches sockets, plates or bars."""
    rng = np.random.default_rng(seed)
    real, ranges = draw_arm(FAMILY, rng)
    body, low, high = machine(real), np.array(ranges.low), np.array(ranges.high)
    count, each = (2, 12) if kind == "plane" else (4, 6)
    place_of = np.repeat(np.arange(count), each)
    q = [low + (high - low) * (0.5 + 0.5 * _FROM * rng.uniform(-1.0, 1.0, len(low))) for _ in range(count)]
    points = np.array([_undeformed(body, one)[0] for one in q])
    across, label, along = np.tile(np.eye(3), (len(place_of), 1, 1)), place_of, None
    if kind == "plane":
        across = np.eye(3)[[2, 0]][place_of][:, None, :]
    if kind == "bar":
        # From each of two places towards the middle of the reach.
        way = np.array([0.0, 0.0, 0.4]) - points[:2]
        way /= np.linalg.norm(way, axis=1)[:, None]
        points = np.concatenate([points[:2], points[:2] + BAR * way])
        label, along = place_of % 2, BAR * (place_of // 2)
    session, pose = _session(_postures(body, points[place_of], across, low, high, rng), rng)
    stage = Stage(body, session, played(Plan(body, session)))
    held = None if along is None else along[pose]
    return arm_of(real, ranges), Touching(
        stage, label[pose].astype(np.int64), points[place_of][pose], across[pose], held
    )


def met(touch: Touching, write: Callable[[Plan], None]) -> tuple[Session, Tips]:
    """The session with the encoders where the tip, with what is wrong with the arm, ends at what it touches."""
    body, session = touch.stage.machine, touch.stage.session
    missed = np.zeros(1)
    for _ in range(_ROUNDS):
        plan = Plan(body, session)
        write(plan)
        tips = played(plan)
        missed = np.einsum("vka,va->vk", touch.across, tips.reading.T - touch.goal)
        if np.abs(missed).max() < _MISSED:
            return session, tips
        session = with_design(session, q=session.q - _moving(touch, tips, missed).T)
    raise ValueError(f"a touch is missed by {np.abs(missed).max():.1g} m after {_ROUNDS} rounds")


def _moving(touch: Touching, tips: Tips, by: Array) -> Array:
    """The least motion of the joints (v, n) that moves each tip by so much (v, k), m, across what it touches."""
    slope = np.stack([rest.jacobian[:, list(touch.stage.machine.drive)] for rest in tips.rests])
    return np.einsum("vnk,vk->vn", np.linalg.pinv(touch.across @ slope), by)


def touched(touch: Touching, write: Callable[[Plan], None], kind: Kind, seed: int) -> Recording:
    """What the encoders of an arm with something wrong read at each touch, which is off by the noise."""
    rng = np.random.default_rng(seed)
    session, tips = met(touch, write)
    rows = np.repeat(np.arange(session.visits), session.repeats)
    read = session.q.T[rows]
    for reading in range(session.repeats):
        off = NOISE * rng.standard_normal((session.visits, 3))
        own = np.arange(session.visits) * session.repeats + reading
        read[own] += _moving(touch, tips, np.einsum("vka,va->vk", touch.across, off))
    labels = tuple(f"{number + 1}" for number in range(int(touch.label.max()) + 1))
    return Recording(
        kind,
        read,
        np.zeros((len(rows), len(KINDS[kind]))),
        np.arange(1, len(rows) + 1),
        time=session.time[rows] + 4.0 * np.tile(np.arange(session.repeats), session.visits),
        sides=session.side.T[rows],
        payload_mass=session.payload[rows],
        slots=np.tile(KINDS[kind], (len(rows), 1)),
        touches=touch.label[rows],
        bar_at=None if touch.along is None else touch.along[rows],
        instrument=Instrument((kind,), labels=labels),
    )


def main(arguments: Sequence[str] | None = None) -> None:
    """Print a table: each cause and size by each instrument."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--causes", nargs="+", choices=CAUSES, default=CAUSES)
    parser.add_argument("--sizes", type=float, nargs="+", default=[1.0, 2.0, 4.0, 8.0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--page", type=Path, help="the page whose table is written anew, of all causes")
    asked = parser.parse_args(arguments)
    if asked.page is not None and len(asked.causes) != len(CAUSES):
        parser.error("--page: the page has all causes")
    stages = {name: touching(kind, asked.seed) for name, kind in INSTRUMENTS.items()}
    arm, first = stages["sockets"]
    print(f"| cause | times the noise | {TRACKER} | {' | '.join(INSTRUMENTS)} |\n|---|---|{'---|' * 4}", flush=True)
    rows: list[Sequence[str]] = []
    for number, effect in enumerate(CAUSES):
        if effect not in asked.causes or not possible(effect, first.stage):
            continue
        drawn = draw_cause(effect, first.stage, np.random.default_rng((asked.seed, number)))
        found: list[tuple[float, list[str]]] = []
        for size in asked.sizes:
            came = dosed(drawn, first.stage, size * NOISE * np.sqrt(3.0), frame_free=True, tool_free=False)
            if came is None:
                continue
            cause = came[0]
            plan = Plan(first.stage.machine, first.stage.session)
            cause.write(plan)
            read = [recorded(first.stage, played(plan), TRACKER, number)]
            read += [touched(stages[name][1], cause.write, kind, number) for name, kind in INSTRUMENTS.items()]
            each = [outcome(diagnose(arm, one), cause) for one in read]
            found.append((size, each))
            print(f"| {effect} {list(cause.at) or ''} | {size:g} | {' | '.join(each)} |", flush=True)
        rows.append((titled(drawn), *(least([(size, each[k]) for size, each in found]) for k in range(4))))
    if asked.page is not None:
        write_table(asked.page, ("cause, six joints", TRACKER, *INSTRUMENTS), rows)


if __name__ == "__main__":
    main()
