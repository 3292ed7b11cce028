"""A diagnosis described: the plain sentence, what is missing with its intervals, where it sits, what else it is not."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePath
from types import MappingProxyType

from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.answer.sentences import about_of, name_of
from linkwright.core.diagnose.result import Diagnosis, Finding, LackOfFit, Unknown
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.units.lists import listed
from linkwright.redesigning import Redesign, redesign_section
from linkwright.report.charts.covariates import joint_curves, small_multiples
from linkwright.report.charts.designs import arm_at_mismatch
from linkwright.report.page import side_by_side
from linkwright.report.pictures.residual_map import residual_maps
from linkwright.results.design import settings
from linkwright.results.diagnoses.evidence import arms_of_recordings, differing, recordings, unit_files
from linkwright.results.document import (
    Cell,
    Column,
    Description,
    Fact,
    Facts,
    Item,
    Lines,
    Paragraph,
    Picture,
    Section,
    Value,
    amount,
    length,
    section,
    table,
)
from linkwright.results.figures_in_words import figure, lasted, mm

from .answer import answer, gravity_guessed, to_do
from .evidence import (
    MOST_REJECTED,
    considered,
    detectable,
    ladder,
    next_readings,
    rejected,
    set_aside,
    standards,
    where_it_sits,
)
from .words import (
    covariate_words,
    explained_share,
    name_words,
    parameter_rows,
    place_words,
    portion,
    probability,
    row_words,
    spoken,
    time_words,
    verdict_words,
    whole_sentence,
    written_differs,
)

_WITHOUT = "Without JavaScript the maps to hover over are missing. All else is here. diagnosis.json has the figures."


def describe(diagnosis: Diagnosis, redesign: Redesign | None = None) -> Description:
    """A diagnosis, with the design that follows from it where one was asked for."""
    anything = bool(diagnosis.findings) or diagnosis.unknown is not None
    could = detectable(diagnosis, detail=diagnosis.verdict not in ("none", "insufficient_data"))
    guessed = gravity_guessed(diagnosis)
    items: list[Item | None] = [
        Paragraph(guessed, "warning") if guessed else None,
        _next_steps(diagnosis),
        Picture(lambda: side_by_side(arm_at_mismatch(diagnosis))),
        Paragraph(diagnosis.sentence),
        _facts(diagnosis),
        Paragraph(diagnosis.noise_source),
        _broken_promise(diagnosis),
        *_identified(diagnosis),
        where_it_sits(diagnosis) if anything else could,
        section("Residuals over the workspace", Picture(lambda: residual_maps(diagnosis)), detail=True),
        ladder(diagnosis) if diagnosis.ladder else None,
        section("Residuals against what was recorded", Picture(lambda: small_multiples(diagnosis)), detail=True),
        considered(diagnosis) if diagnosis.rejected_forms else None,
        could if anything else None,
        standards(diagnosis) if diagnosis.figures else None,
        next_readings(diagnosis) if diagnosis.next_poses or diagnosis.next_poses_note else None,
        None if redesign is None else redesign_section(redesign),
        section("What to do with it", Lines(_to_do(diagnosis)), detail=True) if anything else None,
        _set_aside(diagnosis),
        _notes(diagnosis),
        section("What was asked", settings(_asked(diagnosis)), detail=True),
    ]
    title = f"{diagnosis.arm.name}: what the model lacks"
    held = tuple(item for item in items if item is not None)
    return Description(title, answer(diagnosis), held, _brief(diagnosis), without=_WITHOUT)


def _identified(diagnosis: Diagnosis) -> tuple[Item | None, ...]:
    """What differs between recordings, what is missing, what was fitted beside it, and what stays unknown."""
    return (
        recordings(diagnosis) if diagnosis.recordings else None,
        differing(diagnosis) if diagnosis.differences else None,
        arms_of_recordings(diagnosis) if diagnosis.findings and unit_files(diagnosis.recordings) else None,
        _findings(diagnosis) if diagnosis.findings else None,
        _origins(diagnosis) if diagnosis.origins else None,
        _placements(diagnosis) if diagnosis.placements else None,
        None if diagnosis.unknown is None else _unknown(diagnosis.unknown),
    )


def _brief(diagnosis: Diagnosis) -> str:
    if not diagnosis.findings and diagnosis.scatter is not None:
        return f"scatter of {figure(diagnosis.scatter, 2)} times the noise floor that nothing explains"
    if diagnosis.verdict == "none" and diagnosis.unexplained:
        return f"more than noise, not explained, mismatch {mm(diagnosis.rms_before, 3)}"
    if not diagnosis.findings:
        return f"{verdict_words(diagnosis.verdict)}, mismatch {mm(diagnosis.rms_before, 3)}"
    places = [place_words(finding.effect, finding.at) for finding in diagnosis.findings]
    ids = [finding.effect.replace("_", " ") for finding in diagnosis.findings]
    names = [f"{name} at {place}" if place else name for name, place in zip(ids, places, strict=True)]
    more = f" and {len(names) - 1} more" if len(names) > 1 else ""
    explained = explained_share(diagnosis)
    part = "" if explained is None else f", {portion(explained).text} of {mm(diagnosis.rms_before, 3)} explained"
    return f"{names[0]}{more}{part}"


def _next_steps(diagnosis: Diagnosis) -> Lines | None:
    steps = to_do(diagnosis)
    return Lines(steps) if steps else None


_NOISE = MappingProxyType(
    {
        "repeats": "what repeats scatter by",
        "declared": "as declared",
        "revisits": "what visits of one pose differ by",
        "none": "nothing tells it",
    }
)
"""Whence the noise floor is known."""


def _facts(diagnosis: Diagnosis) -> Facts:
    gate = f"any mismatch at all: p {probability(diagnosis.gate_p).text}"
    verdict = verdict_words(diagnosis.verdict, short=True)
    if diagnosis.verdict == "none" and diagnosis.unexplained:
        verdict = f"{'more than noise' if diagnosis.scatter is None else 'scatter'}, not explained"
    facts = [
        Fact("verdict", verdict, gate),
        Fact("noise floor", length(diagnosis.noise_floor, 3), _NOISE[diagnosis.noise_from]),
        Fact("RMS of the mismatch", length(diagnosis.rms_before, 3), f"{diagnosis.recording.size} readings"),
    ]
    if diagnosis.findings or diagnosis.unknown is not None:
        explained = explained_share(diagnosis)
        described = "beside the form that fits best" if diagnosis.unknown is not None else ""
        note = described if explained is None else f"{portion(explained).text} of the mismatch explained"
        splits = "; ".join(f"{name} {mm(x, 3)}" for name, x in diagnosis.splits.items())
        facts.append(Fact("with what was found", length(diagnosis.rms_after, 3), note))
        facts.append(Fact("on readings not fitted", length(diagnosis.rms_after_held_out, 3), splits))
    if diagnosis.scatter is not None:
        said = "what visits differ by, which nothing explains"
        facts.append(Fact("scatter", Value(f"{figure(diagnosis.scatter, 2)} times the noise floor"), said))
    if diagnosis.lack_of_fit is not None:
        facts.append(Fact("lack of fit", *_lack_of_fit(diagnosis.lack_of_fit)))
    if diagnosis.small is not None:
        chance, left = _lack_of_fit(diagnosis.small.lack_of_fit)
        said = f"what they move the tip by together; lack of fit with room for them {chance.text}: {left}"
        facts.append(Fact("causes too small to be named", length(diagnosis.small.moved, 3), said))
    written = diagnosis.written
    if written is not None and diagnosis.findings and written_differs(written):
        promised = f"of this recording, where the fit promises {mm(written.promised, 3)}"
        facts.append(Fact("the written arm.yaml leaves", length(written.rms, 3), promised))
    return Facts(tuple(facts), headed=False)


def _broken_promise(diagnosis: Diagnosis) -> Paragraph | None:
    """A warning where the written file is not what the fit promises, with what it lacks."""
    written = diagnosis.written
    if written is None or not diagnosis.findings or written.keeps(RULES.answer.promise):
        return None
    lacks = f" The file lacks {listed(written.lacks)}." if written.lacks else ""
    if diagnosis.differences:
        return Paragraph(
            f"arm.yaml holds what is common to the recordings and leaves {mm(written.rms, 3)} RMS of them.{lacks} What "
            "differs is in diagnosis.json (differences)."
        )
    return Paragraph(
        f"Warning: the written arm.yaml leaves {mm(written.rms, 3)} RMS of this recording. The fit promises "
        f"{mm(written.promised, 3)}.{lacks}"
    )


def _lack_of_fit(lack_of_fit: LackOfFit) -> tuple[Value, str]:
    """The test of what is left against readings of one pose, with what stands behind it."""
    pure = {"repeats": "repeatability", "returns": "pose repeatability"}[lack_of_fit.against]
    left = f"remaining error {figure(lack_of_fit.times, 3)} × {pure} on fitted readings"
    held = f"{figure(lack_of_fit.held_out_times, 3)} × on unseen ones"
    return Value(f"p {probability(lack_of_fit.p_value).text}"), f"{left}, {held}"


def _origins(diagnosis: Diagnosis) -> Section:
    rows = [
        (f"joint {origin.joint}", about_of(parameter))
        for origin in diagnosis.origins
        for parameter in origin.parameters
    ]
    swallowed = [
        f"These cannot be told apart from the transform in front of joint {origin.joint}: "
        f"{listed([name_of(effect, at) for effect, at in origin.swallowed])}."
        for origin in diagnosis.origins
        if origin.swallowed
    ]
    return section(
        "Fixed transforms that were free",
        table(("in front of", "shift in the frame before it, and fixed-axis turn"), rows),
        *(Paragraph(said) for said in swallowed),
    )


def _placements(diagnosis: Diagnosis) -> Section:
    """Where free frames and tools were found, one row each."""
    means = {
        "frame": "the base in the measuring frame, and its fixed-axis turn",
        "tool": "the tip at the last link's end, as `tool: {xyz: [...]}` of an arm file",
    }
    rows = [
        (
            f"{item.of}, {item.recording}" if item.recording else item.of,
            "; ".join(about_of(parameter) for parameter in item.parameters),
            means[item.of],
        )
        for item in diagnosis.placements
    ]
    return section("Frame and tool that were free", table(("fitted", "value, 95 % interval", "means"), rows))


def _findings(diagnosis: Diagnosis) -> Section:
    readings = [
        Paragraph(spoken(finding.reading), "statement", True) for finding in diagnosis.findings if finding.reading
    ]
    small = [finding for finding in diagnosis.findings if finding.small]
    rows, small_rows = (
        [row for finding in diagnosis.findings if finding.small is which for row in _finding_rows(finding)]
        for which in (False, True)
    )
    headings = (
        "found",
        "parameter",
        Column("meaning", detail=True),
        "value",
        "95 % interval",
        "explains",
        Column("RMS without it", detail=True),
        "p",
    )
    similar = [
        (
            name_words(finding),
            name_words(other),
            amount(other.likeness),
            amount(round(other.worse, 3), digits=2),
        )
        for finding in diagnosis.findings
        for other in finding.alternatives
    ]
    columns = ("named", "may as well be", "likeness of the patterns", "criterion (BIC) worse by")
    title = "What the data cannot tell apart"
    return section(
        "What describes part of it" if diagnosis.describes_part else "What is missing",
        *readings,
        table(headings, rows),
        Paragraph(_small_words(small, diagnosis.small_together)) if small else None,
        table(headings, small_rows, title="The small ones", detail=True, folded=len(small) > MOST_SMALL)
        if small
        else None,
        Picture(lambda: joint_curves(diagnosis)),
        table(columns, similar, title=title, detail=True) if similar else None,
    )


MOST_SMALL = 4
"""Small findings up to which a page shows their table open."""


def _small_words(small: Sequence[Finding], together: float) -> str:
    """What held-out readings hardly need, by its cause, and what it moves together (m)."""
    causes: dict[str, list[str]] = {}
    for item in small:
        cause = EFFECTS[item.effect].cause if item.effect in EFFECTS else "other"
        causes.setdefault(cause, []).append(f"{name_words(item)} {mm(item.rms_explained, 2)}")
    text = "; ".join(f"{cause}: {', '.join(names)}" for cause, names in causes.items())
    return f"Small, together {mm(together, 2)}: {text}."


def _finding_rows(finding: Finding) -> list[list[Cell]]:
    rest: list[Cell] = [length(finding.rms_explained, 3), length(finding.rms_without, 3), probability(finding.p_value)]
    return parameter_rows(finding, name_words(finding), rest)


def _unknown(unknown: Unknown) -> Section:
    """What nothing in the library explains."""
    lines = []
    if unknown.depends_on:
        lines.append(f"It depends on: {', '.join(covariate_words(name) for name in unknown.depends_on)}.")
    if unknown.since is not None:
        lines.append(f"It is there since {time_words(unknown.since)} into the recording.")
    if unknown.held_out_share is not None:
        good = "It describes and does not explain: good for compensation within the poses recorded only."
        lines.append(
            f"A smooth model of it predicts {portion(unknown.held_out_share).text} of its sum of squares on readings "
            f"that it has not seen. {good if _tells(unknown) else 'That is nothing to compensate by.'}"
        )
    forms = [
        (form.name.replace("_", " "), portion(form.share), portion(form.share_held_out), form.sentence)
        for form in unknown.forms
    ]
    headings = ("forms that describe it", "share", "held out", "")
    decide = Paragraph(f"What would decide: {whole_sentence(unknown.decide)}") if unknown.decide else None
    return section(
        "What nothing in the library explains",
        Paragraph(f"Not explained: {unknown.shape}. RMS {mm(unknown.amplitude, 3)}."),
        Lines(tuple(lines), detail=True),
        table(headings, forms, first=MOST_REJECTED) if forms else None,
        rejected(unknown.rejected) if unknown.rejected else None,
        decide,
        lead="What remains, and what it depends on. Nothing here is a cause.",
    )


def _tells(unknown: Unknown) -> bool:
    """Whether the smooth model predicts of readings that it has not seen what a form must to describe them."""
    return unknown.held_out_share is not None and unknown.held_out_share > RULES.answer.refuted


def _to_do(diagnosis: Diagnosis) -> tuple[str, ...]:
    """What the files beside the page are good for."""
    if diagnosis.unknown is not None:
        described = (
            "compensation.csv: what to subtract at the poses recorded. The table describes, does not explain, and "
            "holds as long as the cause stays as it was.",
        )
        again = "Record what would decide (above), and diagnose again."
        good = diagnosis.unknown.predicted is not None and _tells(diagnosis.unknown)
        return (*(described if good else ()), again)
    return (
        "arm.yaml: the arm with the findings. `linkwright evaluate` and `optimize` take this file. `linkwright "
        "compensate` makes the table that a controller can subtract.",
        "residuals.csv: every reading with its residual before and after.",
        "After a repair, record the same poses again. `linkwright compare` says what has changed and what has not.",
    )


def _set_aside(diagnosis: Diagnosis) -> Section:
    return set_aside([(row_words(diagnosis.recording, row.row), row.reason) for row in diagnosis.rejected_rows])


def _notes(diagnosis: Diagnosis) -> Section | None:
    lines = tuple(dict.fromkeys((*diagnosis.null_vectors, *diagnosis.notes, *diagnosis.recording.warnings)))
    return section("Notes", Lines(lines)) if lines else None


def _asked(diagnosis: Diagnosis) -> list[tuple[str, str]]:
    recording, arm = diagnosis.recording, diagnosis.arm
    rows = [
        ("recordings" if diagnosis.recordings else "recording", PurePath(recording.file).name),
        ("readings used", str(recording.size)),
        ("measuring frame", recording.frame),
        ("tool", recording.tool),
    ]
    if arm.leave_out:
        rows.append(("not in the model (`leave_out` in the arm file)", ", ".join(sorted(arm.leave_out))))
    took = lasted(diagnosis.seconds, "")
    return [*rows, ("time taken", took)] if took else rows
