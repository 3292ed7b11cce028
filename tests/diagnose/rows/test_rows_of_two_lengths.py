"""Zeros and lengths of arms whose rows give both a and d (most industrial robots): each is told by the number of the
file that is off, drawn by chains of plain matrices."""

import math

import numpy as np
import pytest

from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.arm.rows.matrices import QUARTER, arm_of, tip_by_matrices

OFFSET_WRIST = [
    (0.0, 0.66, -QUARTER, 0.0),
    (0.43, 0.15, 0.0, 0.0),
    (-0.02, 0.0, QUARTER, 0.0),
    (0.0, 0.43, -QUARTER, 0.0),
    (0.0, 0.0, QUARTER, 0.0),
    (0.0, 0.056, 0.0, 0.0),
]
"""A shoulder beside the base's axis and an elbow set back."""
SHOULDER = [
    (0.07, 0.29, -QUARTER, 0.0),
    (0.27, 0.0, 0.0, -QUARTER),
    (0.07, 0.0, -QUARTER, 0.0),
    (0.0, 0.302, QUARTER, 0.0),
    (0.0, 0.0, -QUARTER, 0.0),
    (0.0, 0.072, 0.0, math.pi),
]
"""A shoulder set off in front of the base's axis."""


def named(rows, off, tmp_path, seed):
    rng = np.random.default_rng([seed, 11])
    true = np.array(rows)
    for row, number, value in off:
        true[row, number] += value
    q = np.repeat(rng.uniform(-2.0, 2.0, (50, len(rows))), 2, axis=0)
    tip = np.array([tip_by_matrices(true, angles, modified=False) for angles in q])
    seen = tip + 5e-5 * rng.standard_normal(tip.shape)
    arm = arm_of(rows, tmp_path, modified=False)
    return diagnose(arm, Recording("drawn", q, seen, np.arange(1, len(q) + 1), frame="free"))


@pytest.mark.parametrize(
    ("rows", "off", "expected"),
    [
        pytest.param(SHOULDER, [(0, 0, 1e-3)], {("link_length", 1, "x"): 1e-3}, marks=pytest.mark.slow),
        pytest.param(OFFSET_WRIST, [(1, 1, -1.5e-3)], {("link_length", 2, "z"): -1.5e-3}, marks=pytest.mark.slow),
        (
            OFFSET_WRIST,
            [(1, 0, 1.5e-3), (1, 1, -1e-3), (2, 3, math.radians(-1.0))],
            {
                ("link_length", 2, "x"): 1.5e-3,
                ("link_length", 2, "z"): -1e-3,
                ("encoder_offset", 3, "offset"): math.radians(-1.0),
            },
        ),
    ],
)
def test_the_number_of_the_file_is_told(rows, off, expected, tmp_path):
    result = named(rows, off, tmp_path, seed=1)
    found = {
        (finding.effect, *finding.at, item.parameter): item
        for finding in result.findings
        for item in finding.parameters
    }
    assert set(found) == set(expected)
    for name, value in expected.items():
        assert found[name].value == pytest.approx(value, rel=0.03)
    assert result.unknown is None


def test_a_number_that_is_far_off_is_put_in_first_under_its_key(tmp_path):
    result = named(OFFSET_WRIST, [(1, 1, -0.02), (2, 3, math.radians(3.0))], tmp_path, seed=2)
    assert "chain[2].dh.d is off by -20 mm" in result.sentence
