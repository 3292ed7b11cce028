"""Denavit-Hartenberg parameters in both conventions, against the products of matrices that define them."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.files.write import write_arm
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError

Row = tuple[float, float, float, float]

PANDA: tuple[Row, ...] = (
    (0.0, 333.0, 0.0, 0.0),
    (0.0, 0.0, -90.0, 0.0),
    (0.0, 316.0, 90.0, 0.0),
    (82.5, 0.0, 90.0, 0.0),
    (-82.5, 384.0, -90.0, 0.0),
    (0.0, 0.0, 90.0, 0.0),
    (88.0, 0.0, 90.0, 0.0),
)
"""a, d (mm), alpha, theta (deg) as Franka Emika publishes them, in Craig's convention."""
ODD: tuple[Row, ...] = ((30.0, 100.0, 20.0, 15.0), (250.0, -40.0, -75.0, 100.0), (10.0, 60.0, 33.0, -50.0))


def moved(axis: str, angle: float, shift: tuple[float, float, float]) -> Array:
    matrix = np.eye(4)
    matrix[:3, :3] = Rotation.from_euler(axis, angle).as_matrix()
    matrix[:3, 3] = shift
    return matrix


def modified(row: Row, q: float, *, slides: bool = False) -> Array:
    """Rx(alpha) Tx(a) Rz(theta) Tz(d), J. J. Craig, Introduction to Robotics, eq. 3.6."""
    a, d, alpha, theta = row[0] / 1e3, row[1] / 1e3, math.radians(row[2]), math.radians(row[3])
    turn, rise = (0.0, q) if slides else (q, 0.0)
    first = moved("x", alpha, (0, 0, 0)) @ moved("x", 0.0, (a, 0, 0))
    return first @ moved("z", theta + turn, (0, 0, 0)) @ moved("z", 0.0, (0, 0, d + rise))


def arm_file(folder: Path, rows: tuple[Row, ...], kinds: str, tool: float = 107.0, link: str = "") -> Path:
    lines = ["gravity: [0 m/s^2, 0 m/s^2, -9.81 m/s^2]", "chain:"]
    for (a, d, alpha, theta), kind in zip(rows, kinds, strict=True):
        joint = "type: revolute" if kind == "r" else "type: prismatic, range: [0 mm, 500 mm]"
        dh = f"a: {a} mm, d: {d} mm, alpha: {alpha} deg, theta: {theta} deg, convention: modified"
        lines.append(f"  - {{joint: {{{joint}}}, dh: {{{dh}}}, link: {{rigid: true, mass: 1 kg{link}}}}}")
    lines.append(f"tool: {{xyz: [0 mm, 0 mm, {tool} mm]}}")
    path = folder / "arm.yaml"
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.mark.parametrize(("rows", "kinds"), [(PANDA, "r" * 7), (ODD, "rrr"), (ODD, "rpr"), (ODD, "prp")])
def test_modified_parameters(tmp_path: Path, rows: tuple[Row, ...], kinds: str) -> None:
    arm = read_arm(arm_file(tmp_path, rows, kinds))
    random = np.random.default_rng(1)
    for _ in range(20):
        q = np.array([random.uniform(-3, 3) if kind == "r" else random.uniform(0, 0.5) for kind in kinds])
        frame = np.eye(4)
        for row, kind, value in zip(rows, kinds, q.tolist(), strict=True):
            frame = frame @ modified(row, value, slides=kind == "p")
        goal = frame @ [0.0, 0.0, 0.107, 1.0]
        assert tip_position(arm, q[None])[0] == pytest.approx(goal[:3], abs=1e-12)


def test_modified_parameters_survive_writing(tmp_path: Path) -> None:
    arm = read_arm(arm_file(tmp_path, PANDA, "r" * 7))
    write_arm(arm, tmp_path / "again.yaml")
    again = read_arm(tmp_path / "again.yaml")
    q = np.random.default_rng(2).uniform(-3.0, 3.0, (20, 7))
    assert tip_position(again, q) == pytest.approx(tip_position(arm, q), abs=1e-9)


def test_the_panda_stretched_out_as_in_its_data_sheet(tmp_path: Path) -> None:
    """All angles 0: the flange stands 88 mm in front of the base's axis and 333 + 316 + 384 - 107 mm above it."""
    arm = read_arm(arm_file(tmp_path, PANDA, "r" * 7))
    assert tip_position(arm, np.zeros((1, 7)))[0] == pytest.approx([0.088, 0.0, 0.926], abs=1e-12)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("mass: 1 kg}", "mass: 1 kg, length: 100 mm}"), "given by dh already"),
        (("convention: modified", "convention: craig"), "convention"),
        (("type: revolute", "type: revolute, axis: z"), "is z by dh already"),
        (("link: {rigid", "origin: {xyz: [0 mm, 0 mm, 1 mm]}, link: {rigid"), "given by dh already"),
    ],
)
def test_what_contradicts_modified_parameters(tmp_path: Path, change: tuple[str, str], said: str) -> None:
    path = arm_file(tmp_path, ODD, "rrr")
    path.write_text(path.read_text().replace(*change))
    with pytest.raises(InputError) as refused:
        read_arm(path)
    assert said in str(refused.value)
