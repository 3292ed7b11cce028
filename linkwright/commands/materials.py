"""`linkwright materials`: what links can be made of, each figure with its source."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any

import typer

from linkwright.as_json import program_version
from linkwright.writing import check_target, write_json
from materials.catalogue import Catalogue
from materials.material import REFERENCE_TEMPERATURE, Material, PropertyName, property_kinds
from materials.quantities import format_quantity

from .groups import command_group
from .options import CatalogueFile, JsonFile, catalogue_with

HELP = """What links can be made of: list, show."""
LIST_HELP = """Every material of the catalogue at 20 degC.

Example: linkwright materials list
"""
SHOW_HELP = """One material: each property with its range of temperature, its spread and its source.

Example: linkwright materials show aluminium-6061-t6
"""
_DIGITS = 6


def list_materials(json: JsonFile = None, catalogue: CatalogueFile = None) -> None:
    """Run `materials list`."""
    from linkwright.screen.console import console, table

    check_target(json, catalogue)
    known = catalogue_with(catalogue)
    _write(json, {"materials": [_as_json(known, material) for material in known]})
    shown = table("material", "family", "E", "density", "yield", "cost", numbers=(2, 3, 4, 5))
    columns: tuple[PropertyName, ...] = ("elastic_modulus", "density", "yield_strength", "cost")
    for material in known:
        shown.add_row(material.name, material.family, *(_value(material, name) for name in columns))
    console().print(shown)


def show_material(
    name: Annotated[str, typer.Argument(metavar="NAME", help="The material's name.")],
    json: JsonFile = None,
    catalogue: CatalogueFile = None,
) -> None:
    """Run `materials show`."""
    from linkwright.screen.console import console, table

    check_target(json, catalogue)
    known = catalogue_with(catalogue)
    material = known.find(name)
    _write(json, _as_json(known, material))
    screen = console()
    screen.print(f"{material.name}: {material.title or material.family}", style="bold")
    shown = table("property", "at 20 degC", "valid", "spread", "source", numbers=(1,))
    for property_name in property_kinds():
        found = material.properties.get(property_name)
        if found is None:
            continue
        spread = "" if found.spread is None else " to ".join(_written(x, property_name) for x in found.spread)
        value = _value(material, property_name)
        shown.add_row(property_name.replace("_", " "), value, _valid(found.valid), spread, found.source)
        if found.note:
            shown.add_row("", "", "", "", found.note)
    if material.magnetic is not None:
        shown.add_row("magnetic", "yes" if material.magnetic else "no", "", "", material.magnetic_source)
    screen.print(shown)
    for key, text in material.references.items():
        screen.print(f"{key}: {text}")
    screen.print(f"from {', then '.join(known.where(material.name))}", soft_wrap=True)


def _written(value: float, name: PropertyName) -> str:
    return format_quantity(value, property_kinds()[name], digits=_DIGITS)


def _value(material: Material, name: PropertyName) -> str:
    return _written(material.need(name), name) if material.has(name) else "–"


def _valid(valid: tuple[float, float]) -> str:
    low, high = valid
    if low <= 0.0 and math.isinf(high):
        return ""
    return f"{low - 273.15:g} to {high - 273.15:g} degC"


def _write(json: Path | None, content: dict[str, Any]) -> None:
    write_json(json, {"made_by": f"linkwright materials {program_version()}", **content})


def _as_json(catalogue: Catalogue, material: Material) -> dict[str, Any]:
    """A material's figures at 20 degC: as written, and in SI."""
    properties: dict[str, Any] = {}
    for name, found in material.properties.items():
        low, high = found.valid
        properties[name] = {
            "value": _written(found.law.value(REFERENCE_TEMPERATURE), name),
            "si": found.law.value(REFERENCE_TEMPERATURE),
            "valid_degC": None if math.isinf(high) else [low - 273.15, high - 273.15],
            "spread": None if found.spread is None else [_written(x, name) for x in found.spread],
            "source": material.references.get(found.source, found.source),
            "note": found.note or None,
        }
    return {
        "name": material.name,
        "title": material.title,
        "family": material.family,
        "isotropic": material.isotropic,
        "magnetic": material.magnetic,
        "properties": properties,
        "files": list(catalogue.where(material.name)),
    }


def group() -> typer.Typer:
    """The command group."""
    return command_group(HELP, {"list": (list_materials, LIST_HELP), "show": (show_material, SHOW_HELP)})
