"""What the columns of a foreign file are taken for, made otherwise as a refusal's remedy says."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from linkwright.core.diagnose.reading.formula import read_formula
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError

from .proposal import IGNORED, OTHER, Meaning


@dataclass(frozen=True)
class _Sum:
    """A sum over columns: their factors by header, and what is added."""

    factors: Mapping[str, float]
    added: float


def with_columns(meanings: Sequence[Meaning], columns: Mapping[str, Any], *, file: str) -> list[Meaning]:
    """What the columns are taken for with some of them made otherwise, as a remedy says it: of another sign, factor or
    zero, of another column or of several. Raises `InputError` where a formula cannot be read or is no sum."""
    made = {str(ours): _sum(str(text), meanings, file, str(ours)) for ours, text in columns.items()}
    whats = {ours.partition("_")[0] for ours in made}
    changed = [replace(meaning, what=OTHER, unit="") if meaning.what in whats else meaning for meaning in meanings]
    headers = [meaning.header for meaning in meanings]
    numbers = {meaning.what: number for number, meaning in enumerate(meanings) if meaning.named}
    for ours, of in made.items():
        what, _, unit = ours.partition("_")
        if len(of.factors) == 1:
            ((header, factor),) = of.factors.items()
            changed[headers.index(header)] = Meaning(header, what, unit, factor=factor, zero=of.added)
            continue
        number = numbers.get(what, headers.index(next(iter(of.factors), headers[0])))
        parts = [f"{factor:.12g}*`{header}`" for header, factor in of.factors.items()]
        formula = " + ".join([*parts, *([f"{of.added:.12g}"] if of.added else [])])
        changed[number] = Meaning(headers[number], what, unit, formula=formula)
    return changed


def with_ignored(meanings: Sequence[Meaning], headers: Sequence[object]) -> list[Meaning]:
    """What the columns are taken for where some are passed over."""
    return [Meaning(meaning.header, IGNORED) if meaning.header in headers else meaning for meaning in meanings]


def _sum(text: str, meanings: Sequence[Meaning], file: str, key: str) -> _Sum:
    """A formula of columns, by our names for them or by their own, as a sum over the file's columns."""
    known = {meaning.header: _Sum({meaning.header: 1.0}, 0.0) for meaning in meanings}
    known |= {
        meaning.ours: _Sum({meaning.header: meaning.factor}, meaning.zero)
        for meaning in meanings
        if meaning.named and not meaning.formula
    }
    formula = read_formula(text, list(known), file=file, key=key)
    used = formula.columns

    def value(*at: float) -> float:
        numbers = dict(zip(used, at, strict=True))

        def column(name: str) -> Array:
            return np.array([numbers[name]])

        return float(formula.value(column, 1)[0])

    nothing = value(*(0.0 for _ in used))
    each = [value(*(float(k == n) for k in range(len(used)))) - nothing for n in range(len(used))]
    probe = [1.0 + k for k in range(len(used))]
    expected = nothing + sum(factor * at for factor, at in zip(each, probe, strict=True))
    if not abs(value(*probe) - expected) <= 1e-9 * (1.0 + abs(expected)):
        raise InputError(file, f"columns.{key}", f"{text} is no sum of columns; write it into recording.yaml")
    factors: dict[str, float] = {}
    added = nothing
    for name, factor in zip(used, each, strict=True):
        added += factor * known[name].added
        for header, inner in known[name].factors.items():
            factors[header] = factors.get(header, 0.0) + factor * inner
    return _Sum(factors, added)
