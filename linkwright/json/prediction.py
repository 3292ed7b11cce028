"""What an arm is worth on a recording as a plain mapping for JSON, in mm."""

from __future__ import annotations

import math
from pathlib import PurePath
from typing import Any

from linkwright.core.diagnose.predict import Leaving, Prediction
from linkwright.version import program_version

from .fields import fields


def prediction_json(found: Prediction) -> dict[str, Any]:
    """What `predict --json` writes."""
    recording = found.recording
    return {
        "made_by": f"linkwright predict {program_version()}",
        "arm": found.arm.name,
        "recording": PurePath(recording.file).name,
        "rows": recording.size,
        **fields(found, "rms_mm", "mean_mm", "max_mm=largest", "nominal_rms_mm", "outside"),
        **fields(recording, "frame", "tool"),
        "outside_by_joint": [
            {
                **fields(each, "joint", "rows", "learned"),
                "span_deg" if found.arm.joints[each.joint - 1].revolute else "span_mm": _span(found, each),
            }
            for each in found.left
        ],
    }


def _span(found: Prediction, each: Leaving) -> list[float]:
    revolute = found.arm.joints[each.joint - 1].revolute
    return [math.degrees(end) if revolute else 1e3 * end for end in each.span]
