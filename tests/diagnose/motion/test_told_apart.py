"""What a log tells apart and what not: a load on the last axis of MuJoCo's arm is as well mass of the link before, when
noise, a drive's filter and friction of no form that is fitted hide what turns with it."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from scipy.signal import lfilter

from linkwright.core.arm.descriptions.imported import import_robot
from linkwright.core.diagnose.motion.diagnosis import diagnose_motion
from linkwright.core.diagnose.motion.reading.read import read_log
from linkwright.core.diagnose.motion.result import MotionDiagnosis, MotionFinding
from linkwright.core.diagnose.rules.rules import RULES
from tests.arm.motion.by_mujoco import as_csv, inverse
from tests.costs import slow_but

SIX = """<mujoco model="six"><compiler angle="radian"/><option gravity="0 0 -9.81"/><worldbody>
<body pos="0 0 .3"><joint name="j1" axis="0 0 1" range="-2.9 2.9"/>
<inertial pos="0 .02 -.03" mass="5.5" diaginertia=".02 .02 .014"/>
<body pos="0 .1 0"><joint name="j2" axis="0 1 0" range="-2.2 2.2"/>
<inertial pos="0 .01 .2" mass="9" diaginertia=".15 .15 .016"/>
<body pos="0 -.08 .42"><joint name="j3" axis="0 1 0" range="-2.4 2.4"/>
<inertial pos="0 .01 .06" mass="4.5" diaginertia=".06 .06 .006"/>
<body pos="0 0 .13"><joint name="j4" axis="0 0 1" range="-3 3"/>
<inertial pos="0 .01 .17" mass="1.7" diaginertia=".003 .003 .0014"/>
<body pos="0 0 .3"><joint name="j5" axis="0 1 0" range="-2 2"/>
<inertial pos="0 .01 .02" mass="1.5" diaginertia=".002 .002 .0012"/>{link}
<body pos="0 0 .1"><joint name="j6" axis="0 0 1" range="-3 3"/>
<inertial pos="0 0 .02" mass=".5" diaginertia=".0008 .0008 .0003"/><site name="tool" pos="0 0 .08"/>{tip}
</body></body></body></body></body></body></worldbody></mujoco>"""
MORE = '<body pos="{}"><inertial pos="0 0 0" mass="1.5" diaginertia=".0003 .0003 .0003"/></body>'
REACH, FASTEST = (1.6, 0.9, 1.0, 1.8, 1.4, 2.0), (1.2, 1.0, 1.2, 1.8, 1.8, 2.2)
DRY = np.array([4.0, 5.0, 3.0, 0.9, 0.7, 0.4])


def log_of_six(seed: int, **more: str) -> str:
    """Coordinates and torques of 30 s at 100 Hz, as CSV."""
    rng = np.random.default_rng(seed)
    model = mujoco.MjModel.from_xml_string(SIX.format(**{"link": "", "tip": "", **more}))
    time = np.arange(3000) / 100.0
    q, v, a = (np.zeros((3000, 6)) for _ in range(3))
    for joint, (reach, fastest) in enumerate(zip(REACH, FASTEST, strict=True)):
        rates = 2.0 * np.pi / 30.0 * rng.choice(np.arange(2, 15), 6, replace=False)
        sizes, angle = rng.normal(size=6) / np.sqrt(rates), time[:, None] * rates + rng.uniform(0.0, 2.0 * np.pi, 6)
        each = np.sin(angle) @ sizes, np.cos(angle) @ (sizes * rates), -np.sin(angle) @ (sizes * rates**2)
        least = min(reach / np.abs(each[0]).max(), fastest / np.abs(each[1]).max())
        q[:, joint], v[:, joint], a[:, joint] = (least * item for item in each)
    torque = inverse(model, q, v, a)
    way = np.tanh(v / 0.003)
    torque += DRY * (way * (1.0 + 0.15 * np.exp(-((v / 0.08) ** 2))) + 0.6 * v) + 0.02 * way * np.abs(torque)
    torque = lfilter([0.95], [1.0, -0.05], torque, axis=0)
    torque += 0.1 * rng.normal(size=torque.shape)
    names = ["t_s", *(f"q{k}_rad" for k in range(1, 7)), *(f"tau{k}_Nm" for k in range(1, 7))]
    return as_csv(names, time, q, torque)


def names_of_mass(folder: Path, text: str) -> tuple[MotionDiagnosis, MotionFinding, set[tuple[str, tuple[int, ...]]]]:
    """The diagnosis of a log by the arm as it should be, its one mass, and that by all its names."""
    (folder / "six.xml").write_text(SIX.format(link="", tip=""), encoding="utf-8")
    (folder / "log.csv").write_text(text, encoding="utf-8")
    arm = import_robot(folder / "six.xml").arm
    found = diagnose_motion(arm, [read_log(folder / "log.csv", arm)])
    (mass,) = (item for item in found.findings if item.effect in ("payload", "link_inertial"))
    return found, mass, {(mass.effect, mass.at), *(one for other in mass.alternatives for one in other.effects)}


@pytest.mark.parametrize("seed", slow_but([0, 2], 2))
def test_a_load_on_the_last_axis_is_as_well_mass_of_the_link_before(tmp_path: Path, seed: int) -> None:
    found, mass, names = names_of_mass(tmp_path, log_of_six(seed, tip=MORE.format("0 0 .12")))
    assert mass.parameters[0].value == pytest.approx(1.5, rel=0.05)
    assert {("payload", ()), ("link_inertial", (5,))} <= names
    assert all(0.0 <= other.worse <= RULES.search.refuted_odds for other in mass.alternatives)
    assert "The logs cannot tell it from " in mass.reading
    assert "in place of extra mass at the tip." in found.sentence


def test_a_load_beside_the_axis_has_its_name_alone(tmp_path: Path) -> None:
    found, mass, names = names_of_mass(tmp_path, log_of_six(0, link=MORE.format(".06 0 .02")))
    assert mass.parameters[0].value == pytest.approx(1.5, rel=0.05)
    assert names == {("link_inertial", (5,))}
    assert "cannot tell" not in mass.reading
    assert "mass, centre and inertia of a link at link 5." not in found.sentence
