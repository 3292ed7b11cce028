"""What no entry of the library explains is called unknown, with what it depends on and since when."""

from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.diagnose.steps.diagnosis import diagnose
from linkwright.output.diagnosis_folder import compensated
from tests.diagnose.core_cases import SIGMA, pushed, recorded
from tests.diagnose.made_diagnosis import made_arm

PLAN = {"poses": 16, "sides": "one"}


def null(space=False, **changed):
    arm = made_arm(space)
    return arm, recorded(arm, **{**PLAN, **changed})


@pytest.mark.parametrize("space", [False, pytest.param(True, marks=pytest.mark.slow)], ids=["plane", "space"])
def test_a_step_in_time(space):
    """Something slips: the tip is shifted from one visit on."""
    arm, recording = null(space)
    start = 2 * 20  # visits of two readings
    shift = np.zeros_like(recording.tip)
    shift[start:, 0] = 5.0 * SIGMA
    result = diagnose(arm, replace(recording, tip=recording.tip + shift))
    assert result.verdict == "unknown"
    assert result.unknown.depends_on[0] == "time"
    assert recording.time[start - 2] < result.unknown.since <= recording.time[start + 1]
    assert result.where.since == result.unknown.since
    assert result.unknown.amplitude == pytest.approx(5.0 * SIGMA * np.sqrt((len(shift) - start) / len(shift)), rel=0.35)
    assert result.rms_after < 1.15 * result.noise_floor


def test_no_more_is_unexplained_than_there_is():
    """A joint that is off by its own coordinate moves the tip by more than is seen where frame and tool are fitted."""
    arm, recording = null()
    turned = 8.0 * SIGMA * (recording.q[:, 1] + 1.0) ** 2
    moved = turned[:, None] * np.stack([-recording.tip[:, 1], recording.tip[:, 0]], axis=1)
    result = diagnose(arm, replace(recording, tip=recording.tip + moved, frame="free", tool="free"))
    assert result.verdict == "unknown"
    assert 0.9 * result.rms_before < result.unknown.amplitude <= result.rms_before


@pytest.mark.slow
def test_a_long_recording_is_described_at_all_of_its_readings():
    """Of a long recording some visits are searched; what a controller takes off is told at every reading."""
    arm, recording = null()
    field = 8.0 * SIGMA * np.sin(2.0 * recording.q[:, :1]) * np.cos(3.0 * recording.q[:, 1:2]) * np.array([[1.0, 0.4]])
    rules = replace(RULES, search=replace(RULES.search, longest=int(0.6 * recording.tip.size)))
    result = diagnose(arm, replace(recording, tip=recording.tip + field), Options(rules=rules))
    assert result.verdict == "unknown"
    assert len(result.unknown.predicted) == len(result.residual_after)
    assert len(compensated(result)) == len(result.residual_after)


@pytest.mark.slow
def test_a_joint_that_slips():
    """The zero of encoder 2 moves: a step in time again, and not an offset."""
    arm, recording = null()
    start = 2 * 19
    turned = recorded(replace(arm, joints=(arm.joints[0], replace(arm.joints[1], zero=3e-4), arm.joints[2])), **PLAN)
    tip = np.where(np.arange(recording.size)[:, None] >= start, turned.tip, recording.tip)
    result = diagnose(arm, replace(recording, tip=tip))
    assert result.verdict == "unknown"
    assert "time" in result.unknown.depends_on
    assert recording.time[start - 2] < result.unknown.since <= recording.time[start + 1]
    assert result.where.joint == 2


@pytest.mark.slow
def test_a_spring_to_a_fixed_point():
    """A hose that pulls towards a hook, through drives and links that give."""
    arm, recording = null()
    rng = np.random.default_rng(1)
    away = np.column_stack([recording.tip - [1.4, 0.9], np.zeros(recording.size)])
    result = diagnose(arm, pushed(arm, recording, -60.0 * away, rng))
    assert result.verdict == "unknown"
    assert "position" in result.unknown.depends_on
    assert "spring" in result.unknown.shape or "force" in result.unknown.shape or "pull" in result.unknown.shape
    assert result.unknown.since is None
    assert result.rms_after < 1.3 * result.noise_floor
    assert result.unknown.rejected


def test_a_force_field():
    """A magnet: strong near one place and nothing elsewhere."""
    arm, recording = null(poses=40, payloads=())
    rng = np.random.default_rng(2)
    away = np.column_stack([recording.tip - [0.7, 0.5], np.zeros(recording.size)])
    strength = 80.0 * np.exp(-np.sum(away**2, axis=1) / 0.3**2)
    toward = -away / np.maximum(np.linalg.norm(away, axis=1), 0.02)[:, None]
    result = diagnose(arm, pushed(arm, recording, strength[:, None] * toward, rng))
    assert result.verdict == "unknown"
    assert "time" not in result.unknown.depends_on
    assert result.unknown.rejected


@pytest.mark.slow
def test_a_periodic_term():
    """A machine next door, or the sun: it comes and goes."""
    arm, recording = null()
    wave = np.zeros_like(recording.tip)
    wave[:, 1] = 5.0 * SIGMA * np.sin(2.0 * np.pi * recording.time / 137.0)
    result = diagnose(arm, replace(recording, tip=recording.tip + wave))
    assert result.verdict == "unknown"
    assert result.unknown.depends_on[0] == "time"
    assert "periodic" in result.unknown.shape
    assert result.rms_after < 1.15 * result.noise_floor


@pytest.mark.slow
def test_forms_and_the_smooth_model_are_judged_on_held_out_rows():
    """The force that grows across the workspace is predicted in parts of it that were not fitted."""
    arm, recording = null(poses=80, payloads=(), repeats=1, sides="one", temperature=None)
    rng = np.random.default_rng(3)
    place = recording.tip[:, 0] - 0.5
    force = np.column_stack([np.zeros(recording.size), 60.0 * place**2, np.zeros(recording.size)])
    made = pushed(arm, recording, force, rng)
    result = diagnose(arm, made)
    assert result.verdict == "unknown"
    assert result.unknown.forms[0].share_held_out > 0.9
    assert 0.0 < result.unknown.held_out_share < 1.0
    kept = np.isin(recording.row, result.recording.row)
    truth = (made.tip - recording.tip)[kept]
    missed = result.unknown.predicted - truth
    # 80 poses are few for a process over three joints and time; better than nothing it is (its own tests say more).
    assert np.sum(missed**2) < 0.8 * np.sum(truth**2)


@pytest.mark.slow
def test_what_no_form_tells_half_of_is_nothing_simple():
    """Waves over products of the angles, which repeats confirm; a region of the workspace comes nearest."""
    arm, recording = null()
    q, wave = recording.q, np.zeros_like(recording.tip)
    wave[:, 0] = 8.0 * SIGMA * np.sin(3.0 * q[:, 0] * q[:, 2])
    wave[:, 1] = 8.0 * SIGMA * np.cos(3.0 * q[:, 1] * (q[:, 0] + 1.0))
    result = diagnose(arm, replace(recording, tip=recording.tip + wave))
    assert result.verdict == "unknown"
    assert max(form.share_held_out for form in result.unknown.forms) < 0.5
    assert result.unknown.shape.startswith("nothing simple (nearest comes: ")
