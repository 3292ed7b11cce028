"""Corrections of the joint frames of a URDF or MJCF file by what was identified of the arm."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.descriptions.reading.tree import transform
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError, shown

from .exported import identified_geometry, standing
from .file_frames import FileFrames
from .reading.tree import NO_STEP, onward

SAME = 1e-6
"""m or rad: by so much a joint of the file may stand elsewhere than the arm file's, whose numbers are rounded."""


@dataclass(frozen=True)
class Corrections:
    """How frames of a file move (4, 4).

    Attributes:
        joints: each joint's, in the axes of the frame that the joint before it moves.
        tool: the tip's, in the axes of the frame that the last joint moves.
        tip: where the tip stands in that frame, before it moves; m.
        links: where each of the arm's links stands in the frame that its joint moves, at coordinate 0.
    """

    joints: tuple[Array, ...]
    tool: Array
    tip: Array
    links: tuple[Array, ...]


def corrections(arm: Arm, there: FileFrames, file: Path) -> Corrections:
    """What the arm's `effects` say of its zeros, lengths and axes, for the frames of a file of that arm.

    Raises `InputError` where the file's joints stand elsewhere than the arm's do before what was found.
    """
    before, after = _frames_of(arm), _frames_of(identified_geometry(arm))
    to_arm = _base_of(arm, there, before, file)
    joints: list[Array] = []
    links: list[Array] = []
    for index, file_frame in enumerate(there.joints):
        joints.append(to_arm @ _correction(before, after, index) @ np.linalg.inv(to_arm))
        step = before.joints[0] if index == 0 else np.linalg.inv(before.joints[index - 1]) @ before.joints[index]
        to_arm = np.linalg.inv(file_frame.whole) @ to_arm @ step
        links.append(to_arm)
    tool = to_arm @ after.tool @ np.linalg.inv(before.tool) @ np.linalg.inv(to_arm)
    return Corrections(tuple(joints), tool, (to_arm @ before.tool)[:3, 3], tuple(links))


@dataclass(frozen=True)
class _Frames:
    """Frames (4, 4) at coordinate 0: each joint's in the base, and the step from the last to the tip."""

    joints: tuple[Array, ...]
    tool: Array


def _frames_of(arm: Arm) -> _Frames:
    """Where an arm's joints stand at coordinate 0 (their zeros in it), and its tip after the last."""
    here, frames = NO_STEP, []
    for joint, link in zip(arm.joints, arm.links, strict=True):
        here = onward(here, standing(joint))
        frames.append(transform(*here))
        x, y, z = (link.length * item for item in link.direction)
        here = onward(here, (link.end_rotation, (x, y, z)))
    tip = transform(*onward(here, ((NO_STEP[0]), arm.tool)))
    return _Frames(tuple(frames), np.linalg.inv(frames[-1]) @ tip)


def _correction(before: _Frames, after: _Frames, index: int) -> Array:
    """How a joint's frame moves against the one before it, in that one's axes."""
    first, second = (
        np.linalg.inv(item.joints[index - 1]) @ item.joints[index] if index else item.joints[0]
        for item in (before, after)
    )
    return second @ np.linalg.inv(first)


def _base_of(arm: Arm, there: FileFrames, before: _Frames, file: Path) -> Array:
    """The frame of the file in which the arm stands: that one in which all joints stand as in the arm file."""
    off = [_off(arm, there, before, base) for base in there.bases[::-1]]
    nearest_base = min(range(len(off)), key=lambda k: max(off[k]))
    if max(off[nearest_base]) <= SAME:
        return there.bases[::-1][nearest_base]
    joint = next(k for k, item in enumerate(off[nearest_base]) if item > SAME)
    text = f"{1e3 * off[nearest_base][joint]:.3g} mm (or mrad) from where the arm file has it"
    message = f"joint {shown(there.joints[joint].name)} stands {text}, before what was found; it is of another arm"
    raise InputError(file, "", message)


def _off(arm: Arm, there: FileFrames, before: _Frames, base: Array) -> list[float]:
    """How far each joint's axis lies from the arm's (m or rad)."""
    where, distances = np.eye(4), list[float]()
    for joint, file_frame, local in zip(arm.joints, there.joints, before.joints, strict=True):
        assert file_frame.axis is not None
        assert file_frame.point is not None
        where, here = where @ file_frame.whole, base @ local
        axis = here[:3, :3] @ np.array(joint.axis)
        aside = where[:3, :3] @ file_frame.point + where[:3, 3] - here[:3, 3]
        aside = aside - axis * (axis @ aside)
        turned = float(np.linalg.norm(where[:3, :3] @ file_frame.axis - axis))
        other = file_frame.slides == joint.revolute
        distances.append(math.inf if other else max(turned, 0.0 if file_frame.slides else float(np.linalg.norm(aside))))
    return distances


def alike(angles: Array, written: Array) -> Array:
    """Roll, pitch and yaw of the same turn, in the form nearest to those written."""
    roll, pitch, yaw = angles
    forms = [np.array([roll, pitch, yaw]), np.array([roll + math.pi, math.pi - pitch, yaw + math.pi])]
    forms = [form + 2.0 * math.pi * np.round((written - form) / (2.0 * math.pi)) for form in forms]
    return min(forms, key=lambda form: float(np.abs(form - written).sum()))
