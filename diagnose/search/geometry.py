"""Zeros and lengths alone as an answer: what has more numbers must tell readings that were held out better."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.fitting.held_out import hardest, rms_held_out, splits
from linkwright.core.diagnose.patterns.library import Candidate, Family, of_single_numbers

if TYPE_CHECKING:
    from .naming import Namer

_ROUNDING = 1e-9
"""Of an RMS, what rounding makes of two that are the same: a tool's offset and the length and zero that do as much."""


def geometry_alone(namer: Namer) -> tuple[int, ...]:
    """The zeros and lengths that explain a recording best by the criterion: all of them, less one after the other
    whatever is not worth its number."""
    groups = namer.pool.groups
    variants: dict[Family, list[int]] = {}
    for number, group in enumerate(groups):
        if _single(group.candidate):
            variants.setdefault(group.candidate.family, []).append(number)
    members = [max(family, key=lambda number: len(groups[number].candidate.sizes)) for family in variants.values()]
    value = namer.criterion_of(members)
    while members:
        fewer = [[m for m in members if m != member] for member in members]
        for member in members:
            family, sizes = variants[groups[member].candidate.family], set(groups[member].candidate.sizes)
            less = [other for other in family if set(groups[other].candidate.sizes) < sizes]
            fewer += [[other if m == member else m for m in members] for other in less]
        values = [namer.criterion_of(item) for item in fewer]
        least = min(range(len(fewer)), key=values.__getitem__)
        if values[least] > value:
            break
        members, value = fewer[least], values[least]
    return tuple(members) if namer.possible(members) else ()


def _single(candidate: Candidate) -> bool:
    """Whether a candidate is zeros or lengths of one joint or link, in all recordings."""
    known = not candidate.outside and not candidate.share and candidate.only is None
    return known and len(candidate.at) == 1 and of_single_numbers(EFFECTS[candidate.effect])


def beats(namer: Namer, members: Sequence[int], geometry: Sequence[int]) -> bool:
    """Whether groups are a better answer than others of fewer numbers: by the criterion, and on readings held out."""
    if namer.criterion_of(members) >= namer.criterion_of(geometry):
        return False
    return _held_out(namer, members) < (1.0 - _ROUNDING) * _held_out(namer, geometry)


def _held_out(namer: Namer, members: Sequence[int]) -> float:
    prepared = namer.prepared
    columns = [prepared.beside, *(prepared.columns[member] for member in members)]
    return rms_held_out(prepared.observed, columns, hardest(splits(prepared.observed, namer.seed)))
