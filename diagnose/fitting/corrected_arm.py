"""The arm file with the findings in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from types import MappingProxyType

from arm.chain.chain import Arm, EffectEntry
from arm.effects import EFFECTS
from diagnose.patterns.library import Candidate
from diagnose.rules.fitting_rules import FittingRules
from diagnose.rules.rules import RULES

from .refit import Refit


def corrected_arm(arm: Arm, fitted: Refit, *, rules: FittingRules = RULES.fitting) -> tuple[Arm, tuple[str, ...]]:
    """The arm with each finding as an entry of its `effects`, and sentences on what the file cannot carry.

    Physics that the file left out and that came out whole is no longer left out.
    """
    entries = list(arm.effects)
    left_out = set(arm.leave_out)
    notes: list[str] = []
    for term, parameters in zip(fitted.terms, fitted.parameters, strict=True):
        candidate = term.candidate
        if candidate.outside:
            continue
        if candidate.share:
            share = float(term.sizes[0])
            if abs(share - 1.0) <= rules.whole:
                left_out.discard(candidate.effect)
            else:
                notes.append(
                    f"The corrected arm still leaves out {candidate.effect}: {share:.2g} times what the file's data "
                    "give would fit, which no entry of the file can say."
                )
            continue
        if len(term.sizes) != len(candidate.sizes):
            drive = candidate.at[0] + 1
            told = next((each for each in parameters if each.parameter == candidate.sizes[0]), None)
            if told is None:
                notes.append(
                    f"The corrected arm lacks the compliance of drive {drive}: with links of unknown mass only its "
                    "product with their weight is known."
                )
                continue
            values = MappingProxyType({told.parameter: told.value})
            entries.append(EffectEntry(candidate.effect, (drive,), values))
            notes.append(
                f"The corrected arm has the compliance of drive {drive} as the known loads show it; how far the drive "
                "sags under the links' own weight it cannot say while their masses are unknown."
            )
            continue
        entries.append(as_entry(candidate, term.sizes.tolist()))
    return replace(arm, effects=tuple(entries), leave_out=frozenset(left_out)), tuple(notes)


def as_entry(candidate: Candidate, sizes: Sequence[float]) -> EffectEntry:
    """A candidate of the library at some sizes as an entry of an arm's `effects`."""
    values = dict(zip(candidate.sizes, sizes, strict=True))
    # A shape of nought is what the file means anyway, unless its default is another.
    defaults = {parameter.name: parameter.default for parameter in EFFECTS[candidate.effect].shapes}
    shapes = {name: value for name, value in candidate.shapes.items() if value > 0.0 or defaults[name] != 0.0}
    return EffectEntry(candidate.effect, candidate.numbers, MappingProxyType({**values, **shapes}))
