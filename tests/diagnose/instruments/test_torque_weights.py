"""Arms whose links weigh other than their file says, with torques: the file that is written has the weights they show.

Loads and tips are sums over plain matrices of a planar arm, with nothing of the code under test.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.diagnose.judge.predict import predict
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.steps.diagnosis import diagnose
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.sections.numeric import Array
from linkwright.output.diagnosis_folder import with_written

LENGTHS = np.array([0.5, 0.45, 0.3])
MASSES = np.array([9.0, 6.0, 2.5])
CENTRES = np.array([0.22, 0.2, 0.1])
COMPLIANCE = 2e-5
FRICTION = np.array([3.0, 2.0, 1.0])
NOISE = 10e-6
SUM = np.tril(np.ones((3, 3)))
"""From joints' angles to links' own."""


def load(q: Array, masses: Array, centres: Array, payload: Array) -> Array:
    """What weights turn the joints by (N, 3): the transposed Jacobians of links' centres and of the tip times them."""
    falling = -np.cos(q @ SUM.T)  # a link's end rises by its cosine, weights pull against it
    torque = np.zeros_like(q)
    for k in range(4):
        reach = np.diag([*LENGTHS[:k], *centres[k : k + 1], *np.zeros(2 - k)] if k < 3 else LENGTHS)
        weight = 9.80665 * (masses[k] if k < 3 else payload)
        torque += np.reshape(weight, (-1, 1)) * (falling @ reach @ SUM)
    return torque


def recorded(seed: int, masses: Array, centres: Array = CENTRES, heavier: float = 0.0) -> Recording:
    """Readings whose drive 2 gives, torques beside them; the payload is heavier than is recorded by a share."""
    rng = np.random.default_rng(seed)
    q = np.repeat(rng.uniform(-1.4, 1.4, (40, 3)), 2, axis=0)
    payload, side = (np.repeat(rng.choice(of, size), 2, axis=0) for of, size in (((0.0, 3.0), 40), ((-1, 1), (40, 3))))
    bent = q.copy()
    for _ in range(5):
        bent[:, 1] = q[:, 1] + COMPLIANCE * load(bent, masses, centres, (1.0 + heavier) * payload)[:, 1]
    angles = bent @ SUM.T
    tip = np.stack([np.cos(angles) @ LENGTHS, np.sin(angles) @ LENGTHS], axis=1)
    torque = side * FRICTION - load(bent, masses, centres, (1.0 + heavier) * payload)
    return Recording(
        "r.csv", q, tip + NOISE * rng.standard_normal(tip.shape), np.arange(1, len(q) + 1), payload_mass=payload,
        sides=side.astype(float), torque=torque + 0.05 * rng.standard_normal(q.shape),
    )  # fmt: skip


def file_arm() -> Arm:
    links = zip(LENGTHS.tolist(), MASSES.tolist(), CENTRES.tolist(), strict=True)
    return Arm(
        "as the file says",
        tuple(Joint(range=(-math.pi, math.pi)) for _ in LENGTHS),
        tuple(Link(length, mass=mass, center_of_mass=centre) for length, mass, centre in links),
        gravity=(0.0, -9.80665, 0.0),
    )


def test_loads_are_those_of_a_straight_arm() -> None:
    straight = load(np.zeros((1, 3)), MASSES, CENTRES, np.array([2.0]))
    assert straight[0, 2] == pytest.approx(-9.80665 * (2.5 * 0.1 + 2.0 * 0.3))
    assert straight[0, 0] == pytest.approx(-9.80665 * (9.0 * 0.22 + 6.0 * 0.7 + 2.5 * 1.05 + 2.0 * 1.25))


@pytest.mark.parametrize(
    ("masses", "centres"),
    [(1.4 * MASSES, CENTRES), pytest.param(MASSES, CENTRES + np.array([0.0, 0.05, 0.1]), marks=pytest.mark.slow)],
)
def test_the_written_file_has_the_weights_that_the_torques_show(masses: Array, centres: Array) -> None:
    recording = recorded(1, masses, centres)
    result = with_written(diagnose(file_arm(), recording), load_catalogue(user=False))

    (finding,) = result.findings
    assert (finding.effect, finding.at) == ("joint_compliance", (2,))
    low, high = finding.parameters[0].interval
    assert low < COMPLIANCE < high
    assert result.written is not None
    assert result.written.keeps(0.02)
    assert result.written.lacks == ()
    assert any("has the weights that the torques show" in note for note in result.notes)
    # A file that makes the right loads foretells other poses and payloads without their torques.
    other = replace(recorded(2, masses, centres), torque=None)
    assert predict(result.corrected, other).rms < 1.15 * math.sqrt(2.0) * NOISE
    if centres is CENTRES:
        written = np.array([link.mass for link in result.corrected.links])
        assert written == pytest.approx(masses, rel=0.02)
        assert [link.center_of_mass for link in result.corrected.links] == pytest.approx(CENTRES)


@pytest.mark.parametrize("heavier", [0.5, pytest.param(-12.0, marks=pytest.mark.slow)])
def test_a_payload_of_another_weight_than_recorded_loads_all_that_gives(heavier: float) -> None:
    """Half as heavy again, or pulling up by more than the links weigh: the drive is judged under what really hangs
    there, and the recording stays as it was written, so that what the file is worth on it is said."""
    arm, recording = file_arm(), recorded(1, MASSES, heavier=heavier)
    result = with_written(diagnose(arm, recording), load_catalogue(user=False))

    (finding,) = result.findings
    low, high = finding.parameters[0].interval
    assert low < COMPLIANCE < high
    assert any(f"the payload is {1.0 + heavier:.3g} times" in note for note in result.notes)
    assert any("is judged under the loads that the torques show" in note for note in result.notes)
    masses = [link.mass for link in result.corrected.links]
    assert masses == pytest.approx([link.mass for link in arm.links], rel=0.05)
    assert result.recording.payload_mass is not None
    assert set(result.recording.payload_mass.tolist()) == {0.0, 3.0}
    assert result.written is not None
    assert not result.written.keeps(0.02)
