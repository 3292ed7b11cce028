"""A comparison of two recordings described: what changed, in a sentence first; and as a mapping for JSON."""

from __future__ import annotations

from pathlib import PurePath
from typing import Any

from linkwright.core.diagnose.compare.compare import Change, Comparison
from linkwright.core.diagnose.compare.places import Region
from linkwright.json.diagnosis import covered_json, in_unit, parameter_json, unit_of
from linkwright.json.fields import fields, in_mm
from linkwright.results.document import Description, Lines, Section, Table, Value, count, length, section, table
from linkwright.results.figures_in_words import figure, mm
from linkwright.version import program_version

from .words import (
    covered,
    effect_words,
    listed,
    measured,
    probability,
    quantity,
    value,
    verdict_words,
)


def describe(comparison: Comparison) -> Description:
    """What changed between two recordings."""
    sentence = comparison_sentence(comparison)
    regions = [
        (
            region_words(each),
            Value(f"{each.counts[0]}, {each.counts[1]}"),
            length(each.first, 3),
            length(each.second, 3),
        )
        for each in comparison.regions
    ]
    figures = [(one.symbol, covered(one), covered(other), one.standard, one.name) for one, other in comparison.figures]
    headings = ("region", "readings", "RMS, first", "RMS, second")
    standards = ("figure", "first", "second", "standard", "")
    found: list[Section] = [section("Both recordings", _both(comparison))]
    if comparison.changes:
        found.append(section("What was fitted", _changes(comparison)))
    if regions:
        found.append(section("By region of the workspace", table(headings, regions)))
    if figures:
        found.append(section("In the words of the standards", table(standards, figures)))
    if comparison.notes:
        found.append(section("Notes", Lines(comparison.notes)))
    name = comparison.first.arm.name
    return Description(f"{name}: what changed between two recordings", sentence, tuple(found), sentence.split(". ")[0])


def _both(comparison: Comparison) -> Table:
    pair = (comparison.first, comparison.second)
    rows: list[tuple[str | Value, ...]] = [
        ("verdict", *(verdict_words(each.verdict, short=True) for each in pair)),
        ("readings", *(count(each.recording.size) for each in pair)),
        ("noise floor", *(length(each.noise_floor, 3) for each in pair)),
        ("RMS of the mismatch", *(length(each.rms_before, 3) for each in pair)),
        ("left by the common model", *(length(each, 3) for each in comparison.unexplained)),
    ]
    shared = comparison.shared
    if shared is not None:
        rows.append((f"at {shared.count} shared poses", length(shared.first, 3), length(shared.second, 3)))
    return table(("", "first", "second"), rows)


def _changes(comparison: Comparison) -> Table:
    rows = [
        (
            f"{effect_words(each.effect, each.first.at)}: {each.first.parameter.replace('_', ' ')}",
            measured(each.first),
            measured(each.second),
            Value(difference_words(each)),
            probability(each.adjusted),
            "changed" if each.changed else "",
        )
        for each in comparison.changes
    ]
    return table(("what", "first (95 % interval)", "second", "change", "p, adjusted", ""), rows)


def change_words(change: Change) -> str:
    """A change as a phrase: what, from and to."""
    what = f"{effect_words(change.effect, change.first.at)}, {change.first.parameter.replace('_', ' ')}"
    return f"{what} from {value(change.first).text} to {value(change.second).text}"


def difference_words(change: Change) -> str:
    """The difference with its unit and sign."""
    like = max(abs(change.first.value), abs(change.second.value), abs(change.difference))
    words = quantity(change.difference, change.first.kind, 3, like or None)
    return f"+{words}" if change.difference > 0.0 else words


def comparison_sentence(comparison: Comparison) -> str:
    """What changed, plainly."""
    changed = [change_words(each) for each in comparison.changes if each.changed]
    verdicts = (comparison.first.verdict, comparison.second.verdict)
    if changed:
        parts = [f"Changed: {listed(changed)}."]
        if len(changed) < len(comparison.changes):
            parts.append("Nothing else that was fitted changed beyond doubt.")
    elif comparison.changes:
        parts = ["Nothing that was fitted changed beyond doubt."]
    elif "insufficient_data" in verdicts:
        parts = ["The recordings cannot say whether anything changed."]
    else:
        parts = ["Nothing in the library was named in either recording."]
    open_ = [each.unexplained for each in (comparison.first, comparison.second)]
    if any(open_):
        which = "Both hold" if all(open_) else "The first held" if open_[0] else "The second holds"
        other = f"; the {'second' if open_[0] else 'first'} does not"
        # Of a recording that says nothing nobody can say that.
        unsaid = all(open_) or "insufficient_data" in verdicts
        parts.append(f"{which} a mismatch that nothing explains{'' if unsaid else other}.")
    shared = comparison.shared
    if shared is not None:
        poses = "the pose" if shared.count == 1 else f"the {shared.count} poses"
        moved = f"At {poses} that both hold, the tip lies {mm(shared.moved, 3)} (RMS) from where it lay"
        chance = "" if shared.by_chance is None else f"; noise alone would make that {mm(shared.by_chance, 3)}"
        parts.append(f"{moved}{chance}.")
    return " ".join(parts)


def region_words(region: Region) -> str:
    """A box of the workspace."""
    spans = [
        f"{axis} {figure(round(1e3 * low))} to {figure(round(1e3 * high))}"
        for axis, low, high in zip("xyz", region.lower, region.upper, strict=False)
    ]
    return f"{', '.join(spans)} mm"


def _change(change: Change) -> dict[str, Any]:
    kind = change.first.kind
    return {
        **fields(change, "effect", "p_value", "p_adjusted=adjusted", "changed"),
        **fields(change.first, "at", "parameter"),
        "first": parameter_json(change.first),
        "second": parameter_json(change.second),
        "difference": in_unit(change.difference, kind),
        "unit": unit_of(kind),
        "ci95": [in_unit(end, kind) for end in change.interval],
    }


def comparison_json(comparison: Comparison) -> dict[str, Any]:
    """What `compare --json` writes."""
    shared, pair = comparison.shared, (comparison.first, comparison.second)
    told = ("verdict", "sentence", "noise_floor_mm", "rms_before_mm", "rms_after_mm")
    return {
        "made_by": f"linkwright compare {program_version()}",
        "arm": comparison.first.arm.name,
        "sentence": comparison_sentence(comparison),
        "recordings": [
            {
                "file": PurePath(each.recording.file).name,
                "rows": each.recording.size,
                **fields(each, *told),
                "rms_common_model_mm": in_mm(left),
            }
            for each, left in zip(pair, comparison.unexplained, strict=True)
        ],
        "changes": [_change(each) for each in comparison.changes],
        "shared_poses": None
        if shared is None
        else {**fields(shared, "count", "moved_mm", "by_chance_mm"), "rms_mm": in_mm((shared.first, shared.second))},
        "regions": [
            {**fields(each, "lower_mm", "upper_mm", "rows=counts"), "rms_mm": in_mm((each.first, each.second))}
            for each in comparison.regions
        ],
        "iso_figures": [[covered_json(one), covered_json(other)] for one, other in comparison.figures],
        "notes": comparison.notes,
    }
