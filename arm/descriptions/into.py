"""Identified parameters written into the user's URDF or MJCF: a few numbers, and not a byte beside them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects.elastic.joint_compliance import (
    JOINT_COMPLIANCE,
    drive_compliance,
    drive_retardation,
)
from linkwright.core.units.files import read_bytes
from linkwright.core.units.quantities import InputError, shown
from linkwright.core.units.reading import nearest

from .editing.editor import CHANGED, Editor
from .editing.in_motion import write_joints, write_weights
from .exported import GEOMETRY, effects_beside
from .file_frames import FileFrames, mjcf_frames, urdf_frames
from .formats import Exported
from .identified_frames import SAME, Corrections, corrections
from .imported import import_robot
from .in_motion import Format, effects_in_motion
from .reading.elements import Element, elements_in


def into_file(arm: Arm, path: Path | str) -> Exported:
    """A URDF or MJCF file with what `effects` of an arm say of zeros, lengths and axes, friction and weights (of an
    MJCF's joints rotors and springs, of its position servos their stiffness too), byte for byte as it was otherwise.

    Joints are those that the arm file names; without names, those on the only way of a URDF. Raises `InputError` where
    they are not in the file, or stand elsewhere than the arm file's own (before what was found).
    """
    file = Path(path)
    content = read_bytes(file)
    top = elements_in(content, file)
    try:
        content.decode("utf-8")
    except UnicodeDecodeError:
        raise InputError(file, "", "is written in another encoding; save it as UTF-8") from None
    forms: Mapping[str, Format] = {"robot": "urdf", "mujoco": "mjcf"}
    form = forms.get(top.tag)
    if form is None:
        message = f"starts with <{top.tag}>; what was found goes into URDF (<robot>) and MJCF (<mujoco>)"
        raise InputError(file, "", message)
    if arm.branches:
        raise InputError("", "branches", "end in several tips; export the arm file of each by itself")
    names = _names(arm, top, form)
    there = urdf_frames(file, names) if form == "urdf" else mjcf_frames(top, names)
    if [joint.name for joint in there.joints] != list(names):
        raise InputError(file, "", f"has these joints in another order, or not on one way: {', '.join(names)}")
    moves = corrections(arm, there, file)
    editor = Editor(content, form)
    for file_frame, correction in zip(there.joints, moves.joints, strict=True):
        editor.move(file_frame, correction)
    lost = list(_tip(there, moves, editor))
    write_joints(arm, [_joint(top, name) for name in names], top, editor)
    lost += write_weights(arm, there.joints, moves.links, top, editor)
    held = (*GEOMETRY, *effects_in_motion(form), *([JOINT_COMPLIANCE.id] if form == "mjcf" else []))
    lost += effects_beside(arm, held)
    if form == "mjcf":
        lost += _servos(arm, names, top, editor)
    carried = tuple(editor.carried) or (
        "nothing: the arm file's effects name no zero, length or axis, friction or weight",
    )
    return Exported(arm, form, editor.text(), carried, tuple(dict.fromkeys(lost)), ())


def _names(arm: Arm, top: Element, form: str) -> tuple[str, ...]:
    there = [item.attributes.get("name", "") for item in _all(top, "joint")]
    named = [joint.name for joint in arm.joints]
    if not any(named) and form == "urdf":
        names = import_robot(top.file).joint_names
        if len(names) == arm.size:
            return names
        message = f"has {len(names)} joints that move, the arm {arm.size}; name its joints (joint: name)"
        raise InputError(top.file, "", message)
    for index, name in enumerate(named):
        if name not in there:
            message = f"{shown(name)} is no joint of {top.file}{nearest(name, there)}" if name else "is missing"
            raise InputError("", f"{arm.entry(index)}.joint.name", f"{message}; write what the file calls it")
    return tuple(named)


def _joint(top: Element, name: str) -> Element:
    return next(item for item in _all(top, "joint") if item.attributes.get("name") == name)


def _all(element: Element, tag: str) -> list[Element]:
    children = [child for child in element.children if child.tag == tag]
    return children + [item for child in element.children for item in _all(child, tag)]


def _tip(there: FileFrames, moves: Corrections, editor: Editor) -> tuple[str, ...]:
    """Move the frame at the arm's tip, where the last link's length or the tool changed; what could not be is
    reported."""
    if np.abs(moves.tool - np.eye(4)).max() <= CHANGED:
        return ()
    for tip in there.tips:
        if np.linalg.norm(tip.whole[:3, 3] - moves.tip) <= SAME:
            editor.move(tip, moves.tool)
            return ()
    return ("where the tip stands on the last link: no frame that is fixed there stands at the arm's tip",)


def _servos(arm: Arm, names: Sequence[str], top: Element, editor: Editor) -> tuple[str, ...]:
    """Write the stiffness of drives whose compliance was found into position servos; what has none is reported."""
    lost: list[str] = []
    positions = {item.attributes.get("joint", ""): item for item in _all(top, "position")}
    for index, name in enumerate(names):
        elastic = any(e.effect == JOINT_COMPLIANCE.id and index + 1 in (e.at or (index + 1,)) for e in arm.effects)
        if elastic and name in positions:
            editor.number(name, positions[name], "kp", 1.0 / drive_compliance(arm, index))
            if (late := drive_retardation(arm, index)) is not None:
                editor.number(name, positions[name], "kv", late / drive_compliance(arm, index))
        elif elastic:
            lost.append(f"stiffness of the drive of joint {index + 1}: {name} has no position servo")
    return tuple(lost)
