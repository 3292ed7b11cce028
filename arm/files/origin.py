"""Fixed transforms of an arm file: where a joint stands on the link before it, and what nobody knows of that.

They may be written as Denavit-Hartenberg parameters, in both conventions. Standard (distal): each entry's d and a lead
from its joint on. Modified (proximal, Craig's): a and alpha lead to the joint from the one before, as makers of
seven-axis arms like to print them.
"""

from __future__ import annotations

import math
from dataclasses import replace
from types import MappingProxyType
from typing import Any, cast

from linkwright.core.arm.chain.chain import Arm, DhRow, FloatVector, Joint, Link, OriginPart
from linkwright.core.arm.chain.vectors import (
    IDENTITY,
    ZERO,
    Rotation,
    compose,
    from_roll_pitch_yaw,
    norm,
    snap,
    to_roll_pitch_yaw,
    unit,
)
from linkwright.core.units.quantities import format_quantity, kind_of, read_quantity
from linkwright.core.units.reading import Mapping

SHIFTS: tuple[OriginPart, ...] = ("x", "y", "z")
TURNS: tuple[OriginPart, ...] = ("roll", "pitch", "yaw")
_KEYS = MappingProxyType({"xyz": (SHIFTS, "length"), "rpy": (TURNS, "angle")})
FREE = "free"
UNKNOWN_ORIGIN = (
    "is free: nobody knows where that joint stands. Run `linkwright diagnose ARM RECORDING --out FOLDER` first and go "
    "on with the arm.yaml that it writes"
)
"""What whoever has to know an arm's transforms says of one that is free."""


def read_origin(mapping: Mapping) -> tuple[tuple[Rotation, FloatVector], tuple[OriginPart, ...]]:
    """The transform under `origin`, zero wherever it is free, and which of its numbers are.

    `origin: free` frees all six; `xyz: free` and `rpy: free` three; a component of a list may be free too."""
    if mapping.content.get("origin") == FREE:
        mapping.has("origin")
        return (IDENTITY, ZERO), (*SHIFTS, *TURNS)
    with mapping.mapping("origin").reading() as frame:
        (xyz, shifts), (rpy, turns) = (_part(frame, name, *_KEYS[name]) for name in _KEYS)
    return (from_roll_pitch_yaw(*rpy), xyz), (*shifts, *turns)


def _part(
    frame: Mapping, name: str, parts: tuple[OriginPart, ...], kind: str
) -> tuple[FloatVector, tuple[OriginPart, ...]]:
    if frame.content.get(name) == FREE:
        frame.has(name)
        return ZERO, parts
    if not frame.has(name):
        return ZERO, ()
    values = frame.items(name)
    if len(values) not in (2, 3):
        raise frame.error(name, f"needs two components (x, y) or three, not {len(values)}")
    path = frame.path_of(name)
    numbers = [
        0.0 if value == FREE else read_quantity(value, kind, file=frame.file, key=f"{path}[{number}]")
        for number, value in enumerate(values, start=1)
    ]
    free: list[OriginPart] = [part for part, value in zip(parts, values, strict=False) if value == FREE]
    return (numbers[0], numbers[1], numbers[2] if len(numbers) == 3 else 0.0), tuple(free)


def read_vector(mapping: Mapping, name: str, kind: str, default: FloatVector) -> FloatVector:
    """Two or three quantities (SI; the third is 0 where it is left out), or the default where there are none."""
    if not mapping.has(name):
        return default
    example = default if any(default) else (0.0, 0.0, read_quantity(kind_of(kind).example, kind, file="", key=name))
    written = ", ".join(format_quantity(value, kind, digits=4) for value in example)
    values = mapping.items(name, would_do=f"a list of x, y and z, e.g. [{written}]")
    if len(values) not in (2, 3):
        raise mapping.error(name, f"needs two components (x, y) or three, not {len(values)}")
    path = mapping.path_of(name)
    numbers = [
        read_quantity(value, kind, file=mapping.file, key=f"{path}[{number}]")
        for number, value in enumerate(values, start=1)
    ]
    return (numbers[0], numbers[1], numbers[2] if len(numbers) == 3 else 0.0)


def origin_to_value(joint: Joint) -> Any:
    """A joint's fixed transform as an arm file holds it."""
    free = joint.origin_free
    if len(free) == len(SHIFTS) + len(TURNS):
        return FREE
    rpy = to_roll_pitch_yaw(joint.origin_rotation)
    out: dict[str, Any] = {}
    for (name, (parts, kind)), values in zip(_KEYS.items(), (joint.origin_translation, rpy), strict=True):
        texts = [
            FREE if part in free else format_quantity(value, kind) for part, value in zip(parts, values, strict=True)
        ]
        out[name] = FREE if set(texts) == {FREE} else texts
    return out


def origin_given(joint: Joint) -> bool:
    """Whether a joint stands elsewhere than at the end of the link before, or nobody knows where."""
    return bool(joint.origin_free) or joint.origin_rotation != IDENTITY or any(joint.origin_translation)


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
