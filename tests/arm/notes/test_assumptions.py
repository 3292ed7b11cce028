"""What is taken for granted is said: gravity, payloads that load cases leave off, bearings, heights that lie level."""

import json

import pytest
import yaml

import linkwright as lw
from linkwright.core.arm.actuators import USER_ACTUATORS
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.files.write import arm_to_yaml
from linkwright.core.optimize.problem import read_problem
from linkwright.core.units.quantities import InputError
from linkwright.results.document import Paragraph
from linkwright.results.evaluation import describe

BAR = {"shape": "rectangle", "width": "30 mm", "height": "60 mm"}
UPRIGHT = ["0 m/s^2", "0 m/s^2", "-9.81 m/s^2"]


def arm_file(folder, joint=None, link=None, **keys):
    """A file of a lone joint about y, and its link."""
    joint = {"axis": "y", "range": ["-30 deg", "30 deg"], "stiffness": "80 kN*m/rad", **(joint or {})}
    link = {"length": "400 mm", "section": BAR, "material": "steel-s355", **(link or {})}
    content = {"chain": [{"joint": joint, "link": link}], "payload": {"mass": "5 kg"}, "gravity": UPRIGHT, **keys}
    path = folder / "arm.yaml"
    path.write_text(yaml.safe_dump({key: value for key, value in content.items() if value is not None}), "utf-8")
    return path


def notes(path):
    return lw.evaluate(lw.read_arm(path)).notes


def test_gravity_of_an_arm_in_space_that_names_none(tmp_path):
    assert any("no gravity is given" in note for note in notes(arm_file(tmp_path, gravity=None)))
    assert not any("gravity" in note for note in notes(arm_file(tmp_path)))
    assert not any("gravity" in note for note in notes(arm_file(tmp_path, {"axis": "z"}, gravity=None)))


@pytest.mark.parametrize(
    ("case", "said"),
    [
        ("{force: [10 N, 0 N, 0 N]}", True),
        ("{payload: {force: [10 N, 0 N, 0 N]}}", True),
        ("{payload: {mass: 0 kg}, force: [10 N, 0 N, 0 N]}", False),
        ("{mass: 2 kg}", False),
    ],
)
def test_a_load_case_that_names_no_payload(tmp_path, case, said):
    """It is without the arm's, which is said; no payload that is named as none."""
    arm_file(tmp_path)
    problem = tmp_path / "problem.yaml"
    problem.write_text(f"arm: arm.yaml\nload_cases: [{{payload: {{mass: 5 kg}}}}, {case}]\n", "utf-8")
    asked = read_problem(problem)
    assert [case.leaves_off for case in asked.load_cases] == [0.0, 5.0 if said else 0.0]
    result = lw.evaluate(lw.read_arm(tmp_path / "arm.yaml"), problem=problem)
    assert any("load case 2 names no payload and so leaves off the arm's 5 kg" in note for note in result.notes) == said
    assert json.loads(result.to_json())["notes"] == list(result.notes)
    told = [item.text for item in describe(result.found).items if isinstance(item, Paragraph)]
    assert [item for item in told if item.startswith("note: ")] == [f"note: {note}" for note in result.notes]


def test_bearings_of_drives_whose_tilting_nobody_knows(tmp_path):
    """Of an arm in space whose drive gives; not of a stiff one, nor where it is said or left out."""
    text = "the bearing of joint 1 counts as rigid against tilting: none is given"
    assert any(text in note for note in notes(arm_file(tmp_path)))
    for joint, keys in (
        ({"tilting_stiffness": "300 kN*m/rad"}, {}),
        ({"stiffness": "80 kN*m/rad"}, {"leave_out": ["lateral_compliance"]}),
        ({}, {"effects": [{"effect": "lateral_compliance", "compliance": "1e-6 rad/(N*m)"}]}),
    ):
        assert not any("tilting" in note for note in notes(arm_file(tmp_path, joint, **keys)))
    named = arm_file(tmp_path, {"actuator": "RV-20E", "stiffness": None})
    named.write_text(named.read_text("utf-8").replace("stiffness: null", "clearance: 0 mm"), "utf-8")
    assert any("the catalogue has none for RV-20E" in note for note in notes(named))


OWN = """format_version: 1
maker: Turner
references: {sheet: Data sheet 7}
actuators:
  T-1: {gear: strain wave, rated_torque: 50 N*m, stiffness: 16 kN*m/rad, backlash: 0 arcmin, mass: 1 kg, source: sheet,
        tilting_stiffness: 130 kN*m/rad}
"""


def test_a_bearing_of_the_catalogue_counts(tmp_path, monkeypatch):
    """As that of the joint does, which goes before it; and is written back only where it differs."""
    (tmp_path / "own.yaml").write_text(OWN, "utf-8")
    monkeypatch.setenv(USER_ACTUATORS.variable, str(tmp_path / "own.yaml"))
    assert lw.actuators["T-1"].tilting_stiffness == pytest.approx(130e3)
    assert lw.actuators.table.set_index("name").loc["T-1", "tilting_stiffness_Nm_per_rad"] == pytest.approx(130e3)
    path = arm_file(tmp_path, {"actuator": "T-1", "axis": "z"})
    arm = read_arm(path)
    assert arm.joints[0].tilting_stiffness == pytest.approx(130e3)
    assert "tilting_stiffness" not in arm_to_yaml(arm)
    own = read_arm(arm_file(tmp_path, {"actuator": "T-1", "axis": "z", "tilting_stiffness": "200 kN*m/rad"}))
    assert own.joints[0].tilting_stiffness == pytest.approx(200e3)
    path.write_text(arm_to_yaml(own), "utf-8")
    assert read_arm(path).joints[0].tilting_stiffness == pytest.approx(200e3)


@pytest.mark.parametrize(
    ("joint", "said"),
    [
        ({"tilting_stiffness": "0 N*m/rad"}, "must be positive"),
        (
            {"type": "prismatic", "range": ["0 mm", "10 mm"], "stiffness": "1 N/um", "tilting_stiffness": "1 kN*m/rad"},
            "of a slide write rail_pitch",
        ),
    ],
)
def test_a_tilting_stiffness_that_none_has(tmp_path, joint, said):
    with pytest.raises(InputError, match=said):
        read_arm(arm_file(tmp_path, joint))


def test_a_height_that_lies_level_is_said_unless_the_file_says_so(tmp_path):
    """With an upright axis, of a section that bends otherwise on its side; not of a square, nor where it is up."""
    text = "the height of the section points level (along y) in link 1, not up as the word suggests"
    assert any(text in note for note in notes(arm_file(tmp_path, {"axis": "z"})))
    for link in (
        {"height_direction": "up"},
        {"height_direction": [0, 1, 0]},
        {"section": {"shape": "rectangle", "width": "40 mm", "height": "40 mm"}},
        {"section": {"shape": "circle", "diameter": "40 mm"}},
    ):
        assert not any("height" in note for note in notes(arm_file(tmp_path, {"axis": "z"}, link)))
    assert not any("height" in note for note in notes(arm_file(tmp_path)))


def test_what_links_can_win_is_said_before_the_first_round(tmp_path):
    """A drive that gives beside a stout bar: most of the error is not the link's."""
    link = {"section": {"shape": "tube", "diameter": "80 mm", "thickness": "5 mm"}}
    arm_file(tmp_path, {"stiffness": "5 kN*m/rad"}, link)
    problem = tmp_path / "problem.yaml"
    problem.write_text(
        "arm: arm.yaml\nsubject_to: {mass: <= 6 kg, section_size: [40 mm, 120 mm], thickness: [2 mm, 8 mm]}\n"
        "choose: {section: [tube], material: [steel-s355]}\n",
        "utf-8",
    )
    heard = []
    best = lw.optimize(
        lw.read_problem(problem),
        begun=lambda before: heard.append(before.rigid_links_mm),
        log=lambda _: heard.append("round"),
    )
    drive = 5.0 * 9.81 * 0.4**2 / 5e3
    assert heard[0] == pytest.approx(1e3 * drive, rel=1e-6)
    assert heard[1:] == ["round"] * (len(heard) - 1) != []
    assert best.after.max_error_mm > heard[0]


def test_a_spindle_that_runs_level_is_said(tmp_path):
    """Behind two upright axes a slide without an axis runs along the link before it."""
    spindle = {"type": "slide", "range": ["-150 mm", "0 mm"]}

    def said(first, third):
        joints = [{"axis": axis, "range": ["-9 deg", "9 deg"], "stiffness": "80 kN*m/rad"} for axis in (first, "z")]
        chain = [{"joint": joint, "link": {"length": "99 mm", "rigid": True, "mass": "1 kg"}} for joint in joints]
        chain.append({"joint": third, "link": {"length": "50 mm", "rigid": True, "mass": "1 kg"}})
        return any("slides level" in note for note in notes(arm_file(tmp_path, chain=chain)))

    assert said("z", spindle)
    assert not said("z", spindle | {"axis": "z"})
    assert not said("y", spindle)
