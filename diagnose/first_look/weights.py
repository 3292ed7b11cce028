"""Whether a log's torques go with the arm's weights: as read, and as meant otherwise."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.motion.log import MotionLog
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.units.reading import refusal

from .library import Library
from .search import Judged, likeliest
from .torques import TorqueEvidence

_TOLD = 2
"""Transformations that explain a log alike, of which so many are told."""


def look_at_weights(log: MotionLog, arm: Arm, headers: Mapping[str, str], rules: Rules) -> MotionLog:
    """Refuse torques that go against the arm's weights as read, and with them as meant otherwise."""
    base = "current" if log.from_current else "tau"
    library = Library(arm, headers, base=base)
    evidence = TorqueEvidence.of(log, library, rules)
    if evidence is None:
        return log
    _refuse_motor_torques(evidence, log, arm, headers, rules)
    given = evidence.given()
    log = _of_little_torque(evidence, log, headers, rules)
    if given.total < rules.log.conventions_gain:
        return log
    # Speeds that are the coordinates' own decide on their unit; what no constant fits, no side of gravity explains.
    singles = library.of_torques(units=log.velocity is None, gravity=not log.torque_constants_free)
    tried = likeliest(evidence, given, singles, [each for each in singles if each.common])
    best = [each for each in tried if each.total < given.total and each.explains]
    if not best:
        return log.saying(_unexplained(log, evidence, given, headers, rules))
    alike = [each for each in best if each.total - best[0].total < 2.0 * math.log(rules.mistakes.as_well)]
    told = sorted((each.transformation for each in alike), key=lambda each: each.gravity is not None)[:_TOLD]
    said = "; as well it could be that ".join(each.sentence() for each in told)
    remedies = [{"columns": columns} for each in told if (columns := each.columns(arm, headers))]
    raise refusal(log.file, "", f"goes against the arm's weights: {said}", *remedies)


def _unexplained(
    log: MotionLog, evidence: TorqueEvidence, given: Judged, headers: Mapping[str, str], rules: Rules
) -> str:
    """What is to be said of currents of unknown constants that are no torques; empty where they are."""
    if not log.torque_constants_free or given.explains:
        return ""
    shares = evidence.shares()
    bearing = np.std(evidence.rigid, axis=0) > rules.log.heavy * float(np.std(evidence.rigid, axis=0).max())
    strange = [k for k in evidence.joints.tolist() if bearing[k] and shares[k] > rules.log.explains]
    if not strange:
        return ""
    told = [f"{k + 1}" for k in evidence.joints.tolist() if bearing[k] and k not in strange]
    names = ", ".join(headers.get(f"current{k + 1}", f"current{k + 1}") for k in strange)
    sentence = (
        f"{names}: no torque constant makes this the torque of the arm's weights and friction; is it a voltage or "
    )
    sentence += "a PWM? If it is a current, write its `torque_constants`."
    return sentence + (f" Without them these joints can be told: {', '.join(told)}." if told else "")


def _refuse_motor_torques(
    evidence: TorqueEvidence, log: MotionLog, arm: Arm, headers: Mapping[str, str], rules: Rules
) -> None:
    """Refuse torques that follow the arm's weights, all by a factor that is a gear's, or a unit's."""
    if evidence.free:
        return
    rigid = evidence.rigid
    factors: dict[int, float] = {}
    spread = np.std(rigid, axis=0)
    for k in evidence.joints.tolist():
        if spread[k] < rules.log.heavy * float(spread[evidence.joints].max()):
            continue
        y, m = (item - item.mean() for item in (evidence.torque[:, k], rigid[:, k]))
        correlation = float(y @ m) / max(math.sqrt(float(y @ y) * float(m @ m)), 1e-300)
        if abs(correlation) > rules.fitting.same_way:
            factors[k] = float(m @ m) / float(y @ m)
    sizes = [abs(factor) for factor in factors.values()]
    if not sizes or (min(sizes) < rules.log.least_gear and max(sizes) * rules.log.least_gear > 1.0):
        return
    if min(sizes) >= rules.log.least_gear:
        # Nobody has gears at some joints alone: what bears too little to tell is taken for alike.
        usual = float(np.median(sizes))
        ratios = [float(f"{abs(factors.get(k, usual)):.3g}") for k in range(arm.size)]
        by = ", ".join(f"{abs(factor):.3g} at joint {k + 1}" for k, factor in factors.items())
        message = f"torques are less than the arm's weights make by factors of {by}: they seem to be of the motors"
        better = "better than these are the gears' own figures, of all joints"
        raise refusal(log.file, "", f"{message}; {better}", {"gear_ratios": ratios})
    message = f"are more than the arm's weights make by a factor of {1.0 / max(sizes):.3g}"
    refuse_millimetres(log, arm, headers, f"{message}; are they in another unit (N*mm)")


def _of_little_torque(evidence: TorqueEvidence, log: MotionLog, headers: Mapping[str, str], rules: Rules) -> MotionLog:
    """The log, with a sentence on torques that are next to nothing beside what the arm's weights make."""
    logged, made = (np.sqrt(np.mean(np.square(each), axis=0)) for each in (evidence.torque, evidence.rigid))
    little = [k for k in evidence.joints.tolist() if logged[k] * rules.log.least_gear < made[k]]
    if evidence.free or not little:
        return log
    base = "current" if log.from_current else "tau"
    each = ", ".join(f"{headers.get(f'{base}{k + 1}', '')} {logged[k]:.2g} for {made[k]:.2g}" for k in little)
    sentence = (
        f"Torques are next to nothing beside those of the arm file's weights (RMS: {each}): not logged, or currents?"
    )
    return log.saying(sentence)


def refuse_millimetres(log: MotionLog, arm: Arm, headers: Mapping[str, str], message: str) -> None:
    """Refuse torques that seem to be in N mm."""
    base = "current" if log.from_current else "tau"
    names = [name for k in range(arm.size) if (name := headers.get(f"{base}{k + 1}", ""))]
    raise refusal(log.file, ", ".join(names), f"{message}?", {"columns": {name: f"{name}/1000" for name in names}})
