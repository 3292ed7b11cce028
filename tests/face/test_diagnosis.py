"""Diagnosis, prediction and comparison from a program, beside the commands."""

import json
from pathlib import Path

import numpy as np
import pytest

import linkwright as lw
from linkwright.cli import run
from tests.face.test_contract import a_result, same_files

BACKLASH = Path(__file__).resolve().parents[2] / "examples" / "hidden-backlash"


@pytest.fixture(scope="module")
def arm():
    """The arm as its file says."""
    return lw.read_arm(BACKLASH / "arm.yaml")


@pytest.fixture(scope="module")
def heard():
    """What was heard while the recording was diagnosed: words and shares."""
    return []


@pytest.fixture(scope="module")
def dia(arm, heard):
    """What its recording says."""
    recording = lw.read_recording(BACKLASH / "recording.csv", arm)
    return lw.diagnose(arm, recording, progress=lambda text, share: heard.append((text, share)))


def test_diagnosis(dia):
    """Verdict, findings, the corrected arm, residuals."""
    assert repr(dia) == "<Diagnosis: backlash at joint 2, 97 % of 0.122 mm explained>"
    assert dia.verdict == "named"
    assert dia.findings["effect"].iloc[0] == "backlash"
    assert dia.findings["at"].iloc[0] == (2,)
    assert {"rms_explained_mm", "parameter", "value", "low", "high", "unit"} <= set(dia.findings.columns)
    assert len(dia.residuals) == dia.recording.found.size
    assert dia.corrected.model.effects[-1].effect == "backlash"
    a_result(dia)


def test_first_finding_is_told_while_the_search_goes_on(dia, heard):
    """As provisional, from when it passes its own test to the end, where it still is what was found."""
    result = "provisional: backlash of the drives at joint 2; "
    first = next(number for number, (text, _) in enumerate(heard) if text.startswith("provisional"))
    assert heard[first][1] < 0.6
    assert {text for text, _ in heard[:first]} >= {"estimating the noise floor", "searching for what is missing"}
    assert len(heard) > first + 3
    assert all(text.startswith(result) for text, _ in heard[first:])
    assert set(dia.findings["at"]) == {(2,)}


@pytest.mark.slow
def test_saved_folder_is_the_command_s(dia, tmp_path):
    """File for file, but for the seconds that it took."""
    files = [str(BACKLASH / name) for name in ("arm.yaml", "recording.csv")]
    assert run(["diagnose", *files, "--out", str(tmp_path / "out"), "--json", str(tmp_path / "a.json")]) == 0
    dia.save(tmp_path / "saved")
    same_files(tmp_path / "out", tmp_path / "saved", but=("diagnosis.json", "report.html"))
    told, ours = json.loads((tmp_path / "a.json").read_text(encoding="utf-8")), json.loads(dia.to_json())
    assert told.pop("seconds") > 0.0
    assert ours.pop("seconds") > 0.0
    assert told == ours


def test_corrected_arm_predicts(dia, arm):
    """Its own recording to the noise, better than the arm as given; rows beyond what it learned from are named."""
    own = lw.predict(dia.corrected, dia.recording)
    assert own.rms_mm == pytest.approx(1e3 * dia.found.rms_after, rel=0.05)
    assert own.rms_mm < 0.5 * lw.predict(arm, dia.recording).rms_mm < own.nominal_rms_mm
    assert own.outside == ()
    table = own.table
    assert np.sqrt((table["residual_mm"] ** 2).mean()) == pytest.approx(own.rms_mm)
    assert own.max_mm == pytest.approx(table["residual_mm"].max())
    assert own.mean_mm == pytest.approx(table["residual_mm"].mean())
    other = lw.predict(dia.corrected, BACKLASH / "after-service.csv")
    q = lw.read_recording(BACKLASH / "after-service.csv", arm).found.q
    beyond = (q < dia.recording.found.q.min(axis=0)) | (q > dia.recording.found.q.max(axis=0))
    assert len(other.outside) == int(beyond.any(axis=1).sum()) > 0
    assert {item.joint: len(item.rows) for item in other.found.left} == {
        number: count for number, count in enumerate(beyond.sum(axis=0).tolist(), start=1) if count
    }
    free = lw.predict(dia.corrected, dia.recording, frame="free", tool="free")
    assert free.rms_mm < own.rms_mm
    assert (free.frame, free.tool, own.frame) == ("free", "free", "known")
    a_result(own)


def test_a_moved_frame_is_fitted_and_nothing_else(dia, arm):
    """A recording in a frame that stands elsewhere: free takes that up, known counts it."""
    table = dia.recording.table
    table["x_mm"] += 3.0
    moved = lw.read_recording(table, arm)
    assert lw.predict(dia.corrected, moved).rms_mm == pytest.approx(3.0, rel=0.01)
    there, here = (lw.predict(dia.corrected, item, frame="free").rms_mm for item in (moved, dia.recording))
    assert there == pytest.approx(here, rel=1e-6)


def test_predict_command(dia, tmp_path, capsys):
    """An arm file from a diagnosis knows what it was learned from; the JSON holds what is promised."""
    dia.save(tmp_path / "out")
    arm, recording = tmp_path / "out" / "arm.yaml", BACKLASH / "after-service.csv"
    assert run(["predict", str(arm), str(recording), "--json", str(tmp_path / "a.json")]) == 0
    told = json.loads((tmp_path / "a.json").read_text(encoding="utf-8"))
    result = lw.predict(arm, recording)
    assert told == json.loads(result.to_json())
    promised = {"rms_mm", "mean_mm", "max_mm", "rows", "nominal_rms_mm", "outside", "frame", "tool"}
    assert promised <= set(told)
    assert told["outside"] == list(lw.predict(dia.corrected, recording).outside)
    q = np.degrees(dia.recording.found.q)
    for item in told["outside_by_joint"]:
        column = q[:, item["joint"] - 1]
        assert item["span_deg"] == pytest.approx([column.min(), column.max()], abs=1e-5)
        assert item["learned"]
    shown = " ".join(capsys.readouterr().out.split())
    assert f"Warning: joint {told['outside_by_joint'][0]['joint']} leaves the coordinates that were learned" in shown
    own = lw.predict(arm, dia.recording)
    assert dia.found.written.rms == pytest.approx(own.found.rms, rel=1e-6)
    assert dia.found.written.keeps(0.02)


def test_a_list_is_no_recording_where_one_is_asked(arm):
    """Several recordings are not taken for one; an empty list is none, and one is not several units."""
    with pytest.raises(lw.InputError, match="one recording"):
        lw.predict(arm, [BACKLASH / "recording.csv"])
    with pytest.raises(lw.InputError, match="empty list"):
        lw.diagnose(arm, [])
    with pytest.raises(lw.InputError, match="several arms"):
        lw.diagnose(arm, [BACKLASH / "recording.csv"], units=True)
    with pytest.raises(lw.InputError, match="2 for 1 recordings"):
        lw.diagnose(arm, [BACKLASH / "recording.csv"], settings=["a.yaml", "b.yaml"])
    with pytest.raises(lw.InputError, match="did you mean 'backlash'"):
        lw.diagnose(arm, BACKLASH / "recording.csv", without=["backlsh"])
