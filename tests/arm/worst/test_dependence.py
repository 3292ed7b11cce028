"""Which joints a certificate may leave out: a vertical base axis, locked joints, idle ones, and no others."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm, EffectEntry, Joint, Link, LoadCase
from linkwright.core.arm.errors.model import BEAM_FIELDS
from linkwright.core.arm.worst.polynomial_error import error_polynomials
from linkwright.core.arm.worst.workspace import Workspace
from tests.arm.worst.test_worst_case import DOWN_Z, X, Y, Z, check, errors, rods, search_of

TURN = (-2.0, 2.5)
UPRIGHT = (
    Joint(axis=Z, backlash=4e-4, stiffness=3e4, mass=2.0),
    Joint(axis=Y, range=TURN, backlash=3e-4, stiffness=2e4, mass=2.0),
    Joint(axis=Y, range=TURN, stiffness=1e4, mass=1.0),
    Joint(axis=X, range=TURN, stiffness=8e3),
    Joint(axis=Y, range=TURN, stiffness=6e3),
)
LENGTHS = (0.3, 0.5, 0.4, 0.2, 0.1)


def upright(**others: object) -> Arm:
    return rods(UPRIGHT, LENGTHS, **{"gravity": DOWN_Z, "payload": LoadCase(mass=3.0), **others})


def matter(arm: Arm, cases: Sequence[LoadCase] = ()) -> tuple[int, ...]:
    """The joints of which the error of an arm is a polynomial."""
    search, p = search_of(arm, cases)
    coordinates = search._coordinates  # pyright: ignore[reportPrivateUsage]
    case = search.model.cases[0]
    return error_polynomials(case, 0, p, coordinates, arm.play, planar=search.model.planar, confined=False).joints


def gravity_leaning(degrees: float) -> tuple[float, float, float]:
    return (9.81 * math.sin(math.radians(degrees)), 0.0, -9.81 * math.cos(math.radians(degrees)))


@pytest.mark.parametrize("play", ["worst", "loaded"])
def test_turning_a_vertical_base_leaves_every_error_as_long(play: str) -> None:
    search, p = search_of(upright(play=play), [LoadCase(mass=3.0, force=(0.0, 0.0, -40.0))])
    q = np.random.default_rng(1).uniform(search.lower, search.upper, (500, 5))
    turned = q.copy()
    turned[:, 0] = np.random.default_rng(2).uniform(-3.0, 3.0, 500)
    assert errors(search, p, turned) == pytest.approx(errors(search, p, q), rel=1e-9)
    assert matter(upright(play=play), [LoadCase(mass=3.0, force=(0.0, 0.0, -40.0))]) == (1, 2, 3, 4)


def test_five_joints_on_a_vertical_base_are_certified() -> None:
    """Brute force over poses of all five: none is worse than the bound, and the bound is within the gap."""
    worst = check(upright(), poses=10_000)
    # Poses that differ by a turn of the base alone are one.
    rows = np.array([pose.q for pose in worst.poses])[:, 1:]
    distances = np.abs(rows[:, None] - rows[None]).max(axis=2) + np.eye(len(rows))
    assert distances.min() > 0.04


LEANING = replace(UPRIGHT[0], axis=(math.sin(math.radians(1.0)), 0.0, math.cos(math.radians(1.0))))
WAVE = EffectEntry("encoder_eccentricity", (1,), MappingProxyType({"sine": 1e-4}))
UNEVEN = EffectEntry("frame_misalignment", (), MappingProxyType({"x": 1e-4}))


@pytest.mark.parametrize(
    ("change", "case"),
    [
        ({"gravity": gravity_leaning(1.0)}, LoadCase(mass=3.0)),
        ({"gravity": gravity_leaning(1e-4)}, LoadCase(mass=3.0)),
        ({"joints": (LEANING, *UPRIGHT[1:3])}, LoadCase(mass=3.0)),
        ({}, LoadCase(mass=3.0, force=(1e-3, 0.0, 0.0))),
        ({}, LoadCase(mass=3.0, moment=(0.0, 0.1, 0.0))),
        ({"effects": (WAVE,)}, LoadCase(mass=3.0)),
        ({"effects": (UNEVEN,)}, LoadCase(mass=3.0)),
    ],
    ids=["gravity leans", "leans a ten-thousandth", "axis leans", "force across", "moment across", "encoder", "frame"],
)
def test_what_tells_where_the_base_points_keeps_its_joint(change: dict[str, object], case: LoadCase) -> None:
    arm = rods(UPRIGHT[:3], LENGTHS[:3], gravity=DOWN_Z, payload=LoadCase(mass=3.0))
    assert matter(arm) == (1, 2)
    arm = replace(arm, **change)  # type: ignore[arg-type]
    assert matter(arm, [case]) == (0, 1, 2)


def test_an_axis_that_leans_by_a_degree_matters_to_the_error_too() -> None:
    """Turned about its base the worst pose is better by far more than the gap of the certificate."""
    arm = rods((LEANING, *UPRIGHT[1:3]), LENGTHS[:3], gravity=DOWN_Z, payload=LoadCase(mass=3.0))
    assert matter(arm) == (0, 1, 2)
    worst = check(arm, poses=10_000)
    search, p = search_of(arm)
    q = np.tile(worst.poses[0].q, (50, 1))
    q[:, 0] = np.linspace(-3.0, 3.0, 50)
    along = errors(search, p, q)
    assert along.min() < worst.error * (1.0 - 5e-4)


def test_locked_and_idle_joints_do_not_count() -> None:
    """Seven joints: the base upright, two locked (one with a wave on its encoder), the flange turns nothing."""
    locked = (Joint(axis=X, range=(0.4, 0.4), stiffness=9e3), Joint(axis=Z, range=(-0.3, -0.3), stiffness=9e3))
    joints = (*UPRIGHT[:3], *locked, UPRIGHT[4], Joint(axis=X, range=TURN))
    wave = EffectEntry("encoder_eccentricity", (4,), MappingProxyType({"sine": 1e-4}))
    arm = rods(joints, (*LENGTHS[:3], 0.1, 0.1, 0.1, 0.05), gravity=DOWN_Z, effects=(wave,))
    assert matter(arm) == (1, 2, 5)
    check(arm, poses=5_000)


def test_five_locked_or_idle_joints_spoil_no_certificate() -> None:
    """Eight joints, of which three turn what counts: the bound lies within the gap that is asked for."""
    four = [(X, 0.4), (Z, -0.3), (Y, 0.2), (X, -0.6)]
    locked = tuple(Joint(axis=axis, range=(angle, angle), stiffness=9e3) for axis, angle in four)
    joints = (*UPRIGHT[:2], *locked, UPRIGHT[2], Joint(axis=X, range=TURN))
    arm = rods(joints, (*LENGTHS[:2], 0.1, 0.1, 0.1, 0.1, LENGTHS[2], 0.05), gravity=DOWN_Z)
    assert set(matter(arm)) <= {0, 1, 6}
    check(arm, poses=5_000)


def test_a_slide_below_an_upright_joint_does_not_count_either() -> None:
    """As long as nothing below the joint gives: a carriage on rails."""
    arm = rods((Joint("prismatic", X, (0.0, 0.8)), *UPRIGHT[:3]), (0.1, *LENGTHS[:3]), gravity=DOWN_Z)
    assert matter(arm) == (1, 2, 3)
    arm = arm.with_links((Link(0.1, mass=20.0), *arm.links[1:]))
    assert matter(arm) == (2, 3)
    check(arm, poses=20_000)


def test_of_two_upright_axes_one_counts() -> None:
    """A SCARA: turning the first turns all, turning the second alone bends the arm."""
    arm = rods((UPRIGHT[0], replace(UPRIGHT[0], range=TURN)), LENGTHS[1:3], gravity=DOWN_Z, payload=LoadCase(mass=3.0))
    assert matter(arm) == (1,)
    check(arm, poses=20_000)


def test_joints_within_a_box_all_count() -> None:
    """Where the tip has to be says where the base points."""
    joints = tuple(replace(joint, backlash=0.0) for joint in UPRIGHT[:3])
    arm = rods(joints, LENGTHS[:3], gravity=DOWN_Z, payload=LoadCase(mass=3.0))
    box = Workspace("box", ((0.6, 0.1, 0.0), (0.8, 0.3, 0.2)), in_plane=False)
    search, p = search_of(arm, workspace=box)
    worst = search.worst(p)
    assert worst.upper_bound is not None
    q = np.random.default_rng(1).uniform(search.lower, search.upper, (60_000, 3))
    tips = search.tip(q, p)
    inside = np.all((tips >= box.points[0]) & (tips <= box.points[1]), axis=1)
    assert inside.sum() > 20
    assert errors(search, p, q[inside]).max() <= worst.error * (1.0 + 1e-9) <= worst.upper_bound * (1.0 + 2e-9)


def test_a_joint_that_comes_to_matter_with_another_design_is_noticed() -> None:
    """What a search keeps from design to design is given up where it no longer holds: a roll ahead of a link counts
    once that is no longer as stiff on edge as flat."""
    joints = (*UPRIGHT[:3], Joint(axis=X, range=TURN, stiffness=8e3))
    arm = rods(joints, LENGTHS[:4], gravity=DOWN_Z, payload=LoadCase(mass=3.0))
    search, round_ = search_of(arm)
    flat = round_.copy()
    flat[3 * len(BEAM_FIELDS) + BEAM_FIELDS.index("flexural_rigidity_height")] *= 0.3
    for p, joints_then in [(round_, (1, 2)), (flat, (1, 2, 3)), (round_, (1, 2)), (flat, (1, 2, 3))]:
        again, afresh = search.worst(p), search_of(arm)[0].worst(p)
        assert again.error == pytest.approx(afresh.error, rel=1e-9)
        assert again.certified
        assert set(joints_then) <= set(search._matter[0])  # pyright: ignore[reportPrivateUsage]
        q = np.random.default_rng(0).uniform(search.lower, search.upper, (5_000, 4))
        assert again.upper_bound is not None
        assert errors(search, p, q).max() <= again.upper_bound
