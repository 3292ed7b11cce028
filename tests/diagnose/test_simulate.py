"""Simulated recordings: what is in them is what was asked for, computed here by hand where that can be done."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pytest

from linkwright.command_line import outcome
from linkwright.core.arm.chain.chain import Arm, EffectEntry, LoadCase
from linkwright.core.diagnose.plan.simulate import Plan, simulate
from linkwright.core.diagnose.reading.read import read_recording
from linkwright.core.diagnose.reading.write import recording_text, settings_text
from linkwright.core.diagnose.residual.noise import noise_floor
from tests.diagnose.recorded import LENGTHS, planar_arm, planar_tip

ARM = planar_arm()


def with_effect(arm: Arm, effect: str, at: tuple[int, ...], **values: float) -> Arm:
    return replace(arm, effects=(EffectEntry(effect, at, MappingProxyType(values)),))


def test_an_encoder_offset_is_the_tip_of_the_turned_arm() -> None:
    result = simulate(
        with_effect(ARM, "encoder_offset", (2,), offset=1e-4), Plan(50, noise=0.0, repeats=1, sides="one")
    )
    q = result.recording.q
    turned = planar_tip(q + np.array([0.0, 1e-4, 0.0]))
    assert result.recording.tip == pytest.approx(turned, abs=1e-8)  # second order: 1e-8 rad^2 * 0.7 m / 2
    assert np.linalg.norm(result.recording.tip - planar_tip(q), axis=1).max() > 5e-5


def test_joint_compliance_gives_way_under_the_payload_of_each_row() -> None:
    arm = replace(with_effect(ARM, "joint_compliance", (2,), compliance=2e-5), payload=LoadCase(mass=1.0))
    result = simulate(arm, Plan(20, noise=0.0, repeats=1, payloads=(0.0, 5.0), sides="one"))
    read = result.recording
    assert read.payload_mass is not None
    first = LENGTHS[0] * np.stack([np.cos(read.q[:, 0]), np.sin(read.q[:, 0])], axis=1)
    lever = planar_tip(read.q) - first
    turn = np.zeros(read.size)
    for _ in range(30):
        # The load hangs where the joint has turned it to.
        turn = -2e-5 * 9.81 * read.payload_mass * (np.cos(turn) * lever[:, 0] - np.sin(turn) * lever[:, 1])
    across = np.stack([-lever[:, 1], lever[:, 0]], axis=1)
    by_hand = (np.cos(turn) - 1.0)[:, None] * lever + np.sin(turn)[:, None] * across
    assert result.error[:, :2] == pytest.approx(by_hand, abs=1e-10)
    assert set(read.payload_mass.tolist()) == {0.0, 5.0}
    for mass in (0.0, 5.0):
        assert len(np.unique(read.q[read.payload_mass == mass], axis=0)) == 20


def test_backlash_held_by_friction_changes_with_the_side() -> None:
    arm = with_effect(ARM, "backlash", (1,), total=1e-3, held_below=1e6)
    result = simulate(arm, Plan(15, noise=0.0, repeats=1, sides="both"))
    read = result.recording
    assert read.sides is not None
    assert read.size == 30
    assert (read.sides[0::2] == -read.sides[1::2]).all()
    assert read.q[0::2] == pytest.approx(read.q[1::2])
    turned = planar_tip(read.q - 0.5e-3 * read.sides * [1.0, 0.0, 0.0])
    assert read.tip == pytest.approx(turned, abs=3e-7)


def test_the_plan_is_kept() -> None:
    plan = Plan(40, repeats=4, payloads=(0.0, 2.0), sides="random", temperature=(293.15, 308.15), hours=6.0, seed=7)
    read = simulate(ARM, plan).recording
    assert read.size == 40 * 4 * 2
    assert read.time is not None
    assert read.temperature is not None
    assert read.time[-1] == pytest.approx(6 * 3600.0)
    assert (np.diff(read.time) > 0.0).all()
    assert (read.temperature.min(), read.temperature.max()) == pytest.approx((293.15, 308.15))
    # Wandering, not a line in time: warming and drift can be told apart.
    assert abs(np.corrcoef(read.time, read.temperature)[0, 1]) < 0.8
    low, high = (np.array([joint.range[end] for joint in ARM.joints]) for end in (0, 1))
    assert ((read.q >= low) & (read.q <= high)).all()
    # A low-discrepancy sequence leaves no quarter of a range empty.
    quarters = np.floor(4.0 * (read.q - low) / (high - low)).astype(int)
    assert all(set(quarters[:, k].tolist()) == {0, 1, 2, 3} for k in range(3))
    again = simulate(ARM, plan).recording
    assert (again.tip == read.tip).all()
    assert (simulate(ARM, replace(plan, seed=8)).recording.tip != read.tip).any()


def test_the_noise_is_what_was_asked_for() -> None:
    result = noise_floor(simulate(ARM, Plan(200, noise=25e-6, repeats=3)).recording, ARM)
    dof = 2 * 200 * 2
    assert result.degrees_of_freedom == dof
    assert np.array(result.sigma) ** 2 / 25e-6**2 == pytest.approx([1.0, 1.0], abs=4.5 * math.sqrt(2.0 / dof))


def test_outliers_are_as_many_and_as_far_as_asked() -> None:
    plan = Plan(300, noise=20e-6, repeats=1, sides="one", outliers=0.1)
    result = simulate(ARM, plan)
    off = np.linalg.norm(result.recording.tip - planar_tip(result.recording.q) - result.error[:, :2], axis=1)
    far = off > 6.0 * 20e-6
    assert 12 <= far.sum() <= 52  # 30 +- 4.3 standard deviations
    assert off.max() < 56.0 * 20e-6


@pytest.mark.parametrize("free", [False, True])
def test_written_and_read_it_is_the_same(tmp_path: Path, free: bool) -> None:
    plan = Plan(
        12, payloads=(0.0, 1.5), temperature=(290.0, 300.0), free_frame=free, joint_side=True, commands=True,
        base_target=True,
    )  # fmt: skip
    made = replace(simulate(ARM, plan).recording, sigma=15e-6)
    (tmp_path / "r.csv").write_text(recording_text(made, ARM))
    (tmp_path / "r.yaml").write_text(settings_text(made))
    read = read_recording(tmp_path / "r.csv", ARM)
    assert (read.sigma, read.frame, read.tool) == (15e-6, made.frame, "known")
    for name in ("q", "tip", "time", "sides", "payload_mass", "temperature", "joint_side", "commanded", "base_target"):
        close = 1e-4 if name == "temperature" else 2e-8
        assert getattr(read, name) == pytest.approx(getattr(made, name), abs=close), name
    assert read.rejected == ()


def test_an_effect_that_no_column_shows_is_called_idle() -> None:
    arm = with_effect(ARM, "thermal_expansion", (1,), expansion=23e-6)
    assert simulate(arm, Plan(5)).idle == ("thermal_expansion",)
    assert simulate(arm, Plan(5, temperature=(293.15, 313.15))).idle == ()


ARM_FILE = """
name: test
chain:
  - joint: {type: revolute, range: [-90 deg, 90 deg]}
    link: {length: 400 mm, rigid: true, mass: 2 kg}
  - joint: {type: revolute, range: [-90 deg, 90 deg]}
    link: {length: 300 mm, rigid: true, mass: 1 kg}
payload: {mass: 2 kg}
"""


def run(tmp_path: Path, *arguments: str) -> int:
    (tmp_path / "arm.yaml").write_text(ARM_FILE)
    return outcome(["simulate", str(tmp_path / "arm.yaml"), "--out", str(tmp_path / "out.csv"), *arguments])


def test_the_command_writes_a_recording_that_is_read_again(tmp_path: Path) -> None:
    effect = "{effect: joint_compliance, at: 2, compliance: 21 urad/(N*m)}"
    arguments = ("--poses", "10", "--with", effect, "--payloads", "0 kg, 5 kg", "--declare-sigma", "--noise", "20 um")
    assert run(tmp_path, *arguments) == 0
    from linkwright.core.arm.files.read import read_arm

    read = read_recording(tmp_path / "out.csv", read_arm(tmp_path / "arm.yaml"))
    assert read.size == 10 * 2 * 2 * 3
    assert (read.sigma, read.rejected) == (20e-6, ())
    assert run(tmp_path, *arguments) == 0  # a simulation's own files may be written again


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--with", "{effect: joint_complianc, at: 2}"), "did you mean 'joint_compliance'"),
        (("--with", "{effect: joint_compliance, at: 2, compliance: 21}"), "effects[1].compliance: needs a unit"),
        (("--with", "{effect: joint_compliance, at: 3, compliance: 21 urad/(N*m)}"), "from 1 to 2"),
        (("--with", "joint_compliance"), "needs an entry such as"),
        (("--with", "{effect: "), "--with"),
        (("--noise", "15"), "needs a unit"),
        (("--payloads", "0 kg, x"), "--payloads"),
        (("--payloads", "-1 kg"), "negative"),
        (("--sides", "left"), "both, one, random"),
        (("--temperature", "20 degC to 30 degC to 40 degC"), "needs two"),
        (("--repeats", "1000", "--poses", "999999"), "at most"),
    ],
)
def test_wrong_input_is_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: tuple[str, ...], said: str
) -> None:
    poses = () if "--poses" in arguments else ("--poses", "5")
    assert run(tmp_path, *poses, *arguments) == 2
    errors = capsys.readouterr().err
    assert said in errors
    assert errors.count("\n") == 1
    assert not (tmp_path / "out.csv").exists()


def test_nobody_elses_files_are_written_over(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "out.yaml").write_text("minimize: mass\n")
    assert run(tmp_path, "--poses", "5") == 2
    assert "holds more" in capsys.readouterr().err
    assert outcome(["simulate", str(tmp_path / "arm.yaml"), "--poses", "5", "--out", str(tmp_path / "arm.csv")]) == 2
    assert (tmp_path / "arm.yaml").read_text() == ARM_FILE
