"""Headers as people write them, titles above them, and decimal commas: read, or said with what to write."""

import pytest

from linkwright.core.diagnose.reading.columns import otherwise_spelled
from linkwright.core.units.quantities import InputError
from tests.diagnose.reading.test_foreign_files import ANGLES, TIPS, read, text


@pytest.mark.parametrize(
    ("written", "ours"),
    [
        ("Q1_DEG", "q1_deg"),
        ("q1 (deg)", "q1_deg"),
        ("q1 [°]", "q1_deg"),
        ("Q 1 [rad]", "q1_rad"),
        ("x [mm]", "x_mm"),
        ("X(mm)", "x_mm"),
        ("Y_M", "y_m"),
        ("z (µm)", "z_um"),
        ("Time (s)", "time_s"),
        ("Temperature [°C]", "temperature_degC"),
        ("PAYLOAD KG", "payload_kg"),
        ("v2 (deg/s)", "v2_deg_s"),
        ("a2 [deg/s^2]", "a2_deg_s2"),
        ("tau1 [N·m]", "tau1_Nm"),
        ("Fx (N)", "fx_N"),
        ("Dir2", "dir2"),
        ("QW", "qw"),
        ("Temperature_Link2_degC", "temperature_link2_degC"),
        ("temperature link 2 [°C]", "temperature_link2_degC"),
        ("q1_deg", None),
        ("Q1", None),
        ("x position [mm]", None),
        ("Joint 1 [rad]", None),
        ("temp (°C)", None),
        ("", None),
    ],
)
def test_spelling(written, ours):
    """Nothing but letters' size, blanks and brackets may differ; a unit is never guessed."""
    assert otherwise_spelled(written) == ours


@pytest.mark.parametrize(
    "header", ["Q1_DEG,Q2_DEG,X_MM,Y_MM", "q1 (deg),q2 (deg),x (mm),y (mm)", 'Q1 [°],q2_deg,"X [mm]",y [mm]']
)
def test_headers_as_people_write_them_are_read_and_said(tmp_path, header):
    found = read(tmp_path, text(",", header))
    assert found.q == pytest.approx(ANGLES, abs=1e-6)
    assert found.tip == pytest.approx(TIPS, abs=1e-7)
    said = [line for line in found.warnings if "written otherwise" in line]
    assert len(said) == 1
    assert " as x_mm" in said[0]


def test_a_header_as_it_should_be_goes_before_one_like_it(tmp_path):
    """`X_MM` beside `x_mm` is somebody's own column."""
    rows = text(",").splitlines()
    content = "\n".join(["X_MM," + rows[0], *("7," + row for row in rows[1:])]) + "\n"
    found = read(tmp_path, content)
    assert found.tip == pytest.approx(TIPS, abs=1e-7)
    assert "X_MM" in found.other


@pytest.mark.parametrize("separator", [",", ";", "\t"])
@pytest.mark.parametrize(("titles", "skipped"), [(["Cell 7, hall 2"], 1), (["Tracker", "", "serial;12;x"], 3)])
def test_a_title_above_the_header_says_what_to_skip(tmp_path, separator, titles, skipped):
    content = "\n".join([*titles, text(separator, decimal="," if separator == ";" else ".")])
    settings = 'decimal: ","\n' if separator == ";" else ""
    with pytest.raises(InputError, match=rf"line {skipped + 1}; write `skip_rows: {skipped}` in recording.yaml"):
        read(tmp_path, content, settings)
    found = read(tmp_path, content, f"{settings}skip_rows: {skipped}\n")
    assert found.tip == pytest.approx(TIPS, abs=1e-7)


def test_a_title_above_a_foreign_header_is_guessed(tmp_path):
    content = "Cell 7\n" + text(",", "A1,A2,X,Y")
    with pytest.raises(InputError, match="skip_rows: 1"):
        read(tmp_path, content)


def test_comments_are_no_titles(tmp_path):
    found = read(tmp_path, "# Cell 7\n\n" + text(","), 'comment: "#"\n')
    assert found.tip == pytest.approx(TIPS, abs=1e-7)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (text(";", decimal=","), 'decimal commas need `decimal: ","`'),
        (text(",", decimal=","), "decimal commas cannot stand in a table parted by commas"),
    ],
)
def test_decimal_commas_are_named(tmp_path, content, said):
    with pytest.raises(InputError, match=said):
        read(tmp_path, content)
