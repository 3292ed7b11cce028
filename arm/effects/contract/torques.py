"""The joint torques of an effect on motions of a few chains, checked against its declarations."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from types import MappingProxyType

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects.effect import Effect, Settings
from linkwright.core.arm.effects.torques import Bent
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.sections.numeric import Array

from .chains import TOLERANCE, chains, faults_on

_INSTANTS = 40


def torque_faults(effect: Effect) -> list[str]:
    """What is wrong with the torques of an effect, as phrases; each is said once."""
    if effect.torques is None:
        return []
    tried = [_motion(chain.arm, seed) for seed, chain in enumerate(chains())]
    faults = faults_on(tried, partial(_faults, effect), lambda _: "a motion")
    return faults or list(_idle_sizes(effect, tried))


def _motion(arm: Arm, seed: int) -> Motion:
    """A swinging motion with everything that a log can hold; the chain's links are given masses."""
    links = tuple(replace(link, mass=2.0 + index) for index, link in enumerate(arm.links))
    rng = np.random.default_rng(seed)
    time = np.linspace(0.0, 2.0, _INSTANTS)
    rate, start, wide = (rng.uniform(*ends, arm.size) for ends in ((1.5, 4.0), (-2.0, 2.0), (0.1, 0.6)))
    phase = np.outer(time, rate) + start
    q = wide * np.sin(phase)
    return Motion(
        replace(arm, links=links),
        time,
        q,
        wide * rate * np.cos(phase),
        -(rate**2) * q,
        commanded=q + 1e-3,
        joint_side=q - 1e-4 * np.sign(np.cos(phase)),
        temperature=300.0 + time,
    )


@dataclass(frozen=True)
class _Tried:
    """An effect on a motion, its parameters at the upper end of what is typical."""

    effect: Effect
    motion: Motion

    @property
    def usual(self) -> dict[str, float]:
        """Everything at the upper end of what is typical."""
        return {parameter.name: parameter.typical[1] for parameter in self.effect.parameters}

    def torques(self, values: Mapping[str, float], at: tuple[int, ...] = ()) -> dict[int, Array]:
        """The torques by joint."""
        assert self.effect.torques is not None
        return dict(self.effect.torques(self.motion, Settings(at, MappingProxyType(dict(values)))))

    def table(self, values: Mapping[str, float], at: tuple[int, ...] = ()) -> Array:
        """The torques (N, n), those of joints that are left alone zero."""
        torques = np.zeros(self.motion.q.shape)
        for joint, more in self.torques(values, at).items():
            torques[:, joint] = more
        return torques


def _faults(effect: Effect, motion: Motion) -> Iterator[str]:
    tried = _Tried(effect, motion)
    usual, size = tried.usual, motion.arm.size
    for joint, more in tried.torques(usual).items():
        if not 0 <= joint < size:
            yield f"takes torque of joint {joint}, which the chain does not have"
            return
        if np.shape(more) != (motion.size,):
            yield f"has torques of shape {np.shape(more)}, where one for each instant is due"
            return
    whole = tried.table(usual)
    if not np.isfinite(whole).all():
        yield "gives torques that are not finite"
        return
    if not isinstance(effect.torques, Bent):
        yield from _unlike(tried, whole)
    yield from _driving(tried)
    for index, joint in enumerate(motion.arm.joints if effect.place in ("joint", "link") else ()):
        if not effect.can_act(index, revolute=joint.revolute) and tried.table(usual, (index,)).any():
            yield f"takes torque where it cannot act ({effect.only})"
    joints = motion.arm.joints
    passive = replace(motion.arm, joints=(*joints[:-1], replace(joints[-1], passive=True)))
    if effect.drive.needed and size - 1 in _Tried(effect, replace(motion, arm=passive)).torques(usual):
        yield "takes torque of a joint without a drive"


def _driving(tried: _Tried) -> Iterator[str]:
    """Where friction of steady motion one way helps a joint on, at sizes that cannot be negative."""
    effect, motion = tried.effect, tried.motion
    if effect.cause != "friction in motion" or any(size.lower < 0.0 for size in effect.torque_sizes):
        return
    speed = np.full(motion.q.shape, 0.5)
    way = motion.time[:, None] * speed
    steady = replace(motion, q=way, velocity=speed, acceleration=0.0 * speed, commanded=way + 1e-3, joint_side=way)
    if (_Tried(effect, steady).table(tried.usual).sum(axis=0) < 0.0).any():
        yield "helps joints on that it should brake: torques are positive where the drive pushes towards more of q"


def _unlike(tried: _Tried, whole: Array) -> Iterator[str]:
    """Where torques do not follow the sizes in proportion, and do not add up."""
    names = [size.name for size in tried.effect.torque_sizes]
    rest = {name: value for name, value in tried.usual.items() if name not in names}
    if tried.table({**rest, **dict.fromkeys(names, 0.0)}).any():
        yield "takes torque at a size of 0"
        return
    scale = TOLERANCE * max(float(np.abs(whole).max()), 1e-12)
    # A point's inertia goes with its mass, which is no size beside where its centre is; so all sizes are scaled.
    twice = tried.table({**rest, **{name: 2.0 * tried.usual[name] for name in names}})
    if np.abs(twice - 2.0 * whole).max() > scale:
        yield "has torques that are not linear in its sizes"
        return
    added = np.sum([tried.table({**rest, name: tried.usual[name]}) for name in names], axis=0)
    if np.abs(added - whole).max() > scale:
        yield "has torques that do not add up, size by size"
    sizes = {name: tried.usual[name] for name in names}
    named = {shape.name: shape.default for shape in tried.effect.torque_shapes}
    if not np.array_equal(tried.table(sizes), tried.table({**sizes, **named})):
        yield "takes another torque where a shape is not named than at its default"


def _idle_sizes(effect: Effect, tried: Iterable[Motion]) -> Iterator[str]:
    turn = np.linspace(0.0, 2.0 * np.pi, _INSTANTS)[:, None]
    motions = [item for motion in tried for item in (motion, replace(motion, q=0.0 * motion.q + turn))]
    trials = [_Tried(effect, motion) for motion in motions]
    for size in effect.parameters:
        if size.role == "torque":
            others = {other.name: other.typical[1] for other in effect.torque_shapes}
            if not any(one.table({**others, size.name: size.typical[1]}).any() for one in trials):
                yield f"the size {size.name} takes no torque, on no chain"
