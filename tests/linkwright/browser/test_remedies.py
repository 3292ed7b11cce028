"""What a refusal proposes, taken by a click: the recording reads as the one without the mistake."""

import numpy as np
import pandas as pd
import pytest

import linkwright as lw
from linkwright.browser.server.dropped import Dropped
from linkwright.core.diagnose.reading.foreign.proposal import Meaning, settings_text
from linkwright.core.diagnose.reading.foreign.remedy import with_columns
from linkwright.core.units.quantities import InputError

ARM = "examples/hidden-backlash/arm.yaml"
TIPS = "examples/hidden-backlash/recording.csv"
URDF, LOG = "examples/motion-log/robot.urdf", "examples/motion-log/log.csv"


def dropped(table, arm):
    """A table that was dropped, as it is read without a word."""
    result = Dropped("odd.csv", table.to_csv(index=False).encode())
    result.propose(arm)
    result.check(arm)
    return result


def mended(found, arm):
    """With what its refusal proposes first."""
    assert found.problem
    found.take(found.remedies[0])
    found.check(arm)
    assert found.problem == ""
    return found


def read(found, tmp_path):
    place = tmp_path / "odd.csv"
    place.write_bytes(found.content)
    (tmp_path / "odd.yaml").write_text(found.settings(), encoding="utf-8")
    return place


@pytest.mark.parametrize(
    "odd",
    [
        lambda t: t.assign(q2_deg=-t["q2_deg"]),
        lambda t: t.assign(q1_deg=t["q2_deg"], q2_deg=t["q1_deg"]),
        lambda t: t.assign(q3_deg=t["q3_deg"] + t["q2_deg"]),
        lambda t: t.assign(q2_deg=-t["q2_deg"]).rename(columns={"q2_deg": "Joint 2 [deg]", "x_mm": "TCP X [mm]"}),
    ],
    ids=["sign", "places", "sum", "foreign"],
)
def test_a_recording_of_tips_is_mended(odd, tmp_path):
    """Joints that count the other way, that changed places, that hold another; under headers of others too."""
    arm = lw.read_arm(ARM)
    right = lw.read_recording(TIPS, arm)
    result = mended(dropped(odd(pd.read_csv(TIPS)), arm), arm)
    back = lw.read_recording(read(result, tmp_path), arm)
    np.testing.assert_allclose(back.found.q, right.found.q, atol=1e-12)
    np.testing.assert_allclose(back.found.tip, right.found.tip, atol=1e-12)


@pytest.mark.parametrize(
    "odd",
    [lambda t: t.assign(q1_rad=-t["q1_rad"]), lambda t: t.assign(tau1_Nm=t["tau2_Nm"], tau2_Nm=t["tau1_Nm"])],
    ids=["sign", "places"],
)
def test_a_motion_log_is_mended(odd, tmp_path):
    """The same of torques against time."""
    arm = lw.read_arm(URDF)
    right = lw.read_log(LOG, arm)
    result = mended(dropped(odd(pd.read_csv(LOG)), arm), arm)
    back = lw.read_log(read(result, tmp_path), arm)
    np.testing.assert_allclose(back.found.q, right.found.q, atol=1e-12)
    np.testing.assert_allclose(back.found.torque, right.found.torque, atol=1e-12)


def test_a_key_of_its_own_goes_into_further_lines(tmp_path):
    """A list stays one, and the reader obeys it: torques of motors before gears."""
    arm = lw.read_arm(URDF)
    right = lw.read_log(LOG, arm)
    table, ratios = pd.read_csv(LOG), (100, 120, 80, 50)
    for number, ratio in enumerate(ratios, start=1):
        table[f"tau{number}_Nm"] /= ratio
    result = dropped(table, arm)
    result.take({"gear_ratios": [100, 120, 80, 50]})
    result.check(arm)
    assert result.problem == ""
    np.testing.assert_allclose(lw.read_log(read(result, tmp_path), arm).found.torque, right.found.torque, rtol=1e-9)


def test_a_column_of_a_joint_that_is_none_is_passed_over():
    """The refusal quotes `ignore`."""
    arm = lw.read_arm(ARM)
    result = dropped(pd.read_csv(TIPS).assign(q7_deg=1.0), arm)
    assert dict(result.remedies[0]) == {"ignore": ["q7_deg"]}
    mended(result, arm)


@pytest.mark.parametrize(
    ("odd", "columns"),
    [
        (lambda t: t.assign(q2_deg=t["q2_deg"] - 90.0), {"q2_deg": "q2_deg + 90"}),
        (lambda t: t.assign(q2_deg=90.0 - t["q2_deg"]), {"q2_deg": "-q2_deg + 90"}),
        (lambda t: t.assign(x_mm=t["x_mm"] / 1e3, y_mm=t["y_mm"] / 1e3), {"x_mm": "1000*x_mm", "y_mm": "1000*y_mm"}),
    ],
    ids=["zero", "zero and sign", "unit"],
)  # fmt: skip
def test_zeros_and_units_are_mended_by_their_columns(odd, columns, tmp_path):
    """By the same formulas as signs, and with them where both are wrong."""
    arm = lw.read_arm(ARM)
    right = lw.read_recording(TIPS, arm)
    result = dropped(odd(pd.read_csv(TIPS)), arm)
    assert [dict(remedy) for remedy in result.remedies] == [{"columns": columns}]
    back = lw.read_recording(read(mended(result, arm), tmp_path), arm)
    np.testing.assert_allclose(back.found.q, right.found.q, atol=1e-9)
    np.testing.assert_allclose(back.found.tip, right.found.tip, atol=1e-9)


def test_a_unit_that_is_missing_is_offered():
    """Each that the column can have is a remedy."""
    with pytest.raises(InputError) as refused:
        lw.read_recording(pd.read_csv(TIPS).rename(columns={"q2_deg": "q2"}), lw.read_arm(ARM))
    assert refused.value.remedies == ({"columns": {"q2_deg": "q2"}}, {"columns": {"q2_rad": "q2"}})


def test_sign_factor_and_zero_are_written_and_read(tmp_path):
    """As the page's fields tell them; a remedy acts on what they say already."""
    meanings = [Meaning("A", "q1", "deg", factor=-2.0, zero=30.0), Meaning("B", "q2", "deg")]
    text = settings_text(meanings, {})
    (tmp_path / "settings.yaml").write_text(text, encoding="utf-8")
    table = pd.DataFrame({"A": [10.0, 20.0], "B": [1.0, 2.0], "q3_deg": 0.0, "x_mm": 1e3, "y_mm": 0.0})
    arm = lw.read_arm(ARM)
    result = lw.read_recording(table, arm, settings=tmp_path / "settings.yaml")
    np.testing.assert_allclose(np.degrees(result.found.q[:, 0]), [10.0, -10.0])
    (one, two) = with_columns(meanings, {"q1_deg": "-q1_deg + 5"}, file="x")
    assert (one.factor, one.zero, two) == (2.0, -25.0, meanings[1])
    (one, two) = with_columns(meanings, {"q1_deg": "q2_deg", "q2_deg": "q1_deg"}, file="x")
    assert (one.what, one.factor, one.zero, two.what, two.factor) == ("q2", -2.0, 30.0, "q1", 1.0)
    with pytest.raises(InputError, match="is no sum of columns"):
        with_columns(meanings, {"q1_deg": "q1_deg*q2_deg"}, file="x")
