"""A redesign described: what the old optimum really had, what is decided otherwise, and whether drives matter more."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from linkwright.json.design import links_json
from linkwright.json.fields import fields, in_mm
from linkwright.redesigning import STIFFER, Decision, Redesign
from linkwright.report.pictures.sections import sections_grid

from . import design
from .document import Description, Fact, Facts, Lines, Paragraph, Picture, Section, length, section
from .figures_in_words import effect_title, factor_words, figure, mm, percent

TITLE = "The design with the corrected physics"


def describe(redesign: Redesign) -> Description:
    """A redesign by itself."""
    sentences = redesign_sentences(redesign)
    return Description(TITLE, sentences[0], (redesign_section(redesign),), sentences[1].rstrip("."))


def redesign_section(redesign: Redesign) -> Section:
    """What changes: sentences, figures, sections and links of both optima."""
    facts = (
        Fact("promised", length(redesign.promised), "the old optimum, in the model as given"),
        Fact("really had", length(redesign.had), "the old optimum, with what was found"),
        Fact("new optimum", length(redesign.has), "with what was found"),
    )
    words = "Before is the optimum of the arm as given, after that of the corrected arm."
    links = design.links((("before", redesign.old.after), ("after", redesign.new.after)))
    return section(
        TITLE,
        Facts(facts, detail=True),
        Lines(tuple(redesign_sentences(redesign))),
        Paragraph(words, "lead", detail=True),
        Picture(lambda: sections_grid((("before", redesign.old.arm), ("after", redesign.new.arm)))),
        replace(links, detail=True),
        opened=True,
    )


def redesign_sentences(redesign: Redesign) -> list[str]:
    """The redesign in plain sentences, the most telling first."""
    ratio = factor_words(redesign.promised, redesign.had)
    compared = "" if ratio == "unchanged" else f" ({ratio})"
    found = [
        f"The old optimum was promised {mm(redesign.promised)} and really has {mm(redesign.had)}{compared}.",
        _gain(redesign),
        _decided(redesign),
        drive_sentence(redesign),
    ]
    if redesign.carried_over:
        names = ", ".join(effect_title(effect) for effect in redesign.carried_over)
        found.append(f"Found on the links as built, and taken to hold for other links as well: {names}.")
    return found


def _gain(redesign: Redesign) -> str:
    if redesign.new.minimize != "max_error":
        before, after = redesign.old.after.mass, redesign.new.after.mass
        return f"With the corrected physics the links weigh {figure(after)} kg instead of {figure(before)} kg."
    gain = redesign.had - redesign.has
    if gain <= 1e-3 * redesign.had:
        return f"Designing anew gains nothing: the new optimum has {mm(redesign.has)}."
    return f"The new optimum has {mm(redesign.has)}: {percent(gain / redesign.had)} less than the old one really has."


def _decided(redesign: Redesign) -> str:
    if not redesign.decisions:
        return "Every decision stays: shapes, materials and sizes are those of the old optimum, within a hundredth."
    return "Decided otherwise: " + "; ".join(decision_words(each) for each in redesign.decisions) + "."


def decision_words(decision: Decision) -> str:
    """One decision as a phrase."""
    shown = [
        value.replace("_", " ") if isinstance(value, str) else mm(value) for value in (decision.before, decision.after)
    ]
    return f"link {decision.link} {decision.what} {shown[0]} → {shown[1]}"


def drive_sentence(redesign: Redesign) -> str:
    """Whether a stiffer drive is worth more than a stiffer link."""
    best = redesign.best_drive
    if best is None:
        return "No drive gives in this model, so a stiffer one would bring nothing."
    drive = f"Drive {best.joint}, stiffer by {percent(STIFFER)}, would change the worst error by {mm(best.change, 3)}"
    if redesign.link_mass_price is None:
        return f"{drive}; the links' mass has no price where it is what is minimised."
    if redesign.link_mass_price == 0.0:
        return f"{drive}; no limit on the mass binds, so heavier links would bring nothing."
    one = mm(redesign.link_mass_price, 3)
    more = best.change < redesign.link_mass_price
    verdict = "the stiffer drive is worth more" if more else "the stiffer links are worth more"
    return f"{drive}, 1 kg more of links by {one}: {verdict}."


def redesign_json(redesign: Redesign) -> dict[str, Any]:
    """A redesign for machines; errors in mm."""
    return {
        **fields(redesign, "problem=problem_file", "promised_mm", "had_mm", "has_mm", "carried_over"),
        "status": [redesign.old.status, redesign.new.status],
        "decisions": [_decision(each) for each in redesign.decisions],
        "stiffer_drives": [
            {**fields(each, "joint", "compliance", "change_mm"), "stiffer_by": STIFFER} for each in redesign.drives
        ],
        "link_mass_price_mm_per_kg": in_mm(redesign.link_mass_price),
        "links": links_json(redesign.new.arm, redesign.new.after.link_masses),
        "sentences": redesign_sentences(redesign),
    }


def _decision(decision: Decision) -> dict[str, Any]:
    if isinstance(decision.before, str):
        return {**fields(decision, "link", "what", "before", "after"), "unit": None}
    sizes = {"before": in_mm(decision.before), "after": in_mm(decision.after), "unit": "mm"}
    return {**fields(decision, "link", "what"), **sizes}
