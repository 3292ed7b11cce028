"""`linkwright materials import` and `export`: catalogue files, FreeCAD cards and tables."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from linkwright.writing import check_target, write_file
from materials.csv_table import read_table, write_table
from materials.edit import add_all
from materials.fcmat import CardFormat, read_card, write_card
from materials.quantities import InputError
from materials.written import Entry, entries_text, find_entry, read_entries

from .groups import Commands
from .materials_edit import OwnFile, own, say
from .options import CatalogueFile, catalogue_with

IMPORT_HELP = """Put materials from a file into your catalogue: .yaml, .FCMat (FreeCAD) or .csv; all of it or nothing.

Example: linkwright materials import Steel-S235JR.FCMat --name steel-freecad
"""
EXPORT_HELP = """Write materials to a file: .yaml with everything, .FCMat (FreeCAD) or .csv with the values at 20 degC.

Example: linkwright materials export steel-s355 aluminium-6061-t6 --out metals.csv
"""


def import_materials(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A .yaml, .FCMat or .csv file.")],
    name: Annotated[str, typer.Option("--name", help="The name to give the one material of the file.")] = "",
    replace: Annotated[bool, typer.Option("--replace", help="Take the place of those of the same name.")] = False,
    catalogue: OwnFile = None,
) -> None:
    """Run `materials import`."""
    entries = _read(file)
    if name:
        if len(entries) != 1:
            raise InputError(file, "", f"has {len(entries)} materials; --name is for one")
        entries = (Entry(name, entries[0].content, entries[0].references),)
    path = own(catalogue)
    say(add_all(path, entries, replace=replace), path)


def _read(file: Path) -> tuple[Entry, ...]:
    ending = file.suffix.lower()
    if ending in (".yaml", ".yml"):
        return read_entries(file)
    if ending == ".fcmat":
        return (read_card(file),)
    if ending == ".csv":
        return read_table(file)
    raise InputError(file, "", "is of no known kind; known: .yaml, .FCMat, .csv")


def export_materials(
    names: Annotated[list[str] | None, typer.Argument(metavar="[NAME...]", help="Which; all without a name.")] = None,
    out: Annotated[Path, typer.Option("--out", metavar="FILE", help="A .yaml, .FCMat or .csv file.")] = Path(
        "materials.yaml"
    ),
    old: Annotated[bool, typer.Option("--freecad-0.21", help="The card format up to FreeCAD 0.21.")] = False,
    catalogue: CatalogueFile = None,
) -> None:
    """Run `materials export`."""
    check_target(out, catalogue)
    known = catalogue_with(catalogue)
    found = [known.find(name) for name in names] if names else list(known)
    ending = out.suffix.lower()
    if ending == ".csv":
        text = write_table(found)
    elif ending == ".fcmat":
        if len(found) != 1:
            raise InputError(out, "", f"a card holds one material, not {len(found)}; name one")
        form: CardFormat = "ini" if old else "yaml"
        text = write_card(found[0], form)
    elif ending in (".yaml", ".yml"):
        text = entries_text([find_entry(known, material.name) for material in found])
    else:
        raise InputError(out, "", "is of no known kind; known: .yaml, .FCMat, .csv")
    write_file(out, text)
    count = len(found)
    typer.echo(f"wrote {count} material{'' if count == 1 else 's'} to {out}")


def commands() -> Commands:
    """These commands by name."""
    return {"import": (import_materials, IMPORT_HELP), "export": (export_materials, EXPORT_HELP)}
