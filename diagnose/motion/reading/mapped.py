"""Foreign headers of a motion log taken for ours, so far as they are plain, and said."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.reading.columns import canonical
from linkwright.core.diagnose.reading.foreign.proposal import Meaning, proposed
from linkwright.core.diagnose.reading.settings import ReadingSettings
from linkwright.core.diagnose.reading.table import Table
from linkwright.core.units.quantities import InputError


def with_foreign(table: Table, arm: Arm, held: ReadingSettings) -> tuple[ReadingSettings, list[str]]:
    """The settings with formulas of our columns for foreign headers that are plain, beside those that they have; and
    sentences that say so. Raises `InputError` where two robots tell of the same joints."""
    named = {canonical(header).partition("_")[0] for header in held.columns}
    meanings = [item for item in proposed(table, arm) if item.header not in held.ignore]
    rival = next((meaning for meaning in meanings if meaning.rival), None)
    if rival is not None and not any(re.fullmatch(r"q[0-9]+", name) for name in named):
        message = (
            f"and {rival.rival} tell of the same joints: are these two robots in one file? choose one by `columns:` or "
            "`ignore:` in recording.yaml, of a bag by `topics:`"
        )
        raise InputError(table.file, rival.header, message)
    held = replace(held, columns=_of_headers(held, meanings, table))
    foreign = [
        meaning
        for meaning in meanings
        if meaning.named and meaning.what not in named and (meaning.formula or meaning.ours != meaning.header)
    ]
    foreign = [item for item in foreign if canonical(item.header) != item.ours]
    if not foreign:
        return held, []
    columns = {
        **held.columns,
        **{item.ours: item.formula or f"`{item.header}`" for item in foreign if "`" not in item.header},
    }
    return replace(held, columns=MappingProxyType(columns)), [_sentence(foreign)]


def _of_headers(held: ReadingSettings, meanings: Sequence[Meaning], table: Table) -> Mapping[str, str]:
    """The settings' formulas, in which our names for foreign headers, by which refusals call them, may stand."""
    known = {item.ours: item.made_of for item in meanings if item.named and item.ours not in table.columns}
    called = re.compile(rf"(?<![\w`])({'|'.join(map(re.escape, known))})(?![\w`])")
    formulas = {ours: called.sub(lambda name: f"({known[name[1]]})", text) for ours, text in held.columns.items()}
    return MappingProxyType(formulas) if known else held.columns


def _sentence(foreign: Sequence[Meaning]) -> str:
    """Which headers are taken for which of ours: of joints the first of each kind, and how many there are."""
    kinds: dict[str, list[Meaning]] = defaultdict(list)
    for item in foreign:
        kinds[re.sub(r"[0-9]+$", "", item.what)].append(item)
    parts: list[str] = []
    for alike in kinds.values():
        more = f" and {len(alike) - 1} more alike" if len(alike) > 1 else ""
        why = "; ".join(dict.fromkeys(f"{each.said}" for each in alike if each.said))
        parts.append(f"{alike[0].header} as {alike[0].ours}{more}" + (f" ({why})" if why else ""))
    return f"Headers are taken for ours: {', '.join(parts)}."
