"""Rounding described: the design of sizes that can be had and its cost, or why there is none and what comes near."""

from __future__ import annotations

import math

from linkwright.core.optimize.result import KeptLimit, NotRounded, OptimizationResult, Rounded
from linkwright.core.units.quantities import format_quantity
from linkwright.json.design import objective_unit
from linkwright.report.pictures.sections import sections_grid

from . import design
from .document import Column, Paragraph, Picture, Section, Value, section, share, table
from .figures_in_words import lasted, percent, with_unit


def sections(result: OptimizationResult) -> list[Section]:
    """The rounded design, or the one that came near; nothing where none was asked for."""
    if result.rounded is not None:
        return [_made(result, result.rounded)]
    return [] if result.not_rounded is None else [_missed(result.not_rounded)]


def warnings(result: OptimizationResult) -> list[Paragraph]:
    """That the design, or a link of it, is not of sizes that can be had, though they were asked for."""
    if result.rounded is not None:
        return [Paragraph(f"not rounded: {item}; it stays as computed", "warning") for item in result.rounded.kept]
    missing = result.not_rounded
    if missing is None:
        return []
    text = f"not rounded to {sizes_words(missing.to, missing.length_step)}: {missing.reason}"
    return [Paragraph(f"{text}; this is the optimum as it is", "warning")]


def first_words(result: OptimizationResult) -> list[Paragraph]:
    """That the design shown is the rounded one, and its worst case; nothing where it is the optimum itself. What
    follows of bounds and prices is said of the optimum."""
    rounded = result.rounded
    if rounded is None:
        return []
    words = rounding_words(rounded)
    return [
        Paragraph(f"rounded to {words}: {rounding_headline(result, rounded)}", "strong"),
        Paragraph(design.as_sentence(design.bound_words(rounded.evaluation)), "under"),
    ]


def _made(result: OptimizationResult, rounded: Rounded) -> Section:
    limits = [
        (limit.text, limit_figure(limit, limit.before), limit_figure(limit, limit.after), share(limit.room, 3), "kept")
        for limit in rounded.limits
    ]
    headings = ("limit", "as computed", "rounded", Column("to spare", detail=True), "")
    return section(
        f"Rounded to {rounding_words(rounded)}",
        Paragraph(compared_words(rounded), "under"),
        Picture(lambda: sections_grid((("before", result.arm), ("after", rounded.arm)))),
        table(headings, limits) if limits else None,
        lead="Before and after rounding. arm.yaml holds the rounded design.",
    )


def _missed(missing: NotRounded) -> Section:
    """The design that breaks the limits least, and by how much."""
    words = sizes_words(missing.to, missing.length_step)
    title = f"Not rounded to {words}"
    if missing.nearest is None:
        return section(title, Paragraph(f"{missing.reason}."), lead="arm.yaml holds the optimum.")
    limits = [
        (limit.text, limit_figure(limit, limit.before), limit_figure(limit, limit.after), exceeded_words(limit))
        for limit in missing.limits
    ]
    rest = "no other of them breaks the limits less" if missing.proven else "others may break them less"
    nearest = f"the nearest design of {words} breaks a limit by {percent(missing.excess, 3)}; {rest}"
    return section(
        title,
        Paragraph(nearest, "strong"),
        design.links((("", missing.nearest),), 6),
        table(("limit", "optimum", "nearest", ""), limits),
        lead="arm.yaml holds the optimum. This is only what comes near.",
    )


def exceeded_words(limit: KeptLimit) -> str:
    """Whether a limit is kept, or by how much it is not."""
    if math.isnan(limit.exceeded):
        return "not known"
    return "kept" if limit.exceeded == 0.0 else f"broken by {percent(limit.exceeded, 3)}"


def rounding_words(rounded: Rounded) -> str:
    """What a design was rounded to, as a phrase."""
    return sizes_words(rounded.to, rounded.length_step)


def sizes_words(to: str, length_step: float | None) -> str:
    """Sizes that can be had, as a phrase."""
    sizes = "stock sizes" if to == "stock" else f"sizes in steps of {to}"
    if length_step is None:
        return sizes
    return f"{sizes} and lengths in steps of {format_quantity(length_step, 'length')}"


def rounding_headline(result: OptimizationResult, rounded: Rounded) -> str:
    """What rounding cost, as a phrase."""
    factor, unit = objective_unit(result.minimize, result.figures)
    named = "links" if result.minimize == "mass" else result.minimised.title
    before, after = (with_unit(factor * value, unit, 5) for value in (rounded.before, rounded.objective))
    change = rounded.objective / rounded.before - 1.0
    words = f"{percent(abs(change), 3)} {'more' if change >= 0.0 else 'less'}"
    mass = f"; links {with_unit(result.after.mass, 'kg')} computed, {with_unit(rounded.evaluation.mass, 'kg')} rounded"
    return f"{named} {before} as computed, {after} rounded ({words}){'' if result.minimize == 'mass' else mass}"


def compared_words(rounded: Rounded) -> str:
    """How the rounded design was found, as a phrase."""
    text = f"{'every' if rounded.exhaustive else 'not every'} combination of the nearest sizes"
    return f"the best of {rounded.compared} designs compared, {text} among them{lasted(rounded.seconds, ', in ')}"


def limit_figure(limit: KeptLimit, value: float) -> Value:
    """A figure (SI) that is limited, with its unit."""
    known = not math.isnan(value)
    return Value(format_quantity(value, limit.figure.kind, limit.figure.unit or None, digits=5) if known else "–")
