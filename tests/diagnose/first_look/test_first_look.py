"""Recordings with one number of a joint wrong, torques clipped, speeds late: named with their size.

Tips are sums of cosines; torques those of two point masses by Lagrange's equations."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import butter, lfilter

from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.diagnose.columns.proposed_file import propose
from linkwright.core.diagnose.motion.reading.read import read_log
from linkwright.core.diagnose.reading.read import read_recording
from linkwright.core.diagnose.steps.diagnosis import diagnose
from linkwright.core.units.quantities import InputError
from tests.diagnose.motion.reading import test_conventions as logs
from tests.diagnose.recorded import planar_arm, planar_tip, poses, table, written


def refusal(path, arm):
    with pytest.raises(InputError) as refused:
        read_recording(path, arm)
    return str(refused.value)


def test_steps_per_degree_of_two_joints(tmp_path):
    """A SCARA whose first joint turns 1.361 times what is told, and whose second 0.948 times."""
    q = poses(50, joints=2)
    tip = planar_tip(q * [1.361, 0.948], (0.135, 0.125)) + np.random.default_rng(1).normal(0.0, 3e-4, (50, 2))
    line = refusal(written(tmp_path / "r.csv", table(q, tip)), planar_arm((0.135, 0.125)))
    assert "joint 1 turns 1.36" in line
    assert "joint 2 turns 0.94" in line
    (tmp_path / "r.yaml").write_text("columns: {q1_deg: 1.361*q1_deg, q2_deg: 0.948*q2_deg}\n")
    read_recording(tmp_path / "r.csv", planar_arm((0.135, 0.125)))


@pytest.mark.parametrize("part", [-0.25, 0.4])
def test_a_joint_that_the_one_before_takes_along(tmp_path, part):
    q = poses(50)
    meant = q + part * np.column_stack([np.zeros(50), q[:, 0], np.zeros(50)])
    line = refusal(written(tmp_path / "r.csv", table(q, planar_tip(meant))), planar_arm())
    assert f"joint 2 turns by {part:.3g} of q1_deg as well as by q2_deg" in line


def test_a_scale_and_a_sign_of_an_arm_with_as_many_joints_as_coordinates(tmp_path):
    """Units of two joints are as many as those of a tip in a plane: the look ends, and the recording is refused."""
    q = poses(12, joints=2)
    tip = planar_tip(q * [1.0, -1.0], (0.5, 0.4)) * [0.5, 1.0]
    assert "belong together" in refusal(written(tmp_path / "r.csv", table(q, tip)), planar_arm((0.5, 0.4)))


def soft_loop(*degrees):
    """20 N*m/rad under 13.7 N*m when level: poses, each twice; the joint stands where spring and weight agree."""
    commanded = np.repeat(np.radians(degrees), 2)
    at = commanded.copy()
    for _ in range(200):
        at = 0.5 * (at + commanded - 3.49 * 9.81 * 0.4 * np.cos(at) / 20.0)
    arm = Arm("loop", (Joint(),), (Link(0.6, mass=3.49, center_of_mass=0.4),), gravity=(0.0, -9.81, 0.0))
    return arm, commanded, at


def test_a_soft_position_loop(tmp_path):
    arm, commanded, at = soft_loop(-75.0, -60.0, -40.0, -20.0, 0.0, 20.0, 40.0)
    tip = 0.6 * np.stack([np.cos(at), np.sin(at)], axis=1) + np.random.default_rng(1).normal(0.0, 4e-4, (14, 2))
    line = refusal(written(tmp_path / "r.csv", table(commanded[:, None], tip)), arm)
    assert "joint 1 gives way by 0.0" in line
    stiffness = float(line.partition("`stiffness: ")[2].partition(" N*m/rad")[0])
    assert stiffness == pytest.approx(20.0, rel=0.01)


def test_commands_and_angles_tell_a_loops_droop_without_a_tip(tmp_path):
    arm, commanded, at = soft_loop(*range(-75, 46, 10))
    at = np.degrees(at + np.random.default_rng(1).normal(0.0, 1e-4, len(at)))
    rows = [f"{c:.5f},{q:.5f}" for c, q in zip(np.degrees(commanded), at, strict=True)]
    (tmp_path / "r.csv").write_text("\n".join(["c1_deg,q1_deg", *rows]) + "\n", encoding="utf-8")
    recording = read_recording(tmp_path / "r.csv", arm)
    assert any("No tip was recorded" in said for said in recording.warnings)
    (named,) = diagnose(arm, recording).findings
    assert named.effect == "servo_droop"
    assert named.parameters[0].value == pytest.approx(1.0 / 20.0, rel=0.005)


def test_a_unit_beside_a_sign(tmp_path):
    q = poses(50)
    line = refusal(written(tmp_path / "r.csv", table(q * [1.0, -1.0, 1.0], 0.1 * planar_tip(q))), planar_arm())
    assert "q2_deg counts the other way" in line
    assert "x_mm, y_mm seem to be in cm" in line


def test_clipped_torques_are_set_aside_and_counted(tmp_path):
    columns = logs.motion()
    limit = float(np.quantile(columns["tau1_Nm"], 0.8))
    clipped = columns["tau1_Nm"] > limit
    columns["tau1_Nm"] = np.minimum(columns["tau1_Nm"], limit)
    log = read_log(logs.written(tmp_path, columns), logs.arm())
    assert np.isnan(log.torque[:, 0]).sum() == clipped.sum()
    assert np.isfinite(log.torque[:, 1]).all()
    assert any("tau1_Nm is clipped at" in said and "set aside at joint 1" in said for said in log.warnings)


def test_values_of_a_coarse_sensor_are_not_clipped(tmp_path):
    columns = logs.motion()
    columns |= {name: np.round(columns[name]) for name in ("tau1_Nm", "tau2_Nm")}
    log = read_log(logs.written(tmp_path, columns), logs.arm())
    assert np.isfinite(log.torque).all()


def test_speeds_of_a_causal_filter(tmp_path):
    """A Butterworth low-pass of the second order is late by sqrt(2) over its angular frequency at low frequencies."""
    columns = logs.motion()
    b, a = butter(2, 2.0, fs=100.0)
    columns |= {name: lfilter(b, a, columns[name]) for name in ("dq1_radps", "dq2_radps")}
    log = read_log(logs.written(tmp_path, columns), logs.arm())
    assert log.velocity is None
    (said,) = (each for each in log.warnings if "lags the angles" in each)
    late = float(said.partition("dq1_radps lags the angles by ")[2].partition(" ms")[0])
    assert late == pytest.approx(1e3 * math.sqrt(2.0) / (math.tau * 2.0), rel=0.1)


def test_newton_millimetres_by_the_files_efforts(tmp_path):
    """Where the arm bears no weight, the efforts tell."""
    flat = replace(logs.arm(), gravity=(0.0, 0.0, -9.81), joints=tuple(Joint(effort=60.0) for _ in range(2)))
    columns = logs.motion()
    columns |= {name: 1e3 * columns[name] for name in ("tau1_Nm", "tau2_Nm")}
    with pytest.raises(InputError, match=r"N\*mm\?; write `columns: \{tau1_Nm: tau1_Nm/1000, tau2_Nm: tau2_Nm/1000\}`"):
        read_log(logs.written(tmp_path, columns), flat)


def test_pwm_in_place_of_current(tmp_path):
    """What goes with speed is no torque of weights: neither degrees nor another gravity are named for it."""
    columns = logs.motion()
    pwm = {f"current{k}_A": columns[f"dq{k}_radps"] + 0.02 * columns[f"tau{k}_Nm"] for k in (1, 2)}
    columns = {name: values for name, values in columns.items() if not name.startswith("tau")} | pwm
    log = read_log(logs.written(tmp_path, columns, "torque_constants: free\n"), logs.arm())
    assert log.size == 2000


def test_all_that_is_doubtful_a_line_each(tmp_path):
    columns = logs.motion()
    columns["tau2_Nm"] = np.minimum(columns["tau2_Nm"], np.quantile(columns["tau2_Nm"], 0.9))
    columns["tau1_Nm"] = -columns["tau1_Nm"]
    doubts = propose(logs.written(tmp_path, columns), logs.arm(), check=True).doubts
    assert doubts is not None
    assert [doubt.grade for doubt in doubts] == ["refused", "doubted"]
    assert "tau1_Nm counts the other way" in doubts[0].text
    assert "tau2_Nm is clipped" in doubts[1].text
