"""Denavit-Hartenberg parameters of an arm file's entries, in both conventions.

Standard (distal): each entry's d and a lead from its joint on. Modified (proximal, Craig's): a and alpha lead to the
joint from the one before, as makers of seven-axis arms like to print them.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import cast

from linkwright.core.arm.chain.chain import Arm, DhRow, FloatVector, Joint, Link
from linkwright.core.arm.chain.vectors import IDENTITY, ZERO, Rotation, compose, from_roll_pitch_yaw, norm, snap, unit
from linkwright.core.units.reading import Mapping


def read_dh(mapping: Mapping) -> DhRow:
    """The Denavit-Hartenberg parameters that a mapping holds."""
    with mapping.reading():
        convention = mapping.choice("convention", ("standard", "modified"), "standard")
        a, d = mapping.quantity("a", "length", 0.0), mapping.quantity("d", "length", 0.0)
        alpha, theta = mapping.quantity("alpha", "angle", 0.0), mapping.quantity("theta", "angle", 0.0)
    return DhRow(a, d, alpha, theta, convention == "modified")


def standard_dh(row: DhRow, joint: Joint) -> tuple[Joint, Link]:
    """Standard (distal) Denavit-Hartenberg parameters: Rz(theta + q) Tz(d) Tx(a) Rx(alpha)."""
    twist = from_roll_pitch_yaw(row.alpha, 0.0, 0.0)
    if joint.revolute:
        joint = replace(joint, axis=(0.0, 0.0, 1.0), zero=joint.zero + row.theta, dh=row)
    else:
        joint = replace(joint, axis=(0.0, 0.0, 1.0), origin_rotation=from_roll_pitch_yaw(0.0, 0.0, row.theta), dh=row)
    return joint, along((row.a, 0.0, row.d), Link(0.0, end_rotation=twist))


def is_modified(mapping: Mapping) -> bool:
    """Whether an entry's Denavit-Hartenberg parameters are the modified ones."""
    raw = mapping.content.get("dh")
    return isinstance(raw, dict) and cast(dict[str, object], raw).get("convention") == "modified"


def modified_dh(row: DhRow, joint: Joint) -> tuple[tuple[Rotation, FloatVector], Joint]:
    """Modified (proximal) parameters, Rx(alpha) Tx(a) Rz(theta + q) Tz(d) with a and alpha of the link before: where
    the joint stands (J. J. Craig, Introduction to Robotics, ch. 3). As d lies along the joint's axis, it can go
    before the turn."""
    twist = from_roll_pitch_yaw(row.alpha, 0.0, 0.0)
    up: FloatVector = (twist[0][2], twist[1][2], twist[2][2])
    joint = replace(joint, axis=(0.0, 0.0, 1.0), dh=row)
    if joint.revolute:
        joint = replace(joint, zero=joint.zero + row.theta)
    else:
        twist = compose(twist, from_roll_pitch_yaw(0.0, 0.0, row.theta))
    return (twist, (row.a + row.d * up[0], row.d * up[1], row.d * up[2])), joint


def of_the_other_convention(arm: Arm) -> Arm | None:
    """The geometry of an arm whose rows are meant in the other convention than its file says; None where it is not all
    given by rows of one."""
    rows = [joint.dh for joint in arm.joints if joint.dh is not None]
    if len(rows) < arm.size or len({row.modified for row in rows}) > 1:
        return None
    joints, links = list[Joint](), list[Link]()
    for joint, row in zip(arm.joints, rows, strict=True):
        zero = joint.zero - row.theta if joint.revolute else joint.zero
        joint = replace(joint, zero=zero, origin_rotation=IDENTITY, origin_translation=ZERO)
        if row.modified:
            joint, link = standard_dh(row, joint)
        else:
            (turn, shift), joint = modified_dh(row, joint)
            joint, link = replace(joint, origin_rotation=turn, origin_translation=shift), Link(0.0)
        joints.append(joint)
        links.append(link)
    return replace(arm, joints=tuple(joints), links=tuple(links))


def key_of_offset(arm: Arm, index: int, axis: str) -> tuple[str, float] | None:
    """The key of an arm file's row that says how far link `index` (from 0) reaches along an axis (x, y, z) of its
    frame, and what the number there grows by for a unit of that; None where no one number of a row says it."""
    row = arm.joints[index].dh
    if row is not None and not row.modified:
        return {"x": (f"chain[{index + 1}].dh.a", 1.0), "z": (f"chain[{index + 1}].dh.d", 1.0)}.get(axis)
    row = arm.joints[index + 1].dh if index + 1 < arm.size else None
    if row is None or not row.modified:
        return None
    up = {"y": -math.sin(row.alpha), "z": math.cos(row.alpha)}
    keys = {name: (f"chain[{index + 2}].dh.d", snap(share)) for name, share in up.items() if abs(snap(share)) == 1.0}
    return {"x": (f"chain[{index + 2}].dh.a", 1.0), **keys}.get(axis)


def along(vector: FloatVector, link: Link) -> Link:
    """The link along a vector (m) in its frame."""
    length = norm(vector)
    return replace(link, length=length, direction=unit(vector) if length > 0.0 else (1.0, 0.0, 0.0))
