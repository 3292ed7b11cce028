"""Unknown laws of drives and encoders: what they give under load, remember, count or heat up by."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from benchmarks.blind.generator.vectors import Array
from benchmarks.multibody.causes import Stage, any_joint, loaded_joint, turn_drive
from benchmarks.multibody.session import Plan
from benchmarks.multibody.unknowns.unknown import Act, Unknown, UnknownClass

TURN = 2e-4  # rad, a middling one


def _most(stage: Stage, joint: int) -> float:
    return max(float(np.abs(stage.torque[joint]).max()), 1e-3)


def _by_load(joint: int, law: Callable[[float, int, Sequence[Array]], float]) -> Act:
    """A joint that turns by a law of the torque on its drive, the visit and the loads of the visits before."""

    def act(plan: Plan, size: float) -> None:
        drive = plan.machine.drive[joint]
        plan.laws.append(lambda load, v, past: [(drive, size * law(float(load[drive]), v, past))])

    return act


def _turned(joint: int, amount: Array) -> Act:
    """A joint that turns by a given amount at each visit."""
    return lambda plan, size: turn_drive(plan, joint, size * amount)


def _softening_drive(stage: Stage, rng: np.random.Generator) -> Unknown:
    i = loaded_joint(stage, rng)
    knee = float(rng.uniform(0.35, 0.6)) * _most(stage, i)
    give = 2.0 * TURN / (_most(stage, i) - knee)

    def law(torque: float, v: int, past: Sequence[Array]) -> float:
        return give * math.copysign(max(abs(torque) - knee, 0.0), torque)

    return Unknown("softening_drive", _by_load(i, law), (i + 1,), frozenset({"payload_kg"}))


def _one_sided_drive(stage: Stage, rng: np.random.Generator) -> Unknown:
    i = loaded_joint(stage, rng)
    way = 1.0 if rng.random() < 0.5 else -1.0
    give = 2.0 * TURN / _most(stage, i)

    def law(torque: float, v: int, past: Sequence[Array]) -> float:
        return give * way * max(way * torque, 0.0)

    return Unknown("one_sided_drive", _by_load(i, law), (i + 1,), frozenset({"payload_kg"}))


def _belt(stage: Stage, rng: np.random.Generator) -> Unknown:
    i = loaded_joint(stage, rng)
    phase = float(rng.uniform(0.0, 2.0 * math.pi))
    share = np.cos(2.0 * stage.session.q[i] + phase)

    def law(torque: float, v: int, past: Sequence[Array]) -> float:
        return 2.0 * TURN / _most(stage, i) * torque * float(share[v])

    return Unknown("belt", _by_load(i, law), (i + 1,), frozenset({f"q{i + 1}", "payload_kg"}))


def _loaded_ripple(stage: Stage, rng: np.random.Generator) -> Unknown:
    i = loaded_joint(stage, rng)
    order, phase = int(rng.integers(3, 8)), float(rng.uniform(0.0, 2.0 * math.pi))
    ripple = np.sin(order * stage.session.q[i] + phase)

    def law(torque: float, v: int, past: Sequence[Array]) -> float:
        return 2.0 * TURN / _most(stage, i) * abs(torque) * float(ripple[v])

    return Unknown("loaded_ripple", _by_load(i, law), (i + 1,), frozenset({f"q{i + 1}", "payload_kg"}))


def _ripple_by_side(stage: Stage, rng: np.random.Generator) -> Unknown:
    i = any_joint(stage, rng)
    order, phase = int(rng.integers(2, 6)), float(rng.uniform(0.0, 2.0 * math.pi))
    amount = TURN * stage.session.side[i] * np.sin(order * stage.session.q[i] + phase)
    return Unknown("ripple_by_side", _turned(i, amount), (i + 1,), frozenset({f"q{i + 1}", f"dir{i + 1}"}))


def _lost_counts(stage: Stage, rng: np.random.Generator) -> Unknown:
    """Each reversal of the joint, from one visit to the next, loses the encoder a little."""
    i = any_joint(stage, rng)
    moves = np.sign(np.diff(stage.session.q[i], prepend=stage.session.q[i, 0]))
    turned_back = np.concatenate([[0.0], (moves[1:] * moves[:-1] < 0.0).astype(float)])
    lost = np.cumsum(turned_back * (rng.random(moves.size) < 0.4))
    return Unknown(
        "lost_counts", _turned(i, 2.0 * TURN * lost / max(float(lost.max()), 1.0)), (i + 1,), frozenset({"time"})
    )


def _slipping_brake(stage: Stage, rng: np.random.Generator) -> Unknown:
    """Whenever the torque is high the brake lets the joint slip on, and it never comes back."""
    i = loaded_joint(stage, rng)
    torque = stage.torque[i]
    high = np.where(np.abs(torque) > 0.7 * _most(stage, i), torque / _most(stage, i), 0.0)
    slipped = np.cumsum(high)
    return Unknown(
        "slipping_brake",
        _turned(i, 2.0 * TURN * slipped / max(float(np.abs(slipped).max()), 1e-9)),
        (i + 1,),
        frozenset({"time"}),
    )


def _product_of_joints(stage: Stage, rng: np.random.Generator) -> Unknown:
    i = any_joint(stage, rng)
    j = int(rng.choice([k for k in range(stage.machine.arm.count) if k != i]))
    amount = stage.session.q[i] * stage.session.q[j]
    amount = TURN * amount / max(float(np.abs(amount).max()), 1e-9)
    return Unknown("product_of_joints", _turned(i, 2.0 * amount), (i + 1,), frozenset({f"q{i + 1}", f"q{j + 1}"}))


def _warmed_by_work(stage: Stage, rng: np.random.Generator) -> Unknown:
    """The drive warms by how far it has gone lately and cools by itself, whatever the hall does."""
    i = any_joint(stage, rng)
    travel = np.abs(np.diff(stage.session.q[i], prepend=stage.session.q[i, 0]))
    gaps = np.diff(stage.session.time, prepend=0.0)
    forget = np.exp(-gaps / (0.12 * float(stage.session.time[-1])))
    warmth = np.zeros(travel.size)
    for v in range(1, travel.size):
        warmth[v] = warmth[v - 1] * forget[v] + travel[v]
    return Unknown(
        "warmed_by_work",
        _turned(i, 2.0 * TURN * warmth / max(float(warmth.max()), 1e-9)),
        (i + 1,),
        frozenset({"time"}),
    )


def _memory_of_loads(stage: Stage, rng: np.random.Generator) -> Unknown:
    """A rubbery coupling still gives under the loads of the visits before."""
    i = loaded_joint(stage, rng)

    def act(plan: Plan, size: float) -> None:
        drive = plan.machine.drive[i]

        def law(load: Array, v: int, past: Sequence[Array]) -> list[tuple[int, float]]:
            left = sum(0.6**k * float(past[v - k][drive]) for k in range(1, min(v, 6) + 1))
            return [(drive, size * TURN / _most(stage, i) * left)]

        plan.laws.append(law)

    return Unknown("memory_of_loads", act, (i + 1,), frozenset({"time"}))


def _ageing_drive(stage: Stage, rng: np.random.Generator) -> Unknown:
    i = loaded_joint(stage, rng)
    share = stage.session.time / float(stage.session.time[-1])

    def law(torque: float, v: int, past: Sequence[Array]) -> float:
        return 2.0 * TURN / _most(stage, i) * torque * float(share[v])

    return Unknown("ageing_drive", _by_load(i, law), (i + 1,), frozenset({"time", "payload_kg"}))


def _drag_chain(stage: Stage, rng: np.random.Generator) -> Unknown:
    i = any_joint(stage, rng)
    q = stage.session.q[i]
    amount = TURN * stage.session.side[i] * (q - float(q.mean())) / max(float(np.ptp(q)) / 2.0, 1e-9)
    return Unknown("drag_chain", _turned(i, amount), (i + 1,), frozenset({f"q{i + 1}", f"dir{i + 1}"}))


def _gas_spring(stage: Stage, rng: np.random.Generator) -> Unknown:
    """A balancing cylinder whose force goes with its temperature."""
    i = loaded_joint(stage, rng)
    phase = float(rng.uniform(0.0, 2.0 * math.pi))
    warm = stage.session.warming(0.0)
    amount = np.sin(stage.session.q[i] + phase) * (warm - warm.mean()) / max(float(np.ptp(warm)) / 2.0, 1e-9)
    return Unknown("gas_spring", _turned(i, TURN * amount), (i + 1,), frozenset({f"q{i + 1}", "temperature_degC"}))


def _far_coupling(stage: Stage, rng: np.random.Generator) -> Unknown:
    """A joint dragged along by the one after it."""
    i = int(rng.integers(0, stage.machine.arm.count - 1))
    amount = stage.session.q[i + 1]
    amount = TURN * amount / max(float(np.abs(amount).max()), 1e-9)
    return Unknown("far_coupling", _turned(i, 2.0 * amount), (i + 1,), frozenset({f"q{i + 2}"}))


_SIDES, _LOADS = frozenset({"sides"}), frozenset({"payloads"})
DRIVES = (
    UnknownClass("softening_drive", "a drive that gives only beyond a torque", _softening_drive),
    UnknownClass("one_sided_drive", "a drive that gives under one sign of torque", _one_sided_drive),
    UnknownClass("belt", "a drive whose compliance goes with its angle", _belt),
    UnknownClass("loaded_ripple", "a gear whose ripple grows with the torque", _loaded_ripple),
    UnknownClass("ripple_by_side", "a gear whose ripple turns over with the side of approach", _ripple_by_side, _SIDES),
    UnknownClass("lost_counts", "an encoder that loses counts at reversals", _lost_counts),
    UnknownClass("slipping_brake", "a joint that slips on under every high torque", _slipping_brake),
    UnknownClass("product_of_joints", "a joint off by the product of two angles", _product_of_joints),
    UnknownClass("warmed_by_work", "a drive that turns as it warms by its own travel", _warmed_by_work),
    UnknownClass("memory_of_loads", "a coupling that remembers the loads before", _memory_of_loads),
    UnknownClass("ageing_drive", "a drive that gets softer all day", _ageing_drive),
    UnknownClass("drag_chain", "friction that grows along the travel", _drag_chain, _SIDES),
    UnknownClass("gas_spring", "a balancer whose force goes with the warmth", _gas_spring),
    UnknownClass("far_coupling", "a joint dragged along by the one after it", _far_coupling),
)
