"""The worst case: never optimistic against brute force, and its certificate a bound that no pose exceeds."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from linkwright.core.arm.chain.chain import Arm, EffectEntry, Joint, Link, LoadCase
from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.arm.worst.search import WorstCase, WorstSearch
from linkwright.core.arm.worst.workspace import Unreachable, Workspace, spread
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.sections import build
from linkwright.core.sections.numeric import Array

STEEL = load_catalogue(user=False).find("steel-s355")
ROD = build("circle", {"diameter": 0.05})
FULL = (-math.pi, math.pi)
X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
DOWN_Z = (0.0, 0.0, -9.81)
RANGES = [(-2.0, 2.0), (-2.6, 2.6), (-2.6, 2.6)]
PLAYFUL = tuple(Joint(range=r, backlash=1e-3, clearance=25e-6, stiffness=4e4, mass=3.0) for r in RANGES)


def rods(joints: Sequence[Joint], lengths: Sequence[float], **others: object) -> Arm:
    links = tuple(Link(length, section=ROD, material=STEEL) for length in lengths)
    return Arm(**{"name": "rods", "joints": tuple(joints), "links": links, **others})  # type: ignore[arg-type]


def search_of(
    arm: Arm, cases: Sequence[LoadCase] = (), workspace: Workspace | None = None
) -> tuple[WorstSearch, Array]:
    return WorstSearch(error_model(arm, cases), workspace or Workspace()), beam_values(beams_of(arm, cases))


def errors(search: WorstSearch, p: Array, q: Array) -> Array:
    return np.max([search.errors(q, p, case).error for case in range(len(search.model.cases))], axis=0)


def check(
    arm: Arm, cases: Sequence[LoadCase] = (), *, poses: int = 100_000, certified: bool = True, seed: int = 0
) -> WorstCase:
    """Brute force over random poses: not above the error found, nor above the bound; the bound within 1e-4."""
    search, p = search_of(arm, cases)
    worst = search.worst(p)
    q = np.random.default_rng(seed).uniform(search.lower, search.upper, (poses, arm.size))
    brute = float(errors(search, p, q).max())
    assert worst.error >= brute * (1.0 - 1e-9)
    top = worst.poses[0]
    assert errors(search, p, np.array([top.q]))[0] == pytest.approx(worst.error, rel=1e-9, abs=1e-15)
    assert np.all(np.array(top.q) >= search.lower - 1e-12)
    assert np.all(np.array(top.q) <= search.upper + 1e-12)
    if worst.upper_bound is not None:
        assert brute <= worst.upper_bound * (1.0 + 1e-12)
    if certified:
        assert worst.certified
        assert worst.upper_bound is not None
        assert worst.error <= worst.upper_bound <= worst.error * (1.0 + 1.01e-4) + 1e-15
    return worst


planar_joint = st.builds(
    Joint,
    range=st.sampled_from([FULL, (-2.0, 2.0), (0.7, 2.6), (0.5, 2.4), (-2.2, -0.4), (0.3, 0.3), (-6.0, 6.0)]),
    backlash=st.sampled_from([0.0, 3e-4, 1e-3]),
    clearance=st.sampled_from([0.0, 25e-6]),
    stiffness=st.sampled_from([None, 1e4, 6e4]),
    mass=st.sampled_from([0.0, 4.0]),
)
slide_joint = st.builds(
    Joint,
    type=st.just("prismatic"),
    axis=st.sampled_from([X, Y, (0.6, 0.8, 0.0)]),
    range=st.sampled_from([(-0.2, 0.5), (0.1, 0.1)]),
    backlash=st.sampled_from([0.0, 1e-4]),
    clearance=st.sampled_from([0.0, 25e-6]),
    stiffness=st.sampled_from([None, 1e6]),
    mass=st.sampled_from([0.0, 4.0]),
)
side = st.floats(-300.0, 300.0)
loads = st.builds(
    LoadCase, mass=st.sampled_from([0.0, 3.0]), force=st.tuples(side, side, st.just(0.0)),
    moment=st.sampled_from([(0.0, 0.0, 0.0), (0.0, 0.0, 40.0)]),
)  # fmt: skip


@given(
    joints=st.lists(st.one_of(planar_joint, planar_joint, slide_joint), min_size=1, max_size=3),
    lengths=st.lists(st.floats(0.1, 0.6), min_size=3, max_size=3),
    cases=st.lists(loads, min_size=1, max_size=2),
    play=st.sampled_from(["worst", "worst", "loaded"]),
    gravity=st.sampled_from([(0.0, -9.81, 0.0), (0.0, 0.0, 0.0), (6.0, 7.0, 0.0)]),
)
@settings(max_examples=25, deadline=None)
def test_bound_of_any_planar_arm_holds_and_is_tight(
    joints: list[Joint], lengths: list[float], cases: list[LoadCase], play: str, gravity: tuple[float, float, float]
) -> None:
    """Elbows that cannot stretch, full circles, slides, side forces, zero widths, backlash everywhere."""
    arm = rods(joints, lengths[: len(joints)], play=play, gravity=gravity)
    check(arm, cases, poses=20_000)


@given(
    joints=st.lists(planar_joint, min_size=2, max_size=3),
    lengths=st.lists(st.floats(0.1, 0.6), min_size=3, max_size=3),
)
@settings(max_examples=10, deadline=None)
def test_bound_of_an_arm_with_absolute_angles_holds(joints: list[Joint], lengths: list[float]) -> None:
    check(rods(joints, lengths[: len(joints)], angles="absolute"), poses=20_000)


def test_three_load_cases_on_an_arm_whose_elbow_cannot_stretch() -> None:
    joints = (Joint(range=(-2.0, 2.0)), Joint(range=(0.7, 2.6)), Joint(range=(0.5, 2.4)))
    cases = [LoadCase(3.0), LoadCase(force=(43.0, 0.0, 0.0)), LoadCase(1.0, (-300.0, 100.0, 0.0))]
    check(rods(joints, [0.4, 0.42, 0.42]), cases)


def test_play_in_every_joint() -> None:
    check(rods(PLAYFUL, [0.4, 0.42, 0.42]))
    check(rods(PLAYFUL, [0.4, 0.42, 0.42], play="loaded"), [LoadCase(force=(100.0, 20.0, 0.0)), LoadCase(3.0)])


@pytest.mark.parametrize("count", [1, 2, 4])
def test_arms_of_few_full_circle_joints(count: int) -> None:
    check(rods([Joint()] * count, [0.3] * count))


def test_a_single_pose_is_its_own_worst() -> None:
    fixed = [Joint(range=(0.2, 0.2), backlash=1e-3), Joint(range=(0.3, 0.3))]
    check(rods(fixed, [0.4, 0.42]), poses=10)


def test_a_joint_at_its_limit_does_not_blunt_the_climb() -> None:
    """The certificate allows 1e-4; the pose found is exact all the same (it once stopped 4e-7 short)."""
    check(rods([Joint(), Joint(range=(0.3, 0.3))], [0.5, 0.25], angles="absolute"), poses=200_000)


def test_a_weightless_arm_has_no_error() -> None:
    worst = check(rods([Joint()] * 3, [0.4, 0.42, 0.42], gravity=(0.0, 0.0, 0.0)), poses=100)
    assert worst.error == 0.0
    assert worst.upper_bound == 0.0


@pytest.mark.parametrize("play", ["worst", "loaded"])
def test_pins_that_no_load_pushes_count_as_worst(play: str) -> None:
    """Backlash across the arm and a free pin: the errors' lengths add, whichever way the pin's own error would lie.

    A bound that put the unpushed pin at one fixed side of its bore fell below the true worst, at q2 = 0.
    """
    joints = (Joint(range=(0.0, 0.0), backlash=1e-3, clearance=3e-4), Joint(range=(-1.0, 1.5), backlash=1e-3))
    worst = check(rods(joints, [0.4, 0.42], gravity=(0.0, 0.0, 0.0), play=play))
    assert worst.error == pytest.approx(0.5e-3 * (0.82 + 0.42) + 3e-4, rel=1e-9)


@pytest.mark.parametrize("extra", [{}, {"backlash": 1e-3}])
def test_a_vertical_first_axis_costs_nothing(extra: dict[str, float]) -> None:
    joints = (Joint(axis=Z, **extra), Joint(axis=Y, stiffness=4e4, **extra), Joint(axis=Y, stiffness=4e4, **extra))  # type: ignore[arg-type]
    check(rods(joints, [0.4, 0.42, 0.42], gravity=DOWN_Z))


def test_an_arm_in_space() -> None:
    joints = (Joint(axis=Y), Joint(axis=X, stiffness=4e4, backlash=1e-4), Joint(axis=Y, stiffness=4e4))
    check(rods(joints, [0.4, 0.42, 0.42], gravity=(1.0, -9.0, 3.0)), [LoadCase(force=(30.0, 20.0, 50.0))])


@pytest.mark.parametrize("play", ["worst", pytest.param("loaded", marks=pytest.mark.slow)])
def test_clearance_in_space_is_bounded(play: str) -> None:
    """Large clearance on crossed axes: the pose that is worst with it is not the worst without."""
    joints = (
        Joint(axis=Z, backlash=1e-3, clearance=3e-4, range=(-1.0, 1.0)),
        Joint(axis=Y, backlash=1e-3, clearance=3e-4, range=(-1.0, 1.5)),
    )
    worst = check(rods(joints, [0.4, 0.42], gravity=DOWN_Z, play=play), poses=20_000, certified=play == "worst")
    assert worst.upper_bound is not None


def test_six_joints_have_a_bound() -> None:
    joints = (Joint(axis=Z), Joint(axis=Y, stiffness=4e4), Joint(axis=Y, stiffness=4e4), Joint(axis=X),
              Joint(axis=Y), Joint(axis=X))  # fmt: skip
    check(rods(joints, [0.2, 0.4, 0.1, 0.4, 0.1, 0.1], gravity=DOWN_Z), poses=20_000)
    worst = check(rods([Joint()] * 6, [0.2] * 6), certified=False, poses=20_000)
    assert worst.upper_bound is not None


def test_statistical_play_is_searched_too() -> None:
    check(rods(PLAYFUL, [0.4, 0.42, 0.42], play="statistical"), certified=False, poses=2000)


# ---- boxes and paths


def elbow(lengths: tuple[float, float], x: Array, y: Array) -> Array:
    """Both inverse-kinematics solutions of a 2R arm for each point: rows (q1, q2)."""
    a, b = lengths
    cosine = (x * x + y * y - a * a - b * b) / (2.0 * a * b)
    bend = np.arccos(np.clip(cosine, -1.0, 1.0))
    q2 = np.concatenate([bend, -bend])
    x, y = np.tile(x, 2), np.tile(y, 2)
    q1 = np.arctan2(y, x) - np.arctan2(b * np.sin(q2), a + b * np.cos(q2))
    return np.stack([(q1 + math.pi) % (2.0 * math.pi) - math.pi, q2], axis=1)


def inside(search: WorstSearch, q: Array) -> Array:
    return q[np.all((q >= search.lower) & (q <= search.upper), axis=1)]


PATH = ((0.5, 0.1, 0.0), (0.9, 0.3, 0.0), (0.6, 0.7, 0.0))


@pytest.mark.parametrize("play", ["worst", "loaded"])
@pytest.mark.parametrize("cases", [(), (LoadCase(3.0), LoadCase(force=(143.0, 0.0, 0.0)))])
def test_path_of_two_links_against_all_its_inverse_kinematics(play: str, cases: tuple[LoadCase, ...]) -> None:
    joints = (Joint(backlash=1e-3, stiffness=5e4), Joint(range=(-1.0, 2.5), backlash=1e-3, stiffness=5e4))
    search, p = search_of(rods(joints, [0.6, 0.5], play=play), cases, Workspace("path", PATH))
    share = np.linspace(0.0, 1.0, 4000)[:, None]
    points = np.vstack([np.array(a) + share * np.subtract(b, a) for a, b in itertools.pairwise(PATH)])
    q = inside(search, elbow((0.6, 0.5), points[:, 0], points[:, 1]))
    dense = float(errors(search, p, q).max())
    worst = search.worst(p)
    assert worst.error == pytest.approx(dense, rel=1e-5)
    assert worst.upper_bound is not None
    assert dense <= worst.upper_bound <= worst.error * (1.0 + 1.01e-4)


def test_path_of_three_links_against_a_dense_scan_of_its_self_motion() -> None:
    """For each direction of the last link the other two have their two solutions."""
    search, p = search_of(rods(PLAYFUL, [0.4, 0.42, 0.42]), (), Workspace("path", PATH))
    share = np.linspace(0.0, 1.0, 60)[:, None]
    points = np.vstack([np.array(a) + share * np.subtract(b, a) for a, b in itertools.pairwise(PATH)])
    poses = []
    for heading in np.linspace(-math.pi, math.pi, 721):
        x, y = points[:, 0] - 0.42 * math.cos(heading), points[:, 1] - 0.42 * math.sin(heading)
        near = np.abs(x * x + y * y - 0.4**2 - 0.42**2) <= 2 * 0.4 * 0.42
        q = elbow((0.4, 0.42), x[near], y[near])
        q3 = (heading - q.sum(axis=1) + math.pi) % (2.0 * math.pi) - math.pi
        poses.append(np.column_stack([q, q3]))
    q = inside(search, np.vstack(poses))
    dense = float(errors(search, p, q).max())
    worst = search.worst(p)
    assert worst.upper_bound is not None
    assert dense <= worst.upper_bound
    assert dense <= worst.error * (1.0 + 1e-9)
    # Half a degree of heading leaves the dense scan a little short of the true worst, no more.
    assert worst.error <= dense * (1.0 + 2e-3)


def test_box_against_random_poses_whose_tip_lies_in_it() -> None:
    corners = ((0.3, -0.2, 0.0), (0.9, 0.6, 0.0))
    arm = rods(PLAYFUL, [0.4, 0.42, 0.42])
    search, p = search_of(arm, (), Workspace("box", corners))
    q = np.random.default_rng(2).uniform(search.lower, search.upper, (200_000, 3))
    tips = tip_position(arm, q)[:, :2]
    q = q[np.all((tips >= np.array(corners[0])[:2]) & (tips <= np.array(corners[1])[:2]), axis=1)]
    worst = search.worst(p)
    assert worst.upper_bound is not None
    assert errors(search, p, q).max() <= worst.error * (1.0 + 1e-9)
    assert worst.upper_bound <= worst.error * (1.0 + 1.01e-4)
    place = tip_position(arm, np.array([worst.poses[0].q]))[0, :2]
    assert np.all(place >= np.array(corners[0])[:2] - 1e-6)
    assert np.all(place <= np.array(corners[1])[:2] + 1e-6)


@pytest.mark.parametrize("points", [((0.5, 0.1, 0.0),), ((0.5, 0.1, 0.0), (0.5, 0.1, 0.0))])
def test_a_path_of_a_single_point_is_the_worst_of_its_two_elbows(
    points: tuple[tuple[float, float, float], ...],
) -> None:
    arm = rods((Joint(stiffness=5e4), Joint(stiffness=3e4)), [0.6, 0.5])
    search, p = search_of(arm, (), Workspace("path", points))
    q = elbow((0.6, 0.5), np.array([0.5]), np.array([0.1]))
    assert search.worst(p).error == pytest.approx(float(errors(search, p, q).max()), rel=1e-6)


def test_a_path_to_the_very_end_of_the_reach_is_reached() -> None:
    arm = rods(PLAYFUL, [0.4, 0.42, 0.42])
    search, p = search_of(arm, (), Workspace("path", ((0.5, 0.0, 0.0), (1.24, 0.0, 0.0))))
    stretched = float(errors(search, p, np.zeros((1, 3)))[0])
    assert search.worst(p).error >= stretched * (1.0 - 1e-4)


def test_a_point_beyond_the_reach_is_named() -> None:
    search, p = search_of(rods(PLAYFUL, [0.4, 0.42, 0.42]), (), Workspace("path", ((0.5, 0.0, 0.0), (1.25, 0.0, 0.0))))
    with pytest.raises(Unreachable, match=r"1250.*10 mm"):
        search.worst(p)


def test_a_joint_limit_can_put_a_point_out_of_reach() -> None:
    arm = rods((Joint(range=(0.0, 0.5)), Joint(range=(0.0, 0.5))), [0.6, 0.5])
    search, p = search_of(arm, (), Workspace("path", ((0.5, 0.1, 0.0),)))
    with pytest.raises(Unreachable):
        search.worst(p)


def test_ranges_of_the_workspace_replace_the_joints_own() -> None:
    arm = rods(PLAYFUL, [0.4, 0.42, 0.42])
    ranges = ((0.5, 1.0), (0.2, 0.4), (-0.4, 0.1))
    narrowed = replace(arm, joints=tuple(replace(j, range=r) for j, r in zip(arm.joints, ranges, strict=True)))
    search, p = search_of(arm, (), Workspace(ranges=ranges))
    assert search.worst(p).error == pytest.approx(check(narrowed, poses=1000).error, rel=1e-9)


@pytest.mark.parametrize("turns", [1.0, 2.5])
def test_range_of_several_turns_counts_where_turns_differ(turns: float) -> None:
    """An encoder's scale error grows with the angle, so that the last turn is the worst; gravity repeats itself."""
    widest = turns * math.pi
    joint = Joint(stiffness=1e5, range=(-widest, widest))
    scale = EffectEntry("encoder_scale", (), MappingProxyType({"scale": 1e-3}))
    for effects in ((), (scale,)):
        arm = replace(rods([joint], [0.5]), effects=effects)
        model, p = error_model(arm), beam_values(beams_of(arm))
        search = WorstSearch(model, Workspace())
        worst = search.worst(p)
        grid = np.linspace(-widest, widest, 20_001)[:, None]
        assert worst.error == pytest.approx(search.errors(grid, p, 0).error.max(), rel=1e-4)
        assert search.upper[0] - search.lower[0] == pytest.approx(2.0 * (widest if effects else min(widest, math.pi)))


@pytest.mark.parametrize(("joint", "base"), [(0, 2), (2, 5), (6, 17)])
def test_poses_are_spread_evenly_over_each_joint(joint: int, base: int) -> None:
    """A scrambled Halton sequence: of base^2 neighbours each base^2-th of a joint's range holds exactly one."""
    q = spread(np.zeros(7), np.ones(7), 4 * base**2)
    for run in range(4):
        column = q[run * base**2 : (run + 1) * base**2, joint]
        assert sorted(np.floor(column * base**2).astype(int)) == list(range(base**2))
    assert not np.array_equal(q, spread(np.zeros(7), np.ones(7), 4 * base**2, seed=2))
