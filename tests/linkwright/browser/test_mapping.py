"""What foreign headers are taken for, and that the settings say so to the reader."""

from pathlib import Path

import numpy as np
import pytest

import linkwright as lw
from linkwright.browser.server.dropped import Dropped
from linkwright.core.diagnose.reading.files import table_of
from linkwright.core.diagnose.reading.foreign.proposal import IGNORED, OTHER, Meaning, proposed, settings_text
from linkwright.core.units.reading import parse_yaml

ARM = "examples/hidden-backlash/arm.yaml"


def meant(**columns):
    import pandas as pd

    arm = lw.read_arm(ARM).model
    return {item.header: item for item in proposed(table_of(pd.DataFrame(columns), "x"), arm)}


@pytest.mark.parametrize(
    ("header", "what", "unit"),
    [
        ("q1_deg", "q1", "deg"),
        ("Q2 (deg)", "q2", "deg"),
        ("Joint 3 [rad]", "q3", "rad"),
        ("axis_2_deg", "q2", "deg"),
        ("J1", "q1", "deg"),
        ("theta3", "q3", "deg"),
        ("TCP X [mm]", "x", "mm"),
        ("pos_y [m]", "y", "m"),
        ("z", "z", "mm"),
        ("Load [kg]", "payload", "kg"),
        ("Temperature [°C]", "temperature", "degC"),
        ("Time (s)", "time", "s"),
        ("dir2", "dir2", ""),
        ("direction 3", "dir3", ""),
        ("torque_1 [N*m]", "tau1", "Nm"),
        ("t_s", "time", "s"),
        ("dq2_radps", "v2", "rad_s"),
        ("velocity 2 [rad/s]", "v2", "rad_s"),
        ("current3_A", "current3", "A"),
        ("Current 1 (A)", "current1", "A"),
        ("Joint 7 [deg]", OTHER, ""),
        ("operator", OTHER, ""),
        ("humidity", OTHER, ""),
    ],
)
def test_headers_as_people_write_them(header, what, unit):
    """Numbers of hundreds: no radians, no metres."""
    result = meant(**{header: [120.0, -90.0, 210.0]})[header]
    assert (result.what, result.unit) == (what, unit)


def test_joints_that_people_name_behind_their_numbers():
    """`J1_base`, `J4`: what differs from joint to joint is its name; what is the same of each is what was measured."""
    columns = {"J1_base [deg]": [120.0, -90.0], "J2_elbow [deg]": [30.0, -9.0], "J3 [deg]": [30.0, -9.0]}
    assert [item.ours for item in meant(**columns).values()] == ["q1_deg", "q2_deg", "q3_deg"]
    named = {f"Servo {k} {name} (deg)": [120.0, -9.0] for k, name in enumerate(("drehen", "schulter", "hand"), 1)}
    assert [item.ours for item in meant(**named).values()] == ["q1_deg", "q2_deg", "q3_deg"]
    alike = {f"axis {k} lag error [deg]": [120.0, -9.0] for k in (1, 2, 3)}
    assert {item.what for item in meant(**alike).values()} == {OTHER}
    told = {f"axis {k} {name} [deg]": [120.0, -9.0] for k, name in ((1, "target"), (2, "setpoint"))}
    assert not {item.what for item in meant(**told).values()} & {"q1", "q2", "q3"}


def test_a_place_is_the_only_column_of_its_letter():
    """Whatever the tip is called; not what was commanded, nor one of two."""
    result = meant(**{"Spitze X [mm]": [400.0], "Prisma Y mm": [410.0], "soll y [mm]": [410.0], "weight in g": [500.0]})
    assert [item.ours for item in result.values()] == ["x_mm", "y_mm", OTHER, "payload_g"]
    german = meant(**{"X-Ist [mm]": [400.0], "Y-Ist [mm]": [410.0], "X-Soll [mm]": [400.0], "Richtung 2": [1.0]})
    assert [item.ours for item in german.values()] == ["x_mm", "y_mm", OTHER, "dir2"]
    two = meant(**{"left prism x [mm]": [400.0], "right prism x [mm]": [410.0]})
    assert {item.what for item in two.values()} == {OTHER}


def test_time_stamps_are_no_guess():
    """They are read without a word in the settings."""
    result = meant(Timestamp=["2026-03-11 09:00:25", "2026-03-11 09:00:50"])["Timestamp"]
    assert (result.ours, result.guessed) == ("time_s", False)


def test_units_are_guessed_by_size_and_said_to_be():
    """Radians stay within a turn, metres within a machine hall; joints of one file are in one unit."""
    result = meant(**{"joint 1": [1.2, -3.1], "joint 2": [1.2, -0.9], "x": [0.4, 1.1], "y": [400.0, 1100.0]})
    assert [(item.unit, item.guessed) for item in result.values()] == [
        ("rad", True),
        ("rad", True),
        ("m", True),
        ("mm", True),
    ]
    result = meant(**{"joint 1": [1.2, -3.1], "joint 2": [1.2, -90.0]})
    assert [(item.unit, item.guessed) for item in result.values()] == [("deg", True)] * 2


def test_nothing_is_meant_twice():
    """The first of two is taken, the other is somebody's own."""
    result = meant(**{"q1_deg": [10.0, 20.0], "Joint 1 [deg]": [10.0, 20.0]})
    assert [item.what for item in result.values()] == ["q1", OTHER]


def test_the_settings_are_read_as_they_were_meant(tmp_path):
    """Headers with brackets, quotes, colons and signs; the same readings come out."""
    given = lw.read_recording("examples/hidden-backlash/recording.csv", ARM).table
    odd = {"q1_deg": 'a "quoted" - header', "q2_deg": "b: [rad]", "x_mm": "#1 / x", "y_mm": "y, tracker"}
    foreign = given.rename(columns=odd)
    foreign["b: [rad]"] = np.radians(foreign["b: [rad]"])
    foreign["scrap"] = 1.0
    foreign.to_csv(tmp_path / "odd.csv", index=False)
    said = [Meaning(odd.get(name, name), *name.partition("_")[::2]) for name in given.columns]
    said = [Meaning(item.header, item.what, "rad" if item.what == "q2" else item.unit) for item in said]
    text = settings_text([*said, Meaning("scrap", IGNORED)], {"frame": "free", "sigma": "15 um", "tool": ""})
    assert parse_yaml(text, file="x")["ignore"] == ["scrap"]
    (tmp_path / "recording.yaml").write_text(text, encoding="utf-8")
    read = lw.read_recording(tmp_path / "odd.csv", ARM, settings=tmp_path / "recording.yaml")
    assert read.found.frame == "free"
    for name in given.columns:
        np.testing.assert_allclose(read.table[name], given[name], rtol=1e-12, atol=1e-12)


def test_lines_above_the_header_are_a_number():
    """As a field of the page tells them; what is no number is left for the reader to refuse."""
    assert settings_text((), {"skip_rows": "3", "sigma": "15 um"}) == "skip_rows: 3\nsigma: 15 um\n"
    assert settings_text((), {"skip_rows": "three"}) == "skip_rows: three\n"


@pytest.mark.parametrize(("told", "decimal"), [({}, ","), ({"decimal": ""}, "")])
def test_decimal_commas_are_seen_in_the_numbers(told, decimal):
    """Of a file with semicolons as other programs write it; who says that it has points is believed."""
    rows = "".join(f"{10.5 + k};{20.25 - k};0,0;{400.5 + k}\n" for k in range(20)).replace(".", ",")
    content = f"A1 [deg];A2 [deg];A3 [deg];TCP X [mm]\n{rows}".encode()
    dropped = Dropped("foreign.csv", content, dict(told))
    dropped.propose(lw.read_arm(ARM))
    assert (dropped.problem, dropped.given.get("decimal")) == ("", decimal)
    pointed = Dropped("own.csv", content.replace(b",", b"."))
    pointed.propose(lw.read_arm(ARM))
    assert "decimal" not in pointed.given


def test_a_motion_log_is_read_as_one():
    """As its header stands, and under headers as people write them; the line is that of `lw.read_log`."""
    arm = lw.read_arm("examples/motion-log/robot.urdf")
    place = Path("examples/motion-log/log.csv")
    dropped = Dropped("log.csv", place.read_bytes())
    dropped.propose(arm)
    dropped.check(arm)
    assert not dropped.problem
    assert dropped.line == repr(lw.read_log(place, arm))[1:-1]
    renamed = place.read_text().replace("t_s", "Time [s]").replace("_rad", " [rad]").replace("tau", "torque ")
    again = Dropped("log.csv", renamed.replace("_Nm", " (Nm)").encode())
    again.propose(arm)
    again.check(arm)
    assert again.line == dropped.line
