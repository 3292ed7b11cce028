"""An error budget as a plain mapping for JSON."""

from __future__ import annotations

import math
from typing import Any

from linkwright.core.optimize.budget.result import Budget, Gain
from linkwright.version import program_version

from .fields import fields, in_mm


def budget_json(found: Budget) -> dict[str, Any]:
    """What `budget --json` writes: mm, degrees (mm for slides) and EUR."""
    at = zip(found.arm.joints, found.pose, strict=True)
    sheet, tip = found.sheet, found.load_cases[found.load_case - 1].tip or found.arm.tip
    return {
        "made_by": f"linkwright budget {program_version()}",
        "arm": found.arm.name,
        "share": sheet.share,
        **fields(found, "worst_mm", "worst_upper_mm", "median_mm", "average_mm", "nominal_mm"),
        "worst_pose": {
            "q": [math.degrees(value) if joint.revolute else 1e3 * value for joint, value in at],
            "load_case": found.load_case,
            **({"tip": tip} if tip else {}),
            "error_mm": in_mm(found.at_worst),
        },
        "causes": [{"cause": each.name, **fields(each, "at_worst_mm", "average_mm", "share")} for each in found.causes],
        "twice_as_good": [_gain(each) for each in found.halved],
        "better": [_gain(each) for each in found.options],
        "play": found.arm.play,
        "poses": found.poses,
        "draws": sheet.draws,
        "seed": sheet.seed,
        "links_of_unknown_growth": [k + 1 for k in found.unwarmed],
        "samples_mm": in_mm(found.samples),
    }


def _gain(gain: Gain) -> dict[str, Any]:
    own = {"part": gain.name, "worst_less_mm": in_mm(gain.worst), "average_less_mm": in_mm(gain.average)}
    if gain.owner is None:
        own |= {"price_EUR": gain.price, "mm_per_EUR": in_mm(gain.per_euro)}
    return own
