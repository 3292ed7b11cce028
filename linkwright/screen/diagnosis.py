"""A diagnosis on the screen: the plain sentence, what is missing with its intervals, the ladder, what to record."""

from __future__ import annotations

from rich.console import Console
from rich.table import Table

from diagnose.result import Diagnosis, Unknown
from linkwright.diagnosis_words import (
    alias_sentence,
    covered_words,
    detectable_words,
    effect_words,
    interval_words,
    least_visible,
    main_parameters,
    next_pose_words,
    p_words,
    place_words,
    share_words,
    value_words,
    verdict_words,
    where_sentences,
    whole_sentence,
)
from linkwright.words import effect_title, mm

from .console import table

MOST_REJECTED = 5
MOST_NEXT = 5
_BAR = 24


def show_diagnosis(out: Console, diagnosis: Diagnosis) -> None:
    """Print a diagnosis."""
    out.print(diagnosis.sentence, style="bold", soft_wrap=True)
    out.print()
    out.print(sizes(diagnosis))
    out.print(diagnosis.noise_source, soft_wrap=True)
    if diagnosis.findings:
        out.print()
        out.print(findings(diagnosis))
    for finding in diagnosis.findings:
        if sentence := alias_sentence(finding):
            out.print(sentence, soft_wrap=True)
    for sentence in where_sentences(diagnosis):
        out.print(sentence, soft_wrap=True)
    if diagnosis.unknown is not None:
        out.print()
        show_unknown(out, diagnosis.unknown)
    if diagnosis.verdict in ("none", "insufficient_data") and diagnosis.detectable:
        out.print()
        out.print(detectable(diagnosis))
    if len(diagnosis.ladder) > 1:
        out.print()
        out.print(ladder(diagnosis))
    if diagnosis.figures:
        out.print()
        out.print(standards(diagnosis))
    if diagnosis.next_poses or diagnosis.next_poses_note:
        out.print()
        show_next_poses(out, diagnosis)
    _show_rest(out, diagnosis)


def sizes(diagnosis: Diagnosis) -> Table:
    """The verdict and the sizes of mismatch and noise."""
    shown = table("", "", "")
    shown.show_header = False
    shown.add_row("verdict", verdict_words(diagnosis.verdict), f"any mismatch at all: p {p_words(diagnosis.gate_p)}")
    shown.add_row("noise floor", mm(diagnosis.noise_floor, 3), "")
    shown.add_row("RMS of the mismatch", mm(diagnosis.rms_before, 3), f"{diagnosis.recording.size} readings")
    if diagnosis.findings or diagnosis.unknown is not None:
        shown.add_row("with what was found", mm(diagnosis.rms_after, 3), "")
        splits = "; ".join(f"{name} {mm(value, 3)}" for name, value in diagnosis.splits.items())
        shown.add_row("on readings not fitted", mm(diagnosis.rms_after_held_out, 3), splits)
    return shown


def findings(diagnosis: Diagnosis) -> Table:
    """What is missing, each parameter with its interval."""
    headings = ("left out", "parameter", "value", "95 % interval", "explains", "p")
    shown = table(*headings, numbers=(2, 3, 4, 5))
    for finding in diagnosis.findings:
        first = (effect_words(finding.effect, finding.at), mm(finding.rms_explained, 3), p_words(finding.p_value))
        parameters, further = main_parameters(finding)
        for index, fitted in enumerate(parameters):
            name, explained, p = first if index == 0 else ("", "", "")
            bound = " (at its bound)" if fitted.at_bound else ""
            place = place_words(finding.effect, fitted.at) if fitted.at != finding.at else ""
            title = f"{fitted.parameter.replace('_', ' ')} {place}".strip()
            shown.add_row(name, title, value_words(fitted) + bound, interval_words(fitted), explained, p)
        if further:
            shown.add_row("", further, "", "", "", "")
        if not finding.parameters:
            shown.add_row(first[0], "", "", "", *first[1:])
    return shown


def show_unknown(out: Console, unknown: Unknown) -> None:
    """Print what nothing in the library explains."""
    out.print(f"Not explained: {unknown.shape}; RMS {mm(unknown.amplitude, 3)}.", soft_wrap=True)
    if unknown.forms:
        shown = table("forms that describe it", "share", "held out", "", numbers=(1, 2))
        for form in unknown.forms[:MOST_REJECTED]:
            shares = (share_words(form.share), share_words(form.share_held_out))
            shown.add_row(form.name.replace("_", " "), *shares, form.sentence)
        out.print(shown)
    if unknown.rejected:
        shown = table("considered and rejected", "explains", "why not", numbers=(1,))
        for form in unknown.rejected[:MOST_REJECTED]:
            shown.add_row(effect_words(form.effect, form.at), share_words(form.share), form.reason)
        out.print(shown)
    if unknown.decide:
        out.print(f"What would decide: {whole_sentence(unknown.decide)}", soft_wrap=True)


def detectable(diagnosis: Diagnosis) -> Table:
    """The smallest size of each effect that would have been found, at the place where it shows least."""
    shown = table("effect", "would have been found from", "", numbers=(1,))
    for each in least_visible(diagnosis):
        size = f"{each.parameter.replace('_', ' ')} {detectable_words(each)}, {place_words(each.effect, each.at)}"
        shown.add_row(effect_title(each.effect), mm(each.rms, 3), size.removesuffix(", "))
    return shown


def ladder(diagnosis: Diagnosis) -> Table:
    """The models tried, with what they leave."""
    shown = table("model", "RMS", "mean", "largest", "held out", "", numbers=(1, 2, 3, 4))
    largest = max(rung.rms for rung in diagnosis.ladder)
    for rung in diagnosis.ladder:
        bar = "█" * max(1, round(_BAR * rung.rms / largest)) if largest > 0.0 and rung.rms > 0.0 else ""
        shown.add_row(rung.label, *(mm(x, 3) for x in (rung.rms, rung.mean, rung.largest, rung.held_out)), bar)
    return shown


def standards(diagnosis: Diagnosis) -> Table:
    """Figures of ISO 9283 and ISO 230-2."""
    shown = table("figure", "value", "readings", "standard", "", numbers=(1, 2))
    for each in diagnosis.figures:
        shown.add_row(each.symbol, covered_words(each), str(each.count), each.standard, each.name)
    return shown


def show_next_poses(out: Console, diagnosis: Diagnosis) -> None:
    """Print which readings would decide more."""
    if diagnosis.next_poses:
        shown = table("poses worth recording next", "payload", "side", "to decide")
        for each in diagnosis.next_poses[:MOST_NEXT]:
            shown.add_row(*next_pose_words(diagnosis.arm, each), each.decides)
        out.print(shown)
    if diagnosis.next_poses_note:
        out.print(diagnosis.next_poses_note, soft_wrap=True)


def _show_rest(out: Console, diagnosis: Diagnosis) -> None:
    lines = [f"Row {each.row} is set aside: {each.reason}." for each in diagnosis.rejected_rows[:MOST_REJECTED]]
    if len(diagnosis.rejected_rows) > MOST_REJECTED:
        more = len(diagnosis.rejected_rows) - MOST_REJECTED
        lines.append(f"{more} more rows are set aside; the report and the JSON name them.")
    lines += dict.fromkeys((*diagnosis.null_vectors, *diagnosis.notes, *diagnosis.recording.warnings))
    if lines:
        out.print()
    for line in lines:
        out.print(line, soft_wrap=True)
