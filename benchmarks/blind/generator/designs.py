"""Designs of recordings, good and poor: which poses, in which order, from which side, under which load, and when."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.blind.generator.arms import Ranges
from benchmarks.blind.generator.mechanics import Arm
from benchmarks.blind.generator.thermal import Air, draw_air
from benchmarks.blind.generator.vectors import Array

DESIGNS = ("full", "two_payloads", "two_sides", "forced", "moving", "one_payload", "poor")


@dataclass(frozen=True)
class Design:
    """What was done, row by row; `columns` names what the recording tells of it."""

    name: str
    q: Array  # (n, m) encoder readings, rad or m
    side: Array  # (n, m) +1, -1
    speed: Array  # (n, m) rad/s or m/s
    payload: Array  # (m,)
    force: Array  # (3, m)
    time: Array  # (m,) s
    air: Air
    fresh: Array  # (m,) 1.0 where the arm moved before this row
    columns: frozenset[str]
    frame_free: bool
    repeats: bool

    @property
    def temperature(self) -> Array:
        """The air's, degC."""
        return self.air.at(self.time)


@dataclass(frozen=True)
class _Plan:
    poses: tuple[int, int]
    payloads: int
    sides: int
    repeats: int
    forces: int
    columns: tuple[str, ...]
    ordered: bool = False


_FULL = ("dir", "payload_kg", "temperature_degC", "time_s")


def _plan(name: str) -> _Plan:
    plans = {
        "full": _Plan((20, 50), 2, 2, 2, 1, _FULL),
        "two_payloads": _Plan((25, 60), 2, 1, 3, 1, _FULL),
        "two_sides": _Plan((30, 60), 1, 2, 3, 1, _FULL),
        "forced": _Plan((25, 45), 2, 1, 2, 2, (*_FULL, "force")),
        "moving": _Plan((25, 45), 2, 2, 2, 1, (*_FULL, "speed")),
        "one_payload": _Plan((30, 60), 1, 1, 3, 1, _FULL),
        "poor": _Plan((40, 60), 1, 1, 1, 1, ("time_s", "temperature_degC"), ordered=True),
    }
    return plans[name]


def _poses(arm: Arm, ranges: Ranges, count: int, ordered: bool, rng: np.random.Generator) -> Array:
    """Latin hypercube over the joint ranges, rounded as a controller prints; ordered along the first joints."""
    cells = np.stack([rng.permutation(count) for _ in range(arm.count)])
    share = (cells + rng.random(cells.shape)) / count
    low, high = np.array(ranges.low)[:, None], np.array(ranges.high)[:, None]
    q = low + share * (high - low)
    if ordered:
        q = q[:, np.argsort(q[0])]
    for j, joint in enumerate(arm.joints):
        unit = 1e3 if joint.prismatic else 180.0 / math.pi
        q[j] = np.round(q[j] * unit, 3) / unit
    return q


def draw_design(name: str, arm: Arm, ranges: Ranges, rng: np.random.Generator) -> Design:
    """A recording of the named kind for the arm."""
    plan = _plan(name)
    count = int(rng.integers(plan.poses[0], plan.poses[1] + 1))
    while count * plan.payloads * plan.sides * plan.repeats * plan.forces > 400:
        count -= 1
    poses = _poses(arm, ranges, count, plan.ordered, rng)
    payloads = [arm.payload] if plan.payloads == 1 else [0.0, round(arm.payload * float(rng.uniform(1.5, 2.5)), 1)]
    pushes = [np.zeros(3)]
    if plan.forces == 2:
        angle = float(rng.uniform(-0.5, 0.5))
        size = round(float(rng.uniform(30.0, 80.0)), 0)
        push = np.array([math.cos(angle), math.sin(angle), 0.0]) * size
        pushes = [np.round(push, 1), np.round(push * np.array([-1.0, 0.6, 1.0]), 1)]
    visits = _visits(plan, count, payloads, pushes, rng)
    rows = [(visit, first) for visit in visits for first in [1.0] + [0.0] * (plan.repeats - 1)]
    m = len(rows)
    q = np.stack([poses[:, visit[0]] for visit, _ in rows], axis=1)
    fresh = np.array([first for _, first in rows])
    side = np.stack([np.full(arm.count, visit[3]) for visit, _ in rows], axis=1)
    if plan.sides == 2:
        # joints do not all come from one side: each keeps its own sense through a visit and its return
        side = side * np.where(rng.random((arm.count, count)) < 0.5, 1.0, -1.0)[:, [v[0] for v, _ in rows]]
    changed = np.array([i > 0 and rows[i][0][1] != rows[i - 1][0][1] for i in range(m)])
    time = _clock(plan, fresh, changed, rng)
    swing = float(rng.uniform(2.0, 8.0))
    speed = _speed(arm, plan, fresh, side, rng)
    free = bool(rng.random() < 0.5)
    return Design(
        name=name,
        q=q,
        side=side,
        speed=speed,
        payload=np.array([visit[1] for visit, _ in rows]),
        force=np.stack([visit[2] for visit, _ in rows], axis=1),
        time=time,
        air=draw_air(float(time[-1]), swing, rng),
        fresh=fresh,
        columns=frozenset(plan.columns),
        frame_free=free,
        repeats=plan.repeats > 1,
    )


def _speed(arm: Arm, plan: _Plan, fresh: Array, side: Array, rng: np.random.Generator) -> Array:
    """How fast each joint goes through each row (n, m), rad/s or m/s; zero where no column tells it."""
    if "speed" not in plan.columns:
        return np.zeros(side.shape)
    visit_of = np.cumsum(fresh).astype(int) - 1
    drawn = rng.uniform(0.05, 0.8, (arm.count, int(visit_of[-1]) + 1))[:, visit_of] * side
    drawn[[joint.prismatic for joint in arm.joints]] = 0.0  # a slide has no column for its speed: it stands
    return np.asarray(np.round(np.degrees(drawn), 3) * math.pi / 180.0, dtype=np.float64)


def _visits(
    plan: _Plan, count: int, payloads: list[float], pushes: list[Array], rng: np.random.Generator
) -> list[tuple[int, float, Array, float]]:
    """What is visited in turn: pose, payload, force and side, payloads in blocks that come back."""
    visits: list[tuple[int, float, Array, float]] = []
    blocks = [p for _ in range(2) for p in payloads] if plan.payloads == 2 else payloads
    halves = [np.arange(0, count, 2), np.arange(1, count, 2)]
    for b, load in enumerate(blocks):
        chosen = halves[b // 2] if plan.payloads == 2 else np.arange(count)
        block = [(int(k), load, push, s) for k in chosen for push in pushes for s in ((1.0, -1.0)[: plan.sides])]
        if not plan.ordered:
            block = [block[k] for k in rng.permutation(len(block))]
        visits += block
    return visits


def _clock(plan: _Plan, fresh: Array, changed: Array, rng: np.random.Generator) -> Array:
    """When each row is read, s: pauses between visits, more where the payload is changed."""
    pause = float(rng.uniform(20.0, 90.0))
    gaps = np.where(fresh > 0, pause * rng.uniform(0.8, 1.4, fresh.size), 4.0)
    time = np.round(np.cumsum(gaps + 600.0 * changed) - gaps[0], 1)
    stretch = max(1.0, float(rng.uniform(2.0, 9.0)) * 3600.0 / max(float(time[-1]), 1.0)) if not plan.ordered else 1.0
    return np.round(time * stretch, 1) if plan.repeats == 1 else _stretched(time, fresh, stretch)


def _stretched(time: Array, fresh: Array, factor: float) -> Array:
    """Longer pauses between visits; repeats stay seconds apart."""
    gaps = np.diff(time, prepend=time[0])
    return np.asarray(np.round(np.cumsum(np.where(fresh > 0, gaps * factor, gaps)), 1), dtype=np.float64)


def warmed(design: Design, factor: float) -> Design:
    """The same recording with the air's departure from 20 degC scaled."""
    air = Air(design.air.clock, 20.0 + factor * (design.air.temperature - 20.0))
    return replace(design, air=air)
