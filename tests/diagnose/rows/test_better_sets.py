"""A name that was taken early gives way to two that only together explain more: a cobot of rigid links of which two
drives give and whose axes are all a little askew, by chains of plain matrices and sums of moments."""

import itertools

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.residual.observed import rms_length
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.arm.rows.matrices import QUARTER, arm_of
from tests.costs import slow_but

ROWS = [
    (0.0, 0.1625, QUARTER, 0.0),
    (-0.425, 0.0, 0.0, 0.0),
    (-0.3922, 0.0, 0.0, 0.0),
    (0.0, 0.1333, QUARTER, 0.0),
    (0.0, 0.0997, -QUARTER, 0.0),
    (0.0, 0.0996, 0.0, 0.0),
]
MASSES = (4.0, 8.0, 2.3, 1.3, 1.3, 0.4)
GIVES = {1: 25e-6, 2: 50e-6}
"""rad/(N m) of drives 2 and 3."""
SIGMA = 4e-5


def frames(rows, askew, q):
    """Of each joint its axis and where it stands, and the tip."""
    turn, at, axes, places = Rotation.identity(), np.zeros(3), [], [np.zeros(3)]
    for (a, d, alpha, theta), (tilt, length), angle in zip(rows, askew, q, strict=True):
        axes.append(turn.as_matrix()[:, 2])
        turn = turn * Rotation.from_euler("z", angle + theta)
        at = at + turn.apply([a + length[0], 0.0, d + length[1]])
        turn = turn * Rotation.from_euler("x", alpha + tilt[0]) * Rotation.from_euler("y", tilt[1])
        places.append(at)
    return axes, places


def tip(askew, q):
    axes, places = frames(ROWS, askew, q)
    middles = [0.5 * (one + other) for one, other in itertools.pairwise(places)]
    wound = np.array(q)
    for joint, compliance in GIVES.items():
        moment = sum(
            np.cross(middle - places[joint], [0.0, 0.0, -9.81 * mass])
            for middle, mass in zip(middles[joint:], MASSES[joint:], strict=True)
        )
        wound[joint] += compliance * (axes[joint] @ moment)
    return frames(ROWS, askew, wound)[1][-1]


def recorded(rng, askew, poses):
    q = rng.uniform(-2.0, 2.0, (poses, 6))
    seen = np.array([tip(askew, angles) for angles in q])
    seen = seen + SIGMA * rng.standard_normal(seen.shape)
    return Recording("drawn", q, seen, np.arange(1, poses + 1), frame="free", tool="free")


@pytest.mark.parametrize("seed", slow_but(range(5), 2))
def test_two_drives_are_no_bent_link(seed, tmp_path):
    rng = np.random.default_rng([seed, 3])
    askew = [(rng.normal(0.0, 8e-4, 2), rng.normal(0.0, 3e-4, 2)) for _ in ROWS]
    arm = arm_of(ROWS, tmp_path, modified=False, masses=MASSES)
    result = diagnose(arm, recorded(rng, askew, 60))
    gives = [finding for finding in result.findings if EFFECTS[finding.effect].cause != "geometry"]
    assert {(finding.effect, finding.at) for finding in gives} == {
        ("joint_compliance", (2,)),
        ("joint_compliance", (3,)),
    }
    left = rms_length(observe(result.corrected, recorded(rng, askew, 60)).tip_residual())
    assert left < 1.1 * 3.0**0.5 * SIGMA
