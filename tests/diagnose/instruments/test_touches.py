"""Points and planes that are touched again, and nothing else measured: an independent arm goes there."""

import numpy as np
import pytest

from linkwright.core.diagnose.instruments.instrument import Instrument
from linkwright.core.diagnose.instruments.registry import slots_of
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.diagnose.arm_of_drives import jacobian
from tests.diagnose.recorded import planar_arm, planar_tip

PLANE = slots_of("plane")[0]

SIGMA = 15e-6
OFF = 6e-4


def _gone(goal, joint, count, seed, repeats=2):
    """Encoder readings (N, 3) at which the real arm, one zero off, is where `goal` (of tips (N, 2) and numbers of
    postures, what is still missing (N, k), and how that goes with the tip (k, 2)) says, but for noise."""
    rng = np.random.default_rng(seed)
    number = np.repeat(np.arange(count), repeats)
    q = np.repeat(rng.uniform(-1.2, 1.2, (count, 3)), repeats, axis=0)
    noise = SIGMA * rng.standard_normal((len(q), 2))
    zeros = OFF * (np.arange(3) == joint)
    for _ in range(60):
        missing, slope = goal(planar_tip(q + zeros) + noise, number)
        step = np.linalg.pinv(np.einsum("nkd,ndj->nkj", slope, jacobian(q + zeros)), rcond=1e-2)
        moved = np.einsum("njk,nk->nj", step, missing)
        q = np.clip(q - moved * np.minimum(1.0, 0.3 / (1e-12 + np.abs(moved).max(axis=1, keepdims=True))), -2.0, 2.0)
    good = np.abs(goal(planar_tip(q + zeros) + noise, number)[0]).max(axis=1) < 1e-9
    good &= np.bincount(number, weights=~good)[number] == 0
    return q[good], number[good]


def _recording(q, slots, touches, kind):
    count = int(touches.max()) + 1
    return Recording(
        "r.csv", q, np.zeros((len(q), len(slots))), np.arange(1, len(q) + 1), time=20.0 * np.arange(len(q)),
        slots=np.tile(slots, (len(q), 1)), touches=touches.astype(np.int64),
        instrument=Instrument((kind,), labels=tuple("abcdefgh"[:count])),
    )  # fmt: skip


def test_sockets_that_are_touched_from_many_postures_find_a_zero_and_not_that_of_joint_1():
    sockets = np.array([[0.75, 0.3], [0.5, -0.4], [0.7, -0.1]])
    q, number = _gone(lambda tip, n: (tip - sockets[n % 3], np.tile(np.eye(2), (len(tip), 1, 1))), 1, 60, 5)
    assert len(q) > 80
    result = diagnose(planar_arm(), _recording(q, (5, 6), number % 3, "same_point"))

    (finding,) = result.findings
    names = [(finding.effect, finding.at), *((other.effect, other.at) for other in finding.alternatives)]
    assert ("encoder_offset", (2,)) in names
    if finding.effect == "encoder_offset":
        low, high = finding.parameters[0].interval
        assert low < OFF < high
    assert result.noise_floor == pytest.approx(np.sqrt(2) * SIGMA, rel=0.25)
    assert result.rms_after == pytest.approx(np.sqrt(2) * SIGMA, rel=0.25)
    assert any("3 of the 3 ways" in note for note in result.notes)


def test_plates_that_are_touched_find_a_zero_and_not_how_the_arm_stands():
    normals, at = np.array([[0.1, 1.0], [1.0, -0.2], [0.6, 0.8]]), np.array([0.35, 0.6, 0.7])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)

    def goal(tip, n):
        normal = normals[n % 3]
        return (np.sum(tip * normal, axis=1) - at[n % 3])[:, None], normal[:, None]

    q, number = _gone(goal, 2, 75, 6)
    assert len(q) > 100
    result = diagnose(planar_arm(), _recording(q, (PLANE,), number % 3, "plane"))

    (finding,) = result.findings
    assert (finding.effect, finding.at) == ("encoder_offset", (3,))
    low, high = finding.parameters[0].interval
    assert low < OFF < high
    assert result.rms_after == pytest.approx(SIGMA, rel=0.2)
    assert ("encoder_offset", (1,)) in result.invisible


@pytest.mark.parametrize("joint", [0])
def test_a_zero_of_the_first_joint_moves_every_socket_alike(joint):
    sockets = np.array([[0.75, 0.3], [0.5, -0.4]])
    q, number = _gone(lambda tip, n: (tip - sockets[n % 2], np.tile(np.eye(2), (len(tip), 1, 1))), joint, 40, 9)
    result = diagnose(planar_arm(), _recording(q, (5, 6), number % 2, "same_point"))

    assert result.verdict == "none"
