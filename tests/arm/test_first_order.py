"""What `evaluate` says of first order: a drive that gives, by hand, and a bound that the arm keeps as it stands."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from linkwright.core.arm.chain.chain import Arm, Joint, Link, LoadCase
from linkwright.core.arm.chain.conditions import Conditions
from linkwright.core.arm.chain.statics import solve
from linkwright.core.arm.compensation import model_error
from linkwright.core.arm.errors.exact import deformed
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.errors.tip import active_effects
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.sections.shapes.tube import Tube
from linkwright.results.design import bound_words, first_order_words

STEEL = load_catalogue(user=False).find("steel-s355")


def rod(stiffness, mass=10.0, reach=(-1.4, 1.4)):
    """One drive that gives, one stiff link of 1 m without weight, a mass at its end."""
    return Arm("rod", (Joint(range=reach, stiffness=stiffness),), (Link(1.0, mass=0.0),), payload=LoadCase(mass))


def test_a_drive_that_gives_is_off_by_what_geometry_says():
    """First order sinks straight down by m g L / K; really the tip goes round to where the torque has become less."""
    result = evaluate(rod(2e3))
    (at,) = result.worst.poses[0].q
    assert at == pytest.approx(0.0, abs=1e-6)
    turn = brentq(lambda x: 2e3 * x + 98.1 * math.cos(x), -0.2, 0.2, xtol=1e-15)
    off = math.hypot(math.cos(turn) - 1.0, math.sin(turn) + 98.1 / 2e3)
    assert result.beyond.at_worst == pytest.approx(off, rel=1e-6)
    assert result.upper_bound is not None


def soft_arm(seed):
    """Three links of tube that bend by millimetres, drives that give, any weight at the tip."""
    random = np.random.default_rng(seed)
    joints = tuple(Joint(range=(-1.5, 1.5), stiffness=float(k)) for k in random.uniform(2e4, 2e5, 3))
    tube = Tube(0.05, 0.004)
    links = tuple(Link(float(length), section=tube, material=STEEL) for length in random.uniform(0.3, 0.7, 3))
    return Arm("soft", joints, links, payload=LoadCase(float(random.uniform(2.0, 20.0))))


def mast(seed):
    """The same held upright: what weighs on it pushes it further over than first order knows."""
    arm = soft_arm(seed)
    reach = [(math.pi / 2.0 - 0.4, math.pi / 2.0 + 0.4), (-0.3, 0.3), (-0.3, 0.3)]
    return replace(arm, joints=tuple(replace(j, range=r) for j, r in zip(arm.joints, reach, strict=True)))


@pytest.mark.parametrize("arm", [soft_arm(0), soft_arm(1), mast(0), mast(1)], ids=["soft", "soft", "mast", "mast"])
def test_no_pose_as_it_really_stands_is_worse_than_the_bound(arm):
    """At poses that the evaluation did not look at. To first order the masts' bound would not hold."""
    result = evaluate(arm)
    lower, upper = np.array([joint.range for joint in arm.joints]).T
    random = np.random.default_rng(100)
    near = np.clip(np.array(result.worst.poses[0].q) + random.normal(0.0, 0.02, (200, 3)), lower, upper)
    poses = np.vstack([random.uniform(lower, upper, (400, 3)), near])
    met = np.linalg.norm(model_error(arm, poses, arm.payload.mass), axis=1).max()
    assert result.upper_bound is not None
    assert met <= result.upper_bound
    assert (met > result.worst.upper_bound) == (upper[0] > 1.6)


def test_an_arm_that_finds_no_shape_has_no_bound():
    """A column under a load above what its drive can hold upright: m g L > K falls over."""
    arm = replace(rod(50.0, mass=10.0), gravity=(-9.81, 0.0, 0.0))
    result = evaluate(arm)
    assert result.upper_bound is None
    assert any("finds no shape" in warning for warning in result.warnings)


def test_only_what_a_certificate_covers_is_called_certified():
    """The words' bound is that of first order; what samples add to it stands beside it, as such."""
    result = evaluate(mast(0))
    assert result.worst.certified
    words = bound_words(result)
    assert words == f"certified: no pose is worse than {1e3 * result.worst.upper_bound:.6g} mm to first order"
    assert f"{1e3 * result.upper_bound:.6g} mm" in first_order_words(result)
    assert "poses checked" in first_order_words(result)


def plumb(backlash):
    """A link of 1 m and 10 kg that hangs, on a joint with play that its weight seats."""
    joint = Joint(range=(-math.pi / 2 - 0.4, -math.pi / 2 + 0.4), backlash=backlash)
    return Arm("plumb", (joint,), (Link(1.0, mass=10.0),))


def test_a_link_that_hangs_within_its_play_stands_between_both_ends_of_it():
    """Seated one way it hangs past the plumb line, where its weight seats it the other way: neither end holds."""
    arm, half = plumb(2e-3), 1e-3
    aside = np.array([0.2 * half, -0.7 * half, 30.0 * half])
    state = solve(arm, [-math.pi / 2 + aside], beams_of(arm))
    result = deformed(state, active_effects(arm), 3)
    assert result.settled.all()
    assert np.linalg.norm(result.tip[:2], axis=1) == pytest.approx([0.0, 0.0], abs=half**2)
    # Further out the weight seats it for good, at the end of the play nearer to the plumb line.
    assert np.linalg.norm(result.tip[2]) == pytest.approx(2.0 * math.sin(half / 2.0), rel=1e-9)


def test_an_arm_with_such_a_pose_keeps_its_bound():
    """With play so wide that most poses are such."""
    result = evaluate(plumb(0.5))
    assert result.upper_bound is not None
    assert not any("finds no shape" in warning for warning in result.warnings)


def test_a_joint_that_nothing_loads_does_not_turn_all_its_play_into_bending():
    """Two level links with play about plumb axes: as the first sags, the second's axis leans, and its load turns it by
    a hair. That seats all of the play, which worst play counts as it is."""
    turntable = Joint(range=(-1.0, 1.0), backlash=2e-3)
    links = (Link(0.5, section=Tube(0.05, 0.004), material=STEEL), Link(0.5, mass=1.0))
    arm = Arm("level", (turntable, turntable), links, gravity=(0.0, 0.0, -9.81), payload=LoadCase(5.0))
    still = Joint(range=(-1.0, 1.0))
    with_play, without = (evaluate(replace(arm, joints=(item, item))).beyond for item in (turntable, still))
    assert without.largest is not None
    assert 0.0 < without.largest < 2e-6
    assert with_play.largest == pytest.approx(without.largest, rel=0.05)


def test_play_that_nothing_loads_is_left_in_its_middle():
    """The same arm: its compensation takes the sag, and none of the play, which the least friction holds anywhere."""
    turntable = Joint(range=(-1.0, 1.0), backlash=2e-3)
    links = (Link(0.5, section=Tube(0.05, 0.004), material=STEEL), Link(0.5, mass=1.0))
    arm = Arm("level", (turntable, turntable), links, gravity=(0.0, 0.0, -9.81), payload=LoadCase(5.0))
    still = replace(arm, joints=(Joint(range=(-1.0, 1.0)),) * 2)
    poses = np.array([[0.3, 0.8], [-0.5, -0.9]])
    with_play, without = (model_error(item, poses, 5.0) for item in (arm, still))
    np.testing.assert_allclose(with_play, without, atol=1e-15)
    assert np.abs(without[:, 2]).min() > 1e-4


def test_play_that_nothing_loads_lies_where_the_joint_came_from():
    """A turntable that came from below (side +1) lags by half its play; the tip then lies b/2 times its radius back."""
    arm = Arm(
        "turntable", (Joint(range=(-1.0, 1.0), backlash=2e-3),), (Link(0.5, mass=1.0),), gravity=(0.0, 0.0, -9.81)
    )
    conditions = Conditions(sides=(np.array([1.0, -1.0, 0.0]),))
    state = solve(arm, [np.zeros(3)], beams_of(arm), conditions=conditions)
    result = deformed(state, active_effects(arm), 3)
    np.testing.assert_allclose(result.tip[:, 1], 0.5 * np.sin([-1e-3, 1e-3, 0.0]), rtol=1e-9, atol=1e-15)


def test_what_rigid_links_would_leave_is_what_the_drives_and_their_play_do():
    """A level beam on a drive: of the tip's drop m g L^2 / K + b L / 2 is not the beam's; the rest is that its weight
    turns the drive, and that both bend it: m g L^3 / 3EI + w g L^3 / 8EI (S. Timoshenko, Strength of Materials, part
    I), shear beside it."""
    length, mass, stiffness = 0.8, 5.0, 5e4
    joint = Joint(range=(0.0, 1e-9), stiffness=stiffness, backlash=1e-3)
    arm = Arm("beam", (joint,), (Link(length, section=Tube(0.05, 0.004), material=STEEL),), payload=LoadCase(mass))
    result = evaluate(arm)
    of_drive = mass * 9.81 * length**2 / stiffness + 0.5e-3 * length
    assert result.rigid_links_error == pytest.approx(of_drive, rel=1e-6)
    own = result.mass
    modulus = STEEL.at(arm.temperature).need("elastic_modulus")
    bending_stiffness = modulus * math.pi / 64.0 * (0.05**4 - 0.042**4)
    bending = 9.81 * length**3 * (mass / 3.0 + own / 8.0) / bending_stiffness
    assert result.max_error - of_drive == pytest.approx(bending + 0.5 * own * 9.81 * length**2 / stiffness, rel=0.02)
    assert evaluate(rod(2e3)).rigid_links_error is None


def test_an_arm_of_which_nothing_gives_is_not_silently_without_error():
    rigid = Arm("rigid", (Joint(range=(-1.0, 1.0)),), (Link(1.0, mass=2.0),), payload=LoadCase(1.0))
    assert any("nothing in this arm file makes the tip err" in warning for warning in evaluate(rigid).warnings)
    assert not any("nothing in this" in warning for warning in evaluate(rod(2e3)).warnings)
