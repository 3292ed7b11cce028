"""Whether a log's torques go with the arm's weights: as read, and as meant otherwise."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.motion.log import MotionLog
from linkwright.core.diagnose.reading.foreign.headers import Headers
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.units.reading import refusal

from .library import Library
from .search import Judged, likeliest
from .torques import TorqueEvidence
from .transformation import Transformation

_TOLD = 2
"""Transformations that explain a log alike, of which so many are reported."""


@dataclass(frozen=True)
class _Look:
    """A log, what its torques say, as it stands (`given`) and as meant otherwise: what explains them, the likeliest
    first, if that is likelier than `given`."""

    log: MotionLog
    headers: Headers
    evidence: TorqueEvidence
    given: Judged
    meant: tuple[Judged, ...] = ()

    @property
    def gain(self) -> float:
        """How much likelier the likeliest is."""
        return self.given.total - self.meant[0].total if self.meant else 0.0

    def reported(self, within: float) -> list[Transformation]:
        """What is reported: the likeliest, and beside it what else other columns may be; gravity last."""
        kinds: dict[frozenset[str], Transformation] = {}
        for each in self.meant:
            acts = each.transformation.acts_on
            if each.total < self.meant[0].total + within and not any(acts >= of for of in kinds):
                kinds[acts] = each.transformation
        return sorted(list(kinds.values())[:_TOLD], key=lambda each: each.gravity is not None)

    def accepts(self, other: Judged, least: float) -> bool:
        """Whether its torques do not contradict another log's transformation by `least`."""
        here = self.evidence.judged([other.parts])[0]
        return here.explains and here.total - self.given.total < least


def look_at_weights(logs: Sequence[tuple[MotionLog, Headers]], arm: Arm, rules: Rules) -> tuple[MotionLog, ...]:
    """Logs of one arm, each with the headers of its columns, with sentences on torques that are doubted.

    What is doubted of one log is doubted of all, where none contradicts it. Raises `InputError` where torques go
    against the arm's weights as read, and with them as meant otherwise.
    """
    seen: dict[int, _Look] = {}
    libraries: dict[tuple[tuple[str, str], ...], Library] = {}
    for number, (log, headers) in enumerate(logs):
        fresh = Library(arm, headers, base=log.drive.base)
        library = libraries.setdefault((*sorted(headers.items()), ("base", fresh.base)), fresh)
        if (evidence := TorqueEvidence.of(log, library, rules)) is not None:
            _refuse_motor_torques(evidence, log, arm, headers, rules)
            given = evidence.given()
            seen[number] = _Look(_of_little_torque(evidence, log, headers, rules), headers, evidence, given)
    for number, look in seen.items():
        seen[number] = _as_meant(look, rules)
        if seen[number].gain >= rules.log.conventions_gain:
            _refuse(seen[number], [other for other in seen.values() if other is not seen[number]], arm, rules)
    _doubt(seen, arm, rules)
    return tuple(seen[number].log if number in seen else log for number, (log, _) in enumerate(logs))


def _as_meant(look: _Look, rules: Rules) -> _Look:
    """A log with what it may be meant as; as it stands where that is likelier, with what is to be said of it."""
    given, no_weights = look.given, _without_weights(look, rules)
    if given.total >= rules.log.conventions_gain and not (no_weights and given.explains):
        # Speeds decide on the unit of angles, and so do torques that they explain; what no constant fits, no side of
        # gravity explains.
        units, free = look.log.velocity is None and not given.explains, look.log.torque_constants_free
        singles = look.evidence.library.of_torques(units=units, gravity=not free)
        tried = likeliest(look.evidence, given, singles, [each for each in singles if each.common])
        meant = tuple(each for each in tried if each.explains and each.transformation.said)
        if meant and meant[0].total < given.total:
            return replace(look, meant=meant)
    return replace(look, log=look.log.saying(no_weights))


def _refuse(look: _Look, others: Sequence[_Look], arm: Arm, rules: Rules) -> None:
    best, told = look.meant, look.reported(2.0 * math.log(rules.mistakes.as_well))
    remedies = [{"columns": columns} for each in told if (columns := each.columns(arm, look.headers))]
    also = [Path(other.log.file).name for other in others if other.accepts(best[0], rules.log.conventions_gain)]
    more = f" ({', '.join(also)} can be read so too)" if also else ""
    raise look.headers.refusal(look.log.file, "", f"goes against the arm's weights: {_any_of(told)}{more}", *remedies)


def _doubt(seen: dict[int, _Look], arm: Arm, rules: Rules) -> None:
    """Say what is likelier than each log as it stands, or what is so in the log that is surest of it where all logs may
    be meant so."""
    sure = max(seen.values(), key=lambda look: look.gain, default=None)
    if sure is None or not sure.meant:
        return
    shared = all(look.accepts(sure.meant[0], rules.log.conventions_gain) for look in seen.values())
    for number, look in seen.items():
        source = sure if shared else look
        if not source.meant:
            continue
        told = source.reported(rules.log.conventions_gain)
        ways = [{"columns": columns} for each in told if (columns := each.columns(arm, look.headers))]
        by = "" if source is look else f", as in {Path(source.log.file).name}"
        sentence = f"The arm's weights leave doubt{by}: {_any_of(told)}. The log is taken as it stands." + (
            f" If it is so, {look.headers.write(*ways)}." if ways else ""
        )
        seen[number] = replace(look, log=look.log.saying(sentence))


def _any_of(told: Sequence[Transformation]) -> str:
    return "; as well it could be that ".join(each.sentence() for each in told)


def _without_weights(look: _Look, rules: Rules) -> str:
    """What is to be said of currents of unknown constants in which the arm's weights hardly show; else empty."""
    if not look.log.torque_constants_free:
        return ""
    spread, share = np.std(look.evidence.rigid, axis=0), look.evidence.of_bodies()
    bearing = [k for k in look.evidence.joints.tolist() if spread[k] > rules.log.heavy * float(spread.max())]
    strange = [k for k in bearing if share[k] < rules.log.of_bodies]
    if not strange:
        return ""
    explained = [f"{k + 1}" for k in bearing if k not in strange]
    drive = look.log.drive
    names = ", ".join(look.headers.get(name := f"{drive.base}{k + 1}", name) for k in strange)
    sentence = f"{names}: the arm's weights make next to nothing of this"
    sentence += "." if drive.of_voltage else "; is it a voltage or a PWM?"
    sentence += f" If it is one of its {drive.words}, write its `torque_constants`."
    return sentence + (f" Without them these joints can be told: {', '.join(explained)}." if explained else "")


def _refuse_motor_torques(evidence: TorqueEvidence, log: MotionLog, arm: Arm, headers: Headers, rules: Rules) -> None:
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


def _of_little_torque(evidence: TorqueEvidence, log: MotionLog, headers: Headers, rules: Rules) -> MotionLog:
    """The log, with a sentence on torques that are next to nothing beside what the arm's weights make."""
    logged, made = (np.sqrt(np.mean(np.square(each), axis=0)) for each in (evidence.torque, evidence.rigid))
    little = [k for k in evidence.joints.tolist() if logged[k] * rules.log.least_gear < made[k]]
    if evidence.free or not little:
        return log
    base = log.drive.base
    each = ", ".join(f"{headers.get(f'{base}{k + 1}', '')} {logged[k]:.2g} for {made[k]:.2g}" for k in little)
    sentence = (
        f"Torques are next to nothing beside those of the arm file's weights (RMS: {each}): not logged, currents, or "
        "does a counterweight carry them?"
    )
    return log.saying(sentence)


def refuse_millimetres(log: MotionLog, arm: Arm, headers: Headers, message: str) -> None:
    """Refuse torques that seem to be in N mm."""
    base = log.drive.base
    names = [name for k in range(arm.size) if (name := headers.get(f"{base}{k + 1}", ""))]
    remedy = {"columns": {name: f"{name}/1000" for name in names}}
    raise headers.refusal(log.file, ", ".join(names), f"{message}?", remedy)
