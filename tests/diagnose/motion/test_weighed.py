"""Currents whose torque constants nobody says: the arm's weights make them, and a diagnosis is in N*m by them."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.arm.effects.effect import EffectEntry
from linkwright.core.diagnose.motion.diagnosis import diagnose_motion
from linkwright.core.diagnose.motion.log import CURRENT, MotionLog
from linkwright.core.diagnose.motion.preparation import prepare
from linkwright.core.diagnose.motion.simulate import simulate_motion
from linkwright.core.diagnose.motion.weighed import weighed
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.units.quantities import InputError

CONSTANTS = np.array([14.0, 6.0])
RUBBING = (
    EffectEntry("friction_coulomb", (1,), {"torque": 5.0}),
    EffectEntry("friction_coulomb", (2,), {"torque": 3.0}),
)


def arm() -> Arm:
    """Two rods on a vertical plane."""
    return Arm("rods", (Joint(), Joint()), (Link(0.5, mass=6.0), Link(0.4, mass=4.0)))


def mast() -> Arm:
    """The first of three joints turns about the vertical, and the last has a link that weighs next to nothing."""
    joints = (Joint(axis=(0.0, 1.0, 0.0)), Joint(), Joint(axis=(1.0, 0.0, 0.0)))
    return Arm("mast", joints, (Link(0.3, mass=5.0), Link(0.5, mass=6.0), Link(0.05, mass=1e-4)))


def currents(of: Arm, constants, seed: int) -> MotionLog:
    """A log whose drives rub, in A."""
    rubs = [EffectEntry("friction_coulomb", (k + 1,), {"torque": 5.0}) for k in range(of.size)]
    log = simulate_motion(of, effects=rubs, noise=0.1, seed=seed)
    return replace(log, torque=log.torque / constants, drive=CURRENT, torque_constants_free=True)


def test_a_diagnosis_of_currents_is_in_newton_metres():
    """Friction has its size, and nothing is said of weights and constants, which agree."""
    log = simulate_motion(arm(), effects=RUBBING, noise=0.05, seed=4)
    free = replace(log, torque=log.torque / CONSTANTS, drive=CURRENT, torque_constants_free=True)
    result = diagnose_motion(arm(), [free])
    assert result.logs[0].weighed == pytest.approx(CONSTANTS, rel=0.03)
    assert result.logs[0].torque == pytest.approx(log.torque * result.logs[0].weighed / CONSTANTS)
    sizes = {
        finding.at: finding.parameters[0].value for finding in result.findings if finding.effect == "friction_coulomb"
    }
    assert sizes[(1,)] == pytest.approx(5.0, rel=0.08)
    assert sizes[(2,)] == pytest.approx(3.0, rel=0.08)
    assert all(max(finding.rms_explained) < 0.5 for finding in result.findings if finding.effect != "friction_coulomb")


def test_drives_that_bear_no_weight_count_as_not_logged():
    """Their friction tells no constant; what masses swing to and fro does. Logs with torques stay as they are."""
    log = currents(mast(), np.array([9.0, 14.0, 4.0]), 2)
    known = replace(log, torque_constants_free=False)
    got, same = weighed(mast(), [prepare(mast(), item, rules=RULES) for item in (log, known)], rules=RULES)
    assert got.weighed is not None
    assert got.weighed[:2] == pytest.approx((9.0, 14.0), rel=0.05)
    assert math.isnan(got.weighed[2])
    assert np.isnan(got.torque[:, 2]).all()
    assert same is known
    result = diagnose_motion(mast(), [log])
    assert {at for finding in result.findings for at in finding.at} <= {1, 2}
    assert result.unknown is None


def test_weights_that_tell_no_constant_at_all():
    """One line says what to write."""
    turntable = Arm("table", (Joint(axis=(0.0, 1.0, 0.0)),), (Link(0.3, mass=5.0),))
    with pytest.raises(InputError, match=r"torque_constants: is missing.* write `torque_constants: \[14.9, ...\]`"):
        diagnose_motion(turntable, [currents(turntable, 9.0, 3)])
