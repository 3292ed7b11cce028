"""A session: which poses, loads, sides and hours a recording holds, and what the arm does in it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from benchmarks.blind.generator.arms import Ranges
from benchmarks.blind.generator.mechanics import Arm
from benchmarks.blind.generator.thermal import Air, draw_air, lagged
from benchmarks.blind.generator.vectors import Array
from benchmarks.multibody.arms import rounded_degrees
from benchmarks.multibody.engine import Force, Machine, Rest, machine, settle

DESIGNS = ("full", "payloads", "sides", "twenty")
_PLANS = {
    "full": (12, 22, 2, 2, 2),
    "payloads": (18, 30, 2, 1, 3),
    "sides": (20, 32, 1, 2, 2),
    "twenty": (20, 20, 1, 1, 3),
}
BETWEEN_REPEATS = 4.0  # s


@dataclass(frozen=True)
class Session:
    """Visits to poses in their order; every visit is read `repeats` times. Arrays go by visit, the last axis."""

    design: str
    q: Array  # (n, v) rad, as the encoders read
    side: Array  # (n, v) +1 where the joint came towards increasing q
    payload: Array  # kg
    time: Array  # s
    air: Air
    loaded_for: Array  # s since the payload was last changed
    mount: tuple[int, ...]  # which mounting of the tracker
    repeats: int

    @property
    def visits(self) -> int:
        """How many."""
        return int(self.time.size)

    @property
    def temperature(self) -> Array:
        """The air's, degC."""
        return self.air.at(self.time)

    def warming(self, lag: float) -> Array:
        """How far above 20 degC a body is that follows the air by a lag in s."""
        return lagged(self.air, lag, self.time) - 20.0


def draw_session(design: str, arm: Arm, ranges: Ranges, mounts: int, rng: np.random.Generator) -> Session:
    """A session of the named design, in random order of poses, in blocks of payloads, the tracker set up anew between
    mounts."""
    least, most, payloads, sides, repeats = _PLANS[design]
    count = int(rng.integers(least, most + 1))
    cells = np.stack([rng.permutation(count) for _ in range(arm.count)])
    low, high = np.array(ranges.low)[:, None], np.array(ranges.high)[:, None]
    poses = rounded_degrees(low + (cells + rng.random(cells.shape)) / count * (high - low))
    heavy = round(arm.payload * float(rng.uniform(1.4, 2.2)), 1)
    blocks = [0.0, heavy, 0.0, heavy] if payloads == 2 else [arm.payload]
    visits: list[tuple[int, float, float]] = []
    for number, mass in enumerate(blocks):
        chosen = range(number // 2, count, 2) if payloads == 2 else range(count)
        block = [(k, mass, s) for k in chosen for s in ((1.0, -1.0)[:sides])]
        visits += [block[k] for k in rng.permutation(len(block))]
    pose = [v[0] for v in visits]
    sense = np.where(rng.random((arm.count, count)) < 0.5, 1.0, -1.0)
    payload = np.array([v[1] for v in visits])
    changed = np.array([i > 0 and payload[i] != payload[i - 1] for i in range(len(visits))])
    hours = float(rng.uniform(2.0, 8.0))
    gaps = rng.uniform(0.8, 1.4, len(visits)) + 3.0 * changed
    time = np.round((np.cumsum(gaps) - gaps[0]) / (gaps.sum() - gaps[0]) * hours * 3600.0, 0)
    since = np.maximum.accumulate(np.where(changed, time, 0.0))
    mount = np.minimum((np.arange(len(visits)) * mounts) // len(visits), mounts - 1)
    return Session(
        design,
        poses[:, pose],
        sense[:, pose] * np.array([v[2] for v in visits]),
        payload,
        time,
        draw_air(float(time[-1]), float(rng.uniform(2.0, 7.0)), rng),
        time - since,
        tuple(int(k) for k in mount),
        repeats,
    )


@dataclass(frozen=True)
class Tips:
    """What a session comes to, by visit: the tip as it is read free of noise (3, v), and all that led there."""

    reading: Array
    rests: tuple[Rest, ...]

    @property
    def load(self) -> Array:
        """Generalised loads (coordinates, v)."""
        return np.stack([rest.load for rest in self.rests], axis=1)


VisitLaw = Callable[[Array, int, Sequence[Array]], Sequence[tuple[int, float]]]
"""From the loads, the visit's number and the loads of the visits before to (coordinate, what it gives beyond its
spring)."""
VisitForce = Callable[[Machine, int], Sequence[tuple[str, Array, Array]]]
"""From where the bodies stand and the visit's number to forces and moments at sites."""
Reading = Callable[[Array, tuple[Rest, ...]], Array]
"""From tips (3, v) to what the instrument adds to them."""


@dataclass
class Plan:
    """What is to be played: an arm in a session, and what is wrong with it. Causes write into it."""

    machine: Machine
    session: Session
    rest: Array = field(default_factory=lambda: np.zeros(0))  # (coordinates, v)
    compliance: Array = field(default_factory=lambda: np.zeros(0))
    gravity: Array = field(default_factory=lambda: np.zeros(0))
    payload: Array = field(default_factory=lambda: np.zeros(0))
    extra_mass: list[float] = field(default_factory=list)
    laws: list[VisitLaw] = field(default_factory=list)
    forces: list[VisitForce] = field(default_factory=list)
    readings: list[Reading] = field(default_factory=list)

    def __post_init__(self) -> None:
        if self.rest.size == 0:
            body = self.machine
            self.rest = np.zeros((body.size, self.session.visits))
            self.rest[list(body.drive)] = self.session.q
            self.compliance = body.compliance.copy()
            self.gravity = np.array(body.arm.gravity)
            self.payload = self.session.payload.copy()
            self.extra_mass = [0.0] * body.arm.count


def played(plan: Plan) -> Tips:
    """Every visit at rest, in order. Raises benchmarks.multibody.engine.NotSettledError."""
    body = plan.machine
    if any(plan.extra_mass):
        body = machine(body.arm, extra_mass=plan.extra_mass)
    body.model.opt.gravity[:] = plan.gravity
    rests: list[Rest] = []
    before: list[Array] = []
    for v in range(plan.session.visits):
        forces: list[Force] = [lambda m, f=f, v=v: f(m, v) for f in plan.forces]
        laws = [lambda load, w=w, v=v: w(load, v, before) for w in plan.laws]
        at_tip = plan.payload[v] * plan.gravity
        rests.append(settle(body, plan.rest[:, v], plan.compliance, at_tip, laws, forces))
        before.append(rests[-1].load)
    plan.machine.model.opt.gravity[:] = plan.machine.arm.gravity
    done = tuple(rests)
    tips = np.stack([rest.tip for rest in done], axis=1)
    return Tips(tips + sum((read(tips, done) for read in plan.readings), np.zeros_like(tips)), done)
