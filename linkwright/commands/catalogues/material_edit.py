"""Materials for the command line: what a list can be asked for, and the edits of a catalogue of one's own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Literal

import typer

import linkwright as lw
from linkwright.commands.catalogues.own import Names, OwnCatalogue, value_of_text
from linkwright.commands.catalogues.query import Query
from linkwright.commands.options import CatalogueFile
from linkwright.core.catalogues.freecad_cards import read_card, write_card
from linkwright.core.catalogues.keyed import Entry
from linkwright.core.catalogues.materials import MATERIALS, find_entry, write_table
from linkwright.core.materials.catalogue import load_layer, shipped_layers, user_catalogue_path
from linkwright.core.materials.material import Material, PropertyName, property_kinds
from linkwright.core.materials.plausible import doubts_of
from linkwright.core.units.quantities import InputError, format_quantity
from linkwright.core.units.temperature import REFERENCE_TEMPERATURE

Asked = PropertyName | Literal["magnetic"]
"""What a material can be listed, chosen and compared by."""
SHORT: Mapping[Asked, str] = MappingProxyType(
    {
        "elastic_modulus": "E",
        "poisson_ratio": "nu",
        "shear_modulus": "G",
        "yield_strength": "yield",
        "tensile_strength": "tensile",
        "fatigue_strength": "fatigue",
        "thermal_expansion": "expansion",
        "thermal_conductivity": "conductivity",
        "highest_service_temperature": "usable to",
    }
)
"""Headings shorter than the properties' names."""
DIGITS = 6


def value(material: Material, name: Asked) -> float | None:
    """A material's property at 20 degC in SI, 1 or 0 whether it is magnetic; None where nobody knows."""
    if name == "magnetic":
        return None if material.magnetic is None else float(material.magnetic)
    return material.need(name) if material.has(name) else None


QUERY = Query[Material, Asked](
    names=lambda: (*property_kinds(), "magnetic"),
    short=SHORT,
    usual=("elastic_modulus", "density", "yield_strength", "cost"),
    every=(*property_kinds(), "magnetic"),
    kind=lambda name: "dimensionless" if name == "magnetic" else property_kinds()[name],
    value=value,
    yes_or_no=("magnetic",),
    lacks="there is no property '{}'",
    example="density < 3 g/cm^3",
)


def written(value: float, name: PropertyName, digits: int = DIGITS) -> str:
    """A value of a property with its unit."""
    return format_quantity(value, property_kinds()[name], digits=digits)


def value_of(material: Material, name: Asked) -> str:
    """A material's property at 20 degC, or whether it is magnetic; a dash where nobody knows."""
    if name == "magnetic":
        return "–" if material.magnetic is None else "yes" if material.magnetic else "no"
    return written(material.need(name, REFERENCE_TEMPERATURE), name) if material.has(name) else "–"


def is_unconfirmed(material: Material, name: Asked) -> bool:
    """Whether a material's property could not be found in the source that it names."""
    return bool(material.magnetic_unconfirmed if name == "magnetic" else material.unconfirmed(name))


def marked(material: Material, name: Asked) -> str:
    """`value_of`, with a question mark behind what could not be found in its source."""
    return value_of(material, name) + (" ?" if is_unconfirmed(material, name) else "")


_HELPS = MappingProxyType(
    {
        "add": """Add a material to your catalogue.

Example: linkwright materials add my-alloy elastic_modulus='80 GPa' density='3000 kg/m^3' --source 'Data sheet 12'
""",
        "edit": """Change keys of a material, or the catalogue file in $EDITOR; a shipped material is copied to yours.

Keys are such as density, E, cost.spread or title; several at once are one edit: KEY=VALUE KEY=VALUE.

Example: linkwright materials edit steel-s355 cost '1.30 EUR/kg' --source 'Offer of 3 March'
""",
        "price": """Give a material a price in your catalogue; the rest of it stays where it is.

Example: linkwright materials price steel-s355 '1.3 EUR/kg' --source 'Offer of 3 March'
""",
        "import": """Put materials from a file in your catalogue: .yaml, .FCMat (FreeCAD), .csv, .xlsx; all or nothing.

Example: linkwright materials import Steel-S235JR.FCMat --name steel-freecad
""",
        "check": "Check catalogue files: units, ranges, sources, E, G and nu; without a file the shipped ones and "
        "yours.",
    }
)


def _made(name: str, given: dict[str, str], source: str) -> Entry:
    content = {key: value_of_text(value, key) for key, value in given.items()}
    return Entry(name, {**content, "source": "own"}, {"own": source}) if source else Entry(name, content)


OWN = OwnCatalogue(
    group="materials",
    editor=MATERIALS,
    own=lambda: user_catalogue_path(),
    entry="material",
    called="catalogue",
    key="material",
    count=lambda path: len(load_layer(path).materials),
    shipped=lambda: [(layer.file, len(layer.materials)) for layer in shipped_layers()],
    examples=("my-alloy", "alloy-80"),
    helps=_HELPS,
    such_as="density='3000 kg/m^3'",
    made=_made,
    found=lambda path: partial(find_entry, lw.materials.with_file(path).catalogue),
    known=lambda path: lw.materials.with_file(path),
    priced=lambda: [name for layer in shipped_layers() for name in layer.materials],
    doubts=lambda path: [doubt for material in load_layer(path).materials.values() for doubt in doubts_of(material)],
    keys=MappingProxyType({short: name for name, short in SHORT.items()}),
    read={
        ".yaml": MATERIALS.entries,
        ".FCMat": lambda path: (read_card(path),),
        ".csv": MATERIALS.read_table,
        ".xlsx": MATERIALS.read_table,
    },
)


def export_materials(
    names: Names = None,
    out: Annotated[
        Path, typer.Option("--out", metavar="FILE", help="A .yaml, .FCMat, .csv, .parquet, .md or .tex file.")
    ] = Path("materials.yaml"),
    old: Annotated[bool, typer.Option("--freecad-0.21", help="The card format up to FreeCAD 0.21.")] = False,
    catalogue: CatalogueFile = None,
) -> None:
    """Write materials to a file: .yaml with everything, .FCMat (FreeCAD) or .csv with the values at 20 degC.

    Their figures alone to .tex, .md or .parquet.

    Example: linkwright materials export steel-s355 aluminium-6061-t6 --out metals.csv
    """
    known = lw.materials.with_file(catalogue).catalogue

    def materials(found: Sequence[Entry]) -> list[Material]:
        return [known.find(each.name) for each in found]

    def card(found: Sequence[Entry]) -> str:
        if len(found) != 1:
            raise InputError(out, "", f"a card holds one material, not {len(found)}; name one")
        return write_card(materials(found)[0], "ini" if old else "yaml")

    def table(found: Sequence[Entry]) -> str:
        return write_table(materials(found))

    ways = {".yaml": MATERIALS.text, ".FCMat": card, ".csv": table}
    OWN.write(out, [known.find(name).name for name in names] if names else list(known.names), catalogue, ways)
