"""What comes of each of several recordings that were diagnosed together."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence

from linkwright.core.diagnose.result import Diagnosis, OfRecording
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.results.document import Cell, Column, Paragraph, Section, count, length, section, table
from linkwright.results.figures_in_words import mm

from .words import effect_words, listed, measured, probability


def unit_files(each: Sequence[OfRecording]) -> tuple[str, ...]:
    """The names of the files of several arms' own corrected arms, by what each recording is called (`unit:` in its
    settings); none where they are of one arm."""
    found: list[str] = []
    for number, one in enumerate(each, start=1):
        if one.corrected is None:
            return ()
        plain = unicodedata.normalize("NFKD", one.name.lower().removesuffix(".csv")).encode("ascii", "ignore").decode()
        slug = re.sub(r"[^a-z0-9]+", "-", plain).strip("-")[:60].strip("-")
        name = f"arm-{slug or number}.yaml"
        found.append(f"arm-{slug or 'unit'}-{number}.yaml" if name in found else name)
    return tuple(found)


def own_arms(diagnosis: Diagnosis) -> Section:
    """The corrected arm of each of several arms, and what its file is worth on its recording."""
    rows: list[list[Cell]] = []
    broken: list[Paragraph] = []
    for one, file in zip(diagnosis.recordings, unit_files(diagnosis.recordings), strict=True):
        rms = None if one.written is None else one.written.rms
        rows.append([one.name, file, length(rms, 3), length(one.rms_promised, 3)])
        if one.written is not None and not one.written.keeps(RULES.answer.promise):
            lacks = f": the file lacks {listed(one.written.lacks)}" if one.written.lacks else ""
            said = f"leaves {mm(one.written.rms, 3)} RMS where the fit promises {mm(one.rms_promised, 3)}"
            broken.append(Paragraph(f"Warning: {file}, read back and applied to its recording, {said}{lacks}."))
    headings = ("unit", "file", "leaves of its recording", "the fit promises")
    lead = "What belongs to the type and each one's own differences, read back and applied to its own recording; RMS. "
    return section("Each unit's arm", table(headings, rows), *broken, lead=f"{lead}arm.yaml is the type's.")


def recordings(diagnosis: Diagnosis) -> Section:
    """Every recording with its own noise, its mismatch, and what is left of it by what all of them say."""
    rows: list[list[Cell]] = [
        [
            each.name,
            count(each.rows),
            length(each.noise_floor, 3),
            length(each.rms_before, 3),
            length(each.rms_after, 3),
            length(each.rms_held_out, 3),
            length(each.rms_from_others, 3),
            length(each.rms_own, 3),
            _free(each.frame, each.tool),
        ]
        for each in diagnosis.recordings
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
    lead = "The physics is shared, frame, tool and noise are each recording's own; RMS."
    return section("Each recording", table(headings, rows), lead=lead)


def differing(diagnosis: Diagnosis) -> Section:
    """What is not the same in all recordings, with its value in each."""
    rows: list[list[Cell]] = [
        [
            effect_words(each.effect, each.at),
            each.each[0].parameter.replace("_", " "),
            *(measured(fitted) for fitted in each.each),
            probability(each.p_value),
        ]
        for each in diagnosis.differences
    ]
    names = [f"{each.name} (95 % interval)" for each in diagnosis.recordings]
    lead = "All else is common to them."
    return section("What differs", table(("what", "parameter", *names, "p"), rows), lead=lead)


def _free(frame: str, tool: str) -> str:
    free = [name for name, setting in (("frame", frame), ("tool", tool)) if setting == "free"]
    return " and ".join(free)
