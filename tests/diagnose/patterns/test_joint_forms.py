"""What one joint does that the library has no name for: off within a part of its travel, or to and fro with time."""

import numpy as np
import pytest

from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.diagnose.arm_of_drives import arm_of_drives, read, turned_by, visited

ARM = arm_of_drives()


@pytest.mark.parametrize(
    ("seed", "low", "high"),
    [
        pytest.param(0, 0.32, 0.96, marks=pytest.mark.slow),
        (1, 0.32, 0.96),
        pytest.param(2, -0.3, 0.0, marks=pytest.mark.slow),
    ],
)
def test_a_joint_that_is_off_in_a_part_of_its_travel(seed, low, high):
    """A worn stretch of a gear, say: joint 2 is off by 0.15 mrad in there, and nowhere else."""
    rng = np.random.default_rng(seed)
    q = visited(rng, 120, 2)
    errors = np.zeros_like(q)
    errors[:, 1] = np.where((q[:, 1] >= low) & (q[:, 1] < high), 1.5e-4, 0.0)
    result = diagnose(ARM, read(q, turned_by(q, errors), rng))
    assert result.verdict == "unknown"
    assert "q2" in result.unknown.depends_on
    assert "part of its travel" in result.unknown.shape
    assert "joint 2" in result.unknown.shape
    assert result.where.joint == 2
    assert result.unknown.amplitude == pytest.approx(result.rms_before, rel=0.35)


@pytest.mark.slow
@pytest.mark.parametrize("joint", [1, 2, 3])
def test_a_joint_that_goes_to_and_fro_with_time(joint):
    """0.1 mrad with a period of 9 visits, in 150 visits to random poses."""
    rng = np.random.default_rng(joint)
    q = visited(rng, 150, 2)
    time = 20.0 * np.arange(300)
    errors = np.zeros_like(q)
    errors[:, joint - 1] = 1e-4 * np.sin(2.0 * np.pi * time / 352.0 + joint)
    result = diagnose(ARM, read(q, turned_by(q, errors), rng))
    assert result.verdict == "unknown"
    assert "time" in result.unknown.depends_on
    assert "motion of one joint that is periodic in time" in result.unknown.shape
    assert result.unknown.forms[0].name == "joint_periodic_in_time"
    assert result.unknown.forms[0].share_held_out > 0.4
    assert result.where.joint == joint
    assert result.rms_after < 1.2 * result.noise_floor


@pytest.mark.parametrize(
    ("joint", "other", "law"),
    [
        pytest.param(1, 3, lambda q: q[:, 2], marks=pytest.mark.slow),
        (2, 3, lambda q: q[:, 2] ** 2),
        pytest.param(3, 2, lambda q: q[:, 1] * q[:, 2], marks=pytest.mark.slow),
        pytest.param(2, 1, lambda q: q[:, 0] * q[:, 1], marks=pytest.mark.slow),
    ],
)
def test_a_joint_that_is_off_by_where_another_stands(joint, other, law):
    """Dragged along by a later one, or twisted between two: 0.3 mrad at most, by no entry of the library."""
    rng = np.random.default_rng(10 * joint + other)
    q = visited(rng, 100, 2)
    errors = np.zeros_like(q)
    errors[:, joint - 1] = 3e-4 * law(q) / np.abs(law(q)).max()
    result = diagnose(ARM, read(q, turned_by(q, errors), rng))
    assert result.verdict == "unknown"
    assert f"(joint {joint} by joint {other})" in result.unknown.shape
    assert f"q{other}" in result.unknown.depends_on
    assert result.where.joint == joint
    assert result.unknown.forms[0].share_held_out > 0.7
    assert result.rms_after < 1.15 * result.noise_floor


@pytest.mark.slow
def test_a_coupling_to_the_joint_before_keeps_its_name():
    """The form could tell it as well; an entry of the library goes before it."""
    rng = np.random.default_rng(4)
    q = visited(rng, 100, 2)
    errors = np.zeros_like(q)
    errors[:, 1] = 2e-4 * q[:, 0]
    result = diagnose(ARM, read(q, turned_by(q, errors), rng))
    assert [(finding.effect, finding.at) for finding in result.findings] == [("joint_coupling", (2,))]
    assert result.unknown is None
