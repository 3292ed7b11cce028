"""Effects of a rail that a joint slides on: against closed forms."""

import math
from dataclasses import replace
from types import MappingProxyType

import pytest

from linkwright.core.arm.chain.chain import Arm, EffectEntry, Joint, Link, LoadCase
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.files.read import read_arm
from linkwright.paper.corrected import worst_error

pytestmark = pytest.mark.slow


def one_slide(effect, value, *, spatial=False):
    """A slide along x that carries a rigid link of 0.8 m and an effect of its rail."""
    parameter = EFFECTS[effect].parameters[0].name
    entry = EffectEntry(effect, (1,), MappingProxyType({parameter: value}))
    axis = (0.0, 1.0, 0.0) if spatial else (0.0, 0.0, 1.0)
    joints = (Joint("prismatic", axis=(1.0, 0.0, 0.0), range=(0.0, 2.0)), Joint(axis=axis))
    return Arm("slide", joints, (Link(0.0, mass=0.0), Link(0.8, mass=0.0)), effects=(entry,))


@pytest.mark.parametrize("play", ["worst", "loaded"])
def test_a_rail_that_is_not_straight_shifts_the_tip_by_as_much(play):
    """Wherever the arm points, and whatever it carries: a shape is not moved by a load."""
    arm = replace(one_slide("rail_straightness", 5e-5), play=play, payload=LoadCase(force=(0.0, 30.0, 0.0)))
    assert worst_error(arm) == pytest.approx(5e-5, rel=1e-9)


@pytest.mark.parametrize("play", ["worst", "loaded"])
def test_a_carriage_that_tilts_turns_what_it_carries(play):
    """Its angle times the distance from the carriage, not from where the rail begins."""
    arm = replace(one_slide("rail_pitch", 1e-4), play=play)
    assert worst_error(arm) == pytest.approx(1e-4 * 0.8, rel=1e-6)


def test_in_space_the_carriage_shifts_and_tilts_every_way():
    """Across the rail on a disc; about the rail and both axes across it."""
    assert not one_slide("rail_pitch", 1e-4, spatial=True).planar()
    straight = worst_error(one_slide("rail_straightness", 5e-5, spatial=True))
    assert straight == pytest.approx(5e-5, rel=1e-6)
    tilted = worst_error(one_slide("rail_pitch", 1e-4, spatial=True))
    # The link turns in the x-z plane: halfway between them |psi x p| is greatest, sqrt(3) for psi = (1, 1, -1).
    assert tilted == pytest.approx(1e-4 * 0.8 * math.sqrt(3.0), rel=1e-4)


@pytest.mark.parametrize("turned", [0.0, -math.pi / 4.0, 0.3])
def test_a_tilt_goes_with_the_slide_that_a_joint_before_it_turns(turned):
    """A SCARA's quill: pitch and yaw 290 mm above the tip, and where that is off the quill's axis by 100 mm roll too:
    |psi x r|^2 is greatest for psi = (1, 1, -1) a, which is a^2 (z^2 + (z + x)^2 + x^2)."""
    entry = EffectEntry("rail_pitch", (2,), MappingProxyType({"angle": 5e-5}))
    shoulder = Joint(range=(turned, turned + 1e-9))
    slide = Joint("prismatic", axis=(0.0, 0.0, -1.0), range=(0.0, 0.1))
    for offset in (0.0, 0.1):
        links = (Link(0.6, mass=0.0), Link(0.29, mass=0.0, direction=(0.0, 0.0, -1.0)), Link(offset, mass=0.0))
        arm = Arm("scara", (shoulder, slide, Joint(range=(0.0, 1e-9))), links, effects=(entry,))
        by_hand = 5e-5 * math.sqrt(0.29**2 + (0.29 + offset) ** 2 + offset**2)
        assert worst_error(arm) == pytest.approx(by_hand, rel=1e-6)


@pytest.mark.parametrize("effect", ["rail_straightness", "rail_pitch"])
def test_effects_of_a_rail_leave_turning_joints_alone(effect):
    parameter = EFFECTS[effect].parameters[0]
    entry = EffectEntry(effect, (), MappingProxyType({parameter.name: 1e-3}))
    turning = Arm("turning", tuple(Joint() for _ in range(3)), tuple(Link(0.4, mass=0.0) for _ in range(3)))
    assert worst_error(replace(turning, effects=(entry,))) == 0.0
    assert worst_error(one_slide(effect, 0.0)) == 0.0
    assert parameter.lower <= parameter.typical[0] <= parameter.typical[1] <= parameter.upper


def test_effects_of_a_rail_are_read_from_a_file(tmp_path):
    """A tilt is an angle, though its joint slides."""
    (tmp_path / "arm.yaml").write_text(
        "chain:\n"
        "  - joint: {type: prismatic, range: [0 mm, 2000 mm]}\n    link: {length: 0 mm, rigid: true, mass: 20 kg}\n"
        "  - joint: {type: revolute}\n    link: {length: 800 mm, rigid: true, mass: 0 kg}\n"
        "effects:\n  - {effect: rail_straightness, at: 1, deviation: 0.05 mm}\n"
        "  - {effect: rail_pitch, at: 1, angle: 0.1 mrad}\n",
        encoding="utf-8",
    )
    read = read_arm(tmp_path / "arm.yaml")
    assert [dict(entry.parameters) for entry in read.effects] == [
        {"deviation": pytest.approx(5e-5)},
        {"angle": pytest.approx(1e-4)},
    ]
    # At its longest lever the tilt moves the tip across, as the rail does: x is the rail, so the arm lies along it.
    assert worst_error(read) == pytest.approx(5e-5 + 0.8e-4, rel=1e-6)
