"""What can be reached and which seams can be followed, against brute force."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from linkwright.core.arm.chain.arrays import jacobian
from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.arm.worst.reach import Reach, Ring, free_ring, ring_of
from linkwright.core.arm.worst.seam import check_seam
from tests.arm.worst.test_inverse import LENGTHS, planar_arm

LIMITED = tuple((math.radians(low), math.radians(high)) for low, high in ((-30, 90), (10, 150), (10, 120)))
point = st.tuples(st.floats(-1.5, 1.5), st.floats(-1.5, 1.5))


@given(st.lists(st.floats(0.05, 2.0), min_size=1, max_size=4))
def test_ring_holds_every_pose_and_both_edges_are_met(lengths):
    """Against all absolute angles of a grid, and against folding the shorter links back along the longest."""
    ring = ring_of(lengths)
    grid = np.linspace(-math.pi, math.pi, 12, endpoint=False)
    angles = np.stack(np.meshgrid(*[grid] * len(lengths)), axis=-1).reshape(-1, len(lengths))
    tips = np.exp(1j * angles) @ np.array(lengths)
    assert np.all(np.abs(tips) <= ring.outer + 1e-9)
    assert np.all(np.abs(tips) >= ring.inner - 1e-9)
    assert ring.outer == pytest.approx(np.abs(tips).max())
    if ring.inner > 0.0:
        assert ring.inner == pytest.approx(2 * max(lengths) - sum(lengths))
        assert np.abs(tips).min() == pytest.approx(ring.inner)


def test_the_papers_own_lengths_leave_no_hole():
    """L1 - L2 - L3 would be negative."""
    assert ring_of(LENGTHS) == Ring((0.0, 0.0), 0.0, pytest.approx(1.24))


def test_free_ring_counts_offsets_and_asks_for_full_circles():
    """A tool and an offset joint lengthen the links; a limited joint leaves no ring."""
    joints = (Joint(origin_translation=(0.1, 0.2, 0.0)), Joint(origin_translation=(0.0, 0.3, 0.0)))
    base = Arm("a", joints, (Link(0.4), Link(0.2)))
    ring = free_ring(base)
    assert ring is not None
    assert ring.center == pytest.approx((0.1, 0.2))
    assert (ring.inner, ring.outer) == pytest.approx((0.3, 0.7))
    q = np.random.default_rng(2).uniform(-math.pi, math.pi, (4000, 2))
    radius = np.hypot(*(tip_position(base, q)[:, :2] - (0.1, 0.2)).T)
    assert (radius.min(), radius.max()) == pytest.approx((0.3, 0.7), abs=1e-3)
    assert free_ring(planar_arm(ranges=LIMITED)) is None


@given(point, point)
def test_first_point_outside_a_ring(start, end):
    """Against 4001 points of the segment."""
    ring = Ring((0.1, -0.2), 0.5, 1.2)
    shares = np.linspace(0.0, 1.0, 4001)
    places = np.array(start) + shares[:, None] * (np.array(end) - np.array(start))
    missing = np.array([ring.missing(place) for place in places])
    result = ring.first_outside(start, end)
    outside = missing > 1e-6
    if not outside.any():
        assert result is None or ring.missing(places[min(4000, math.ceil(result * 4000))]) < 1e-6
    else:
        assert result is not None
        assert result <= shares[np.argmax(outside)] + 1e-9
        assert not outside[: max(0, math.floor(result * 4000) - 1)].any()


@given(st.tuples(*[st.floats(low + 0.01, high - 0.01) for low, high in LIMITED]), st.integers(0, 10**6))
@settings(max_examples=25, deadline=None)
def test_every_point_of_a_proven_ball_has_a_pose(q, seed):
    """Random points of the ball, its edge among them, searched for from the pose itself."""
    reach = Reach(planar_arm(ranges=LIMITED))
    ball = reach.ball(np.array(q))
    assume(ball.radius > 1e-6)
    turn = np.random.default_rng(seed).uniform(0.0, math.tau, 12)
    size = ball.radius * np.linspace(0.2, 1.0, 12)
    points = reach.tip(np.array([q]))[0] + size[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    poses, distance = reach.nearest(points, starts=np.vstack([q, np.array(q) + 0.02]))
    assert distance.min(axis=1).max() < 1e-9
    low, high = np.array(LIMITED).T
    assert np.all((poses >= low - 1e-12) & (poses <= high + 1e-12))


def test_a_ball_is_worth_something():
    """In the middle of things a step is centimetres, and it does not reach past the edge of the workspace."""
    reach = Reach(planar_arm())
    assert reach.ball(np.array([0.3, 1.2, 1.0])).radius > 0.01
    for bend in (0.5, 0.1, 0.01):
        q = np.array([0.0, bend, bend])
        tip = float(np.hypot(*reach.tip(q[None])[0]))
        assert 0.0 < reach.ball(q).radius <= 1.24 - tip
    assert reach.ball(np.zeros(3)).radius == 0.0


@pytest.mark.parametrize("angles", ["relative", "absolute"])
def test_the_jacobian_bends_no_more_than_said(angles):
    """|J(a) - J(b)| <= bending |a - b| for random pairs, slides among the joints."""
    rail = Joint(type="prismatic", axis=(1.0, 0.0, 0.0), range=(0.0, 2.0))
    arms = [planar_arm(angles=angles)]
    if angles == "relative":
        joints = (Joint(), rail, Joint(), Joint(axis=(0.0, 1.0, 0.0)))
        arms.append(Arm("m", joints, tuple(map(Link, (0.3, 0.1, 0.4, 0.2)))))
    for arm in arms:
        reach = Reach(arm)
        generator = np.random.default_rng(4)
        low, high = np.array([joint.range for joint in arm.joints]).T
        for _ in range(200):
            a = generator.uniform(low, high)
            b = np.clip(a + generator.normal(0.0, 0.1, arm.size), low, high)
            slopes = jacobian(arm, np.array([a, b]))[:, :, : reach.dimensions]
            change = np.linalg.norm(slopes[0] - slopes[1], 2)
            assert change <= reach.bending * np.linalg.norm(a - b) + 1e-7


def test_seam_across_the_hole_of_a_ring():
    """Links of 1000, 300 and 200 mm: the ends are reachable, the first point that is not lies at (400, 300) mm."""
    result = check_seam(planar_arm((1.0, 0.3, 0.2)), (0.8, 0.3), (-0.8, 0.3))
    assert (result.verdict, result.exact) == ("unreachable", True)
    assert result.first_unreachable == pytest.approx((0.4, 0.3), abs=1e-12)
    assert result.missing == pytest.approx(0.2)
    assert check_seam(planar_arm(), (0.8, 0.3), (-0.8, 0.3)).verdict == "reachable"


def test_a_walk_agrees_with_the_ring():
    """A joint that lacks a thousandth of its circle takes the walk, and finds the same point."""
    nearly = (math.pi, -math.pi + 1e-3)
    ranges = ((-math.pi, math.pi), (-math.pi, math.pi), (nearly[1], nearly[0]))
    result = check_seam(planar_arm((1.0, 0.3, 0.2), ranges), (0.8, 0.3), (-0.8, 0.3))
    assert (result.verdict, result.exact) == ("unreachable", False)
    assert result.first_unreachable == pytest.approx((0.4, 0.3), abs=1e-6)


@pytest.mark.parametrize(
    ("start", "end"),
    [
        pytest.param((0.3, 0.9), (-0.9, 0.1), marks=pytest.mark.slow),
        pytest.param((1.0, 0.1), (0.2, -0.1), marks=pytest.mark.slow),
        ((0.9, 0.5), (0.2, 0.9)),
        pytest.param((0.9, -0.3), (0.4, 0.7), marks=pytest.mark.slow),
    ],
)
def test_seams_under_joint_limits_against_a_dense_grid(start, end):
    """Four million poses say which points of the seam have a tip near them."""
    arm = planar_arm(ranges=LIMITED)
    result = check_seam(arm, start, end)
    grids = [np.linspace(low, high, 160) for low, high in LIMITED]
    first, second, third = np.meshgrid(*grids, indexing="ij")
    a, b, c = first, first + second, first + second + third
    tips = LENGTHS[0] * np.exp(1j * a) + LENGTHS[1] * np.exp(1j * b) + LENGTHS[2] * np.exp(1j * c)
    tips = tips.ravel()
    shares = np.linspace(0.0, 1.0, 41)
    places = complex(*start) + shares * (complex(*end) - complex(*start))
    nearest = np.array([np.abs(tips - place).min() for place in places])
    apart = 0.02  # no point of the reachable set is farther than this from a tip of the grid
    if result.verdict == "reachable":
        assert nearest.max() < apart
    else:
        assert result.verdict == "unreachable"
        assert nearest[shares < result.proved_to].max(initial=0.0) < apart
        assert nearest[shares > result.proved_to].max() > 1e-3
        assert nearest.max() == pytest.approx(result.missing, abs=apart)


def test_reachable_seams_are_proved_and_not_sampled():
    """Every step of the walk is covered by the ball of a pose: no gaps are left."""
    limits = tuple((-math.radians(x), math.radians(x)) for x in (120, 150, 150))
    result = check_seam(planar_arm(ranges=limits), (0.9, -0.3), (0.4, 0.7))
    assert (result.verdict, result.proved_to, result.gaps, result.exact) == ("reachable", 1.0, (), False)


def test_the_very_edge_is_left_undecided():
    """At full stretch no ball is left: poses are found, nothing is claimed of the last tenth of a millimetre."""
    limits = tuple((-math.radians(x), math.radians(x)) for x in (120, 150, 150))
    result = check_seam(planar_arm(ranges=limits), (1.1, 0.0), (1.24, 0.0))
    assert result.verdict == "undecided"
    assert 0.999 < result.proved_to < 1.0
    assert result.gaps == ((result.proved_to, 1.0),)


@pytest.mark.slow
def test_gaps_beside_each_other_are_one():
    """A seam that touches the hole's edge is undecided around the one point where it does."""
    nearly = (-math.pi + 0.04, math.pi - 0.04)
    arm = planar_arm((1.0, 0.3, 0.2), ((-math.pi, math.pi), (-math.pi, math.pi), nearly))
    result = check_seam(arm, (0.03, 0.5), (-0.03, 0.5))
    assert result.verdict == "undecided"
    ((low, high),) = result.gaps
    assert low < 0.5 < high


@pytest.mark.slow
def test_a_seam_in_space_with_a_rail():
    """A rail of 2 m under two joints: along it everything within reach, beyond its end nothing."""
    rail = Joint(type="prismatic", axis=(1.0, 0.0, 0.0), range=(0.0, 2.0))
    arm = Arm("rail", (rail, Joint(), Joint()), (Link(0.0), Link(0.4), Link(0.42)))
    assert check_seam(arm, (0.1, 0.3), (2.2, 0.3)).verdict == "reachable"
    beyond = check_seam(arm, (2.0, 0.3), (3.0, 0.3))
    assert beyond.verdict == "unreachable"
    assert beyond.first_unreachable == pytest.approx((2.0 + math.sqrt(0.82**2 - 0.09), 0.3), abs=1e-5)
