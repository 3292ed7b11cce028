"""Which stock sizes a list shows, in which order and with which columns."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from linkwright.words import figure
from materials.quantities import InputError, read_quantity
from materials.reading import nearest
from sections import SHAPES, SectionProperties, StockSize

from .materials_query import CONDITION, RELATIONS

POISSON_RATIO = 0.3
"""With which shear areas are listed; it changes them by some per cent at most."""

FIGURES: Mapping[str, tuple[str, int]] = MappingProxyType(
    {
        "area": ("area", 2),
        "second_moment_y": ("second moment about y", 4),
        "second_moment_z": ("second moment about z", 4),
        "torsion_constant": ("torsion constant", 4),
        "shear_area_y": ("shear area along y", 2),
        "shear_area_z": ("shear area along z", 2),
        "section_modulus_y": ("section modulus about y", 3),
        "section_modulus_z": ("section modulus about z", 3),
        "plastic_modulus_y": ("plastic modulus about y", 3),
        "plastic_modulus_z": ("plastic modulus about z", 3),
    }
)
"""What is computed of a size: its name in words, and the power of cm in which it is shown."""

USUAL = ("area", "second_moment_y", "second_moment_z", "torsion_constant")
"""The columns of a list that nobody chose columns for, after the dimensions."""

SHORT: Mapping[str, str] = MappingProxyType(
    {
        "area": "A",
        "second_moment_y": "I_y",
        "second_moment_z": "I_z",
        "torsion_constant": "J",
        "shear_area_y": "A_sy",
        "shear_area_z": "A_sz",
        "section_modulus_y": "W_y",
        "section_modulus_z": "W_z",
        "plastic_modulus_y": "W_pl,y",
        "plastic_modulus_z": "W_pl,z",
    }
)
"""Headings shorter than the figures' names."""

_KINDS = MappingProxyType({2: "area", 3: "section_modulus", 4: "second_moment_of_area"})
_POWERS = "\N{SUPERSCRIPT TWO}\N{SUPERSCRIPT THREE}\N{SUPERSCRIPT FOUR}"


@dataclass(frozen=True)
class Condition:
    """One `--where`: a figure or dimension, a relation and a limit in SI."""

    name: str
    relation: str
    limit: float

    def holds(self, size: StockSize) -> bool:
        """Tell whether the size has the dimension and keeps the limit."""
        value = value_of(size, self.name)
        return value is not None and RELATIONS[self.relation](value, self.limit)


def properties_of(size: StockSize) -> SectionProperties:
    """The size's properties, for a Poisson's ratio of 0.3."""
    return size.section.properties(POISSON_RATIO)


def value_of(size: StockSize, name: str) -> float | None:
    """A figure or dimension in SI; None where the size has no such dimension.

    `width` and `height` are those of the bounding box, so that a round tube has them too.
    """
    if name in FIGURES or name in ("width", "height"):
        return float(getattr(properties_of(size), name))
    return size.dimensions.get(name)


def unit_of(name: str) -> str:
    """The unit in which a figure or dimension is shown."""
    return f"cm{_POWERS[FIGURES[name][1] - 2]}" if name in FIGURES else "mm"


def written(size: StockSize, name: str) -> str:
    """A figure or dimension of a size in its unit, a dash where it has none."""
    value = value_of(size, name)
    if value is None:
        return "–"
    return figure(value * 100.0 ** FIGURES[name][1], 4) if name in FIGURES else figure(1e3 * value, 5)


def heading(name: str) -> str:
    """A column's heading, with its unit."""
    return f"{SHORT.get(name, name.replace('_', ' '))} {unit_of(name)}"


def name_of(text: str, option: str) -> str:
    """The figure or dimension that a user names, by its name or its short heading. Raises `InputError`."""
    wanted = text.strip().replace(" ", "_").replace("-", "_")
    dimensions = (each.name for kind in SHAPES.values() for each in kind.dimensions if each.kind != "points")
    known = list(dict.fromkeys([*FIGURES, "width", "height", *dimensions]))
    for name in known:
        if wanted in (name, SHORT.get(name, name)):
            return name
    raise InputError("", option, f"a section has no '{text.strip()}'{nearest(wanted, known)}")


def condition(text: str) -> Condition:
    """`second_moment_y > 100 cm^4` as a condition. Raises `InputError`."""
    found = CONDITION.fullmatch(text)
    if not found:
        raise InputError("", "--where", f"'{text}' is no condition; write e.g. 'area < 10 cm^2'")
    name = name_of(found[1], "--where")
    kind = _KINDS[FIGURES[name][1]] if name in FIGURES else "length"
    return Condition(name, found[2], read_quantity(found[3].strip(), kind, file="--where", key=name))


def chosen(sizes: Iterable[StockSize], conditions: Sequence[Condition], sort: str | None) -> tuple[StockSize, ...]:
    """The sizes that keep every condition, in the order asked for; those without the sorted dimension last.

    `sort` is `name`, `family`, a figure or a dimension, with `-` before it for the largest first. Raises `InputError`.
    """
    found = [size for size in sizes if all(each.holds(size) for each in conditions)]
    if not sort:
        return tuple(found)
    key, descending = sort.removeprefix("-"), sort.startswith("-")
    if key in ("name", "family"):
        return tuple(sorted(found, key=lambda size: str(getattr(size, key)), reverse=descending))
    name = name_of(key, "--sort")
    values = {size.name: value for size in found if (value := value_of(size, name)) is not None}
    having = sorted((size for size in found if size.name in values), key=lambda s: values[s.name], reverse=descending)
    return (*having, *(size for size in found if size.name not in values))


def chosen_columns(text: str | None) -> tuple[str, ...]:
    """The columns of `--columns area,height`; `all` is every computed figure. Raises `InputError`."""
    if not text:
        return USUAL
    if text.strip() == "all":
        return tuple(FIGURES)
    return tuple(name_of(part, "--columns") for part in text.split(",") if part.strip())
