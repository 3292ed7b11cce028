"""A sound arm that returns badly, by plain sums of cosines: what visits scatter by, with poses come back to or not."""

import numpy as np
import pytest

from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.costs import slow_but
from tests.diagnose.by_cosines import SIGMA, file, noise, poses, recording, tips


def found_of(seed: int, scatter: float, *, again: int = 1, offset: float = 0.0):
    """30 poses, each visited `again` times and read three times a visit; visits stand off by `scatter` times the noise,
    in either direction of the plane. The second encoder's zero is off by `offset`, rad."""
    q = np.tile(poses(seed, 30), (again, 1))
    off = scatter * SIGMA * np.random.default_rng(seed + 7).standard_normal((len(q), 2))
    q, off = np.repeat(q, 3, axis=0), np.repeat(off, 3, axis=0)
    return diagnose(file(), recording(q, tips(q + np.array([0.0, offset, 0.0])) + off + noise(seed, len(q))))


@pytest.mark.parametrize("seed", slow_but(range(2, 5), 3))
def test_a_little_scatter_is_no_fault_of_the_model(seed):
    result = found_of(seed, 1.3)
    assert result.verdict == "none"
    assert result.scatter == pytest.approx(np.hypot(1.0, 1.3), rel=0.2)


@pytest.mark.parametrize("seed", slow_but([2, 4, 6], 4))
def test_much_is_unknown_where_no_pose_was_come_back_to(seed):
    """Nobody can say there whether it is scatter or the model: that is said, and what would tell. (At seed 3 a mass of
    link 1 explains as much as at one such arm in 300, which is the level itself: draws toss for it.)"""
    result = found_of(seed, 3.0)
    assert result.verdict == "unknown"
    assert result.unknown is not None
    assert result.unknown.decide.startswith("visit some poses three times or more")
    assert any(note.startswith("No pose was visited again") for note in result.notes)


@pytest.mark.parametrize("seed", slow_but(range(2, 5), 3))
def test_the_same_is_scatter_where_poses_were_come_back_to(seed):
    result = found_of(seed, 3.0, again=2)
    assert result.verdict == "none"
    assert result.scatter is not None
    assert result.scatter > 2.0
    assert not any(note.startswith("No pose was visited again") for note in result.notes)


@pytest.mark.parametrize("seed", slow_but(range(2, 5), 3))
def test_scatter_beside_a_name_of_its_own_size_is_told_as_that_too(seed):
    """The zero moves the tip by little more than visits scatter: what is left may be either."""
    result = found_of(seed, 1.8, offset=1.2e-4)
    assert [(finding.effect, finding.at) for finding in result.findings] == [("encoder_offset", (2,))]
    assert result.unknown is not None
    assert result.unknown.decide.startswith("visit some poses three times or more")
    assert any(note.startswith("No pose was visited again") for note in result.notes)


_ADDED = pytest.mark.xfail(strict=True, reason="a mass is named beside the zero, by chance: at none of 40 other seeds")


@pytest.mark.parametrize(
    "seed", [pytest.param(2, marks=pytest.mark.slow), pytest.param(3, marks=[pytest.mark.slow, _ADDED]), 4]
)
def test_beside_a_name_no_more_is_believed_unseen(seed):
    """A zero off by 2 mrad explains 99 % of the mismatch; three times the noise is left, and no pose was come back to:
    the name describes part of it. Where poses were come back to it stands, and so it does beside less."""
    result = found_of(seed, 3.0, offset=2e-3)
    assert result.verdict == "unknown"
    assert result.describes_part
    assert [(finding.effect, finding.at) for finding in result.findings] == [("encoder_offset", (2,))]
    assert result.unknown is not None
    assert result.unknown.decide.startswith("visit some poses three times or more")
    for scatter, again in ((3.0, 2), (1.3, 1)):
        named = found_of(seed, scatter, again=again, offset=2e-3)
        assert named.verdict == "named"
        assert [(finding.effect, finding.at) for finding in named.findings] == [("encoder_offset", (2,))]
