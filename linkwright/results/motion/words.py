"""The words of torques: joints with their units, findings with where they act, what the logs cannot tell apart."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import PurePath

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.motion.log import MotionLog
from linkwright.core.diagnose.motion.model.chance import DRAWS
from linkwright.core.diagnose.motion.result import Alternative, MotionDiagnosis, MotionFinding
from linkwright.core.units.lists import listed
from linkwright.results.diagnoses.words import covariate_words, effect_words, probability
from linkwright.results.document import Value
from linkwright.results.figures_in_words import figure, with_unit

NEWTON_METRES = "N·m"


def torque_unit(arm: Arm, joint: int) -> str:
    """The unit of what the drive of a joint (from 1) gives: N·m where it turns, N where it slides."""
    return NEWTON_METRES if arm.joints[joint - 1].revolute else "N"


def torque(value: float, unit: str = NEWTON_METRES, digits: int = 3) -> Value:
    """A torque (or force) with its unit; a dash where it is not known."""
    return Value(with_unit(None if math.isnan(value) else value, unit, digits))


def of_all_joints(each: Sequence[float]) -> float:
    """One figure of those of the joints (n,): the root of the mean of their squares, of those that are known."""
    known = [value for value in each if math.isfinite(value)]
    return math.sqrt(sum(value * value for value in known) / len(known)) if known else math.nan


def by_draws(p: float, draws: int = DRAWS, tests: int = 1) -> Value:
    """A p-value that is a share of draws (0: it is none), the least of several tests: where none reached what was seen,
    at most that of one draw."""
    least = draws and p <= 1.001 * tests / (draws + 1)
    return Value(f"≤ {figure(p, 2)}") if least else probability(p)


def finding_words(finding: MotionFinding) -> str:
    """A finding with where it acts."""
    return effect_words(finding.effect, finding.at, finding.recording)


def alternative_words(alternative: Alternative) -> str:
    """What a finding may as well be: one effect, or several together."""
    named = [effect_words(effect, at) for effect, at in alternative.effects]
    return f"{listed(named)} together" if len(named) > 1 else listed(named)


def alias_sentence(finding: MotionFinding) -> str:
    """What the logs cannot tell from a finding; empty where there is nothing."""
    if not finding.alternatives:
        return ""
    others = [
        f"{alternative_words(item)} ({'exactly alike' if item.worse <= 0.0 else f'{figure(item.worse, 2)} nats less'})"
        for item in finding.alternatives
    ]
    return f"The logs cannot tell {finding_words(finding)} from {listed(others, 'or')}."


def dependence_words(names: Sequence[str]) -> str:
    """What a residual depends on, in words."""
    return listed([covariate_words(name) for name in names])


def logs_words(logs: Sequence[MotionLog]) -> str:
    """The files of logs, or how many there are."""
    return PurePath(logs[0].file).name if len(logs) == 1 else f"{len(logs)} logs"


def sample_words(diagnosis: MotionDiagnosis) -> str:
    """How many samples of how many joints, and how long."""
    count = sum(log.size for log in diagnosis.logs)
    seconds = sum(float(log.time[-1] - log.time[0]) for log in diagnosis.logs if log.size > 1)
    return f"{count} samples, {figure(seconds, 3)} s"
