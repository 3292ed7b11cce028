"""The kinds of files that people hand in: good ones to begin with, and how the program reads one."""

from __future__ import annotations

import re
import zipfile
from collections.abc import Sequence
from functools import cache
from pathlib import Path

import linkwright as lw
from arm.actuators import load_actuators
from arm.chain.chain import Arm
from arm.files.read import read_arm
from arm.files.write import arm_to_yaml
from catalogues import freecad_cards, materials_csv, stock_csv
from diagnose.reading.read import read_recording
from linkwright.commands.compensate import read_poses
from linkwright.output.diagnosis_folder import learned_from
from linkwright.output.files import made_by
from materials.catalogue import load_layer
from optimize.problem import read_problem
from sections.stock.tables import read_file

from .kind import EXAMPLES, ROOT, Kind, each_of, example
from .planning import planning_kinds
from .served import served_kinds

ENTRY, ROW = re.compile(r"\n  [^ ]"), re.compile(r"\n      - \[")


@cache
def kinds() -> dict[str, Kind]:
    """Every kind of file by name."""
    arms = tuple(
        example(f"{name}/arm.yaml") for name in ("welding-arm", "hidden-backlash", "several-loads", "real/ur10")
    )
    problems = tuple(example(f"{name}/problem.yaml") for name in ("welding-arm", "left-out-slopes", "several-loads"))
    welding = read_arm(EXAMPLES / "welding-arm/arm.yaml")
    drives = read_arm(EXAMPLES / "hidden-backlash/arm.yaml")
    rows = example("hidden-backlash/recording.csv").splitlines(keepends=True)[:24]
    recordings = ("".join(rows), "".join(rows).replace(",", ";"), "".join(rows).replace(",", "\t"))
    cable = example("cable-drag/recording.yaml")
    return {
        "arm": Kind({"arm.yaml": (*arms, UNUSUAL_ARM)}, _arm, {}),
        "problem": Kind({"problem.yaml": (*problems, UNUSUAL_PROBLEM)}, _problem, {"arm.yaml": arm_to_yaml(welding)}),
        "materials": Kind(
            {"own.yaml": _shipped("materials/catalogue/*.yaml")}, lambda at: load_layer(at / "own.yaml"), {}
        ),
        "sections": Kind({"own.yaml": _shipped("sections/stock/*.yaml")}, lambda at: read_file(at / "own.yaml"), {}),
        "actuators": Kind(
            {"own.yaml": (*_shipped("arm/actuators/*.yaml"), PRICES)},
            lambda at: load_actuators([at / "own.yaml"], user=False),
            {},
        ),
        "workbook": Kind(
            _book("".join(rows)),
            lambda at: read_recording(_workbook(at), drives),
            {},
        ),
        "materials_book": Kind(_book(MATERIALS), lambda at: materials_csv.read_table(_workbook(at)), {}),
        "sizes_book": Kind(_book(STOCK), lambda at: stock_csv.read_table(_workbook(at)), {}),
        "recording": Kind(
            {"r.csv": recordings, "recording.yaml": (cable, UNUSUAL_SETTINGS, "sigma: 15 um\n")},
            lambda at: read_recording(at / "r.csv", drives),
            {},
        ),
        "result": Kind(
            {"diagnosis.json": (DIAGNOSIS,), "residuals.csv": ("".join(rows),)},
            _result,
            {
                "arm.yaml": arm_to_yaml(drives),
                "problem.yaml": "arm: arm.yaml\nrobust: worst\nuncertain: {diagnosis: diagnosis.json}\n",
            },
        ),
        "exchange": Kind(
            {
                "card.FCMat": (CARD, "[General]\nName = a\n[Mechanical]\nYoungsModulus = 70 GPa\n"),
                "materials.csv": (MATERIALS,),
                "stock.csv": (STOCK,),
                "poses.csv": ("q1_deg,q2_deg,q3_deg\n0,10,20\n5,15,25\n",),
                "robot.urdf": (example("urdf/tabletop.urdf"),),
            },
            lambda at: _exchange(at, welding),
            {},
        ),
        **planning_kinds(drives),
        **served_kinds(drives),
    }


def _shipped(pattern: str) -> tuple[str, ...]:
    """The first entries of the shipped files: what odd files cost grows with their size."""
    return tuple(_begun(path.read_text(encoding="utf-8")) for path in sorted(ROOT.glob(pattern)))


def _begun(text: str) -> str:
    """The text as far as an entry, or in one long table a row, ends beyond 2500 letters."""
    ends = ENTRY.search(text, 2500) or ROW.search(text, 2500)
    return text if len(text) <= 5000 or ends is None else text[: ends.start() + 1]


def _sheet(rows: Sequence[str]) -> str:
    """Rows of a table as a sheet of a workbook: numbers as numbers, all else as texts."""
    lines: list[str] = []
    for number, row in enumerate(rows, start=1):
        forms = ["<c><v>{}</v></c>" if _NUMBER.fullmatch(cell) else TEXT for cell in row.strip().split(",")]
        cells = (form.format(cell) for form, cell in zip(forms, row.strip().split(","), strict=True))
        lines.append(f'<row r="{number}">' + "".join(cells) + "</row>")
    body = "\n".join(lines)
    return f'<worksheet xmlns="{MAIN}"><sheetData>\n{body}\n</sheetData></worksheet>\n'


def _book(table: str) -> dict[str, tuple[str, ...]]:
    """The parts of a workbook that holds a table."""
    sheet = _sheet(table.splitlines())
    return {"sheet1.xml": (sheet,), "workbook.xml": (WORKBOOK,), "workbook.xml.rels": (RELATIONS,)}


def _workbook(at: Path) -> Path:
    """The parts put together as a spreadsheet program does."""
    with zipfile.ZipFile(at / "r.xlsx", "w") as made:
        made.writestr("[Content_Types].xml", TYPES)
        made.writestr(
            "_rels/.rels",
            RELATIONS.replace("worksheet", "officeDocument", 1).replace("worksheets/sheet1", "xl/workbook"),
        )
        for name, part in (
            ("xl/workbook.xml", "workbook.xml"),
            ("xl/_rels/workbook.xml.rels", "workbook.xml.rels"),
            ("xl/worksheets/sheet1.xml", "sheet1.xml"),
        ):
            made.write(at / part, name)
    return at / "r.xlsx"


def _arm(at: Path) -> object:
    """What is read is written so that it reads back."""
    arm = read_arm(at / "arm.yaml")
    (at / "back.yaml").write_text(arm_to_yaml(arm), encoding="utf-8")
    return read_arm(at / "back.yaml")


def _problem(at: Path) -> object:
    return read_problem(at / "problem.yaml")


def _result(at: Path) -> object:
    made_by(at / "diagnosis.json")
    learned_from(at / "arm.yaml", read_arm(at / "arm.yaml"))
    return read_problem(at / "problem.yaml")


def _exchange(at: Path, arm: Arm) -> object:
    """Each of the files, and the first refusal."""
    each_of(
        lambda: freecad_cards.read_card(at / "card.FCMat"),
        lambda: materials_csv.read_table(at / "materials.csv"),
        lambda: stock_csv.read_table(at / "stock.csv"),
        lambda: read_poses(at / "poses.csv", arm),
        lambda: lw.import_arm(at / "robot.urdf", tip="tip"),
    )


_NUMBER = re.compile(r"[-+0-9.eE]+")
TEXT = '<c t="inlineStr"><is><t>{}</t></is></c>'
MAIN = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
_OFFICE = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
WORKBOOK = (
    f'<workbook xmlns="{MAIN}" xmlns:r="{_OFFICE}">\n'
    '<sheets>\n<sheet name="run" sheetId="1" r:id="rId1"/>\n</sheets></workbook>\n'
)
RELATIONS = (
    '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">\n'
    f'<Relationship Id="rId1" Type="{_OFFICE}/worksheet" Target="worksheets/sheet1.xml"/>\n</Relationships>\n'
)
_KIND = "application/vnd.openxmlformats-officedocument.spreadsheetml"
TYPES = (
    '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
    '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    f'<Override PartName="/xl/workbook.xml" ContentType="{_KIND}.sheet.main+xml"/>'
    f'<Override PartName="/xl/worksheets/sheet1.xml" ContentType="{_KIND}.worksheet+xml"/></Types>'
)
PRICES = (
    "format_version: 1\nprices: {RV-20E: {value: 900 EUR, spread: [800 EUR, 1000 EUR], date: 2026-03, source: x}}\n"
)
UNUSUAL_ARM = """\
name: all that may stand in a file
gravity: [0 m/s^2, 0 m/s^2, -9.81 m/s^2]
temperature: 30 degC
chain:
  - joint: {type: revolute, range: [-90 deg, 90 deg], clearance: 0.02 mm, backlash: 1 arcmin, mass: 2 kg}
    dh: {a: 0 mm, d: 300 mm, alpha: 90 deg, theta: 0 deg}
    link: {rigid: true, mass: unknown}
  - joint: {type: prismatic, axis: [1, 0, 0], range: [0 mm, 500 mm], stiffness: 50 N/um}
    link: {length: 400 mm, section: IPE 80, material: steel-s355, masses: [{mass: 1 kg, at: [10 mm, 0 mm, 5 mm]}]}
  - joint: {range: [-2 rad, 2 rad], stiffness: 60 kN*m/rad, zero: 1 deg}
    origin: {xyz: [0 mm, 0 mm, 10 mm], rpy: [0 deg, 90 deg, 0 deg]}
    link:
      length: 300 mm
      section: {shape: tube, diameter: [60 mm, 40 mm], thickness: 3 mm}
      material: {elastic_modulus: 71 GPa, poisson_ratio: 0.33, density: 2700 kg/m^3}
payload: {mass: 0.7 kg, force: [0 N, 5 N, 0 N]}
play: {mode: statistical, draws: 200, level: 0.95}
tool: {xyz: [0 mm, 0 mm, 80 mm]}
leave_out: [slope_propagation]
effects:
  - {effect: encoder_offset, at: 1, offset: 0.05 deg}
  - {effect: thermal_expansion, at: [2, 3]}
"""
UNUSUAL_PROBLEM = """\
arm: arm.yaml
minimize: mass
relative_to: {payload: {mass: 2 kg}}
workspace: {box: [[0.6 m, 0.2 m], [0.7 m, 0.3 m]]}
load_cases: [{payload: {mass: 3 kg}}, {payload: {mass: 0 kg}, force: [43 N, 0 N, 0 N]}]
subject_to:
  max_error: "<= 1 mm"
  mass: [">= 1 kg", "<= 26 kg"]
  safety_factor: ">= 2"
  wall_slenderness: off
  link_length: [200 mm, 700 mm]
  reach: "== 1240 mm"
choose:
  section: [circle, tube]
  material: {where: {magnetic: false, service_temperature: ">= 50 degC", family: [aluminium]}}
  same: [section]
robust: worst
uncertain: {elastic_modulus: 5 %, stiffness: [10 %, 10 %, 20 %]}
"""
UNUSUAL_SETTINGS = """\
columns: {q1_deg: "q1_deg*1.0 + 0", q2_deg: "(`q2_deg` - 0)**1", x_mm: x_mm, y_mm: "-(-y_mm)"}
ignore: [time_s]
rows: ["q1_deg < 1000"]
separator: comma
decimal: "."
comment: "#"
skip_rows: 0
encoding: latin-1
time_format: iso
sigma: 15 um
frame: free
tool: known
sides: from_order
"""
DIAGNOSIS = """\
{"made_by": "linkwright diagnose 0.1.0", "verdict": "named", "missing": [{"effect": "joint_compliance", "at": [2],
 "parameters": {"compliance_2": {"parameter": "compliance", "value": 2e-5, "at": 2, "ci95": [1.9e-5, 2.1e-5]}}}]}
"""
CARD = """\
General:
  Name: "own alloy"
Models:
  LinearElastic:
    YoungsModulus: "70 GPa"
    PoissonRatio: "0.3"
    Density: "2700 kg/m^3"
"""
MATERIALS = """\
name,elastic_modulus,poisson_ratio,density,source
mine,70 GPa,0.3,2700 kg/m^3,a data sheet
"""
STOCK = """\
name,family,shape,source,diameter_mm,thickness_mm
mine,CHS,tube,a data sheet,60.3,3.2
"""
