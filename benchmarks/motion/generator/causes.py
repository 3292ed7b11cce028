"""Causes that the tool has an entry for, by its own names: how each acts on the arm, and what it takes of the torque.

Forms and usual sizes are those of the field: B. Armstrong-Helouvry, P. Dupont & C. Canudas de Wit, Automatica 30 (1994)
1083-1138, doi:10.1016/0005-1098(94)90209-7; P. Dahl, AIAA J. 14 (1976), 1675-1682; L. Simoni et al., IROS 2015,
doi:10.1109/IROS.2015.7354034 (friction and temperature); P. Hamon et al., IROS 2010 (friction and load).
"""

# ruff: noqa: ARG001, ARG005 (all are called alike)

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from benchmarks.blind.generator.vectors import Array
from benchmarks.motion.generator.arms import GRAVITY, STEP, Arm, Elastic, Rigid
from benchmarks.motion.generator.moved import Cause, Moved
from benchmarks.motion.generator.signals import low_passed
from benchmarks.motion.generator.world import Law, State, World

Drawn = tuple[tuple[int, ...], dict[str, float], dict[str, float]]
"""Joints or links (from 1), sizes of one or so, shapes."""


@dataclass(frozen=True)
class Kind:
    """How an effect is drawn, what it takes of the torque for sizes of one, (N, n) for each size, and how it acts;
    `most` is the greatest size that a machine may have, `weight` how often it is drawn."""

    draw: Callable[[Arm, np.random.Generator], Drawn]
    columns: Callable[[Cause, Moved], Sequence[Array]]
    install: Callable[[Cause, World], None]
    most: float = math.inf
    weight: float = 1.0


class Here(NamedTuple):
    """A joint at an instant, or at all of a motion; `load` is what its gear carries to the link."""

    time: Any
    q: Any
    velocity: Any
    load: Any


Pattern = Callable[[Here, Mapping[str, float]], Any]
"""Of a joint and the shapes of a cause."""


def _at_joint(
    *patterns: Callable[[Moved, int, Mapping[str, float]], Array],
) -> Callable[[Cause, Moved], Sequence[Array]]:
    def columns(cause: Cause, moved: Moved) -> Sequence[Array]:
        results = []
        for pattern in patterns:
            results.append(np.zeros_like(moved.q))
            results[-1][:, cause.joint] = pattern(moved, cause.joint, cause.shapes)
        return results

    return columns


def _here(moved: Moved, j: int) -> Here:
    return Here(moved.time, moved.q[:, j], moved.velocity[:, j], moved.rigid[:, j])


def _installed(patterns: Sequence[Pattern], *, rubs: bool) -> Callable[[Cause, World], None]:
    """Adds to the amount of friction, or to what a drive must push."""

    def install(cause: Cause, world: World) -> None:
        joint, parts = cause.joint, list(zip(cause.sizes.values(), patterns, strict=True))

        def act(state: State) -> None:
            here = Here(state.time, state.q[joint], state.velocity[joint], state.load(joint))
            total = sum(size * float(pattern(here, cause.shapes)) for size, pattern in parts)
            (state.loss if rubs else state.demand)[joint] += total

        world.laws.append(lambda: act)

    return install


def _drawn(
    *names: str, sign: bool = False, turning: bool = False, **shapes: tuple[float, float]
) -> Callable[[Arm, np.random.Generator], Drawn]:
    """At any joint; of two sizes any mixture, shapes evenly on a logarithmic scale."""

    def draw(arm: Arm, rng: np.random.Generator) -> Drawn:
        joint = int(rng.choice([i for i in range(arm.count) if not (turning and arm.axes[i].slide)]))
        angle = float(rng.uniform(0.0, 2.0 * math.pi))
        one = float(rng.choice([-1.0, 1.0])) if sign else 1.0
        values = (one,) if len(names) == 1 else (math.cos(angle), math.sin(angle))
        forms = {name: float(f"{math.exp(rng.uniform(*np.log(ends))):.3g}") for name, ends in shapes.items()}
        return (joint + 1,), dict(zip(names, values, strict=True)), forms

    return draw


def _rubbing(draw: Callable[[Arm, np.random.Generator], Drawn], *amounts: Pattern, **how: float) -> Kind:
    """Friction whose amount is a pattern."""
    parts = [lambda m, j, c, amount=amount: m.sign[:, j] * amount(_here(m, j), c) for amount in amounts]
    return Kind(draw, _at_joint(*parts), _installed(amounts, rubs=True), **how)


def _pushing(draw: Callable[[Arm, np.random.Generator], Drawn], *torques: Pattern, **how: float) -> Kind:
    """A torque that is a pattern."""
    parts = [lambda m, j, c, torque=torque: torque(_here(m, j), c) for torque in torques]
    return Kind(draw, _at_joint(*parts), _installed(torques, rubs=False), **how)


def _of_drive(row: int) -> Callable[[Cause, World], None]:
    """Adds to what a drive has of its own in MuJoCo."""

    def install(cause: Cause, world: World) -> None:
        drives = world.arm.drives.copy()
        drives[row, cause.joint] += next(iter(cause.sizes.values()))
        world.arm = replace(world.arm, drives=drives)

    return install


def _of_world(name: str) -> Callable[[Cause, World], None]:
    """Adds to one of the world's figures of a joint."""

    def install(cause: Cause, world: World) -> None:
        for number in cause.at:
            getattr(world, name)[number - 1] += next(iter(cause.sizes.values()))

    return install


# What hangs on the arm


def _draw_payload(arm: Arm, rng: np.random.Generator) -> Drawn:
    centre = np.round([*rng.uniform(-0.06, 0.06, 2), rng.uniform(0.02, 0.12)], 3)
    return (), {"mass": 1.0}, dict(zip(("centre_x", "centre_y", "centre_z"), map(float, centre), strict=True))


def _draw_weight(arm: Arm, rng: np.random.Generator) -> Drawn:
    """A weight fixed to a link (a valve, a cable's clamp) somewhere along it."""
    link = int(rng.integers(0 if arm.family == "scara" else 1, arm.count))
    axis = arm.axes[link]
    at = np.array([axis.a, 0.0, axis.d]) * rng.uniform(0.2, 0.9) + rng.uniform(-0.06, 0.06, 3)
    return (link + 1,), {"mass": 1.0}, dict(zip(("x", "y", "z"), map(float, np.round(at, 3)), strict=True))


def _loaded(cause: Cause, arm: Arm, mass: float) -> Arm:
    """With the weight of a payload, or on a link."""
    at = np.array(list(cause.shapes.values()))
    return arm.with_point(cause.joint, mass, at) if cause.at else arm.with_point(arm.count - 1, mass, arm.tip + at)


def _install_weight(cause: Cause, world: World) -> None:
    world.arm = _loaded(cause, world.arm, cause.sizes["mass"])


def _draw_tilt(arm: Arm, rng: np.random.Generator) -> Drawn:
    angle = float(rng.uniform(0.0, 2.0 * math.pi))
    return (), {"about_x": math.cos(angle), "about_y": math.sin(angle)}, {}


def _tilted(about_x: float, about_y: float) -> Array:
    """Gravity in the frame of a base that is turned by small angles."""
    return -GRAVITY * np.array([-about_y, about_x, math.sqrt(max(0.0, 1.0 - about_x**2 - about_y**2))])


def _tilt_columns(cause: Cause, moved: Moved) -> Sequence[Array]:
    del cause
    still, result = np.zeros_like(moved.q), []
    for x, y in ((0.05, 0.0), (0.0, 0.05)):
        one, two = (Rigid.of(moved.arm, _tilted(s * x, s * y)).torque(moved.q, still, still) for s in (1.0, -1.0))
        result.append((one - two) / 0.1)
    return result


def _install_tilt(cause: Cause, world: World) -> None:
    world.gravity = _tilted(cause.sizes["about_x"], cause.sizes["about_y"])


def _draw_losses(arm: Arm, rng: np.random.Generator) -> Drawn:
    """What a gear loses where it drives and where the load does: both of them losses."""
    at, sizes, shapes = _drawn("forward", "backward")(arm, rng)
    return at, {name: abs(size) for name, size in sizes.items()}, shapes


# Friction with a memory, and of two joints


def _install_reversal(cause: Cause, world: World) -> None:
    """P. Dahl's law in place of so much of the declared Coulomb friction."""
    joint, distance, amount = cause.joint, cause.shapes["distance"], cause.sizes["torque"]

    def make() -> Law:
        bent = 0.0

        def act(state: State) -> None:
            nonlocal bent
            v = float(state.velocity[joint])
            way = math.copysign(1.0, v)
            bent = way + (bent - way) * math.exp(-abs(v) * STEP / distance)
            state.loss[joint] -= amount
            state.demand[joint] += amount * bent

        return act

    world.laws.append(make)


def _reversal_column(moved: Moved, j: int, shapes: Mapping[str, float]) -> Array:
    ways, bent, out = np.sign(moved.velocity[:, j]), 0.0, np.empty_like(moved.time)
    kept = np.exp(-np.abs(np.diff(moved.q[:, j], prepend=moved.q[:1, j])) / shapes["distance"])
    for k, way in enumerate(ways):
        bent = way + (bent - way) * kept[k]
        out[k] = bent - way
    return out


def _draw_coupling(arm: Arm, rng: np.random.Generator) -> Drawn:
    """The last joints of a wrist, of which one turns the other."""
    first = 1 if arm.family == "scara" else arm.count - int(rng.integers(1, 3))
    return (first, first + 1), {"coefficient": float(rng.choice([-1.0, 1.0]))}, {}


def _coupling_columns(cause: Cause, moved: Moved) -> Sequence[Array]:
    pair, out = [number - 1 for number in cause.at], np.zeros_like(moved.q)
    out[:, pair] = moved.velocity[:, pair[::-1]]
    return (out,)


def _install_coupling(cause: Cause, world: World) -> None:
    pair = [number - 1 for number in cause.at]

    def act(state: State) -> None:
        state.demand[pair] += cause.sizes["coefficient"] * state.velocity[pair[::-1]]

    world.laws.append(lambda: act)


# Drives, gears and encoders


def _draw_ripple(arm: Arm, rng: np.random.Generator) -> Drawn:
    order = float(rng.choice([2, 3, 4, 6, 8, 50, 80, 100, 120, 160, 200, 202, 240, 320]))
    at, sizes, _ = _drawn("sine", "cosine", turning=True)(arm, rng)
    return at, sizes, {"order": order}


def _draw_delay(arm: Arm, rng: np.random.Generator) -> Drawn:
    every = tuple(range(1, arm.count + 1))
    return every if rng.random() < 0.5 else (int(rng.integers(1, arm.count + 1)),), {"time": 1.0}, {}


def _delay_columns(cause: Cause, moved: Moved) -> Sequence[Array]:
    out, places = np.zeros_like(moved.q), [number - 1 for number in cause.at]
    out[:, places] = -moved.slope(moved.torque)[:, places]
    return (out,)


def _zero_columns(cause: Cause, moved: Moved) -> Sequence[Array]:
    """A joint stands beyond what its encoder says."""
    way = 1e-3 * (np.arange(moved.arm.count) == cause.joint)
    one, two = (Rigid.of(moved.arm).torque(moved.q + s * way, moved.velocity, moved.acceleration) for s in (1.0, -1.0))
    return ((one - two) / 2e-3,)


def _install_zero(cause: Cause, world: World) -> None:
    world.zero[cause.joint] -= cause.sizes["offset"]


def _draw_resonance(arm: Arm, rng: np.random.Generator) -> Drawn:
    return (int(rng.integers(1, 3)) if arm.family == "scara" else int(rng.integers(2, 5)),), {"compliance": 1.0}, {}


def _resonance_columns(cause: Cause, moved: Moved) -> Sequence[Array]:
    """The link lags its rotor by torque over stiffness; to first order in that."""
    behind = 1e-4 * low_passed(moved.rigid, moved.rate) * (np.arange(moved.arm.count) == cause.joint)
    once = moved.slope(behind)
    lagging = (moved.q - behind, moved.velocity - once, moved.acceleration - moved.slope(once))
    return ((Rigid.of(moved.arm).torque(*lagging) - moved.rigid) / 1e-4,)


def inertia_at(arm: Arm, joint: int) -> float:
    """Of the arm about a joint, stretched as at zero."""
    return float(Rigid.of(arm).inertia(np.zeros(arm.count))[joint, joint])


def _install_resonance(cause: Cause, world: World) -> None:
    stiffness = 1.0 / cause.sizes["compliance"]
    damping = 0.25 * math.sqrt(stiffness * inertia_at(world.arm, cause.joint))
    world.elastic[cause.joint] = Elastic(stiffness, damping)


def _install_spring(cause: Cause, world: World) -> None:
    world.springs[cause.joint] = world.springs.get(cause.joint, 0.0) + cause.sizes["stiffness"]


def _weight_columns(cause: Cause, moved: Moved) -> Sequence[Array]:
    return (moved.beyond(_loaded(cause, moved.arm, 1.0)),)


_WAVES: tuple[Pattern, Pattern] = (
    lambda h, c: np.sin(c.get("order", 1.0) * h.q),
    lambda h, c: np.cos(c.get("order", 1.0) * h.q),
)

KINDS: Mapping[str, Kind] = MappingProxyType(
    {
        "payload": Kind(_draw_payload, _weight_columns, _install_weight, 12.0, 2.0),
        "link_inertial": Kind(_draw_weight, _weight_columns, _install_weight, 12.0, 2.0),
        "base_tilt": Kind(_draw_tilt, _tilt_columns, _install_tilt, 0.12),
        "friction_coulomb": Kind(_drawn("torque"), _at_joint(lambda m, j, c: m.sign[:, j]), _of_drive(0), weight=2.0),
        "friction_viscous": Kind(
            _drawn("coefficient"), _at_joint(lambda m, j, c: m.velocity[:, j]), _of_drive(1), weight=2.0
        ),
        "friction_stribeck": _rubbing(
            _drawn("torque", speed=(0.03, 0.3)), lambda h, c: np.exp(-np.abs(h.velocity) / c["speed"])
        ),
        "friction_load": _rubbing(_drawn("share"), lambda h, c: np.abs(h.load), most=0.3, weight=2.0),
        "gear_efficiency": _rubbing(
            _draw_losses,
            lambda h, c: np.abs(h.load) * (h.load * h.velocity > 0.0),
            lambda h, c: np.abs(h.load) * (h.load * h.velocity < 0.0),
            most=0.5,
        ),
        "friction_asymmetry": _rubbing(_drawn("torque"), lambda h, c: h.velocity > 0.0),
        "friction_warmup": _rubbing(
            _drawn("torque", sign=True, time=(8.0, 60.0)), lambda h, c: 1.0 - np.exp(-h.time / c["time"])
        ),
        "friction_place": _rubbing(_drawn("sine", "cosine", turning=True), *_WAVES),
        "friction_reversal": Kind(
            _drawn("torque", distance=(1e-3, 1e-2)), _at_joint(_reversal_column), _install_reversal
        ),
        "friction_quadratic": _pushing(_drawn("coefficient", sign=True), lambda h, c: h.velocity * np.abs(h.velocity)),
        "joint_coupling": Kind(_draw_coupling, _coupling_columns, _install_coupling),
        "armature": Kind(_drawn("inertia"), _at_joint(lambda m, j, c: m.acceleration[:, j]), _of_drive(2), weight=2.0),
        "torque_constant": Kind(
            _drawn("excess", sign=True), _at_joint(lambda m, j, c: m.torque[:, j]), _of_world("gain"), 0.4, 2.0
        ),
        "torque_offset": Kind(
            _drawn("torque", sign=True), _at_joint(lambda m, j, c: np.ones_like(m.time)), _of_world("offset")
        ),
        "torque_delay": Kind(_draw_delay, _delay_columns, _of_world("delay"), 0.04),
        "gear_ripple": _pushing(_draw_ripple, *_WAVES),
        "spring": Kind(_drawn("stiffness"), _at_joint(lambda m, j, c: m.q[:, j]), _install_spring),
        "joint_compliance": Kind(_draw_resonance, _resonance_columns, _install_resonance),
        "encoder_offset": Kind(_drawn("offset", sign=True, turning=True), _zero_columns, _install_zero, 0.15),
    }
)
