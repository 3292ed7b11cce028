"""Klipper's own sums with what was found of a gantry, against where its tip goes."""

import re
from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm, EffectEntry, Joint, Link
from linkwright.core.arm.corrections import CORRECTIONS
from linkwright.core.arm.effects.geometry.axis_misalignment import across_axis
from linkwright.core.units.quantities import InputError


def gantry(axes):
    """Slides along these axes, each on the one before."""
    joints = tuple(Joint("prismatic", axis, (0.0, 0.4)) for axis in axes)
    return Arm("gantry", joints, tuple(Link(0.05, (0.0, 0.0, 1.0), mass=1.0) for _ in axes), gravity=(0.0, 0.0, -9.81))


def turned(vector, about, angle):
    """Rodrigues' formula."""
    about = np.asarray(about) / np.linalg.norm(about)
    return (
        np.cos(angle) * np.asarray(vector)
        + np.sin(angle) * np.cross(about, vector)
        + (1 - np.cos(angle)) * about * (about @ np.asarray(vector))
    )


def settings(text):
    """The factors and each stepper's ratio and shift (mm) of the text."""
    skew = {key: float(value) for key, value in re.findall(r"^(\w\w_skew): (\S+)$", text, re.MULTILINE)}
    steppers = dict.fromkeys("xyz", (1.0, 0.0))
    for axis, ratio, again, shift in re.findall(
        r"\[stepper_(\w)\] rotation_distance times (\S+), position_endstop times (\S+) plus (\S+) mm", text
    ):
        assert ratio == again
        steppers[axis] = (float(ratio), float(shift))
    return skew, steppers


def klipper(wanted, text):
    """Which position (m, today's reading of x, y and z) the firmware goes to for a wanted one."""
    skew, steppers = settings(text)
    xy, xz, yz = (skew[f"{item}_skew"] for item in ("xy", "xz", "yz"))
    x, y, z = wanted
    commanded = (x - y * xy - z * (xz - xy * yz), y - z * yz, z)
    return [
        (value - 1e-3 * steppers[axis][1]) / steppers[axis][0] for axis, value in zip("xyz", commanded, strict=True)
    ]


def apart(points):
    """All distances between points: what a machine that stands turned as a whole leaves."""
    return np.linalg.norm(points[:, None] - points[None], axis=2)


AXES = {
    "x on y": ((0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    "against": ((1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, -1.0, 0.0)),
}


@pytest.mark.parametrize("name", AXES)
def test_a_skew_gantry_is_square_by_klippers_sums(name):
    """Askew by milliradians and off by parts in a thousand, by millimetres; then square to the last digit."""
    axes = AXES[name]
    arm = gantry(axes)
    scales, offsets, tilts = (0.002, -0.001, 0.0005), (0.001, 0.0, -0.0004), ((0.003, -0.002), (0.001, 0.004))
    effects = [EffectEntry("encoder_scale", (k + 1,), {"scale": scale}) for k, scale in enumerate(scales)]
    effects += [EffectEntry("encoder_offset", (k + 1,), {"offset": offset}) for k, offset in enumerate(offsets)]
    directions, frame = [], np.eye(3)
    for k, axis in enumerate(axes):
        if k:
            tilt_u, tilt_v = tilts[k - 1]
            effects.append(EffectEntry("axis_misalignment", (k + 1,), {"tilt_u": tilt_u, "tilt_v": tilt_v}))
            u, v = (np.array(item) for item in across_axis(arm.joints[k]))
            turn = tilt_u * u + tilt_v * v
            # Each tilt turns what is on it too.
            frame = frame @ np.column_stack([turned(item, turn, np.linalg.norm(turn)) for item in np.eye(3)])
        directions.append(frame @ axis)
    which = [next(k for k in range(3) if axes[k][along] != 0.0) for along in range(3)]
    senses = [axes[which[along]][along] for along in range(3)]

    def machine(position):
        """Where the tip goes when x, y and z are read as these."""
        read = np.zeros(3)
        for along in range(3):
            read[which[along]] = senses[along] * position[along]
        return sum((offsets[k] + (1 + scales[k]) * read[k]) * directions[k] for k in range(3))

    out = CORRECTIONS["klipper"](replace(arm, effects=tuple(effects)))
    wanted = np.array([(x, y, z) for x in (0.0, 0.2, 0.4) for y in (0.0, 0.4) for z in (0.0, 0.3)])
    before = apart(np.array([machine(item) for item in wanted])) - apart(wanted)
    after = apart(np.array([machine(klipper(item, out.text)) for item in wanted])) - apart(wanted)
    assert np.abs(before).max() > 0.4e-3
    assert np.abs(after).max() < 1e-10
    assert len(out.lost) == 1
    assert "the whole machine stands turned" in out.lost[0]


def test_where_only_z_leans_positions_are_right_too():
    """Then nothing stands turned: the tip comes to where it was told, zeros included."""
    arm = gantry(AXES["x on y"])
    leaning = EffectEntry("axis_misalignment", (3,), {"tilt_u": 0.002})
    shifted = EffectEntry("encoder_offset", (2,), {"offset": 0.003})
    out = CORRECTIONS["klipper"](replace(arm, effects=(leaning, shifted)))
    lean = turned((0.0, 0.0, 1.0), across_axis(arm.joints[2])[0], 0.002)
    for wanted in ((0.1, 0.2, 0.3), (0.4, 0.0, 0.1)):
        x, y, z = klipper(wanted, out.text)
        tip = (x + 0.003) * np.array([1.0, 0.0, 0.0]) + y * np.array([0.0, 1.0, 0.0]) + z * lean
        assert tip == pytest.approx(wanted, abs=1e-10)
    assert not out.lost


def test_what_klipper_has_no_place_for_is_told():
    backlash = EffectEntry("backlash", (1,), {"total": 0.0001})
    out = CORRECTIONS["klipper"](replace(gantry(AXES["x on y"]), effects=(backlash,)))
    assert "backlash" in out.lost[0]
    assert out.carried[0].startswith("nothing")


def test_another_arm_is_refused():
    arm = gantry(AXES["x on y"])
    for other in (
        replace(arm, joints=arm.joints[:2], links=arm.links[:2]),
        replace(arm, joints=(replace(arm.joints[0], type="revolute"), *arm.joints[1:])),
        gantry(((0.0, 1.0, 0.0), (0.6, 0.8, 0.0), (0.0, 0.0, 1.0))),
    ):
        with pytest.raises(InputError, match="three slides along x, y and z"):
            CORRECTIONS["klipper"](other)
