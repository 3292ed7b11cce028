"""A corrected arm goes into a URDF: as plain matrices of the corrected numbers have it, and past the guard that reads
the file back; the uncorrected arm's file in its place does not pass."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import linkwright as lw
from linkwright.core.arm.chain.chain import Arm, EffectEntry, Link
from linkwright.core.sections.numeric import Array
from linkwright.output.files import NotAsWritten
from tests.arm.descriptions.urdf_chain import tip_pose
from tests.arm.rows.matrices import QUARTER, arm_of
from tests.test_house import ROOT

ROWS = [(0.0, 0.13, QUARTER, 0.0), (0.61, 0.0, 0.0, -0.2), (0.07, 0.0, -QUARTER, 0.3), (0.0, 0.41, QUARTER, 0.0)]
TOOL = (0.05, -0.02, 0.11)
TABLETOP = (ROOT / "examples" / "urdf" / "tabletop.urdf").read_text(encoding="utf-8")
OFFSET, LONGER, TILT = 0.005, 0.0008, {"tilt_u": 0.004, "tilt_v": -0.003, "shift_u": 0.001, "shift_v": -0.0005}
GEOMETRY = (
    EffectEntry("encoder_offset", (2,), {"offset": OFFSET}),
    EffectEntry("link_length", (2,), {"length": LONGER}),
    EffectEntry("axis_misalignment", (2,), TILT),
)
EACH = [*((item,) for item in GEOMETRY), GEOMETRY]
NAMES = ["encoder_offset", "link_length", "axis_misalignment", "all"]


def askew(found: Sequence[EffectEntry], u: Array, v: Array) -> tuple[Rotation, Array]:
    """How the axis of joint 2 stands beside where the file has it, in its frame; u and v across it."""
    if not any(item.effect == "axis_misalignment" for item in found):
        return Rotation.identity(), np.zeros(3)
    turn, shift = (TILT[f"{kind}_u"] * u + TILT[f"{kind}_v"] * v for kind in ("tilt", "shift"))
    return Rotation.from_rotvec(turn), shift


def by_rows(found: Sequence[EffectEntry], q: Array) -> Array:
    """The tip by the corrected rows. Across a row's axis z lie y and -x."""
    kinds = {item.effect for item in found}
    rows = np.array(ROWS)
    rows[1, 3] += OFFSET * ("encoder_offset" in kinds)
    rows[1, 0] += LONGER * ("link_length" in kinds)
    turn, tip = Rotation.identity(), np.zeros(3)
    for number, ((a, d, alpha, theta), angle) in enumerate(zip(rows, q, strict=True), start=1):
        if number == 2:
            off, shift = askew(found, np.array([0.0, 1.0, 0.0]), np.array([-1.0, 0.0, 0.0]))
            tip, turn = tip + turn.apply(shift), turn * off
        about_z = Rotation.from_euler("z", angle + theta)
        tip = tip + turn.apply(np.array([0.0, 0.0, d]) + about_z.apply([a, 0.0, 0.0]))
        turn = turn * about_z * Rotation.from_euler("x", alpha)
    return tip + turn.apply(TOOL)


def by_text(found: Sequence[EffectEntry], q: Array) -> Array:
    """The tip by the URDF's own numbers, three of them changed. Across the axis (0, 0.6, 0.8) lie (0, 0.8, -0.6) and
    -x."""
    kinds = {item.effect for item in found}
    text = TABLETOP.replace('xyz="0.25 0 0"', f'xyz="{0.25 + LONGER * ("link_length" in kinds)} 0 0"')
    stands = Rotation.from_euler("xyz", [1.5708, 0.0, 0.2])
    off, shift = askew(found, np.array([0.0, 0.8, -0.6]), np.array([-1.0, 0.0, 0.0]))
    place = np.array([0.0, 0.03, 0.2]) + stands.apply(shift)
    xyz, rpy = (" ".join(map(repr, map(float, item))) for item in (place, (stands * off).as_euler("xyz")))
    right = 'xyz="0 0.03 0.2" rpy="1.5708 0 0.2"'
    assert right in text
    q = q + OFFSET * np.array([0.0, 1.0, 0.0]) * ("encoder_offset" in kinds)
    changed = text.replace(right, f'xyz="{xyz}" rpy="{rpy}"')
    return tip_pose(changed, "base", "tip", dict(zip(("turn", "shoulder", "reach"), q, strict=True)))[:3, 3]


def check_exported(arm: Arm, found: Sequence[EffectEntry], truth: Array, poses: Array, tmp_path: Path) -> None:
    """`truth` (N, 3) is where the tip is at the poses (N, n)."""
    corrected = lw.Arm.of(replace(arm, effects=(*arm.effects, *found)))
    result = lw.export_arm(corrected, to="urdf")
    names = [joint.name or f"joint{number}" for number, joint in enumerate(arm.joints, start=1)]
    tips = [tip_pose(result.text, "base", "tip", dict(zip(names, q, strict=True)))[:3, 3] for q in poses]
    assert np.array(tips) == pytest.approx(truth, abs=1e-9)
    result.save(tmp_path / "arm.urdf")
    as_before = lw.export_arm(lw.Arm.of(arm), to="urdf").text
    with pytest.raises(NotAsWritten, match=r"a tip is .* away from where it was"):
        replace(result, found=replace(result.found, text=as_before)).save(tmp_path / "wrong.urdf")


@pytest.mark.parametrize("found", EACH, ids=NAMES)
def test_rows_with_a_tool(found: Sequence[EffectEntry], tmp_path: Path) -> None:
    arm = replace(arm_of(ROWS, tmp_path, modified=False), tool=TOOL)
    poses = np.random.default_rng(5).uniform(-math.pi, math.pi, (4, 4))
    check_exported(arm, found, np.array([by_rows(found, q) for q in poses]), poses, tmp_path)


@pytest.mark.parametrize("found", EACH, ids=NAMES)
def test_a_urdf(found: Sequence[EffectEntry], tmp_path: Path) -> None:
    (tmp_path / "tabletop.urdf").write_text(TABLETOP, encoding="utf-8")
    arm = lw.import_arm(tmp_path / "tabletop.urdf", tip="tip").arm.model
    poses = np.random.default_rng(5).uniform((-3.0, -1.2, 0.0), (3.0, 2.0, 0.15), (4, 3))
    check_exported(arm, found, np.array([by_text(found, q) for q in poses]), poses, tmp_path)


def test_what_was_found_of_weights_is_held_beside_the_file_too(tmp_path: Path) -> None:
    """3 kg at the tip, which the arm file does not have."""
    arm = arm_of(ROWS, tmp_path, modified=False)
    more = EffectEntry("payload", (), {"mass": 3.0, "inertia_xx": 0.1, "inertia_yy": 0.1, "inertia_zz": 0.1})
    result = lw.export_arm(lw.Arm.of(replace(arm, effects=(more,))), to="urdf")
    result.save(tmp_path / "arm.urdf")
    as_before = lw.export_arm(lw.Arm.of(arm), to="urdf").text
    with pytest.raises(NotAsWritten, match="7 kg of it moved and 4 kg move"):
        replace(result, found=replace(result.found, text=as_before)).save(tmp_path / "wrong.urdf")


def test_a_link_that_is_called_tip_is_not_the_tip(tmp_path: Path) -> None:
    """The file's tip then has another name, and is the one that is held beside the arm."""
    arm = replace(arm_of(ROWS, tmp_path, modified=False), tool=TOOL)
    links: tuple[Link, ...] = (*arm.links[:-1], replace(arm.links[-1], name="tip"))
    result = lw.export_arm(lw.Arm.of(replace(arm, links=links)), to="urdf")
    result.save(tmp_path / "arm.urdf")
    names = re.findall(r'<joint name="([^"]*)" type="revolute"', result.text)
    for q in np.random.default_rng(7).uniform(-1.0, 1.0, (3, 4)):
        tip = tip_pose(result.text, "base", "tip_", dict(zip(names, q, strict=True)))[:3, 3]
        np.testing.assert_allclose(tip, by_rows((), q), atol=1e-9)


def test_a_gantry_carries_its_carriage_and_not_its_beam(tmp_path: Path) -> None:
    """What moves: the carriage of the first slide (8 kg) with its link, and not the beam that it runs on."""
    lw.export_arm(ROOT / "examples" / "worked" / "gantry" / "arm.yaml", to="urdf").save(tmp_path / "arm.urdf")
    assert 'mass value="12.0"' in (tmp_path / "arm.urdf").read_text(encoding="utf-8")
