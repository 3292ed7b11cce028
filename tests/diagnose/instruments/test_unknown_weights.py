"""Links that nobody has weighed, with torques beside the tip: what they weigh is fitted and written.

MuJoCo gives the tips, what each drive holds and how drive 2 gives under it; of the library, the description alone.
"""

from __future__ import annotations

import math
from dataclasses import replace

import mujoco
import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.diagnose.first_look.torque_sign import refuse_torques_of_another_sign
from linkwright.core.diagnose.judge.predict import predict
from linkwright.core.diagnose.reading.foreign.headers import Headers
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.diagnose.steps.diagnosis import diagnose
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.units.quantities import InputError
from linkwright.output.diagnosis_folder import with_written
from tests.diagnose.instruments import test_torque_weights as planar

AXES = ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (0.0, 1.0, 0.0))
LENGTHS, MASSES = (0.3, 0.5, 0.4), (12.0, 7.0, 3.0)
ON_LINE = ((0.1, 0.0, 0.0), (0.22, 0.0, 0.0), (0.15, 0.0, 0.0))
BESIDE = ((0.1, 0.05, 0.0), (0.22, 0.0, 0.09), (0.15, 0.0, -0.06))
COMPLIANCE, SIGMA, TORQUE_NOISE = 2e-5, 10e-6, 0.03


def spatial_arm() -> Arm:
    """What the file says: no link was weighed."""
    joints = tuple(Joint(range=(-1.5, 1.5), axis=axis) for axis in AXES)
    return Arm("not weighed", joints, tuple(Link(item) for item in LENGTHS), gravity=(0.0, 0.0, -9.81))


def recorded(seed: int, centres: tuple[tuple[float, float, float], ...], payloads: tuple[float, ...]) -> Recording:
    """Visits at random, read twice: what the encoders read, where the tip is, what the drives hold."""
    body, ends = "", ""
    for axis, mass, centre, before in zip(AXES, MASSES, centres, (0.0, *LENGTHS), strict=False):
        body += f'<body pos="{before} 0 0"><joint axis="{axis[0]} {axis[1]} {axis[2]}"/>'
        body += f'<inertial pos="{centre[0]} {centre[1]} {centre[2]}" mass="{mass}" diaginertia="0.1 0.1 0.1"/>'
        ends += "</body>"
    head = '<compiler angle="radian"/><option gravity="0 0 -9.81"/>'
    world = f'{body}<site name="tip" pos="{LENGTHS[-1]} 0 0"/>{ends}'
    model = mujoco.MjModel.from_xml_string(f"<mujoco>{head}<worldbody>{world}</worldbody></mujoco>")
    data, rng = mujoco.MjData(model), np.random.default_rng(seed)
    q = rng.uniform(-1.4, 1.4, (45, 3))
    payload, side = rng.choice(payloads, 45), rng.choice([-1.0, 1.0], (45, 3))
    tip, held = np.zeros((45, 3)), np.zeros((45, 3))
    for k in range(45):
        for _ in range(6):
            data.qpos[:] = q[k]
            data.qpos[1] -= COMPLIANCE * held[k, 1]
            mujoco.mj_forward(model, data)
            moves, turns = np.zeros((3, 3)), np.zeros((3, 3))
            mujoco.mj_jacSite(model, data, moves, turns, 0)
            held[k] = data.qfrc_bias + 9.81 * payload[k] * moves[2]
        tip[k] = data.site_xpos[0]
    twice = {"repeats": 2, "axis": 0}
    torque = np.repeat(held + side * np.array([4.0, 3.0, 1.0]) + 0.7, **twice)
    seen = np.repeat(tip, **twice)
    return Recording(
        "r.csv", np.repeat(q, **twice), seen + SIGMA * rng.standard_normal(seen.shape), np.arange(1, 91),
        payload_mass=np.repeat(payload, **twice), sides=np.repeat(side, **twice),
        torque=torque + TORQUE_NOISE * rng.standard_normal(torque.shape),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("centres", "payloads"), [(ON_LINE, (0.0, 3.0)), pytest.param(BESIDE, (0.0,), marks=pytest.mark.slow)]
)
def test_what_nobody_has_weighed_is_fitted_to_the_torques_and_written(centres, payloads):
    result = with_written(diagnose(spatial_arm(), recorded(1, centres, payloads)), load_catalogue(user=False))

    (finding,) = result.findings
    assert (finding.effect, finding.at) == ("joint_compliance", (2,))
    # The compliance by itself, and no product with a weight, though no payload was known that would tell it.
    (compliance,) = finding.parameters
    low, high = compliance.interval
    assert low < COMPLIANCE < high
    assert high - low < 0.05 * COMPLIANCE
    assert result.written is not None
    assert result.written.keeps(0.02)
    # Under a payload that was never recorded, without torques.
    other = replace(recorded(2, centres, (0.0, 5.0)), torque=None)
    assert predict(result.corrected, other).rms < 1.15 * math.sqrt(3.0) * SIGMA
    # First moments about joint 2 and 3 as they are, with what lies beyond.
    links = result.corrected.links
    hung = [sum(mass.mass for mass in link.masses) for link in links]
    last = links[2].mass * (links[2].center_of_mass or 0.0) + sum(mass.mass * mass.at[0] for mass in links[2].masses)
    assert last == pytest.approx(MASSES[2] * centres[2][0], rel=0.02)
    whole = (links[1].center_of_mass or 0.0) * links[1].mass + sum(mass.mass * mass.at[0] for mass in links[1].masses)
    assert whole + LENGTHS[1] * (links[2].mass + hung[2]) == pytest.approx(
        MASSES[1] * centres[1][0] + LENGTHS[1] * MASSES[2], rel=0.02
    )
    assert any(hung) == (centres is BESIDE)
    # Joint 1 is upright: no torque tells what link 1 weighs, and the file does not say that it does.
    assert links[0].mass is None
    assert evaluate(result.corrected).mass is None
    assert any("The weight of link 1 loads no drive" in note for note in result.notes)


@pytest.mark.slow
def test_without_torques_only_products_of_compliance_and_weight_show():
    arm = planar.file_arm()
    arm = arm.with_links(tuple(replace(link, mass=None, center_of_mass=None) for link in arm.links))
    recording = planar.recorded(1, planar.MASSES)
    (bare,) = diagnose(arm, replace(recording, torque=None)).findings
    (told,) = diagnose(arm, recording).findings

    assert [parameter.parameter for parameter in bare.parameters] == ["sag", "compliance"]
    (known,) = told.parameters
    low, high = known.interval
    assert low < planar.COMPLIANCE < high
    assert high - low < 0.5 * (bare.parameters[1].interval[1] - bare.parameters[1].interval[0])


def test_torques_of_another_sign_are_refused_whatever_the_links_may_weigh():
    recording = recorded(3, ON_LINE, (0.0, 3.0))
    assert recording.torque is not None
    refuse_torques_of_another_sign(recording, spatial_arm(), Headers({}), rules=RULES.residual)
    for wrong in ([1.0, -1.0, 1.0], [1.0, -1.0, -1.0]):
        turned = replace(recording, torque=recording.torque * wrong)
        names = ", ".join(f"tau{k + 1}" for k, sign in enumerate(wrong) if sign < 0.0)
        with pytest.raises(InputError, match=f"{names}: goes against what links and payload weigh"):
            refuse_torques_of_another_sign(turned, spatial_arm(), Headers({}), rules=RULES.residual)
