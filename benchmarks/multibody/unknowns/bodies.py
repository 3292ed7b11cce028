"""Unknown faults of links, bearings, targets, the base and the tracker."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from benchmarks.blind.generator.vectors import Array
from benchmarks.multibody.causes import Stage, any_joint, elastic_link
from benchmarks.multibody.engine import Rest
from benchmarks.multibody.session import Plan
from benchmarks.multibody.unknowns.unknown import Act, Unknown, UnknownClass

SHIFT = 1e-4  # m, a middling one


def _sign(rng: np.random.Generator) -> float:
    return 1.0 if rng.random() < 0.5 else -1.0


def _breathing_crack(stage: Stage, rng: np.random.Generator) -> Unknown:
    """A crack somewhere along a link opens under one sign of moment."""
    link = elastic_link(stage, rng)
    node = int(rng.integers(0, len(stage.machine.nodes[link])))
    hinge = stage.machine.nodes[link][node][5]
    moment = stage.tips.load[hinge]
    way = float(np.sign(moment[np.argmax(np.abs(moment))])) * (1.0 if rng.random() < 0.6 else -1.0)
    give = 4e-4 / max(float(np.abs(moment).max()), 1e-3)

    def act(plan: Plan, size: float) -> None:
        def law(load: Array, v: int, past: Sequence[Array]) -> list[tuple[int, float]]:
            return [(hinge, size * give * way * max(way * float(load[hinge]), 0.0))]

        plan.laws.append(law)

    return Unknown("breathing_crack", act, (link + 1,), frozenset({"position"}))


def _seated(stage: Stage, joint: int, shift: Array) -> Act:
    """Moves a joint's axis across by (3, v), in the frame of the link before."""

    def act(plan: Plan, size: float) -> None:
        plan.rest[list(plan.machine.seat[joint])] += size * shift

    return act


def _across(stage: Stage, joint: int) -> tuple[Array, Array]:
    axis = np.array(stage.machine.arm.joints[joint].axis, dtype=float)
    u = np.cross(axis, [1.0, 0.0, 0.0] if abs(axis[0]) < 0.9 else [0.0, 1.0, 0.0])
    u /= np.linalg.norm(u)
    return u, np.cross(axis, u)


def _bearing_runout(stage: Stage, rng: np.random.Generator) -> Unknown:
    i = any_joint(stage, rng)
    u, v = _across(stage, i)
    angle = 2.0 * stage.session.q[i] + float(rng.uniform(0.0, 2.0 * math.pi))
    shift = 2.0 * SHIFT * (np.outer(u, np.cos(angle)) + np.outer(v, np.sin(angle)))
    return Unknown("bearing_runout", _seated(stage, i, shift), (i + 1,), frozenset({f"q{i + 1}"}))


def _bearing_by_side(stage: Stage, rng: np.random.Generator) -> Unknown:
    i = any_joint(stage, rng)
    u, v = _across(stage, i)
    angle = float(rng.uniform(0.0, math.pi))
    way = math.cos(angle) * u + math.sin(angle) * v
    shift = 1.5 * SHIFT * np.outer(way, stage.session.side[i])
    return Unknown("bearing_by_side", _seated(stage, i, shift), (i + 1,), frozenset({f"dir{i + 1}"}))


def _wobbling_axis(stage: Stage, rng: np.random.Generator) -> Unknown:
    i = int(rng.integers(0, max(stage.machine.arm.count - 1, 1)))
    u, v = _across(stage, i)
    angle = stage.session.q[i] + float(rng.uniform(0.0, 2.0 * math.pi))
    turn = 2e-4 * (np.outer(u, np.cos(angle)) + np.outer(v, np.sin(angle)))

    def act(plan: Plan, size: float) -> None:
        plan.rest[list(plan.machine.tilt[i])] += size * turn

    return Unknown("wobbling_axis", act, (i + 1,), frozenset({f"q{i + 1}"}))


def _play_about_a_link(stage: Stage, rng: np.random.Generator) -> Unknown:
    """A flange with play about the link's own axis: it lies to whichever side the twisting moment turns it."""
    link = elastic_link(stage, rng)
    twist = stage.machine.nodes[link][0][3]

    def act(plan: Plan, size: float) -> None:
        def law(load: Array, v: int, past: Sequence[Array]) -> list[tuple[int, float]]:
            return [(twist, size * 3e-4 * math.tanh(float(load[twist]) / 0.02))]

        plan.laws.append(law)

    return Unknown("play_about_a_link", act, (link + 1,), frozenset({"position"}))


def _read(effect: str, read: object, depends_on: frozenset[str], joints: tuple[int, ...] = ()) -> Unknown:
    def act(plan: Plan, size: float) -> None:
        plan.readings.append(lambda tips, rests: size * read(tips, rests))  # type: ignore[operator]

    return Unknown(effect, act, joints, depends_on)


def _loose_target(stage: Stage, rng: np.random.Generator) -> Unknown:
    """The target slides along the tool to whichever end is down."""
    gravity, count = np.array(stage.machine.arm.gravity), stage.machine.arm.count
    way = np.array(stage.machine.arm.links[-1].direction, dtype=float)
    if rng.random() < 0.5:
        way = _across(stage, count - 1)[1]
    way = way / np.linalg.norm(way)

    def read(tips: Array, rests: tuple[Rest, ...]) -> Array:
        out = [rest.turn @ way for rest in rests]
        return np.stack([1.5 * SHIFT * math.tanh(float(gravity @ axis) / 0.3) * axis for axis in out], axis=1)

    return _read("loose_target", read, frozenset({"position"}), (count,))


def _tracker_at(stage: Stage, rng: np.random.Generator) -> Array:
    reach = sum(link.length for link in stage.machine.arm.links)
    angle = float(rng.uniform(0.0, 2.0 * math.pi))
    way = np.array([math.cos(angle), math.sin(angle), 0.0 if stage.machine.arm.planar else 0.2])
    return way * reach * float(rng.uniform(1.8, 2.6))


def _skewed_target(stage: Stage, rng: np.random.Generator) -> Unknown:
    """A reflector reads long by how far it is turned away from the beam."""
    tracker = _tracker_at(stage, rng)

    def read(tips: Array, rests: tuple[Rest, ...]) -> Array:
        beam = tips - tracker[:, None]
        beam = beam / np.linalg.norm(beam, axis=0)
        facing = np.stack([rest.turn[:, 0] for rest in rests], axis=1)
        turned_away = 1.0 - np.abs((beam * facing).sum(axis=0))
        return 2.0 * SHIFT * turned_away**2 * beam

    return _read("skewed_target", read, frozenset({"position"}))


def _bent_beam(stage: Stage, rng: np.random.Generator) -> Unknown:
    """Air of different warmth bends the beam: up or down with the cube of the distance."""
    tracker, sign = _tracker_at(stage, rng), _sign(rng)
    gravity = np.array(stage.machine.arm.gravity)
    up = -gravity / np.linalg.norm(gravity)

    def read(tips: Array, rests: tuple[Rest, ...]) -> Array:
        far = np.linalg.norm(tips - tracker[:, None], axis=0) / np.linalg.norm(tracker)
        return 4.0 * SHIFT * sign * up[:, None] * far**3

    return _read("bent_beam", read, frozenset({"position"}))


def _tracker_encoder(stage: Stage, rng: np.random.Generator) -> Unknown:
    """The tracker's own turning axis errs with its angle, twice a turn and more."""
    tracker, order = _tracker_at(stage, rng), int(rng.integers(6, 14))
    phase = float(rng.uniform(0.0, 2.0 * math.pi))

    def read(tips: Array, rests: tuple[Rest, ...]) -> Array:
        line = tips - tracker[:, None]
        azimuth = np.arctan2(line[1], line[0])
        across = np.stack([-line[1], line[0], np.zeros(azimuth.size)]) / np.linalg.norm(tracker)
        return 1.5 * SHIFT * across * np.sin(order * azimuth + phase)

    return _read("tracker_encoder", read, frozenset({"position"}))


def _settling_base(stage: Stage, rng: np.random.Generator) -> Unknown:
    """The base sinks to one side by each heavy payload, and a part of that stays for good."""
    session = stage.session
    heavy = session.payload > 0.5 * float(session.payload.max())
    sunk = np.zeros(session.visits)
    for v in range(1, session.visits):
        sunk[v] = sunk[v - 1] + (0.12 * (1.0 - sunk[v - 1]) if heavy[v] else -0.03 * sunk[v - 1])
    about = 2 if stage.machine.arm.planar else int(rng.integers(0, 2))
    sign = _sign(rng)

    def act(plan: Plan, size: float) -> None:
        plan.rest[plan.machine.base[3 + about]] += sign * size * 2e-4 * sunk

    return Unknown("settling_base", act, (), frozenset({"time"}))


_SIDES, _SPACE = frozenset({"sides"}), frozenset({"space"})
BODIES = (
    UnknownClass("breathing_crack", "a link that is cracked and opens one way", _breathing_crack, frozenset({"links"})),
    UnknownClass("bearing_runout", "a bearing that runs out twice a turn", _bearing_runout),
    UnknownClass("bearing_by_side", "an axis that shifts with the side of approach", _bearing_by_side, _SIDES),
    UnknownClass("wobbling_axis", "an axis that wobbles as it turns", _wobbling_axis, _SPACE),
    UnknownClass(
        "play_about_a_link", "a flange with play about its link", _play_about_a_link, _SPACE | {"links", "wrist"}
    ),
    UnknownClass("loose_target", "a target that slides to the lower end", _loose_target),
    UnknownClass("skewed_target", "a target that reads long when it is turned away", _skewed_target),
    UnknownClass("bent_beam", "a beam bent by warm air", _bent_beam),
    UnknownClass("tracker_encoder", "a tracker whose own axis errs", _tracker_encoder),
    UnknownClass("settling_base", "a base that sinks under heavy payloads", _settling_base),
)
