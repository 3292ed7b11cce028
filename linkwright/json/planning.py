"""A plan as a plain mapping for JSON."""

from __future__ import annotations

import math
from typing import Any

from diagnose.plan.planned import Planned
from diagnose.plan.promise import Rival, Shown
from linkwright.version import program_version

from .diagnosis import in_unit, joint_coordinates, unit_of
from .fields import fields


def plan_json(found: Planned) -> dict[str, Any]:
    """What `plan --json` writes: degrees (mm for slides), kg, and each parameter in its own unit."""
    asked, visits = found.asked, found.visits
    return {
        "made_by": f"linkwright plan {program_version()}",
        "arm": found.arm.name,
        **({"tip": found.arm.tip} if found.arm.branches else {}),
        "readings": found.recording.size,
        **fields(asked, "poses", "repeats", "instrument", "sigma_mm", "frame", "tool", "seed"),
        "sees": list(found.axes),
        "payloads_kg": list(asked.payloads),
        "after": None if found.after is None else found.after.file,
        "shown": [_shown(found, each) for each in found.promise.shown],
        "unseen": [{"effect": effect, "at": list(at)} for effect, at in found.promise.unseen],
        "pairs": found.promise.pairs,
        "pairs_told": found.promise.told,
        "pairs_random": found.told_at_random[1],
        "pairs_told_random": found.told_at_random[0],
        "random_plans": len(found.random),
        "interrupted": found.interrupted,
        "returns": list(found.returns),
        "correlation_with_time": found.with_time,
        "tried": found.tried,
        "visits": [
            {
                "q": joint_coordinates(found.arm, visits.q[row].tolist()),
                "dir": [] if visits.sides is None else [int(side) for side in visits.sides[row]],
                "payload_kg": None if visits.payload_mass is None else float(visits.payload_mass[row]),
            }
            for row in range(visits.size)
        ],
    }


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
