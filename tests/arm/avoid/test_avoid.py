"""Regions to keep out of: read and written as they are, met where points of the arm are inside, kept clear of."""

import math
from dataclasses import replace

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

import linkwright as lw
from linkwright.core.arm.avoid.links import OtherLinks
from linkwright.core.arm.avoid.obstacle import Piece, frames_and_tips, half_size, pieces
from linkwright.core.arm.avoid.poses import Room, meets, room_of
from linkwright.core.arm.avoid.regions import Region, around, between, beyond
from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.arm.chain.kinematics import place, tip_position
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.files.write import arm_to_yaml
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.sections import Circle
from linkwright.core.sections.shapes import RectangularTube
from linkwright.core.units.quantities import InputError

UP = (0.0, 0.0, -9.81)
ALUMINIUM = load_catalogue(user=False).find("aluminium-6061-t6")


def upright_arm(radius=0.04):
    """A column that turns, and two links that pitch, on a floor at z = 0."""
    section = Circle(2.0 * radius)
    pitch = Joint(axis=(0.0, 1.0, 0.0), range=(-math.pi, math.pi))
    column = Link(0.4, direction=(0.0, 0.0, 1.0), section=section, material=ALUMINIUM)
    reach = Link(0.5, section=section, material=ALUMINIUM)
    return Arm("upright", (Joint(), pitch, pitch), (column, reach, reach), gravity=UP, tool=(0.0, 0.0, 0.2))


FLOOR = beyond("below", "z", 0.0)


def skin(arm, q, radius, count=60):
    """Points of circles of a radius about the links of an arm at a pose q (n,), across them; and its tool."""
    frames, start, points = place(arm, list(q)), np.zeros(3), []
    turns = np.linspace(0.0, 2.0 * math.pi, count, endpoint=False)
    for number, link in enumerate(frames.links):
        vector, height, width = (np.array(part, float) for part in (link.vector, link.height, link.width))
        circle = radius * (np.cos(turns)[:, None] * height + np.sin(turns)[:, None] * width)
        first = radius / np.linalg.norm(vector) if number == 0 else 0.0
        points += [start + share * vector + circle for share in np.linspace(first, 1.0, 40)]
        start = start + vector
    points.append(start + np.linspace(0.0, 1.0, 40)[:, None] * np.array(frames.tool, float))
    return np.concatenate(points)


@settings(max_examples=80, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_a_floor_is_met_where_the_skin_of_the_arm_is_below_it(seed):
    arm, rng = upright_arm(), np.random.default_rng(seed)
    q = rng.uniform(-math.pi, math.pi, 3)
    lowest = skin(arm, q, 0.04)[:, 2].min()
    if abs(lowest) > 2e-3:  # between the points of a circle
        assert bool(meets(arm, q[None], (FLOOR,))[0]) == bool(lowest < 0.0)


@settings(max_examples=80, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_no_point_of_the_skin_is_in_a_box_that_is_not_met(seed):
    arm, rng = upright_arm(), np.random.default_rng(seed)
    q = rng.uniform(-math.pi, math.pi, 3)
    corner = rng.uniform(-0.8, 0.8, 3)
    box = between(corner, corner + rng.uniform(0.05, 0.6, 3))
    inside = ((skin(arm, q, 0.04) > np.array(box.low)) & (skin(arm, q, 0.04) < np.array(box.high))).all(axis=1)
    if not meets(arm, q[None], (box,))[0]:
        assert not inside.any()
    wide = between(np.array(box.low) - 0.05, np.array(box.high) + 0.05)
    if inside.any():
        assert meets(arm, q[None], (wide,))[0]


def test_a_column_stands_on_its_floor_and_what_leans_does_not():
    """The base is where it is at every pose; a link that lies on the floor by half its height is in it."""
    arm = upright_arm()
    q = np.array([[0.3, -0.5, 0.2], [0.0, 0.9273, 0.0], [0.0, 0.7, -0.7], [0.0, 0.84, -0.84]])
    # Down by 0.4, 0.32 and 0.37 over a link of 0.5: where the last lies level, its axis is 78 and 28 mm above.
    assert meets(arm, q, (FLOOR,)).tolist() == [False, True, False, True]
    assert half_size(arm.links[1]) == pytest.approx(0.04)
    assert half_size(Link(0.3, mass=2.0)) == 0.0
    tube = Link(0.3, section=RectangularTube(0.06, 0.08, 0.003), material=ALUMINIUM)
    assert half_size(tube) == pytest.approx(0.05, rel=1e-6)


def test_the_tool_counts():
    """Both links straight up, the tool of 0.2 m points back: it alone is behind the base by more than 0.1 m."""
    arm = upright_arm(0.001)
    down = np.radians([[0.0, 0.0, 0.0], [0.0, -90.0, 0.0]])
    assert not meets(arm, down, (beyond("above", "z", 1.5),))[0]
    top = 0.4 + 1.0
    assert tip_position(arm, down[1:])[0] == pytest.approx((-0.2, 0.0, top), abs=1e-12)
    behind = beyond("below", "x", -0.1)
    assert meets(arm, down, (behind,)).tolist() == [False, True]
    assert not meets(replace(arm, tool=(0.0, 0.0, 0.0)), down, (behind,)).any()


def test_the_box_of_what_was_recorded_holds_all_frames():
    arm = upright_arm()
    q = np.random.default_rng(2).uniform(-0.6, 0.4, (30, 3))
    room = room_of(arm, q)
    points = frames_and_tips(arm, q)
    assert points.shape == (30, 7, 3)
    assert room.within == around(points)
    assert room.allows(arm, q).all()
    assert room.allows(arm, np.array([[0.0, 1.4, 0.0]])).tolist() == [False]
    # The wrist never goes below what was recorded: the base at its lowest.
    tried = np.random.default_rng(3).uniform(-math.pi, math.pi, (4000, 3))
    kept = tried[room.allows(arm, tried)]
    assert len(kept) > 5
    assert frames_and_tips(arm, kept)[:, :, 2].min() >= points[:, :, 2].min() - 1e-8


def test_what_is_said_goes_before_what_was_recorded():
    q = np.zeros((3, 3))
    assert room_of(upright_arm(), q, (FLOOR,)) == Room((FLOOR,))
    wall = beyond("above", "x", 0.5)
    arm = replace(upright_arm(), avoid=(wall,))
    assert room_of(arm, q, (FLOOR, wall)).avoid == (wall, FLOOR)
    assert room_of(arm, None).within is None
    assert room_of(upright_arm(), None).everywhere


FILE = """
chain:
  - joint: {type: revolute, range: [-90 deg, 90 deg]}
    link: {length: 400 mm, rigid: true, mass: 2 kg}
"""


def test_regions_are_read_and_written_as_they_are(tmp_path):
    path = tmp_path / "arm.yaml"
    text = "avoid: [{box: [[1 m, -1 m, 0 m], [0.5 m, 1 m, 400 mm]]}, {below: {z: -20 mm}}, {above: {x: 1.2 m}},"
    path.write_text(f"{FILE}{text} {{box: [[0 m, 0 m], [1 m, 2 m]]}}]\n")
    arm = read_arm(path)
    infinite = math.inf
    assert arm.avoid == (
        Region((0.5, -1.0, 0.0), (1.0, 1.0, 0.4)),
        Region((-infinite,) * 3, (infinite, infinite, -0.02)),
        Region((1.2, -infinite, -infinite), (infinite,) * 3),
        Region((0.0, 0.0, -infinite), (1.0, 2.0, infinite)),
    )
    path.write_text(arm_to_yaml(arm))
    assert read_arm(path).avoid == arm.avoid
    assert yaml.safe_load(path.read_text())["avoid"][1] == {"below": {"z": "-20 mm"}}


@pytest.mark.parametrize(
    ("said", "fault"),
    [
        ("[{}]", r"avoid\[1\]: needs one of box, below, above and links"),
        ("[{below: {z: 0 mm}, above: {z: 2 m}}]", r"avoid\[1\]: needs one of box, below, above and links"),
        ("[{below: {z: 0 mm, x: 1 m}}]", r"avoid\[1\]\.below: needs one of x, y and z"),
        ("[{below: {q: 0 mm}}]", r"avoid\[1\]\.below: "),
        ("[{below: {z: 3}}]", r"avoid\[1\]\.below\.z"),
        ("[{box: [[0 m, 0 m, 0 m]]}]", r"avoid\[1\]\.box: needs two corners"),
        ("[{box: [[0 m, 0 m, 0 m], [1 m, 1 m]]}]", r"avoid\[1\]\.box: needs two corners"),
        ("[{box: [0 m, 1 m]}]", r"avoid\[1\]\.box\[1\]: is a corner of two or three coordinates"),
        ("[{bellow: {z: 0 mm}}]", r"needs one of box, below, above and links"),
        ("{below: {z: 0 mm}}", r"avoid: needs a list"),
    ],
)
def test_what_is_no_region_is_one_line(said, fault, tmp_path):
    path = tmp_path / "arm.yaml"
    path.write_text(f"{FILE}avoid: {said}\n")
    with pytest.raises(InputError, match=fault):
        read_arm(path)


def below_floor(arm, q):
    """By the frames, without what the test is of."""
    heights = [frames_and_tips(arm, q)[:, :, 2].min(axis=1)]
    return np.array(heights[0] < -1e-9)


def test_simulated_poses_keep_clear(tmp_path):
    path = tmp_path / "arm.yaml"
    path.write_text(arm_to_yaml(upright_arm()))
    free = lw.simulate(path, poses=24, repeats=1, sides="one")
    path.write_text(arm_to_yaml(replace(upright_arm(), avoid=(FLOOR,))))
    kept = lw.simulate(path, poses=24, repeats=1, sides="one")
    assert below_floor(upright_arm(), free.found.q).any()
    assert len(kept.found.q) == 24
    assert not meets(upright_arm(), kept.found.q, (FLOOR,)).any()
    nothing = replace(upright_arm(), avoid=(beyond("above", "z", 0.1),))
    path.write_text(arm_to_yaml(nothing))
    with pytest.raises(InputError, match="avoid: what is to be avoided leaves 0 poses of the 24 asked for"):
        lw.simulate(path, poses=24)


def test_a_budget_counts_poses_that_may_be(tmp_path):
    """A wrong zero of joint 2 moves the tip by its lever; within walls the arm cannot stretch, and errs by less."""
    path = tmp_path / "arm.yaml"
    path.write_text(arm_to_yaml(upright_arm()))
    sheet = {"tolerances": [{"effect": "encoder_offset", "at": 2, "offset": "1 mrad"}], "draws": 20}
    free = lw.budget(path, sheet=sheet)
    walls = [beyond(side, axis, v) for side, v in (("above", 0.45), ("below", -0.45)) for axis in "xy"]
    path.write_text(arm_to_yaml(replace(upright_arm(), avoid=(*walls, FLOOR))))
    kept = lw.budget(path, sheet=sheet)
    assert not meets(upright_arm(), np.array([kept.found.pose]), (*walls, FLOOR)).any()
    assert kept.worst_mm < free.worst_mm
    problem = tmp_path / "problem.yaml"
    path.write_text(arm_to_yaml(upright_arm()))
    problem.write_text("arm: arm.yaml\nsubject_to: {mass: '<= 90 kg'}\navoid: [{below: {z: 0 mm}}]\n")
    by_problem = lw.budget(path, sheet=sheet, problem=problem)
    assert by_problem.found.room == Room((FLOOR,))
    assert not meets(upright_arm(), np.array([by_problem.found.pose]), (FLOOR,)).any()


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_the_nearest_points_are_those_of_many_along_the_pieces(seed):
    rng = np.random.default_rng(seed)
    starts, vectors = rng.uniform(-1.0, 1.0, (2, 2, 3))
    along = vectors / np.linalg.norm(vectors, axis=1)[:, None]
    one, other = (
        Piece("link", 3 * k, 3 * k - 1, tuple(starts[k]), tuple(vectors[k]), 0.05 * (k + 1), tuple(along[k]))
        for k in range(2)
    )
    share = np.linspace(0.0, 1.0, 401)
    points = [starts[k] + share[:, None] * vectors[k] for k in range(2)]
    box = between(*rng.uniform(-0.5, 0.5, (2, 3)))
    out = 0.05 * np.sqrt(1.0 - along[0] ** 2)
    gaps = np.maximum(np.array(box.low) - points[0] - out, points[0] - np.array(box.high) - out).max(axis=1)
    (gap,), (shares,) = box.closest((one,), 1)
    assert gaps.min() - 0.005 * np.linalg.norm(vectors[0]) <= gap <= gaps.min() + 1e-12
    assert float(box.gap((one,), shares)) == pytest.approx(gap, abs=1e-12)
    apart = np.linalg.norm(points[0][:, None] - points[1][None], axis=2).min() - 0.15
    (gap,), (shares,) = OtherLinks().closest((one, other), 1)
    assert apart - 0.01 <= gap <= apart + 1e-12
    assert float(OtherLinks().gap((one, other), shares)) == pytest.approx(gap, abs=1e-12)


def test_links_that_share_no_joint_are_asked_of(tmp_path):
    """Four links and a tool: each but with its neighbours. Two arms on one torso: each link of one with each of the
    other but the first two, which share the torso's end, and the second ones with the torso."""
    asked = OtherLinks().asks(list(pieces(_chain(4, tool=(0.1, 0.0, 0.0)), [0.0] * 4)))
    assert asked == [(0, 2), (0, 3), (0, 4), (1, 3), (1, 4), (2, 4)]
    link = "{joint: {axis: z}, link: {length: 300 mm, rigid: true, mass: 1 kg}}"
    branches = "".join(f"  - {{name: {name}, chain: [{link}, {link}]}}\n" for name in ("left", "right"))
    (tmp_path / "arm.yaml").write_text(f"chain: [{link}]\nbranches:\n{branches}")
    parts = list(pieces(read_arm(tmp_path / "arm.yaml"), [0.0] * 5))
    names = {frozenset(parts[number].name for number in pair) for pair in OtherLinks().asks(parts)}
    expected = [(1, 3), (1, 5), (2, 5), (3, 4), (3, 5)]
    assert names == {frozenset((f"link {one}", f"link {other}")) for one, other in expected}


def test_joints_that_stand_in_one_point_are_one():
    """A wrist of three joints in one point, with a tool: the forearm (link 2) and the tool share it, whatever their
    radii, and only link 1 keeps clear of what is beyond."""
    arm = _chain(5, tool=(0.1, 0.0, 0.0))
    wrist = (*arm.links[:2], *(replace(arm.links[2], length=0.0, section=None, mass=0.0),) * 3)
    parts = list(pieces(replace(arm, links=wrist), [0.0] * 5))
    assert [part.name for part in parts][::5] == ["link 1", "the tool"]
    asked = OtherLinks().asks(parts)
    assert (0, 5) in asked
    assert {one for one, _ in asked} == {0}


def test_a_rail_and_what_stands_on_its_carriage_are_clear_of_the_floor():
    """A slide along the floor and one that rises from it: neither rail comes near it, the arm on them does."""
    rod, turned = Link(0.3, direction=(0.0, 0.0, 1.0), section=Circle(0.02), material=ALUMINIUM), Joint(axis=(0, 1, 0))
    for axis, least in (((1.0, 0.0, 0.0), 0.03), ((0.0, 0.0, 1.0), 0.23)):
        slide = Joint("prismatic", axis=axis, range=(0.0, 0.4))
        arm = Arm("on a rail", (slide, turned), (rod, replace(rod, direction=(1.0, 0.0, 0.0))), gravity=UP)
        gaps = [FLOOR.closest([part], 1)[0][0] for part in pieces(arm, [0.2, 0.0])]
        assert min(gaps) == pytest.approx(least, abs=1e-12)


def _chain(size, tool):
    link = Link(0.3, section=Circle(0.05), material=ALUMINIUM)
    return Arm("chain", (Joint(),) * size, (link,) * size, tool=tool)


def test_folded_links_meet_each_other():
    arm = _chain(3, (0.0, 0.0, 0.0))
    q = np.radians([[0.0, 0.0, 0.0], [0.0, 120.0, 120.0], [0.0, 150.0, 150.0], [0.0, 100.0, 10.0]])
    assert meets(arm, q, (OtherLinks(),)).tolist() == [False, True, True, False]
