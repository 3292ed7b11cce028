"""What changed between two motion logs of one arm."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from linkwright.core.diagnose.motion.uses.compare import MotionComparison as MotionComparisonResult
from linkwright.core.diagnose.motion.uses.compare import compare_motion
from linkwright.core.diagnose.options import Options
from linkwright.face.arm import Arm
from linkwright.face.planning.comparison import change_json, changed_sentences, changes_frame, changes_table
from linkwright.face.progress import Progress
from linkwright.face.result import Result, drawn
from linkwright.json.fields import fields
from linkwright.json.motion import OBSERVES
from linkwright.results.diagnoses.words import verdict_words
from linkwright.results.document import Description, Lines, Section, count, section, table
from linkwright.results.motion.words import torque

from .log import Log

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go


def comparison_sentence(result: MotionComparisonResult) -> str:
    """What changed, plainly."""
    parts = changed_sentences(result.changes)
    if not result.changes:
        sentence = "cannot say whether anything changed" if result.together.verdict == "insufficient_data" else ""
        parts = [f"The logs {sentence}." if sentence else "Nothing in the library was named in either log."]
    if result.together.verdict == "unknown":
        parts.append("Together they hold a mismatch that nothing explains.")
    return " ".join(parts)


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
    sentences = (f"Both were diagnosed together: {verdict_words(together.verdict)}.", *together.notes)
    items.append(section("Notes", Lines(sentences)))
    name = together.arm.name
    return Description(f"{name}: what changed between two motion logs", sentence, tuple(items), sentence.split(". ")[0])


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
            "changes": [change_json(change) for change in comparison.changes],
            "notes": list(comparison.together.notes),
        }

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {"Changes": self.changes}


def compared_motion(arm: Arm, logs: Sequence[Log], options: Options, tell: Progress) -> MotionComparison:
    """Two logs diagnosed together, and each fitted with the findings."""
    first, second = logs
    return MotionComparison(arm, (first, second), compare_motion(arm.model, first.found, second.found, options, tell))
