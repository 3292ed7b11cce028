"""Zeros off by degrees and lengths by a hundredth are named as that, and nothing beside them."""

import numpy as np
import pytest

from linkwright.core.arm.files.read import read_arm
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.residual.observed import rms_length
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.costs import slow_but
from tests.diagnose.off_by_degrees import (
    arm_file,
    drawn,
    least_squares_with_the_true_set,
    sessions,
)

SURE = 8.0
"""Standard errors from which on what is off must be named: p = 0.003 over all candidates asks for some five."""
QUICK = (1, 4, 10)
ONCE_STOPPED = 119
"""Whose small causes a singular value decomposition by divide and conquer did not converge for."""


def recording(case, q, tip):
    tool = "free" if case.tool_free else "known"
    return Recording("drawn", q, tip, np.arange(1, len(q) + 1), frame="free", tool=tool)


def judged(case, seed, tmp_path):
    """What is named; what the corrected arm leaves of further readings, over least squares with the true set; and what
    is off by many standard errors."""
    path = tmp_path / "arm.yaml"
    path.write_text(arm_file(case), encoding="utf-8")
    fitted, further = sessions(case, seed)
    best, sure = least_squares_with_the_true_set(case, fitted, further)
    result = diagnose(read_arm(path), recording(case, *fitted))
    left = rms_length(observe(result.corrected, recording(case, *further)).tip_residual())
    return result, left / best, {name for name, errors in sure.items() if errors > SURE}


@pytest.mark.parametrize("seed", slow_but((*range(40), ONCE_STOPPED), *QUICK))
def test_zeros_and_lengths_are_named_and_nothing_beside(seed, tmp_path):
    result, times, sure = judged(drawn(seed), seed, tmp_path)
    names = {(finding.effect, *finding.at) for finding in result.findings}
    assert {effect for effect, *_ in names} <= {"encoder_offset", "link_length"}
    assert result.unknown is None
    assert times < 1.1
    assert len(names & sure) == len(sure)
