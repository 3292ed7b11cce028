"""Of poses that are equally bad the plainest is told, whatever the processor rounds."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.limits.modes import first_frequencies
from linkwright.core.arm.limits.weakest_poses import plainest

ROOT = Path(__file__).parents[3]
BOX = (np.array([-2.0, -2.0, 0.5]), np.array([2.0, 2.0, 2.0]))


def bad(q):
    """Worst where the second joint stands at 0.7 to either side; the first does not count, the third hardly ever."""
    return 1.0 - (np.abs(q[:, 1]) - 0.7) ** 2 + 0.0 * q[:, 0]


@given(first=st.floats(-2.0, 2.0), side=st.sampled_from([-1.0, 1.0]), third=st.floats(0.5, 2.0))
def test_joints_that_do_not_count_stand_at_nought(first: float, side: float, third: float):
    result = plainest(bad, np.array([first, 0.7 * side, third]), BOX)
    # The third comes no nearer than 0.5, so its mirror image is no pose of this arm.
    assert result.tolist() == [0.0, 0.7 * side, 0.5]
    free = (np.full(3, -2.0), np.full(3, 2.0))
    assert plainest(bad, np.array([first, 0.7 * side, third]), free).tolist() == [0.0, 0.7, 0.0]


@given(pose=st.lists(st.floats(-2.0, 2.0), min_size=3, max_size=3))
def test_a_joint_that_counts_stays(pose: list[float]):
    def load(q):
        return 1.0 - np.sum((q - np.array(pose)) ** 2, axis=1)

    result = plainest(load, np.array(pose), (np.full(3, -2.0), np.full(3, 2.0)))
    assert load(result[None])[0] >= 1.0 - 1e-9
    assert result == pytest.approx(pose, abs=4e-5)


def test_the_first_joint_of_a_planar_arm_does_not_count():
    """Turned as a whole, an arm in the plane is as slow and, by whichever force is worst, as soft: 0 is told, and what
    is told is as slow as what is found."""
    arm = read_arm(ROOT / "examples" / "welding-arm" / "arm.yaml")
    result = evaluate(arm)
    assert result.frequency is not None
    assert result.stiffness is not None
    assert result.frequency.q[0] == result.stiffness.q[0] == 0.0
    there = first_frequencies(arm, beams_of(arm), arm.payloads(arm.cases[0]), np.array([result.frequency.q]))
    assert there[0] == pytest.approx(result.frequency.value, rel=1e-8)
