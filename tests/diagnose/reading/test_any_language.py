"""Columns in a language that nobody taught the reader: known by numbers, units and signs."""

from pathlib import Path

import numpy as np
import openpyxl
import pytest

from linkwright.core.diagnose.columns.proposed_file import propose
from linkwright.core.diagnose.reading.read import read_recording
from linkwright.core.units.quantities import InputError
from tests.diagnose.reading.test_foreign_files import ANGLES, ARM, TIPS, text

FRENCH = [
    "N°",
    "Temps (s)",
    "Axe 1 (°)",
    "Axe 2 (°)",
    "Sens 1",
    "Sens 2",
    "Charge (kg)",
    "X mesuré (mm)",
    "Y mesuré (mm)",
]
POLISH = ["Lp", "Czas (s)", "Oś 1 (°)", "Oś 2 (°)", "Zwrot 1", "Zwrot 2", "Obciążenie (kg)", "X (mm)", "Y (mm)"]
SPANISH = [
    "N.º",
    "Tiempo [s]",
    "Eje 1 [°]",
    "Eje 2 [°]",
    "Lado 1",
    "Lado 2",
    "Carga [kg]",
    "X medida [mm]",
    "Y medida [mm]",
]
FINNISH = [
    "Nro",
    "Aika (s)",
    "Akseli 1 (°)",
    "Akseli 2 (°)",
    "Suunta 1",
    "Suunta 2",
    "Kuorma (kg)",
    "X (mm)",
    "Y (mm)",
]
OURS = ["q1_deg", "q2_deg", "dir1", "dir2", "payload_kg", "x_mm", "y_mm"]


def workbook(folder: Path, header: list[str], extra: tuple[str, ...] = ()) -> Path:
    """Two sheets, a title, angles as text with decimal commas beside lengths as numbers, signs for sides."""
    book = openpyxl.Workbook()
    first = book.active
    assert first is not None
    first.title = "À lire"
    first.append(["Étalonnage du robot n° 12"])
    sheet = book.create_sheet("Mesures")
    sheet.append(["Relevé du 12 mars 2026"])
    sheet.append([])
    sheet.append([*header, *extra])
    for k, (q, tip) in enumerate(zip(np.degrees(ANGLES), TIPS, strict=True)):
        angles = [f"{value:.5f}".replace(".", ",") for value in q]
        sides = ["+" if k % 2 else "-", "-" if k % 2 else "+"]
        sheet.append([k + 1, 2.5 * k, *angles, *sides, 3.5, *(1e3 * tip).tolist(), *angles[: len(extra)]])
    book.save(folder / "r.xlsx")
    return folder / "r.xlsx"


@pytest.mark.parametrize("header", [FRENCH, POLISH, SPANISH, FINNISH])
def test_a_workbook_of_another_language(tmp_path, header):
    path = workbook(tmp_path, header)
    proposal = propose(path, ARM)
    by_header = {item.header: item for item in proposal.meanings}
    assert [by_header[name].ours for name in header[2:]] == OURS
    assert all(by_header[name].guessed == (header is FINNISH) for name in header[2:4])
    (tmp_path / "recording.yaml").write_text(proposal.settings)
    result = read_recording(path, ARM)
    # As a spreadsheet numbers them, the blank line below the title too.
    said = "The header stands in line 3. Lines above the header are not used."
    assert said in result.warnings
    assert result.q == pytest.approx(ANGLES, abs=1e-6)
    assert result.tip == pytest.approx(TIPS, abs=1e-9)
    assert np.unique(result.sides).tolist() == [-1.0, 1.0]


def test_two_series_in_degrees_are_no_guess(tmp_path):
    """Which of them was measured nobody says."""
    path = workbook(tmp_path, FINNISH, ("Kulma 1 (°)", "Kulma 2 (°)"))
    assert not any(item.what.startswith("q") for item in propose(path, ARM).meanings)
    with pytest.raises(InputError, match="q1: is missing"):
        read_recording(path, ARM)


@pytest.mark.parametrize(
    ("word", "unit"),
    [
        ("Eje", "(grados)"),
        ("Articulación", "[grados]"),
        ("Asse", "[gradi]"),
        ("Giunto", "(gradi)"),
        ("Oś", "[stopnie]"),
        ("Przegub", "(stopnie)"),
        ("Achse", "(Grad)"),
        ("Gelenk", "Grad"),
        ("Axe", "(degrés)"),
        ("Articulation", "(degrés)"),
        ("Eixo", "(graus)"),
        ("Gewricht", "(graden)"),
        ("Osa", "(stupně)"),
        ("Axel", "[grader]"),
        ("Winkel der Achse", "[Grad]"),
        ("Angle de l'axe", "(degrés)"),
    ],
)
def test_words_for_axes_and_degrees(tmp_path, word, unit):
    """They are taken without a map, and said; beside them other headers are their columns' own."""
    headers = f"{word} 1 {unit},{word} 2 {unit},x_mm,y_mm"
    (tmp_path / "r.csv").write_text(text(",", headers), encoding="utf-8")
    assert not any(item.guessed for item in propose(tmp_path / "r.csv", ARM).meanings)
    result = read_recording(tmp_path / "r.csv", ARM)
    assert result.q == pytest.approx(ANGLES, abs=1e-6)
    assert f"Headers are taken for ours: {word} 1 {unit} as q1_deg and 1 more alike." in result.warnings


def test_a_word_for_axes_beside_others_is_left_to_units(tmp_path):
    """`Desgaste` is wear, and no coordinate."""
    lines = text(",").splitlines()
    rows = [f"{line},1,2" for line in lines[1:]]
    (tmp_path / "r.csv").write_text("\n".join([f"{lines[0]},Desgaste eje 1 (mm),Desgaste eje 2 (mm)", *rows]))
    assert [item.what for item in propose(tmp_path / "r.csv", ARM).meanings][4:] == ["other", "other"]


def test_commanded_angles_do_not_count(tmp_path):
    """`consigne` is French for a command."""
    path = workbook(tmp_path, FRENCH, ("Axe consigne 1 (°)", "Axe consigne 2 (°)"))
    assert [item.header for item in propose(path, ARM).meanings if item.what in ("q1", "q2")] == FRENCH[2:4]


def test_bare_columns_by_their_place(tmp_path):
    """As many columns of numbers as there are joints, beside the tip's."""
    rows = "\n".join(
        f"{a:.4f},{b:.4f},{1e3 * x:.3f},{1e3 * y:.3f}" for (a, b), (x, y) in zip(np.degrees(ANGLES), TIPS, strict=True)
    )
    (tmp_path / "r.csv").write_text(f"shoulder,elbow,x_mm,y_mm\n{rows}\n")
    assert [item.ours for item in propose(tmp_path / "r.csv", ARM).meanings] == ["q1_deg", "q2_deg", "x_mm", "y_mm"]
    (tmp_path / "r.csv").write_text(f"shoulder,elbow,x_mm,y_mm,note\n{rows.replace(chr(10), ',7' + chr(10))},7\n")
    assert not any(item.what.startswith("q") for item in propose(tmp_path / "r.csv", ARM).meanings)


def test_a_motion_log_of_another_language(tmp_path):
    """Torques and currents by their units; `N.m` is French."""
    for last, ours in (("Couple {} (N.m)", "tau{}_Nm"), ("Courant {} (A)", "current{}_A")):
        header = ["Temps (s)", *(f"{name.format(k)}" for name in ("Axe {} (rad)", last) for k in (1, 2))]
        (tmp_path / "log.csv").write_text(
            ",".join(header) + "\n" + "\n".join(f"{0.01 * k},0.1,0.2,3,4" for k in range(9))
        )
        proposal = propose(tmp_path / "log.csv", ARM)
        assert [item.ours for item in proposal.meanings][1:] == ["q1_rad", "q2_rad", ours.format(1), ours.format(2)]
        assert proposal.motion
