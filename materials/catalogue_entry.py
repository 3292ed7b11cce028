"""One entry of a catalogue, or a material described in place, read and checked.

`family` of its overrides that of the file. A property is written as a plain quantity (`71 GPa`), or as a
mapping (the n-th coefficient of a polynomial is per kelvin^n):

```yaml
elastic_modulus:
  value: 210 GPa                       # or table: [[20 degC, 210 GPa], [100 degC, 205 GPa]]
                                       # or polynomial: {origin: 20 degC, coefficients: [210 GPa, -60 MPa]}
  spread: [200 GPa, 215 GPa]
  range: [0 degC, 100 degC]
  source: en-1993-1-1
  note: where to be careful
```

`unconfirmed: {density: what was looked for}` beside the properties marks those that nobody could find in their sources,
`found_in: {density: where}` tells in which text others were found; a file tells it of all that have a source, with
`found_in: {en-1993-1-1: where}` beside its `references`.

A laminate says what it is made of in place of the moduli, which follow from that (`materials.walls`):

```yaml
laminate: {ply: cfrp-unidirectional, angles: [0 deg, 45 deg, -45 deg, 0 deg], source: own}
```

`ply` is a material that has a `transverse_modulus`, by its name or in place; `thicknesses` beside the `angles` where
plies differ. Density, price and what else laminates have of their plies is taken from the ply where it is not given.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from collections.abc import Mapping as MappingLike
from dataclasses import replace
from types import MappingProxyType
from typing import TypeAlias, cast, get_args

from linkwright.core.materials.in_place import with_units
from linkwright.core.materials.material import (
    Constant,
    Law,
    Material,
    Polynomial,
    Property,
    PropertyName,
    Table,
    property_kinds,
)
from linkwright.core.materials.walls import Orthotropic, Ply, Unbalanced, Wall, wall_of
from linkwright.core.units.quantities import InputError, format_quantity, read_quantity, shown
from linkwright.core.units.reading import Mapping
from linkwright.core.units.temperature import REFERENCE_TEMPERATURE, ZERO_CELSIUS

_REQUIRED: tuple[PropertyName, ...] = ("elastic_modulus", "density")
_POSITIVE: tuple[PropertyName, ...] = (
    "elastic_modulus",
    "shear_modulus",
    "transverse_modulus",
    "density",
    "yield_strength",
    "tensile_strength",
    "fatigue_strength",
    "thermal_conductivity",
    "heat_capacity",
)
_PRICES: tuple[PropertyName, ...] = ("cost", "machining_cost")
_NOT_NEGATIVE: tuple[PropertyName, ...] = (*_PRICES, "damping")
CONSISTENT_WITHIN = 0.02
"""How far a given shear modulus may be from E/(2(1+nu)) in an isotropic material, relative."""


Finder: TypeAlias = Callable[[str], Material | None]
"""Gives the material of a name that a ply may have; None for no such material."""


def no_material(name: str) -> Material | None:
    """Knows no plies by name."""
    del name
    return None


def read_inline(content: object, *, file: object, key: str, find: Finder = no_material) -> Material:
    """Return the material that an arm file describes in place, such as `{elastic_modulus: 71 GPa, ...}`.

    Nothing is required: what a question needs and the entry lacks is a `MissingProperty` when the question is
    asked. What is there is checked as in a catalogue. Raises `InputError`.
    """
    mapping = Mapping(content, file=file, key=key)
    if not mapping.content:
        raise InputError(file, key, "the material has no properties; give e.g. {elastic_modulus: 71 GPa}")
    named = mapping.text("name", key or "material in place")
    material = _read(mapping, named, references=None, family="in place", find=find)
    mapping.close()
    return replace(material, in_place=with_units(mapping.content))


def read_entry(
    mapping: Mapping,
    name: str,
    references: MappingLike[str, str],
    family: str,
    find: Finder = no_material,
    found_in: MappingLike[str, str] | None = None,
) -> Material:
    """Return the checked material of one catalogue entry; `found_in` has the text in which the values of a source were
    found, by the source's key. Raises `InputError` naming the entry and its key."""
    for required in () if mapping.has("laminate") else _REQUIRED:
        if not mapping.has(required):
            raise mapping.error(required, "is missing; every material needs it, with its source")
    material = _read(mapping, name, references, family, find, found_in or {})
    mapping.close()
    return material


def _read(
    mapping: Mapping,
    name: str,
    references: MappingLike[str, str] | None,
    family: str,
    find: Finder = no_material,
    found_in: MappingLike[str, str] = MappingProxyType({}),
) -> Material:
    title = mapping.text("title", "")
    family = mapping.text("family", family)
    isotropic = mapping.boolean("isotropic", True)
    default_source = _source(mapping, references, "") if mapping.has("source") else ""
    magnetic, magnetic_source = _read_magnetic(mapping, references, default_source)
    properties: dict[PropertyName, Property] = {}
    for property_name in get_args(PropertyName):
        if mapping.has(property_name):
            properties[property_name] = _read_property(mapping, property_name, references, default_source)
    sources: dict[str, str] = {key: item.source for key, item in properties.items()}
    marks = _marks(mapping, sources if magnetic is None else {**sources, "magnetic": magnetic_source}, found_in)
    for property_name, item in properties.items():
        unconfirmed, result = marks[property_name]
        properties[property_name] = replace(item, unconfirmed=unconfirmed, found_in=result)
    bending = None
    if mapping.has("laminate"):
        made, bending = read_laminate(mapping, references, default_source, find)
        for follows in made.keys() & set(properties) & set(FOLLOWING):
            raise mapping.error(follows, "follows from the laminate; leave it out")
        properties, isotropic = made | properties, False
    used = [item.source for item in properties.values()] + [magnetic_source]
    cited = {key: references[key] for key in used if references is not None and key}
    magnetic_marks = marks.get("magnetic", ("", ""))
    material = Material(
        name, properties, title, family, isotropic, magnetic, magnetic_source, cited, *magnetic_marks, bending
    )
    _check_values(material, mapping)
    return material


def _marks(
    mapping: Mapping, sources: MappingLike[str, str], found_in: MappingLike[str, str]
) -> dict[str, tuple[str, str]]:
    """What was looked for in vain, and where it was found, for each value of an entry that names a source."""
    missing, result = (_texts(mapping, key, sources) for key in ("unconfirmed", "found_in"))
    for name in set(missing) & set(result):
        raise mapping.error(f"found_in.{name}", "was found and is not confirmed; only one can be")
    return {
        name: (missing.get(name, ""), "" if name in missing else result.get(name, found_in.get(source, "")))
        for name, source in sources.items()
    }


def _texts(mapping: Mapping, key: str, names: Iterable[str]) -> dict[str, str]:
    if not mapping.has(key):
        return {}
    with mapping.mapping(key).reading() as marks:
        return {name: marks.text(name) for name in names if marks.has(name)}


def _source(mapping: Mapping, references: MappingLike[str, str] | None, default: str) -> str:
    """Return the source key of a property, which must stand among the references of a catalogue."""
    source = mapping.text("source", default) if default or references is None else mapping.text("source")
    if references is not None and source not in references:
        known = ", ".join(references) or "none are given"
        raise mapping.error("source", f"'{source}' is not among the file's references ({known})")
    return source


def _read_magnetic(
    mapping: Mapping, references: MappingLike[str, str] | None, default_source: str
) -> tuple[bool | None, str]:
    if not mapping.has("magnetic"):
        return None, ""
    if isinstance(mapping.content["magnetic"], dict):
        inner = mapping.mapping("magnetic")
        value = inner.boolean("value")
        source = _source(inner, references, default_source)
        inner.close()
        return value, source
    value = mapping.boolean("magnetic")
    if references is not None and not default_source:
        raise mapping.error("magnetic", "has no source; write {value: true, source: KEY}")
    return value, default_source


def _read_property(
    mapping: Mapping, name: PropertyName, references: MappingLike[str, str] | None, default_source: str
) -> Property:
    kind = property_kinds()[name]
    content = mapping.raw(name)
    path = mapping.path_of(name)
    if not isinstance(content, dict):
        value = read_quantity(content, kind, file=mapping.file, key=path)
        if references is not None and not default_source:
            raise mapping.error(
                name, "has no source; write {value: ..., source: KEY} or a source for all (in a command: --source TEXT)"
            )
        return Property(Constant(value), source=default_source)
    inner = mapping.mapping(name)
    ways = [way for way in ("value", "table", "polynomial") if inner.has(way)]
    if len(ways) != 1:
        several = ", not several" if ways else ""
        raise mapping.error(name, f"needs one of value, table or polynomial{several}")
    law, span = _read_law(inner, ways[0], kind)
    valid = inner.range("range", "temperature") if inner.has("range") else span
    spread = inner.range("spread", kind) if inner.has("spread") else None
    note = inner.text("note", "")
    source = _source(inner, references, default_source)
    date = inner.when("date", "") if name in _PRICES else ""
    inner.close()
    return Property(law, valid, source, spread, note, date)


def _read_law(inner: Mapping, way: str, kind: str) -> tuple[Law, tuple[float, float]]:
    everywhere = (0.0, float("inf"))
    if way == "value":
        return Constant(inner.quantity("value", kind)), everywhere
    if way == "table":
        return _read_table(inner, kind)
    polynomial = inner.mapping("polynomial")
    origin = polynomial.quantity("origin", "temperature")
    coefficients = polynomial.vector("coefficients", kind)
    polynomial.close()
    if not coefficients:
        raise inner.error("polynomial", "needs at least one coefficient")
    if not inner.has("range"):
        raise inner.error("range", "is missing; a polynomial needs one, e.g. [0 degC, 300 degC]")
    return Polynomial(coefficients, origin), everywhere


def _read_table(inner: Mapping, kind: str) -> tuple[Table, tuple[float, float]]:
    rows = inner.items("table")
    path = inner.path_of("table")
    points: list[tuple[float, float]] = []
    for number, row in enumerate(rows, start=1):
        where = f"{path}[{number}]"
        if not isinstance(row, list) or len(cast(list[object], row)) != 2:
            raise InputError(inner.file, where, f"needs [temperature, value], not {shown(row)}")
        temperature, value = cast(list[object], row)
        point = (
            read_quantity(temperature, "temperature", file=inner.file, key=where),
            read_quantity(value, kind, file=inner.file, key=where),
        )
        if points and point[0] <= points[-1][0]:
            raise InputError(inner.file, where, "the temperatures must rise from row to row")
        points.append(point)
    if len(points) < 2:
        raise InputError(inner.file, path, "a table needs two rows or more")
    temperatures = tuple(point[0] for point in points)
    table = Table(temperatures, tuple(point[1] for point in points))
    return table, (temperatures[0], temperatures[-1])


FOLLOWING: tuple[PropertyName, ...] = (
    "elastic_modulus",
    "transverse_modulus",
    "shear_modulus",
    "poisson_ratio",
    "thermal_expansion",
    "transverse_expansion",
)
"""What follows from a laminate's plies."""
_ALIKE: tuple[PropertyName, ...] = ("density", "cost", "machining_cost", "heat_capacity", "highest_service_temperature")
"""What a laminate has of its plies, whatever their angles. Its strength is not theirs."""


def read_laminate(
    mapping: Mapping, references: MappingLike[str, str] | None, default_source: str, find: Finder
) -> tuple[dict[PropertyName, Property], Orthotropic]:
    """The properties that a material's `laminate` gives it, over the temperatures that all of the ply's are known for,
    and how its walls bend. Raises `InputError`."""
    with mapping.mapping("laminate").reading() as keys:
        angles = keys.vector("angles", "angle")
        thicknesses = keys.vector("thicknesses", "length") if keys.has("thicknesses") else None
        if not angles or (thicknesses is not None and (len(thicknesses) != len(angles) or min(thicknesses) <= 0.0)):
            wrong = "angles" if not angles else "thicknesses"
            raise keys.error(wrong, "must be one for each ply, the thicknesses above zero")
        source = _source(keys, references, default_source)
        ply = _ply(keys, find)
    for name in FOLLOWING[:4]:
        if not ply.has(name):
            message = f"{ply.name} has no {name}; a ply needs its modulus along, across and in shear, and its Poisson's"
            raise mapping.error("laminate.ply", f"{message} ratio")
    wall = _wall(mapping, ply, angles, thicknesses)
    return _of_wall(wall, ply, source), wall.bending


def _wall(mapping: Mapping, ply: Material, angles: tuple[float, ...], thicknesses: tuple[float, ...] | None) -> Wall:
    """The wall of such plies by laminate theory."""
    values: dict[PropertyName, float] = {name: ply.need(name) for name in FOLLOWING if ply.has(name)}
    try:
        return wall_of(
            Ply(
                along=values["elastic_modulus"],
                across=values["transverse_modulus"],
                shear=values["shear_modulus"],
                poisson_ratio=values["poisson_ratio"],
                expansion_along=values.get("thermal_expansion"),
                expansion_across=values.get("transverse_expansion"),
            ),
            angles,
            thicknesses,
        )
    except Unbalanced:
        message = "are not balanced: as much must lie at + as at - each angle, or the link would twist under its load"
        raise mapping.error("laminate.angles", message) from None


def _of_wall(wall: Wall, ply: Material, source: str) -> dict[PropertyName, Property]:
    """The properties of a laminate: those of its wall, and what it has of its ply."""
    needed: list[PropertyName] = [name for name in FOLLOWING if ply.has(name)]
    valid = [ply.properties[name].valid for name in needed if name in ply.properties]
    span = (max(low for low, _ in valid), min(high for _, high in valid))
    properties: dict[PropertyName, float | None] = {
        "elastic_modulus": wall.along,
        "transverse_modulus": wall.around,
        "shear_modulus": wall.shear,
        "poisson_ratio": wall.poisson_ratio,
        "thermal_expansion": wall.expansion_along,
        "transverse_expansion": wall.expansion_around,
    }
    note = f"of plies of {ply.name} by laminate theory"
    made: dict[PropertyName, Property] = {
        name: Property(Constant(value), span, source, note=note)
        for name, value in properties.items()
        if value is not None
    }
    for name in _ALIKE:
        if name in ply.properties:
            made[name] = replace(ply.properties[name], source=source)
    return made


def _ply(keys: Mapping, find: Finder) -> Material:
    if isinstance(keys.content.get("ply"), dict):
        ply_keys = keys.mapping("ply")
        ply = _read(ply_keys, "the ply", None, "in place")
        ply_keys.close()
        return ply
    name = keys.text("ply")
    result = find(name)
    if result is None:
        raise keys.error("ply", f"there is no material '{name}' here; give a ply's properties in place")
    return result


def _temperatures_to_check(item: Property) -> list[float]:
    """Return temperatures that show every extreme of a property: ends, reference, table points, a fine
    sweep."""
    low, high = item.valid
    if high == float("inf"):
        return [min(max(REFERENCE_TEMPERATURE, low), high)]
    sweep = [low + (high - low) * step / 40 for step in range(41)]
    points = list(item.law.temperatures) if isinstance(item.law, Table) else []
    return [kelvin for kelvin in [*sweep, *points, REFERENCE_TEMPERATURE] if low <= kelvin <= high]


def _check_values(material: Material, mapping: Mapping) -> None:
    for name, item in material.properties.items():
        kind = property_kinds()[name]
        low, high = item.valid
        if not low <= REFERENCE_TEMPERATURE <= high:
            raise mapping.error(name, "its range must hold the reference temperature, 20 degC")
        for kelvin in _temperatures_to_check(item):
            value = item.law.value(kelvin)
            if due := _not_kept(name, value, _most_contraction(material)):
                is_so = f"not {format_quantity(value, kind, digits=4)} at {kelvin - ZERO_CELSIUS:g} degC"
                raise mapping.error(name, f"{due}, {is_so}")
        if item.spread is not None:
            value = item.law.value(REFERENCE_TEMPERATURE)
            if not item.spread[0] <= value <= item.spread[1]:
                raise mapping.error(name, "its value at 20 degC is outside its spread")
            if name in _POSITIVE and item.spread[0] <= 0:
                raise mapping.error(name, "its spread must be above zero")
    if material.isotropic and "transverse_modulus" in material.properties:
        raise mapping.error("transverse_modulus", "is that of a material that is not isotropic; write isotropic: false")
    _check_shear_modulus(material, mapping)
    _check_strengths(material, mapping)


def _most_contraction(material: Material) -> float:
    """The greatest Poisson's ratio that is possible: above it a body would give work away under load. Where there is a
    transverse modulus that is sqrt(E1/E2) (R. M. Jones, Mechanics of Composite Materials, 2nd ed., section 2.4)."""
    if material.isotropic or "transverse_modulus" not in material.properties:
        return 0.5
    return (material.need("elastic_modulus") / material.need("transverse_modulus")) ** 0.5


def _not_kept(name: str, value: float, most_contraction: float) -> str:
    """What a property's value must be and is not; empty where it is."""
    if name in _POSITIVE and value <= 0:
        return "must be above zero"
    if name in _NOT_NEGATIVE and value < 0:
        return "must not be negative"
    if name == "poisson_ratio" and not -1 < value < most_contraction:
        return f"must be between -1 and {most_contraction:.4g}"
    return ""


def _check_strengths(material: Material, mapping: Mapping) -> None:
    if "yield_strength" not in material.properties:
        return
    lowest = material.need("yield_strength")
    if "tensile_strength" in material.properties and material.need("tensile_strength") < lowest:
        raise mapping.error("tensile_strength", "must not be below the yield strength")


def _check_shear_modulus(material: Material, mapping: Mapping) -> None:
    constants = ("elastic_modulus", "poisson_ratio", "shear_modulus")
    if not material.isotropic or any(name not in material.properties for name in constants):
        return
    expected = material.need("elastic_modulus") / (2 * (1 + material.need("poisson_ratio")))
    shear_modulus = material.need("shear_modulus")
    if abs(shear_modulus - expected) > CONSISTENT_WITHIN * expected:
        written = format_quantity(shear_modulus, "elastic_modulus", digits=4)
        due = format_quantity(expected, "elastic_modulus", digits=4)
        raise mapping.error("shear_modulus", f"{written} does not fit E/(2(1+nu)) = {due}; or write isotropic: false")
