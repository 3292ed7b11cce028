"""Torque, speed, power and energy of drives along a motion: against mechanics done by hand."""

import csv
import json
from dataclasses import replace

import numpy as np
import pytest

import linkwright as lw
from linkwright.cli import run
from linkwright.core.arm.chain.chain import Arm, EffectEntry, Joint, Link
from linkwright.core.arm.motion.dynamics import loads_of
from linkwright.core.arm.motion.motion import Motion
from tests.arm.builders import rod_lines

ROD = Arm("rod", (Joint(),), (Link(0.8, mass=3.0, center_of_mass=0.8),), gravity=(0.0, 0.0, 0.0))
TIME = np.linspace(0.0, 2.0 * np.pi, 4001)


def swinging(arm):
    """Once there and back, by 0.5 rad."""
    wide = 0.5
    columns = (wide * np.sin(TIME), wide * np.cos(TIME), -wide * np.sin(TIME))
    return Motion(arm, TIME, *(column[:, None] for column in columns))


def test_what_an_arm_without_friction_takes_it_gives_back():
    """A slender rod of a mass at 0.8 m: J = m l^2 (1 + 1/12), of an energy J w^2/2 four times in a period."""
    (result,) = loads_of(swinging(ROD))
    inertia = 3.0 * 0.8**2 * (1.0 + 1.0 / 12.0)
    ball = 0.4 * 3.0 * (3.0 * 3.0 / (4.0 * np.pi * 7850.0)) ** (2.0 / 3.0)
    inertia += ball
    assert result.torque == pytest.approx(0.5 * inertia, rel=1e-6)
    assert result.rms_torque == pytest.approx(0.5 * inertia / np.sqrt(2.0), rel=1e-6)
    assert result.speed == pytest.approx(0.5)
    assert result.power == pytest.approx(0.25 * inertia / 2.0, rel=1e-6)
    assert result.energy == pytest.approx(2.0 * 0.5 * inertia * 0.25, rel=1e-6)
    assert result.braked == pytest.approx(result.energy, rel=1e-6)


def test_the_friction_that_is_there_counts():
    """It takes 4 N*m over a way of 2 rad, and nobody gives that back."""
    rubs = replace(ROD, effects=(EffectEntry("friction_coulomb", (), {"torque": 4.0}),))
    (plain,), (result,) = loads_of(swinging(ROD)), loads_of(swinging(rubs))
    assert result.energy - result.braked == pytest.approx(4.0 * 2.0, rel=2e-3)
    assert result.torque > plain.torque


def test_the_command_and_the_face_tell_it(tmp_path, capsys):
    text = rod_lines([400, 300]) + "effects: [{effect: friction_coulomb, at: 2, torque: 5 N*m}]\n"
    (tmp_path / "arm.yaml").write_text(text, encoding="utf-8")
    motion = tmp_path / "motion.csv"
    with motion.open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file)
        rows.writerow(("t_s", "q1_rad", "q2_rad", "dq1_radps", "dq2_radps", "ddq1_radps2", "ddq2_radps2"))
        for t in np.linspace(0.0, 2.0, 201):
            rows.writerow((t, 0.0, 0.4 * t, 0.0, 0.4, 0.0, 0.0))
    target = tmp_path / "result.json"
    assert run(["evaluate", str(tmp_path / "arm.yaml"), "--motion", str(motion), "--json", str(target)]) == 0
    shown = " ".join(capsys.readouterr().out.split())
    assert "RMS torque greatest speed greatest power energy braked off" in shown
    told = json.loads(target.read_text(encoding="utf-8"))["motion"]
    assert [item["joint"] for item in told] == [1, 2]
    assert told[1]["greatest_speed"] == pytest.approx(0.4)
    assert (told[1]["torque_unit"], told[1]["speed_unit"]) == ("N*m", "rad/s")
    assert told[0]["energy_J"] == 0.0
    result = lw.evaluate(tmp_path / "arm.yaml", motion=motion)
    assert result.drives["torque"].tolist() == [item["greatest_torque"] for item in told]
    plain = lw.evaluate(tmp_path / "arm.yaml")
    assert plain.found.max_error == result.found.max_error
    assert plain.motion is None
    assert plain.drives.empty
    assert "friction_coulomb" not in result.found.by_effect
    assert run(["evaluate", str(tmp_path / "arm.yaml"), "--motion", str(tmp_path / "none.csv")]) == 2
