"""Foreign headers taken for ours, so far as they are plain, and said."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.reading.columns import canonical, looks_like_ours, otherwise_spelled
from linkwright.core.diagnose.reading.settings import ReadingSettings
from linkwright.core.diagnose.reading.table import Table
from linkwright.core.units.quantities import InputError

from .proposal import Meaning, proposed

_POSES = ("position", "camera")
"""Kinds of observation that x, y and z are of."""


def plain_headers(table: Table, arm: Arm, held: ReadingSettings) -> dict[str, Meaning]:
    """The foreign headers of a recording of the tip that are one of ours beyond doubt (`Meaning.plain`), none of what
    headers of ours say or the settings map or pass over."""
    names = [header for header in table.names if header not in held.ignore and not _of_a_branch(header)]
    known = {canonical(each).partition("_")[0] for each in (*names, *(otherwise_spelled(name) or "" for name in names))}
    known |= {canonical(header).partition("_")[0] for header in held.columns}
    if held.instrument is not None and not set(held.kinds) & set(_POSES):
        known |= {"x", "y", "z"}
    meanings = proposed(table, arm)
    if any(item.rival for item in meanings):
        known |= {f"q{joint}" for joint in range(1, arm.size + 1)}
    return {
        item.header: item
        for item in meanings
        if item.plain and not item.formula and item.header in names and item.what not in known and _fits(item, table)
    }


def _of_a_branch(header: str) -> bool:
    """Whether a header is one of ours behind a name, as those of the other arms of a tree are (`left_q1_deg`)."""
    return any(looks_like_ours(header[end.end() :]) for end in re.finditer("_", header))


def _fits(item: Meaning, table: Table) -> bool:
    """Whether a column of sides holds sides and nothing else."""
    return not item.what.startswith("dir") or bool(np.isin(table.sides(item.header), (-1.0, 0.0, 1.0)).all())


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
    return replace(held, columns=MappingProxyType(columns)), [taken_for_ours(foreign)]


def _of_headers(held: ReadingSettings, meanings: Sequence[Meaning], table: Table) -> Mapping[str, str]:
    """The settings' formulas, in which our names for foreign headers, by which refusals call them, may stand."""
    known = {item.ours: item.made_of for item in meanings if item.named and item.ours not in table.columns}
    called = re.compile(rf"(?<![\w`])({'|'.join(map(re.escape, known))})(?![\w`])")
    formulas = {ours: called.sub(lambda name: f"({known[name[1]]})", text) for ours, text in held.columns.items()}
    return MappingProxyType(formulas) if known else held.columns


def taken_for_ours(foreign: Sequence[Meaning]) -> str:
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
