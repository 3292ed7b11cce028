"""The arm file with the findings in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from types import MappingProxyType

from arm.chain import Arm, EffectEntry

from .candidates import Candidate
from .refit import Refit

_WHOLE = 0.25
"""Physics that was left out comes back where its fitted share of the whole is within this of 1."""


def corrected_arm(arm: Arm, fitted: Refit) -> tuple[Arm, tuple[str, ...]]:
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
            if abs(share - 1.0) <= _WHOLE:
                left_out.discard(candidate.effect)
            else:
                notes.append(
                    f"The corrected arm still leaves out {candidate.effect}: {share:.2g} times what the file's data "
                    "give would fit, which no entry of the file can say."
                )
            continue
        if candidate.effect == "joint_compliance" and len(term.sizes) != len(candidate.sizes):
            drive = candidate.at[0] + 1
            told = next((each for each in parameters if each.parameter == "compliance"), None)
            if told is None:
                notes.append(
                    f"The corrected arm lacks the compliance of drive {drive}: with links of unknown mass only its "
                    "product with their weight is known."
                )
                continue
            values = MappingProxyType({"compliance": told.value})
            entries.append(EffectEntry("joint_compliance", (drive,), values))
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
    # A shape of nought is what the file means anyway, but for creep that does not begin anew.
    shapes = {name: value for name, value in candidate.shapes.items() if value > 0.0 or name == "anew"}
    at = tuple(index + 1 for index in candidate.at)
    return EffectEntry(candidate.effect, at, MappingProxyType({**values, **shapes}))
