"""The command that proposes recording.yaml for a foreign file: what it writes is read as it was meant."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import linkwright as lw
from linkwright.cli import run
from tests.diagnose.motion.reading.test_other_files import EXPORTS

ARM = """name: planar
chain:
  - joint: {range: [-2 rad, 2 rad]}
    link: {length: 400 mm, rigid: true, mass: 2 kg}
  - joint: {range: [-2 rad, 2 rad]}
    link: {length: 400 mm, rigid: true, mass: 2 kg}
"""


@pytest.fixture(autouse=True)
def in_a_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("arm.yaml").write_text(ARM, encoding="utf-8")


def currents(columns: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Currents (A) that hold the arm's weights, by moments about its joints, at 10 N m/A, and overcome 1 N m of
    friction."""
    one, two = (columns[f"actual_q_{k}"] for k in (0, 1))
    second = 2.0 * 9.81 * 0.2 * np.cos(one + two)
    first = 2.0 * 9.81 * (0.2 + 0.4) * np.cos(one) + second
    rubs = [np.sign(columns[f"actual_qd_{k}"]) for k in (0, 1)]
    return {f"actual_current_{k}": (held + rubs[k]) / 10.0 for k, held in enumerate((first, second))}


def test_a_log_of_another_program(capsys):
    """The settings that are written read as the proposal meant, and the answer says what is a guess."""
    pd.DataFrame({**EXPORTS["ur"], **currents(EXPORTS["ur"])}).to_csv("log.csv", index=False)
    assert run(["columns", "log.csv", "--arm", "arm.yaml", "--out", "recording.yaml", "--json", "c.json"]) == 0
    said = capsys.readouterr().out
    assert "a motion log, 300 samples in 2.99 s" in said
    assert "a guess by the size of its numbers" in said
    assert "computed by the controller" in said
    content = json.loads(Path("c.json").read_text(encoding="utf-8"))
    assert content["observes"] == "motion"
    assert content["settings"] == Path("recording.yaml").read_text(encoding="utf-8")
    log = lw.read_log("log.csv", "arm.yaml").found
    assert log.q == pytest.approx(np.stack([EXPORTS["ur"][f"actual_q_{k}"] for k in (0, 1)], axis=1), abs=1e-9)
    assert log.torque_constants_free


def test_a_recording_of_the_tip_by_ros():
    """Joint states beside a pose: radians and metres; two columns of stamps are one clock."""
    q = np.random.default_rng(1).uniform(-1.5, 1.5, (40, 2))
    angles = np.cumsum(q, axis=1)
    table = {
        "header.stamp.secs": np.arange(40.0),
        "header.stamp.nsecs": np.full(40, 5e8),
        **{f"/joint_states.position[{k}]": q[:, k] for k in (0, 1)},
        "/pose.pose.position.x": 0.4 * np.cos(angles).sum(axis=1),
        "/pose.pose.position.y": 0.4 * np.sin(angles).sum(axis=1),
    }
    pd.DataFrame(table).to_csv("tips.csv", index=False, sep=";", decimal=",")
    result = lw.columns("tips.csv", "arm.yaml")
    assert repr(result) == "<Columns: tips.csv: a recording, 40 readings; 5 of 6 columns tell of an arm>"
    assert result.save("recording.yaml") == [Path("recording.yaml")]
    recording = lw.read_recording("tips.csv", "arm.yaml").found
    assert recording.tip[:, 0] == pytest.approx(table["/pose.pose.position.x"], abs=1e-9)
    assert recording.time is not None
    assert recording.time == pytest.approx(np.arange(40.0))


def test_without_an_arm_there_are_as_many_joints_as_columns():
    pd.DataFrame(EXPORTS["franka"]).to_csv("log.csv", index=False)
    result = lw.columns("log.csv")
    assert {"q1_rad", "q2_rad", "tau2_Nm", "c1_rad"} <= set(result.table["is"])
    assert not result.found.wrong


def test_abbreviations_of_joint_states_are_read():
    """`pos`, `vel` and `eff` before the joints' names."""
    named = ARM.replace("joint: {range", "joint: {name: arm1, range", 1)
    Path("arm.yaml").write_text(named.replace("joint: {range", "joint: {name: arm2, range", 1), encoding="utf-8")
    log, weights = EXPORTS["ur"], currents(EXPORTS["ur"])
    table = {"t_s": np.arange(300) * 0.01}
    for k in (0, 1):
        table |= {f"pos_arm{k + 1}": log[f"actual_q_{k}"], f"vel_arm{k + 1}": log[f"actual_qd_{k}"]}
        table[f"eff_arm{k + 1}"] = 10.0 * weights[f"actual_current_{k}"]
    pd.DataFrame(table).to_csv("log.csv", index=False)
    result = lw.columns("log.csv", "arm.yaml")
    assert {"q1_rad", "q2_rad", "tau1_Nm", "tau2_Nm"} <= set(result.table["is"])
    assert not result.found.wrong


def test_what_the_proposal_cannot_mend_is_said(capsys):
    """The file tells of one joint of two."""
    pd.DataFrame({"timestamp": np.arange(50.0), "actual_q_0": np.sin(np.arange(50.0))}).to_csv("log.csv", index=False)
    assert run(["columns", "log.csv", "--arm", "arm.yaml"]) == 0
    assert "q2: is missing" in capsys.readouterr().out


def test_no_table_is_wrong_input(capsys):
    Path("log.mcap").write_bytes(b"nothing")
    assert run(["columns", "log.mcap"]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_without_an_arm_file_columns_tell_how_many_joints_there_are():
    """Joints, the measured place and the tool's, as calibration programs export them; the second place is no tip's."""
    names = [
        *(f"J{k} (deg)" for k in range(1, 7)),
        "X (mm)",
        "Y (mm)",
        "Z (mm)",
        "TCP X (mm)",
        "TCP Y (mm)",
        "TCP Z (mm)",
    ]
    pd.DataFrame(np.arange(24.0).reshape(2, 12), columns=names).to_csv("readings.txt", sep="\t", index=False)
    meant = list(lw.columns("readings.txt").table["is"])
    assert meant == [*(f"q{k}_deg" for k in range(1, 7)), "x_mm", "y_mm", "z_mm", "", "", ""]


def test_what_the_settings_beside_a_file_say_stands(capsys):
    """The sheet, a frame and a column that somebody wrote are read and kept, and the rest is proposed beside them."""
    q = np.round(np.random.default_rng(5).uniform(-90.0, 90.0, (12, 2)), 3)
    angles = np.radians(np.cumsum(q, axis=1))
    x, y = (400.0 * np.sum(of(angles), axis=1) for of in (np.cos, np.sin))
    table = pd.DataFrame(
        {"Servo 1 [deg]": q[:, 0], "Servo 2 [deg]": q[:, 1] + 30.0, "X [mm]": x, "Y [mm]": y, "Note": "-"}
    )
    with pd.ExcelWriter("log.xlsx") as book:
        table.to_excel(book, sheet_name="Messung", index=False)
        pd.DataFrame({"cell": [1], "hall": [2]}).to_excel(book, sheet_name="Notes", index=False)
    assert run(["columns", "log.xlsx", "--arm", "arm.yaml"]) == 2
    assert "write `sheet: Messung`" in capsys.readouterr().err
    told = "sheet: Messung\nframe: free\ncolumns: {q2_deg: '`Servo 2 [deg]` - 30'}\nignore: [Note]\n"
    Path("recording.yaml").write_text(told, encoding="utf-8")
    assert run(["columns", "log.xlsx", "--arm", "arm.yaml", "--out", "recording.yaml"]) == 0
    recording = lw.read_recording("log.xlsx", "arm.yaml").found
    assert recording.frame == "free"
    assert np.degrees(recording.q) == pytest.approx(q, abs=1e-9)
