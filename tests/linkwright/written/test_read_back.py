"""What the program writes and reads too is read back before it is called written; what differs is told."""

from __future__ import annotations

import ast
import pkgutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import linkwright as lw
from linkwright.cli import run
from linkwright.core.arm.files.read_back import differences
from linkwright.core.arm.files.write import arm_to_yaml
from linkwright.output.files import NotAsWritten, ReadBack, write_each
from tests.arm.builders import arm_of
from tests.arm.test_files import FULL_FILE
from tests.test_house import ROOT
from tests.two_arms import arm_text

WELDING = ROOT / "examples" / "welding-arm"
PROBLEM = """arm: arm.yaml
workspace: {path: [[600 mm, 300 mm], [700 mm, 300 mm]]}
subject_to: {mass: "<= 30 kg", section_size: [20 mm, 150 mm]}
choose: {section: [circle], same: [size]}
"""


@pytest.fixture
def problem(tmp_path: Path) -> Path:
    """A small problem in a folder with its arm."""
    (tmp_path / "arm.yaml").write_text((WELDING / "arm.yaml").read_text())
    (tmp_path / "problem.yaml").write_text(PROBLEM)
    return tmp_path / "problem.yaml"


def altered(home: str, name: str, change: Callable[[str], str], patch: pytest.MonkeyPatch) -> None:
    """Let what a function of a module, or of a class there, writes be something else."""
    where = pkgutil.resolve_name(home)
    right = getattr(where, name)
    patch.setattr(where, name, lambda *given, **more: change(right(*given, **more)))


CHANGED = {
    "thickness: 4 mm": "thickness: 4.00001 mm",
    "diameter: 100 mm": "diameter: 100.0001 mm",
    "stiffness: 60 kN*m/rad": "stiffness: 60.0001 kN*m/rad",
    "backlash: 3.4 arcmin": "backlash: 3.40001 arcmin",
    "poisson_ratio: 0.33": "poisson_ratio: 0.3301",
    "material: steel-s355": "material: steel-s275",
    "leave_out: [shear_deformation, slope_propagation]": "leave_out: [slope_propagation]",
    "level: 0.9": "level: 0.91",
    "mass: 0.7 kg": "mass: 0.70001 kg",
    "total: 2 mrad": "total: 2.001 mrad",
}


@pytest.mark.parametrize("part", CHANGED)
def test_whatever_differs_in_an_arm_file_is_told(part: str, tmp_path: Path) -> None:
    meant = arm_of(FULL_FILE, tmp_path)
    text = arm_to_yaml(meant).replace("2 mrad", "2 mrad")
    assert not list(differences(meant, arm_of(text, tmp_path)))
    written = part if part in text else part.replace("total: 2 mrad", "total: 0.1145915590262 deg")
    assert written in text
    changed = CHANGED[part] if part == written else "total: 0.1146 deg"
    assert list(differences(meant, arm_of(text.replace(written, changed, 1), tmp_path)))


def test_a_design_that_does_not_read_back_is_shown_written_and_told(
    problem: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Another wall is written than was found: status 1, the answer on the screen, every file in the folder."""
    altered("linkwright.output.arm_file", "arm_to_yaml", lambda text: text.replace("420 mm", "421 mm"), monkeypatch)
    out = problem.parent / "result"
    assert run(["optimize", str(problem), "--out", str(out)]) == 1
    told = capsys.readouterr()
    assert "what binds" in told.out
    assert "written:" not in told.out
    (line,) = [item for item in told.err.splitlines() if "read back" in item]
    assert "result/arm.yaml: is written, but does not read back as what was found: chain[2].link.length" in line
    assert {item.name for item in out.iterdir()} == {"arm.yaml", "report.html", "result.json"}


@pytest.mark.slow
def test_a_design_that_cannot_be_read_is_told_with_the_reason(
    problem: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    altered("linkwright.output.arm_file", "arm_to_yaml", lambda text: text.replace("6061", "6062"), monkeypatch)
    assert run(["optimize", str(problem), "--out", str(problem.parent / "result")]) == 1
    assert "chain[1].link.material: there is no material" in capsys.readouterr().err


@pytest.mark.slow
def test_a_design_is_held_to_the_figures_promised_of_it(problem: Path) -> None:
    """The file says the arm that was meant, and the promise is another's."""
    best = lw.optimize(problem)
    place = problem.parent / "new.yaml"
    best.arm.to_file(best.found.after).hold(_written(best.arm.to_yaml(), place))
    with pytest.raises(NotAsWritten, match=r"mass .* was promised, .* is had; .*error at worst pose 1"):
        best.arm.to_file(best.found.before).hold(place)


def _written(text: str, place: Path) -> Path:
    place.write_text(text)
    return place


def test_all_files_are_written_before_one_of_them_is_complained_of(tmp_path: Path) -> None:
    bad = ReadBack("bad", lambda path: [f"{path.name} differs"])
    good = ReadBack("good", lambda path: () if path.read_text() == "good" else ["no"])
    with pytest.raises(NotAsWritten, match=r"a\.yaml: is written, but .*: a\.yaml differs"):
        write_each({tmp_path / "a.yaml": bad, tmp_path / "b.yaml": good, tmp_path / "c.txt": "plain"})
    assert {item.name: item.read_text() for item in tmp_path.iterdir()} == {
        "a.yaml": "bad", "b.yaml": "good", "c.txt": "plain"}  # fmt: skip


def test_a_recording_is_read_back_to_its_last_digit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made = lw.simulate(WELDING / "arm.yaml", poses=6)
    made.save(tmp_path / "rec.csv")
    back = lw.read_recording(tmp_path / "rec.csv", WELDING / "arm.yaml")
    np.testing.assert_allclose(back.found.tip, made.found.tip, rtol=0.0, atol=0.51e-8)
    altered("linkwright.face.recording", "recording_text", _last_digit_up, monkeypatch)
    with pytest.raises(NotAsWritten, match=r"rec\.csv: is written, but .*y_mm in row 2 was"):
        made.save(tmp_path / "rec.csv")


def _last_digit_up(text: str) -> str:
    head, first, *rest = text.splitlines()
    *cells, last = first.split(",")
    return "\n".join([head, ",".join([*cells, f"{float(last) + 2e-5:.5f}"]), *rest]) + "\n"


def test_settings_of_a_recording_are_read_back_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made = lw.simulate(WELDING / "arm.yaml", poses=6, frame_free=True)
    altered("linkwright.face.recording", "settings_text", lambda text: f"{text}tool: free\n", monkeypatch)
    with pytest.raises(NotAsWritten, match="settings"):
        made.save(tmp_path / "rec.csv")


@pytest.mark.parametrize(
    ("right", "wrong", "says"),
    [
        ("0.42 0.0 0.0", "0.4201 0.0 0.0", "a tip is .* away"),
        ('mass value="8.4', 'mass value="8.5', "moved and .* move"),
        ('type="revolute"', 'type="fixed"', "joints and reads"),
    ],
)
def test_an_export_is_imported_again(right: str, wrong: str, says: str, tmp_path: Path) -> None:
    result = lw.export_arm(WELDING / "arm.yaml", to="urdf")
    result.save(tmp_path / "arm.urdf")
    from dataclasses import replace

    assert right in result.text
    worse = replace(result, found=replace(result.found, text=result.text.replace(right, wrong, 1)))
    with pytest.raises(NotAsWritten, match=says):
        worse.save(tmp_path / "arm.urdf")
    assert (tmp_path / "arm.urdf").read_text() == worse.text


@pytest.mark.parametrize(
    ("command", "name", "change"),
    [
        ("materials", "steel-s355", ("210 GPa", "211 GPa")),
        ("sections", "IPE 80", ("IPE 80, 80", "IPE 80, 80.02")),
        ("actuators", "RV-20E", ("kg", "g")),
    ],
)
def test_an_exported_catalogue_is_imported_again(
    command: str, name: str, change: tuple[str, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    for ending in ("yaml", "csv"):
        assert run([command, "export", name, "--out", str(tmp_path / f"own.{ending}")]) == 0
    keyed = ("linkwright.core.catalogues.keyed:KeyedEditor", "text")
    writer = ("linkwright.commands.catalogues.sections", "rows_text") if command == "sections" else keyed
    written = (tmp_path / "own.yaml").read_text()
    assert change[0] in written, written
    altered(*writer, lambda text: text.replace(*change, 1), monkeypatch)
    capsys.readouterr()
    assert run([command, "export", name, "--out", str(tmp_path / "own.yaml")]) == 1
    told = capsys.readouterr().err
    assert "own.yaml: is written, but does not read back as what was found" in told
    assert name in told


def test_arms_are_written_by_the_one_way_that_reads_them_back() -> None:
    """No module of the commands writes the text of an arm but through `arm_file`."""
    room = ROOT / "linkwright"
    uses = {
        path.relative_to(room).as_posix()
        for path in room.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") in ("arm_to_yaml", "write_arm")
    }
    assert "output/arm_file.py" in uses
    assert uses <= {"output/arm_file.py", "output/diagnosis_folder.py", "face/arm.py"}  # the last two: texts


@pytest.mark.parametrize("tip", [None, "left", "right"])
def test_several_arms_on_a_torso_are_read_back_whole(tip: str | None, tmp_path: Path) -> None:
    place = _written(arm_text(), tmp_path / "two.yaml")
    lw.read_arm(place, tip=tip).save(tmp_path / "back.yaml")
    assert lw.read_arm(tmp_path / "back.yaml", tip=tip).model.tip == lw.read_arm(place, tip=tip).model.tip
