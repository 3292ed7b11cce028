"""The kinds of files that people hand in: good ones to begin with, and how the program reads one."""

from __future__ import annotations

import re
import zipfile
from collections.abc import Sequence
from functools import cache
from pathlib import Path

import linkwright as lw
from linkwright.core.arm.actuators import load_actuators
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.files.write import arm_to_yaml
from linkwright.core.catalogues import freecad_cards, materials, stock_csv
from linkwright.core.diagnose.reading.read import read_recording
from linkwright.core.materials.catalogue import load_layer
from linkwright.core.optimize.problem import read_problem
from linkwright.core.sections.stock.tables import read_file
from linkwright.face.compensation import read_poses
from linkwright.output.diagnosis_folder import learned_from
from linkwright.output.files import made_by

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
        "arm": Kind({"arm.yaml": (*arms, UNUSUAL_ARM, BALANCED_ARM, TORSO)}, _arm, {}),
        "problem": Kind({"problem.yaml": (*problems, *PROBLEMS)}, _problem, {"arm.yaml": arm_to_yaml(welding)}),
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
        "materials_book": Kind(_book(MATERIALS), lambda at: materials.MATERIALS.read_table(_workbook(at)), {}),
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
    parts = {"sheet1.xml": (sheet,), "workbook.xml": (WORKBOOK,), "workbook.xml.rels": (RELATIONS,)}
    return {**parts, "damage.txt": DAMAGES}


def _workbook(at: Path) -> Path:
    """The parts put together and packed as a spreadsheet program does, then bytes of the archive exchanged: each line
    of the damage says where, in ten-thousandths of its length, and for which."""
    with zipfile.ZipFile(at / "r.xlsx", "w", zipfile.ZIP_DEFLATED) as made:
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
    packed = bytearray((at / "r.xlsx").read_bytes())
    told = (at / "damage.txt").read_bytes().decode("utf-8", "replace")
    for place, byte in re.findall(r"\b([0-9]{1,4})\b[^0-9\n]+([0-9]{1,3})\b", told):
        packed[int(place) * len(packed) // 10_000] = int(byte) % 256
    (at / "r.xlsx").write_bytes(packed)
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
        lambda: materials.MATERIALS.read_table(at / "materials.csv"),
        lambda: stock_csv.read_table(at / "stock.csv"),
        lambda: read_poses(at / "poses.csv", arm),
        lambda: lw.import_arm(at / "robot.urdf", tip="tip"),
    )


DAMAGES = ("", "0 80\n0 80\n")
"""The first byte of an archive is 80, so that these leave it whole."""
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
BALANCED_ARM = """\
name: what balances, follows and runs out
machining: {per_kilogram: 6 EUR/kg, per_metre: 40 EUR/m, per_part: 25 EUR, date: 2026-03}
chain:
  - joint: {type: prismatic, axis: [1, 0, 0], range: [200 mm, 900 mm]}
    link: {length: 1 m, section: {shape: tube, diameter: 90 mm, thickness: 4 mm}, material: steel-s355, bends_over: q1}
  - joint:
      range: [-90 deg, 60 deg]
      mass: 1 kg
      motor: {mass: 4 kg, on: 1}
      balancer: {stiffness: 8 kN/m, free_length: 250 mm, on_link: 120 mm, on_base: 400 mm, base_at: 90 deg}
    link:
      length: 400 mm
      section: {shape: tube, diameter: 60 mm, thickness: 3 mm}
      material: {laminate: {ply: cfrp-unidirectional, angles: [0 deg, 45 deg, -45 deg, 0 deg]}}
      masses: [{mass: 8 kg, at: [-250 mm, 40 mm, 0 mm], on: joint}]
      cost: 120 EUR
  - joint: {range: [-150 deg, 0 deg], balancer: {torque: 30 N*m, greatest_at: 10 deg}, passive: false}
    origin: free
    link: {length: 300 mm, rigid: true, mass: 2 kg}
  - joint: {follows: "-(q2 + q3)", stiffness: 90 kN*m/rad}
    link: {length: 100 mm, rigid: true, mass: 1 kg}
payload: {mass: 2 kg}
"""
TORSO = """\
name: two arms on a torso
gravity: [0 m/s^2, 0 m/s^2, -9.81 m/s^2]
chain:
  - joint: {axis: z, range: [-170 deg, 170 deg], stiffness: 20 kN*m/rad}
    link: {length: 400 mm, direction: [0, 0, 1], rigid: true, mass: 10 kg}
branches:
  - name: left
    origin: {xyz: [0 m, 0.2 m, 0.05 m]}
    payload: {mass: 1 kg}
    tool: {xyz: [0 mm, 0 mm, 80 mm]}
    chain:
      - joint: {axis: y, range: [-90 deg, 90 deg], actuator: RV-20E}
        link: {length: 300 mm, rigid: true, mass: 2.5 kg}
      - joint: {axis: y, follows: "-q1"}
        link: {length: 100 mm, rigid: true, mass: 1 kg}
  - name: right
    origin: {xyz: [0 m, -0.2 m, 0.05 m], rpy: [0 deg, 0 deg, 90 deg]}
    chain: [{joint: {axis: y, range: [-90 deg, 90 deg]}, link: {length: 300 mm, rigid: true, mass: 2.5 kg}}]
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
BALANCE_TO_CHOOSE = """\
arm: arm.yaml
subject_to:
  mass: "<= 26 kg"
  section_size: [20 mm, 150 mm]
  taper: [0.4, 1]
  tip_stiffness: {at_least: 500 N/mm, poses: [[0 deg, 30 deg, 0 deg]]}
  aspect: "<= 3"
choose:
  section: [tube]
  material: [steel-s355]
  balancer: [{joint: 1, torque: [0 N*m, 200 N*m], greatest_at: 0 deg}]
  counterweight: [{link: 2, mass: [0 kg, 20 kg], at: [-300 mm, -100 mm]}]
  motor:
    - {joint: 2, mass: 4 kg, on: [joint, base]}
    - {joint: 3, places: [{on: joint, mass: 2 kg}, {on: 2, mass: 2.5 kg, stiffness: 9 kN*m/rad, cost: 150 EUR}]}
robust: 95 %
uncertain: {elastic_modulus: 5 %}
"""
SIZES_TO_CHOOSE = """\
arm: arm.yaml
workspace: {path: [[600 mm, 100 mm], [600 mm, 200 mm]], error: across}
subject_to: {mass: "<= 26 kg", cost: "<= 900 EUR"}
choose:
  section: [tube]
  material: [steel-s355, aluminium-6082-t6]
  sizes:
    - stock
    - [CHS 60.3x3, CHS 48.3x3]
    - {diameter: [40 mm, 50 mm], thickness: {from: 2 mm, to: 8 mm, step: 0.5 mm}}
"""
PROBLEMS = (UNUSUAL_PROBLEM, BALANCE_TO_CHOOSE, SIZES_TO_CHOOSE)
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
