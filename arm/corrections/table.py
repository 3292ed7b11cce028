"""Identified parameters of an arm as a table of numbers (CSV), for controllers fed by hand or by a script."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterator

from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.arm.chain.vectors import Rotation, to_roll_pitch_yaw
from linkwright.core.arm.descriptions.exported import GEOMETRY, effects_beside, identified_geometry
from linkwright.core.arm.descriptions.formats import Exported
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.units.quantities import kind_of

from .readings import READINGS, readings

NAME = "csv"
COLUMNS = ("place", "name", "figure", "unit", "before", "after")
_Row = tuple[str, str, str, str, float, float]


def tabulated(arm: Arm) -> Exported:
    """Where joints stand on the link before and how links lead on, before and after what was found (angles of URDF's
    kind); of each joint `zero` and `scale` make its coordinate of what is read of it: `zero + (1 + scale) * reading`.
    Parameters of other effects are in SI."""
    rows = [*_frames(arm), *_readings(arm), *_others(arm)]
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows((*row[:4], f"{row[4]:.12g}", f"{row[5]:.12g}") for row in rows)
    changed = [
        f"{row[1] or row[0]}: {row[2]} {row[4]:.6g}{f' {row[3]}' if row[3] else ''} is now {row[5]:.6g}"
        for row in rows
        if row[4] != row[5]
    ]
    nothing = ("nothing: the arm file's effects say nothing",)
    lost = effects_beside(arm, tuple(EFFECTS))
    return Exported(arm, NAME, stream.getvalue(), tuple(changed) or nothing, tuple(lost), ())


def _frames(arm: Arm) -> Iterator[_Row]:
    geometry = identified_geometry(arm)
    for number, (before, after) in enumerate(zip(arm.joints, geometry.joints, strict=True), start=1):
        place = f"joint {number}"
        for (figure, unit, old), (_, _, new) in zip(_of_joint(before), _of_joint(after), strict=True):
            yield place, before.name, figure, unit, old, new
    for number, (before, after) in enumerate(zip(arm.links, geometry.links, strict=True), start=1):
        for (figure, unit, old), (_, _, new) in zip(_of_link(before), _of_link(after), strict=True):
            yield f"link {number}", before.name, figure, unit, old, new
    for axis, value in zip("xyz", arm.tool, strict=True):
        yield "tool", "", axis, "mm", 1e3 * value, 1e3 * value


def _of_joint(joint: Joint) -> Iterator[tuple[str, str, float]]:
    """Its frame on the link before, and its axis in that frame."""
    for axis, value in zip("xyz", joint.origin_translation, strict=True):
        yield axis, "mm", 1e3 * value
    yield from _turn(joint.origin_rotation)
    for axis, value in zip("xyz", joint.axis, strict=True):
        yield f"axis {axis}", "", value


def _of_link(link: Link) -> Iterator[tuple[str, str, float]]:
    """Its length along its direction in the joint's frame, and how its end is turned."""
    yield "length", "mm", 1e3 * link.length
    for axis, value in zip("xyz", link.direction, strict=True):
        yield f"direction {axis}", "", value
    yield from _turn(link.end_rotation)


def _turn(rotation: Rotation) -> Iterator[tuple[str, str, float]]:
    for name, angle in zip(("roll", "pitch", "yaw"), to_roll_pitch_yaw(rotation), strict=True):
        yield name, "deg", math.degrees(angle)


def _readings(arm: Arm) -> Iterator[_Row]:
    for number, (joint, read) in enumerate(zip(arm.joints, readings(arm), strict=True), start=1):
        unit, factor = ("deg", math.degrees(1.0)) if joint.revolute else ("mm", 1e3)
        place = f"joint {number}"
        yield place, joint.name, "zero", unit, factor * joint.zero, factor * (joint.zero + read.offset)
        yield place, joint.name, "scale", "", 0.0, read.scale


def _others(arm: Arm) -> Iterator[_Row]:
    """Parameters of the other effects, in SI."""
    for entry in arm.effects:
        if entry.effect in (*GEOMETRY, *READINGS):
            continue
        kinds = {item.name: item for item in EFFECTS[entry.effect].parameters}
        for parameter, value in entry.parameters.items():
            for number in entry.at or (0,):
                place = f"{EFFECTS[entry.effect].place} {number}" if number else EFFECTS[entry.effect].place
                yield place, "", f"{entry.effect}.{parameter}", kind_of(kinds[parameter].kind).si, 0.0, value
