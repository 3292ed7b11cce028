"""Unknown forces on the bodies: hoses, cables, stops, magnets, wind, payloads that are not points."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from benchmarks.blind.generator.vectors import Array
from benchmarks.multibody.causes import Stage
from benchmarks.multibody.engine import Machine, place
from benchmarks.multibody.session import Plan
from benchmarks.multibody.unknowns.unknown import Unknown, UnknownClass

Pushes = Sequence[tuple[str, Array, Array]]
NO_MOMENT = np.zeros(3)


def _at(body: Machine, site: str) -> Array:
    return np.array(body.data.site_xpos[body.site(site)])


def _turn(body: Machine) -> Array:
    return np.array(body.data.site_xmat[body.site("tip")]).reshape(3, 3)


def _weight(stage: Stage) -> float:
    """A middling force: a tenth of the weight of payload and links, N."""
    arm = stage.machine.arm
    return 0.98 * (arm.payload + sum(link.line_mass * link.length for link in arm.links))


def _reach(stage: Stage) -> float:
    return sum(link.length for link in stage.machine.arm.links)


def _up(stage: Stage) -> Array:
    gravity = np.array(stage.machine.arm.gravity)
    return -gravity / np.linalg.norm(gravity)


def _unit(vector: Array) -> Array:
    return vector / max(float(np.linalg.norm(vector)), 1e-12)


def _link(stage: Stage, rng: np.random.Generator) -> int:
    """A link (from 1) to hang something on: neither the first nor, where there are more than two, the last."""
    count = stage.machine.arm.count
    return 2 if count == 2 else int(rng.integers(2, count))


def _elbow(stage: Stage, rng: np.random.Generator) -> str:
    """An end of a link that moves, short of the tip."""
    arm = stage.machine.arm
    return f"end{int(rng.integers(1 if arm.planar else 2, arm.count))}"


def _stood(stage: Stage, site: str) -> Array:
    """Where a site stands at every visit, (3, v)."""
    results = []
    for rest in stage.tips.rests:
        place(stage.machine, rest.coordinates)
        results.append(_at(stage.machine, site))
    return np.stack(results, axis=1)


def _across(stage: Stage, rng: np.random.Generator) -> Array:
    """A level direction, or one in the arm's plane."""
    angle = float(rng.uniform(0.0, 2.0 * math.pi))
    if stage.machine.arm.planar:
        return np.array([math.copysign(1.0, math.cos(angle)), 0.0, 0.0])
    return np.array([math.cos(angle), math.sin(angle), 0.0])


def _hose_across_a_joint(stage: Stage, rng: np.random.Generator) -> Unknown:
    link = _link(stage, rng)
    one, two = f"middle{link - 1}", f"middle{link}"
    first, second = _stood(stage, one), _stood(stage, two)
    distance = np.linalg.norm(first - second, axis=0)
    slack = float(np.quantile(distance, 0.4))
    stiff = _weight(stage) / max(float(distance.max()) - slack, 1e-3)

    def act(plan: Plan, size: float) -> None:
        def force(body: Machine, v: int) -> Pushes:
            line = _at(body, two) - _at(body, one)
            pull = size * stiff * max(float(np.linalg.norm(line)) - slack, 0.0) * _unit(line)
            return [(one, pull, NO_MOMENT), (two, -pull, NO_MOMENT)]

        plan.forces.append(force)

    return Unknown("hose_across_a_joint", act, (link,), frozenset({f"q{link}"}))


def _cable_from_the_ceiling(stage: Stage, rng: np.random.Generator) -> Unknown:
    link, reach = _link(stage, rng), _reach(stage)
    hook = _up(stage) * reach * float(rng.uniform(0.7, 1.1)) + _across(stage, rng) * reach * 0.5
    site = f"middle{link}"
    distance = np.linalg.norm(_stood(stage, site) - hook[:, None], axis=0)
    slack = float(np.quantile(distance, 0.5))
    stiff = _weight(stage) / max(float(distance.max()) - slack, 1e-3)

    def act(plan: Plan, size: float) -> None:
        def force(body: Machine, v: int) -> Pushes:
            line = hook - _at(body, site)
            return [(site, size * stiff * max(float(np.linalg.norm(line)) - slack, 0.0) * _unit(line), NO_MOMENT)]

        plan.forces.append(force)

    return Unknown("cable_from_the_ceiling", act, (), frozenset({"position"}))


def _bumper(stage: Stage, rng: np.random.Generator) -> Unknown:
    site, way = _elbow(stage, rng), _across(stage, rng)
    along = way @ _stood(stage, site)
    wall = float(np.quantile(along, 0.65))
    stiff = 2.0 * _weight(stage) / max(float(along.max()) - wall, 1e-4)

    def act(plan: Plan, size: float) -> None:
        def force(body: Machine, v: int) -> Pushes:
            deep = max(float(way @ _at(body, site)) - wall, 0.0)
            return [(site, -size * stiff * deep * way, NO_MOMENT)]

        plan.forces.append(force)

    return Unknown("bumper", act, (), frozenset({"position"}))


def _steel_floor(stage: Stage, rng: np.random.Generator) -> Unknown:
    site, up = _elbow(stage, rng), _up(stage)
    height = up @ _stood(stage, site)
    depth = 0.25 * max(float(np.ptp(height)), 0.05)
    floor = float(height.min())

    def act(plan: Plan, size: float) -> None:
        def force(body: Machine, v: int) -> Pushes:
            near = math.exp(-(float(up @ _at(body, site)) - floor) / depth)
            return [(site, -2.0 * size * _weight(stage) * near * up, NO_MOMENT)]

        plan.forces.append(force)

    return Unknown("steel_floor", act, (), frozenset({"position"}))


def _half_full_tank(stage: Stage, rng: np.random.Generator) -> Unknown:
    """The payload's centre lies off the tip towards what is down, as far as the tank is wide across the tool."""
    arm = stage.machine.arm
    width = 0.1

    def act(plan: Plan, size: float) -> None:
        def force(body: Machine, v: int) -> Pushes:
            turn, gravity = _turn(body), np.array(arm.gravity)
            inside = turn.T @ _unit(gravity)
            inside[0] = 0.0
            return [("tip", NO_MOMENT, np.cross(turn @ (size * width * inside), plan.payload[v] * gravity))]

        plan.forces.append(force)

    return Unknown("half_full_tank", act, (arm.count,), frozenset({"payload_kg"}))


def _payload_beside_the_tip(stage: Stage, rng: np.random.Generator) -> Unknown:
    arm = stage.machine.arm
    angle = float(rng.uniform(0.0, 2.0 * math.pi))
    beside = 0.12 * np.array([math.cos(angle), math.sin(angle), 0.0])

    def act(plan: Plan, size: float) -> None:
        def force(body: Machine, v: int) -> Pushes:
            lever = _turn(body) @ (size * beside)
            return [("tip", NO_MOMENT, np.cross(lever, plan.payload[v] * np.array(arm.gravity)))]

        plan.forces.append(force)

    return Unknown("payload_beside_the_tip", act, (arm.count,), frozenset({"payload_kg"}))


def _operator_leans(stage: Stage, rng: np.random.Generator) -> Unknown:
    site, way = _elbow(stage, rng), _across(stage, rng)
    time = stage.session.time
    first = float(rng.uniform(0.15, 0.5)) * float(time[-1])
    last = first + float(rng.uniform(0.2, 0.35)) * float(time[-1])
    there = (time >= first) & (time < last)

    def act(plan: Plan, size: float) -> None:
        def force(body: Machine, v: int) -> Pushes:
            return [(site, size * _weight(stage) * float(there[v]) * way, NO_MOMENT)]

        plan.forces.append(force)

    since, until = (float(time[there][0]), float(time[there][-1])) if there.any() else (first, last)
    return Unknown("operator_leans", act, (), frozenset({"time"}), since, until)


def _wind(stage: Stage, rng: np.random.Generator) -> Unknown:
    """Drag on each link with the square of how far it stands across the wind, at its middle."""
    way, count = _across(stage, rng), stage.machine.arm.count

    def act(plan: Plan, size: float) -> None:
        def force(body: Machine, v: int) -> Pushes:
            pushes = []
            for link in range(2, count + 1):
                line = _unit(_at(body, f"end{link}") - _at(body, f"end{link - 1}"))
                share = plan.machine.arm.links[link - 1].length / _reach(stage)
                facing = 1.0 - float(line @ way) ** 2
                pushes.append((f"middle{link}", 1.5 * size * _weight(stage) * share * facing * way, NO_MOMENT))
            return pushes

        plan.forces.append(force)

    return Unknown("wind", act, (), frozenset({"position"}))


FORCES = (
    UnknownClass("hose_across_a_joint", "a hose between two links that pulls once it is taut", _hose_across_a_joint),
    UnknownClass(
        "cable_from_the_ceiling", "a cable from above to the middle of a link, slack or taut", _cable_from_the_ceiling
    ),
    UnknownClass("bumper", "an elbow that leans against a soft wall in a part of the workspace", _bumper),
    UnknownClass("steel_floor", "an elbow drawn to a floor the more the nearer", _steel_floor),
    UnknownClass(
        "half_full_tank", "a payload whose centre runs to the lower side", _half_full_tank, frozenset({"payloads"})
    ),
    UnknownClass("payload_beside_the_tip", "a payload whose centre lies beside the tip", _payload_beside_the_tip),
    UnknownClass("operator_leans", "somebody leans on a link for a while", _operator_leans),
    UnknownClass("wind", "a steady wind on all links", _wind),
)
