"""The keys of the files: what each means, as the page on files says it, and what stands in catalogues for it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from types import MappingProxyType

import linkwright as lw
from linkwright.browser.server.folder import Kind
from linkwright.core.units.quantities import InputError

Place = tuple[str | int, ...]
_ROW = re.compile(r"\| (`[^|]*`) \| (.*?) \|(?: (.*?) \|)?$")
_LINK = re.compile(r"\[([^\]]*)\]\([^)]*\)")


@cache
def _tables() -> Mapping[str, Mapping[str, str]]:
    """The tables of docs/formats.md: what each key means, by the heading or the key that its table is of."""
    tables: dict[str, dict[str, str]] = {}
    of = ""
    for line in files("linkwright.browser").joinpath("formats.md").read_text(encoding="utf-8").splitlines():
        if line.startswith("#"):
            of = line.strip("# ").lower()
        elif named := re.match(r"\| in `(\w+)`", line):
            of = named[1]
        elif row := _ROW.match(line):
            default = row[3] and row[3].strip()
            text = f"{row[2]} (default: {default})" if default else row[2]
            plain = _LINK.sub(r"\1", text).replace("`", "").replace("\\*", "*")
            for key in re.findall(r"`(\w+)`", row[1]):
                tables.setdefault(of, {})[key] = plain
    return MappingProxyType(tables)


def known_keys(kind: Kind, entries: int) -> list[str]:
    """The keys of a file as they are written, those of its `entries` joints and links among them."""
    tables = _tables()
    chain = [
        f"chain[{n}].{part}.{key}" for n in range(1, entries + 1) for part in ("joint", "link") for key in tables[part]
    ]
    within = {"subject_to": (*lw.limits, *tables["subject_to"]), "choose": tables["choose"]}
    below = [f"{name}.{key}" for name, keys in within.items() for key in dict.fromkeys(keys)]
    return [*tables[f"{kind} file"], *(chain if kind == "arm" else below)]


def meaning(kind: Kind, place: Place, shape: str = "") -> str:
    """What a key means; of a dimension for a `shape`. Empty where nobody says it."""
    names = [item for item in place if isinstance(item, str)]
    if len(names) == 2 and names[0] == "subject_to" and names[1] in lw.limits:
        figure = lw.limits[names[1]]
        return f"{figure.title}{figure.unit and f', {figure.unit}'}: {' or '.join(figure.senses)}"
    if len(names) > 2 and names[-2] == "section" and shape in lw.shapes:
        meanings = {dimension.name: dimension.meaning for dimension in lw.shapes[shape].dimensions}
        if names[-1] in meanings:
            return meanings[names[-1]]
    tables = _tables()
    for of, key in (
        (names[-2], names[-1]) if len(names) > 1 else (f"{kind} file", names[0]),
        (f"{kind} file", names[0]),
    ):
        if key in tables.get(of, ()):
            return tables[of][key]
    return ""


def to_choose(place: Place) -> list[str]:
    """The names that can stand there: of a catalogue, or nothing where other things do."""
    catalogues = {
        "material": lw.materials,
        "section": lw.shapes if place[0] == "choose" else lw.sections,
        "actuator": lw.actuators,
        "shape": lw.shapes,
        "effect": lw.effects,
        "minimize": lw.limits,
        "maximize": lw.limits,
    }
    try:
        return list(catalogues.get(str(place[-1]), ()))
    except InputError:  # a catalogue of the user's that cannot be read says so where it is used
        return []
