"""Heat, field, rail and two arms: against closed forms and brute force."""

import math
from dataclasses import replace
from types import MappingProxyType

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm, EffectEntry, Joint, Link, LoadCase
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.files.read import read_arm
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.paper.corrected import PaperArm, worst_error
from linkwright.paper.extended.tables import Extended
from linkwright.paper.extended.workplace import (
    EVERY_PART,
    Rail,
    dual_table,
    heat_table,
    magnetism,
    pair_errors,
    rail_table,
)
from linkwright.paper.postures import Postures, around
from linkwright.paper.printed import read_paper

pytestmark = pytest.mark.slow

LENGTHS = (0.4, 0.42, 0.42)


def rigid(*, backlash=0.0, clearance=0.0, sag=0.0, payload=None):
    """Massless links of the paper's lengths; `sag` is what a force of 1 N through a drive's give moves joint 1 by."""
    joints = tuple(Joint(backlash=backlash, clearance=clearance, stiffness=sag or None) for _ in LENGTHS)
    return Arm("rigid", joints, tuple(Link(each, mass=0.0) for each in LENGTHS), payload=payload or LoadCase())


def one_slide(effect, value, *, spatial=False):
    """A slide along x that carries a rigid link of 0.8 m and an effect of its rail."""
    parameter = EFFECTS[effect].parameters[0].name
    entry = EffectEntry(effect, (1,), MappingProxyType({parameter: value}))
    axis = (0.0, 1.0, 0.0) if spatial else (0.0, 0.0, 1.0)
    joints = (Joint("prismatic", axis=(1.0, 0.0, 0.0), range=(0.0, 2.0)), Joint(axis=axis))
    return Arm("slide", joints, (Link(0.0, mass=0.0), Link(0.8, mass=0.0)), effects=(entry,))


@pytest.fixture(scope="module")
def arms():
    return PaperArm(read_paper())


# ---- heat and field


def test_growth_and_sag_add_as_the_sides_of_a_right_angle(arms):
    """At full stretch: growth along the arm, sag across it; the paper's growth is some 22 times its own sag."""
    table = heat_table(arms, ("aluminium-6061-t6", "steel-s355"))
    for _, elastic, growth, ratio, both, _ in table.rows:
        assert ratio == pytest.approx(growth / elastic)
        assert both >= math.hypot(elastic, growth) * (1.0 - 1e-9)
        assert both < elastic + growth
        assert both == pytest.approx(math.hypot(elastic, growth), rel=1e-2)  # a little bent is a little worse
    assert table.rows[0][2] == pytest.approx(1240.0 * 30.0 * 23e-6)
    assert "22 times its own 0.0382 mm" in table.note
    assert "4.8 times the true one" in table.note


def test_ferromagnetic_materials_do_not_serve(arms):
    """And what nobody has stated is not taken for granted."""
    catalogue = load_catalogue(user=False)
    told = {name: magnetism(catalogue.find(name)) for name in ("steel-s355", "stainless-316l", "aluminium-6061-t6")}
    assert told == {
        "steel-s355": "ferromagnetic: no",
        "stainless-316l": "serves",
        "aluminium-6061-t6": "serves",
    }
    assert magnetism(replace(catalogue.find("steel-s355"), magnetic=None)) == "not stated"
    assert heat_table(arms, ("steel-s355",)).column("at 125 gauss") == ("ferromagnetic: no",)


# ---- the rail's two effects


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
    """Across the rail on a disc; about all three axes of the base."""
    assert not one_slide("rail_pitch", 1e-4, spatial=True).planar()
    straight = worst_error(one_slide("rail_straightness", 5e-5, spatial=True))
    assert straight == pytest.approx(5e-5, rel=1e-6)
    tilted = worst_error(one_slide("rail_pitch", 1e-4, spatial=True))
    # The link turns in the x-z plane: halfway between them |psi x p| is greatest, sqrt(3) for psi = (1, 1, -1).
    assert tilted == pytest.approx(1e-4 * 0.8 * math.sqrt(3.0), rel=1e-4)


@pytest.mark.parametrize("effect", ["rail_straightness", "rail_pitch"])
def test_effects_of_a_rail_leave_turning_joints_alone(effect):
    parameter = EFFECTS[effect].parameters[0]
    entry = EffectEntry(effect, (), MappingProxyType({parameter.name: 1e-3}))
    assert worst_error(replace(rigid(), effects=(entry,))) == 0.0
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


# ---- the rail's table


def test_each_part_of_a_rail_adds_what_geometry_says():
    """On a rigid arm that carries nothing each part alone is the whole error."""
    rail = Rail(clearance=2e-5, backlash=4e-5, straightness=5e-5, pitch=1e-4)
    reach = sum(LENGTHS)
    expected = {"clearance": 2e-5, "backlash": 2e-5, "straightness": 5e-5, "pitch": 1e-4 * reach}
    for part, size in expected.items():
        assert worst_error(rail.under(rigid(), frozenset({part}))) == pytest.approx(size, rel=1e-5)
    pushed = rail.under(rigid(payload=LoadCase(force=(100.0, 0.0, 0.0))), frozenset({"stiffness"}))
    assert worst_error(pushed) == pytest.approx(100.0 / rail.stiffness)
    # Backlash shifts along the rail, clearance and straightness across; the arm can stand so that tilt adds to both.
    expected_of_all = 1e-4 * reach + math.hypot(2e-5 + 5e-5, 2e-5)
    together = worst_error(replace(rail, force=0.0).under(rigid(), EVERY_PART))
    assert together == pytest.approx(expected_of_all, rel=1e-4)


def test_a_rail_renumbers_what_stands_on_it():
    """An effect at joint 1 of the arm is at joint 2 of the arm on its rail."""
    entry = EffectEntry("encoder_offset", (1,), MappingProxyType({"offset": 1e-4}))
    moved = Rail().under(replace(rigid(), effects=(entry,)), frozenset())
    assert moved.effects[0].at == (2,)
    assert worst_error(moved) == pytest.approx(1e-4 * sum(LENGTHS), rel=1e-6)


def test_the_rail_table_adds_nothing_for_a_perfect_rail(arms):
    perfect = Rail(clearance=0.0, backlash=0.0, stiffness=1e15, straightness=0.0, pitch=0.0)
    assert [row[3] for row in rail_table(arms, perfect).rows] == pytest.approx([0.0] * 7, abs=1e-5)
    added = rail_table(arms).column("added")
    assert all(value > 0.0 for value in added[1:])
    assert max(added[1:6]) < added[6] <= sum(added[1:6])


# ---- two arms


def test_play_of_two_arms_adds_up():
    """Discs alone: what one reaches in any direction, the other reaches against it."""
    both = (rigid(clearance=25e-6), Rail().under(rigid(clearance=10e-6), frozenset(), (1.0, 1.0)))
    found = pair_errors(*both, np.array([[0.5, 0.4]]), postures=32)
    assert found.first == pytest.approx([75e-6], rel=1e-9)
    assert found.second == pytest.approx([30e-6], rel=1e-9)
    assert found.together == pytest.approx([105e-6], rel=1e-9)


def test_what_moves_both_tips_alike_does_not_part_them():
    """One posture each, a drive that gives, equal arms side by side: the difference of two known vectors."""
    joint = Joint(stiffness=1e4)
    one = Arm("one", (joint,), (Link(0.5, mass=0.0),), payload=LoadCase(force=(0.0, -10.0, 0.0)))
    # The tip at (0.3, 0.4): torque -10 * 0.3, turn -3e-4, shift (0.4, -0.3) * 3e-4.
    found = pair_errors(one, one, np.array([[0.3, 0.4]]), postures=16, directions=3600)
    assert found.first == pytest.approx([1.5e-4], rel=1e-6)
    assert found.together == pytest.approx([0.0], abs=1e-12)
    # The same arm from 0.6 m away leans the other way: shift (-0.4, -0.3) * 3e-4, so 2 * 0.4 * 3e-4 apart.
    other = Rail().under(one, frozenset(), (0.6, 0.6))
    assert pair_errors(one, other, np.array([[0.3, 0.4]]), postures=16, directions=3600).together == pytest.approx(
        [2.4e-4], rel=1e-6
    )


def test_the_parting_is_that_of_two_convex_sets():
    """Against every vertex of the one set less every vertex of the other, at one posture of each."""
    arm = replace(
        rigid(backlash=1e-3, payload=LoadCase(mass=5.0)),
        joints=tuple(Joint(backlash=1e-3, stiffness=2e4) for _ in LENGTHS),
    )
    postures = Postures(arm)
    q = np.array([[0.4, -0.7, 0.3], [1.9, 0.8, -0.2]])
    case = postures.search.model.cases[0]
    arrays = case.arrays(q, postures.design)
    signs = np.array(np.meshgrid(*[[-1.0, 1.0]] * 3)).reshape(3, -1).T
    corners = arrays.vector[:, None] + np.einsum("ck,nki->nci", signs, arrays.intervals)
    brute = max(float(np.linalg.norm(a - b)) for a in corners[0] for b in corners[1])
    ways = around(3600)
    reach = postures.support(q, ways)
    assert (reach[0] + np.roll(reach[1], -1800)).max() == pytest.approx(brute, rel=1e-6)


def test_the_tips_part_by_less_than_the_errors_add_up_to(arms):
    """And never by less than the greater part of them: play is free to go either way."""
    table = dual_table(arms, postures=128)
    for _, one, other, both, parted in table.rows:
        assert both <= one + other + 1e-9
        assert max(one, other) < parted < both
    middle = table.rows[4]
    assert middle[0] == "(600, 500)"
    assert middle[1] == pytest.approx(middle[2], rel=2e-3)  # midway they are each other's mirror image


def test_directions_come_in_pairs():
    with pytest.raises(ValueError, match="even"):
        around(7)


def test_the_workplace_stands_in_the_extended_tables(arms):
    """Each table has a maker; their names are what the command may write."""
    from linkwright.commands.paper.tables import EXTENDED_KEYS

    extended = Extended(arms)
    assert {extended.heat().key, extended.rail().key} == {"heat_and_field", "rail"}
    assert EXTENDED_KEYS[-3:] == ("heat_and_field", "rail", "dual_arm")
