"""`linkwright materials` on a catalogue of one's own: `add`, `edit`, `import`, `export` and the like."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Annotated

import typer

import linkwright as lw
from linkwright.commands.catalogues.own import (
    OwnCatalogue,
    edit_keys_command,
    price_command,
    value_of_text,
)
from linkwright.commands.groups import Commands
from linkwright.commands.materials.query import SHORT
from linkwright.commands.options import CatalogueFile
from linkwright.core.catalogues.freecad_cards import read_card, write_card
from linkwright.core.catalogues.keyed import Entry
from linkwright.core.catalogues.materials import MATERIALS, find_entry, write_table
from linkwright.core.materials.catalogue import load_layer, shipped_layers, user_catalogue_path
from linkwright.core.materials.material import Material
from linkwright.core.materials.plausible import doubts_of
from linkwright.core.units.quantities import InputError
from linkwright.output.files import check_target
from linkwright.output.table_file import rows_of

ADD_HELP = """Add a material to your catalogue.

Example: linkwright materials add my-alloy elastic_modulus='80 GPa' density='3000 kg/m^3' --source 'Data sheet 12'
"""
EDIT_HELP = """Change keys of a material, or the catalogue file in $EDITOR; a shipped material is copied to yours.

Keys are such as density, E, cost.spread or title; several at once are one edit: KEY=VALUE KEY=VALUE.

Example: linkwright materials edit steel-s355 cost '1.30 EUR/kg' --source 'Offer of 3 March'
"""
PRICE_HELP = """Give a material a price in your catalogue; the rest of it stays where it is.

Example: linkwright materials price steel-s355 '1.3 EUR/kg' --source 'Offer of 3 March'
"""
IMPORT_HELP = """Put materials from a file in your catalogue: .yaml, .FCMat (FreeCAD), .csv, .xlsx; all or nothing.

Example: linkwright materials import Steel-S235JR.FCMat --name steel-freecad
"""
EXPORT_HELP = """Write materials to a file: .yaml with everything, .FCMat (FreeCAD) or .csv with the values at 20 degC.

Their figures alone to .tex, .md or .parquet.

Example: linkwright materials export steel-s355 aluminium-6061-t6 --out metals.csv
"""
CHECK_HELP = "Check catalogue files: units, ranges, sources, E, G and nu; without a file the shipped ones and yours."


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
    helps={"add": ADD_HELP, "import": IMPORT_HELP, "check": CHECK_HELP},
    such_as="density='3000 kg/m^3'",
    made=_made,
    table=lambda path: lw.materials.with_file(path).table,
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
    names: Annotated[list[str] | None, typer.Argument(metavar="[NAME...]", help="Which; all without a name.")] = None,
    out: Annotated[
        Path, typer.Option("--out", metavar="FILE", help="A .yaml, .FCMat, .csv, .parquet, .md or .tex file.")
    ] = Path("materials.yaml"),
    old: Annotated[bool, typer.Option("--freecad-0.21", help="The card format up to FreeCAD 0.21.")] = False,
    catalogue: CatalogueFile = None,
) -> None:
    """Run `materials export`."""
    check_target(out, catalogue)
    known = lw.materials.with_file(catalogue).catalogue

    def card(found: Sequence[Material]) -> str:
        if len(found) != 1:
            raise InputError(out, "", f"a card holds one material, not {len(found)}; name one")
        return write_card(found[0], "ini" if old else "yaml")

    ways: Mapping[str, Callable[[Sequence[Material]], str]] = {
        ".yaml": lambda found: MATERIALS.text(find_entry(known, material.name) for material in found),
        ".FCMat": card,
        ".csv": write_table,
    }
    found = [known.find(name) for name in names] if names else list(known)
    table = lw.materials.with_file(catalogue).table
    OWN.write(out, found, ways, lambda: rows_of(table, [each.name for each in found]))


def commands() -> Commands:
    """These commands by name."""
    price = price_command(OWN, lambda: [name for layer in shipped_layers() for name in layer.materials])
    return OWN.commands(
        {
            "edit": (edit_keys_command(OWN, MATERIALS), EDIT_HELP),
            "export": (export_materials, EXPORT_HELP),
            "price": (price, PRICE_HELP),
        }
    )
