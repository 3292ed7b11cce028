"""`linkwright materials add`, `edit`, `remove`, `rename`, `undo`, `check`: changes to a catalogue of one's own."""

from __future__ import annotations

import os
import shlex
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from materials import store
from materials.catalogue import load_layer, shipped_layers, user_catalogue_path
from materials.edit import add, draft, land, remove, remove_key, rename, set_key, uses
from materials.quantities import InputError
from materials.reading import parse_yaml
from materials.written import Entry

from .groups import Commands

ADD_HELP = """Add a material to your catalogue.

Example: linkwright materials add my-alloy elastic_modulus='80 GPa' density='3000 kg/m^3' --source 'Data sheet 12'
"""
EDIT_HELP = """Change one key of a material, or the catalogue file in $EDITOR; a shipped material is copied to yours.

Example: linkwright materials edit steel-s355 cost '1.30 EUR/kg' --source 'Offer of 3 March'
"""
REMOVE_HELP = """Take a material out of your catalogue.

Example: linkwright materials remove my-alloy --used-in arm.yaml
"""
RENAME_HELP = """Give a material of your catalogue another name.

Example: linkwright materials rename my-alloy alloy-80 --used-in arm.yaml
"""
UNDO_HELP = """Take the last edit of your catalogue back; again for the one before.

Example: linkwright materials undo
"""
CHECK_HELP = """Check catalogue files: units, ranges, sources, E, G and nu; without a file the shipped ones and yours.

Example: linkwright materials check materials.yaml
"""

OwnFile = Annotated[
    Path | None, typer.Option("--catalogue", metavar="FILE", help="The catalogue to change; your own without it.")
]
UsedIn = Annotated[
    list[Path] | None,
    typer.Option("--used-in", metavar="FILE", help="Warn if this arm or problem file uses it; may be repeated."),
]
Source = Annotated[str, typer.Option("--source", metavar="TEXT", help="Where the figures are from.")]
Name = Annotated[str, typer.Argument(metavar="NAME", help="The material's name.")]


def own(catalogue: Path | None) -> Path:
    """The catalogue file to change."""
    return user_catalogue_path() if catalogue is None else catalogue


def say(text: str, path: Path) -> None:
    """Tell what was done, and where."""
    typer.echo(f"{text} ({path})")


def _value(text: str, key: str) -> Any:
    """A value as YAML reads it: `71 GPa`, `0.3`, `[1 EUR/kg, 2 EUR/kg]`, `{value: 71 GPa, source: x}`."""
    if text.lstrip().startswith(("[", "{")):
        return parse_yaml(text, file=f"the value of {key}")
    found = (
        parse_yaml(f"[{text}]", file="") if not set(text) & set(",[]{}#&*!|>%@`'\"\n") and ": " not in text else None
    )
    return found[0] if isinstance(found, list) and len(found) == 1 and found[0] is not None else text


def add_material(
    name: Name,
    values: Annotated[list[str], typer.Argument(metavar="KEY=VALUE...", help="Its properties, title and so on.")],
    source: Source = "",
    replace: Annotated[bool, typer.Option("--replace", help="Take the place of one of that name.")] = False,
    catalogue: OwnFile = None,
) -> None:
    """Run `materials add`."""
    content: dict[str, Any] = {}
    for text in values:
        key, equals, value = text.partition("=")
        if not equals or not key.strip() or not value.strip():
            raise InputError("", text, "is not KEY=VALUE, such as density='3000 kg/m^3'")
        content[key.strip()] = _value(value.strip(), key)
    if source:
        content["source"] = "own"
    path = own(catalogue)
    say(add(path, Entry(name, content, {"own": source} if source else {}), replace=replace), path)


def edit_material(
    name: Name,
    key: Annotated[str | None, typer.Argument(metavar="KEY", help="Such as density, cost.spread or title.")] = None,
    value: Annotated[str | None, typer.Argument(metavar="VALUE", help="Its new value.")] = None,
    source: Source = "",
    unset: Annotated[bool, typer.Option("--unset", help="Take the key away.")] = False,
    catalogue: OwnFile = None,
) -> None:
    """Run `materials edit`."""
    path = own(catalogue)
    if key is None:
        before, text = draft(path, name)
        in_editor(path, text, lambda edited: land(path, before, edited))
    elif unset:
        if value is not None:
            raise InputError("", "--unset", "takes no value")
        say(remove_key(path, name, key), path)
    elif value is None:
        raise InputError("", "VALUE", f"is missing: give {key} a value, or --unset")
    else:
        say(set_key(path, name, key, _value(value, key), source=source), path)


def in_editor(path: Path, text: str, land: Callable[[str], str]) -> None:
    """Hand a copy of a file to the editor, and let `land` put it in place once it is closed and sound."""
    command = shlex.split(os.environ.get("VISUAL", "").strip() or os.environ.get("EDITOR", "").strip())
    if not command:
        raise InputError("", "$EDITOR", "is not set; set it, or give KEY and VALUE")
    with tempfile.NamedTemporaryFile(
        "w", prefix=f"{path.stem}-", suffix=".yaml", delete=False, encoding="utf-8", newline=""
    ) as stream:
        stream.write(text)
    copy = Path(stream.name)
    try:
        ended = subprocess.run([*command, str(copy)], check=False).returncode
    except OSError as error:
        copy.unlink()
        raise InputError("", "$EDITOR", f"cannot be run: {error.strerror or error}") from None
    edited = copy.read_bytes().decode("utf-8", errors="replace")
    if ended != 0 or edited == text:
        copy.unlink()
        if ended != 0:
            raise InputError("", "$EDITOR", f"ended with status {ended}; nothing was changed")
        typer.echo("nothing was changed")
        return
    try:
        done = land(edited)
    except InputError as error:
        raise InputError("", "", f"{error}; nothing was changed, your text is in {copy}") from None
    copy.unlink()
    say(done, path)


def _warn(name: str, files: list[Path] | None) -> None:
    """Warn on standard error of each file that uses the material."""
    for file in files or ():
        if uses(file, name):
            typer.echo(f"WARNING: {file} uses {name}", err=True)


def remove_material(name: Name, used_in: UsedIn = None, catalogue: OwnFile = None) -> None:
    """Run `materials remove`."""
    path = own(catalogue)
    _warn(name, used_in)
    done = remove(path, name)
    shipped = any(name in layer.materials for layer in shipped_layers())
    say(done + ("; the shipped one shows again" if shipped else ""), path)


def rename_material(
    name: Name,
    new_name: Annotated[str, typer.Argument(metavar="NEW", help="Its new name.")],
    used_in: UsedIn = None,
    catalogue: OwnFile = None,
) -> None:
    """Run `materials rename`."""
    path = own(catalogue)
    _warn(name, used_in)
    say(rename(path, name, new_name), path)


def undo_edit(catalogue: OwnFile = None) -> None:
    """Run `materials undo`."""
    path = own(catalogue)
    say(f"undone: {store.undo(path)}", path)


def check_files(
    files: Annotated[list[Path] | None, typer.Argument(metavar="[FILE...]", help="Catalogue files.")] = None,
    catalogue: Annotated[
        Path | None, typer.Option("--catalogue", metavar="FILE", help="One more catalogue file to check.")
    ] = None,
) -> None:
    """Run `materials check`."""
    given = [*(files or ()), *([catalogue] if catalogue is not None else [])]
    layers = [load_layer(path) for path in given]
    if not given:
        layers = [*shipped_layers(), *([load_layer(path)] if (path := user_catalogue_path()).exists() else [])]
    for layer in layers:
        count = len(layer.materials)
        typer.echo(f"{layer.file}: {count} material{'' if count == 1 else 's'}, all sound")


def commands() -> Commands:
    """These commands by name."""
    return {
        "add": (add_material, ADD_HELP),
        "edit": (edit_material, EDIT_HELP),
        "remove": (remove_material, REMOVE_HELP),
        "rename": (rename_material, RENAME_HELP),
        "undo": (undo_edit, UNDO_HELP),
        "check": (check_files, CHECK_HELP),
    }
