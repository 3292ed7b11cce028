"""An arm under given torques, simulated by MuJoCo from many states side by side.

Links, rotors, springs, dry and viscous friction stand in the model that MuJoCo compiles. What MJCF has no word for acts
as the arm's own equations have it, worked out at each step: further friction as MuJoCo's dry friction of that amount,
so that a joint sticks and slips without chatter, all else as a torque at the joint. What goes by the course of a motion
and not by its instant (friction after a reversal, drives that give) acts as along the measured motion.

(E. Todorov, T. Erez & Y. Tassa, MuJoCo: A physics engine for model-based control, IEEE/RSJ IROS (2012) 5026-5033,
doi:10.1109/IROS.2012.6386109.)
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm, EffectEntry
from linkwright.core.arm.descriptions.formats import under_torques
from linkwright.core.arm.descriptions.in_motion import effects_in_motion
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.effects.torques import direction
from linkwright.core.arm.motion.dynamics import acting, torque_of, torque_stages
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.sections.numeric import Array
from linkwright.core.units.extras import not_installed
from linkwright.core.units.quantities import InputError

STEP = 1e-3
"""s; a step of the simulation is at most so long."""
_FRICTION = "friction in motion"
_SLOWEST = 0.03
"""rad/s, m/s; below it the arm's own friction is smoothed, MuJoCo's is not: it is that of this speed."""
_LOCKED = 1e6
"""N*m, N; friction that holds a joint at the end of its range."""
_SAME = 1e-5
"""Of a joint's largest torque, by which MuJoCo's may differ from the arm's own equations."""
_ROWS = 50
"""Instants at which that is tried, and whether an effect goes by the instant."""


@dataclass(frozen=True)
class Courses:
    """W courses of S + 1 samples at `rate` Hz, side by side.

    `motion` (W * (S + 1) instants, course after course) is the measured one: its first samples are the states from
    which the arm is simulated, and what else a log holds (temperatures, commands) counts at each sample. `torque` (W, S
    + 1, n) N*m (N) is that of the drives; `lasting` (W, S + 1, n) what they take beside for effects that go by the
    course of the motion, `rubbing` alike what of friction does (positive against the motion).
    """

    motion: Motion
    rate: float
    torque: Array
    lasting: Array
    rubbing: Array


@dataclass(frozen=True)
class Rolled:
    """What comes of W courses: coordinates `q` and `velocity` (W, S + 1, n), and for how many samples each joint goes
    (`going`, (W, n)) before it leaves its range, where it is stopped."""

    q: Array
    velocity: Array
    going: NDArray[np.int64]

    @property
    def left(self) -> NDArray[np.bool_]:
        """Which courses (W,) left a joint's range."""
        return (self.going < self.q.shape[1]).any(axis=1)


@dataclass(frozen=True)
class Simulator:
    """An arm for MuJoCo: the compiled `model`, and the entries of its effects that act beside it, by instant (of
    `loads`, of `friction`, `others`) or by the course of a motion (`lasting`)."""

    arm: Arm
    model: Any
    loads: tuple[EffectEntry, ...]
    friction: tuple[EffectEntry, ...]
    others: tuple[EffectEntry, ...]
    lasting: tuple[EffectEntry, ...]

    @property
    def beside(self) -> tuple[str, ...]:
        """The effects, by id, that MJCF has no word for."""
        entries = (*self.loads, *self.friction, *self.others, *self.lasting)
        return tuple(dict.fromkeys(entry.effect for entry in entries))


def simulator(arm: Arm, motion: Motion) -> Simulator:
    """An arm for MuJoCo; `motion` is one that it makes, by which effects are tried.

    Raises:
        InputError: MuJoCo is not installed, or cannot hold the arm.
        PropertyNeeded: A link's mass is not known.
    """
    mujoco = installed()
    entries, held = acting(arm), effects_in_motion("mjcf")
    simple = replace(arm, effects=tuple(entry for entry in arm.effects if entry.effect in held))
    try:
        model = mujoco.MjModel.from_xml_string(under_torques(simple))
    except ValueError as error:
        raise InputError("", "rollout", f"MuJoCo does not take the arm: {' '.join(str(error).split())}") from None
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    _check(simple, model, motion)
    by_instant: dict[bool, list[EffectEntry]] = {True: [], False: []}
    for entry in (*entries.loads, *entries.drives):
        if entry.effect not in held and (alike := _goes_by_instant(entry, motion)) is not None:
            by_instant[alike].append(entry)
    now = by_instant[True]
    loads = tuple(entry for entry in now if entry in entries.loads)
    friction = tuple(entry for entry in now if EFFECTS[entry.effect].cause == _FRICTION)
    others = tuple(entry for entry in now if entry not in (*loads, *friction))
    return Simulator(arm, model, loads, friction, others, tuple(by_instant[False]))


def installed() -> Any:
    """MuJoCo. Raises `InputError` where it is not installed."""
    try:
        import mujoco
    except ImportError:
        raise InputError("", "rollout", not_installed("a rollout", "mujoco", "mujoco")) from None
    return mujoco


def _goes_by_instant(entry: EffectEntry, motion: Motion) -> bool | None:
    """Whether the torque of an effect is the same at an instant, whatever is before and after; None where it has
    none."""
    rows = np.sort(np.random.default_rng(1).permutation(motion.size)[:_ROWS])
    along, alone = torque_of(motion, [entry]), torque_of(motion.at(rows), [entry])
    largest = float(np.abs(along).max(initial=0.0))
    return bool(np.abs(along[rows] - alone).max() <= 1e-9 * largest) if largest > 0.0 else None


def _check(arm: Arm, model: Any, motion: Motion) -> None:
    """Refuse an arm of which MuJoCo has other equations. Raises `InputError`."""
    mujoco = installed()
    if model.nv != arm.size:
        raise InputError("", "rollout", f"MuJoCo's arm has {model.nv} joints, the arm file's {arm.size}")
    rows = np.linspace(0, motion.size - 1, _ROWS).astype(int)
    here = replace(motion.at(rows), arm=arm)
    ours, data = torque_stages(here).drive, mujoco.MjData(model)
    rubs = model.dof_frictionloss * direction(here.velocity)
    theirs = np.zeros_like(ours)
    for row in range(len(rows)):
        data.qpos[:], data.qvel[:], data.qacc[:] = here.q[row], here.velocity[row], here.acceleration[row]
        mujoco.mj_inverse(model, data)
        theirs[row] = data.qfrc_inverse + data.qfrc_constraint + rubs[row]
    off = np.abs(ours - theirs).max(axis=0) / np.maximum(np.abs(ours).max(axis=0), 1e-9)
    worst = int(np.argmax(off))
    if off[worst] > _SAME:
        what = f"at joint {worst + 1} MuJoCo's torque is {100.0 * off[worst]:.2g} % off that of the arm's equations"
        raise InputError("", "rollout", f"{what}; MJCF cannot hold the arm")


def rolled_out(simulator: Simulator, courses: Courses, limits: Array) -> Rolled:
    """An arm simulated from the first sample of each course on, under the torques of its drives.

    Each step takes the acceleration at its middle, which the one before foretells: exact to the second order of a step.

    Args:
        simulator: The arm.
        courses: Where it begins, and what acts.
        limits: (2, n) between which coordinates may go.
    """
    count, samples, n = courses.torque.shape
    steps = max(1, int(np.ceil(1.0 / (courses.rate * STEP) - 1e-9)))
    step = 1.0 / (courses.rate * steps)
    q, velocity = np.empty((count, samples, n)), np.empty((count, samples, n))
    first = courses.motion.at(np.arange(count) * samples)
    at, speed, acceleration = first.q.copy(), first.velocity.copy(), first.acceleration.copy()
    load = torque_stages(first).load
    goes, inside, going = (
        np.ones(count, dtype=bool),
        np.ones((count, n), dtype=bool),
        np.ones((count, n), dtype=np.int64),
    )
    q[:, 0], velocity[:, 0] = at, speed
    beside, forward = _Beside(simulator, courses), _Forward(simulator.model)
    for sample in range(samples - 1):
        for part in range(steps):
            share = (part + 0.5) / steps
            middle = at + 0.5 * step * speed + 0.125 * step**2 * acceleration
            slope = speed + 0.5 * step * acceleration
            acts = beside.at(sample, share, middle, slope, acceleration, load)
            drive = (1.0 - share) * courses.torque[:, sample] + share * courses.torque[:, sample + 1]
            torque, loss = drive - acts.others - acts.loads, np.where(inside, acts.loss, _LOCKED)
            for course in np.flatnonzero(goes).tolist():
                forward(middle[course], slope[course], torque[course], loss[course])
                acceleration[course], load[course] = forward.acceleration, forward.load
            load += acts.loads
            at = at + step * speed + 0.5 * step**2 * acceleration
            speed = speed + step * acceleration
            goes &= np.isfinite(speed).all(axis=1)
            stopped = ~goes[:, None] | (at < limits[0]) | (at > limits[1])
            at = np.clip(np.nan_to_num(at), *limits)
            inside &= ~stopped
            speed[~inside] = acceleration[~inside] = 0.0
        q[:, sample + 1], velocity[:, sample + 1] = at, speed
        going += inside
    return Rolled(q, velocity, going)


class _Forward:
    """MuJoCo's forward dynamics at one state after the other: the `acceleration` (n,), and the `load` (n,) that drives
    pass on to the links."""

    def __init__(self, model: Any) -> None:
        self._mujoco, self._model = installed(), model
        self._data, self._loss = self._mujoco.MjData(model), model.dof_frictionloss.copy()

    def __call__(self, q: Array, velocity: Array, torque: Array, loss: Array) -> None:
        """At a state (n,), under torques and with more dry friction (n,) than the model's."""
        data = self._data
        data.qpos[:], data.qvel[:], data.qfrc_applied[:] = q, velocity, torque
        self._model.dof_frictionloss[:] = self._loss + loss
        self._mujoco.mj_forward(self._model, data)
        self.acceleration = data.qacc
        self.load = torque + data.qfrc_passive + data.qfrc_constraint - self._model.dof_armature * data.qacc


@dataclass(frozen=True)
class _Acts:
    """What acts beside what stands in MuJoCo's model: more dry friction (`loss`), and what the drives take for `loads`
    and for `others` (W, n all), N*m (N)."""

    loss: Array
    loads: Array
    others: Array


class _Beside:
    """What acts on the courses beside what stands in MuJoCo's model, at any instant of them."""

    def __init__(self, simulator: Simulator, courses: Courses) -> None:
        self._of, self._courses = simulator, courses
        self._rows = np.arange(len(courses.torque)) * courses.torque.shape[1]
        self._by_instant = bool(simulator.loads or simulator.friction or simulator.others)

    def at(self, sample: int, share: float, q: Array, velocity: Array, acceleration: Array, load: Array) -> _Acts:
        """What acts at a `share` of the way from a sample to the next, at states and under loads (W, n)."""
        courses, of = self._courses, self._of
        others, rubbing = (
            (1.0 - share) * values[:, sample] + share * values[:, sample + 1]
            for values in (courses.lasting, courses.rubbing)
        )
        loads, way = np.zeros(q.shape), np.where(velocity < 0.0, -1.0, 1.0)
        if self._by_instant:
            held = courses.motion.at(self._rows + sample)
            clock = held.time + share / courses.rate
            now = replace(held, arm=of.arm, time=clock, q=q, velocity=velocity, acceleration=acceleration, torque=load)
            sliding = replace(now, velocity=way * np.maximum(np.abs(velocity), _SLOWEST))
            loads = torque_of(now, of.loads)
            rubbing = rubbing + way * torque_of(sliding, of.friction)
            others = others + torque_of(now, of.others)
        # Friction that would help the motion is none that MuJoCo has.
        return _Acts(np.maximum(rubbing, 0.0), loads, others + way * np.minimum(rubbing, 0.0))
