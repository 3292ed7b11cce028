"""arm.yaml at the door: all of its features read and written back, and each mistake one line that helps."""

from __future__ import annotations

import math
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest
import yaml

from linkwright.core.arm.bodies.beams import PropertyNeeded
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.arm.effects.loads.base_tilt import BASE_TILT
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.files.write import arm_to_yaml, write_arm
from linkwright.core.units.quantities import InputError, format_quantity
from tests.arm.builders import CIRCLE, PAPER_MATERIAL, arm_of, rod_lines

FULL_FILE = """
name: everything
gravity: [1 m/s^2, -9.7 m/s^2, 0 m/s^2]
angles: relative
temperature: 35 degC
chain:
  - joint: {type: revolute, range: [-120 deg, 100 deg], clearance: 0.025 mm, backlash: 3.4 arcmin,
            stiffness: 60 kN*m/rad, mass: 6 kg, zero: 12 deg}
    link: {length: 400 mm, section: {shape: circle, diameter: 100 mm}, material: aluminium-6061-t6}
  - joint: {type: prismatic, range: [0 mm, 500 mm], axis: y, clearance: 0.01 mm, backlash: 20 um, stiffness: 3e6 N/m}
    link: {length: 420 mm, section: {shape: rectangular_tube, width: 80 mm, height: 100 mm, thickness: 3 mm},
           material: steel-s355, height_direction: [0, 0, 1]}
  - joint: {axis: [0, 0.6, 0.8]}
    origin: {xyz: [10 mm, -20 mm, 30 mm], rpy: [10 deg, 20 deg, 30 deg]}
    link: {length: 300 mm, section: {shape: tube, diameter: 60 mm, thickness: 4 mm},
           material: {elastic_modulus: 71 GPa, poisson_ratio: 0.33, density: 2700 kg/m^3, yield_strength: 100 MPa}}
  - joint: {}
    dh: {a: 20 mm, d: 115 mm, alpha: 90 deg, theta: -90 deg}
    link: {rigid: true, mass: 12 kg, center_of_mass: 21 mm}
  - joint: {axis: y, stiffness: 1e4 N*m/rad}
    link: {length: 50 mm, rigid: true, mass: 1.5 kg}
tool: {xyz: [30 mm, 0 mm, -10 mm]}
payload: {mass: 0.7 kg, force: [1 N, 2 N, 3 N], moment: [0 N*m, 1 N*m, 0 N*m]}
play: {mode: statistical, level: 0.9, draws: 500, seed: 7}
leave_out: [slope_propagation, shear_deformation]
effects:
  - {effect: thermal_expansion, at: [1, 2, 3]}
  - {effect: joint_compliance, at: 4, stiffness: 20 kN*m/rad}
  - {effect: backlash, at: [5], total: 2 mrad}
"""


def same(first: object, second: object) -> bool:
    """Equal but for the last digits of floats that went through a file."""
    if isinstance(first, float) and isinstance(second, float):
        return math.isclose(first, second, rel_tol=1e-9, abs_tol=1e-12)
    if isinstance(first, tuple) and isinstance(second, tuple):
        return len(first) == len(second) and all(map(same, first, second))
    return first == second


def assert_same_arm(first: Arm, second: Arm) -> None:
    for name in ("name", "gravity", "angles", "temperature", "play", "statistics", "leave_out", "tool"):
        assert same(getattr(first, name), getattr(second, name)), name
    assert same(first.payload.force, second.payload.force)
    assert same(first.payload.moment, second.payload.moment)
    assert same(first.payload.mass, second.payload.mass)
    for a, b in zip(first.joints, second.joints, strict=True):
        for name in (field.name for field in fields(a) if field.compare):
            assert same(getattr(a, name), getattr(b, name)), name
    for a, b in zip(first.links, second.links, strict=True):
        for name in ("length", "direction", "end_rotation", "mass", "center_of_mass", "height_direction"):
            assert same(getattr(a, name), getattr(b, name)), name
        assert (a.section is None) == (b.section is None)
        if a.section is not None and b.section is not None:
            assert a.section.shape == b.section.shape
            for name, value in a.section.given().items():
                assert same(value, b.section.given()[name]), name
        assert a.material == b.material
    for a, b in zip(first.effects, second.effects, strict=True):
        assert (a.effect, a.at) == (b.effect, b.at)
        assert a.parameters.keys() == b.parameters.keys()
        assert all(same(value, b.parameters[name]) for name, value in a.parameters.items())


def round_trip(arm: Arm, folder: Path) -> Arm:
    write_arm(arm, folder / "written.yaml")
    return read_arm(folder / "written.yaml")


def test_everything_is_read_in_si(tmp_path: Path) -> None:
    arm = arm_of(FULL_FILE, tmp_path)
    first, slide, third, wrist, last = arm.joints
    assert first.range == pytest.approx((-2 * math.pi / 3, math.radians(100)))
    assert (first.clearance, first.stiffness, first.mass) == pytest.approx((25e-6, 60e3, 6.0))
    assert first.backlash == pytest.approx(3.4 / 60 * math.pi / 180)
    assert first.zero == pytest.approx(math.radians(12))
    assert (slide.axis, slide.range, slide.backlash, slide.stiffness) == ((0, 1, 0), (0.0, 0.5), 20e-6, 3e6)
    assert third.axis == pytest.approx((0.0, 0.6, 0.8))
    assert third.origin_translation == pytest.approx((0.01, -0.02, 0.03))
    assert third.range == pytest.approx((-math.pi, math.pi))
    assert arm.links[1].height_direction == (0.0, 0.0, 1.0)
    assert wrist.zero == pytest.approx(-math.pi / 2)
    assert arm.links[3].length == pytest.approx(math.hypot(0.02, 0.115))
    assert (arm.links[3].mass, arm.links[3].center_of_mass) == pytest.approx((12.0, 0.021))
    assert last.stiffness == 1e4
    assert arm.tool == pytest.approx((0.03, 0.0, -0.01))
    assert arm.payload.moment == (0.0, 1.0, 0.0)
    assert (arm.play, arm.statistics.level, arm.statistics.draws, arm.statistics.seed) == ("statistical", 0.9, 500, 7)
    assert arm.temperature == pytest.approx(308.15)
    assert arm.leave_out == {"slope_propagation", "shear_deformation"}
    assert arm.effects[0].at == (1, 2, 3)
    assert arm.effects[1].parameters["stiffness"] == pytest.approx(20e3)


@pytest.mark.parametrize(
    "text",
    [
        FULL_FILE,
        FULL_FILE.replace("play: {mode: statistical, level: 0.9, draws: 500, seed: 7}", "play: loaded"),
        f"angles: absolute\n{rod_lines([400, 420])}",
        rod_lines([400, 333.3333333]),
    ],
)
def test_what_is_written_reads_back_the_same(text: str, tmp_path: Path) -> None:
    arm = arm_of(text, tmp_path)
    again = round_trip(arm, tmp_path)
    assert_same_arm(arm, again)
    assert arm_to_yaml(again) == arm_to_yaml(arm)
    q = np.linspace(0.0, 0.4, arm.size)
    assert tip_position(again, q) == pytest.approx(tip_position(arm, q), abs=1e-12)


def test_unknown_mass_is_kept_and_asked_for_only_when_needed(tmp_path: Path) -> None:
    arm = arm_of("chain:\n  - joint: {}\n    link: {length: 400 mm, rigid: true, mass: unknown}\n", tmp_path)
    assert arm.links[0].mass is None
    assert "mass: unknown" in arm_to_yaml(arm)
    assert round_trip(arm, tmp_path).links[0].mass is None
    with pytest.raises(PropertyNeeded, match="link 1"):
        beams_of(arm)


def test_stock_sizes_are_named_and_written_as_named(tmp_path: Path) -> None:
    arm = arm_of("chain:\n  - joint: {}\n    link: {length: 1 m, section: IPE 80, material: steel-s355}\n", tmp_path)
    section = arm.links[0].section
    assert section is not None
    # EN 10365: IPE 80 has A = 7.64 cm^2 and I_y = 80.1 cm^4.
    assert section.properties(0.3).area == pytest.approx(7.64e-4, rel=0.01)
    assert section.properties(0.3).second_moment_y == pytest.approx(80.1e-8, rel=0.01)
    assert "IPE 80" in arm_to_yaml(arm)


@pytest.mark.parametrize("unit", ["rad", "mrad", "deg", "arcmin"])
def test_a_size_at_its_limit_is_read_back_from_any_unit(unit: str, tmp_path: Path) -> None:
    """0.15 rad are 8.59436692696 deg as they are written, which is more than 0.15 rad by a rounding."""
    text = rod_lines([400, 420]) + "effects:\n  - {effect: base_tilt, about_x: %s, about_z: %s}\n"
    about_x, _, about_z = BASE_TILT.parameters
    low, high = (format_quantity(limit, "angle", unit) for limit in (about_x.lower, about_z.upper))
    (entry,) = round_trip(arm_of(text % (low, high), tmp_path), tmp_path).effects
    assert entry.parameters == pytest.approx({"about_x": about_x.lower, "about_z": about_z.upper}, rel=1e-11)
    assert entry.parameters["about_x"] >= about_x.lower
    assert entry.parameters["about_z"] <= about_z.upper
    with pytest.raises(InputError, match="must lie between"):
        arm_of(text % (low, format_quantity(about_z.upper * (1.0 + 1e-6), "angle", unit)), tmp_path)


def test_defaults_are_those_of_the_documentation(tmp_path: Path) -> None:
    arm = arm_of(rod_lines([400]), tmp_path)
    assert arm.gravity == (0.0, -9.81, 0.0)
    assert (arm.angles, arm.play, arm.temperature) == ("relative", "worst", 293.15)
    assert arm.joints[0].axis == (0.0, 0.0, 1.0)
    assert arm.joints[0].stiffness is None
    rail = "chain: [{joint: {type: prismatic, range: [0 mm, 1 m]}, link: {length: 1 m, rigid: true, mass: 1 kg}}]"
    slide = arm_of(rail, tmp_path)
    assert slide.joints[0].axis == (1.0, 0.0, 0.0)


GOOD = f"""name: arm
temperature: 20 degC
chain:
  - joint: {{type: revolute, range: [-90 deg, 90 deg], backlash: 1 mrad}}
    link: {{length: 400 mm, section: {CIRCLE}, material: {PAPER_MATERIAL}}}
payload: {{mass: 1 kg}}
play: worst
"""


def test_the_file_that_the_mistakes_start_from_is_right(tmp_path: Path) -> None:
    assert evaluate(arm_of(GOOD, tmp_path)).max_error > 0.0


@pytest.mark.parametrize(
    ("right", "wrong", "says"),
    [
        ("payload:", "paylod:", ["paylod", "payload"]),
        ("backlash: 1 mrad", "backlsh: 1 mrad", ["joint", "backlsh", "backlash"]),
        ("length: 400 mm", "length: 400", ["length", "mm"]),
        ("length: 400 mm", "length: 400 kg", ["length", "mm"]),
        ("length: 400 mm", "length: -400 mm", ["length", "negative"]),
        ("length: 400 mm, ", "", ["length", "missing"]),
        ("length: 400 mm, section", "length: .inf, section", ["length"]),
        ("mass: 1 kg", "mass: 1 N", ["payload.mass", "kg"]),
        ("mass: 1 kg", "mass: -1 kg", ["payload.mass", "negative"]),
        ("backlash: 1 mrad", "backlash: -1 mrad", ["backlash", "negative"]),
        ("backlash: 1 mrad", "stiffness: 0 N*m/rad", ["stiffness", "positive"]),
        ("backlash: 1 mrad", "stiffness: 5 N/m", ["stiffness"]),
        ("diameter: 100 mm", "diameter: -100 mm", ["section.diameter", "positive"]),
        ("shape: circle, diameter: 100 mm", "shape: circel, diameter: 100 mm", ["shape", "circle"]),
        ("shape: circle, diameter: 100 mm", "shape: tube, diameter: 50 mm, thickness: 30 mm", ["thickness"]),
        ("shape: circle, diameter: 100 mm", "shape: circle, radius: 50 mm", ["radius", "circle"]),
        (PAPER_MATERIAL, "steel-s356", ["material", "steel-s355"]),
        ("[-90 deg, 90 deg]", "[90 deg, -90 deg]", ["range", "deg"]),
        ("[-90 deg, 90 deg]", "[90 deg]", ["range"]),
        ("type: revolute", "type: revolut", ["type", "revolute"]),
        ("type: revolute, range: [-90 deg, 90 deg], backlash: 1 mrad", "type: prismatic", ["range", "mm"]),
        ("play: worst", "play: wrost", ["play", "worst"]),
        ("play: worst", "leave_out: [slope_propagaton]", ["leave_out[1]", "slope_propagation"]),
        ("play: worst", "effects: [{effect: thermal_expansio}]", ["effects[1]", "thermal_expansion"]),
        ("play: worst", "effects: [{effect: thermal_expansion, at: 2}]", ["effects[1]", "at", "1"]),
        ("play: worst", "effects: [{effect: backlash, totl: 1 mrad}]", ["effects[1]", "totl", "total"]),
        ("play: worst", "effects: [{effect: backlash, total: 1}]", ["effects[1]", "total", "rad"]),
        ("play: worst", "effects: [{effect: joint_compliance, stiffness: 0 N*m/rad}]", ["stiffness", "positive"]),
        ("play: worst", "effects: [{effect: backlash, total: -1 mrad}]", ["total", "negative"]),
        ("play: worst", "effects: [{effect: link_bending}]", ["effects[1]", "already"]),
        ("play: worst", "effects: [{effect: backlash, at: 1}]", ["effects[1]", "already"]),
        ("length: 400 mm", "length: 400 mm, height_direction: [1, 0, 0]", ["chain[1].link.height_direction", "across"]),
        ("temperature: 20 degC", "temperature: 20", ["temperature", "degC"]),
        ("temperature: 20 degC", "gravity: [0 m/s^2]", ["gravity", "three"]),
        ("temperature: 20 degC", "angles: relativ", ["angles", "relative"]),
        ("type: revolute", "type: revolute, axis: [0, 0, 0]", ["axis"]),
        ("type: revolute", "type: revolute, axis: w", ["axis"]),
    ],
)  # fmt: skip
def test_mistakes_are_one_line_with_file_key_and_what_would_do(
    right: str, wrong: str, says: list[str], tmp_path: Path
) -> None:
    assert GOOD.count(right) == 1
    with pytest.raises(InputError) as caught:
        arm_of(GOOD.replace(right, wrong), tmp_path)
    message = str(caught.value)
    assert "\n" not in message
    for part in ["arm.yaml", *says]:
        assert part in message, message


@pytest.mark.parametrize(
    "text", ["chain: []", "name: x", "chain: {}", "[]", "", "chain: [1]", "chain: [{joint: {}}]\nx: {"]
)
def test_files_that_hold_no_arm_are_refused_in_one_line(text: str, tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        arm_of(text, tmp_path)
    assert "\n" not in str(caught.value)


def test_absolute_angles_need_parallel_axes(tmp_path: Path) -> None:
    text = "angles: absolute\n" + rod_lines([400, 420], joint=", axis: y")
    with pytest.raises(InputError, match="absolute"):
        arm_of(text, tmp_path)


def test_a_link_cannot_be_rigid_and_have_a_section(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="rigid"):
        arm_of(GOOD.replace("length: 400 mm", "length: 400 mm, rigid: true"), tmp_path)


def test_origins_in_place_of_lengths_make_the_same_arm(tmp_path: Path) -> None:
    """Joint origins as in URDF: the link before runs to the next origin."""
    body = f"section: {CIRCLE}, material: steel-s355"
    origins = arm_of(
        f"chain:\n  - joint: {{}}\n    link: {{{body}}}\n"
        f"  - joint: {{axis: y}}\n    origin: {{xyz: [0 mm, 300 mm, 400 mm], rpy: [0 deg, 0 deg, 90 deg]}}\n"
        f"    link: {{length: 200 mm, {body}}}\n",
        tmp_path,
    )
    assert origins.links[0].length == pytest.approx(0.5)
    assert origins.links[0].direction == pytest.approx((0.0, 0.6, 0.8))
    assert tip_position(origins, [0.0, 0.0])[0] == pytest.approx([0.0, 0.5, 0.4], abs=1e-12)


def test_an_effect_that_was_left_out_may_come_back_where_it_is_named(tmp_path: Path) -> None:
    text = GOOD.replace("play: worst", "leave_out: [link_bending]\neffects: [{effect: link_bending, at: 1}]")
    assert evaluate(arm_of(text, tmp_path)).max_error == evaluate(arm_of(GOOD, tmp_path)).max_error


def test_an_origin_turns_a_slide_in_dh_form_too(tmp_path: Path) -> None:
    """Rot(rpy) Rz(theta) Tz(q) Tx(a): a quarter turn about x lays the slide along -y."""
    arm = arm_of(
        "chain: [{joint: {type: prismatic, range: [0 mm, 500 mm]}, dh: {a: 100 mm, theta: 90 deg},"
        " origin: {rpy: [90 deg, 0 deg, 0 deg]}, link: {rigid: true, mass: 1 kg}}]",
        tmp_path,
    )
    assert tip_position(arm, [0.3])[0] == pytest.approx([0.0, -0.3, 0.1], abs=1e-12)


@pytest.mark.parametrize(
    ("joint", "link", "key"),
    [("axis: x", "", "joint.axis"), ("", ", direction: [0, 1, 0]", "link.direction"),
     ("", ", end_rotation: [0 deg, 0 deg, 90 deg]", "link.end_rotation")],
)  # fmt: skip
def test_dh_and_what_it_says_already_contradict_each_other(joint: str, link: str, key: str, tmp_path: Path) -> None:
    text = f"chain: [{{joint: {{{joint}}}, dh: {{a: 100 mm}}, link: {{rigid: true, mass: 1 kg{link}}}}}]"
    with pytest.raises(InputError, match=key):
        arm_of(text, tmp_path)


def test_what_is_written_is_plain_yaml(tmp_path: Path) -> None:
    content = yaml.safe_load(arm_to_yaml(arm_of(FULL_FILE, tmp_path)))
    assert content["chain"][0]["joint"]["backlash"] == "3.4 arcmin"
    assert content["chain"][0]["link"]["length"] == "400 mm"


def test_a_slide_is_prismatic(tmp_path: Path) -> None:
    """By either word it is the same arm, and it is written by the one of the format."""
    text = "chain:\n  - joint: {{type: {}, range: [0 mm, 500 mm]}}\n    link: {{length: 200 mm, mass: 1 kg}}\n"
    arms = [arm_of(text.format(word), tmp_path) for word in ("slide", "prismatic")]
    assert arms[0].joints == arms[1].joints
    assert arm_to_yaml(arms[0]) == arm_to_yaml(arms[1])


def test_height_direction_within_a_section_is_told_where_it_belongs(tmp_path: Path) -> None:
    section = "{shape: circle, diameter: 50 mm, height_direction: up}"
    text = f"chain:\n  - joint: {{}}\n    link: {{length: 1 m, section: {section}, material: steel-s355}}\n"
    with pytest.raises(InputError, match=r"link\.section\.height_direction: is of the link, .* beside section"):
        arm_of(text, tmp_path)
