"""What an optimisation chose among: every combination's objective, what each choice costs, near ties, the price of
limits."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from types import MappingProxyType

from linkwright.core.optimize.result import BindingLimit, Candidate, OptimizationResult
from linkwright.json.design import objective_unit

from .document import BARS, Bars, Column, Item, Paragraph, Section, Table, Value, amount, section, share, table
from .figures_in_words import mm, percent, with_unit

MOST_CANDIDATES = 8


def objective_of(result: OptimizationResult, value: float | None, digits: int = 5, mark: str = "") -> Value:
    """A value of the objective in the unit that people read; a dash where there is none."""
    factor, unit = objective_unit(result.minimize, result.figures)
    return Value("–" if value is None else f"{mark}{with_unit(factor * value, unit, digits)}")


_COLOURS = MappingProxyType({"best": "after", "bounded out": "held"})
"""Of bars, by what came of a combination."""
_CUT = 5.0
"""How many times the best the longest bar is at most: one hopeless material shall not make all other bars alike."""


def _longest(values: Iterable[float | None], best: float) -> float:
    return min(max((abs(value) for value in values if value is not None), default=0.0), _CUT * abs(best))


def _bar(value: float | None, largest: float, colour: str) -> Bars:
    return Bars(((colour, 0.0 if value is None or not largest else abs(value) / largest),))


def candidates(result: OptimizationResult) -> Table | None:
    """Every combination that was looked at, best first, with bars of its objective; None where there was no choice."""
    if len(result.candidates) < 2:
        return None
    ranked = result.candidates
    bound = "≤ " if result.minimised.more_is_better else "≥ "
    some = "" if result.exhaustive else failed(result) or ", not all of them tried"
    if result.combinations > len(ranked):
        some = f" solved of {result.combinations:,}; {others(result)}"
    longest = _longest([item.objective for item in ranked], result.objective)
    rows = [
        (
            names_words(item.shapes),
            names_words(item.materials),
            objective_of(result, item.objective, mark=bound if item.outcome == "bounded out" else ""),
            item.outcome,
            _bar(item.objective, longest, _COLOURS.get(item.outcome, "before")),
        )
        for item in ranked
    ]
    title = f"{len(ranked)} combinations of shape and material{some}"
    rest = f"and {len(ranked) - MOST_CANDIDATES} more, in result.json, the best of them in the report"
    headings = ("shapes", "materials", "objective", "outcome", BARS)
    return table(headings, rows, first=MOST_CANDIDATES, title=title, rest=rest)


def costs(result: OptimizationResult) -> list[Section]:
    """What each shape and each material costs: the best combination that has it, against the best of all."""
    bound = "≤ " if result.minimised.more_is_better else "≥ "
    rows: list[tuple[str, Candidate]] = []
    for of in ("shapes", "materials"):
        best: dict[str, Candidate] = {}
        for item in result.candidates:
            for name in dict.fromkeys(getattr(item, of)):
                if name and item.objective is not None:
                    best.setdefault(name, item)
        rows += best.items() if len(best) > 1 else ()
    if not rows or not result.objective:
        return []
    worse = [abs((item.objective or 0.0) / result.objective - 1.0) for _, item in rows]
    longest = _longest(worse, (_CUT - 1.0) / _CUT)
    cells = [
        (
            name,
            objective_of(result, item.objective, mark=bound if item.outcome == "bounded out" else ""),
            share(loss),
            _bar(loss, longest, _COLOURS.get(item.outcome, "before")),
        )
        for (name, item), loss in zip(rows, worse, strict=True)
    ]
    lead = f"The best combination that has it. Bars end at {_CUT:g} times the best of all. Pale bars are bounds."
    shown = table(("shape or material", "objective", "worse by", BARS), cells, first=MOST_CANDIDATES)
    return [section("What each shape and material costs", shown, lead=lead, detail=True)]


def near_ties(result: OptimizationResult) -> list[Section]:
    """The combinations that come near the best."""
    if not result.near_ties and not result.near_ties_left:
        return []
    rows = [
        (
            names_words(tie.shapes),
            names_words(tie.materials),
            *((names_words(tie.actuators),) if result.drives else ()),
            objective_of(result, tie.objective),
            share(abs(tie.objective / result.objective - 1.0) if result.objective else 0.0),
            Value(mm(tie.max_error)),
            amount(tie.mass, "kg", 4),
            amount(tie.cost, "EUR", 4),
            amount(tie.first_frequency, "Hz", 4),
        )
        for tie in result.near_ties
    ]
    drives = ("actuators",) if result.drives else ()
    headings = ("shapes", "materials", *drives, "objective", "worse by", "error", "mass", "cost", "first frequency")
    rest = f"and {len(rows) - MOST_CANDIDATES} more, in result.json, the best of them in the report"
    ties = table(headings, rows, first=MOST_CANDIDATES, rest=rest) if rows else None
    rest_text = None
    if result.near_ties_left:
        rest_text = Paragraph(
            f"Up to {result.near_ties_left:,} more combinations could come within 3 % by their bounds. "
            "These were not solved."
        )
    return [section("Near ties", ties, rest_text, lead="Combinations within 3 % of the best, each solved to the end.")]


def others(result: OptimizationResult) -> str:
    """What is known of the combinations that were not solved."""
    if result.exhaustive:
        return "bounds leave out the others"
    if result.gap is None:
        return f"nothing is known of the others{failed(result)}"
    if not result.gap:
        return f"bounds leave out the others{failed(result)}"
    return f"none of the others is more than {percent(result.gap)} better{failed(result)}"


def failed(result: OptimizationResult) -> str:
    """On how many of the combinations the solver failed."""
    return f", but for {len(result.unsolved):,} on which the solver failed" if result.unsolved else ""


def binding(result: OptimizationResult) -> Item:
    """What holds the optimum back, and what one unit more of it would buy."""
    if result.listed:
        return Paragraph("Sections come from lists: between one and the next no limit has a price.")
    limits = result.binding
    if not limits:
        return Paragraph("No limit holds the design back.")
    factor, _ = objective_unit(result.minimize, result.figures)
    worth = [abs(item.price * item.limit / (factor * result.objective)) if result.objective else 0.0 for item in limits]
    rows = [
        (item.text, amount(item.value, item.unit, 5), price_words(item), share(0.01 * x), _bar(x, max(worth), "after"))
        for item, x in zip(limits, worth, strict=True)
    ]
    return table(("what binds", "has", "price", Column("objective per 1 %", detail=True), BARS), rows)


def price_words(limit: BindingLimit) -> str:
    """A limit's price as a sentence: what one unit more of it would buy."""
    one = f"one {_unit_name(limit.unit)} more" if limit.unit else "one more"
    # The price of one unit more is in the unit of the objective: 0.004 mm/kg is 0.004 mm for one kilogram.
    size = with_unit(abs(limit.price), limit.price_unit.removesuffix(f"/{limit.unit}"), 3)
    if limit.price == 0.0:
        return f"{one} would buy nothing"
    return f"{one} would buy {size}" if limit.price < 0.0 else f"{one} would cost {size}"


def _unit_name(unit: str) -> str:
    names = (("kg", "kilogram"), ("mm", "millimetre"), ("EUR", "euro"), ("Hz", "hertz"), ("m", "metre"))
    return dict(names).get(unit, unit)


def names_words(names: Sequence[str | None]) -> str:
    """Shapes or materials from the base out, of the links that have one; one name where all have the same."""
    shown = [name for name in names if name]
    return f"all {shown[0]}" if len(shown) > 1 and len(set(shown)) == 1 else ", ".join(shown) or "–"
