"""A value of a file in parts that a person edits: a relation, numbers and a unit; and a section of another shape."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from types import MappingProxyType
from typing import Any, cast

import pint

import linkwright as lw
from linkwright.browser.server.folder import Kind
from linkwright.core.units.quantities import InputError, read_quantity
from linkwright.core.units.units import kinds, registry

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
    name = place[1] if place[0] == "choose" and len(place) == 3 else place[-1]  # choose.section.1 is of one link
    try:
        return list(catalogues.get(str(name), ()))
    except InputError:  # a catalogue of the user's that cannot be read says so where it is used
        return []


_NUMBER = r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?"
_PARTS = re.compile(rf"\s*(<=|>=|==)?\s*({_NUMBER})\s*(\S.*?)?\s*")
_LONGEST = 4
"""Numbers that stand beside each other at most; a longer list stays a text."""
_MORE: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {"angle": ("arcmin", "arcsec", "rad"), "length": ("cm", "in"), "temperature": ("K", "degF")}
)
_WALL_SHARE = 0.06
_USUAL_SIZE = 0.08
"""The outer size (m) of a section of which nothing is known."""


@dataclass(frozen=True)
class Parts:
    """`<= 6 kg` or `[-30 deg, 100 deg]`: the relation (empty where there is none), the numbers as they are written, the
    unit (empty of pure numbers), and whether they stand in a list."""

    relation: str
    numbers: tuple[str, ...]
    unit: str
    listed: bool

    @property
    def units(self) -> list[str]:
        """The units that measure the same, its first where it is not a usual one."""
        return list(_units(self.unit)) if self.unit else []

    def value(self) -> Any:
        """The value as a file has it."""
        words = [" ".join(filter(None, (self.relation, number, self.unit))) for number in self.numbers]
        if self.unit or self.relation:
            return words if self.listed else words[0]
        pure = [_pure(word) for word in words]
        return pure if self.listed else pure[0]

    def typed(self, place: int, text: str) -> Parts:
        """With another number at a place, or with what was typed there altogether: `0.5 m` is a unit as well."""
        result = _PARTS.fullmatch(text.replace("−", "-"))
        numbers = list(self.numbers)
        if result is None or (self.listed and result[3] not in (None, self.unit)):
            numbers[place] = text.strip()
            return Parts(self.relation, tuple(numbers), self.unit, self.listed)
        numbers[place] = result[2]
        return Parts(result[1] or self.relation, tuple(numbers), result[3] or self.unit, self.listed)


def parts_of(value: object) -> Parts | None:
    """A value in its parts; None where it has none that a person would edit one by one."""
    listed = isinstance(value, list)
    items = cast("list[object]", value) if isinstance(value, list) else [value]
    if not items or len(items) > _LONGEST or (listed and len(items) < 2):
        return None
    result = [_split(item) for item in items]
    if any(item is None for item in result):
        return None
    split = [item for item in result if item is not None]
    units = {unit for _, number, unit in split if unit or float(number) != 0.0}
    relations = {relation for relation, _, _ in split}
    unit = next(iter(units), "")
    if len(units) > 1 or len(relations) > 1 or (unit and not _units(unit)):
        return None
    return Parts(relations.pop(), tuple(number for _, number, _ in split), unit, listed)


def _split(item: object) -> tuple[str, str, str] | None:
    if isinstance(item, bool):
        return None
    if isinstance(item, int | float):
        return "", f"{item:.12g}", ""
    result = _PARTS.fullmatch(item) if isinstance(item, str) else None
    return None if result is None else (result[1] or "", result[2], result[3] or "")


@cache
def _units(unit: str) -> tuple[str, ...]:
    """The usual units of what a unit measures; none where it is no unit."""
    try:
        dimension = registry().parse_units(unit.replace("°C", "degC").replace("°", "deg")).dimensionality
    except (pint.PintError, ValueError, AttributeError, TypeError):
        return ()
    for kind in kinds().values():
        if kind.si and registry().parse_units(kind.si).dimensionality == dimension:
            return tuple(dict.fromkeys((unit, *kind.units, *_MORE.get(kind.name, ()))))
    return (unit,)


def _pure(word: str) -> Any:
    try:
        return int(word)
    except ValueError:
        pass
    try:
        return float(word)
    except ValueError:
        return word


def section_like(chosen: str, before: object) -> Any:
    """What stands for a section in a file once another shape or stock size was chosen: dimensions of the same name are
    kept, others are about as large; of a shape that more than sizes and walls describe as in its nearest stock size."""
    if chosen not in lw.shapes:
        return chosen
    old = cast("dict[str, Any]", before) if isinstance(before, dict) else {}
    outer = [value for name in ("height", "diameter", "width") if (value := _metres(old.get(name))) is not None]
    if not outer and isinstance(before, str):
        outer = [_stock_size(before)]
    size = outer[0] if outer else _USUAL_SIZE
    wall = next((value for name in old if "thickness" in name and (value := _metres(old[name])) is not None), None)
    if any(item.kind == "radius" and not item.optional for item in lw.shapes[chosen].dimensions):
        return _like_stock(chosen, size)
    made: dict[str, Any] = {"shape": chosen}
    for dimension in lw.shapes[chosen].dimensions:
        if dimension.name in old:
            made[dimension.name] = old[dimension.name]
        elif not dimension.optional and dimension.kind in ("outer", "wall"):
            metres = size if dimension.kind == "outer" else wall or _WALL_SHARE * size
            made[dimension.name] = f"{round(1e3 * metres, 1):g} mm"
    return made


def _like_stock(shape: str, size: float) -> dict[str, Any]:
    """The dimensions of a shape as high (m) as that, and otherwise as the stock size that is nearest to it."""
    sections = (lw.sections[name].section for name in lw.sections)
    known = (section.given() for section in sections if section.shape == shape)
    near = min(known, key=lambda given: abs(float(given["height"]) - size))
    share = 1e3 * size / float(near["height"])
    return {"shape": shape, **{name: f"{share * float(value):.4g} mm" for name, value in near.items()}}


def _metres(value: object) -> float | None:
    try:
        return read_quantity(value, "length", file="", key="")
    except InputError:
        return None


def _stock_size(name: str) -> float:
    try:
        ring = lw.sections[name].section.outline()[0]
    except (KeyError, InputError, AttributeError):
        return _USUAL_SIZE
    heights = [float(z) for _, z in ring]
    return max(heights) - min(heights)
