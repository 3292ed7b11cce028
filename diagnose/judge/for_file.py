"""Which names the arm file holds: verdict and file are two questions.

A form of unknown physics may be the better answer than names, and stands in no file. What names predict of readings
that they were not fitted to they predict all the same. So where a form is the answer, the file holds the names that
predict held-out readings best: those beside the form, those that fit best without it, or none where the arm as given
predicts them better.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwright.core.diagnose.answer.confirmation import Confirmed
from linkwright.core.diagnose.answer.sentences import mm
from linkwright.core.diagnose.fitting.held_out import hardest


@dataclass(frozen=True)
class ForFile:
    """What the arm file is written from: confirmed `names`, RMS lengths (m) that they (`held_out`) and the arm as given
    (`given`) leave of readings not fitted, and whether they are a fit in place of what the answer says."""

    names: Confirmed
    held_out: float
    given: float
    instead: bool

    def note(self) -> str | None:
        """What is said where the file holds other names than the answer; None where it holds the same."""
        if not self.instead:
            return None
        labels = [self.names.label(member) for member in self.names.members]
        if not labels:
            return (
                "The written arm file is the arm as given. No named cause predicts readings better that were not "
                "fitted."
            )
        listed = labels[0] if len(labels) == 1 else f"{', '.join(labels[:-1])} and {labels[-1]}"
        return (
            f"The written arm file holds {listed}. This is a fit, not the causes. It leaves {mm(self.held_out)} of "
            f"readings not fitted, the arm as given {mm(self.given)}."
        )


def for_file(names: Confirmed) -> ForFile:
    """What the arm file is written from, by what names predict of readings not fitted."""
    beside = names.rms_held_out_of_file() if names.members or names.outside else np.inf
    given = hardest(names.held_out).rms([0])
    if names.named is None or not names.forms:
        return ForFile(names, beside, given, instead=False)
    best = ForFile(names, beside, given, instead=False)
    if names.named.without_forms:
        alone = names.of_the_library(names.named.without_forms)
        held_out = hardest(alone.held_out).rms()
        if alone.members and held_out < best.held_out:
            same = {alone.place(k) for k in range(len(alone.members))} == {
                names.place(k) for k in range(len(names.members))
            }
            best = ForFile(alone, held_out, given, instead=not same)
    if names.members and best.held_out >= given:
        best = ForFile(names.of_the_library(()), given, given, instead=True)
    return best
