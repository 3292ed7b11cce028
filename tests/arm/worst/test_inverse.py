"""Poses for points: the paper's equations and the general search, against forward kinematics."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.arm.chain.kinematics import place, tip_position
from linkwright.core.arm.worst.inverse import UnreachableInclined, inverse
from linkwright.core.arm.worst.workspace import Unreachable
from tests.arm.worst.planar_inverse import planar_3r
from tests.costs import slow_but
from tests.random_chains import random_spatial_chain

LENGTHS = (0.4, 0.42, 0.42)
angle = st.floats(-math.pi, math.pi)
length = st.floats(0.1, 2.0)


def planar_arm(lengths=LENGTHS, ranges=None, angles="relative"):
    spans = ranges or ((-math.pi, math.pi),) * len(lengths)
    return Arm("planar", tuple(Joint(range=span) for span in spans), tuple(map(Link, lengths)), angles=angles)


def forward(lengths, absolute):
    """Equations (1) and (2) of the paper."""
    x = sum(a * math.cos(t) for a, t in zip(lengths, absolute, strict=True))
    return x, sum(a * math.sin(t) for a, t in zip(lengths, absolute, strict=True))


def apart(one, other):
    """The largest difference of two lists of angles, whole turns aside."""
    return max(abs(math.remainder(a - b, math.tau)) for a, b in zip(one, other, strict=True))


@given(st.tuples(length, length, length), angle, angle, angle)
def test_both_elbows_come_back_to_the_point(lengths, first, second, third):
    """Of whatever pose the point was made, it is among those found."""
    x, y = forward(lengths, (first, second, third))
    poses = planar_3r(lengths, x, y, third)
    for pose in poses:
        assert forward(lengths, pose.absolute) == pytest.approx((x, y), abs=1e-7 * sum(lengths))
        assert math.cos(pose.absolute[2] - third) == pytest.approx(1.0)
    folded = math.hypot(*forward(lengths[:2], (first, second))) < 1e-6
    if not folded:
        assert min(apart(pose.absolute[:2], (first, second)) for pose in poses) < 1e-5


def test_the_two_elbows_lie_on_either_side():
    """Seen along the line from the base to the third joint."""
    left, right = sorted(planar_3r(LENGTHS, 0.7, 0.3, 0.2), key=lambda pose: pose.elbow)
    assert (left.elbow, right.elbow) == ("left", "right")
    joint = (0.7 - 0.42 * math.cos(0.2), 0.3 - 0.42 * math.sin(0.2))
    for pose, side in ((left, 1.0), (right, -1.0)):
        elbow = (0.4 * math.cos(pose.absolute[0]), 0.4 * math.sin(pose.absolute[0]))
        assert side * (joint[0] * elbow[1] - joint[1] * elbow[0]) > 0.0
        assert forward(LENGTHS, np.cumsum(pose.relative)) == pytest.approx((0.7, 0.3))


def test_stretched_there_is_one_pose():
    """Both elbows coincide at full stretch."""
    (pose,) = planar_3r(LENGTHS, 1.24, 0.0, 0.0)
    assert pose.elbow == "straight"
    assert pose.absolute == pytest.approx((0.0, 0.0, 0.0), abs=1e-7)


def test_third_joint_on_the_base():
    """Equal first links may stand anywhere there; unequal ones cannot fold so far."""
    (pose,) = planar_3r((0.5, 0.5, 0.3), 0.3, 0.0, 0.0)
    assert pose.free
    assert forward((0.5, 0.5, 0.3), pose.absolute) == pytest.approx((0.3, 0.0), abs=1e-12)
    with pytest.raises(UnreachableInclined) as refused:
        planar_3r((0.5, 0.4, 0.3), 0.3, 0.0, 0.0)
    assert refused.value.missing == pytest.approx(0.1)


@pytest.mark.parametrize(
    ("x", "inclination", "missing"), [(1.3, 0.0, 0.06), (1.24, math.pi, 0.84), (0.42, 0.0, 0.02), (0.43, 0.0, 0.01)]
)
def test_unreachable_points_are_refused_with_the_distance(x, inclination, missing):
    """Beyond the stretch, and within the hole that links of 400 and 420 mm leave around the base."""
    with pytest.raises(UnreachableInclined) as refused:
        planar_3r(LENGTHS, x, 0.0, inclination)
    assert refused.value.missing == pytest.approx(missing, abs=1e-12)
    assert f"{1e3 * missing:.4g} mm away" in str(refused.value)


@given(angle, angle, angle)
@settings(max_examples=15, deadline=None)
def test_the_search_finds_what_the_equations_give(first, second, third):
    """With the orientation given a planar 3R arm has two poses: both, and no third."""
    exact = planar_3r(LENGTHS, *forward(LENGTHS, (first, second, third)), third)
    if len(exact) < 2 or math.sin(second - first) ** 2 < 1e-2:
        return
    point = forward(LENGTHS, (first, second, third))
    turned = place(planar_arm(), [third, 0.0, 0.0]).orientation
    result = inverse(planar_arm(), point, turned)
    assert len(result) == 2
    for pose in exact:
        assert min(apart(pose.relative, item.q) for item in result) < 1e-6
    assert all(item.isolated and item.residual < 1e-9 for item in result)


def test_a_redundant_arm_gives_samples_of_its_family():
    """Three joints for two coordinates: many poses, none of them isolated."""
    result = inverse(planar_arm(), (0.7, 0.3), most=10)
    assert len(result) == 10
    assert not any(item.isolated for item in result)
    tips = tip_position(planar_arm(), [item.q for item in result])[:, :2]
    assert tips == pytest.approx(np.tile((0.7, 0.3), (10, 1)), abs=1e-9)


def test_joint_limits_are_kept():
    """An elbow that only bends one way leaves one of the two poses."""
    ranges = ((-math.pi, math.pi), (0.1, 3.0), (-math.pi, math.pi))
    turned = place(planar_arm(), [0.2, 0.0, 0.0]).orientation
    (result,) = inverse(planar_arm(ranges=ranges), (0.7, 0.3), turned)
    assert 0.1 <= result.q[1] <= 3.0
    with pytest.raises(UnreachableInclined):
        inverse(planar_arm(ranges=((-0.1, 0.1), (0.1, 3.0), (-math.pi, math.pi))), (0.7, 0.3), turned)


@pytest.mark.parametrize(("point", "missing"), [((1.3, 0.0), 0.06), ((0.0, -2.0), 0.76)])
def test_search_refuses_with_the_distance_missing(point, missing):
    """The ring's own distance."""
    with pytest.raises(Unreachable) as refused:
        inverse(planar_arm(), point)
    assert refused.value.missing == pytest.approx(missing, abs=1e-6)


def test_absolute_angles():
    """An arm whose drives hold the links against the base."""
    arm = planar_arm(angles="absolute")
    result = inverse(arm, (0.5, -0.6), most=4)
    assert tip_position(arm, [item.q for item in result])[:, :2] == pytest.approx(
        np.tile((0.5, -0.6), (4, 1)), abs=1e-9
    )


def test_rail_and_arm():
    """A slide in mm and joints in rad together."""
    rail = Joint(type="prismatic", axis=(1.0, 0.0, 0.0), range=(0.0, 2.0))
    arm = Arm("rail", (rail, Joint(), Joint()), (Link(0.0), Link(0.4), Link(0.42)))
    result = inverse(arm, (2.5, 0.3))
    assert all(0.0 <= item.q[0] <= 2.0 and item.residual < 1e-9 for item in result)
    with pytest.raises(Unreachable) as refused:
        inverse(arm, (3.0, 0.0))
    assert refused.value.missing == pytest.approx(0.18, abs=1e-6)


@pytest.mark.parametrize("seed", slow_but(range(4), 0, 2))
def test_spatial_chains_meet_point_and_orientation(seed):
    """Six joints in space: the pose that made the target is found again, and every pose found meets it."""
    generator = np.random.default_rng(seed)
    chain = random_spatial_chain(generator, 6)
    arm = Arm("space", tuple(Joint(axis=link.axis) for link in chain.links), tuple(Link(x.length) for x in chain.links))
    frames = place(arm, generator.uniform(-2.0, 2.0, 6).tolist())
    target = np.array(frames.tip(), dtype=float)
    for item in inverse(arm, target.tolist(), frames.orientation, seeds=96):
        reached = place(arm, list(item.q))
        assert np.array(reached.tip()) == pytest.approx(target, abs=1e-8)
        assert np.array(reached.orientation) == pytest.approx(np.array(frames.orientation), abs=1e-7)
