"""The answer to motion logs on one screen: a sentence of at most thirty words, and what to do."""

from __future__ import annotations

from linkwright.core.diagnose.motion.result import MotionDiagnosis, MotionFinding
from linkwright.core.diagnose.motion.sentences import event_words
from linkwright.core.diagnose.result import HALF
from linkwright.results.diagnoses.answer import briefly, capital
from linkwright.results.diagnoses.words import listed, portion, value
from linkwright.results.figures_in_words import figure, from_to

from .words import alternative_words, dependence_words, finding_words, of_all_joints, torque, torque_unit

MOST_EVENTS = 2
"""Events that an answer tells of."""
_NOISE = 1.15
"""Times the floor up to which what is left on motion that was not fitted counts as the floor."""


def answer(diagnosis: MotionDiagnosis) -> str:
    """The answer: the largest cause and where it sits, how many others, their share of the mismatch, what remains."""
    return briefly(_clauses(diagnosis))


def _clauses(diagnosis: MotionDiagnosis) -> list[str]:
    """What must be said first, and what may follow as far as there is room."""
    mismatch = torque(diagnosis.rms_before).text
    if diagnosis.verdict == "insufficient_data":
        return [diagnosis.sentence.removesuffix(".")]
    if diagnosis.events and not diagnosis.findings and diagnosis.unknown is None:
        happened = [event_words(event).split(": ")[0] for event in diagnosis.events[:MOST_EVENTS]]
        more = len(diagnosis.events) - len(happened)
        beside = f" and {more} more events" if more > 0 else ""
        return [f"{listed(happened)}{beside}", "; nothing is missing from the rest", f", {mismatch} remain"]
    if diagnosis.verdict == "none":
        return [f"nothing is missing that this log could show; {mismatch} remain"]
    largest, part = largest_of(diagnosis), explained_share(diagnosis)
    open_at, on = _unexplained(diagnosis)
    if open_at and (part is None or part < HALF):
        explained = "" if largest is None else f". {capital(finding_words(largest))} explains part of the rest"
        return [f"not explained: {open_at}", on, explained]
    if largest is None:
        return [diagnosis.sentence.removesuffix(".")]
    opening, share = _named(diagnosis, largest, open_at=bool(open_at)), "" if part is None else portion(part).text
    if open_at:
        does = f" ({share} of the {mismatch} mismatch)" if share else ""
        return [f"{opening}{does}. Not explained: {open_at}", on]
    does = f" ({share} of the mismatch)" if share else ""
    change = from_to(mismatch, torque(left_with_own(diagnosis)[1]).text)
    return [f"{opening}{does}", f". Error {change}", f", {over(diagnosis)}"]


def _unexplained(diagnosis: MotionDiagnosis) -> tuple[str, str]:
    """The torque that nothing explains and where, and what it depends on; empty where there is none."""
    unknown = diagnosis.unknown
    if unknown is None:
        return "", ""
    joint = unknown.worst
    more = f" and {len(unknown.joints) - 1} more" if len(unknown.joints) > 1 else ""
    open_at = f"{torque(unknown.amplitude, torque_unit(diagnosis.arm, joint)).text} at joint {joint}{more}"
    if unknown.change is not None:
        return open_at, f". Something changed at {figure(unknown.change.start.time, 4)} s"
    depends = dependence_words(unknown.depends_on[:3])
    return open_at, f". It depends on {depends}" if depends else ""


def _named(diagnosis: MotionDiagnosis, largest: MotionFinding, *, open_at: bool) -> str:
    """The largest cause, its size where it is the one name, and how many others; `open_at`: something else is left."""
    either = f" or {alternative_words(largest.alternatives[0])}" if largest.alternatives and not open_at else ""
    alone = not largest.alternatives and not open_at and len(largest.parameters) == 1
    size = f", {value(largest.parameters[0]).text}" if alone else ""
    rest = len(diagnosis.findings) - 1
    more = f" and {rest} smaller {'cause' if rest == 1 else 'causes'}" if rest else ""
    return f"found: {finding_words(largest)}{either}{size}{more}"


def over(diagnosis: MotionDiagnosis) -> str:
    """What is left on motion that was not fitted, beside the floor."""
    times = left_with_own(diagnosis)[1] / diagnosis.noise_floor if diagnosis.noise_floor > 0.0 else 1.0
    return "the noise floor" if times <= _NOISE else f"{figure(times, 2)} times the noise floor"


def largest_of(diagnosis: MotionDiagnosis) -> MotionFinding | None:
    """The finding that adds most to the torques of all joints together."""
    return max(diagnosis.findings, key=lambda finding: of_all_joints(finding.rms_explained), default=None)


def explained_share(diagnosis: MotionDiagnosis) -> float | None:
    """The share of the mismatch's sum of squares that the findings explain; None where there was nothing."""
    if not diagnosis.findings or diagnosis.rms_before <= 0.0:
        return None
    return max(0.0, 1.0 - (left_with_own(diagnosis)[0] / diagnosis.rms_before) ** 2)


def left_with_own(diagnosis: MotionDiagnosis) -> tuple[float, float]:
    """What is left of the motion fitted and of other motion, beside what one log alone has."""
    return diagnosis.rms_with_own or (diagnosis.rms_after, diagnosis.rms_held_out)


def to_do(diagnosis: MotionDiagnosis) -> tuple[str, ...]:
    """What to do next, the most useful first."""
    lines: list[str] = []
    if any(log.torque_constants_free for log in diagnosis.logs):
        lines.append(
            "Write the torque constants into recording.yaml (`torque_constants: [14.9, ...]`, "
            f"N m/{next(log.drive.unit for log in diagnosis.logs if log.torque_constants_free)}), diagnose again."
        )
    if diagnosis.unknown is not None and diagnosis.unknown.decide:
        lines.append(f"To find the cause, {diagnosis.unknown.decide}.")
    if any(finding.alternatives for finding in diagnosis.findings):
        lines.append("linkwright plan --instrument motion --after LOG says how far another motion tells names apart.")
    helps = diagnosis.written is None or diagnosis.written.rms < diagnosis.rms_before
    if any(not finding.recording for finding in diagnosis.findings) and helps:
        whose = "this log" if len(diagnosis.logs) == 1 else "these logs"
        leaves = "" if diagnosis.written is None else f" (it leaves {torque(diagnosis.written.rms).text} of {whose})"
        lines.append(
            f"Use arm.yaml, the arm with the findings{leaves}. linkwright predict says what this arm leaves of other "
            "logs. linkwright export --to mjcf, or --into your own file, takes the arm to a simulator."
        )
    return tuple(lines)
