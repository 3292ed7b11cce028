"""What changed between two motion logs of one arm."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from linkwright.core.diagnose.compare.compare import Change
from linkwright.core.diagnose.motion.result import MotionDiagnosis, MotionFinding
from linkwright.core.diagnose.motion.sentences import nothing_else
from linkwright.core.diagnose.motion.uses.compare import MotionComparison as MotionComparisonResult
from linkwright.core.diagnose.motion.uses.compare import compare_motion
from linkwright.core.diagnose.options import Options
from linkwright.face.arm import Arm
from linkwright.face.planning.comparison import (
    change_json,
    change_words,
    changed_sentences,
    changes_frame,
    changes_table,
)
from linkwright.face.progress import Progress
from linkwright.face.result import Result, drawn
from linkwright.json.fields import fields
from linkwright.json.motion import OBSERVES
from linkwright.results.diagnoses.words import quantity, verdict_words
from linkwright.results.document import Description, Lines, Section, Table, count, section, table
from linkwright.results.motion.words import finding_words, torque, torque_unit

from .log import Log

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go


def comparison_sentence(result: MotionComparisonResult) -> str:
    """What changed, plainly: what one log alone has first, then what else differs beyond doubt."""
    alone = [item for item in result.together.findings if item.recording]
    stepping = {(item.effect, item.at) for item in alone}
    rest = [change for change in result.changes if (change.effect, change.first.at) not in stepping]
    parts = [f"Changed: {_more_words(item, result.changes)}." for item in alone]
    if rest and (not alone or any(change.changed for change in rest)):
        parts += changed_sentences(rest)
    if not parts:
        sentence = "cannot say whether anything changed" if result.together.verdict == "insufficient_data" else ""
        parts = [f"The logs {sentence}." if sentence else "Nothing in the library was named in either log."]
    if result.together.beyond:
        parts = [item for item in parts if not item.startswith("Nothing else that was fitted")]
        parts.append(nothing_else(result.together.beyond))
    if result.together.verdict == "unknown":
        parts.append("Together they hold a mismatch that nothing explains.")
    return " ".join(parts)


def _more_words(finding: MotionFinding, changes: Sequence[Change]) -> str:
    """What one log alone has, and how much more of it; from and to where the other has something of it too."""
    if not finding.parameters:
        return finding_words(finding)
    size = finding.parameters[0]
    for change in changes:
        both = [item.interval for item in (change.first, change.second)]
        same = (change.effect, change.first.at, change.first.parameter) == (finding.effect, finding.at, size.parameter)
        if same and all(low > 0.0 or high < 0.0 for low, high in both):
            return change_words(change)
    more = f"{quantity(abs(size.value), size.kind, 3)} {'more' if size.value > 0.0 else 'less'}"
    return f"{finding_words(finding)}, {size.parameter.replace('_', ' ')} {more}"


def describe(result: MotionComparisonResult) -> Description:
    """What changed between two motion logs."""
    sentence, together = comparison_sentence(result), result.together
    pair = together.of_logs
    rows = [
        ("samples", *(count(item.samples) for item in pair)),
        ("RMS of the mismatch", *(torque(item.rms_before) for item in pair)),
        ("left by what was found in both", *(torque(item.rms_after) for item in pair)),
        ("left with sizes of its own", *(torque(value) for value in result.left)),
    ]
    items: list[Section] = [section("Both logs", table(("", "first", "second"), rows))]
    if result.changes:
        items.append(section("What was fitted", changes_table(result.changes)))
    if together.beyond:
        items.append(section("By joint", _by_joint(together)))
    sentences = (f"Both were diagnosed together: {verdict_words(together.verdict)}.", *together.notes)
    items.append(section("Notes", Lines(sentences)))
    name = together.arm.name
    return Description(f"{name}: what changed between two motion logs", sentence, tuple(items), sentence.split(". ")[0])


def _by_joint(together: MotionDiagnosis) -> Table:
    """What differs at each joint, and what else may."""
    differs = [item for item in together.findings if item.recording]
    rows = [
        (
            count(joint + 1),
            *(torque(item.rms_explained[joint], torque_unit(together.arm, joint + 1)) for item in differs),
            torque(beyond, torque_unit(together.arm, joint + 1)),
        )
        for joint, beyond in enumerate(together.beyond)
    ]
    return table(("joint", *(finding_words(item) for item in differs), "anything else, at most"), rows)


@dataclass(frozen=True, repr=False)
class MotionComparison(Result):
    """What changed between two motion logs of one arm; `found` holds everything in SI."""

    _command = "compare"
    _describe = staticmethod(describe)

    arm: Arm
    logs: tuple[Log, Log]
    found: MotionComparisonResult

    @property
    def sentence(self) -> str:
        """What changed, plainly."""
        return comparison_sentence(self.found)

    @property
    def changes(self) -> pd.DataFrame:
        """A row for each size of the findings, in both logs, in `unit`; `changed` where beyond doubt."""
        return changes_frame(self.found.changes)

    def plot(self) -> go.Figure:
        """The RMS mismatch of both logs, before anything is explained and after, N*m."""
        pair = self.found.together.of_logs
        bars = {"mismatch": [item.rms_before for item in pair], "not explained": list(self.found.left)}
        return drawn(["before", "after"], bars, "", "RMS in N*m", mode="bar")

    def _content(self) -> Mapping[str, Any]:
        comparison = self.found
        logs = [
            {**fields(log, "name", "file", "samples", "rms_before", "rms_after"), "rms_own": left}
            for log, left in zip(comparison.together.of_logs, comparison.left, strict=True)
        ]
        return {
            "arm": comparison.together.arm.name,
            **OBSERVES,
            "sentence": self.sentence,
            "verdict": comparison.together.verdict,
            "logs": logs,
            "differs_beyond": list(comparison.together.beyond),
            "changes": [change_json(change) for change in comparison.changes],
            "notes": list(comparison.together.notes),
        }

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {"Changes": self.changes}


def compared_motion(arm: Arm, logs: Sequence[Log], options: Options, tell: Progress) -> MotionComparison:
    """Two logs diagnosed together, and each fitted with the findings."""
    first, second = logs
    return MotionComparison(arm, (first, second), compare_motion(arm.model, first.found, second.found, options, tell))
