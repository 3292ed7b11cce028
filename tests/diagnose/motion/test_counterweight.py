"""A lift whose counterweight carries an arm: its drive gives friction and inertia alone, and an offset is named first.

Torques are those of point masses at the links' ends, by Newton's equations."""

from __future__ import annotations

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.diagnose.motion.diagnosis import diagnose_motion
from linkwright.core.diagnose.motion.reading.read import read_log

LIFT, MASSES, LENGTHS, G = 12.0, (4.0, 2.5), (0.4, 0.35), 9.81


def log_of_a_lift(folder):
    """Thirty seconds of a vertical slide and two joints about y, whose links are level at 0."""
    time = np.arange(3000) / 100.0
    rates, sizes = np.array([0.5, 0.9, 1.3]), np.array([0.12, 0.9, 0.8])
    phase = time[:, None] * rates + np.array([0.3, 1.1, 2.0])
    q, v = sizes * np.sin(phase) + np.array([0.2, 0.3, -0.4]), sizes * rates * np.cos(phase)
    a = -sizes * rates**2 * np.sin(phase)
    turned, spin, spun = (np.cumsum(each[:, 1:], axis=1) for each in (q, v, a))
    sine, cosine = np.sin(turned), np.cos(turned)
    along = np.cumsum(LENGTHS * (-cosine * spin**2 - sine * spun), axis=1)
    upwards = a[:, :1] + G + np.cumsum(LENGTHS * (sine * spin**2 - cosine * spun), axis=1)
    # What mass j asks of a turn of link i.
    work = -(along[:, :, None] * (sine * LENGTHS)[:, None] + upwards[:, :, None] * (cosine * LENGTHS)[:, None])
    work *= np.array(MASSES)[:, None]
    first, second = work[:, 0, 0] + work[:, 1].sum(axis=1), work[:, 1, 1]
    force = LIFT * (a[:, 0] + G) + upwards @ MASSES - (LIFT + sum(MASSES)) * G
    torque = np.stack([force, first, second], axis=1)
    torque += np.array([4.0, 0.8, 0.4]) * np.tanh(v / 0.005) + np.array([10.0, 0.5, 0.3]) * v
    torque += np.random.default_rng(4).normal(0.0, [0.3, 0.05, 0.03], torque.shape)
    columns = {"t_s": time, "q1_m": q[:, 0], "v1_m_s": v[:, 0], "tau1_N": torque[:, 0]}
    for k in (1, 2):
        columns |= {f"q{k + 1}_rad": q[:, k], f"v{k + 1}_rad_s": v[:, k], f"tau{k + 1}_Nm": torque[:, k]}
    rows = [",".join(columns), *(",".join(f"{x:.7g}" for x in row) for row in zip(*columns.values(), strict=True))]
    (folder / "log.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    return folder / "log.csv"


def test_what_a_counterweight_carries_is_an_offset_of_its_joint_alone(tmp_path):
    lift = Joint(type="prismatic", axis=(0.0, 0.0, 1.0), range=(0.0, 0.4))
    joints = (lift, *(Joint(axis=(0.0, 1.0, 0.0)) for _ in MASSES))
    ends = zip(LENGTHS, MASSES, strict=True)
    links = (Link(0.0, mass=LIFT), *(Link(length, mass=mass, center_of_mass=length) for length, mass in ends))
    arm = Arm("torso", joints, links, gravity=(0.0, 0.0, -G))
    log = read_log(log_of_a_lift(tmp_path), arm)
    assert any("does a counterweight carry them?" in said for said in log.warnings)
    named = diagnose_motion(arm, [log]).findings
    assert (named[0].effect, named[0].at) == ("torque_offset", (1,))
    assert named[0].parameters[0].value == pytest.approx(-(LIFT + sum(MASSES)) * G, rel=1e-3)
    assert {each.effect for each in named[1:]} == {"friction_coulomb", "friction_viscous"}
