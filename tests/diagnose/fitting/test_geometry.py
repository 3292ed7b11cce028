"""Zeros and lengths fitted together before anything else is sought, on a chain of plain matrices."""

import math

import numpy as np

from linkwright.core.arm.files.read import read_arm
from linkwright.core.diagnose.fitting.geometry import about_geometry
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.observe import observe

TABLE = [(0, 160, 90), (-425, 0, 0), (-392, 0, 0), (0, 109, 90), (0, 95, -90), (0, 82, 0)]
"""a, d (mm) and alpha (deg), standard: the tip is on the last axis, whose zero moves it by rounding alone."""
ZEROS = np.radians([0.5, -1.0, 2.0, -3.0, 1.0, 0.0])


def tips(q):
    results = []
    for angles in q:
        whole = np.eye(4)
        for angle, (a, d, alpha) in zip(angles, TABLE, strict=True):
            c, s, twist = math.cos(angle), math.sin(angle), math.radians(alpha)
            ca, sa = math.cos(twist), math.sin(twist)
            step = [[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]]
            whole = whole @ np.array(step)
        results.append(1e-3 * whole[:3, 3])
    return np.array(results)


def test_a_zero_that_no_reading_shows_does_not_hold_the_others(tmp_path):
    rows = [f"  - {{joint: {{}}, dh: {{a: {a} mm, d: {d} mm, alpha: {alpha} deg}}}}\n" for a, d, alpha in TABLE]
    path = tmp_path / "arm.yaml"
    path.write_text("gravity: [0 m/s^2, 0 m/s^2, -9.81 m/s^2]\nchain:\n" + "".join(rows), encoding="utf-8")
    rng = np.random.default_rng(4)
    q = rng.uniform(-2.0, 2.0, (60, 6))
    measured = tips(q + ZEROS) + 2e-5 * rng.standard_normal((60, 3))
    result = about_geometry(observe(read_arm(path), Recording("dh", q, measured, np.arange(1, 61))))
    offsets = {item.at[0]: item.parameters["offset"] for item in result.about if item.effect == "encoder_offset"}
    np.testing.assert_allclose([offsets[k + 1] for k in range(5)], ZEROS[:5], atol=2e-4)
