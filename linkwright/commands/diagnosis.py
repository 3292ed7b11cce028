"""The commands that diagnose: what a model leaves out, what changed, what to record, and what to do against it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from linkwright.core.units.quantities import InputError
from linkwright.output.files import REPORT, RESULT, check_target

from .made import Made, Out, Targets

DIAGNOSIS, RECORDING = "linkwright.api.diagnosis", "linkwright.api.recording"


class Diagnose(Made):
    """`diagnose`: its folder holds files of several arms' own."""

    def claim(self, folder: Path) -> None:
        """As a diagnosis claims it."""
        from linkwright.output.diagnosis_folder import claim_diagnosis

        claim_diagnosis(folder)


class Compensate(Made):
    """`compensate`: a table of any kind."""

    def checked(self, targets: Targets, words: dict[str, Any], inputs: Sequence[Path]) -> Targets:
        """Parquet too can be written."""
        from linkwright.output.table_file import check_table

        found = super().checked(targets, words, inputs)
        check_table(targets.out)
        return found


class Simulate(Made):
    """`simulate`: settings are written beside the recording."""

    def checked(self, targets: Targets, words: dict[str, Any], inputs: Sequence[Path]) -> Targets:
        """Settings of somebody's own stay."""
        from linkwright.face.recording import settings_beside

        if words["poses"] is None and words["at"] is None:
            raise InputError("", "--poses", "is missing; say how many, or name a plan with --at")
        found = super().checked(targets, words, inputs)
        if targets.out is not None:
            others = [path for path in (targets.json, targets.markdown) if path is not None]
            check_target(settings_beside(targets.out), *inputs, *others)
        return found


def commands() -> Mapping[str, Made]:
    """These commands by name."""
    recording = Out("The recording to write, a CSV file.", (), beside=True, required=True)
    plan = Out("The plan: a recording whose tip is still blank.", (), beside=True)
    table = Out("Write the table: .csv, .parquet, .md or .tex.", ())
    made = (
        Diagnose("diagnose", DIAGNOSIS, doing="beginning", out=Out(), pdf=True),
        Made("compare", DIAGNOSIS, doing="beginning"),
        Made("predict", DIAGNOSIS, doing="predicting"),
        Compensate("compensate", DIAGNOSIS, doing="computing the table", out=table, tip=True),
        Made("plan", RECORDING, out=plan, tip=True, kept="this is the best plan so far"),
        Made("watch", DIAGNOSIS, doing="beginning", out=Out(own=(RESULT, REPORT)), pdf=True),
        Simulate("simulate", RECORDING, doing="simulating", out=recording, tip=True),
    )
    return {each.name: each for each in made}
