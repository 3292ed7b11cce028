"""A redesign in words: what the old optimum really had, what is decided otherwise, and whether drives matter more."""

from __future__ import annotations

from typing import Any

from .as_json import links_json
from .redesign import STIFFER, Decision, Redesign
from .words import effect_title, factor_words, figure, mm, percent


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
    price = redesign.link_mass_price
    return {
        "problem": redesign.problem_file,
        "promised_mm": 1e3 * redesign.promised,
        "had_mm": 1e3 * redesign.had,
        "has_mm": 1e3 * redesign.has,
        "status": [redesign.old.status, redesign.new.status],
        "decisions": [
            {
                "link": each.link,
                "what": each.what,
                "before": each.before if isinstance(each.before, str) else 1e3 * each.before,
                "after": each.after if isinstance(each.after, str) else 1e3 * each.after,
                "unit": None if isinstance(each.before, str) else "mm",
            }
            for each in redesign.decisions
        ],
        "stiffer_drives": [
            {"joint": each.joint, "compliance": each.compliance, "stiffer_by": STIFFER, "change_mm": 1e3 * each.change}
            for each in redesign.drives
        ],
        "link_mass_price_mm_per_kg": None if price is None else 1e3 * price,
        "links": links_json(redesign.new.arm, redesign.new.after.link_masses),
        "carried_over": list(redesign.carried_over),
        "sentences": redesign_sentences(redesign),
    }
