"""What differs between logs of one arm: in which of them, how much, and by how much nothing else does."""

import numpy as np
import pytest

from linkwright.core.diagnose.motion.diagnosis import diagnose_motion
from linkwright.core.diagnose.motion.predict import predict_motion
from linkwright.core.diagnose.motion.uses.compare import compare_motion
from linkwright.core.diagnose.options import Options, silent
from tests.costs import slow_but
from tests.diagnose.motion.plumb_arm import HAND, NOISE, logged, plumb_arm

LOAD, DRY = 1.2, 0.8
"""What is taken at the tip between two logs (kg), and dry friction that one drive has in one log alone (N*m)."""


def held(more):
    """The hand and so much more, all the time."""
    return lambda time: np.full_like(time, HAND + more)


def smooth(_, v):
    """Nothing beside."""
    return np.zeros_like(v)


def rough(_, v):
    """Dry friction in the first joint."""
    return np.stack([DRY * np.sign(v[0]), np.zeros_like(v[1])])


def mass_of(finding):
    (mass,) = (item for item in finding.parameters if item.parameter == "mass")
    return mass


@pytest.mark.parametrize("loaded", slow_but([0, 1], 1))
def test_a_load_in_one_of_two_logs(tmp_path, loaded):
    """Whichever comes first; the interval holds the truth, and all else is within what noise makes."""
    logs = [logged(5 + k, held(LOAD if k == loaded else 0.0), smooth, f"{k}.csv") for k in range(2)]
    result = diagnose_motion(plumb_arm(tmp_path), logs)
    (finding,) = result.findings
    assert (result.verdict, finding.effect, finding.recording) == ("named", "payload", f"{loaded}.csv")
    mass = mass_of(finding)
    assert mass.interval[0] <= LOAD <= mass.interval[1]
    assert mass.value == pytest.approx(LOAD, rel=0.02)
    assert max(result.beyond) < NOISE
    assert f"in {loaded}.csv alone (mass 1.2 kg)" in result.sentence
    assert "Nothing else differs between the logs by more than" in result.sentence
    assert result.rms_before > 1.0
    assert max(result.rms_with_own) < NOISE
    assert [log.rms_with_own is None for log in result.of_logs] == [k != loaded for k in range(2)]
    # The file has no load: figures are what `predict` says of it.
    left = [predict_motion(result.corrected, log) for log in logs]
    squares, counts = np.square([item.rms for item in left]), np.array([item.samples for item in left])
    by_joint = np.sqrt((squares * counts).sum(axis=0) / counts.sum(axis=0))
    np.testing.assert_allclose([item.after for item in result.per_joint], by_joint, rtol=1e-9)
    assert result.rms_after == pytest.approx(np.sqrt(np.mean(by_joint**2)), rel=1e-9)


def test_two_of_three_logs_are_loaded(tmp_path):
    """The load stands with both, once."""
    logs = [logged(8 + k, held(LOAD if k else 0.0), smooth, f"{k}.csv") for k in range(3)]
    (finding,) = diagnose_motion(plumb_arm(tmp_path), logs).findings
    assert (finding.effect, finding.recording) == ("payload", "1.csv and 2.csv")
    assert mass_of(finding).value == pytest.approx(LOAD, rel=0.02)


def test_a_load_and_friction_in_one_log(tmp_path):
    """Both, each by its size, and a load that is less is one that the other log has."""
    logs = [logged(11, held(0.0), rough, "cold.csv"), logged(12, held(LOAD), smooth, "loaded.csv")]
    made = compare_motion(plumb_arm(tmp_path), logs[0], logs[1], Options(), silent)
    said = {(item.effect, item.recording) for item in made.together.findings}
    assert said == {("payload", "loaded.csv"), ("friction_coulomb", "cold.csv")}
    changed = {(item.effect, item.first.parameter): item.difference for item in made.changes if item.changed}
    assert changed["payload", "mass"] == pytest.approx(LOAD, rel=0.02)
    assert changed["friction_coulomb", "torque"] == pytest.approx(-DRY, rel=0.02)


def test_friction_in_both_logs_is_no_difference(tmp_path):
    """It is the arm's, as before."""
    logs = [logged(13 + k, held(0.0), rough, f"{k}.csv") for k in range(2)]
    result = diagnose_motion(plumb_arm(tmp_path), logs)
    assert [(item.effect, item.at, item.recording) for item in result.findings] == [("friction_coulomb", (1,), "")]
    assert max(result.beyond) < NOISE
    assert "Nothing else" not in result.sentence


def test_like_logs_do_not_differ(tmp_path):
    """Nothing is missing, and nothing differs."""
    result = diagnose_motion(plumb_arm(tmp_path), [logged(15 + k, held(0.0), smooth) for k in range(2)])
    assert (result.verdict, result.findings) == ("none", ())
    assert 0.0 < max(result.beyond) < NOISE


def test_what_is_small_beside_an_unknown_is_no_difference(tmp_path):
    """A bump of 1 N*m over the second joint's angle, which the library lacks, leaves more than dry friction that one
    log alone has: what differs may then be the bump's, which each log meets in its own way."""

    def more(dry):
        return lambda q, v: np.stack([np.exp(-(((q[1] - 0.3) / 0.25) ** 2)) + dry * np.sign(v[0]), np.zeros_like(v[1])])

    logs = [logged(17 + k, held(0.0), more(0.5 * k), f"{k}.csv") for k in range(2)]
    result = diagnose_motion(plumb_arm(tmp_path), logs)
    assert [item.effect for item in result.findings if item.recording] == []
    assert (result.verdict, result.unknown.joints, result.unknown.depends_on) == ("unknown", (1,), ("q2",))


@pytest.mark.parametrize("dry", slow_but([0.0, 0.8], 0.8))
def test_more_than_the_sensors_noise_is_never_nothing(tmp_path, dry):
    """1 N*m that goes with both joints' angles together and with neither alone, in one log or two."""

    def more(dry):
        return lambda q, v: np.stack([np.sin(5.3 * q[0] * q[1]) + dry * np.sign(v[0]), np.zeros_like(v[1])])

    logs = [logged(17 + k, held(0.0), more(dry * k), f"{k}.csv") for k in range(2)]
    for few in (logs[:1], logs):
        result = diagnose_motion(plumb_arm(tmp_path), few)
        assert (result.verdict, result.unknown.joints) == ("unknown", (1,))
