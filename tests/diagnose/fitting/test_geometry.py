"""Zeros and lengths fitted together before anything else is sought, on a chain of plain matrices."""

import math

import numpy as np
import pytest

from linkwright.core.arm.files.read import read_arm
from linkwright.core.diagnose.fitting.geometry import about_geometry
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.costs import slow_but

TABLE = [(0, 160, 90), (-425, 0, 0), (-392, 0, 0), (0, 109, 90), (0, 95, -90), (0, 82, 0)]
"""a, d (mm) and alpha (deg), standard: the tip is on the last axis, whose zero moves it by rounding alone."""
ZEROS = np.radians([0.5, -1.0, 2.0, -3.0, 1.0, 0.0])


def tips(q, tool=(0.0, 0.0, 0.0)):
    """Tips (N, 3), m, of the first joints, `tool` (m) being where the tip truly is in the frame of the last."""
    results = []
    for angles in q:
        whole = np.eye(4)
        for angle, (a, d, alpha) in zip(angles, TABLE[: q.shape[1]], strict=True):
            c, s, twist = math.cos(angle), math.sin(angle), math.radians(alpha)
            ca, sa = math.cos(twist), math.sin(twist)
            step = [[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]]
            whole = whole @ np.array(step)
        results.append(1e-3 * whole[:3, 3] + whole[:3, :3] @ tool)
    return np.array(results)


def arm_of(tmp_path, joints=6):
    rows = [
        f"  - {{joint: {{}}, dh: {{a: {a} mm, d: {d} mm, alpha: {alpha} deg}}, link: {{rigid: true, mass: 1 kg}}}}\n"
        for a, d, alpha in TABLE[:joints]
    ]
    path = tmp_path / "arm.yaml"
    head = "gravity: [0 m/s^2, 0 m/s^2, -9.81 m/s^2]\npayload: {mass: 0 kg}\nchain:\n"
    path.write_text(head + "".join(rows), encoding="utf-8")
    return read_arm(path)


def diagnosed(arm, zeros, tool, seed):
    """Of 40 poses read twice, with noise of 0.05 mm."""
    rng = np.random.default_rng(seed)
    q = np.repeat(rng.uniform(-2.0, 2.0, (40, len(zeros))), 2, axis=0)
    measured = tips(q + np.radians(zeros), tool) + 5e-5 * rng.standard_normal((80, 3))
    return diagnose(arm, Recording("dh", q, measured, np.arange(1, 81), frame="free"))


def test_a_zero_that_no_reading_shows_does_not_hold_the_others(tmp_path):
    rng = np.random.default_rng(4)
    q = rng.uniform(-2.0, 2.0, (60, 6))
    measured = tips(q + ZEROS) + 2e-5 * rng.standard_normal((60, 3))
    result = about_geometry(observe(arm_of(tmp_path), Recording("dh", q, measured, np.arange(1, 61))))
    offsets = {item.at[0]: item.parameters["offset"] for item in result.about if item.effect == "encoder_offset"}
    np.testing.assert_allclose([offsets[k + 1] for k in range(5)], ZEROS[:5], atol=2e-4)


@pytest.mark.parametrize("seed", slow_but([1, 3], 1))
def test_zeros_are_allowed_for_beside_a_tool_that_is_off_by_more(seed, tmp_path):
    """The tool leaves 20 mm that no zero or length explains; what the zeros do beyond first order is small beside that,
    and far above the noise. The last zero turns the tool alone."""
    result = diagnosed(arm_of(tmp_path, 3), [0.0, 0.7, 1.0], (0.0, 0.0, 0.02), seed)
    names = {(finding.effect, finding.at) for finding in result.findings}
    assert names == {("encoder_offset", (2,)), ("tool_offset", ())}
    (zero,) = (finding for finding in result.findings if finding.effect == "encoder_offset")
    assert abs(zero.parameters[0].value - math.radians(0.7)) < 5e-5


def test_a_tool_off_by_centimetres_along_the_last_link_is_its_length_or_the_tool(tmp_path):
    (length,) = diagnosed(arm_of(tmp_path), [0.0] * 6, (0.0, 0.0, 0.02), 1).findings
    assert (length.effect, length.at) == ("link_length", (6,))
    assert [(other.effect, other.at) for other in length.alternatives] == [("tool_offset", ())]


CROOKED = """
gravity: [0 m/s^2, 0 m/s^2, -9.81 m/s^2]
chain:
  - joint: {axis: z}
    link: {length: 300 mm, rigid: true, mass: 1 kg}
  - joint: {axis: y}
    link: {length: 150 mm, direction: [0.8, 0, -0.6], rigid: true, mass: 1 kg}
"""


@pytest.mark.parametrize("seed", slow_but(range(3), 1))
def test_a_zero_at_the_wrist_is_not_told_as_two_lengths(seed, tmp_path):
    """To first order the zero is both numbers of the crooked last link, whose usual sizes are nearer; beyond it, a
    single number does as well as those two."""
    rng = np.random.default_rng(seed)
    q = np.repeat(rng.uniform(-1.5, 1.5, (40, 2)), 2, axis=0)
    wrist = q[:, 1] + math.radians(2.5)
    # The link, 120 mm out and 90 mm down, turned about y and then about z.
    out, up = 300 + 120 * np.cos(wrist) - 90 * np.sin(wrist), -120 * np.sin(wrist) - 90 * np.cos(wrist)
    tip = 1e-3 * np.stack([out * np.cos(q[:, 0]), out * np.sin(q[:, 0]), up], axis=1)
    (tmp_path / "arm.yaml").write_text(CROOKED, encoding="utf-8")
    measured = tip + 2e-4 * rng.standard_normal(tip.shape)
    result = diagnose(read_arm(tmp_path / "arm.yaml"), Recording("r.csv", q, measured, np.arange(1, 81)))
    (zero,) = result.findings
    assert (zero.effect, zero.at) == ("encoder_offset", (2,))
    low, high = zero.parameters[0].interval
    assert low <= math.radians(2.5) <= high
