"""Problems with every kind of choice: the design that is written is read back, and is what was promised."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import linkwright as lw
from linkwright.cli import run

pytestmark = pytest.mark.slow

ARM = """name: trial
chain:
  - joint: {range: [-90 deg, 90 deg], mass: 3 kg, stiffness: 60000 N*m/rad%(joint)s}
    link: {length: 500 mm, section: {shape: tube, diameter: 70 mm, thickness: 4 mm}, material: %(first)s%(link)s}
  - joint: {range: [-120 deg, 120 deg], mass: 2 kg, stiffness: 30000 N*m/rad}
    link: {length: 400 mm, section: {shape: tube, diameter: 60 mm, thickness: 4 mm}, material: aluminium-6061-t6}
payload: {mass: 5 kg}
"""
LIMITS = "mass: '<= 6 kg', section_size: [20 mm, 90 mm], thickness: [2 mm, 10 mm]"
ALLOY = "{elastic_modulus: 71 GPa, poisson_ratio: 0.33, density: 2700 kg/m^3, yield_strength: 250 MPa, cost: 4 EUR/kg}"
WARM = "{elastic_modulus: {table: [[0 degC, 72 GPa], [40 degC, 70 GPa]]}, poisson_ratio: 0.33, density: 2700 kg/m^3}"
PLY = "{elastic_modulus: 135 GPa, transverse_modulus: 9 GPa, shear_modulus: 5 GPa, poisson_ratio: 0.3, "
PLY += "density: 1550 kg/m^3, isotropic: false}"
CHOICES: dict[str, dict[str, str]] = {
    "a material in place": {"choose": f"section: [tube], material: [steel-s355, {ALLOY}]"},
    "a material in place alone": {"choose": f"section: [tube], material: {ALLOY}"},
    "a material in place over temperature": {"choose": f"section: [tube], material: [{WARM}]"},
    "the same in place on both links": {"choose": f"section: [tube], material: [{ALLOY}], same: [material]",
                                        "first": ALLOY},
    "a material in place that stays": {"choose": "section: [tube]", "first": ALLOY},
    "a laminate": {"choose": "section: [tube], material: [aluminium-6061-t6, {laminate: "
                             "{ply: cfrp-unidirectional, angles: [0 deg, 30 deg, -30 deg, 0 deg]}}]"},
    "a laminate of a ply in place": {"choose": f"section: [tube], material: [{{name: wound, laminate: {{ply: {PLY}, "
                                               "angles: [0 deg, 45 deg, -45 deg], thicknesses: [2 mm, 1 mm, 1 mm]}}]"},
    "materials by condition": {"choose": "section: [tube], material: {where: {magnetic: false, family: [aluminium]}}"},
    "an own catalogue": {"choose": "section: [tube], material: [steel-s355, our-alloy]", "catalogue": "yes"},
    "a laminate of an own ply": {"choose": "section: [tube], material: [{laminate: {ply: our-ply, "
                                           "angles: [0 deg, 45 deg, -45 deg]}}]", "catalogue": "yes"},
    "shapes": {"choose": "section: [tube, rectangular_tube, i_section]"},
    "drives": {"choose": "actuator: [RV-20E, RV-40E]"},
    "a taper": {"choose": "section: [tube]", "limits": ", taper: [0.4, 1]"},
    "a taper in place": {"choose": f"section: [rectangular_tube], material: [{ALLOY}]", "limits": ", taper: [0.4, 1]"},
    "listed sizes": {"choose": "section: [tube], sizes: {diameter: [50 mm, 60 mm, 70 mm], thickness: [3 mm, 5 mm]}"},
    "listed sizes in place": {"choose": "section: [tube], sizes: {diameter: [50 mm, 70 mm], thickness: [3 mm, 5 mm]}, "
                                        f"material: [steel-s355, {ALLOY}]"},
    "stock sizes": {"choose": "section: [tube], sizes: stock, material: [steel-s355]"},
    "a counterweight": {"choose": "counterweight: [{link: 1, at: -200 mm, mass: [0 kg, 8 kg]}]"},
    "free lengths": {"choose": f"section: [tube], material: [{ALLOY}]",
                     "limits": ", link_length: [300 mm, 600 mm], reach: '== 900 mm'"},
    "sizes to be had": {"choose": f"section: [tube], material: [{ALLOY}]", "options": "--round stock"},
    "sizes on a grid": {"choose": f"section: [tube], material: [{ALLOY}]", "options": "--round 0.5mm"},
    "prices and effects": {"choose": f"section: [tube], material: [{ALLOY}]",
                           "joint": ", cost: 200 EUR, backlash: 3 arcmin, clearance: 0.02 mm",
                           "link": ", cost: {value: 12 EUR, date: 2026-01}"},
}  # fmt: skip
OWN = """format_version: 1
references: {ours: measured here}
materials:
  our-alloy: {source: ours, elastic_modulus: 75 GPa, poisson_ratio: 0.33, density: 2650 kg/m^3, yield_strength: 300 MPa}
  our-ply: {source: ours, elastic_modulus: 140 GPa, transverse_modulus: 8 GPa, shear_modulus: 4.5 GPa,
            poisson_ratio: 0.3, density: 1560 kg/m^3, isotropic: false}
"""


@pytest.mark.parametrize("name", CHOICES)
def test_the_file_of_a_design_is_the_design(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    said = {"joint": "", "link": "", "first": "aluminium-6061-t6", "limits": "", "options": "", **CHOICES[name]}
    (tmp_path / "arm.yaml").write_text(ARM % said)
    problem = tmp_path / "problem.yaml"
    limits = f"subject_to: {{{LIMITS}{said['limits']}}}"
    problem.write_text(f"arm: arm.yaml\n{limits}\nchoose: {{{said['choose']}}}\n")
    (tmp_path / "own.yaml").write_text(OWN)
    more = ["--catalogue", str(tmp_path / "own.yaml")] if "catalogue" in said else []
    options = said["options"].replace("0.5mm", "0.5 mm").split(" ", 1) if said["options"] else []
    out = tmp_path / "result"
    status = run(["optimize", str(problem), "--out", str(out), *more, *options])
    told = capsys.readouterr()
    assert status == 0, told.err

    written = json.loads((out / "result.json").read_text())
    promised = (written.get("rounded") or {}).get("max_error_mm") or written["max_error_mm"]
    back = lw.read_arm(out / "arm.yaml", catalogue=tmp_path / "own.yaml" if more else None)
    asked = lw.read_problem(problem, catalogue=tmp_path / "own.yaml" if more else None)
    assert lw.evaluate(back, asked).max_error_mm == pytest.approx(promised, rel=1e-7)


def test_other_commands_write_what_is_read_of_materials_in_place(tmp_path: Path) -> None:
    """A front's designs, exports and recordings of an arm with a material, and a laminate, in place."""
    said = {"joint": "", "link": "", "first": ALLOY}
    (tmp_path / "arm.yaml").write_text(ARM % said)
    choose = "section: [tube], material: [{laminate: {ply: cfrp-unidirectional, angles: [0 deg, 30 deg, -30 deg]}}]"
    problem = tmp_path / "problem.yaml"
    problem.write_text(f"arm: arm.yaml\nsubject_to: {{{LIMITS}, max_error: '<= 20 mm'}}\nchoose: {{{choose}}}\n")
    front = tmp_path / "front"
    assert run(["tradeoff", str(problem), "--accuracy", "0.4", "--out", str(front)]) == 0
    for file in sorted((front / "points").iterdir()):
        assert lw.evaluate(file).max_error_mm > 0.0
        assert run(["export", str(file), "--to", "urdf", "--out", str(tmp_path / "arm.urdf")]) == 0
    last = str(file)
    assert run(["import", str(tmp_path / "arm.urdf"), "--tip", "tip", "--out", str(tmp_path / "back.yaml")]) == 0
    assert run(["simulate", last, "--poses", "12", "--out", str(tmp_path / "rec.csv")]) == 0
    assert run(["diagnose", last, str(tmp_path / "rec.csv"), "--out", str(tmp_path / "diagnosis")]) == 0
    assert lw.evaluate(tmp_path / "diagnosis" / "arm.yaml").max_error_mm == pytest.approx(
        lw.evaluate(last).max_error_mm, rel=0.2
    )
