"""Joint torques and power of a motion by the whole model of an arm, and the load of each drive over it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple, dataclass, replace

import numpy as np

from linkwright.core.arm.chain.chain import Arm, EffectEntry, Joint
from linkwright.core.arm.effects import EFFECTS, Settings
from linkwright.core.arm.effects.drives.armature import ARMATURE
from linkwright.core.arm.effects.loads.inertial import OfInertia, torque_of_more
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.arm.motion.rigid import inverse_dynamics
from linkwright.core.sections.numeric import Array


def model_torque(motion: Motion) -> Array:
    """Torques that a motion takes of the drives: the rigid arm's, with what the arm's `effects` add.

    What goes by a load (friction under it, elasticity) goes by what the drives pass on to the arm: its links, with what
    its effects add to their weight. What is of the instrument (a torque constant, an offset, a delay) comes last, and
    goes by all that is before it, as what is logged does.

    Args:
        motion: The motion; its own `torque` does not count.

    Returns:
        (N, n) N*m (N for slides), positive where the drive pushes towards increasing q.

    Raises:
        PropertyNeeded: A link's mass is not known.
        InputError: The arm has branches, or links that run out of a sleeve.

    >>> from linkwright.core.arm.chain.chain import Arm, Joint, Link
    >>> rubs = (EffectEntry("friction_viscous", (1,), {"coefficient": 3.0}),)
    >>> arm = Arm("rod", (Joint(),), (Link(0.5, mass=2.0, center_of_mass=0.25),), effects=rubs)
    >>> turning = Motion(arm, np.zeros(1), np.full((1, 1), np.pi / 2), np.ones((1, 1)), np.zeros((1, 1)))
    >>> model_torque(turning).round(9).tolist()
    [[3.0]]
    """
    return torque_stages(motion).logged


@dataclass(frozen=True)
class Stages:
    """Torques (N, n), N*m (N for slides), in the order in which they come about: `load` is what the drives pass on to
    the arm (links, payload, tilt), `drive` what they give, friction and rotors included, `logged` what the instrument
    makes of that."""

    load: Array
    drive: Array
    logged: Array


@dataclass(frozen=True)
class Acting:
    """The entries of effects that act on a moving arm, by the stage at which they do: on what the drives pass on
    (`loads`), in the `drives`, and in the `instrument` that logs them."""

    loads: tuple[EffectEntry, ...]
    drives: tuple[EffectEntry, ...]
    instrument: tuple[EffectEntry, ...]


def acting(arm: Arm) -> Acting:
    """The entries that act on an arm in motion: those of its `effects`, and what its file has anyway."""
    given = (e.id for e in EFFECTS.values() if e.automatic and e.torques is not None and e.id not in arm.leave_out)
    entries = [*(EffectEntry(effect) for effect in given), *arm.effects]
    instrument = [entry for entry in entries if EFFECTS[entry.effect].recording.of_instrument]
    others = [entry for entry in entries if entry not in instrument]
    loads = [entry for entry in others if EFFECTS[entry.effect].place != "joint"]
    return Acting(tuple(loads), tuple(entry for entry in others if entry not in loads), tuple(instrument))


def torque_stages(motion: Motion) -> Stages:
    """The torques of `model_torque` with what they are made of."""
    entries = acting(motion.arm)
    rigid = inverse_dynamics(motion)
    load = rigid + torque_of(replace(motion, torque=rigid), entries.loads)
    drive = load + torque_of(replace(motion, torque=load), entries.drives)
    return Stages(load, drive, drive + torque_of(replace(motion, torque=drive), entries.instrument))


def torque_of(motion: Motion, entries: Sequence[EffectEntry]) -> Array:
    """What effects with these entries take of the drives (N, n) beyond the rigid arm, one added to the other."""
    torque = np.zeros(motion.q.shape)
    parameters = np.zeros((motion.arm.size, 10))
    for entry in entries:
        torques = EFFECTS[entry.effect].torques
        if isinstance(torques, OfInertia):  # bodies add up, and take one pass together
            parameters += torques.parameters(motion.arm, Settings.of(entry))
            continue
        for joint, more in ({} if torques is None else torques(motion, Settings.of(entry))).items():
            torque[:, joint] += more
    for joint, more in torque_of_more(motion, parameters).items():
        torque[:, joint] += more
    return torque


def drive_torques(motion: Motion) -> Array:
    """What a motion takes of the drives (N, n), N*m (N for slides): `model_torque`, and the rotors of drives from a
    catalogue that knows them. Raises as that does."""
    return model_torque(motion) + motion.acceleration * [_rotor(motion.arm, index) for index in range(motion.arm.size)]


def _rotor(arm: Arm, index: int) -> float:
    """The inertia (kg*m^2) of a catalogue's rotor behind its gear; none where the file says what turns there."""
    actuator = arm.joints[index].actuator
    said = any(entry.effect == ARMATURE.id and (not entry.at or index + 1 in entry.at) for entry in arm.effects)
    return 0.0 if actuator is None or said else actuator.rotor_at_joint


def drive_power(motion: Motion, torque: Array) -> Array:
    """The power of each drive (N, n) W under these torques (N, n): positive where it drives, negative where it
    brakes."""
    return torque * motion.velocity


@dataclass(frozen=True)
class OfDrive:
    """What a motion asks of one drive, by the arm's whole model: the greatest `torque` (N*m; N for a slide) to either
    side and its root mean square `rms_torque` over time, the greatest `speed` (rad/s, m/s) and `power` (W), the
    `energy` (J) that the drive puts in and what it brakes off again (`braked`)."""

    torque: float
    rms_torque: float
    speed: float
    power: float
    energy: float
    braked: float

    def uses(self, joint: Joint) -> tuple[float | None, float | None]:
        """What share of its joint's peak torque the greatest torque takes, and of its rated one the root mean square;
        None where nobody knows those."""
        rated, peak = joint.rating
        return None if peak is None else self.torque / peak, None if rated is None else self.rms_torque / rated


def most_of(motions: Sequence[Sequence[OfDrive]]) -> tuple[OfDrive, ...]:
    """The most that any of several motions asks of each drive."""
    every = np.array([[astuple(drive) for drive in drives] for drives in motions]).max(axis=0)
    return tuple(OfDrive(*drive) for drive in every.tolist())


def loads_of(motion: Motion) -> tuple[OfDrive, ...]:
    """What a motion asks of each of an arm's drives (`drive_torques`); integrals by trapezoids.

    Raises `PropertyNeeded` for a link of unknown mass, `InputError` for an arm with branches or links that run out.
    """
    torque = drive_torques(motion)
    power = drive_power(motion, torque)
    span = float(motion.time[-1] - motion.time[0])
    loads: list[OfDrive] = []
    for item, speed, work in zip(torque.T, motion.velocity.T, power.T, strict=True):
        loads.append(
            OfDrive(
                torque=float(np.abs(item).max()),
                rms_torque=float(np.sqrt(np.trapezoid(item**2, motion.time) / span)),
                speed=float(np.abs(speed).max()),
                power=float(work.max()),
                energy=float(np.trapezoid(np.maximum(work, 0.0), motion.time)),
                braked=float(-np.trapezoid(np.minimum(work, 0.0), motion.time)),
            )
        )
    return tuple(loads)
