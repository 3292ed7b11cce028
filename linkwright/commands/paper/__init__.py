"""`linkwright tables`, `linkwright figures` and `linkwright seam`: the paper's, beside the truth."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from linkwright.commands.made import Made, Out
from linkwright.output.files import REPORT, RESULT

from .tables import TABLES, Tables

HOME = "linkwright.api.paper"
FIGURES = (RESULT, REPORT, *(f"figure-{number}.csv" for number in range(5, 10)))

NOTHING = "Nothing is written without --out DIR or --json FILE."


class Figures(Made):
    """`figures`: their titles and remarks are shown; the pictures are written."""

    def answer(self, result: Any) -> None:
        """The titles and what is remarked."""
        from linkwright.screen.console import console

        screen = console()
        for each in result.figures:
            screen.print(f"Figure {each.number}: {each.title}", style="bold")
            for remark in each.remarks:
                screen.print(f"  {remark}")


def commands() -> Mapping[str, Made]:
    """These commands by name."""
    folder = Out("Write report.html, result.json and a CSV file per figure there.", FIGURES)
    plain: Any = {"markdown": False, "catalogue": False}
    drawing: Any = {"doing": "computing the paper's figures", "out": folder, "unwritten": NOTHING}
    made = (
        Tables("tables", HOME, also=TABLES, **plain),
        Figures("figures", HOME, **drawing, **plain),
        Made("seam", HOME, doing="following the seam", tip=True),
    )
    return {each.name: each for each in made}
