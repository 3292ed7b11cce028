"""Edits of a catalogue of materials (`catalogues.editor`): single keys, and the sources that their values are from."""

from __future__ import annotations

import re
from collections.abc import Mapping as MappingLike
from collections.abc import Sequence
from pathlib import Path
from typing import Any, ClassVar, cast

from linkwright.core.catalogues.editor import Editor, Place
from linkwright.core.catalogues.materials_as_text import NEW_FILE, Entry, put, reference, shipped_entry
from linkwright.core.catalogues.yaml_edit import YamlText
from linkwright.core.materials.catalogue import read_layer
from linkwright.core.materials.material import property_kinds
from linkwright.core.units.reading import Mapping, parse_yaml

_LAWS = ("value", "table", "polynomial")


class MaterialsEditor(Editor[Entry]):
    """Edits of a catalogue of materials."""

    what: ClassVar[str] = "material"
    new_file: ClassVar[str] = NEW_FILE

    def check(self, text: str, path: Path | str) -> None:
        """As it is checked on load."""
        read_layer(Mapping(parse_yaml(text, file=path), file=path), Path(path).stem)

    def names(self, document: YamlText) -> list[str]:
        """The materials of a file."""
        return list(document.get(["materials"]) or {})

    def find(self, document: YamlText, name: str) -> Place | None:
        """Under `materials`."""
        return ["materials", name] if isinstance(document.get(["materials", name]), dict) else None

    def shipped(self, name: str) -> Entry | None:
        """The shipped entry as it is written."""
        return shipped_entry(name)

    def put(self, document: YamlText, entries: Sequence[Entry]) -> None:
        """With the sources that they name."""
        put(document, *entries)

    def take_out(self, document: YamlText, place: Place) -> None:
        """With all its keys; sources stay."""
        document.remove(place)

    def set_name(self, document: YamlText, place: Place, name: str) -> None:
        """At its place."""
        document.rename(place, name)

    def key(self, name: str) -> str:
        """Where it stands."""
        return f"materials.{name}"

    def set_keys(self, path: Path | str, name: str, values: MappingLike[str, Any], *, source: str = "") -> str:
        """Set keys of a material, such as `title`, `density` or `cost.spread`, all of them or none.

        A plain value given to a property that is written as a mapping becomes its value, and the rest of the mapping
        (source, note, range) stays. `source` is the text of the source that the new value is from.
        """

        def change(document: YamlText) -> str:
            copied = self.copy_shipped(document, path, name)
            for key, value in values.items():
                keys = key.split(".")
                _set(document, ["materials", name], keys, value)
                if keys[-1] == keys[0] or keys[1] in _LAWS:
                    _unmark(document, name, keys[0], "found_in")
                if source:
                    _cite(document, name, keys[0], source, fresh=len(keys) == 1 and not isinstance(value, dict))
            set_ = ", ".join(f"{name}.{key}" for key in values)
            return f"set {set_}" + (", copied from the shipped catalogue" if copied else "")

        return self.edit(path, change)

    def remove_key(self, path: Path | str, name: str, key: str) -> str:
        """Take one key of a material away."""

        def change(document: YamlText) -> str:
            self.copy_shipped(document, path, name)
            document.remove(["materials", name, *key.split(".")])
            _confirm(document, name, key)
            return f"removed {name}.{key}"

        return self.edit(path, change)


MATERIALS = MaterialsEditor()


def _cite(document: YamlText, name: str, property_name: str, source: str, *, fresh: bool) -> None:
    """Make `source` the source of one property, or of the whole entry for a key that is no property.

    With a `fresh` value, what was said of the old one goes: its note, its spread, that it is unconfirmed.
    """
    slug = re.sub(r"[^a-z0-9]+", "-", source.lower()).strip("-")[:40].strip("-")
    key = reference(document, slug, source)
    path = ["materials", name, property_name]
    value = document.get(path)
    if fresh:
        _confirm(document, name, property_name)
    if isinstance(value, dict):
        document.set([*path, "source"], key)
        for stale in ("note", "spread"):
            if fresh and stale in value:
                document.remove([*path, stale])
    elif property_name in property_kinds() or property_name == "magnetic":
        document.set(path, {"value": value, "source": key})
    else:
        document.set(["materials", name, "source"], key)


def _confirm(document: YamlText, name: str, property_name: str) -> None:
    """Take away what is said of whether a property was found in its source."""
    for mark in ("unconfirmed", "found_in"):
        _unmark(document, name, property_name, mark)


def _unmark(document: YamlText, name: str, property_name: str, mark: str) -> None:
    marks = document.get(["materials", name, mark])
    if isinstance(marks, dict) and property_name in marks:
        last = len(cast(dict[str, Any], marks)) == 1
        document.remove(["materials", name, mark, *([] if last else [property_name])])


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
