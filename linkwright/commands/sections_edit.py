"""`linkwright sections add`, `edit`, `remove`, `rename`, `undo`, `check`: changes to stock tables of one's own."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated

import typer

from materials import store
from materials.edit import uses
from materials.quantities import InputError
from materials.reading import read_text
from sections.stock import plain_name, shipped_sizes, user_stock_path

from . import sections_rows
from .groups import Commands
from .materials_edit import Source, in_editor, say

ADD_HELP = """Add a stock size to your tables; printed figures, where given, must be those of its dimensions.

Example: linkwright sections add 'TUBE 60x4' shape=tube diameter='60 mm' thickness='4 mm' --source 'Offer 12'
"""
EDIT_HELP = """Change keys of a stock size, or the file in $EDITOR; a shipped size is copied to yours.

Example: linkwright sections edit 'TUBE 60x4' thickness '5 mm'
"""
REMOVE_HELP = """Take a stock size out of your tables.

Example: linkwright sections remove 'TUBE 60x4' --used-in arm.yaml
"""
RENAME_HELP = """Give a stock size of your tables another name.

Example: linkwright sections rename 'TUBE 60x4' 'OUR 60x4' --used-in arm.yaml
"""
UNDO_HELP = """Take the last edit of your tables back; again for the one before.

Example: linkwright sections undo
"""
CHECK_HELP = """Recompute A and I of every row of stock tables; without a file those of the shipped ones and yours.

Example: linkwright sections check sections.yaml
"""

OwnFile = Annotated[
    Path | None, typer.Option("--catalogue", metavar="FILE", help="The file to change; your own without it.")
]
UsedIn = Annotated[
    list[Path] | None,
    typer.Option("--used-in", metavar="FILE", help="Warn if this arm or problem file uses it; may be repeated."),
]
Name = Annotated[str, typer.Argument(metavar="NAME", help="The size's name.")]


def own(catalogue: Path | None) -> Path:
    """The file of stock sizes to change."""
    return user_stock_path() if catalogue is None else catalogue


def _pairs(texts: list[str]) -> dict[str, str]:
    found: dict[str, str] = {}
    for text in texts:
        key, equals, value = (part.strip() for part in text.partition("="))
        if not equals or not key or not value:
            raise InputError("", text, "is not KEY=VALUE, such as thickness='4 mm'")
        if key in found:
            raise InputError("", key, "is given twice")
        found[key] = value
    return found


def add_section(
    name: Name,
    values: Annotated[
        list[str],
        typer.Argument(metavar="KEY=VALUE...", help="Its shape, family, dimensions and printed figures."),
    ],
    source: Source = "",
    replace: Annotated[bool, typer.Option("--replace", help="Take the place of one of that name.")] = False,
    catalogue: OwnFile = None,
) -> None:
    """Run `sections add`."""
    given = _pairs(values)
    if "shape" not in given:
        raise InputError("", "shape", "is missing; write shape=tube, say")
    if not source:
        raise InputError("", "--source", "is missing: say where the size is from")
    shape = given.pop("shape")
    sections_rows.columns_of(shape)
    found = re.match(r"[^\d]*[^\d\s]", name)
    family = given.pop("family", found[0] if found else name)
    cells = dict(sections_rows.cell(shape, key, value) for key, value in given.items())
    path = own(catalogue)
    say(sections_rows.add(path, [sections_rows.Row(name, family, shape, source, cells)], replaced=replace), path)


def edit_section(
    name: Name,
    changes: Annotated[
        list[str] | None,
        typer.Argument(metavar="[KEY VALUE | KEY=VALUE...]", help="What to change; nothing opens the editor."),
    ] = None,
    source: Source = "",
    unset: Annotated[str | None, typer.Option("--unset", metavar="KEY", help="Take this key away.")] = None,
    catalogue: OwnFile = None,
) -> None:
    """Run `sections edit`."""
    path = own(catalogue)
    if unset is not None:
        if changes or source:
            raise InputError("", "--unset", "stands alone")
        say(sections_rows.remove_cell(path, name, unset), path)
    elif changes or source:
        say(sections_rows.change_cells(path, name, _changes(changes or []), source=source), path)
    else:
        before, text = sections_rows.draft(path, name)
        in_editor(path, text, lambda edited: sections_rows.land(path, before, edited))


def _changes(words: list[str]) -> dict[str, str]:
    if any("=" in word for word in words[:1]):
        return _pairs(words)
    if len(words) == 1:
        raise InputError("", "VALUE", f"is missing: give {words[0]} a value, or --unset {words[0]}")
    if len(words) > 2:
        raise InputError("", words[2], "is too much: one KEY VALUE, or several KEY=VALUE")
    return {words[0]: words[1]} if words else {}


def _warn(name: str, files: list[Path] | None) -> None:
    """Warn on standard error of each file that uses the size."""
    for file in files or ():
        if uses(file, name, key="section", same=lambda one, other: plain_name(one) == plain_name(other)):
            typer.echo(f"WARNING: {file} uses {name}", err=True)


def remove_section(name: Name, used_in: UsedIn = None, catalogue: OwnFile = None) -> None:
    """Run `sections remove`."""
    path = own(catalogue)
    _warn(name, used_in)
    done = sections_rows.remove(path, name)
    shipped = any(plain_name(size.name) == plain_name(name) for size in shipped_sizes())
    say(done + ("; the shipped one shows again" if shipped else ""), path)


def rename_section(
    name: Name,
    new_name: Annotated[str, typer.Argument(metavar="NEW", help="Its new name.")],
    used_in: UsedIn = None,
    catalogue: OwnFile = None,
) -> None:
    """Run `sections rename`."""
    path = own(catalogue)
    _warn(name, used_in)
    say(sections_rows.rename(path, name, new_name), path)


def undo_edit(catalogue: OwnFile = None) -> None:
    """Run `sections undo`."""
    path = own(catalogue)
    say(f"undone: {store.undo(path)}", path)


def check_files(
    files: Annotated[list[Path] | None, typer.Argument(metavar="[FILE...]", help="Files of stock tables.")] = None,
    catalogue: Annotated[
        Path | None, typer.Option("--catalogue", metavar="FILE", help="One more file to check.")
    ] = None,
) -> None:
    """Run `sections check`."""
    given = [*(files or ()), *([catalogue] if catalogue is not None else [])]
    if not given:
        _say_sound("shipped tables", len(shipped_sizes()))
        given = [path] if (path := user_stock_path()).exists() else []
    for path in given:
        _say_sound(str(path), len(sections_rows.check(read_text(path), path)))


def _say_sound(what: str, count: int) -> None:
    typer.echo(f"{what}: {count} size{'' if count == 1 else 's'}, all sound")


def commands() -> Commands:
    """These commands by name."""
    return {
        "add": (add_section, ADD_HELP),
        "edit": (edit_section, EDIT_HELP),
        "remove": (remove_section, REMOVE_HELP),
        "rename": (rename_section, RENAME_HELP),
        "undo": (undo_edit, UNDO_HELP),
        "check": (check_files, CHECK_HELP),
    }
