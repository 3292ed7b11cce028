"""A comparison of two recordings in words, and as a mapping for JSON."""

from __future__ import annotations

import math
from pathlib import PurePath
from typing import Any

from diagnose.compare import Change, Comparison
from diagnose.compare_places import Region

from .as_json import program_version
from .diagnosis_json import covered_json, in_unit, parameter_json, unit_of
from .diagnosis_words import effect_words, listed, quantity, value_words
from .words import figure, mm


def change_words(change: Change) -> str:
    """A change as a phrase: what, from and to."""
    what = f"{effect_words(change.effect, change.first.at)}, {change.first.parameter.replace('_', ' ')}"
    return f"{what} from {value_words(change.first)} to {value_words(change.second)}"


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
    if verdicts == ("none", "unknown") or (verdicts[1] == "unknown" and verdicts[0] != "unknown"):
        parts.append("The second holds a mismatch that nothing explains; the first does not.")
    elif verdicts[0] == "unknown" and verdicts[1] != "unknown":
        parts.append("The first held a mismatch that nothing explains; the second does not.")
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
        "effect": change.effect,
        "at": list(change.first.at),
        "parameter": change.first.parameter,
        "first": parameter_json(change.first),
        "second": parameter_json(change.second),
        "difference": in_unit(change.difference, kind),
        "unit": unit_of(kind),
        "ci95": [in_unit(end, kind) if math.isfinite(end) else None for end in change.interval],
        "p_value": change.p_value,
        "p_adjusted": change.adjusted,
        "changed": change.changed,
    }


def comparison_json(comparison: Comparison) -> dict[str, Any]:
    """What `compare --json` writes."""
    shared = comparison.shared
    pair = (comparison.first, comparison.second)
    return {
        "made_by": f"linkwright compare {program_version()}",
        "arm": comparison.first.arm.name,
        "sentence": comparison_sentence(comparison),
        "recordings": [
            {
                "file": PurePath(each.recording.file).name,
                "rows": each.recording.size,
                "verdict": each.verdict,
                "sentence": each.sentence,
                "noise_floor_mm": None if each.noise_floor is None else 1e3 * each.noise_floor,
                "rms_before_mm": 1e3 * each.rms_before,
                "rms_after_mm": 1e3 * each.rms_after,
                "rms_common_model_mm": 1e3 * left,
            }
            for each, left in zip(pair, comparison.unexplained, strict=True)
        ],
        "changes": [_change(each) for each in comparison.changes],
        "shared_poses": None
        if shared is None
        else {
            "count": shared.count,
            "rms_mm": [1e3 * shared.first, 1e3 * shared.second],
            "moved_mm": 1e3 * shared.moved,
            "by_chance_mm": None if shared.by_chance is None else 1e3 * shared.by_chance,
        },
        "regions": [
            {
                "lower_mm": [1e3 * value for value in each.lower],
                "upper_mm": [1e3 * value for value in each.upper],
                "rms_mm": [1e3 * each.first, 1e3 * each.second],
                "rows": list(each.counts),
            }
            for each in comparison.regions
        ],
        "iso_figures": [[covered_json(one), covered_json(other)] for one, other in comparison.figures],
        "notes": list(comparison.notes),
    }
