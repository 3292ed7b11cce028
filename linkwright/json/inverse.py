"""The poses that reach a point as a plain mapping for JSON, in degrees and mm."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.worst.inverse import InversePose
from linkwright.version import program_version

from .design import coordinates
from .fields import fields, in_mm

_AT_LIMIT = 1e-6
"""A coordinate this near to an end of its range (rad, m) stands at it."""


def at_limit(arm: Arm, pose: InversePose) -> list[int]:
    """The joints (from 0) on the way to the tip that stand at an end of their range, of those that cannot turn all the
    way round."""
    return [
        index
        for index, (joint, value) in enumerate(zip(arm.joints, pose.q, strict=True))
        if index in arm.to_tip
        and not (joint.revolute and joint.range[1] - joint.range[0] >= math.tau - 1e-9)
        and min(abs(value - end) for end in joint.range) <= _AT_LIMIT
    ]


def inverse_json(arm: Arm, point: Sequence[float], found: Sequence[InversePose]) -> dict[str, Any]:
    """What `inverse --json` writes."""
    return {
        "made_by": f"linkwright inverse {program_version()}",
        "arm": arm.name,
        **({"tip": arm.tip} if arm.branches else {}),
        "point_mm": in_mm(point),
        "poses": [
            {
                **coordinates(arm, pose.q),
                **fields(pose, "residual_mm", "isolated", "singular"),
                "joints_at_limit": [index + 1 for index in at_limit(arm, pose)],
            }
            for pose in found
        ],
    }
