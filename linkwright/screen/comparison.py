"""Two recordings of one arm on the screen: what changed, in a sentence first."""

from __future__ import annotations

from rich.console import Console
from rich.table import Table

from diagnose.compare import Comparison
from linkwright.comparison_words import comparison_sentence, difference_words, region_words
from linkwright.diagnosis_words import (
    covered_words,
    effect_words,
    measured_words,
    p_words,
    verdict_words,
)
from linkwright.words import mm

from .console import table


def show_comparison(out: Console, comparison: Comparison) -> None:
    """Print a comparison."""
    out.print(comparison_sentence(comparison), style="bold", soft_wrap=True)
    out.print()
    out.print(_both(comparison))
    if comparison.changes:
        out.print()
        out.print(_changes(comparison))
    if comparison.regions:
        out.print()
        shown = table("region", "readings", "RMS, first", "RMS, second", numbers=(1, 2, 3))
        for each in comparison.regions:
            counts = f"{each.counts[0]}, {each.counts[1]}"
            shown.add_row(region_words(each), counts, mm(each.first, 3), mm(each.second, 3))
        out.print(shown)
    if comparison.figures:
        out.print()
        shown = table("figure", "first", "second", "standard", "", numbers=(1, 2))
        for one, other in comparison.figures:
            shown.add_row(one.symbol, covered_words(one), covered_words(other), one.standard, one.name)
        out.print(shown)
    if comparison.notes:
        out.print()
    for note in comparison.notes:
        out.print(note, soft_wrap=True)


def _both(comparison: Comparison) -> Table:
    one, other = comparison.first, comparison.second
    shown = table("", "first", "second", numbers=(1, 2))
    shown.add_row("verdict", *(verdict_words(each.verdict, short=True) for each in (one, other)))
    shown.add_row("readings", *(str(each.recording.size) for each in (one, other)))
    shown.add_row("noise floor", *(mm(each.noise_floor, 3) for each in (one, other)))
    shown.add_row("RMS of the mismatch", *(mm(each.rms_before, 3) for each in (one, other)))
    shown.add_row("left by the common model", *(mm(each, 3) for each in comparison.unexplained))
    shared = comparison.shared
    if shared is not None:
        shown.add_row(f"at {shared.count} shared poses", mm(shared.first, 3), mm(shared.second, 3))
    return shown


def _changes(comparison: Comparison) -> Table:
    headings = ("what", "first (95 % interval)", "second", "change", "p, adjusted", "")
    shown = table(*headings, numbers=(1, 2, 3, 4))
    for each in comparison.changes:
        name = f"{effect_words(each.effect, each.first.at)}: {each.first.parameter.replace('_', ' ')}"
        pair = (measured_words(each.first), measured_words(each.second))
        marked = "changed" if each.changed else ""
        p = p_words(each.adjusted)
        shown.add_row(name, *pair, difference_words(each), p, marked)
    return shown
