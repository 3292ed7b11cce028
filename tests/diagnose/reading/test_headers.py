"""Headers as people write them, titles above them, and decimal commas: read, or said with what to write."""

import numpy as np
import pytest

from linkwright.core.diagnose.columns.proposed_file import propose
from linkwright.core.diagnose.reading.columns import otherwise_spelled
from linkwright.core.diagnose.reading.read import read_recording
from linkwright.core.units.quantities import InputError
from tests.diagnose.reading.test_foreign_files import ANGLES, ARM, TIPS, read, text


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
    result = read(tmp_path, text(",", header))
    assert result.q == pytest.approx(ANGLES, abs=1e-6)
    assert result.tip == pytest.approx(TIPS, abs=1e-7)
    said = [line for line in result.warnings if "written otherwise" in line]
    assert len(said) == 1
    assert " as x_mm" in said[0]


def test_a_header_as_it_should_be_goes_before_one_like_it(tmp_path):
    """`X_MM` beside `x_mm` is somebody's own column."""
    rows = text(",").splitlines()
    content = "\n".join(["X_MM," + rows[0], *("7," + row for row in rows[1:])]) + "\n"
    result = read(tmp_path, content)
    assert result.tip == pytest.approx(TIPS, abs=1e-7)
    assert "X_MM" in result.other


@pytest.mark.parametrize("separator", [",", ";", "\t"])
@pytest.mark.parametrize(("titles", "skipped"), [(["Cell 7, hall 2"], 1), (["Tracker", "", "serial;12;x"], 3)])
def test_titles_above_the_header_are_passed_over_and_said(tmp_path, separator, titles, skipped):
    content = "\n".join([*titles, text(separator, decimal="," if separator == ";" else ".")])
    settings = 'decimal: ","\n' if separator == ";" else ""
    for told in (settings, f"{settings}skip_rows: {skipped}\n"):
        result = read(tmp_path, content, told)
        assert result.tip == pytest.approx(TIPS, abs=1e-7)
        said = any(f"The header stands in line {skipped + 1}" in warning for warning in result.warnings)
        assert said == ("skip_rows" not in told)


def test_titles_above_a_foreign_header_are_passed_over(tmp_path):
    """It is the first line with as many cells as those of numbers below it."""
    columns = "columns: {q1_deg: A1, q2_deg: A2, x_mm: X, y_mm: Y}"
    for titles, first in (("Cell 7\n", 3), ("Cell 7; hall 2\n\nserial,12,made,here,2024,x\n", 5)):
        result = read(tmp_path, titles + text(",", "A1,A2,X,Y"), columns)
        assert result.tip == pytest.approx(TIPS, abs=1e-7)
        assert result.row.tolist() == list(range(first, first + 30))


@pytest.mark.parametrize("units", [(), ("[deg]", "[°]", "mm", "(mm)")])
def test_titles_as_a_spreadsheet_writes_them(tmp_path, units):
    """It fills their lines with separators; and numbers with decimal commas hold more commas than semicolons."""
    names = ["A1 [deg]", "A2 [°]", "X [mm]", "Y (mm)"]
    if units:
        names = [name.split()[0] for name in names]
    numbers = text(";", "A1;A2;X;Y", decimal=",").splitlines()[1:]
    lines = ["Log 12;;;", "Anna;12.03.2026;;", ";;;", ";".join(names), *([";".join(units)] if units else []), *numbers]
    columns = "columns: {q1_deg: '`A1 [deg]`', q2_deg: '`A2 [°]`', x_mm: '`X [mm]`', y_mm: Y_MM}"
    columns = columns.replace("Y_MM", "'`Y [mm]`'" if units else "'`Y (mm)`'")
    result = read(tmp_path, "\n".join(lines), columns)
    assert result.tip == pytest.approx(TIPS, abs=1e-7)
    first = 6 if units else 5
    assert result.row.tolist() == list(range(first, first + 30))
    assert "The header stands in line 4. Lines above the header are not used." in result.warnings
    assert ("The header has a second line, with units." in result.warnings) == bool(units)


def test_titles_above_numbers_that_are_text(tmp_path):
    """A workbook whose numbers are text with decimal commas: they stand in quotes, and hold the separator."""
    lines = ["Messung,,,2026-05-16", "q1_deg,q2_deg,X,Y"]
    lines += [",".join(f'"{cell}"' for cell in row.split(";")) for row in text(";", decimal=",").splitlines()[1:]]
    result = read(tmp_path, "\n".join(lines), "columns: {x_mm: X, y_mm: Y}")
    assert result.tip == pytest.approx(TIPS, abs=1e-7)


def test_a_row_that_lacks_cells_makes_no_titles(tmp_path):
    """A first reading that breaks off is one row set aside, with the header in its place."""
    lines = text(",").splitlines()
    result = read(tmp_path, "\n".join([lines[0], "1,2", *lines[1:]]))
    assert [item.row for item in result.rejected] == [2]
    assert result.tip == pytest.approx(TIPS, abs=1e-7)


def test_comments_are_no_titles(tmp_path):
    result = read(tmp_path, "# Cell 7\n\n" + text(","), 'comment: "#"\n')
    assert result.tip == pytest.approx(TIPS, abs=1e-7)


def test_decimal_commas_are_read_and_said(tmp_path):
    result = read(tmp_path, text(";", decimal=","))
    assert result.tip == pytest.approx(TIPS, abs=1e-7)
    assert "Numbers have decimal commas." in result.warnings
    proposal = propose(tmp_path / "r.csv", ARM)
    assert [*proposal.notes, *proposal.warnings].count("Numbers have decimal commas.") == 1


def test_joints_that_are_called_j_are_the_coordinates_where_a_file_has_no_others(tmp_path):
    """Beside others they are encoders on the joints themselves."""
    (tmp_path / "r.csv").write_text("J1 [deg],J2 [deg],X [mm],Y [mm]\n" + "10,20,1,2\n" * 3)
    assert [meaning.ours for meaning in propose(tmp_path / "r.csv", ARM).meanings] == [
        "q1_deg",
        "q2_deg",
        "x_mm",
        "y_mm",
    ]
    (tmp_path / "r.csv").write_text("q1_deg,q2_deg,J1 [deg],x_mm,y_mm\n" + "10,20,10,1,2\n" * 3)
    assert propose(tmp_path / "r.csv", ARM).meanings[2].ours == "j1_deg"


def test_a_clock_of_another_language_is_proposed(tmp_path):
    lines = text(",").splitlines()
    stamped = [f"{number},{line}" for number, line in enumerate(lines[1:])]
    (tmp_path / "r.csv").write_text("\n".join([f"Zeitstempel,{lines[0]}", *stamped]))
    clock = propose(tmp_path / "r.csv", ARM).meanings[0]
    assert (clock.header, clock.ours, clock.guessed) == ("Zeitstempel", "time_s", True)


@pytest.mark.parametrize(
    ("content", "settings", "said"),
    [
        (text(";", decimal=","), 'decimal: "."\n', "write `decimal: ','` in recording.yaml"),
        (text(",", decimal=","), "", "decimal commas cannot stand in a table parted by commas"),
    ],
)
def test_decimal_commas_are_named(tmp_path, content, settings, said):
    with pytest.raises(InputError, match=said):
        read(tmp_path, content, settings)


def test_settings_of_another_file_in_the_folder_are_passed_over_in_a_proposal(tmp_path):
    """They are said, and no part of what is written."""
    (tmp_path / "r.csv").write_text(text(","))
    (tmp_path / "recording.yaml").write_text("columns: {x_mm: tracker east}\nsigma: 20 um\n")
    proposal = propose(tmp_path / "r.csv", ARM)
    assert not proposal.wrong
    assert [meaning.ours for meaning in proposal.meanings] == ["q1_deg", "q2_deg", "x_mm", "y_mm"]
    assert any("do not fit this file (x_mm)" in note for note in proposal.notes)
    assert "sigma: 20 um" in proposal.settings


def with_columns(*headers):
    """The table with a column of numbers under each of some headers beside it."""
    first, *rows = text(",").splitlines()
    more = [",".join(f"{number + 0.1 * row}" for number, _ in enumerate(headers)) for row in range(len(rows))]
    return "\n".join([f"{first},{','.join(headers)}", *(f"{row},{item}" for row, item in zip(rows, more, strict=True))])


@pytest.mark.parametrize(("load", "warmth"), [("Kuorma [kg]", "Motor [°C]"), ("Kuorma in kg", "bed (degC)")])
def test_a_unit_that_no_other_column_has_counts_with_the_word(tmp_path, load, warmth):
    """In whatever language, as a guess that says why."""
    (tmp_path / "r.csv").write_text(with_columns(load, warmth, "note"), encoding="utf-8")
    *_, first, second, third = propose(tmp_path / "r.csv", ARM).meanings
    assert [(item.ours, item.guessed) for item in (first, second)] == [("payload_kg", True), ("temperature_degC", True)]
    assert first.said == "by its unit, the only one in kg"
    assert not third.named


def test_of_two_columns_in_kg_none_is_the_payload(tmp_path):
    (tmp_path / "r.csv").write_text(with_columns("Kuorma [kg]", "Jalusta [kg]"), encoding="utf-8")
    assert not any(item.what == "payload" for item in propose(tmp_path / "r.csv", ARM).meanings)


def test_a_column_in_kg_is_asked_for(tmp_path):
    """A recording of a tip takes no guess for granted; what the question says to write answers it."""
    asked = "Kuorma [kg] is no column that is known here. Is it the payload? Then"
    said = " ".join(read(tmp_path, with_columns("Kuorma [kg]")).warnings)
    assert f"{asked} write `columns: {{payload_kg: '`Kuorma [kg]`'}}` in recording.yaml." in said
    result = read(tmp_path, with_columns("Kuorma [kg]"), "columns: {payload_kg: '`Kuorma [kg]`'}")
    assert result.payload_mass is not None
    said = " ".join(read(tmp_path, with_columns("Kuorma [kg]"), "columns: {q1_deg: q1_deg}").warnings)
    assert f'{asked} in `columns` of recording.yaml add payload_kg: "`Kuorma [kg]`".' in said


MAP = "columns: {q1_deg: A 1, q2_deg: A 2}\n"


@pytest.mark.parametrize("headers", ["A 1,A 2,X [mm],Y [mm],Carga (kg)", "Carga (kg),A 1,A 2,X [mm],Y [mm]"])
def test_a_column_that_a_map_leaves_out_is_taken_and_said(tmp_path, headers):
    """What the map does not say, a header that is plain does."""
    rows = [f"2.5,{row}" if headers.startswith("C") else f"{row},2.5" for row in text(",").splitlines()[1:]]
    result = read(tmp_path, "\n".join([headers, *rows]), MAP)
    assert result.payload_mass == pytest.approx(np.full(30, 2.5))
    assert "Headers are taken for ours: Carga (kg) as payload_kg." in result.warnings


@pytest.mark.parametrize(
    "settings",
    [
        MAP + "ignore: [Carga (kg)]\n",
        MAP.replace("}", ", payload_kg: 3 + 0*`A 1`}"),
        MAP.replace("}", ", time_s: Carga (kg)}"),
    ],
)
def test_a_column_that_the_settings_pass_over_or_use_is_not_taken(tmp_path, settings):
    rows = [f"{row},{2.5 * number}" for number, row in enumerate(text(",").splitlines()[1:])]
    result = read(tmp_path, "\n".join(["A 1,A 2,X [mm],Y [mm],Carga (kg)", *rows]), settings)
    assert not any("taken for ours: Carga" in warning for warning in result.warnings)
    assert result.payload_mass is None or result.payload_mass == pytest.approx(np.full(30, 3.0))


def test_our_header_goes_before_a_foreign_one(tmp_path):
    rows = [f"7,{row},2.5" for row in text(",").splitlines()[1:]]
    result = read(tmp_path, "\n".join(["Carga (kg),q1_deg,q2_deg,x_mm,y_mm,payload_kg", *rows]))
    assert result.payload_mass == pytest.approx(np.full(30, 2.5))


def test_two_robots_in_one_file_are_not_taken(tmp_path):
    rows = [",".join((*row.split(",")[:2], row)) for row in text(",").splitlines()[1:]]
    headers = "left/Joint 1 [deg],left/Joint 2 [deg],right/Joint 1 [deg],right/Joint 2 [deg],x_mm,y_mm"
    with pytest.raises(InputError, match="q1: is missing"):
        read(tmp_path, "\n".join([headers, *rows]))


def test_columns_left_aside_are_named(tmp_path):
    """Where settings map others."""
    said = read(tmp_path, with_columns("bed", "lamp"), "columns: {time_s: bed*2}\n").warnings
    assert "No columns that are known here: lamp. They are kept as they are." in said


def test_headers_of_other_programs_point_to_what_proposes_them(tmp_path):
    """KUKA's angles beside a tip whose columns lack their unit."""
    (tmp_path / "r.csv").write_text("AIPos.A1,x,y\n10,0.1,0.3\n20,0.2,0.4\n", encoding="utf-8")
    with pytest.raises(
        InputError,
        match=r"x: has no unit; write .* \(`linkwright columns FILE --arm ARM --out recording.yaml` proposes it",
    ):
        read_recording(tmp_path / "r.csv", ARM)
