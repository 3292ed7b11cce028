"""FreeCAD material cards (.FCMat), read and written: the INI-like ones up to 0.21 and the YAML-like ones since 1.0.

A card holds one value a property, taken here to be at 20 degC; ranges, tables and spreads have no place in it. What is
exchanged: density, Young's modulus, Poisson's ratio, shear modulus, yield and ultimate tensile strength, thermal
expansion, conductivity and specific heat, and the source as text. A card that inherits from another
(`Inherits`) is read as it stands: the values of its parent are in the parent's file.

Format: FreeCAD, src/Mod/Material (cards and models of 0.19 to 1.0); the model identifiers below are FreeCAD's own.
"""

from __future__ import annotations

import configparser
import re
import uuid
from collections.abc import Mapping as MappingLike
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal, cast

from linkwright.core.catalogues.keyed import Entry
from linkwright.core.materials.material import Material, PropertyName, property_kinds
from linkwright.core.units.quantities import InputError, format_quantity, read_quantity
from linkwright.core.units.reading import parse_yaml, read_text, yaml_line
from linkwright.core.units.temperature import REFERENCE_TEMPERATURE

CardFormat = Literal["yaml", "ini"]

MECHANICAL: MappingLike[str, PropertyName] = MappingProxyType(
    {
        "Density": "density",
        "PoissonRatio": "poisson_ratio",
        "ShearModulus": "shear_modulus",
        "UltimateTensileStrength": "tensile_strength",
        "YieldStrength": "yield_strength",
        "YoungsModulus": "elastic_modulus",
    }
)
THERMAL: MappingLike[str, PropertyName] = MappingProxyType(
    {
        "SpecificHeat": "heat_capacity",
        "ThermalConductivity": "thermal_conductivity",
        "ThermalExpansionCoefficient": "thermal_expansion",
    }
)
_UNITS: MappingLike[str, str] = MappingProxyType(
    {"SpecificHeat": "J/kg/K", "ThermalConductivity": "W/m/K", "ThermalExpansionCoefficient": "um/m/K"}
)
_LINEAR_ELASTIC = "7b561d1d-fb9b-44f6-9da9-56a4f74d7536"
_THERMAL = "9959d007-a970-4ea7-bae4-3eb1b8b883c7"
_SOURCES = ("ReferenceSource", "SourceURL", "ProductURL", "StandardCode", "Author")


def read_card(path: Path | str) -> Entry:
    """Return the material of a card of either format, under the card's name in our spelling.

    Raises `InputError` for a file that is no such card, or a value that is no quantity of its kind.
    """
    values = _card_values(read_text(path), path)
    title = values.get("Name", "").strip() or Path(path).stem
    reference = _reference(values, Path(path).name)
    content: dict[str, Any] = {"title": values.get("Description", "").strip() or title, "source": "freecad-card"}
    for key, property_name in [*MECHANICAL.items(), *THERMAL.items()]:
        text = values.get(key, "").strip()
        if not text:
            continue
        kind = property_kinds()[property_name]
        value = read_quantity(text, kind, file=path, key=key)
        content[property_name] = value if kind == "dimensionless" else format_quantity(value, kind)
    if not set(content) & set(property_kinds()):
        raise InputError(path, "", "has no property that is read here (YoungsModulus, Density, ...)")
    return Entry(spelled(title), content, {"freecad-card": reference})


def spelled(title: str) -> str:
    """Return a title as a material's name: lower case, with hyphens."""
    return re.sub(r"[^\w.]+", "-", title.strip().lower()).strip("-") or "material"


def write_card(material: Material, form: CardFormat = "yaml") -> str:
    """Return the card of a material, its values at 20 degC.

    Raises `InputError` for a material that is not isotropic, which a card's constants would misstate.
    """
    if not material.isotropic:
        raise InputError("", material.name, "is not isotropic, and a FreeCAD card holds isotropic constants only")
    mechanical, thermal = _written(material, MECHANICAL), _written(material, THERMAL)
    used = {material.properties[name].source for name in material.properties}
    texts = [material.references[key] for key in sorted(used) if key in material.references]
    about = {"Name": material.name, "Description": material.title, "ReferenceSource": "; ".join(texts)}
    about = {key: " ".join(text.split()) for key, text in about.items() if text}
    if form == "ini":
        sections = {"General": about, "Mechanical": mechanical, "Thermal": thermal}
        blocks = (_ini_section(title, entries) for title, entries in sections.items() if entries)
        return "; FreeCAD material card, values at 20 degC\n\n" + "\n".join(blocks)
    identity = uuid.uuid5(uuid.NAMESPACE_URL, f"{material.name} {mechanical} {thermal}")
    lines = ["---", "# values at 20 degC", "General:", f'  UUID: "{identity}"', *_yaml_lines(about, 2), "Models:"]
    lines += ["  LinearElastic:", f'    UUID: "{_LINEAR_ELASTIC}"', *_yaml_lines(mechanical, 4)]
    if thermal:
        lines += ["  Thermal:", f'    UUID: "{_THERMAL}"', *_yaml_lines(thermal, 4)]
    return "\n".join(lines) + "\n"


def _written(material: Material, keys: MappingLike[str, PropertyName]) -> dict[str, str]:
    values: dict[str, str] = {}
    for key, name in keys.items():
        if material.has(name):
            value = material.need(name, REFERENCE_TEMPERATURE)
            values[key] = format_quantity(value, property_kinds()[name], _UNITS.get(key))
    return values


def _ini_section(title: str, entries: MappingLike[str, str]) -> str:
    return "".join([f"[{title}]\n", *(f"{key} = {text}\n" for key, text in entries.items())])


def _yaml_lines(entries: MappingLike[str, str], indent: int) -> list[str]:
    return [" " * indent + f"{key}: {yaml_line(text, quoted=True)}" for key, text in entries.items()]


def _card_values(text: str, path: Path | str) -> dict[str, str]:
    """Return the card's keys and values as text, whatever section they stand in."""
    lines = (line.strip() for line in text.splitlines())
    first = next((line for line in lines if line and not line.startswith((";", "#"))), "")
    if first.startswith("["):
        return _ini_values(text, path)
    content = parse_yaml(text, file=path)
    if not isinstance(content, dict) or ("Models" not in content and "General" not in content):
        raise InputError(path, "", "is not a FreeCAD material card")
    card = cast(dict[str, Any], content)
    return {**_leaves(card.get("Models")), **_leaves(card.get("General"))}


def _ini_values(text: str, path: Path | str) -> dict[str, str]:
    parser = configparser.RawConfigParser(
        delimiters=("=",), comment_prefixes=(";", "#"), strict=False, empty_lines_in_values=False
    )
    parser.optionxform = str  # type: ignore[assignment,method-assign]  # keys keep their capitals
    try:
        parser.read_string(text)
    except configparser.Error as error:
        raise InputError(path, "", f"is not a FreeCAD material card: {error}") from None
    return {key: value for section in parser.sections() for key, value in parser.items(section)}


def _leaves(value: object) -> dict[str, str]:
    leaves: dict[str, str] = {}
    if isinstance(value, dict):
        for key, inner in cast(dict[str, object], value).items():
            if isinstance(inner, dict):
                leaves |= _leaves(cast(object, inner))
            elif isinstance(inner, str | int | float) and not isinstance(inner, bool):
                leaves[key] = str(inner)
    return leaves


def _reference(values: MappingLike[str, str], file: str) -> str:
    parts = [" ".join(values[key].split()) for key in _SOURCES if values.get(key, "").strip()]
    return "; ".join([f"FreeCAD material card {file}", *parts])
