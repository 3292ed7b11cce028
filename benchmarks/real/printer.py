"""A printer's frame warming up: is the expansion of the frame alone the explanation?"""

from __future__ import annotations

from collections.abc import Callable

from benchmarks.real.data import PRINTER, nominal, read, recording_file
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.result import Diagnosis
from linkwright.core.diagnose.steps.diagnosis import diagnose

FILES = {
    "2021-06-12": ("frame_exp_quant_v3_2021-06-12_12-54-36-mvieleers_V2.1253.csv", "recording"),
    "2021-06-13": ("frame_exp_quant_v3_2021-06-13_05-41-53.csv", "recording-2021-06-13"),
}
EXPANSION = "thermal_expansion"


def warmed(day: str, *, expansion_only: bool = False) -> Diagnosis:
    """A day's diagnosis; `expansion_only` takes everything but the frame's expansion out of the library."""
    file, how = FILES[day]
    recording = read(PRINTER, recording_file(PRINTER, file), how)
    without = frozenset(EFFECTS) - {EXPANSION} if expansion_only else frozenset[str]()
    return diagnose(nominal(PRINTER), recording, Options(without=without))


def refused(found: Diagnosis) -> bool:
    """Whether the frame's expansion alone is not what was named."""
    alone = len(found.findings) == 1 and found.findings[0].effect == EXPANSION
    return not (alone and found.verdict in ("named", "alias_class"))


def evaluate(tell: Callable[[str], None] = print) -> None:
    """Print what is said of each day."""
    tell("## Printer's frame\n")
    for day in FILES:
        for only in (False, True):
            said = warmed(day, expansion_only=only)
            asked = "with nothing but thermal expansion in the library" if only else "with the whole library"
            tell(f"{day}, {asked}: {said.verdict}. {said.sentence}")
            why = [f"{form.reason}" for form in said.rejected_forms if form.effect == EXPANSION]
            tell(f"  expansion alone refused: {refused(said)}{'; ' + '; '.join(why) if why else ''}\n")
