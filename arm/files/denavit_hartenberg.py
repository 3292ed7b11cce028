"""Denavit-Hartenberg parameters of an arm file's entries, in both conventions.

Standard (distal): each entry's d and a lead from its joint on. Modified (proximal, Craig's): a and alpha lead to the
joint from the one before, as makers of seven-axis arms like to print them.
"""

from __future__ import annotations

from dataclasses import replace
from typing import cast

from linkwright.core.arm.chain.chain import FloatVector, Joint, Link
from linkwright.core.arm.chain.vectors import Rotation, compose, from_roll_pitch_yaw, norm, unit
from linkwright.core.units.reading import Mapping


def standard_dh(mapping: Mapping, joint: Joint) -> tuple[Joint, Link]:
    """Standard (distal) Denavit-Hartenberg parameters: Rz(theta + q) Tz(d) Tx(a) Rx(alpha)."""
    a, d, alpha, theta = _dh_numbers(mapping)
    twist = from_roll_pitch_yaw(alpha, 0.0, 0.0)
    if joint.revolute:
        joint = replace(joint, axis=(0.0, 0.0, 1.0), zero=joint.zero + theta)
    else:
        joint = replace(joint, axis=(0.0, 0.0, 1.0), origin_rotation=from_roll_pitch_yaw(0.0, 0.0, theta))
    return joint, along((a, 0.0, d), Link(0.0, end_rotation=twist))


def is_modified(mapping: Mapping) -> bool:
    """Whether an entry's Denavit-Hartenberg parameters are the modified ones."""
    raw = mapping.content.get("dh")
    return isinstance(raw, dict) and cast(dict[str, object], raw).get("convention") == "modified"


def _dh_numbers(mapping: Mapping) -> tuple[float, float, float, float]:
    with mapping.reading():
        mapping.choice("convention", ("standard", "modified"), "standard")
        a, d = mapping.quantity("a", "length", 0.0), mapping.quantity("d", "length", 0.0)
        alpha, theta = mapping.quantity("alpha", "angle", 0.0), mapping.quantity("theta", "angle", 0.0)
    return a, d, alpha, theta


def modified_dh(mapping: Mapping, joint: Joint) -> tuple[tuple[Rotation, FloatVector], Joint]:
    """Modified (proximal) parameters, Rx(alpha) Tx(a) Rz(theta + q) Tz(d) with a and alpha of the link before: where
    the joint stands (J. J. Craig, Introduction to Robotics, ch. 3). As d lies along the joint's own axis, it can go
    before the turn."""
    a, d, alpha, theta = _dh_numbers(mapping)
    twist = from_roll_pitch_yaw(alpha, 0.0, 0.0)
    up: FloatVector = (twist[0][2], twist[1][2], twist[2][2])
    joint = replace(joint, axis=(0.0, 0.0, 1.0))
    if joint.revolute:
        joint = replace(joint, zero=joint.zero + theta)
    else:
        twist = compose(twist, from_roll_pitch_yaw(0.0, 0.0, theta))
    return (twist, (a + d * up[0], d * up[1], d * up[2])), joint


def along(vector: FloatVector, link: Link) -> Link:
    """The link along a vector (m) in its frame."""
    length = norm(vector)
    return replace(link, length=length, direction=unit(vector) if length > 0.0 else (1.0, 0.0, 0.0))
