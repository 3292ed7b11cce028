"""The arm file with the findings in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from linkwright.core.arm.chain.chain import Arm, EffectEntry
from linkwright.core.arm.effects import EFFECTS, without_zeros
from linkwright.core.diagnose.patterns.library import Candidate
from linkwright.core.diagnose.patterns.unknown_weights import weight_entries
from linkwright.core.diagnose.result import FittedParameter
from linkwright.core.diagnose.rules.fitting_rules import FittingRules
from linkwright.core.diagnose.rules.rules import RULES

from .refit import Refit
from .shared_masses import factors
from .terms import Term


def corrected_arm(
    arm: Arm, fitted: Refit, *, only: int | None = None, rules: FittingRules = RULES.fitting
) -> tuple[Arm, tuple[str, ...]]:
    """The arm with each finding as an entry of its `effects`, and sentences on what the file cannot carry.

    Of several recordings that is what all have in common; `only` names one (from 0) whose own findings come on top.
    Physics that the file left out and that came out whole is no longer left out.
    """
    entries = list(arm.effects)
    left_out = set(arm.leave_out)
    notes: list[str] = []
    shared = [term for term in fitted.terms if term.shared]
    products: dict[int, float] = {}
    if shared:
        shared_factors = factors(np.stack([term.sizes[:-1] for term in shared]))
        entries += weight_entries(fitted.weights, shared_factors.weight.tolist()) if fitted.weights else ()
        products = dict(zip(map(id, shared), shared_factors.compliance.tolist(), strict=True))
        notes.append(_of_weights(shared))
    for term, parameters in zip(fitted.terms, fitted.parameters, strict=True):
        candidate = term.candidate
        if candidate.outside or candidate.only not in (None, only):
            continue
        if arm.branches and EFFECTS[candidate.effect].place == "tip":
            notes.append(f"The corrected arm lacks {candidate.effect}: it is of one tip, and its file has several.")
            continue
        if candidate.share:
            share = float(term.sizes[0])
            if abs(share - 1.0) <= rules.whole:
                left_out.discard(candidate.effect)
            else:
                notes.append(
                    f"The corrected arm still misses {candidate.effect}: {share:.2g} times what the file's data "
                    "give would fit, which no entry of the file can say."
                )
            continue
        if term.shared:
            entries.append(_under_weights(term, products[id(term)]))
            continue
        entry = _as_reported(as_entry(candidate, term.sizes.tolist()), parameters)
        if candidate.only is None or not _added(entries, entry, candidate.sizes):
            entries.append(entry)
    effects = without_zeros(entries, arm.effects)
    return replace(arm, effects=effects, leave_out=frozenset(left_out)), tuple(notes)


def _as_reported(entry: EffectEntry, parameters: Sequence[FittedParameter]) -> EffectEntry:
    """The entry by the sum that it is told by, where it is: by that alone where nothing else of it shows."""
    sum_of_sizes = EFFECTS[entry.effect].recording.told_as
    total = [
        parameter.value
        for parameter in parameters
        if sum_of_sizes is not None and parameter.parameter == sum_of_sizes.name
    ]
    if sum_of_sizes is None or not total:
        return entry
    beside = any(parameter.parameter == sum_of_sizes.beside for parameter in parameters)
    if len(entry.parameters) == 1 and beside:
        return entry
    kept = {sum_of_sizes.beside: entry.parameters[sum_of_sizes.beside]} if len(entry.parameters) > 1 else {}
    return replace(entry, parameters=MappingProxyType({**kept, sum_of_sizes.name: total[0]}))


def _added(entries: list[EffectEntry], more: EffectEntry, sizes: Sequence[str]) -> bool:
    """Put what one recording has more of into the entry of what all have, which is linear in its sizes; False where
    there is none of the same shape."""

    def shapes(entry: EffectEntry) -> dict[str, float]:
        return {name: value for name, value in entry.parameters.items() if name not in sizes}

    for place, entry in enumerate(entries):
        if (entry.effect, entry.at) == (more.effect, more.at) and shapes(entry) == shapes(more):
            both = {name: entry.parameters.get(name, 0.0) + more.parameters.get(name, 0.0) for name in sizes}
            entries[place] = replace(entry, parameters=MappingProxyType({**entry.parameters, **both}))
            return True
    return False


def _under_weights(term: Term, unit_sag: float) -> EffectEntry:
    """What gives under unknown weights, as an entry: the product, and its size where known loads told that."""
    values = {"unit_sag": unit_sag}
    if term.columns[:, :, -1].any():
        values[term.candidate.sizes[0]] = float(term.sizes[-1])
    return EffectEntry(term.candidate.effect, term.candidate.numbers, MappingProxyType(values))


def _of_weights(shared: Sequence[Term]) -> str:
    """What the file holds of products of compliance and unknown weight, as a sentence."""
    any_weight = any(term.columns[:, :, -1].any() for term in shared)
    held = "as products of compliance and weight (`unit_sag` under `unknown_weight`)"
    if any_weight:
        return (
            f"The corrected arm has what gives under links of unknown mass {held}, and its compliance by known loads."
        )
    return (
        f"The corrected arm has what gives under links of unknown mass {held}. Nothing else shows. The effect of "
        "another payload is unknown. Record two payloads."
    )


def as_entry(candidate: Candidate, sizes: Sequence[float]) -> EffectEntry:
    """A candidate of the library at some sizes as an entry of an arm's `effects`."""
    values = dict(zip(candidate.sizes, sizes, strict=True))
    # A shape of zero is what the file means anyway, unless its default is another.
    defaults = {parameter.name: parameter.default for parameter in EFFECTS[candidate.effect].shapes}
    shapes = {name: value for name, value in candidate.shapes.items() if value > 0.0 or defaults[name] != 0.0}
    return EffectEntry(candidate.effect, candidate.numbers, MappingProxyType({**values, **shapes}))
