"""What changed between two recordings of one arm."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from linkwright.core.diagnose.compare.compare import Change, compare
from linkwright.core.diagnose.compare.compare import Comparison as ComparisonResult
from linkwright.core.diagnose.compare.places import Region
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.result import Diagnosis
from linkwright.core.diagnose.steps.diagnosis import diagnose as diagnosed
from linkwright.core.units.lists import listed
from linkwright.core.units.quantities import InputError
from linkwright.face.arm import Arm
from linkwright.face.progress import Progress
from linkwright.face.recording import Recording
from linkwright.face.result import Result, drawn
from linkwright.json.diagnosis import covered_json
from linkwright.json.fields import fields, in_mm
from linkwright.json.parameters import in_unit, parameter_json, unit_of
from linkwright.output.table_file import frame
from linkwright.results.diagnoses.words import (
    covered,
    effect_words,
    measured,
    probability,
    quantity,
    value,
    verdict_words,
)
from linkwright.results.document import Description, Lines, Section, Table, Value, count, length, section, table
from linkwright.results.figures_in_words import figure, mm

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go


def describe(comparison: ComparisonResult) -> Description:
    """What changed between two recordings."""
    sentence = comparison_sentence(comparison)
    regions = [
        (
            region_words(region),
            Value(f"{region.counts[0]}, {region.counts[1]}"),
            length(region.first, 3),
            length(region.second, 3),
        )
        for region in comparison.regions
    ]
    figures = [(one.symbol, covered(one), covered(other), one.standard, one.name) for one, other in comparison.figures]
    headings = ("region", "readings", "RMS, first", "RMS, second")
    standards = ("figure", "first", "second", "standard", "")
    sections: list[Section] = [section("Both recordings", _both(comparison))]
    if comparison.changes:
        sections.append(section("What was fitted", changes_table(comparison.changes)))
    if regions:
        sections.append(section("By region of the workspace", table(headings, regions)))
    if figures:
        sections.append(section("In the words of the standards", table(standards, figures)))
    if comparison.notes:
        sections.append(section("Notes", Lines(comparison.notes)))
    name = comparison.first.arm.name
    return Description(
        f"{name}: what changed between two recordings", sentence, tuple(sections), sentence.split(". ")[0]
    )


def _both(comparison: ComparisonResult) -> Table:
    pair = (comparison.first, comparison.second)
    rows: list[tuple[str | Value, ...]] = [
        ("verdict", *(verdict_words(item.verdict, short=True) for item in pair)),
        ("readings", *(count(item.recording.size) for item in pair)),
        ("noise floor", *(length(item.noise_floor, 3) for item in pair)),
        ("RMS of the mismatch", *(length(item.rms_before, 3) for item in pair)),
        ("left by the common model", *(length(item, 3) for item in comparison.unexplained)),
    ]
    shared = comparison.shared
    if shared is not None:
        rows.append((f"at {shared.count} shared poses", length(shared.first, 3), length(shared.second, 3)))
    return table(("", "first", "second"), rows)


def changes_table(changes: Sequence[Change]) -> Table:
    """Each size in both recordings, and whether it changed."""
    rows = [
        (
            f"{effect_words(change.effect, change.first.at)}: {change.first.parameter.replace('_', ' ')}",
            measured(change.first),
            measured(change.second),
            Value(difference_words(change)),
            probability(change.adjusted),
            "changed" if change.changed else "",
        )
        for change in changes
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


def comparison_sentence(comparison: ComparisonResult) -> str:
    """What changed, plainly."""
    verdicts = (comparison.first.verdict, comparison.second.verdict)
    if comparison.changes:
        parts = changed_sentences(comparison.changes)
    elif "insufficient_data" in verdicts:
        parts = ["The recordings cannot say whether anything changed."]
    else:
        parts = ["Nothing in the library was named in either recording."]
    open_ = [item.unexplained for item in (comparison.first, comparison.second)]
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


def changed_sentences(changes: Sequence[Change]) -> list[str]:
    """Which of the sizes that were fitted changed."""
    changed = [change_words(change) for change in changes if change.changed]
    if not changed:
        return ["Nothing that was fitted changed beyond doubt."]
    rest = ["Nothing else that was fitted changed beyond doubt."] if len(changed) < len(changes) else []
    return [f"Changed: {listed(changed)}.", *rest]


def region_words(region: Region) -> str:
    """A box of the workspace."""
    spans = [
        f"{axis} {figure(round(1e3 * low))} to {figure(round(1e3 * high))}"
        for axis, low, high in zip("xyz", region.lower, region.upper, strict=False)
    ]
    return f"{', '.join(spans)} mm"


@dataclass(frozen=True, repr=False)
class Comparison(Result):
    """What changed between two recordings of one arm; `found` holds everything in SI."""

    _command = "compare"
    _describe = staticmethod(describe)

    arm: Arm
    found: ComparisonResult

    @property
    def sentence(self) -> str:
        """What changed, plainly."""
        return comparison_sentence(self.found)

    @property
    def changes(self) -> pd.DataFrame:
        """A row for each parameter of the common model in both recordings, in `unit`; `changed` where beyond doubt."""
        return changes_frame(self.found.changes)

    def plot(self) -> go.Figure:
        """The RMS mismatch of both recordings, before anything is explained and after, mm."""
        pair = (self.found.first, self.found.second)
        bars = {
            "mismatch": in_mm([item.rms_before for item in pair]),
            "not explained": in_mm(self.found.unexplained),
        }
        return drawn(["before", "after"], bars, "", "RMS in mm", mode="bar")

    def _content(self) -> Mapping[str, Any]:
        comparison, pair = self.found, (self.found.first, self.found.second)
        shared, shown = comparison.shared, ("verdict", "sentence", "noise_floor_mm", "rms_before_mm", "rms_after_mm")
        recordings = [
            {
                "file": PurePath(item.recording.file).name,
                **fields(item, "rows=recording.size", *shown),
                "rms_common_model_mm": in_mm(left),
            }
            for item, left in zip(pair, comparison.unexplained, strict=True)
        ]
        return {
            "arm": comparison.first.arm.name,
            "sentence": self.sentence,
            "recordings": recordings,
            "changes": [change_json(change) for change in comparison.changes],
            "shared_poses": None
            if shared is None
            else {
                **fields(shared, "count", "moved_mm", "by_chance_mm"),
                "rms_mm": in_mm((shared.first, shared.second)),
            },
            "regions": [
                {
                    **fields(region, "lower_mm", "upper_mm", "rows=counts"),
                    "rms_mm": in_mm((region.first, region.second)),
                }
                for region in comparison.regions
            ],
            "iso_figures": [[covered_json(one), covered_json(other)] for one, other in comparison.figures],
            **fields(comparison, "notes"),
        }

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {"Changes": self.changes}


def changes_frame(changes: Sequence[Change]) -> pd.DataFrame:
    """A row for each size in both recordings."""
    columns = ["effect", "at", "parameter", "before", "after", "difference", "low", "high", "unit", "changed"]
    rows: list[tuple[Any, ...]] = []
    for change in changes:
        kind = change.first.kind
        figures = (change.first.value, change.second.value, change.difference, *change.interval)
        shown = [in_unit(value, kind) for value in figures]
        rows.append((change.effect, change.first.at, change.first.parameter, *shown, unit_of(kind), change.changed))
    return frame(rows, columns)


def change_json(change: Change) -> dict[str, Any]:
    """A size in both recordings for machines."""
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


def compared(arm: Arm, both: Sequence[Recording], options: Options, tell: Progress) -> Comparison:
    """Both recordings diagnosed, then fitted with one common model. Raises `InputError` for those of two tips."""
    tips = [item.found.branch for item in both]
    if tips[0] != tips[1]:
        message = f"are of different tips ({' and '.join(tips)}); compare two recordings of one, diagnose takes both"
        raise InputError("", "recordings", message)
    diagnoses: list[Diagnosis] = []
    for number, read in enumerate(both):

        def half(text: str, share: float, done: int = number) -> None:
            tell(text, 0.5 * (done + share))

        diagnoses.append(diagnosed(arm.model, read.found, options, half))
    return Comparison(arm, compare(arm.model.on(tips[0]), *diagnoses))
