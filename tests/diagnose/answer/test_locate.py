"""Where the mismatch sits and what it depends on, before anything is named."""

from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.diagnose.answer.locate import dependences, depends_on, direction, joint_shares
from linkwright.core.diagnose.fitting.prepare import prepare
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.reading.read import read_recording
from linkwright.core.diagnose.residual.observe import observe
from tests.diagnose.arm_of_drives import SIGMA
from tests.diagnose.core_cases import noise_of, prepared_null, recorded, with_effects, with_residual
from tests.diagnose.made_diagnosis import made_arm
from tests.diagnose.recorded import planar_arm, planar_tip, table, written


@pytest.fixture(scope="module", params=[False, True], ids=["plane", "space"])
def null(request):
    return prepared_null(request.param, poses=24, sides="random", repeats=1)


def moved_by(prepared, values, size=1e-4):
    """A displacement along x (N, C) that goes with `values` (N,)."""
    moved = np.zeros(prepared.observed.residual.shape)
    moved[:, 0] = size * values
    return moved


@pytest.mark.parametrize("joint", [1, 2, 3])
@pytest.mark.parametrize("effect", ["encoder_offset", "encoder_scale", "gear_transmission_error"])
def test_the_joint_that_moves_has_the_largest_share(joint, effect):
    values = {
        "encoder_offset": {"offset": 2e-4},
        "encoder_scale": {"scale": 3e-4},
        "gear_transmission_error": {"sine": 2e-4, "order": 1.0},
    }[effect]
    arm = made_arm()
    true = with_effects(arm, (effect, (joint,), values))
    prepared = prepare(observe(arm, recorded(true, poses=20, noise=2e-6)), Options())
    shares = joint_shares(prepared)
    assert int(np.argmax(shares)) == joint - 1
    assert shares[joint - 1] > 0.9


def test_noise_has_no_joint(null):
    rng = np.random.default_rng(1)
    results = [joint_shares(with_residual(null, noise_of(null, rng))) for _ in range(20)]
    assert np.mean(results) < 0.03


def test_what_it_depends_on_is_found(null):
    rng = np.random.default_rng(2)
    # As simulated, one payload comes after the other: that is a step in time as well. Here they alternate.
    payload = 5.0 * (null.visits % 2)
    recording = replace(null.observed.recording, payload_mass=payload)
    null = replace(null, observed=replace(null.observed, recording=recording))
    time, sides = recording.time, recording.sides
    cases = {
        "payload_kg": recording.payload_mass / 5.0,
        "time": (time > np.median(time)).astype(float),
        "temperature_degC": (recording.temperature - 293.15) / 5.0,  # and a shift that all readings share
        "dir2": sides[:, 1],
        "q2": recording.q[:, 1],
    }
    for name, values in cases.items():
        trial = with_residual(null, noise_of(null, rng) + moved_by(null, values))
        result = dependences(trial, 0, np.random.default_rng(3))
        strongest = result[0]
        assert name in depends_on(result), name
        # What moves the tip with one coordinate goes with its position, too.
        assert strongest.on in ({name, "position"} if name == "q2" else {name}), name


def test_noise_depends_on_nothing(null):
    rng = np.random.default_rng(4)
    called = 0
    for seed in range(6):
        trial = with_residual(null, noise_of(null, rng))
        called += bool(depends_on(dependences(trial, 0, np.random.default_rng(seed))))
    assert called <= 1  # one in a hundred each


def test_direction(null):
    """Outward from the base, along the sweep, or along gravity."""
    observed = null.observed
    tip = np.stack([np.broadcast_to(x, (observed.rows,)) for x in observed.state.tip()], axis=1)
    assert direction(observed, np.zeros_like(observed.tip_residual())) is None
    flat = tip * [1.0, 1.0, 0.0]
    outward = flat / np.linalg.norm(flat, axis=1, keepdims=True)
    around = np.cross([0.0, 0.0, 1.0], outward)
    width = observed.components
    assert direction(observed, 1e-4 * outward[:, :width]) == "radial"
    assert direction(observed, -1e-4 * around[:, :width]) == "tangential"
    mixed = np.where(np.arange(len(tip))[:, None] % 2, outward, around)[:, :width]
    assert direction(observed, mixed) == "mixed"
    if width == 3:
        assert direction(observed, np.tile([0.0, 0.0, -1e-4], (observed.rows, 1))) == "vertical"


def test_columns_that_never_change_are_not_asked_about(null):
    recording = null.observed.recording
    still = replace(null.observed, recording=replace(recording, temperature=np.full(recording.size, 295.0)))
    trial = replace(null, observed=still)
    assert all(dependence.on != "temperature_degC" for dependence in dependences(trial, 0, np.random.default_rng(1)))


def test_a_pose_under_two_payloads_one_after_the_other_happened_once(tmp_path):
    """What is left differs from pose to pose, alike under both payloads: neither time nor the pose tells it."""
    q = np.repeat(np.random.default_rng(0).uniform(-1.2, 1.2, (24, 3)), 2, axis=0)
    tip = planar_tip(q) + SIGMA * np.random.default_rng(1).standard_normal((48, 2))
    columns = table(q, tip, time_s=8.0 * np.arange(48), payload_kg=np.tile([0.0, 1.0], 24))
    arm = planar_arm()
    prepared = prepare(observe(arm, read_recording(written(tmp_path / "r.csv", columns), arm)), Options())
    called = 0
    for seed in range(12):
        of_poses = np.repeat(np.random.default_rng(seed).standard_normal((24, 2)), 2, axis=0)
        trial = replace(prepared, vector=of_poses.reshape(-1))
        called += any(item.p_value < 0.05 for item in dependences(trial, 0, np.random.default_rng(seed)))
    assert called <= 3  # one in twenty is expected; five of twelve where each visit counts
