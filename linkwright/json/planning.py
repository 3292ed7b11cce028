"""A plan as a plain mapping for JSON."""

from __future__ import annotations

import math
from typing import Any

from linkwright.core.diagnose.plan.planned import Planned
from linkwright.core.diagnose.plan.promise import Rival, Shown
from linkwright.core.diagnose.plan.torques import TorqueTold
from linkwright.version import program_version

from .diagnosis import in_unit, joint_coordinates, unit_of
from .fields import fields, in_mm


def plan_json(found: Planned) -> dict[str, Any]:
    """What `plan --json` writes: degrees (mm for slides), kg, and each parameter in its own unit."""
    asked, visits = found.asked, found.visits
    return {
        "made_by": f"linkwright plan {program_version()}",
        "arm": found.arm.name,
        **({"tip": found.arm.tip} if found.arm.branches else {}),
        "readings": found.recording.size,
        **fields(asked, "poses", "repeats", "instrument", "frame", "tool", "seed"),
        **_scatter(found),
        "sees": list(found.axes),
        "payloads_kg": list(asked.payloads),
        "after": None if found.after is None else found.after.file,
        "torque_noise": list(asked.torque_noise),
        "torques": [_torque(found, each) for each in found.promise.torques],
        "shown": [_shown(found, each) for each in found.promise.shown],
        "unseen": [{"effect": effect, "at": list(at)} for effect, at in found.promise.unseen],
        "pairs": found.promise.pairs,
        "pairs_told": found.promise.told,
        "pairs_random": found.told_at_random[1],
        "pairs_told_random": found.told_at_random[0],
        "random_plans": len(found.random),
        "interrupted": found.interrupted,
        "touches": [
            {
                "label": each.label,
                "at_mm": in_mm(each.at),
                "normal": None if each.normal is None else list(each.normal),
                **({} if each.way is None else {"way": list(each.way)}),
            }
            for each in found.touched
        ],
        "returns": list(found.returns),
        "correlation_with_time": found.with_time,
        "tried": found.tried,
        "visits": [
            {
                "q": joint_coordinates(found.arm, visits.q[row].tolist()),
                "dir": [] if visits.sides is None else [int(side) for side in visits.sides[row]],
                "payload_kg": None if visits.payload_mass is None else float(visits.payload_mass[row]),
                **({} if visits.touches is None else {"touches": visits.instrument.labels[int(visits.touches[row])]}),
                **({} if visits.bar_at is None else {"bar_mm": 1e3 * float(visits.bar_at[row])}),
            }
            for row in range(visits.size)
        ],
    }


def _scatter(found: Planned) -> dict[str, Any]:
    """What is read scatters by: a length, of a level an angle, of a camera both."""
    asked = found.asked
    if asked.instrument == "tilt":
        return {"sigma_deg": math.degrees(asked.sigma)}
    if asked.instrument != "camera":
        return fields(asked, "sigma_mm")
    deep, turns = asked.camera_noise
    return {**fields(asked, "sigma_mm"), "sigma_depth_mm": 1e3 * deep, "sigma_angle_deg": math.degrees(turns)}


def _torque(found: Planned, each: TorqueTold) -> dict[str, Any]:
    """What a drive's torque will tell, half the width of 95 % intervals: shares of the weights, N*m (of slides N)."""
    names = ("links", "payload", "friction")
    own = {f"{name}_within": _within(getattr(each, name)) for name in names}
    random = {f"{name}_within_random": _within(found.torques_at_random(each.joint, name)) for name in names}
    return {**fields(each, "joint", "together"), **own, **random}


def _within(error: float | None) -> float | None:
    return None if error is None or not math.isfinite(error) else 1.96 * error


def _shown(found: Planned, each: Shown) -> dict[str, Any]:
    return {
        **fields(each, "effect", "at", "parameter", "rms_mm"),
        "unit": unit_of(each.kind),
        "usual": _size(each.usual, each),
        "smallest": _size(each.smallest, each),
        "random": _size(found.at_random(each), each),
        "told_from": _size(each.told, each),
        "others": each.others,
        "not_told": [_rival(rival, each) for rival in each.not_told],
    }


def _rival(rival: Rival, of: Shown) -> dict[str, Any]:
    return {**fields(rival, "effect", "at", "likeness"), "told_from": _size(rival.told, of)}


def _size(value: float, each: Shown) -> float | None:
    return in_unit(value, each.kind) if math.isfinite(value) else None
