"""Several recordings at once: what all of them say, each measured from a frame of its own."""

import re
from dataclasses import replace

import numpy as np
import pytest

import linkwright as lw
from linkwright.browser.server.folder import Folder
from linkwright.cli import run
from linkwright.core.diagnose.reading.write import recording_text, settings_text
from linkwright.core.diagnose.several.recordings import together
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.diagnose.several.days import arm, day

SOFT = {2: 40e-6}


def test_an_arm_mounted_anew_is_one_arm():
    """A drive that gives by 40 urad/(N*m) on both days, the instrument three times louder on the second."""
    two = together([day(1, compliance=SOFT), day(2, compliance=SOFT, sigma=45e-6)], arm())
    result = diagnose(arm(), two)
    assert [(finding.effect, finding.at) for finding in result.findings] == [("joint_compliance", (2,))]
    low, high = result.findings[0].parameters[0].interval
    assert low < SOFT[2] < high
    quiet, loud = result.recordings
    assert loud.noise_floor == pytest.approx(3.0 * quiet.noise_floor, rel=0.25)
    for recording, noise in zip(result.recordings, np.sqrt(2.0) * np.array([15e-6, 45e-6]), strict=True):
        assert recording.rms_after < 1.1 * noise < 0.2 * recording.rms_before
        # What one day has learned is as good on the other, frame its own.
        assert recording.rms_from_others < 1.1 * noise
        assert recording.rms_own <= recording.rms_after * (1.0 + 1e-6)


def test_days_too_poor_alone_name_it_together():
    """Each day held one payload only: the weight that bends it cannot be told from a zero and the frame."""
    days = [day(3, poses=5, payloads=(0.0,), compliance=SOFT), day(4, poses=5, payloads=(8.0,), compliance=SOFT)]
    days += [day(5, poses=5, payloads=(4.0,), compliance=SOFT)]
    for item in days:
        assert diagnose(arm(), item).verdict != "named"
    result = diagnose(arm(), together(days, arm()))
    assert [(finding.effect, finding.at) for finding in result.findings] == [("joint_compliance", (2,))]


@pytest.mark.slow
def test_a_zero_is_named_before_a_tool_that_explains_as_much(tmp_path):
    """One number before two: joint 2 of a planar arm of two joints is off by 0.3 deg on both days."""
    Folder(tmp_path).add_examples()
    file = tmp_path / "example-arm.yaml"
    off = {"effect": "encoder_offset", "at": 2, "offset": "0.3 deg"}
    for number in (1, 2):
        made = lw.simulate(file, poses=10, repeats=2, with_=[off], sides="one", seed=number).table
        made.to_csv(tmp_path / f"{number}.csv", index=False)
    known = lw.read_arm(file)
    result = lw.diagnose(known, lw.read_recordings([tmp_path / "1.csv", tmp_path / "2.csv"], known))
    assert result.findings[["effect", "at"]].to_numpy().tolist() == [["encoder_offset", (2,)]]


def test_one_recording_in_a_list_is_that_recording():
    made = day(6, compliance=SOFT)
    alone, listed = lw.diagnose(_face(), _read(made)), lw.diagnose(_face(), [_read(made)])
    timeless = [re.sub(r'"seconds": .*', "", item.to_json()) for item in (alone, listed)]
    assert timeless[0] == timeless[1]


def test_rows_are_numbered_by_file(tmp_path):
    """A reading that is far off is named by its row in its own file, on the screen, in JSON and in the residuals."""
    first, second = day(7, compliance=SOFT), day(8, compliance=SOFT)
    second.tip[10] += 2e-3
    files = [tmp_path / "may.csv", tmp_path / "august.csv"]
    for file, made in zip(files, (first, second), strict=True):
        file.write_text(recording_text(made, arm()))
        file.with_suffix(".yaml").write_text(settings_text(made))
    result = lw.diagnose(_face(), files)
    data = result._content()
    assert data["rejected_rows_detail"][0]["recording"] == "august.csv"
    assert data["rejected_rows_detail"][0]["row"] == 12
    assert [item["rejected_rows"] for item in data["recordings"]] == [[], [12]]
    rows = result.residuals.groupby("recording")["row"].agg(["min", "max"])
    assert rows.loc["august.csv"].tolist() == [2, second.size + 1]


@pytest.mark.parametrize(
    ("files", "said"),
    [
        (("may.csv", "may.csv"), "named twice"),
        (("may.csv", "other.csv"), "q3"),
    ],
)
def test_what_is_no_second_recording_is_one_line(tmp_path, capsys, files, said):
    made = day(9)
    (tmp_path / "may.csv").write_text(recording_text(made, arm()))
    (tmp_path / "may.yaml").write_text(settings_text(made))
    (tmp_path / "other.csv").write_text("q1_deg,q2_deg,x_mm,y_mm\n1,2,3,4\n2,3,4,5\n")
    _face().save(tmp_path / "arm.yaml")
    status = run(["diagnose", str(tmp_path / "arm.yaml"), *(str(tmp_path / f) for f in files)])
    told = capsys.readouterr().err
    assert status == 2
    assert said in told
    assert len(told.strip().splitlines()) == 1


def test_readings_come_back_apart():
    days = [day(10), replace(day(11), time=None, payload_mass=None)]
    both = together(days, arm())
    first, second = both.parts()
    assert np.array_equal(first.q, days[0].q)
    assert np.array_equal(second.tip, days[1].tip)
    assert both.time is None
    assert second.payload_mass is not None
    assert not second.payload_mass.any()
    assert any("the payload" in warning for warning in both.warnings)
    again = both.kept(np.arange(both.size) % 2 == 0)
    assert sum(part.size for part in again.parts()) == again.size
    assert both.place_of(int(both.row[days[0].size])) == (1, 1)


def _face() -> lw.Arm:
    return lw.Arm.of(arm())


def _read(made):
    from linkwright.face.recording import Recording

    return Recording(_face(), made)
