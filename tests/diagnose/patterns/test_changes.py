"""A tool, a load or a stiffness that is another from one visit on, and what the library has no form for: recordings by
plain sums of cosines, which share no code with the product."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from linkwright.core.diagnose.result import Diagnosis
from linkwright.core.diagnose.steps.diagnosis import diagnose
from linkwright.core.sections.numeric import Array
from tests.costs import slow_but
from tests.diagnose.by_cosines import GIVES, LENGTHS, MASS, SIGMA, file, noise, poses, recording

VISITS, FIRST = 50, 22
"""Visits of two readings each; from this one on (from 0) something is another."""


def diagnosed(
    seed: int,
    gives: Callable[[Array], Array] = lambda torque: torque * GIVES,
    errors: Array | float = 0.0,
    mass: Array | float = MASS,
    tool: tuple[Array, Array] | None = None,
) -> Diagnosis:
    """The diagnosis of an arm whose drives turn by `gives` (N, 3) of their torques, rad; it carries `mass` (N, 1) and
    its tool is off along and across the last link (N,), m."""
    q = poses_of(seed)
    off = np.zeros_like(q) + errors
    for _ in range(6):  # loads act on the arm as it stands
        out = np.cos(np.cumsum(q + off, axis=1)) * LENGTHS
        off = errors + gives(-9.81 * mass * np.cumsum(out[:, ::-1], axis=1)[:, ::-1])
    angles = np.cumsum(q + off, axis=1)
    tip = np.stack([np.cos(angles) @ LENGTHS, np.sin(angles) @ LENGTHS], axis=1)
    if tool is not None:
        hand = np.stack([np.cos(angles[:, 2]), np.sin(angles[:, 2])], axis=1)
        tip += tool[0][:, None] * hand + tool[1][:, None] * hand[:, ::-1] * [-1.0, 1.0]
    return diagnose(file(), recording(q, tip + noise(seed, len(q))))


def poses_of(seed: int) -> Array:
    return np.repeat(poses(seed, VISITS), 2, axis=0)


AFTER = (np.arange(2 * VISITS) >= 2 * FIRST).astype(float)


def changed(what: str) -> Diagnosis:
    """The tool slips by 0.1 mm, a kilogram is hung on, drive 2 gives 8 urad/(N*m) more; from one visit on."""
    if what == "tool":
        return diagnosed(1, tool=(7e-5 * AFTER, 7e-5 * AFTER))
    if what == "load":
        return diagnosed(1, mass=MASS + AFTER[:, None])
    return diagnosed(1, gives=lambda torque: torque * (GIVES + AFTER[:, None] * np.array([0.0, 8e-6, 0.0])))


@pytest.mark.slow
@pytest.mark.parametrize("what", ["tool", "load", "stiffness"])
def test_a_step_in_time_is_told_by_what_has_changed(what: str) -> None:
    result = changed(what)
    assert result.verdict == "unknown"
    assert result.unknown is not None
    assert result.unknown.forms[0].name == f"{what}_step_in_time"
    assert result.unknown.shape.startswith(result.unknown.forms[0].sentence)
    assert result.unknown.forms[0].share_held_out > 0.9
    assert result.unknown.since == pytest.approx(16.0 * FIRST, abs=8.0)
    assert result.rms_after < 1.1 * np.sqrt(2.0) * SIGMA
    assert result.findings == ()
    if what == "stiffness":
        assert "(joint 2)" in result.unknown.shape


@pytest.mark.parametrize("what", slow_but(["ridge", "kink"], "ridge"))
def test_what_has_no_form_is_not_named(what: str) -> None:
    """An angle that is off by the sharp ridge of two others' product, and a drive that gives to one side only: no cause
    of the library, nor one of its forms, is the answer."""
    if what == "ridge":
        q = poses_of(1)
        result = diagnosed(1, errors=2e-4 * np.abs(q[:, 0] * q[:, 2])[:, None] * np.array([0.0, 1.0, 0.0]))
    else:
        softer = np.array([0.0, 1.5e-5, 0.0])
        result = diagnosed(1, gives=lambda torque: torque * GIVES + softer * np.maximum(torque, 0.0))
    assert result.verdict == "unknown"
    assert result.rms_after > 1.3 * np.sqrt(2.0) * SIGMA


@pytest.mark.slow
def test_a_joint_that_is_off_by_its_product_with_another_is_described_and_not_named() -> None:
    """The form names both joints; no cause of the library is the answer."""
    q = poses_of(1)
    result = diagnosed(1, errors=1.5e-4 * (q[:, 0] * q[:, 1])[:, None] * np.array([0.0, 1.0, 0.0]))
    assert result.verdict == "unknown"
    assert result.unknown is not None
    assert result.unknown.shape.endswith("(joint 2 by joint 1)")
    assert result.findings == ()
    assert result.rms_after < 1.1 * np.sqrt(2.0) * SIGMA
