"""Motion logs from tables: what is read, what is said, what is set aside, what is refused in one line."""

import math
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.diagnose.motion.log import CURRENT
from linkwright.core.diagnose.motion.reading.read import is_motion_log, read_log
from linkwright.core.diagnose.motion.written import settings_text
from linkwright.core.units.quantities import InputError


def two_joints() -> Arm:
    return Arm("planar", (Joint(), Joint()), (Link(0.4, mass=4.0), Link(0.3, mass=2.0)))


def moving(count: int = 400, rate: float = 100.0, seed: int = 2) -> dict[str, np.ndarray]:
    """A log of two joints by the contract, in rad and N*m."""
    time = np.arange(count) / rate
    q = np.stack([np.sin(1.3 * time), 0.7 * np.cos(2.1 * time)], axis=1)
    speed = np.stack([1.3 * np.cos(1.3 * time), -0.7 * 2.1 * np.sin(2.1 * time)], axis=1)
    noise = np.random.default_rng(seed).normal(0.0, 0.05, (count, 2))
    torque = np.stack([9.81 * np.cos(q[:, 0]), 2.9 * np.cos(q.sum(axis=1))], axis=1) + np.sign(speed) + noise
    columns = {"t_s": time}
    for k in range(2):
        columns |= {f"q{k + 1}_rad": q[:, k], f"dq{k + 1}_radps": speed[:, k], f"tau{k + 1}_Nm": torque[:, k]}
    return columns


def written(folder: Path, columns: dict, settings: str = "") -> Path:
    path = folder / "log.csv"
    rows = zip(*columns.values(), strict=True)
    cells = [",".join(item if isinstance(item, str) else f"{item:.9g}" for item in row) for row in rows]
    path.write_text("\n".join([",".join(columns), *cells]) + "\n", encoding="utf-8")
    if settings:
        (folder / "recording.yaml").write_text(settings, encoding="utf-8")
    return path


def refused(path: Path, arm: Arm | None = None) -> str:
    with pytest.raises(InputError) as caught:
        read_log(path, arm or two_joints())
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_a_log_by_the_contract(tmp_path):
    columns = moving()
    log = read_log(written(tmp_path, columns), two_joints())
    assert log.warnings == ()
    assert log.rejected == ()
    assert log.q[:, 1] == pytest.approx(columns["q2_rad"], abs=1e-8)
    assert log.velocity is not None
    assert log.velocity[:, 0] == pytest.approx(columns["dq1_radps"], abs=1e-8)
    assert log.torque[:, 1] == pytest.approx(columns["tau2_Nm"], abs=1e-7)
    assert log.time[-1] == pytest.approx(3.99)


def test_degrees_and_our_other_spellings(tmp_path):
    columns = moving()
    named = {"time_s": columns["t_s"] + 1e5}
    for k in (1, 2):
        named[f"q{k}_deg"] = np.degrees(columns[f"q{k}_rad"])
        named[f"v{k}_deg_s"] = np.degrees(columns[f"dq{k}_radps"])
        named[f"tau{k} [N*m]"] = columns[f"tau{k}_Nm"]
    log = read_log(written(tmp_path, named), two_joints())
    assert log.time[0] == 0.0
    assert log.q[:, 0] == pytest.approx(columns["q1_rad"], abs=1e-7)
    assert log.velocity is not None
    assert log.velocity[:, 1] == pytest.approx(columns["dq2_radps"], abs=1e-7)


def test_currents_with_known_and_with_free_constants(tmp_path):
    columns = moving()
    constants = {1: 14.9, 2: 11.0}
    named = {name: values for name, values in columns.items() if "tau" not in name}
    named |= {f"current{k}_A": columns[f"tau{k}_Nm"] / constants[k] for k in constants}
    path = written(tmp_path, named, "observes: motion\ntorque_constants: [14.9, 11 N*m/A]\n")
    log = read_log(path, two_joints())
    assert log.drive is CURRENT
    assert not log.torque_constants_free
    assert log.torque[:, 0] == pytest.approx(columns["tau1_Nm"], rel=1e-6)
    for settings in ("observes: motion\n", "torque_constants: free\n"):
        free = read_log(written(tmp_path, named, settings), two_joints())
        assert free.torque_constants_free
        assert free.torque[:, 0] == pytest.approx(named["current1_A"], rel=1e-6)
        assert any("torque_constants" in warning for warning in free.warnings) == (settings == "observes: motion\n")


def test_gear_ratios_say_that_torques_are_of_the_motor(tmp_path):
    columns = moving()
    named = dict(columns) | {f"tau{k}_Nm": columns[f"tau{k}_Nm"] / 100.0 for k in (1, 2)}
    log = read_log(written(tmp_path, named, "observes: motion\ngear_ratios: [100, 100]\n"), two_joints())
    assert log.torque[:, 0] == pytest.approx(columns["tau1_Nm"], rel=1e-6)


def test_encoders_sit_on_the_motors_side_unless_settings_say_else(tmp_path):
    for side, beyond in (("", False), ("encoders: motor\n", False), ("encoders: joint\n", True)):
        log = read_log(written(tmp_path, moving(), f"observes: motion\n{side}"), two_joints())
        assert log.beyond_drive == beyond
        assert ("encoders: joint\n" in settings_text(log)) == beyond


def test_settings_of_a_motion_log(tmp_path):
    settings = "observes: motion\nfilter: {cutoff: 8 Hz}\nsigma: [0.5 N*m, 0.2]\nunit: serial 7\ndate: 2026-05-16\n"
    log = read_log(written(tmp_path, moving(), settings), two_joints())
    assert (log.cutoff, log.sigma, log.unit, log.date) == (8.0, (0.5, 0.2), "serial 7", "2026-05-16")


@pytest.mark.parametrize(
    ("settings", "says"),
    [
        ("observes: [motion, position]\n", "has others beside motion"),
        ("observes: motion\ntorque_constants: [1, -2]\n", "must be positive"),
        ("observes: motion\nsigma: [1, 2, 3]\n", "has 3 numbers"),
        ("observes: motion\ngear_ratios: [100, 100, 50]\n", "has 3 numbers"),
        ("observes: motion\nfilter: {cutof: 8 Hz}\n", "cutoff"),
        ("observes: along\ndirection: [0, 0, 1]\ngear_ratios: [100]\n", "goes with `observes: motion`"),
        ("observes: motion\nencoders: links\n", "encoders"),
        ("observes: motion\ntorque_constants: []\n", "is an empty list"),
    ],
)
def test_settings_that_cannot_be(tmp_path, settings, says):
    assert says in refused(written(tmp_path, moving(), settings))


def test_what_is_a_motion_log(tmp_path):
    columns = moving()
    arm = two_joints()
    assert is_motion_log(written(tmp_path, columns), arm)
    assert is_motion_log(written(tmp_path, columns, "observes: position\n"), arm)
    tip = {"x_mm": columns["t_s"], "y_mm": columns["t_s"]}
    assert not is_motion_log(written(tmp_path, columns | tip), arm)
    assert is_motion_log(written(tmp_path, columns | tip, "observes: motion\n"), arm)
    assert not is_motion_log(written(tmp_path, columns, "observes: along\ndirection: [0, 0, 1]\n"), arm)
    (tmp_path / "recording.yaml").unlink()
    without_torque = {name: values for name, values in columns.items() if "tau" not in name}
    assert not is_motion_log(written(tmp_path, without_torque), arm)


def test_missing_speeds_and_a_drive_that_was_not_logged(tmp_path):
    columns = {name: values for name, values in moving().items() if "dq" not in name and name != "tau1_Nm"}
    log = read_log(written(tmp_path, columns), two_joints())
    assert log.velocity is None
    assert np.isnan(log.torque[:, 0]).all()
    assert np.isfinite(log.torque[:, 1]).all()
    assert any("no speeds" in warning for warning in log.warnings)
    assert any("no torque of joint 1" in warning for warning in log.warnings)


def test_a_drive_that_never_changes_counts_as_not_logged(tmp_path):
    log = read_log(written(tmp_path, moving() | {"tau1_Nm": np.full(400, 3.0)}), two_joints())
    assert np.isnan(log.torque[:, 0]).all()
    assert any("tau1_Nm never changes" in warning for warning in log.warnings)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda c: c | {"tau1_Nm": np.full(400, 3.0), "tau2_Nm": np.zeros(400)}, "tau1_Nm, tau2_Nm: never change"),
        (lambda c: c | {f"q{k}_rad": c[f"q{k}_rad"] * 1e-4 + 0.3 for k in (1, 2)}, "is a log at rest"),
        (lambda c: c | {"t_s": c["t_s"][::-1]}, "t_s: runs backwards"),
        (lambda c: c | {"t_s": np.concatenate([c["t_s"][:200], c["t_s"][:200]])}, "several logs, or two robots"),
        (lambda c: c | {"t_s": np.zeros(400)}, "t_s: stands still: the log has no clock"),
        (lambda c: c | {"t_s": c["t_s"] * 1e9}, "another unit (ms, us, ns)"),
        (lambda c: c | {"q3_rad": c["q2_rad"]}, "is of joint 3, but 'planar' has 2 joints"),
        (
            lambda c: {name: item for name, item in c.items() if name[:2] != "q2"},
            "q2: is missing: 'planar' has 2 joints",
        ),
        (lambda c: {name: item for name, item in c.items() if name != "t_s"}, "t_s: is missing"),
        (lambda c: {name: item for name, item in c.items() if "tau" not in name}, "tau1_Nm: is missing"),
        (lambda c: {name: item[:8] for name, item in c.items()}, "has 8 samples that can be used"),
        (lambda c: c | {"payload_kg": np.full(400, 2000.0)}, "payload_kg: reaches 2000 kg where the arm weighs 6 kg"),
        (lambda c: c | {"q1_rad": ["a"] * 400}, "log.csv: q1_rad: holds no numbers in most samples"),
    ],
)
def test_what_is_refused_in_one_line(tmp_path, change, says):
    assert says in refused(written(tmp_path, change(moving())))


@pytest.mark.parametrize("stamps", ["shared", "own"])
def test_two_robots_in_one_file(tmp_path, stamps):
    one, other = moving(seed=2), moving(seed=3)
    other = {name: values + (0.9 if name[0] == "q" else 0.0) for name, values in other.items()}
    if stamps == "own":
        other["t_s"] = other["t_s"] + 0.004
    both = {name: np.stack([one[name], other[name]], axis=1).ravel() for name in one}
    assert "are these two robots in one file?" in refused(written(tmp_path, both))


def test_a_log_with_faults_keeps_the_rest_and_says_what_went(tmp_path):
    columns = {name: [f"{value:.9g}" for value in values] for name, values in moving().items()}
    columns["q1_rad"][50] = "1e282"
    columns["tau2_Nm"][70] = ""
    columns["tau1_Nm"][90] = "65"
    columns["q2_rad"][110] = "nan"
    columns["t_s"][130] = columns["t_s"][129]
    columns["t_s"][150] = "0.1"
    path = written(tmp_path, columns)
    lines = path.read_text(encoding="utf-8").splitlines()
    path.write_text("\n".join([*lines[:300], *lines[340:-1], lines[-1][:20]]), encoding="utf-8")
    log = read_log(path, two_joints())
    reasons = {item.row: item.reason for item in log.rejected}
    assert "beyond anything measured" in reasons[52]
    assert reasons[72] == "tau2_Nm is blank"
    assert reasons[92] == "tau1_Nm jumps for this one sample"
    assert reasons[112] == "q2_rad is nan"
    assert reasons[132] == "t_s is that of row 131 again"
    assert "runs backwards" in reasons[152]
    assert "cells where the header has 7" in reasons[361]
    assert log.size == 353
    assert (np.diff(log.time) > 0.0).all()
    assert np.isfinite(log.q).all()
    assert np.isfinite(log.torque).all()
    assert any("1 gap, the longest of 0.41 s after row 300" in warning for warning in log.warnings)
    assert any("stamps that occur twice (row 132)" in warning for warning in log.warnings)


def test_jitter_is_said(tmp_path):
    columns = moving()
    shifts = np.random.default_rng(1).uniform(-0.004, 0.004, 400)
    log = read_log(written(tmp_path, columns | {"t_s": columns["t_s"] + shifts}), two_joints())
    assert any("t_s jitters" in warning for warning in log.warnings)


def test_friction_that_changes_its_sign_is_no_spike(tmp_path):
    """Steps of torque and stops of the arm stay: nothing of them is a logger's fault."""
    columns = moving()
    step = 8.0 * np.sign(columns["dq1_radps"]) + np.where(columns["t_s"] > 2.0, 20.0, 0.0)
    log = read_log(written(tmp_path, columns | {"tau1_Nm": columns["tau1_Nm"] + step}), two_joints())
    assert log.rejected == ()


def test_what_a_motion_or_noise_may_make_is_no_spike(tmp_path):
    """A torque to and fro, and single samples beyond the noise that are small beside the torque's or angle's range."""
    columns = {name: values.copy() for name, values in moving().items()}
    columns["tau1_Nm"][[100, 101]] += (40.0, -40.0)
    columns["tau1_Nm"][200] += 0.9
    columns["q1_rad"][121] += 0.01
    assert read_log(written(tmp_path, columns), two_joints()).rejected == ()


def test_slides_are_in_metres_and_newtons(tmp_path):
    arm = Arm("slide", (Joint("prismatic", (1.0, 0.0, 0.0), (0.0, 2.0)),), (Link(0.3, mass=2.0),))
    columns = moving()
    named = {"t_s": columns["t_s"], "q1_mm": 1e3 * columns["q1_rad"], "tau1_N": columns["tau1_Nm"]}
    log = read_log(written(tmp_path, named), arm)
    assert log.q[:, 0] == pytest.approx(columns["q1_rad"], abs=1e-6)
    assert math.isfinite(log.torque.sum())
