"""The poses that put the tip at a point, described."""

from __future__ import annotations

import math
from collections.abc import Sequence

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.worst.inverse import InversePose
from linkwright.json.inverse import at_limit

from .document import Description, Item, Paragraph, Value, table
from .figures_in_words import MINUS, coordinate, figure


def describe(arm: Arm, point: Sequence[float], poses: Sequence[InversePose]) -> Description:
    """Each pose by its coordinates, and what is odd about it."""
    place = ", ".join(figure(1e3 * value) for value in point)
    count = "1 pose" if len(poses) == 1 else f"{len(poses)} poses"
    family = "" if all(pose.isolated for pose in poses) else ", samples of a family"
    items: list[Item] = [_table(arm, poses)]
    if not all(pose.isolated or pose.singular for pose in poses):
        items.append(Paragraph("samples of a family: the joints can move on while the tip stays"))
    if arm.branches:
        items.append(Paragraph(f"the tip is {arm.tip}'s; the other arms' joints stand in mid-range"))
    headline = f"{count} at ({place}) mm, within the joint ranges"
    return Description(arm.name, headline, tuple(items), f"{count} at ({place}) mm{family}", f"{arm.name}: ")


def _table(arm: Arm, poses: Sequence[InversePose]) -> Item:
    headings = [
        f"joint {index + 1} ({coordinate(arm, index, low)} to {coordinate(arm, index, high)})"
        for index, (low, high) in enumerate(joint.range for joint in arm.joints)
    ]
    rows = [
        (
            *(Value(_coordinate(arm, index, value)) for index, value in enumerate(arm.whole_pose(pose.q))),
            ", ".join(
                [
                    *(["singular"] if pose.singular else []),
                    *(f"joint {k + 1} at its limit" for k in at_limit(arm, pose)),
                ]
            ),
        )
        for pose in poses
    ]
    return table((*headings, ""), rows)


def _coordinate(arm: Arm, index: int, value: float) -> str:
    """Fine enough that the tip comes within a hundredth of a millimetre of the point: 0.001 degrees, 0.001 mm."""
    shown = math.degrees(value) if arm.joints[index].revolute else 1e3 * value
    return f"{round(shown, 3) + 0.0:.3f}{'°' if arm.joints[index].revolute else ' mm'}".replace("-", MINUS)
