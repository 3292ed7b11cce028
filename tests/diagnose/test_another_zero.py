"""A joint that counts from another zero, swallowed by a free tool: what hangs on it pulls another way than it seems."""

from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import LoadCase
from linkwright.core.diagnose.steps.diagnosis import diagnose
from linkwright.core.units.quantities import InputError

from .by_cosines import GIVES, LENGTHS, file, noise, poses, recording

QUARTER = 0.5 * np.pi
MASSES = np.array([8.0, 5.0, 6.0])
"""kg of the links, each in its middle."""


def ranged(*ranges):
    """The arm of sums of cosines with nothing at its tip but links that weigh, and these ranges of its joints."""
    arm = file(payload=LoadCase(0.0))
    joints = tuple(replace(joint, range=limits) for joint, limits in zip(arm.joints, ranges, strict=True))
    links = tuple(replace(link, mass=float(mass)) for link, mass in zip(arm.links, MASSES, strict=True))
    return replace(arm, joints=joints, links=links)


def tips(q):
    """Tips (N, 2), m, under the links' weight, by torques about each joint."""
    off = np.zeros_like(q)
    for _ in range(4):  # loads act on the arm as it stands
        out = np.cos(np.cumsum(q + off, axis=1)) * LENGTHS
        end = np.cumsum(out, axis=1)
        middle, begin = end - 0.5 * out, end - out
        torque = [MASSES[k:] @ (middle[:, k:] - begin[:, k : k + 1]).T for k in range(3)]
        off = -GIVES * 9.81 * np.stack(torque, axis=1)
    angles = np.cumsum(q + off, axis=1)
    return np.stack([np.cos(angles) @ LENGTHS, np.sin(angles) @ LENGTHS], axis=1)


def test_another_zero_is_told_by_the_range_and_by_what_hangs_on_the_joint():
    q = np.repeat(poses(3, 30), 2, axis=0)
    tip = tips(q) + noise(3, len(q))
    arm = ranged((-2.4, 2.4), (-2.4, 2.4), (-2.4, 2.4))
    with pytest.raises(InputError, match="q3 counts from another zero, 90 deg away"):
        diagnose(arm, recording(q - [0.0, 0.0, QUARTER], tip, tool="free"))


def test_a_range_that_is_wrong_is_no_other_zero():
    """The same rows beyond the range, but what hangs on the joint pulls as the readings say."""
    q = np.repeat(poses(3, 30), 2, axis=0)
    arm = ranged((-2.4, 2.4), (-2.4, 2.4), (-2.4 + QUARTER, 2.4 + QUARTER))
    result = diagnose(arm, recording(q, tips(q) + noise(3, len(q)), tool="free"))
    assert result.verdict == "none"
