"""What links and joints are called in a file for other programs: as the arm file says, and by number elsewhere."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from linkwright.core.arm.chain.chain import Arm

_KEPT = ("world",)
"""Names that simulators keep for what everything stands on."""


@dataclass(frozen=True)
class Names:
    """The names of an arm's `joints` and `links` (in its order), of its `base`, of the fixed joints `mounting` and of
    each tip's `tools`, and of the `tips`; `lost` says which of the arm file's could not stand."""

    joints: tuple[str, ...]
    links: tuple[str, ...]
    base: str
    mounting: str
    tips: tuple[str, ...]
    tools: tuple[str, ...]
    lost: tuple[str, ...]


def names_of(arm: Arm) -> Names:
    """Names of which no two links and no two joints have the same; `base`, `tip` and numbers give way to the file's."""
    prefixes = [f"{branch.name}_" for branch in arm.branches] or [""]
    links, twice = _named([link.name for link in arm.links], "link", _KEPT)
    joints, again = _named([joint.name for joint in arm.joints], "joint", ())
    base, *tips = _unlike(["base", *(f"{prefix}tip" for prefix in prefixes)], {*links, *_KEPT})
    mounting, *tools = _unlike(["mounting", *(f"{prefix}tool" for prefix in prefixes)], set(joints))
    lost = [f"the name of {item}, which another has or simulators keep" for item in (*twice, *again)]
    return Names(joints, links, base, mounting, tuple(tips), tuple(tools), tuple(lost))


def _named(given: Sequence[str], kind: str, reserved: Sequence[str]) -> tuple[tuple[str, ...], list[str]]:
    """The names as given, where they are and differ, and `link3` elsewhere; and which of them could not stand."""
    names: list[str] = []
    refused: list[str] = []
    for number, name in enumerate(given, start=1):
        stands = bool(name) and name not in names and name not in reserved
        if name and not stands:
            refused.append(f"{kind} {number}")
        names.append(name if stands else "")
    numbered = [f"{kind}{number}" for number, name in enumerate(names, start=1) if not name]
    free = iter(_unlike(numbered, {*filter(None, names), *reserved}))
    return tuple(name or next(free) for name in names), refused


def _unlike(names: Iterable[str], taken: set[str]) -> list[str]:
    """The names, with as many `_` after each as make it unlike those taken and the ones before."""
    results: list[str] = []
    for name in names:
        name_here = name
        while name_here in taken or name_here in results:
            name_here += "_"
        results.append(name_here)
    return results
