"""Everything that the library could add to the model, as patterns over a recording's readings.

A candidate is an effect at a place (one joint or link, or all that share it) with its shapes fixed; its columns are the
displacements for one unit of each of its sizes. Shapes (a lag, a threshold, an order) make variants of one candidate.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from arm.beam import Beam
from arm.chain import LoadCase
from arm.effects import EFFECTS, Effect, Parameter, Settings
from arm.statics import PoseState, solve

from .observed import Observed

Array = NDArray[np.float64]

_STEP = 1e-3
"""Sizes are tried at this share of their typical upper end: small enough for what is linear to first order only."""

WHOLE = frozenset({"order", "orders", "anew", "sharp"})
"""Shapes that are whole numbers and stay on their grid."""
STANDS = 0.05
"""rad; a joint that travels less is taken to stand."""
_STEADY = 0.02
"""A load that changes by no more than this share of its greatest is steady."""
_FOR_EACH = 8.0
"""Different angles for each coefficient of a joint's curve."""

PLAUSIBLE: tuple[str, ...] = (
    "joint_compliance",
    "encoder_offset",
    "link_length",
    "backlash",
    "payload",
    "slope_propagation",
    "link_bending",
    "thermal_expansion",
    "link_modulus",
    "tool_offset",
    "axis_misalignment",
    "encoder_eccentricity",
    "gear_transmission_error",
    "joint_waviness",
    "joint_hardening",
    "clearance",
    "frame_misalignment",
    "encoder_scale",
    "joint_coupling",
    "friction_windup",
    "gearbox_thermal",
    "thermal_bending",
    "base_compliance",
    "base_tilt",
    "link_mass",
    "instrument_scale",
    "frame_drift",
    "creep",
    "counterbalance",
    "latency",
    "dynamic_deflection",
    "servo_droop",
)
"""Which name goes first where the data cannot tell: the commoner cause before the rarer, the simpler before the richer
(stiffness of drives and geometry lead in the surveys of robot calibration, e.g. B. W. Mooring, Z. S. Roth &
M. R. Driels, Fundamentals of Manipulator Calibration, Wiley 1991, ch. 1)."""


@dataclass(frozen=True)
class Candidate:
    """An effect at places (from 0) with its shapes (SI), or a form outside the library (`effect` then is its name).

    `sizes` names the parameter of each column; `shared` says that one parameter serves all places. `share` marks
    physics that the arm file has data for but leaves out: its one column is the whole effect, and its size should come
    out as 1.
    """

    effect: str
    at: tuple[int, ...]
    sizes: tuple[str, ...]
    shapes: Mapping[str, float]
    shared: bool = False
    share: bool = False
    outside: bool = False

    @property
    def family(self) -> tuple[str, tuple[int, ...], bool]:
        """What variants of one candidate have in common."""
        return (self.effect, self.at, self.share)

    @property
    def free_shapes(self) -> tuple[str, ...]:
        """The shapes that may take any value between those of the grid."""
        if self.outside:
            return tuple(name for name in self.shapes if name == "core" or name.startswith("at_"))
        return tuple(name for name, value in self.shapes.items() if name not in WHOLE and value > 0.0)

    def settings(self, values: Mapping[str, float]) -> Settings:
        """The effect's settings at sizes of these values."""
        return Settings(self.at, MappingProxyType({**self.shapes, **values}))


def candidates(observed: Observed, without: frozenset[str] = frozenset()) -> Iterator[tuple[Candidate, Array]]:
    """Every candidate of the library with its columns (N, C, d); those that move nothing are left out.

    `without` takes effects out by id.
    """
    for effect in EFFECTS.values():
        if effect.id in without:
            continue
        for candidate in _of_effect(observed, effect):
            columns = columns_of(observed, candidate)
            if columns is None:
                continue
            moving = np.asarray(columns.any(axis=(0, 1)))
            if columns.shape[2] == len(candidate.sizes) and not moving.all():
                # In the plane a shift out of it, say, moves nothing: no size of this candidate.
                sizes = tuple(name for name, moves in zip(candidate.sizes, moving.tolist(), strict=True) if moves)
                candidate, columns = replace(candidate, sizes=sizes), columns[:, :, moving]
            yield candidate, columns


def columns_of(observed: Observed, candidate: Candidate) -> Array | None:
    """A candidate's columns (N, C, d) for one unit of each size, m and rad; None where it moves nothing."""
    effect = EFFECTS[candidate.effect]
    if candidate.share:
        pattern = observed.signature(effect.id, Settings())
        return pattern[:, :, None] if pattern.any() else None
    if effect.id == "joint_compliance" and observed.unknown_masses:
        extra = _unknown_weight(observed, candidate.at[0])
        known = observed.signature(effect.id, candidate.settings({"compliance": 1.0}))
        return np.concatenate([extra, known[:, :, None]], axis=2)
    parts: list[Array] = []
    for name in candidate.sizes:
        parameter = parameter_of(effect, name)
        step = _STEP * max(abs(parameter.typical[0]), abs(parameter.typical[1]))
        parts.append(observed.signature(effect.id, candidate.settings({name: step})) / step)
    columns = np.stack(parts, axis=2)
    return columns if columns.any() else None


def parameter_of(effect: Effect, name: str) -> Parameter:
    """An effect's parameter by name."""
    return next(parameter for parameter in effect.parameters if parameter.name == name)


def _of_effect(observed: Observed, effect: Effect) -> Iterator[Candidate]:
    sizes = tuple(parameter.name for parameter in effect.sizes)
    alone = tuple(parameter.name for parameter in effect.sizes if not parameter.of_all)
    common = tuple(parameter.name for parameter in effect.sizes if parameter.of_all) or sizes
    if effect.automatic and effect.id in observed.arm.leave_out:
        acting = tuple(i for i in _places(observed, effect) if observed.signature(effect.id, Settings((i,))).any())
        yield Candidate(effect.id, acting, ("share",), MappingProxyType({}), share=True)
    if not sizes:
        return
    shaped = [parameter for parameter in effect.parameters if parameter.role == "shape" and parameter.grid]
    joints = observed.arm.joints
    everywhere = tuple(i for i in _places(observed, effect) if effect.can_act(i, revolute=joints[i].revolute))
    places: list[tuple[tuple[int, ...], bool]] = [((index,), False) for index in everywhere]
    if effect.place in ("base", "tip"):
        places = [((), False)]
    elif effect.together and len(everywhere) > 1:
        places.append((everywhere, True))
    for (at, shared), values in itertools.product(places, itertools.product(*[p.grid for p in shaped])):
        shapes = {
            parameter.name: value * _load_scale(observed, at) if parameter.relative_to_load else value
            for parameter, value in zip(shaped, values, strict=True)
        }
        if not _needs_met(observed, effect, at, shapes):
            continue
        own = common if shared else alone
        yield Candidate(effect.id, at, own, MappingProxyType(shapes), shared=shared)
        needed = tuple(name for name in own if not parameter_of(effect, name).optional)
        if 0 < len(needed) < len(own):
            yield Candidate(effect.id, at, needed, MappingProxyType(shapes), shared=shared)


def _needs_met(observed: Observed, effect: Effect, at: tuple[int, ...], shapes: Mapping[str, float]) -> bool:
    """Whether the recording holds what a variant asks for; else it would move nothing, or repeat another variant."""
    held = observed.state.conditions
    if any(getattr(held, condition) is None for condition in effect.requires):
        return False
    if effect.least_travel > 0.0 and float(np.ptp(observed.recording.q[:, at[0]])) < effect.least_travel:
        return False
    if effect.id == "backlash" and shapes.get("held_below", 0.0) > 0.0:
        return held.sides is not None
    if effect.id == "creep" and not _load_changes(observed, at):
        return False
    if effect.id == "creep" and shapes.get("anew") == 0.0:
        started = observed.recording.time
        return started is not None and not np.array_equal(started, np.asarray(held.loaded_for))
    if effect.id == "gear_transmission_error":
        return _enough_travel(observed, at[0], shapes["order"])
    if effect.id == "joint_waviness":
        angles = np.unique(np.round(observed.recording.q[:, at[0]], 3))
        return len(angles) >= _FOR_EACH * 2.0 * shapes["orders"]
    if shapes.get("lag", 0.0) > 0.0:
        return held.time is not None and held.warming is not None
    return True


def _load_changes(observed: Observed, at: tuple[int, ...]) -> bool:
    """Whether the load on a drive changes: under the same load for ever, creep is any slow settling."""
    load = np.asarray(observed.state.joints[at[0]].drive_load, dtype=float)
    return float(np.ptp(load)) > _STEADY * float(np.max(np.abs(load)))


def _enough_travel(observed: Observed, joint: int, order: float) -> bool:
    """Whether a joint went through a whole wave of some order, at enough different coordinates to see it."""
    q = observed.recording.q[:, joint]
    waves = order * float(np.ptp(q)) / (2.0 * np.pi if observed.arm.joints[joint].revolute else 1.0)
    different = len(np.unique(np.round(q, 3)))
    return waves >= 1.0 and different >= max(8.0, 1.5 * waves)


def _places(observed: Observed, effect: Effect) -> tuple[int, ...]:
    return () if effect.place in ("base", "tip") else tuple(range(observed.arm.size))


def _load_scale(observed: Observed, at: tuple[int, ...]) -> float:
    """The greatest load (N*m, N) on the drives at these places; one where they carry none."""
    joints = [observed.state.joints[index] for index in at] if at else list(observed.state.joints)
    return max(float(np.max(np.abs(joint.drive_load))) for joint in joints) or 1.0


def _unknown_weight(observed: Observed, joint: int) -> Array:
    """How the drive of `joint` gives under links of unknown weight, (N, C, d): for each of them beyond the joint its
    mass at its own joint and its first moments along and across itself, times the compliance, in rad/(N*m) * kg and
    kg*m."""
    parts: list[Array] = []
    for index in observed.unknown_masses:
        if index < joint:
            continue
        for towards in (None, "along", "height", "width"):
            state = _weighing(observed.state, index, towards)
            weighed = replace(observed, state=state)
            settings = Settings((joint,), MappingProxyType({"compliance": 1.0}))
            parts.append(weighed.signature("joint_compliance", settings))
    return np.stack(parts, axis=2)


def _weighing(state: PoseState, link: int, towards: Literal["along", "height", "width"] | None) -> PoseState:
    """The same poses where only one link weighs: 1 kg at its joint, or a metre from there in one of its directions."""
    arm = state.arm
    bare = replace(arm, joints=tuple(replace(joint, mass=0.0) for joint in arm.joints))
    beams = [
        Beam(length=each.beam.length, lumped_mass=float(index == link), lumped_at=float(towards is not None))
        for index, each in enumerate(state.links)
    ]
    links = list(state.frames.links)
    if towards is not None:
        links[link] = replace(links[link], along=getattr(links[link], towards))
    frames = replace(state.frames, links=tuple(links))
    coordinates = [joint.coordinate for joint in state.joints]
    return solve(bare, coordinates, beams, LoadCase(), conditions=state.conditions, frames=frames)
