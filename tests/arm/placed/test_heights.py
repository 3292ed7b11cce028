"""Where sections' heights point, and `height_direction: up` of an arm file."""

import math

import numpy as np
import pytest

from linkwright.core.arm.chain.kinematics import place
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.files.write import arm_to_yaml
from linkwright.core.arm.placed.heights import heights
from linkwright.core.arm.placed.views import stands
from linkwright.core.units.quantities import InputError

TUBE = "{shape: rectangular_tube, width: 30 mm, height: 90 mm, thickness: 3 mm}"


def file_of(tmp_path, entries, gravity="[0 m/s^2, 0 m/s^2, -9.81 m/s^2]"):
    """An arm file with such joints and such keys of links beside their section."""
    lines = [f"gravity: {gravity}", "chain:"]
    for joint, link in entries:
        lines.append(f"  - joint: {{{joint}, range: [-60 deg, 60 deg], stiffness: 50 kN*m/rad}}")
        lines.append(f"    link: {{length: 300 mm, section: {TUBE}, material: steel-s355{link}}}")
    path = tmp_path / "arm.yaml"
    path.write_text("\n".join([*lines, "payload: {mass: 3 kg}"]) + "\n")
    return path


def test_up_is_against_gravity_whatever_the_joint(tmp_path):
    """For an upright axis, a level one and one that leans, after a turned link; by the frames that are computed."""
    up = ", height_direction: up"
    joints = ("axis: z", "axis: -y", "axis: [0, -0.6, 0.8], zero: 20 deg")
    path = file_of(
        tmp_path, [(joints[0], up + ", end_rotation: [25 deg, 10 deg, 0 deg]"), *((j, up) for j in joints[1:])]
    )
    arm = read_arm(path)
    for link in place(arm, [0.0] * 3).links:
        along, height = np.array(link.along), np.array(link.height)
        assert height @ along == pytest.approx(0.0, abs=1e-12)
        assert height[2] == pytest.approx(math.hypot(along[0], along[1]))  # as near to up as across the link can be
    assert [item.words for item in heights(arm)] == ["up"] * 3
    text = arm_to_yaml(arm)
    assert text.count("height_direction: up") == 3
    path.write_text(text)
    for link, again in zip(arm.links, read_arm(path).links, strict=True):
        assert again.height_direction == pytest.approx(link.height_direction)


def test_a_section_stood_upright_bends_less_under_its_weight(tmp_path):
    """By bh^3 - (b - 2t)(h - 2t)^3 over the same with b and h exchanged: of a cantilever that the axis holds level."""
    alone = {}
    for name, keys in (("level", ""), ("up", ", height_direction: up")):
        alone[name] = evaluate(read_arm(file_of(tmp_path, [("axis: z", keys)]))).by_effect["link_bending"]

    def second_moment(b, h, t=3.0):
        return (b * h**3 - (b - 2 * t) * (h - 2 * t) ** 3) / 12

    ratio = second_moment(30.0, 90.0) / second_moment(90.0, 30.0)
    assert alone["level"] / alone["up"] == pytest.approx(ratio, rel=1e-9)


def test_words_of_a_planar_arm_and_of_an_upright_link(tmp_path):
    """A planar file has its heights up; a column has none that could be."""
    planar = read_arm(file_of(tmp_path, [("axis: z", "")], "[0 m/s^2, -9.81 m/s^2, 0 m/s^2]"))
    assert [height.words for height in heights(planar)] == ["up"]
    column = read_arm(file_of(tmp_path, [("axis: z", ", direction: [0, 0, 1]")]))
    assert [height.words for height in heights(column)] == ["level (along y)"]
    free = read_arm(file_of(tmp_path, [("axis: z", "")], "[0 m/s^2, 0 m/s^2, 0 m/s^2]"))
    assert [height.words for height in heights(free)] == ["along y"]
    assert stands(free, [0.5])[0].height == pytest.approx([-math.sin(0.5), math.cos(0.5), 0.0])


@pytest.mark.parametrize(
    ("link", "gravity", "said"),
    [
        (", direction: [0, 0, 1], height_direction: up", "[0 m/s^2, 0 m/s^2, -9.81 m/s^2]", "stands upright"),
        (", height_direction: up", "[0 m/s^2, 0 m/s^2, 0 m/s^2]", "where gravity is zero"),
        (", height_direction: upwards", "[0 m/s^2, 0 m/s^2, -9.81 m/s^2]", "is up, or a vector in the link's frame"),
        (", height_direction: [1, 0, 0]", "[0 m/s^2, 0 m/s^2, -9.81 m/s^2]", "lies along the link"),
    ],
)
def test_what_cannot_be_up_is_one_line(tmp_path, link, gravity, said):
    with pytest.raises(InputError, match=said) as caught:
        read_arm(file_of(tmp_path, [("axis: z", link)], gravity))
    assert "chain[1].link.height_direction" in str(caught.value)
