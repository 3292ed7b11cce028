"""Arms by Denavit-Hartenberg rows, as chains of plain matrices and as files: no code of the tool takes part."""

import math

import numpy as np
from scipy.spatial.transform import Rotation

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.files.read import read_arm

QUARTER = 0.5 * math.pi


def tip_by_matrices(rows, q, *, modified):
    turn, tip = Rotation.identity(), np.zeros(3)
    for (a, d, alpha, theta), angle in zip(rows, q, strict=True):
        about_x, about_z = Rotation.from_euler("x", alpha), Rotation.from_euler("z", angle + theta)
        if modified:
            tip = tip + turn.apply(np.array([a, 0.0, 0.0]) + about_x.apply([0.0, 0.0, d]))
            turn = turn * about_x * about_z
        else:
            tip = tip + turn.apply(np.array([0.0, 0.0, d]) + about_z.apply([a, 0.0, 0.0]))
            turn = turn * about_z * about_x
    return tip


def arm_of(rows, tmp_path, *, modified, masses=None) -> Arm:
    convention = "modified" if modified else "standard"
    lines = ["name: rows", "gravity: [0 m/s^2, 0 m/s^2, -9.81 m/s^2]", "chain:"]
    for (a, d, alpha, theta), mass in zip(rows, masses or [1.0] * len(rows), strict=True):
        lines.append("  - joint: {range: [-180 deg, 180 deg]}")
        lines.append(
            f"    dh: {{a: {a} m, d: {d} m, alpha: {alpha} rad, theta: {theta} rad, convention: {convention}}}"
        )
        lines.append(f"    link: {{rigid: true, mass: {mass} kg}}")
    path = tmp_path / "arm.yaml"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return read_arm(path)
