"""A design problem solved again with the diagnosed physics: decisions that change, true error of the old optimum."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from linkwright.core.arm.chain.chain import Arm, Link, LoadCase
from linkwright.core.arm.compensation import without_instrument
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.effects.elastic.joint_compliance import drive_compliance, with_compliance
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.arm.worst.parts import worst_search
from linkwright.core.arm.worst.workspace import Workspace
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.result import OptimizationResult
from linkwright.core.optimize.run import optimise
from linkwright.core.units.quantities import InputError, NoAnswer
from linkwright.json.design import links_json
from linkwright.json.fields import fields, in_mm
from linkwright.report.pictures.sections import sections_grid
from linkwright.results import design
from linkwright.results.document import Description, Fact, Facts, Lines, Paragraph, Picture, Section, length, section
from linkwright.results.figures_in_words import effect_title, factor_words, figure, mm, percent

STIFFER = 0.1
"""How much stiffer a drive is tried: a tenth."""
_SAME_SIZE = 0.01
"""A dimension that changes by less than this share is no other decision."""


def refuse_nothing_of_the_tip(arm: Arm, corrected: Arm) -> None:
    """Raise `NoAnswer` where all that was found only changes what the drives give: a tip stands where it stood."""
    effects = [EFFECTS[effect.effect] for effect in corrected.effects if effect not in arm.effects]
    if effects and not any(effect.moves_tip for effect in effects):
        named = ", ".join(dict.fromkeys(effect.title for effect in effects))
        raise NoAnswer(f"what was found moves no tip ({named}): the error that a design is chosen by stays as it was")


@dataclass(frozen=True)
class Decision:
    """Something about a link that the corrected physics decides otherwise: `what` is shape, material, length or size;
    `before` and `after` in words for shapes and materials, as lengths in m otherwise."""

    link: int
    what: str
    before: str | float
    after: str | float


@dataclass(frozen=True)
class StifferDrive:
    """What a drive stiffer by a tenth would bring: the change of the worst error of the new design (m, negative is
    better), and its whole compliance, rad/(N*m) or m/N. `joint` counts from 1."""

    joint: int
    compliance: float
    change: float


@dataclass(frozen=True)
class Redesign:
    """A problem solved twice. Errors are worst cases over the workspace in m.

    `promised` is the old optimum's error in the model as given, `had` the same design's under the corrected physics,
    `has` that of the new optimum. `link_mass_price` is the change of the error for 1 kg more of links (m/kg, negative
    is better), 0 where no limit on the mass binds, None where mass is what is minimised. `carried_over` is a caution on
    findings that belong to links which the design replaces.
    """

    problem_file: str
    old: OptimizationResult
    new: OptimizationResult
    promised: float
    had: float
    has: float
    decisions: tuple[Decision, ...]
    drives: tuple[StifferDrive, ...]
    link_mass_price: float | None
    carried_over: tuple[str, ...]

    @property
    def best_drive(self) -> StifferDrive | None:
        """The drive whose stiffness is worth most."""
        return min(self.drives, key=lambda drive: drive.change, default=None)


def redesign(
    problem: Problem,
    given: Arm,
    corrected: Arm,
    shown: Callable[[str, float], None] | None = None,
) -> Redesign:
    """Solve the problem with the arm as given and as corrected, both without what belongs to the instrument.

    `shown` hears of the steps. Raises `InputError` where the problem is for another arm, and what `optimise` raises.
    """
    tell = shown or _silent
    given, corrected = without_instrument(given), without_instrument(corrected)
    if problem.arm.size != given.size:
        raise InputError(problem.file, "arm", f"has {problem.arm.size} joints, the arm diagnosed has {given.size}")
    tell("designing with the arm as given", 0.0)
    old = optimise(replace(problem, arm=given))
    tell("designing with the corrected arm", 0.45)
    new = optimise(replace(problem, arm=corrected))
    tell("the old design under the corrected physics", 0.9)
    cases, space = problem.load_cases, problem.workspace
    had = worst_error(with_findings(old.arm, corrected), space, cases)
    return Redesign(
        problem_file=problem.file,
        old=old,
        new=new,
        promised=old.after.max_error,
        had=had,
        has=new.after.max_error,
        decisions=decisions(old.arm, new.arm),
        drives=stiffer_drives(new.arm, space, cases, new.after.max_error),
        link_mass_price=_mass_price(new),
        carried_over=_carried_over(given, corrected),
    )


def _silent(text: str, share: float) -> None:
    del text, share


def with_findings(design: Arm, corrected: Arm) -> Arm:
    """A design with the corrected arm's physics: its links, and all else as corrected."""
    links = tuple(mine if mine.elastic else theirs for mine, theirs in zip(design.links, corrected.links, strict=True))
    return replace(corrected, name=design.name, links=links)


def worst_error(arm: Arm, workspace: Workspace, cases: Sequence[LoadCase]) -> float:
    """The worst error over a workspace, m."""
    search = worst_search(error_model(arm, cases), workspace)
    return search.worst(beam_values(beams_of(arm, cases))).error


def decisions(before: Arm, after: Arm) -> tuple[Decision, ...]:
    """What differs between two designs, link by link."""
    decided: list[Decision] = []
    for number, (one, other) in enumerate(zip(before.links, after.links, strict=True), start=1):
        decided += [Decision(number, *difference) for difference in _differences(one, other)]
    return tuple(decided)


def _differences(one: Link, other: Link) -> list[tuple[str, str | float, str | float]]:
    differences: list[tuple[str, str | float, str | float]] = []
    if _differs(one.length, other.length):
        differences.append(("length", one.length, other.length))
    shapes = ["rigid" if link.section is None else link.section.shape for link in (one, other)]
    if shapes[0] != shapes[1]:
        differences.append(("shape", shapes[0], shapes[1]))
    elif one.section is not None and other.section is not None:
        sizes = [link.section.given() for link in (one, other) if link.section is not None]
        for name, value in sizes[0].items():
            new = sizes[1].get(name)
            if isinstance(value, int | float) and isinstance(new, int | float) and _differs(value, new):
                differences.append((name.replace("_", " "), float(value), float(new)))
    materials = ["–" if link.material is None else link.material.name for link in (one, other)]
    if materials[0] != materials[1]:
        differences.append(("material", materials[0], materials[1]))
    return differences


def _differs(one: float, other: float) -> bool:
    return abs(one - other) > _SAME_SIZE * max(abs(one), abs(other))


def stiffer_drives(arm: Arm, workspace: Workspace, cases: Sequence[LoadCase], error: float) -> tuple[StifferDrive, ...]:
    """What each drive that gives would bring if it were stiffer by a tenth, the links kept; `error` is that before (m).

    Of first order this is also what a new optimum would gain, for at an optimum the links' own share vanishes.
    """
    drives: list[StifferDrive] = []
    for joint in range(arm.size):
        compliance = drive_compliance(arm, joint)
        if compliance <= 0.0:
            continue
        stiffened = with_compliance(arm, joint, -compliance * STIFFER / (1.0 + STIFFER))
        drives.append(StifferDrive(joint + 1, compliance, worst_error(stiffened, workspace, cases) - error))
    return tuple(drives)


def _mass_price(result: OptimizationResult) -> float | None:
    """What 1 kg more of links would change of the worst error, m."""
    if result.minimize != "max_error":
        return None
    prices = [limit.price for limit in result.binding if limit.name in ("mass", "total_mass")]
    return 1e-3 * min(prices) if prices else 0.0


def _carried_over(arm: Arm, corrected: Arm) -> tuple[str, ...]:
    """Findings that belong to the links as built; a link of another shape or material need not have them."""
    new = [entry for entry in corrected.effects if entry not in arm.effects]
    return tuple(dict.fromkeys(entry.effect for entry in new if EFFECTS[entry.effect].belongs_to_link))


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
    sentences = [
        f"The old optimum was promised {mm(redesign.promised)} and really has {mm(redesign.had)}{compared}.",
        _gain(redesign),
        _decided(redesign),
        drive_sentence(redesign),
    ]
    if redesign.carried_over:
        names = ", ".join(effect_title(effect) for effect in redesign.carried_over)
        sentences.append(f"Found on the links as built, and taken to hold for other links as well: {names}.")
    return sentences


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
    return "Decided otherwise: " + "; ".join(decision_words(decision) for decision in redesign.decisions) + "."


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
        return f"{drive}. The links' mass has no price where it is what is minimised."
    if redesign.link_mass_price == 0.0:
        return f"{drive}. No limit on the mass binds, so heavier links would bring nothing."
    one = mm(redesign.link_mass_price, 3)
    more = best.change < redesign.link_mass_price
    verdict = "the stiffer drive is worth more" if more else "the stiffer links are worth more"
    return f"{drive}, 1 kg more of links by {one}: {verdict}."


def redesign_json(redesign: Redesign) -> dict[str, Any]:
    """A redesign for machines; errors in mm."""
    return {
        **fields(redesign, "problem=problem_file", "promised_mm", "had_mm", "has_mm", "carried_over"),
        "status": [redesign.old.status, redesign.new.status],
        "decisions": [_decision(decision) for decision in redesign.decisions],
        "stiffer_drives": [
            {**fields(drive, "joint", "compliance", "change_mm"), "stiffer_by": STIFFER} for drive in redesign.drives
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
