"""Exciting trajectories: within ranges, speeds and regions, at rest at both ends, and written as they are."""

import math
from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.arm.avoid.poses import NoRoom, Room
from linkwright.core.arm.avoid.regions import Region
from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.diagnose.motion.uses.trajectory import limits_of, motion_columns, moved, random_series, read_motion
from linkwright.core.diagnose.motion.written import table_text
from linkwright.core.units.quantities import InputError

ANYWHERE = Room()


def an_arm():
    """Two joints that turn, of which one tells its greatest speed, and a slide."""
    turning = Joint(range=(-math.pi / 2, math.pi / 2))
    joints = (replace(turning, velocity=0.5), turning, Joint(type="prismatic", axis=(1.0, 0.0, 0.0), range=(0.0, 0.4)))
    links = tuple(Link(length, mass=2.0, center_of_mass=0.5 * length) for length in (0.4, 0.3, 0.1))
    return Arm("planar", joints, links)


def a_motion(seed, room=ANYWHERE, seconds=12.0):
    arm, draw = an_arm(), np.random.default_rng(seed)
    limits = limits_of(arm, room, draw)
    return moved(arm, random_series(arm, draw, 1)[0], limits, seconds, 200.0, room), limits


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_limits_are_kept_and_used(seed):
    """No joint leaves its range or its speed, and each comes near one of its limits."""
    motion, limits = a_motion(seed)
    for number, joint in enumerate(motion.arm.joints):
        q = motion.q[:, number]
        assert joint.range[0] < q.min() < q.max() < joint.range[1]
    fastest, hardest = np.abs(motion.velocity).max(axis=0), np.abs(motion.acceleration).max(axis=0)
    assert (fastest <= 1.001 * limits.speed).all()
    assert (hardest <= 1.001 * limits.acceleration).all()
    assert limits.speed == pytest.approx([0.95 * 0.5, 0.95 * 1.0, 0.95 * 0.25])
    use = [
        np.abs(motion.q - limits.centre).max(axis=0) / limits.reach,
        fastest / limits.speed,
        hardest / limits.acceleration,
    ]
    assert (np.max(use, axis=0) > 0.98).all()


def test_speeds_are_the_derivatives():
    """By differences, to what a step of 5 ms leaves of them; at rest at both ends."""
    motion, _ = a_motion(4)
    by_difference = np.gradient(motion.q, motion.time, axis=0)
    np.testing.assert_allclose(motion.velocity[1:-1], by_difference[1:-1], atol=2e-3)
    np.testing.assert_allclose(
        motion.acceleration[1:-1], np.gradient(motion.velocity, motion.time, axis=0)[1:-1], atol=2e-2
    )
    for values in (motion.velocity, motion.acceleration):
        assert np.abs(values[[0, -1]]).max() < 1e-9


def test_regions_are_avoided():
    """The tip stays out of a box that it passes through otherwise; where nothing is free it is said."""
    free, _ = a_motion(5)
    tip = tip_position(free.arm, free.q)
    middle = tip[len(tip) // 3]
    box = Region(tuple(middle - 0.05), tuple(middle + 0.05))
    room = Room(avoid=(box,))
    motion, _ = a_motion(5, room)
    assert not room.allows(free.arm, free.q[::10]).all()
    assert room.allows(motion.arm, motion.q[::10]).all()
    with pytest.raises(NoRoom, match="no pose"):
        a_motion(5, Room(avoid=(Region((-9.0, -9.0, -9.0), (9.0, 9.0, 9.0)),)))


def test_a_motion_is_read_as_it_was_written(tmp_path):
    """Speeds and accelerations too; without them they are differences."""
    motion, _ = a_motion(6)
    columns = motion_columns(motion)
    assert list(columns)[:5] == ["time_s", "q1_deg", "q2_deg", "q3_mm", "qd1_deg_s"]
    (tmp_path / "motion.csv").write_text(table_text(columns))
    back = read_motion(tmp_path / "motion.csv", motion.arm)
    for name in ("time", "q", "velocity", "acceleration"):
        np.testing.assert_allclose(getattr(back, name), getattr(motion, name), rtol=1e-6, atol=1e-9)
    bare = {name: values for name, values in columns.items() if not name.startswith("qd")}
    (tmp_path / "bare.csv").write_text(table_text(bare))
    again = read_motion(tmp_path / "bare.csv", motion.arm)
    np.testing.assert_allclose(again.velocity, motion.velocity, atol=0.02)


def test_what_is_no_motion_is_one_line(tmp_path):
    """No clock, a joint too few."""
    place = tmp_path / "motion.csv"
    place.write_text("q1_rad,q2_rad,q3_m\n0,0,0\n")
    with pytest.raises(InputError, match="time_s"):
        read_motion(place, an_arm())
    place.write_text("t_s,q1_rad,q2_rad\n0,0,0\n1,0,0\n2,0,0\n")
    with pytest.raises(InputError, match="q3_m"):
        read_motion(place, an_arm())
