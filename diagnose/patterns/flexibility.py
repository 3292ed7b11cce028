"""Which candidates are flexibility, and which are loads that act through it."""

from __future__ import annotations

from collections.abc import Sequence
from types import MappingProxyType

from linkwright.core.arm.chain.chain import EffectEntry
from linkwright.core.arm.effects import EFFECTS

from .form import form_of
from .library import Candidate, parameter_of


def flexible(candidate: Candidate) -> bool:
    """Whether a candidate is flexibility through which unknown loads act."""
    common = candidate.only is None
    return common and not (candidate.share or candidate.outside) and EFFECTS[candidate.effect].link.flexible


def through_flexibility(candidate: Candidate) -> bool:
    """Whether a candidate is a load that acts through the arm's flexibility."""
    return form_of(candidate).force if candidate.outside else EFFECTS[candidate.effect].link.through_flexibility


def entry(candidate: Candidate, sizes: Sequence[float]) -> EffectEntry | None:
    """A flexibility found as an entry of the arm's effects; None where it has no parameters of its own (links of
    unknown weight) or would be no physics."""
    if not flexible(candidate) or len(sizes) != len(candidate.sizes):
        return None
    values: dict[str, float] = {}
    for name, size in zip(candidate.sizes, sizes, strict=True):
        parameter = parameter_of(EFFECTS[candidate.effect], name)
        if not parameter.lower < size < parameter.upper:
            return None
        values[name] = size
    return EffectEntry(candidate.effect, candidate.numbers, MappingProxyType(values))
