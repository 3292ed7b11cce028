"""What a motion takes of a drive that gives between its encoder and its link: the link lags, and swings.

The encoder sits on the motor's side and reads theta. The link stands behind it by d, and the gear passes on the torque
that its spring and damper hold: tau_load(theta - d) = K d + D d'. With compliance c = 1/K and retardation T = D/K:

    d = c x,  x + T x' = tau_load(theta - c x, theta' - c x', theta'' - c x'')

The motor gives its own rotor's torque and friction by theta, and tau_load beside them.

Where the encoder sits on the joint's side it reads where the link stands, and tau_load is the rigid arm's. The motor
goes ahead by d, x + T x' = tau_load, and takes J d'' for its rotor and F d' for its viscous friction: of a drive whose
rotor and friction nobody says, nothing shows.

Where there is an encoder on either side, torques follow from both motions, and d is what they differ by.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.vectors import ZERO
from linkwright.core.arm.effects.drives.armature import ARMATURE
from linkwright.core.arm.effects.effect import Effect, Settings
from linkwright.core.arm.effects.friction.friction_viscous import FRICTION_VISCOUS
from linkwright.core.arm.effects.loads.inertial import OfInertia
from linkwright.core.arm.effects.registry import EFFECTS
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.arm.motion.rigid import link_parameters, load_torque, rigid_torque, without_tip_load
from linkwright.core.sections.numeric import Array

_ROUNDS = 2
"""Times that the arm's torque is worked out where its link stands; gravity changes little over so small an angle."""
_STEP = 1e-3
"""Of a compliance, or of the least that counts, by which its slope is taken."""
_LEAST = 1e-6
"""rad/(N*m), m/N: on a thousandth of it nothing swings that a log shows."""
_USUAL = 10.0
"""Hz, at which robots under load swing: 5 to 20."""
RETARDATION = 5e-3
"""s, by which a drive's angle lags its torque where nobody says."""


@dataclass(frozen=True)
class OfElasticDrive:
    """The torques of drives that give: not linear in the compliance where the link swings near its eigenfrequency.

    `file` gives the compliance (rad/(N*m), m/N) that an arm file has of a drive (from 0) by its joint, `whole` that
    with its effects. What settings name comes on top of the one in a torque, of the other in a slope.
    """

    file: Callable[[Arm, int], float]
    whole: Callable[[Arm, int], float]

    def __call__(self, motion: Motion, settings: Settings) -> Mapping[int, Array]:
        """The torques by joint."""
        torque = np.zeros(motion.q.shape)
        for joint in self._joints(motion, settings):
            had, more = self.file(motion.arm, joint), _named(settings)
            after = had if more is None else had + more
            before = 0.0 if more is None else had
            drive, late = _drive(motion, joint), settings.values.get("retardation", RETARDATION)
            torque += drive.beyond(after, late) - drive.beyond(before, late)
        return _by_joint(motion.arm, torque)

    def slope(self, motion: Motion, settings: Settings) -> Mapping[int, Array]:
        """How the torques by joint change with the compliance that settings name, per unit of it."""
        torque = np.zeros(motion.q.shape)
        for joint in self._joints(motion, settings):
            whole = self.whole(motion.arm, joint) + (_named(settings) or 0.0)
            step = _STEP * max(whole, _LEAST)
            drive, late = _drive(motion, joint), settings.values.get("retardation", RETARDATION)
            torque += (drive.beyond(whole + step, late) - drive.beyond(whole, late)) / step
        return _by_joint(motion.arm, torque)

    def usual(self, motion: Motion, joint: int) -> float:
        """The compliance on which the arm swings at 10 Hz in the midst of a motion."""
        here = motion.q[motion.size // 2 : motion.size // 2 + 1]
        inertia = inertia_about(motion.arm, here, joint)[0]
        if motion.beyond_drive:  # on a spring beside its link, a rotor swings as fast as both
            rotor = _rotor(motion, joint)
            inertia = rotor * inertia / (rotor + inertia) if rotor > 0.0 else inertia
        return float(1.0 / (inertia * (2.0 * np.pi * _USUAL) ** 2))

    def _joints(self, motion: Motion, settings: Settings) -> list[int]:
        if motion.joint_side_rates is not None:  # where motor and link stand is known: each takes what its motion takes
            return []
        return [index for index in range(motion.arm.size) if settings.acts_at(index) and _has_drive(motion.arm, index)]


def _has_drive(arm: Arm, joint: int) -> bool:
    return arm.joints[joint].driven and not arm.joints[joint].passive


def _by_joint(arm: Arm, torque: Array) -> dict[int, Array]:
    """The columns of torques (N, n) that are those of drives, and not zero."""
    return {joint: column for joint, column in enumerate(torque.T) if column.any() and _has_drive(arm, joint)}


def _said(arm: Arm, joint: int, effect: Effect, size: str) -> float:
    """A size that an arm has of an effect at a joint (from 0)."""
    entries = (entry for entry in arm.effects if entry.effect == effect.id and joint + 1 in (entry.at or (joint + 1,)))
    return sum(entry.parameters.get(size, 0.0) for entry in entries)


def _rotor(motion: Motion, joint: int) -> float:
    """The inertia of a drive's rotor: the arm's, else the motion's."""
    said = _said(motion.arm, joint, ARMATURE, "inertia")
    return said if said or motion.rotors is None else float(motion.rotors[joint])


def _named(settings: Settings) -> float | None:
    """The compliance that settings name; None where they leave it to the file."""
    values = settings.values
    if "compliance" in values or "unit_sag" in values:  # a product with a weight that nobody knows is of tips alone
        return values.get("compliance", 0.0)
    return 1.0 / values["stiffness"] if "stiffness" in values else None


@dataclass(frozen=True)
class _Rigid:
    """An arm in a motion as if its drives were rigid: what is alike for all that may give."""

    motion: Motion

    @cached_property
    def parameters(self) -> Array:
        """The inertial parameters (n, 10) of the arm's links."""
        return _parameters(self.motion.arm)

    @cached_property
    def torque(self) -> Array:
        """The torques (N, n)."""
        motion = self.motion
        states = motion.q, motion.velocity, motion.acceleration
        return rigid_torque(motion.arm, self.parameters, *states, payload_mass=motion.payload_mass)

    @cached_property
    def load(self) -> Array:
        """The torques (N, n) that drives hold."""
        return load_torque(self.motion)


def _drive(motion: Motion, joint: int) -> _Drive:
    """A drive (from 0) in a motion, the same for all compliances and dampings."""
    arm = motion.once("rigid", lambda: _Rigid(motion))
    return motion.once(f"drive {joint}", lambda: _Drive(motion, joint, arm))


@dataclass(frozen=True)
class _Drive:
    """A drive (from 0) in a motion of an arm."""

    motion: Motion
    joint: int
    arm: _Rigid

    @cached_property
    def inertia(self) -> Array:
        """What the joint feels of all beyond it (N,)."""
        return inertia_about(self.motion.arm, self.motion.q, self.joint, self.arm.parameters)

    def ahead(self, load: Array, late: float) -> Array:
        """What a motor takes (N,) for going ahead of its link under a load (N,), of a unit of compliance."""
        rate, rate_of_rate = _rates(self.motion, swing(self.motion, np.zeros(self.motion.size), late, load))
        alone = np.eye(self.motion.arm.size)[self.joint]
        motor = replace(self.motion, velocity=rate[:, None] * alone, acceleration=rate_of_rate[:, None] * alone)
        rubs = _said(self.motion.arm, self.joint, FRICTION_VISCOUS, "coefficient")
        takes = ((ARMATURE, "inertia", _rotor(self.motion, self.joint)), (FRICTION_VISCOUS, "coefficient", rubs))
        each = (
            effect.torques(motor, Settings((self.joint,), {size: value}))[self.joint]
            for effect, size, value in takes
            if effect.torques is not None
        )
        return sum(each, np.zeros(self.motion.size))

    def rigid(self, behind: Array, rate: Array, rate_of_rate: Array) -> Array:
        """The torques (N, n) where the joint stands behind by so much (N,)."""
        motion = self.motion
        unit = np.eye(motion.arm.size)[self.joint]
        moved = (
            values - less[:, None] * unit
            for values, less in ((motion.q, behind), (motion.velocity, rate), (motion.acceleration, rate_of_rate))
        )
        return rigid_torque(motion.arm, self.arm.parameters, *moved, payload_mass=motion.payload_mass)

    def beyond(self, compliance: float, late: float) -> Array:
        """What all drives (N, n) take more where this one gives by a compliance, its angle `late` s behind."""
        if compliance == 0.0 or self.motion.size < 6:
            return np.zeros(self.motion.q.shape)
        load = self.arm.load[:, self.joint]
        if self.motion.beyond_drive:
            alone = np.eye(self.motion.arm.size)[self.joint]
            return np.asarray(compliance * self.ahead(load, late)[:, None] * alone, dtype=float)
        swings = compliance > _STEP * _LEAST
        inertia = compliance * self.inertia if swings else np.zeros(self.motion.size)
        behind, left, moved = np.zeros(self.motion.size), load, self.arm.torque
        for _ in range(_ROUNDS if swings else 1):
            behind = behind + swing(self.motion, inertia, late, left)
            rate, rate_of_rate = _rates(self.motion, behind)
            moved = self.rigid(compliance * behind, compliance * rate, compliance * rate_of_rate)
            left = load + (moved - self.arm.torque)[:, self.joint] - behind - late * rate
        return moved - self.arm.torque


def inertia_about(arm: Arm, q: Array, joint: int, parameters: Array | None = None) -> Array:
    """The inertia (N,) that a joint (from 0) feels of all beyond it at coordinates (N, n): kg*m^2, kg for slides."""
    weighs = _parameters(arm) if parameters is None else parameters
    still, unit = np.zeros_like(q), np.zeros_like(q)
    unit[:, joint] = 1.0
    return np.asarray(rigid_torque(without_tip_load(arm), weighs, q, still, unit, gravity=ZERO)[:, joint])


def eigenfrequencies(arm: Arm, q: Array, joint: int, compliance: float) -> tuple[float, float]:
    """The lowest and the highest frequency (Hz) at which the arm swings on a drive (from 0) that gives by `compliance`
    (rad/(N*m), m/N), at coordinates (N, n), its motor held.

    >>> from linkwright.core.arm.chain.chain import Arm, Joint, Link
    >>> arm = Arm("rod", (Joint(),), (Link(0.5, mass=3.0, center_of_mass=0.25),))
    >>> [round(each, 3) for each in eigenfrequencies(arm, np.zeros((1, 1)), 0, 1e-3)]
    [10.066, 10.066]
    """
    inertia = inertia_about(arm, q, joint)
    low, high = (float(1.0 / np.sqrt(compliance * each) / (2.0 * np.pi)) for each in (inertia.max(), inertia.min()))
    return low, high


def _parameters(arm: Arm) -> Array:
    """The inertial parameters (n, 10) of an arm's links by its file and its effects."""
    whole = link_parameters(arm)
    for entry in arm.effects:
        torques = EFFECTS[entry.effect].torques
        if isinstance(torques, OfInertia):
            whole = whole + torques.parameters(arm, Settings.of(entry))
    return whole


def _rates(motion: Motion, values: Array) -> tuple[Array, Array]:
    """The rate of change (N,) of values (N,) along a motion, and that rate's own."""
    from scipy.interpolate import CubicSpline  # here, for a list of effects needs none of it

    if motion.sampled < 1.0:
        once = motion.rate(values)
        return once, motion.rate(once)
    curve = CubicSpline(motion.time, values)
    return np.asarray(curve(motion.time, 1)), np.asarray(curve(motion.time, 2))


def swing(motion: Motion, inertia: Array, late: float, load: Array) -> Array:
    """x (N,) of m x'' + T x' + x = load (N,), with m (N,) s^2 and T s, begun as if the motion had begun slowly.

    Newmark's method with constant mean acceleration, stable at any step (N. M. Newmark, ASCE J. Eng. Mech. Div. 85
    (1959) 67-94). Where samples do not tell rates of change, x is the load.
    """
    from scipy.linalg import solve_banded  # here, as above

    if motion.sampled < 1.0:
        return load
    clock = np.linspace(motion.time[0], motion.time[-1], motion.size)
    step = clock[1] - clock[0]
    even, mass = (np.interp(clock, motion.time, values) for values in (load, inertia / step**2))
    drag = 0.5 * late / step
    bands = np.zeros((3, motion.size))
    bands[0, :2], bands[0, 2:] = 1.0, mass[1:-1] + drag + 0.25
    bands[1, 1:-1] = 0.5 - 2.0 * mass[1:-1]
    bands[2, :-2] = mass[1:-1] - drag + 0.25
    bands[1, 0] = 0.0
    once = np.gradient(even, step)
    slow = even - late * once - mass * step**2 * np.gradient(once, step)
    right = np.concatenate((slow[:2], 0.25 * (even[2:] + 2.0 * even[1:-1] + even[:-2])))
    x = np.asarray(solve_banded((2, 0), bands, right), dtype=float)
    # What alternates from sample to sample is of the method.
    x[2:-2] = (10.0 * x[2:-2] + 4.0 * (x[1:-3] + x[3:-1]) - x[:-4] - x[4:]) / 16.0
    return np.interp(motion.time, clock, x)
