"""Edits of a catalogue file: each is checked as the whole file would be on load, and lands whole or not at all.

What surrounds an edit, its comments, order and layout, stays as it is (see yaml_text.py); locking, atomic replacement
and undo are in store.py. The shipped catalogue is never written: changing one of its materials puts a copy of it, with
its sources, into the file first, where it hides the shipped one.
"""

from __future__ import annotations

import operator
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, cast

from materials.catalogue import read_layer
from materials.material import property_kinds
from materials.quantities import InputError
from materials.reading import Mapping, load_yaml, nearest, parse_yaml, read_text
from materials.store import edit_text
from materials.written import NEW_FILE, Entry, put, reference, shipped_entry
from materials.yaml_text import YamlText

_LAWS = ("value", "table", "polynomial")


def add(path: Path | str, entry: Entry, *, replace: bool = False) -> str:
    """Add a material to the file at `path`, which is made where it is not there; returns what was done.

    Raises `InputError` where the name is taken (unless `replace`), or the entry is not what a catalogue can hold.
    """

    def change(document: YamlText) -> str:
        taken = _has(document, entry.name)
        if taken and not replace:
            raise InputError(path, f"materials.{entry.name}", "is there already; edit it, or replace it")
        put(document, entry)
        return f"{'replaced' if taken else 'added'} {entry.name}"

    return _edit(path, change)


def add_all(path: Path | str, entries: Sequence[Entry], *, replace: bool = False) -> str:
    """Add several materials in one edit: all of them or none. Raises `InputError` as `add` does."""

    def change(document: YamlText) -> str:
        names = [entry.name for entry in entries]
        for entry in entries:
            if names.count(entry.name) > 1:
                raise InputError(path, f"materials.{entry.name}", "comes twice")
            if _has(document, entry.name) and not replace:
                raise InputError(path, f"materials.{entry.name}", "is there already; use another name, or replace it")
        put(document, *entries)
        return f"added {', '.join(entry.name for entry in entries)}"

    return _edit(path, change)


def set_key(path: Path | str, name: str, key: str, value: Any, *, source: str = "") -> str:
    """Set one key of a material, such as `title`, `density` or `cost.spread`; returns what was done.

    A plain value given to a property that is written as a mapping becomes its value, and the rest of the mapping
    (source, note, range) stays. `source` is the text of the source that the new value is from. A shipped material is
    copied into the file first. Raises `InputError`.
    """
    keys = key.split(".")

    def change(document: YamlText) -> str:
        copied = _copy_shipped(document, path, name)
        _set(document, ["materials", name], keys, value)
        if source:
            _cite(document, name, keys[0], source, fresh=len(keys) == 1 and not isinstance(value, dict))
        return f"set {name}.{key}" + (", copied from the shipped catalogue" if copied else "")

    return _edit(path, change)


def remove_key(path: Path | str, name: str, key: str) -> str:
    """Take one key of a material away. Raises `InputError`."""

    def change(document: YamlText) -> str:
        _copy_shipped(document, path, name)
        document.remove(["materials", name, *key.split(".")])
        return f"removed {name}.{key}"

    return _edit(path, change)


def remove(path: Path | str, name: str) -> str:
    """Take a material out of the file; returns what was done. Raises `InputError` where the file has it not."""

    def change(document: YamlText) -> str:
        _require(document, path, name)
        document.remove(["materials", name])
        return f"removed {name}"

    return _edit(path, change)


def rename(path: Path | str, name: str, new_name: str) -> str:
    """Give a material of the file another name. Raises `InputError` where it is taken or cannot be a name."""

    def change(document: YamlText) -> str:
        _require(document, path, name)
        if _has(document, new_name):
            raise InputError(path, f"materials.{new_name}", "is there already")
        document.rename(["materials", name], new_name)
        return f"renamed {name} to {new_name}"

    return _edit(path, change)


def draft(path: Path | str, name: str) -> tuple[str | None, str]:
    """Return the file's text (None where there is no file) and the text to hand to an editor.

    The second one has the material in any case: a shipped one is copied in. Raises `InputError`.
    """
    before = read_text(path) if Path(path).exists() else None
    document = YamlText(before if before is not None and before.strip() else NEW_FILE, file=path)
    _copy_shipped(document, path, name)
    return before, document.text


def land(path: Path | str, before: str | None, text: str) -> str:
    """Put an edited text in place of the file, checked; returns what was done.

    Raises `InputError` where it is no catalogue, or the file is no longer as it was `before`.
    """

    return land_yaml(path, before, text, check=lambda changed: _check(path, changed))


def land_yaml(path: Path | str, before: str | None, text: str, *, check: Callable[[str], object]) -> str:
    """Put an edited text in place of any file of ours; `check` raises `InputError` where it is not what it should be.

    Raises `InputError` as well where the file is no longer as it was `before`.
    """

    def whole(current: str | None) -> tuple[str, str]:
        if current != before:
            raise InputError(path, "", "has been changed by somebody else meanwhile; nothing was written")
        check(text)
        return text, "edited the file"

    return edit_text(path, whole)


def edit_yaml(
    path: Path | str, change: Callable[[YamlText], str], *, new_file: str, check: Callable[[str], object]
) -> str:
    """Change a file of ours under its lock, in its journal; returns what `change` says that it did.

    `new_file` is the text that a missing or empty file begins as. `check` gets the whole text that would land and
    raises `InputError` where it may not.
    """

    def whole(before: str | None) -> tuple[str, str]:
        document = YamlText(new_file if before is None or not before.strip() else before, file=path)
        what = change(document)
        check(document.text)
        return document.text, what

    return edit_text(path, whole)


def uses(
    path: Path | str, name: str, *, key: str = "material", same: Callable[[str, str], bool] = operator.eq
) -> bool:
    """Tell whether an arm or problem file has the name anywhere under the key, alone or in a list.

    `same` tells whether two names mean the same. Raises `InputError`.
    """
    return _names(load_yaml(path).content, key, lambda other: isinstance(other, str) and same(other, name))


def _names(value: object, wanted: str, meant: Callable[[object], bool]) -> bool:
    if isinstance(value, dict):
        for key, inner in cast(dict[str, object], value).items():
            listed = cast(list[object], inner) if isinstance(inner, list) else [inner]
            if key == wanted and any(meant(each) for each in listed):
                return True
            if _names(inner, wanted, meant):
                return True
    if isinstance(value, list):
        return any(_names(inner, wanted, meant) for inner in cast(list[object], value))
    return False


def _edit(path: Path | str, change: Callable[[YamlText], str]) -> str:
    return edit_yaml(path, change, new_file=NEW_FILE, check=lambda text: _check(path, text))


def _check(path: Path | str, text: str) -> None:
    read_layer(Mapping(parse_yaml(text, file=path), file=path), Path(path).stem)


def _has(document: YamlText, name: str) -> bool:
    return isinstance(document.get(["materials", name]), dict)


def _require(document: YamlText, path: Path | str, name: str) -> None:
    if _has(document, name):
        return
    if shipped_entry(name) is not None:
        raise InputError(path, f"materials.{name}", "is not in this file but shipped with the program, and stays there")
    known = list(document.get(["materials"]) or {})
    raise InputError(path, f"materials.{name}", f"there is no such material in this file{nearest(name, known)}")


def _copy_shipped(document: YamlText, path: Path | str, name: str) -> bool:
    if _has(document, name):
        return False
    shipped = shipped_entry(name)
    if shipped is None:
        _require(document, path, name)
        return False
    put(document, shipped)
    return True


def _cite(document: YamlText, name: str, property_name: str, source: str, *, fresh: bool) -> None:
    """Make `source` the source of one property, or of the whole entry for a key that is no property.

    With a `fresh` value, what the old source said of the old one goes: its note and its spread.
    """
    slug = re.sub(r"[^a-z0-9]+", "-", source.lower()).strip("-")[:40].strip("-")
    key = reference(document, slug, source)
    path = ["materials", name, property_name]
    value = document.get(path)
    if isinstance(value, dict):
        document.set([*path, "source"], key)
        for stale in ("note", "spread"):
            if fresh and stale in value:
                document.remove([*path, stale])
    elif property_name in property_kinds() or property_name == "magnetic":
        document.set(path, {"value": value, "source": key})
    else:
        document.set(["materials", name, "source"], key)


def _set(document: YamlText, at: Sequence[str], keys: Sequence[str], value: Any) -> None:
    path = [*at, *keys]
    old = document.get(path)
    if len(keys) == 1 and isinstance(old, dict) and not isinstance(value, dict):
        laws = [law for law in _LAWS if law in old]
        if laws == ["value"]:
            document.set([*path, "value"], value)
        else:
            kept = {key: entry for key, entry in cast(dict[str, Any], old).items() if key not in _LAWS}
            document.set(path, {"value": value, **kept})
        return
    parent = document.get(path[:-1])
    if len(keys) > 1 and parent is not None and not isinstance(parent, dict):
        document.set(path[:-1], {"value": parent, keys[-1]: value})
        return
    document.set(path, value)
