"""What a diagnosis says in plain words."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects import EFFECTS, parameter_title
from linkwright.core.arm.errors.unknown_mass import weighs_nothing
from linkwright.core.arm.files.origin import key_of_offset
from linkwright.core.diagnose.fitting.prepare import Prepared
from linkwright.core.diagnose.judge.needed import small_words
from linkwright.core.diagnose.patterns.library import Candidate, of_single_numbers
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.result import (
    Alternative,
    Difference,
    Exchange,
    Finding,
    FittedOrigin,
    FittedParameter,
    LackOfFit,
    Left,
    Mislabelled,
    OfRecording,
    SmallBeside,
    Unknown,
    Verdict,
)
from linkwright.core.diagnose.rules.mistake_rules import MistakeRules
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.units.lists import listed
from linkwright.core.units.quantities import format_quantity

_MANY_PARAMETERS = 8
MANY_FINDINGS = 4
"""Findings up to which the plain answer names each with its size; more are summed up by their cause."""


WEIGHTLESS = "all links weigh 0 kg here"


def said_of_no_weight(arm: Arm, verdict: Verdict) -> str:
    """That nothing of an arm has a weight, where something was found: whatever sags under it goes by other names."""
    if verdict in ("none", "insufficient_data") or not weighs_nothing(arm):
        return ""
    would_do = "Write their masses, or `mass: unknown` at each, and diagnose again"
    return (
        f"{WEIGHTLESS[:1].upper()}{WEIGHTLESS[1:]}: what sags under their weight goes by other names here. {would_do}. "
    )


def place_of(effect: str, at: Sequence[int]) -> str:
    """Where an effect acts, in words: " at joint 2", " at links 1, 2 and 3" or nothing."""
    if not at:
        return ""
    kind = "link" if effect in EFFECTS and EFFECTS[effect].place == "link" else "joint"
    return f" at {kind}{'s' if len(at) > 1 else ''} {listed([str(number) for number in at])}"


def name_of(effect: str, at: Sequence[int], recording: str = "") -> str:
    """An effect and where it acts, in words; of several recordings, in which alone."""
    title = EFFECTS[effect].title if effect in EFFECTS else effect.replace("_", " ")
    return f"{title}{place_of(effect, at)}{f' in {recording} alone' if recording else ''}"


def of_branches(arm: Arm, findings: Sequence[Finding]) -> str:
    """Which of a branch's joints or links the numbers of findings are, as sentences; nothing for a serial arm."""
    numbers = sorted({number for finding in findings for number in finding.at})
    sentences = [
        f" Number {number} is {branch.name}'s {number - branch.first}."
        for number in numbers
        for branch in arm.branches
        if branch.first < number <= branch.end
    ]
    return "".join(sentences)


def label_of(candidate: Candidate, recording: Recording) -> str:
    """A candidate and where it acts, in words."""
    return name_of(candidate.effect, candidate.numbers, recording_of(candidate, recording))


def recording_of(candidate: Candidate, recording: Recording) -> str:
    """The name of the one recording in which a candidate acts; empty where it acts in all."""
    return "" if candidate.only is None else recording.names[candidate.only]


def size_of(effect: str, parameter: FittedParameter) -> str:
    """A parameter of an effect with its interval, in words."""
    digits, title = max(3, parameter.digits), parameter_title(effect, parameter.parameter)
    value = format_quantity(parameter.value, parameter.kind, digits=digits)
    low, high = parameter.interval
    if parameter.value == low == high:
        return f"{title} {value}"
    if not (np.isfinite(low) and np.isfinite(high)):
        return f"{title} {value}, which the data do not bound"
    unit = value.partition(" ")[2] or None
    ends = [format_quantity(end, parameter.kind, unit, digits=digits).partition(" ")[0] for end in (low, high)]
    also = f"; part of it may be {EFFECTS[parameter.may_hold].title}" if parameter.may_hold else ""
    return f"{title} {value} (95 % interval {ends[0]} to {ends[1]}{also})"


def about_of(parameter: FittedParameter) -> str:
    """A parameter that is large beside what is not known of it, in words, with half its interval."""
    reach = 0.5 * (parameter.interval[1] - parameter.interval[0])
    unit = "deg" if parameter.kind == "angle" else "mm"
    if not np.isfinite(reach):
        value = format_quantity(parameter.value, parameter.kind, unit, digits=4)
        return f"{parameter.parameter} {value}, which the data do not bound"
    size = format_quantity(reach, parameter.kind, unit, digits=2).partition(" ")[0]
    shown = float(format_quantity(parameter.value, parameter.kind, unit).partition(" ")[0])
    digits = max(0, 1 - int(np.floor(np.log10(max(float(size), 1e-9)))))
    return f"{parameter.parameter} {shown:.{digits}f} {unit} within {size} {unit}"


def chief(parameters: Sequence[FittedParameter]) -> FittedParameter:
    """The parameter that is clearest: the largest for the width of its interval."""

    def clear(parameter: FittedParameter) -> float:
        low, high = parameter.interval
        if parameter.value == low == high:
            return 0.0
        return abs(parameter.value) / (high - low) if high > low else 0.0

    return max(parameters, key=clear)


def reading_of(
    effect: str,
    at: Sequence[int],
    parameters: Sequence[FittedParameter],
    others: Sequence[Alternative],
    recording: str = "",
    together: Sequence[tuple[str, tuple[int, ...]]] = (),
    *,
    nothing: bool = False,
) -> str:
    """A finding in one sentence; `together` are others without which it means nothing, `nothing` says that all its
    sizes may be zero."""
    if len(parameters) > _MANY_PARAMETERS:
        sizes = f"{len(parameters)} coefficients, the clearest of them {size_of(effect, chief(parameters))}"
    else:
        sizes = "; ".join(size_of(effect, parameter) for parameter in parameters)
    name = name_of(effect, at, recording)
    text = f"{name}: {sizes}." if sizes else f"{name}."
    if others:
        names = [name_of(other.effect, other.at, other.recording) for other in others[:4]]
        more = f" and {len(others) - 4} more" if len(others) > 4 else ""
        text += f" The data cannot tell it from {'; '.join(names)}{more}."
        if min(other.worse for other in others) <= RULES.search.tied:
            text += " That it goes first rests on what is simpler and more usual, not on this recording."
    if together:
        text += f" Singly it means nothing: only together with {names_of(together)}."
    elif nothing:
        text += " With room for what is not named, its sizes may be zero."
    return text[0].upper() + text[1:]


def names_of(places: Sequence[tuple[str, tuple[int, ...]]]) -> str:
    """Effects and where they act, in words."""
    return listed([name_of(effect, at) for effect, at in places])


def nothing_singly(places: Sequence[tuple[str, tuple[int, ...]]], moved: float) -> str:
    """What is said of findings that mean nothing singly and move the tip by `moved` (m) as one."""
    if len(places) == 1:
        return f"Singly the {names_of(places)} means nothing: others that are named would take its place."
    return (
        f"These {len(places)} together move the tip by {mm(moved)} RMS. Singly they mean nothing, as others that are "
        f"named would take their place: {names_of(places)}."
    )


def verdict_sentence(
    findings: Sequence[Finding],
    unknown: Unknown | None,
    rms_before: float,
    left: Left,
    p_value: float,
    causes: Sequence[tuple[str, float]] = (),
    together: float = 0.0,
    *,
    scatter: float | None = None,
    small: SmallBeside | None = None,
) -> str:
    """The plain answer. `rms_before` (m) is that of the mismatch, `left` what remains, `scatter` how many times the
    noise floor scatter is that nothing explains (None: it is not more), `small` what causes too small to be named make
    of what remains, `causes` the kinds of physics found and the RMS length (m) of what each moves beyond the nuisances,
    the largest first, `together` (m) what the small findings move."""
    many = len(findings) > MANY_FINDINGS
    named = _summed_up(findings, causes, together) if many else "; ".join(_named(finding) for finding in findings)
    if unknown is not None:
        return _of_unknown(unknown) + (f" What describes part of it: {named}." if named else "")
    if not findings:
        return _of_nothing(rms_before, left, p_value, more=scatter is not None or left.is_more)
    share = 100.0 * max(0.0, 1.0 - (left.rms / rms_before) ** 2) if rms_before > 0.0 else 0.0
    after = remains(left)
    if small is not None:
        after += f": noise, and causes too small to be told one by one, {mm(small.moved)}"
    whose = "It explains" if len(findings) == 1 else "Together they explain"
    text = f"Found: {named}. {whose} {share:.0f} % of the mismatch ({mm(rms_before)} RMS). "
    doubtful = [_undecided(f, alone=len(findings) == 1) for f in findings if f.alternatives and not many]
    return " ".join((f"{text}{after[:1].upper()}{after[1:]}.", *doubtful))


def _of_nothing(rms: float, left: Left, p_value: float, *, more: bool) -> str:
    """The plain answer where nothing was found; `more` than noise is left."""
    if more:
        return (
            f"More than noise: {mm(rms)} RMS, {left.times:.1f} times the noise floor. Nothing explains the "
            f"mismatch beyond chance (p = {p_value:.2g} for the best of all explanations). The noise floor may be "
            "wrong, or sides, payloads or angles were logged wrongly. Or the arm does not return to a pose as "
            "exactly as it stays there."
        )
    level = "scatter" if left.floor is None else "the noise floor" if left.fits else "chance"
    times = "" if left.floor is None or left.fits else f", {left.times:.1f} times the noise floor"
    return (
        f"No mismatch beyond {level}: what remains, {mm(rms)} RMS{times}, is what chance leaves "
        f"(p = {p_value:.2g} for the best of all explanations)."
    )


def _of_unknown(unknown: Unknown) -> str:
    """That something is there which nothing explains."""
    on = ", ".join(unknown.depends_on) or "nothing that was recorded"
    since = "" if unknown.since is None else f", since {format_quantity(unknown.since, 'time', digits=4)}"
    amount = f"{mm(unknown.amplitude)} RMS, depending on {on}{since}"
    return f"Unknown: {unknown.shape}, {amount}. Nothing in the library explains it."


def put_in_first(findings: Sequence[Finding], arm: Arm) -> str:
    """Zeros and lengths that are off so far that they belong into the arm file, as a sentence that goes on; nothing
    where there are none."""
    off: dict[tuple[str, str], list[tuple[int, float]]] = {}
    numbers: list[str] = []
    for finding in findings:
        if not of_single_numbers(EFFECTS[finding.effect]) or len(finding.at) != 1 or finding.recording:
            continue
        for parameter in finding.parameters:
            if parameter.parameter in ("x", "y", "z"):
                numbers.append(_offset_in_file(arm, finding.at[0], parameter))
                continue
            what = "zero of joint" if EFFECTS[finding.effect].place == "joint" else "length of link"
            off.setdefault((what, parameter.kind), []).append((finding.at[0], parameter.value))
    sentences: list[str] = []
    for (what, kind), pairs in off.items():
        unit = "deg" if kind == "angle" else "mm"
        sizes = [format_quantity(value, kind, unit, digits=2).partition(" ")[0] for _, value in sorted(pairs)]
        summary = f"{listed([str(at) for at, _ in sorted(pairs)])} are off by {listed(sizes)} {unit}"
        noun, _, place = what.partition(" of ")
        sentences.append(
            f"{noun}s of {place}s {summary}" if len(pairs) > 1 else f"{what} {summary.replace(' are ', ' is ')}"
        )
    sentences += numbers
    if not sentences:
        return ""
    text = "; ".join(sentences)
    them = "them" if sum(map(len, off.values())) + len(numbers) > 1 else "it"
    return f" {text if numbers and not off else text[0].upper() + text[1:]}: put {them} into the arm file first."


def _offset_in_file(arm: Arm, link: int, parameter: FittedParameter) -> str:
    """By how much a number of a link (from 1) that runs askew is off, under the arm file's name for it."""
    key = key_of_offset(arm, link - 1, parameter.parameter)
    name, factor = (f"{parameter.parameter} of link {link}", 1.0) if key is None else key
    return f"{name} is off by {format_quantity(factor * parameter.value, 'length', 'mm', digits=2)}"


def what_differs(
    differences: Sequence[Difference], recordings: Sequence[OfRecording], *, rules: MistakeRules = RULES.mistakes
) -> str:
    """What is not the same in several recordings, as sentences that go on; nothing where all is."""
    values = [f"{name_of(item.effect, item.at)}, {_values(item, recordings)}" for item in differences]
    sentences = [f" Not the same in all recordings: {'; '.join(values)}."] if values else []
    worst = max(
        recordings, key=lambda recording: recording.rms_from_others / max(recording.rms_own, 1e-12), default=None
    )
    if worst is not None and rules.label_leaves * worst.rms_after > max(worst.rms_own, worst.noise_floor or 0.0):
        sentences.append(
            f" The recordings do not agree. The findings of all leave {mm(worst.rms_after)} in {worst.name}, where "
            f"sizes of its own would leave {mm(worst.rms_own)}. Either the recordings are of different arms, or "
            "something has changed that is not named. Diagnose each by itself."
        )
    return "".join(sentences)


def what_was_free(origins: Sequence[FittedOrigin]) -> str:
    """Fixed transforms that the arm file leaves free, as sentences that go on; nothing where there are none."""
    sentences: list[str] = []
    for item in origins:
        sizes = [about_of(parameter) for parameter in item.parameters]
        sentences.append(f" The fixed transform in front of joint {item.joint}: {'; '.join(sizes)}.")
        if not all(np.isfinite(end) for parameter in item.parameters for end in parameter.interval):
            sentences.append(
                " Numbers that the data do not bound keep their starting values, and loads are computed with these. "
                "Leave less free (`frame: known`), or give one of the numbers."
            )
        names = [name_of(effect, at) for effect, at in item.swallowed]
        if names:
            sentences.append(f" These cannot be told apart from the transform: {'; '.join(names)}.")
    return "".join(sentences)


def _values(difference: Difference, recordings: Sequence[OfRecording]) -> str:
    """A parameter with its value in each recording, in one unit."""
    largest = max(difference.each, key=lambda fitted: abs(fitted.value))
    unit = format_quantity(largest.value, largest.kind, digits=3).partition(" ")[2]
    sizes = [
        format_quantity(item.value, item.kind, unit or None, digits=3).partition(" ")[0] for item in difference.each
    ]
    sizes[-1] = f"{sizes[-1]} {unit}".strip()
    values = [f"{size} in {recording.name}" for size, recording in zip(sizes, recordings, strict=True)]
    return f"{parameter_title(difference.effect, largest.parameter)} {listed(values)}"


def refutation(test: LackOfFit) -> str:
    """Why what was named is not the whole answer, by readings of one pose."""
    what = "visits of one pose" if test.against == "returns" else "repeats of a visit"
    return (
        "Readings of one pose refute the findings as the whole answer. Remaining error: "
        f"{test.times:.1f} times what {what} differ by (F = {test.ratio:.2g}, p = {test.p_value:.2g}). On held-out "
        f"readings: {test.held_out_times:.1f} times what noise alone leaves. The findings describe part of the "
        "mismatch, and may stand for something else."
    )


def of_small_causes(beside: SmallBeside, alone: LackOfFit) -> str:
    """What causes too small to be named make of what is left, where readings of one pose refute the names alone."""
    held = beside.lack_of_fit.held_out_times
    return (
        f"Remaining error: {alone.times:.2f} times what readings of one pose differ by (p = {alone.p_value:.2g}). "
        "Causes of the library that are too small to be named one by one fit the remainder, "
        f"{mm(beside.moved)} RMS together. With room for them only noise remains "
        f"(p = {beside.lack_of_fit.p_value:.2g}). Held-out readings leave {held:.2f} times what such causes and noise "
        "leave. arm.yaml holds the named causes alone. More readings would name the largest of the small causes."
    )


def put_right(labels: Mislabelled) -> str:
    """What is named once labels are put right, and what that leaves."""
    names = " and ".join(name_of(effect, at) for effect, at in labels.named)
    left = f"{names} leave" if names else "nothing is missing, and readings are off by"
    return f"{left} {mm(labels.rms)} RMS, the noise floor"


def _named(finding: Finding) -> str:
    size = f", {size_of(finding.effect, chief(finding.parameters))}" if finding.parameters else ""
    return name_of(finding.effect, finding.at, finding.recording) + size


def _summed_up(findings: Sequence[Finding], causes: Sequence[tuple[str, float]], together: float) -> str:
    """Many findings by their cause: what, where, and how much it moves the tip; the small ones `together` (m)."""
    parts: list[str] = []
    for cause, rms in causes:
        places: dict[str, list[int]] = {}
        for finding in findings:
            if EFFECTS[finding.effect].cause == cause and not finding.small:
                places.setdefault(finding.effect, []).extend(finding.at)
        names = [name_of(effect, sorted(set(at))) for effect, at in places.items()]
        parts.append(f"{cause}, {mm(rms)} RMS ({'; '.join(names)})")
    count = sum(finding.small for finding in findings)
    return "; ".join([*parts, *([small_words(count, mm(together))] if count else [])])


def _undecided(finding: Finding, *, alone: bool) -> str:
    """What else a finding could be; in place of what, where it is not the only one."""
    names = [name_of(other.effect, other.at, other.recording) for other in finding.alternatives[:3]]
    more = f" ({len(finding.alternatives) - 3} more in the report)" if len(finding.alternatives) > 3 else ""
    instead = "" if alone else f", in place of the {name_of(finding.effect, finding.at, finding.recording)}"
    return f"The data fit equally well: {listed(names, 'or')}{more}{instead}."


def of_exchange(exchange: Exchange) -> str:
    """Causes that together could stand in the place of findings, as a sentence."""
    instead, others = (
        " and ".join(f"the {name_of(*item)}" for item in some) for some in (exchange.instead_of, exchange.effects)
    )
    return f"These readings do not tell {instead} from {others}{' together' if len(exchange.effects) > 1 else ''}."


def remains(left: Left) -> str:
    """What is left beside the noise floor, as a clause; it is called that only where readings that were not fitted
    leave no more either."""
    if left.floor is None:
        return f"{mm(left.rms)} RMS remain, and no repeats say how much of that is noise"
    if left.is_noise:
        return f"what remains, {mm(left.rms)}, is the noise floor"
    if left.fits:
        return (
            f"{mm(left.rms)} RMS remain, and {mm(left.held_out)} on readings that were not fitted, "
            f"{left.times_held_out:.1f} times the noise floor"
        )
    return f"{mm(left.rms)} RMS remain, {left.times:.1f} times the noise floor"


def mm(value: float) -> str:
    """A length (m) in mm."""
    return f"{1e3 * value:.3g} mm"


def null_vectors(prepared: Prepared) -> tuple[str, ...]:
    """What the nuisances cannot tell apart among themselves, and what of the library they swallow, as sentences."""
    sentences: list[str] = []
    beside = prepared.observed.whitened(prepared.beside)
    if beside.shape[1]:
        size = np.linalg.norm(beside, axis=0)
        unit = np.where(size > 0.0, size, 1.0)
        _, singular, vt = np.linalg.svd(beside / unit, full_matrices=False)
        for value, row in zip(singular, vt, strict=True):
            if value <= 1e-8 * singular[0]:
                parts = [name for name, weight in zip(prepared.beside_names, row, strict=True) if abs(weight) > 0.1]
                sentences.append(f"These poses do not tell apart: {', '.join(parts)}.")
    places: dict[str, set[int]] = {}
    shown = {group.candidate.family for group in prepared.pool.groups}
    for candidate in prepared.pool.invisible:
        if not candidate.outside and candidate.family not in shown:
            places.setdefault(candidate.effect, set()).update(candidate.numbers)
    recording = prepared.observed.recording
    free = [name for name, setting in (("frame", recording.frame), ("tool", recording.tool)) if setting == "free"]
    fitted = f"{' and '.join(free)} {'were' if len(free) > 1 else 'was'} fitted" if free else "more was fitted beside"
    why = f"Because {fitted}, these cannot be seen" if beside.shape[1] else "These readings cannot show"
    names = [name_of(effect, sorted(at)) for effect, at in sorted(places.items())]
    if names:
        sentences.append(f"{why}: {'; '.join(names)}.")
    return tuple(sentences)
