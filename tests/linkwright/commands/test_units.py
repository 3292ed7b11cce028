"""`linkwright diagnose --units`: an arm file for each of several arms of one type, told by textbook kinematics."""

import json

import numpy as np
import pytest

from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.files.write import arm_to_yaml
from tests.diagnose.recorded import LENGTHS
from tests.diagnose.several.days import SIGMA, arm, day

SOFT = 40e-6
OTHER = (LENGTHS[0] + 1e-3, LENGTHS[1] - 1.5e-3, LENGTHS[2])


def _write(path, recording, unit):
    names = ["time_s", "q1_deg", "q2_deg", "q3_deg", "payload_kg", "x_mm", "y_mm"]
    parts = [recording.time[:, None], np.degrees(recording.q), recording.payload_mass[:, None], 1e3 * recording.tip]
    np.savetxt(path, np.hstack(parts), delimiter=",", header=",".join(names), comments="", fmt="%.9g")
    path.with_suffix(".yaml").write_text(f"frame: free\nunit: {unit}\n")


@pytest.fixture
def two_units(bench):
    """The bench with an arm file, and a recording each of two arms: one as drawn, one with links of other lengths; both
    give at their second joint. And one more recording of the second, on another day."""
    (bench / "arm.yaml").write_text(arm_to_yaml(arm()))
    gives = {2: SOFT}
    _write(bench / "a.csv", day(1, poses=12, compliance=gives), "serial 7")
    _write(bench / "b.csv", day(2, poses=12, compliance=gives, lengths=OTHER), "Nr. 12/ä")
    _write(bench / "later.csv", day(3, poses=12, compliance=gives, lengths=OTHER), "Nr. 12/ä")
    return bench


@pytest.mark.slow
def test_each_unit_has_an_arm_file_that_holds_on_its_other_recordings(linkwright, two_units):
    status, out, _ = linkwright("diagnose", "arm.yaml", "a.csv", "b.csv", "--units", "--out", "found")
    assert status == 0
    told = json.loads((two_units / "found" / "diagnosis.json").read_text())
    files = [item["arm_file"] for item in told["recordings"]]
    assert files == ["arm-serial-7.yaml", "arm-nr-12-a.yaml"]
    page = (two_units / "found" / "report.html").read_text()
    for name, each in zip(files, told["recordings"], strict=True):
        assert name in out
        assert name in page
        assert each["written_arm_rms_mm"] == pytest.approx(each["written_arm"]["promised_mm"], rel=0.02)
        assert not each["written_arm"]["lacks"]
    # What belongs to the type is in both files; the lengths of the second arm in its own alone.
    drawn, other = (read_arm(two_units / "found" / name) for name in files)
    for own in (drawn, other):
        (gives,) = [effect for effect in own.effects if effect.effect == "joint_compliance"]
        assert gives.parameters["compliance"] == pytest.approx(SOFT, rel=0.02)
    assert [effect.effect for effect in drawn.effects] == ["joint_compliance"]
    lengths = {effect.at: effect.parameters for effect in other.effects if effect.effect == "link_length"}
    assert sorted(lengths) == [(1,), (2,)]
    # On another recording of the second arm its own file leaves the noise, the first one's does not.
    left = {}
    for name in files:
        status, _, _ = linkwright("predict", f"found/{name}", "later.csv", "--json", "later.json")
        assert status == 0
        left[name] = json.loads((two_units / "later.json").read_text())["rms_mm"]
    noise = 1e3 * SIGMA * np.sqrt(2.0)
    assert left[files[1]] < 1.2 * noise
    assert left[files[0]] > 10.0 * noise
    # Anew into the same folder with one recording: the units' files go, the folder is still the command's own.
    assert linkwright("diagnose", "arm.yaml", "a.csv", "--out", "found")[0] == 0
    assert not list((two_units / "found").glob("arm-*.yaml"))
