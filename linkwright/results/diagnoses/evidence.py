"""The evidence of a diagnosis: localisation, models compared, detectable causes, and each recording by itself."""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Sequence

from linkwright.core.diagnose.result import Detectable, Diagnosis, OfRecording, RejectedForm
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.units.lists import listed
from linkwright.results.diagnoses.words import (
    covariate_words,
    covered,
    detectable_words,
    effect_words,
    least_visible,
    measured,
    next_pose_words,
    place_words,
    portion,
    probability,
    where_sentences,
)
from linkwright.results.document import (
    Bars,
    Cell,
    Column,
    Lines,
    Paragraph,
    Section,
    Table,
    Value,
    count,
    length,
    section,
    table,
)
from linkwright.results.figures_in_words import effect_title, mm, pose

MOST_REJECTED = 5
MOST_NEXT = 5

SPLITS = (
    ("pose blocks", "a part of the workspace at a time (the one quoted above)"),
    ("random rows", "a fifth of the rows at random"),
    ("time blocks", "a stretch of time at a time"),
    ("payloads", "a payload at a time"),
)


def where_it_sits(diagnosis: Diagnosis) -> Section:
    """Where the mismatch sits: the joint, what each joint's motion could describe, what it depends on."""
    where = diagnosis.where
    shares = [
        (count(number), portion(part), Bars((("after" if number == where.joint else "before", part),)))
        for number, part in enumerate(where.joint_shares, start=1)
    ]
    title = "What each joint's motion could describe"
    overlap = "Each joint alone. The shares overlap, and do not add up to the whole."
    tested = [
        (
            covariate_words(dependence.on),
            portion(dependence.share),
            probability(dependence.p_value),
            "it depends on this" if dependence.on in where.depends_on else "",
        )
        for dependence in where.dependences
    ]
    headings = ("tested against", "could describe", "p", "")
    columns = ("joint", "could describe", "")
    return section(
        "Where it sits",
        Lines(tuple(where_sentences(diagnosis))),
        table(columns, shares, title=title, detail=True) if shares else None,
        Paragraph(overlap, "lead", detail=True) if shares else None,
        table(headings, tested, detail=True) if tested else None,
    )


def ladder(diagnosis: Diagnosis) -> Section:
    """The models tried, each with what it leaves on fitted and on held-out readings."""
    known = [x for rung in diagnosis.ladder for x in (rung.rms, rung.held_out) if math.isfinite(x)]
    largest = max(known, default=0.0) or 1.0
    rows = [
        (
            rung.label,
            *(length(x, 3) for x in (rung.rms, rung.mean, rung.largest, rung.held_out)),
            Bars((("after", rung.rms / largest), ("before", rung.held_out / largest))),
        )
        for rung in diagnosis.ladder
    ]
    rivals = () if diagnosis.rivals is None else diagnosis.rivals.table
    tried = [
        (item.subject, count(item.parameters), length(item.in_sample, 3), length(item.held_out, 3)) for item in rivals
    ]
    splits = [f"{dict(SPLITS).get(name, name)}: RMS {mm(x, 3)}" for name, x in diagnosis.splits.items()]
    return section(
        "The ladder of models",
        table(("model", "RMS", "mean", "largest", "held out", ""), rows),
        Paragraph("On readings that it has not seen, by what was held out:", "lead", detail=True) if splits else None,
        Lines(tuple(splits), detail=True),
        table(("what the file could hold", "numbers", "RMS", "held out"), tried, detail=True) if tried else None,
        Paragraph(diagnosis.rivals.why, "lead", detail=True) if diagnosis.rivals is not None else None,
        lead="Each model is fitted and then tried on readings that it has not seen: the blue bar, and the grey one.",
        detail=len(rows) < 2,
    )


def rejected(forms: Sequence[RejectedForm]) -> Table:
    """What was considered and not taken, and why."""
    rows = [(effect_words(form.effect, form.at), portion(form.share), form.reason) for form in forms]
    return table(("considered and rejected", "explains", "why not"), rows, first=MOST_REJECTED)


def set_aside(rows: Sequence[tuple[str, str]]) -> Section:
    """The rows that were not used (`row 5`, or of several recordings `row 5 of august.csv`), each with why."""
    if not rows:
        return section("Rows set aside", Paragraph("Every row was used.", detail=True), detail=True)
    lines = [f"{name[:1].upper()}{name[1:]} is set aside: {why}." for name, why in rows]
    left = len(lines) - MOST_REJECTED
    more = Paragraph(f"{left} more rows are set aside. The report and the JSON name them.") if left > 0 else None
    numbered = [(Value(name.removeprefix("row ")), why) for name, why in rows]
    every = table(("row", "why"), numbered, detail=True) if left > 0 else None
    return section("Rows set aside", Lines(tuple(lines[:MOST_REJECTED])), more, every)


def considered(diagnosis: Diagnosis) -> Section:
    """What was considered over the whole search and not named."""
    lead = "How much more of the mismatch each would explain, and why it is not named."
    forms = rejected(diagnosis.rejected_forms)
    return section("Considered and rejected", forms, lead=lead, detail=True)


def detectable(diagnosis: Diagnosis, *, detail: bool) -> Section | None:
    """The smallest sizes that would have been found, and what cannot be seen at all."""
    if not (diagnosis.detectable or diagnosis.invisible):
        return None
    visible = [item for item in diagnosis.detectable if item.visible > 0.0]
    worst = least_visible(diagnosis)
    hidden = [effect_words(effect, at) for effect, at in diagnosis.invisible]
    every = "Every one, at every joint and link"
    return section(
        "What this recording could have shown",
        table(_SEEN, [_seen(item) for item in worst]) if visible else None,
        table(_SEEN, [_seen(item) for item in visible], title=every, detail=True, folded=True)
        if len(visible) > len(worst)
        else None,
        Paragraph(f"Not to be seen in this recording at all: {', '.join(hidden)}.", detail=True) if hidden else None,
        lead="The smallest size that this recording would have shown nine times in ten, where it shows least.",
        detail=detail or not visible,
    )


_SEEN = ("effect", "would have been found from", "", Column("visible share of its pattern", detail=True))


def _seen(each: Detectable) -> tuple[Cell, ...]:
    size = f"{each.parameter.replace('_', ' ')} {detectable_words(each)}, {place_words(each.effect, each.at)}"
    return effect_title(each.effect), length(each.rms, 3), size.removesuffix(", "), portion(each.visible)


def standards(diagnosis: Diagnosis) -> Section:
    """Figures of ISO 9283 and ISO 230-2."""
    rows = [
        (figure.symbol, covered(figure), count(figure.count), figure.standard, figure.name)
        for figure in diagnosis.figures
    ]
    lead = "Where the recording has enough visits. The standards ask for thirty (ISO 9283) and five (ISO 230-2)."
    shown = table(("figure", "value", "readings", "standard", ""), rows)
    return section("In the words of the standards", shown, lead=lead)


def next_readings(diagnosis: Diagnosis) -> Section:
    """Readings that would decide more."""
    rows: list[list[Cell]] = []
    for next_pose in diagnosis.next_poses:
        payload, side = next_pose_words(next_pose)
        rows.append([pose(diagnosis.arm, next_pose.q), payload, side, next_pose.decides])
    headings = ("poses worth recording next", "payload", "side", "to decide")
    note = Paragraph(diagnosis.next_poses_note) if diagnosis.next_poses_note else None
    shown = table(headings, rows, first=MOST_NEXT) if rows else None
    return section("What to record next", shown, note)


def unit_files(each: Sequence[OfRecording]) -> tuple[str, ...]:
    """The names of the files of several arms' corrected arms, by what each recording is called (`unit:` in its
    settings); none where they are of one arm."""
    names: list[str] = []
    for number, one in enumerate(each, start=1):
        if one.corrected is None:
            return ()
        plain = unicodedata.normalize("NFKD", one.name.lower().removesuffix(".csv")).encode("ascii", "ignore").decode()
        slug = re.sub(r"[^a-z0-9]+", "-", plain).strip("-")[:60].strip("-")
        name = f"arm-{slug or number}.yaml"
        names.append(f"arm-{slug or 'unit'}-{number}.yaml" if name in names else name)
    return tuple(names)


def arms_of_recordings(diagnosis: Diagnosis) -> Section:
    """The corrected arm of each of several arms, and what its file is worth on its recording."""
    rows: list[list[Cell]] = []
    broken: list[Paragraph] = []
    for one, file in zip(diagnosis.recordings, unit_files(diagnosis.recordings), strict=True):
        rms = None if one.written is None else one.written.rms
        rows.append([one.name, file, length(rms, 3), length(one.rms_promised, 3)])
        if one.written is not None and not one.written.keeps(RULES.answer.promise):
            lacks = f" The file lacks {listed(one.written.lacks)}." if one.written.lacks else ""
            text = f"The fit promises {mm(one.rms_promised, 3)}.{lacks}"
            broken.append(Paragraph(f"Warning: {file} leaves {mm(one.written.rms, 3)} RMS of its recording. {text}"))
    headings = ("unit", "file", "leaves of its recording", "the fit promises")
    lead = "Each file holds the type's physics and the unit's own differences. RMS on the unit's own recording. "
    return section("Each unit's arm", table(headings, rows), *broken, lead=f"{lead}arm.yaml is the type's.")


def recordings(diagnosis: Diagnosis) -> Section:
    """Every recording with its noise, its mismatch, and what is left of it by what all of them say."""
    rows: list[list[Cell]] = [
        [
            recording.name,
            count(recording.rows),
            length(recording.noise_floor, 3),
            length(recording.rms_before, 3),
            length(recording.rms_after, 3),
            length(recording.rms_held_out, 3),
            length(recording.rms_from_others, 3),
            length(recording.rms_own, 3),
            _free(recording.frame, recording.tool),
        ]
        for recording in diagnosis.recordings
    ]
    headings = (
        "recording",
        "readings",
        "noise floor",
        "mismatch",
        "with what was found",
        "held out",
        "learned on the others",
        Column("sizes of its own", detail=True),
        Column("its own", detail=True),
    )
    lead = "The physics is shared. Frame, tool and noise are each recording's own. Figures are RMS."
    return section("Each recording", table(headings, rows), lead=lead)


def differing(diagnosis: Diagnosis) -> Section:
    """What is not the same in all recordings, with its value in each."""
    rows: list[list[Cell]] = [
        [
            effect_words(difference.effect, difference.at),
            difference.each[0].parameter.replace("_", " "),
            *(measured(fitted) for fitted in difference.each),
            probability(difference.p_value),
        ]
        for difference in diagnosis.differences
    ]
    names = [f"{recording.name} (95 % interval)" for recording in diagnosis.recordings]
    lead = "All else is common to them."
    return section("What differs", table(("what", "parameter", *names, "p"), rows), lead=lead)


def _free(frame: str, tool: str) -> str:
    free = [name for name, setting in (("frame", frame), ("tool", tool)) if setting == "free"]
    return " and ".join(free)
