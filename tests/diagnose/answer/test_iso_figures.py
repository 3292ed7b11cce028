"""Figures of ISO 9283 and ISO 230-2 against examples worked out by hand."""

import math
from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.arm.chain.arrays import jacobian
from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.diagnose.answer import iso_figures as iso
from linkwright.core.diagnose.recording import Recording
from tests.diagnose.made_diagnosis import made_arm, made_recording

MICRON = 1e-6


def rod():
    """One joint, one link of 1 m: at angle 0 the tip is at (1, 0) and a turn moves it along y."""
    return Arm("rod", (Joint(),), (Link(1.0, mass=1.0),))


def readings(tips_um, q=0.0, **more):
    """Readings of the rod: tips in um from where it should be."""
    tips = np.array(tips_um, dtype=float) * MICRON
    angles = np.broadcast_to(np.asarray(q, dtype=float), (len(tips),))[:, None]
    nominal = np.stack([np.cos(angles[:, 0]), np.sin(angles[:, 0])], axis=1)
    more = {name: np.asarray(value, dtype=float) for name, value in more.items()}
    return Recording("r.csv", angles.copy(), nominal + tips, np.arange(1, len(tips) + 1), **more)


def figure(recording, symbol, arm=None):
    results = {iso_figure.symbol: iso_figure for iso_figure in iso.iso_figures(recording, arm or rod())}
    return results.get(symbol)


CROSS = [(130, 40), (130, 20), (140, 30), (120, 30), (130, 30)]
"""Mean (130, 30); distances from it 10, 10, 10, 10, 0."""


def test_accuracy_is_the_way_from_the_command_to_the_mean():
    """sqrt(130^2 + 30^2) um."""
    result = figure(readings(CROSS), "AP")
    assert result.value == pytest.approx(math.hypot(130.0, 30.0) * MICRON, rel=1e-9)
    assert (result.count, result.standard) == (5, "ISO 9283:1998")


def test_repeatability_is_mean_plus_three_deviations():
    """Mean distance 8, S = sqrt((4 * 2^2 + 8^2) / 4) = sqrt(20): RP = 8 + 3 sqrt(20) um."""
    assert figure(readings(CROSS), "RP").value == pytest.approx((8.0 + 3.0 * math.sqrt(20.0)) * MICRON, rel=1e-9)


def test_repeatability_does_not_mix_sides():
    """Ten readings, two sides 1 mm apart: each side repeats as well as the cross above."""
    other = [(x, y + 1000) for x, y in CROSS]
    mixed = readings(CROSS + other, sides=[[1]] * 5 + [[-1]] * 5)
    assert figure(mixed, "RP").value == pytest.approx((8.0 + 3.0 * math.sqrt(20.0)) * MICRON, rel=1e-9)


def test_variation_with_the_side():
    """Means (0, 0) and (30, 40): 50 um apart."""
    first, second = [(0, 1), (0, -1), (0, 0)], [(30, 41), (30, 39), (30, 40)]
    result = figure(readings(first + second, sides=[[1]] * 3 + [[-1]] * 3), "vAP")
    assert result.value == pytest.approx(50.0 * MICRON, rel=1e-9)
    assert result.count == 3


def test_reversal_is_taken_along_the_joints_own_motion():
    """From below the tip stays 40 um behind where it comes from above; the 30 um across are no reversal."""
    first, second = [(0, 0)] * 3, [(30, 40)] * 3
    recording = readings(first + second, sides=[[1]] * 3 + [[-1]] * 3)
    poses = iso.poses_of(recording, rod())
    assert iso.joint_reversals(recording, rod(), poses, 0) == [(pytest.approx(-40.0 * MICRON, rel=1e-9), 3)]
    assert figure(recording, "B_1").value == pytest.approx(40.0 * MICRON, rel=1e-9)


def test_mean_reversal_keeps_its_sign():
    """-40 um at one pose, +10 um at another: the mean is -15 um, the worst 40 um."""
    quarter = math.pi / 2
    tips = [(0, 0)] * 3 + [(0, 40)] * 3 + [(0, 0)] * 3 + [(10, 0)] * 3
    recording = readings(tips, q=[0.0] * 6 + [quarter] * 6, sides=([[1]] * 3 + [[-1]] * 3) * 2)
    # At a quarter turn the joint moves the tip along -x, so +10 um in x from above is -10 um along its motion.
    assert figure(recording, "B_1").value == pytest.approx(40.0 * MICRON, rel=1e-9)
    assert figure(recording, "B̄_1").value == pytest.approx(-15.0 * MICRON, rel=1e-9)


def test_reversal_wants_the_other_joints_on_the_same_side():
    """Both joints turned round together: a variation with the side, but no one joint's reversal."""
    arm = Arm("two", (Joint(), Joint()), (Link(0.5, mass=1.0), Link(0.5, mass=1.0)))
    sides = np.array([[1.0, 1.0]] * 3 + [[-1.0, -1.0]] * 3)
    tips = tip_position(arm, np.zeros((6, 2)))[:, :2] + np.array([[0.0, 0.0]] * 3 + [[0.0, 5e-5]] * 3)
    recording = Recording("r.csv", np.zeros((6, 2)), tips, np.arange(1, 7), sides=sides)
    results = {iso_figure.symbol for iso_figure in iso.iso_figures(recording, arm)}
    assert "vAP" in results
    assert not results & {"B_1", "B_2"}


def test_static_compliance_is_give_per_newton():
    """10 kg pull the tip down by 98.1 um: 1 um/N, 10 readings, the least of both loads counted."""
    recording = readings([(0, 0)] * 6 + [(0, -98.1)] * 4, payload_mass=[0.0] * 6 + [10.0] * 4)
    result = figure(recording, "C")
    assert result.value == pytest.approx(1e-6, rel=1e-9)
    assert result.count == 4


def test_static_compliance_by_a_force_at_the_tip():
    """30 N along x and 40 N along y are 50 N; 100 um are 2 um/N."""
    force = [[0.0, 0.0, 0.0]] * 3 + [[30.0, 40.0, 0.0]] * 3
    assert figure(readings([(0, 0)] * 3 + [(60, 80)] * 3, force=force), "C").value == pytest.approx(2e-6, rel=1e-9)


def test_drift_is_the_change_of_accuracy_since_the_first_visit():
    """|AP| 100, then 130, then 90 um at visits an hour apart: the drift is 30 um."""
    tips = [(100, 0)] * 3 + [(0, 130)] * 3 + [(90, 0)] * 3
    time = [0, 1, 2, 3600, 3601, 3602, 7200, 7201, 7202]
    assert figure(readings(tips, time=time), "dAP").value == pytest.approx(30.0 * MICRON, rel=1e-9)


def test_one_visit_has_no_drift():
    """Readings one after another are one visit."""
    assert figure(readings([(100, 0), (0, 130), (90, 0)] * 3, time=np.arange(9)), "dAP") is None


def test_too_few_visits_give_nothing():
    """Four readings at a pose carry neither an accuracy nor a repeatability."""
    assert iso.iso_figures(readings(CROSS[:4]), rod()) == ()


def test_accuracy_needs_a_known_frame():
    """With the frame or the tool free nobody knows where the tip should be; repeatability does not ask."""
    for free in ({"frame": "free"}, {"tool": "free"}):
        results = {iso_figure.symbol for iso_figure in iso.iso_figures(replace(readings(CROSS), **free), rod())}
        assert results == {"RP"}


def test_commands_are_what_accuracy_is_measured_from():
    """The encoder reads 1 mrad more than was commanded: 1000 um of the error are the servo's."""
    recording = replace(readings([(0, 0)] * 5, q=1e-3), commanded=np.zeros((5, 1)))
    assert figure(recording, "AP").value == pytest.approx(1000.0 * MICRON, rel=1e-3)


def test_poses_are_grouped_whatever_their_order():
    """Shuffled rows fall into the same poses; encoder readings that differ by noise are one pose."""
    recording = made_recording(poses=7, repeats=4)
    rng = np.random.default_rng(1)
    order = rng.permutation(recording.size)
    shuffled = replace(
        recording,
        q=recording.q[order] + rng.uniform(-3e-5, 3e-5, recording.q.shape),
        tip=recording.tip[order],
        time=recording.time[order],
        sides=recording.sides[order],
        payload_mass=recording.payload_mass[order],
    )
    poses = iso.poses_of(shuffled, made_arm())
    assert sorted(len(pose.rows) for pose in poses) == [4] * 7


@pytest.mark.parametrize(("space", "angles"), [(False, "relative"), (False, "absolute"), (True, "relative")])
def test_jacobian_against_differences(space, angles):
    """Central differences of the tip's position."""
    arm = replace(made_arm(space), angles=angles, tool=(0.1, 0.05, 0.0))
    q = np.random.default_rng(4).uniform(-1.5, 1.5, (20, arm.size))
    step = 1e-6
    for joint in range(arm.size):
        shift = step * np.eye(arm.size)[joint]
        slope = (tip_position(arm, q + shift) - tip_position(arm, q - shift)) / (2.0 * step)
        assert np.abs(jacobian(arm, q)[:, joint] - slope).max() < 1e-8
