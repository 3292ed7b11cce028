"""Identified geometry in the calibration file that ROS's driver extracts from a robot of Universal Robots.

Such a file (`my_robot_calibration.yaml`, `config/*/default_kinematics.yaml` of ur_description) has under `kinematics`
where each of six joints stands on the link before, in the words of a URDF's origin, each turning about its z; its
`hash` says of which robot it is, and stays.

Source: UniversalRobots/Universal_Robots_ROS2_Driver, ur_calibration/src/calibration.cpp;
Universal_Robots_ROS2_Description, urdf/ur_macro.xacro.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import yaml
from scipy.spatial.transform import Rotation as Turn

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.descriptions.editing.editor import CHANGED
from linkwright.core.arm.descriptions.exported import GEOMETRY, effects_beside
from linkwright.core.arm.descriptions.file_frames import FileFrame, FileFrames, transform
from linkwright.core.arm.descriptions.formats import Exported
from linkwright.core.arm.descriptions.identified_frames import alike, corrections
from linkwright.core.arm.descriptions.reading.elements import Element
from linkwright.core.sections.numeric import Array
from linkwright.core.units.files import read_bytes
from linkwright.core.units.quantities import InputError, shown

NAME = "ur-calibration"
_PARTS = ("shoulder", "upper_arm", "forearm", "wrist_1", "wrist_2", "wrist_3")
_SHIFT, _TURN = ("x", "y", "z"), ("roll", "pitch", "yaw")


@dataclass(frozen=True)
class _Number:
    """A number of the file, and where it stands in its text."""

    value: float
    start: int
    end: int


def is_kinematics(path: Path | str) -> bool:
    """Whether a file is named as such a calibration is."""
    return Path(path).suffix.lower() in (".yaml", ".yml")


def into_kinematics(arm: Arm, path: Path | str) -> Exported:
    """The calibration of a robot with what `effects` of an arm say of zeros, lengths and axes, character for character
    as it was otherwise. The arm is that robot's by the file, from `base_link` or from `base`.

    Raises `InputError` where it is of another arm, or no calibration.
    """
    file = Path(path)
    try:
        text = read_bytes(file).decode("utf-8")
    except UnicodeDecodeError:
        raise InputError(file, "", "is written in another encoding; save it as UTF-8") from None
    numbers = _numbers(text, file)
    if arm.size != len(_PARTS) or arm.branches:
        raise InputError(file, "", f"is of a robot of six joints; the arm has {arm.size}")
    there = FileFrames(tuple(_frame(part, numbers[part], file) for part in _PARTS), (_turned_base(), np.eye(4)), ())
    moves = corrections(arm, there, file)
    edits: list[tuple[_Number, str]] = []
    carried: list[str] = []
    for frame, correction in zip(there.joints, moves.joints, strict=True):
        local, written = correction @ frame.local, numbers[frame.name]
        angles = Turn.from_matrix(local[:3, :3]).as_euler("xyz")
        angles = alike(angles, np.array([written[key].value for key in _TURN]))
        for key, value in zip((*_SHIFT, *_TURN), (*local[:3, 3], *angles), strict=True):
            if abs(value - written[key].value) > CHANGED:
                edits.append((written[key], f"{value:.12g}"))
                carried.append(f"{frame.name}.{key} {text[written[key].start : written[key].end]} is now {value:.12g}")
    lost = effects_beside(arm, GEOMETRY)
    if np.abs(moves.tool - np.eye(4)).max() > CHANGED:
        lost.append("where the tip stands on the last link: the file ends at wrist_3")
    for number, made in sorted(edits, key=lambda edit: -edit[0].start):
        text = text[: number.start] + made + text[number.end :]
    nothing = ("nothing: the arm file's effects name no zero, length or axis",)
    return Exported(arm, NAME, text, tuple(carried) or nothing, tuple(lost), ())


def _turned_base() -> Array:
    """`base_link`, which stands half a turn about z from the frame in which the file begins."""
    return transform(Turn.from_euler("z", math.pi).as_matrix(), (0.0, 0.0, 0.0))


def _frame(part: str, numbers: Mapping[str, _Number], file: Path) -> FileFrame:
    """Where a joint stands on the link before, by the file."""
    shift, turn = ([numbers[key].value for key in keys] for keys in (_SHIFT, _TURN))
    local = transform(Turn.from_euler("xyz", turn).as_matrix(), shift)
    element = Element(part, {key: f"{number.value!r}" for key, number in numbers.items()}, 0, file)
    return FileFrame(part, element, np.eye(4), local, np.eye(4), False, np.array([0.0, 0.0, 1.0]), np.zeros(3))


def _numbers(text: str, file: Path) -> dict[str, dict[str, _Number]]:
    """The numbers of each joint by their key. Raises `InputError`."""
    try:
        top = yaml.compose(text, Loader=yaml.SafeLoader)
    except yaml.YAMLError as error:
        raise InputError(file, "", f"is no YAML: {error}") from None
    kinematics = _mapping(top).get("kinematics")
    numbers: dict[str, dict[str, _Number]] = {}
    for part in _PARTS:
        values = _mapping(_mapping(kinematics).get(part))
        numbers[part] = {}
        for key in (*_SHIFT, *_TURN):
            node = values.get(key)
            if not isinstance(node, yaml.ScalarNode):
                message = (
                    "is missing; a UR calibration has x, y, z, roll, pitch and yaw of six joints under `kinematics`"
                )
                raise InputError(file, f"kinematics.{part}.{key}", message)
            numbers[part][key] = _Number(
                _number(node, file, f"kinematics.{part}.{key}"), node.start_mark.index, node.end_mark.index
            )
    return numbers


def _mapping(node: Any) -> MappingProxyType[str, Any]:
    """A node's values by key; none of what is no mapping."""
    if not isinstance(node, yaml.MappingNode):
        return MappingProxyType({})
    return MappingProxyType({str(key.value): value for key, value in node.value})


def _number(node: yaml.ScalarNode, file: Path, key: str) -> float:
    try:
        value = float(node.value)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(file, key, f"needs a number, not {shown(node.value)}")
    return value
