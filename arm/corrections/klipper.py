"""Identified geometry of a Cartesian machine for Klipper: skew, and factors of its steppers' `rotation_distance`.

Klipper takes a machine for one whose tip stands at `(x + xy*y + xz*z, y + yz*z, z)` when its axes stand at x, y and z
(Klipper3d/klipper, klippy/extras/skew_correction.py). With the columns of M the directions in which the tip goes with
each reading, M = Q R by Gram and Schmidt: the diagonal of R is by how much farther each axis goes than its stepper's
`rotation_distance` says, the rest of R is the skew, and Q how the whole machine stands turned.
"""

from __future__ import annotations

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.arm.descriptions.exported import GEOMETRY, effects_beside, identified_geometry
from linkwright.core.arm.descriptions.formats import Exported
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError

from .readings import READINGS, readings

NAME = "klipper"
_AXES = "xyz"
_ALONG = 0.99
"""The cosine to its axis from which on a slide is one along x, y or z."""
_NOTHING = 1e-12


def skewed(arm: Arm) -> Exported:
    """Settings of a `printer.cfg` for an arm of three slides along x, y and z, in any order and sense.

    Raises `InputError` for another arm.
    """
    slides = _slides(arm)
    geometry, read = identified_geometry(arm), readings(arm)
    directions = _directions(geometry)
    scales = np.array([1.0 + item.scale for item in read])
    signs = np.array([sign for _, sign in slides])
    order = [index for index, _ in slides]
    turned, upper = np.linalg.qr((directions * scales)[:, order] * signs)
    turned, upper = turned * np.sign(np.diag(upper)), upper * np.sign(np.diag(upper))[:, None]
    farther = np.diag(upper)
    factors = {
        "xy_skew": upper[0, 1] / farther[1],
        "xz_skew": upper[0, 2] / farther[2],
        "yz_skew": upper[1, 2] / farther[2],
    }
    text = ["[skew_correction]", "", "[skew_correction linkwright]"]
    text += [f"{name}: {_number(value)}" for name, value in factors.items()]
    text += ["", "# Load it after homing: SKEW_PROFILE LOAD=linkwright"]
    carried = [f"{name} {_number(value)}" for name, value in factors.items() if abs(value) > _NOTHING]
    for axis, (index, sign), ratio in zip(_AXES, slides, farther, strict=True):
        shift = 1e3 * sign * read[index].offset * ratio / scales[index]
        if abs(ratio - 1.0) <= _NOTHING and abs(shift) <= _NOTHING:
            continue
        times = f"times {ratio:.12g}"
        said = f"stepper_{axis}: rotation_distance {times}, position_endstop {times} plus {_number(shift)} mm"
        carried.append(said)
        text.append(f"# [{said.replace(':', ']', 1)}")
    lost = effects_beside(arm, (*GEOMETRY, *READINGS))
    if (angle := _angle(turned)) > 1e-9:
        lost.append(f"that the whole machine stands turned, by {1e3 * angle:.4g} mrad")
    nothing = ("nothing: the arm file's effects name no zero, scale or axis",)
    return Exported(arm, NAME, "\n".join(text) + "\n", tuple(carried) or nothing, tuple(lost), ())


def _slides(arm: Arm) -> list[tuple[int, float]]:
    """Which joint slides along x, y and z, from 0, and in which sense."""
    message = "has settings for three slides along x, y and z, which this arm does not have"
    if arm.size != len(_AXES) or any(joint.revolute or joint.follows for joint in arm.joints) or arm.branches:
        raise InputError("", "to", f"klipper {message}")
    directions = _directions(arm)
    slides: list[tuple[int, float]] = []
    for row in directions:
        index = int(np.argmax(abs(row)))
        if abs(row[index]) < _ALONG:
            raise InputError("", "to", f"klipper {message}")
        slides.append((index, float(np.sign(row[index]))))
    return slides


def _directions(arm: Arm) -> Array:
    """In which direction (a column each) the tip goes with each slide."""
    start = np.array([float(item) for item in tip_position(arm, [0.0] * arm.size)[0]])
    moved = (tip_position(arm, [float(index == item) for item in range(arm.size)])[0] for index in range(arm.size))
    return np.column_stack([np.array([float(value) for value in item]) - start for item in moved])


def _angle(rotation: Array) -> float:
    """By how much (rad) a rotation turns."""
    across = rotation - rotation.T
    return float(np.arctan2(np.linalg.norm(across) / np.sqrt(8.0), 0.5 * (np.trace(rotation) - 1.0)))


def _number(value: float) -> str:
    return f"{float(value) if abs(value) > _NOTHING else 0.0:.12g}"
