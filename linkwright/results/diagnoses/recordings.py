"""What comes of each of several recordings that were diagnosed together."""

from __future__ import annotations

from diagnose.result import Diagnosis
from linkwright.results.document import Cell, Column, Section, count, length, section, table

from .words import effect_words, measured, probability


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
