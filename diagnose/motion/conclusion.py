"""The result of a diagnosis of motion logs, drawn from what it rests on: figures, findings and sentences."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects.effect import Effect
from linkwright.core.diagnose.judge.contradictions import contradictions
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array

from .causes.swinging import eigenfrequency_notes
from .differing import Differing, differing_findings, squares_of
from .encoders.between import Between
from .encoders.findings import encoder_findings, encoder_notes
from .findings import finding_of, findings
from .judged import Judged, rms_together
from .model.entries import with_entries
from .model.identify import Identified
from .model.intervals import Estimates
from .model.ripple import Ripple
from .model.rows import LogRows
from .preparation import PreparedLog
from .result import Event, MotionDiagnosis, MotionFinding, OfJoint, OfLog
from .sentences import answer, event_words, verdict_of
from .unknown import Residuals, Structure, residuals, unexplained
from .uses.traces import traces_of
from .weighed import as_the_constants, load_words

_HELD_OUT = "Held out are the sizes: they were fitted to the rest of the motion. Names were chosen by all of it."
"""What figures on motion that was not fitted rest on."""
_ALONE = (
    "The arm file holds what all logs share, and figures are of that file. What one log alone has counts beside it "
    "in the choice of the file, and in what is left with it."
)
"""What figures of logs that differ rest on."""


@dataclass(frozen=True)
class RestsOn:
    """What a diagnosis rests on: the logs' rows by the arm as given (`given`), what was identified with its sizes, what
    differs between the logs, the rivals as judged, what each joint's residual depends on (`structures`), ripples that
    are too fast for the fit, and what two encoders show (`between`)."""

    given: Sequence[LogRows]
    identified: Identified
    sizes: Estimates
    different: Differing
    judge: Judged
    structures: Sequence[Structure]
    ripples: Sequence[tuple[Effect, Ripple]]
    between: Sequence[Between]

    @property
    def prepared(self) -> list[PreparedLog]:
        """The logs."""
        return [row.prepared for row in self.given]


def conclusion(
    arm: Arm, rests_on: RestsOn, events: tuple[Event, ...], notes: Sequence[str], *, rules: Rules
) -> MotionDiagnosis:
    """The result, beside `events` that were set aside and further `notes`."""
    identified, judge, different = rests_on.identified, rests_on.judge, rests_on.different
    written, logs = judge.written, tuple(each.log for each in rests_on.prepared)
    squares = squares_of(rests_on.given, identified.pool.width)
    left = residuals(identified, judge, squares)
    per_joint = tuple(_of_joint(joint, left, identified, seen, rules) for joint, seen in enumerate(rests_on.structures))
    of_torques = _torque_findings(arm, rests_on, left.held_out, rules)
    named = (*encoder_findings(arm, rests_on.between, left.held_out.tolist()), *of_torques)
    small = {(item.effect, item.at) for item in named if item.small}
    together = tuple(judge.added_by(small, identified.pool).tolist())
    unknown = unexplained(identified, left, rests_on.structures, per_joint, of_torques, rules=rules)
    verdict = verdict_of(named, unknown, events)
    with_own = rms_together(judge.named.beside[1], judge.counts) if different.differences else None
    sentences = (
        *map(event_words, events),
        answer(verdict, named, unknown, per_joint, judge.rivals, different.beyond, with_own, together),
        *load_words(named, logs),
    )
    return MotionDiagnosis(
        arm=arm,
        logs=logs,
        verdict=verdict,
        sentence=" ".join(sentences),
        per_joint=per_joint,
        findings=named,
        unknown=unknown,
        rms_before=_together(left.before),
        rms_after=_together(left.after),
        rms_held_out=_together(left.held_out),
        noise_floor=_together(left.floor),
        gate_p=min(identified.gate_p, *(item.p_value for item in named if item.recording or item.apart), 1.0),
        split=identified.split,
        cutoff=rests_on.prepared[0].low_pass,
        rates=tuple(1.0 / log.interval for log in logs),
        traces=tuple(
            traces_of(*rows, written.sizes, written.arm) for rows in zip(rests_on.given, written.rows, strict=True)
        ),
        of_logs=tuple(_of_log(identified, judge, squares, number) for number in range(len(logs))),
        corrected=with_entries(written.arm, [entry for item in rests_on.between for entry in item.entries]),
        notes=(*_notes(arm, rests_on, left, named, rules), *notes),
        rivals=judge.rivals,
        beyond=different.beyond,
        small_together=together,
        rms_with_own=None if with_own is None else (rms_together(written.beside[0], judge.counts), with_own),
        events=events,
    )


def too_little(arm: Arm, prepared: Sequence[PreparedLog]) -> MotionDiagnosis:
    """The result of logs in which no joint moves long enough."""
    nan = float("nan")
    return MotionDiagnosis(
        arm=arm,
        logs=tuple(each.log for each in prepared),
        verdict="insufficient_data",
        sentence=answer("insufficient_data", (), None, ()),
        per_joint=tuple(OfJoint(joint + 1, nan, nan, nan, nan, nan) for joint in range(arm.size)),
        findings=(),
        unknown=None,
        rms_before=nan,
        rms_after=nan,
        rms_held_out=nan,
        noise_floor=nan,
        gate_p=1.0,
        split="",
        cutoff=prepared[0].low_pass,
        rates=tuple(1.0 / each.log.interval for each in prepared),
        traces=(),
        of_logs=(),
        corrected=arm,
        notes=_sparse(prepared),
    )


def _torque_findings(arm: Arm, rests_on: RestsOn, held_out: Array, rules: Rules) -> tuple[MotionFinding, ...]:
    """What differs between the logs, what was identified in all of them, and ripples; small ones last."""
    every = (
        *differing_findings(rests_on.different, rests_on.identified.pool, rules=rules),
        *findings(rests_on.identified, rests_on.sizes, rests_on.judge, arm, rules=rules),
        *(finding_of(effect, item, held_out) for effect, item in rests_on.ripples),
    )
    logs = [each.log for each in rests_on.prepared]
    return tuple(sorted((as_the_constants(item, logs, rules) for item in every), key=lambda item: item.small))


def _of_joint(joint: int, left: Residuals, identified: Identified, seen: Structure, rules: Rules) -> OfJoint:
    return OfJoint(
        joint + 1,
        float(left.before[joint]),
        float(left.after[joint]),
        float(left.held_out[joint]),
        float(left.floor[joint]),
        float(left.held_out[joint] / identified.torque[joint]),
        seen.names if seen.p_value <= rules.residual.level else (),
        seen.p_value,
    )


def _of_log(identified: Identified, judge: Judged, given: Array, number: int) -> OfLog:
    """The figures of a log (its number), of which the arm as given leaves the squares `given` (B, n)."""
    log, entries = identified.rows[number].prepared.log, identified.rows[number].prepared.entries
    here = identified.products.log == number
    rows = max(int(judge.counts[here].sum()), 1)

    def size(left: Array) -> float:
        return float(np.sqrt(left[here].sum() / rows))

    return OfLog(
        Path(log.file).name,
        log.file,
        log.unit,
        log.date,
        log.size,
        size(given),
        size(judge.written.left),
        size(judge.written.held_out),
        tuple(item.row for item in log.rejected),
        entries,
        size(judge.written.beside[0]) if entries else None,
    )


def _notes(
    arm: Arm, rests_on: RestsOn, left: Residuals, named: Sequence[MotionFinding], rules: Rules
) -> tuple[str, ...]:
    """What figures rest on, and what they contradict."""
    return (
        *_contradictions(arm, rests_on.identified.split, left, rules),
        _HELD_OUT,
        *([_ALONE] if rests_on.different.differences else []),
        *_sparse(rests_on.prepared),
        *encoder_notes(arm, rests_on.prepared, rests_on.between),
        *eigenfrequency_notes(rests_on.judge.written.arm, named, [item.motion for item in rests_on.prepared]),
    )


def _contradictions(arm: Arm, split: str, left: Residuals, rules: Rules) -> tuple[str, ...]:
    """What held-out motion contradicts, at the joint that it is worst at where all together do not."""
    after, held = left.after, left.held_out
    worst = int(np.nanargmax(held / after))
    unit = "N*m" if arm.joints[worst].revolute else "N"
    whole = contradictions(_together(after), {split: _together(held)}, "{:.3g} N*m".format, rules=rules)
    of_joint = contradictions(
        float(after[worst]),
        {split: float(held[worst])},
        f"{{:.3g}} {unit}".format,
        rules=rules,
        noise=left.sensors[worst],
    )
    return whole or tuple(f"Joint {worst + 1}: {line[0].lower()}{line[1:]}" for line in of_joint)


def _sparse(prepared: Sequence[PreparedLog]) -> tuple[str, ...]:
    """What samples that are far apart do not tell, log by log."""
    return tuple(
        f"{Path(item.log.file).name}: samples {1.0 / item.rate:.3g} s apart show {100.0 * item.motion.sampled:.0f} % "
        "of how fast things change. Inertia, delays and resonances count by this share, and speeds as logged."
        for item in prepared
        if item.motion.sampled < 1.0
    )


def _together(each: Array) -> float:
    return float(np.sqrt(np.nanmean(np.square(each))))
