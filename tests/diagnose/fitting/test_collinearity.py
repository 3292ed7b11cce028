"""What the constant of a wind-up may hold of play, by recordings of the textbook's kinematics."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.diagnose.reading.read import read_recording
from linkwright.core.diagnose.result import Finding, FittedParameter
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.diagnose.arm_of_drives import COMPLIANCE, SIGMA, arm_of_drives
from tests.diagnose.recorded import LENGTHS, sagging_tip, table, written

WINDUP, HALF_PLAY, PER_LOAD = 0.1e-3, 0.2e-3, 1e-5


def wound_up(folder: Path, payloads: tuple[float, float], per_load: float = PER_LOAD) -> Finding:
    """Joint 3 is held back on the side of approach: by friction, more of it under load, and by play that friction holds
    too. Two payloads, every pose from both sides."""
    rng = np.random.default_rng(11)
    stood = np.repeat(rng.uniform(-1.2, 1.2, (60, 3)), 2, axis=0)
    sides = np.tile([[-1.0], [1.0]], (60, 3))
    payload = np.repeat(rng.choice(payloads, 60), 2)
    load = 9.81 * payload * LENGTHS[2] * np.abs(np.cos(stood.sum(axis=1)))
    moved = -sides * np.array([0.0, 0.0, 1.0]) * (WINDUP + HALF_PLAY + per_load * load)[:, None]
    tip = sagging_tip(stood + moved, 1.0 / np.array(COMPLIANCE), payload)
    tip += SIGMA * rng.standard_normal(tip.shape)
    columns = table(stood, tip, payload_kg=payload, **{f"dir{k + 1}": sides[:, k] for k in range(3)})
    (folder / "recording.yaml").write_text(f"sigma: {1e6 * SIGMA:g} um\n", encoding="utf-8")
    arm = replace(arm_of_drives(), gravity=(0.0, -9.81, 0.0))
    result = diagnose(arm, read_recording(written(folder / "recording.csv", columns), arm, folder / "recording.yaml"))
    assert [(finding.effect, finding.at) for finding in result.findings] == [("friction_windup", (3,))]
    return result.findings[0]


def constant(found: Finding) -> FittedParameter:
    return next(parameter for parameter in found.parameters if parameter.parameter == "windup")


@pytest.mark.slow
def test_the_constant_of_a_windup_may_be_play_that_friction_holds(tmp_path: Path) -> None:
    result = wound_up(tmp_path, (2.0, 5.0))
    windup = constant(result)
    assert windup.value == pytest.approx(WINDUP + HALF_PLAY, rel=0.1)
    assert windup.may_hold == "backlash"
    assert windup.interval[0] > WINDUP  # of both together it is known well
    assert windup.alone[0] <= WINDUP <= windup.alone[1]
    assert windup.alone[0] >= 0.0
    assert windup.alone[1] == windup.interval[1]
    assert "part of it may be backlash of the drives" in result.reading


@pytest.mark.slow
def test_play_under_loads_that_no_friction_holds_is_no_part_of_it(tmp_path: Path) -> None:
    """There it would be seated by the load, which shows."""
    windup = constant(wound_up(tmp_path, (60.0, 90.0)))
    assert windup.may_hold == ""
    assert windup.alone == windup.interval


def test_a_windup_of_one_size_has_play_as_another_name(tmp_path: Path) -> None:
    result = wound_up(tmp_path, (2.0, 5.0), per_load=0.0)
    assert [alternative.effect for alternative in result.alternatives] == ["backlash"]
    assert constant(result).may_hold == ""
