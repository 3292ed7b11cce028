"""Edits of a catalogue of actuators (`catalogues.editor`): entries as they are written, with the sources they name."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any, ClassVar, cast

from linkwright.core.arm.actuators import CONFIRMABLE, read_actuators
from linkwright.core.catalogues.editor import Editor, Place
from linkwright.core.catalogues.materials_as_text import Entry, entry_in, put, reference
from linkwright.core.catalogues.yaml_edit import YamlText
from linkwright.core.units.reading import Mapping as Keys
from linkwright.core.units.reading import load_yaml, parse_yaml, read_text, shipped_files

NEW_FILE = "format_version: 1\nreferences: {}\nactuators: {}\n"
"""What a file of actuators begins as; each entry says its maker."""


class ActuatorsEditor(Editor[Entry]):
    """Edits of a catalogue of actuators."""

    what: ClassVar[str] = "actuator"
    new_file: ClassVar[str] = NEW_FILE

    def check(self, text: str, path: Path | str) -> None:
        """As it is checked on load."""
        read_actuators(Keys(parse_yaml(text, file=path), file=path))

    def names(self, document: YamlText) -> list[str]:
        """The actuators of a file."""
        return list(document.get(["actuators"]) or {})

    def find(self, document: YamlText, name: str) -> Place | None:
        """Under `actuators`."""
        return ["actuators", name] if isinstance(document.get(["actuators", name]), dict) else None

    def shipped(self, name: str) -> Entry | None:
        """The shipped entry as it is written, with its maker."""
        return next((found for found in (_entry(data, name) for data in _shipped()) if found is not None), None)

    def put(self, document: YamlText, entries: Sequence[Entry]) -> None:
        """With the sources that they name."""
        if document.get(["references"]) is None:
            document.set(["references"], {})
        put(document, *entries, under="actuators")

    def take_out(self, document: YamlText, place: Place) -> None:
        """With all its keys; sources stay."""
        document.remove(place)

    def set_name(self, document: YamlText, place: Place, name: str) -> None:
        """At its place."""
        document.rename(place, name)

    def key(self, name: str) -> str:
        """Where it stands."""
        return f"actuators.{name}"

    def set_keys(self, path: Path | str, name: str, values: Mapping[str, Any], *, source: str = "") -> str:
        """Set keys of an actuator, all of them or none; `source` is the text of where the new values are from.

        An entry has one source: that of values changed is named in it with what it is the source of.
        """

        def change(document: YamlText) -> str:
            copied = self.copy_shipped(document, path, name)
            for key, value in values.items():
                document.set(["actuators", name, *key.split(".")], value)
                _confirm(document, name, key)
            if source:
                known = (document.get(["references"]) or {}).get(document.get(["actuators", name, "source"]), "")
                told = f"{known}; {', '.join(values)}: {source}" if known and known != source else source
                slug = re.sub(r"[^a-z0-9]+", "-", source.lower()).strip("-")[:40].strip("-")
                document.set(["actuators", name, "source"], reference(document, slug, told))
            set_ = ", ".join(f"{name}.{key}" for key in values)
            return f"set {set_}" + (", copied from the shipped catalogue" if copied else "")

        return self.edit(path, change)

    def remove_key(self, path: Path | str, name: str, key: str) -> str:
        """Take one key of an actuator away."""

        def change(document: YamlText) -> str:
            self.copy_shipped(document, path, name)
            document.remove(["actuators", name, *key.split(".")])
            return f"removed {name}.{key}"

        return self.edit(path, change)


ACTUATORS = ActuatorsEditor()


def actuator_entry(name: str, files: Sequence[Path | str]) -> Entry | None:
    """The entry of an actuator as it is written in the last of the files that has it, or else in the shipped ones."""
    for path in reversed(files):
        found = _entry(YamlText(read_text(path), file=path).data, name)
        if found is not None:
            return found
    return ACTUATORS.shipped(name)


def read_entries(path: Path | str) -> tuple[Entry, ...]:
    """The entries of a file of actuators, checked. Raises `InputError`."""
    read_actuators(load_yaml(path))
    data = YamlText(read_text(path), file=path).data
    found = (_entry(data, name) for name in data.get("actuators") or {})
    return tuple(entry for entry in found if entry is not None)


def entries_text(entries: Iterable[Entry]) -> str:
    """The entries as the text of a file of their own."""
    document = YamlText(NEW_FILE, file="")
    ACTUATORS.put(document, list(entries))
    return document.text


def _entry(data: Mapping[str, Any], name: str) -> Entry | None:
    found = entry_in(data, name, under="actuators")
    if found is None:
        return None
    whole = {
        key: data[key] for key in ("maker", "unconfirmed", "found_in") if data.get(key) and key not in found.content
    }
    return Entry(name, {**whole, **found.content}, found.references)


def _confirm(document: YamlText, name: str, key: str) -> None:
    """Take away that a figure could not be confirmed: its new value has a source of its own."""
    marks = document.get(["actuators", name, "unconfirmed"])
    if isinstance(marks, str) and key in CONFIRMABLE:  # of all figures
        document.set(["actuators", name, "unconfirmed"], {each: marks for each in CONFIRMABLE if each != key})
    if isinstance(marks, dict) and key in marks:
        last = len(cast(dict[str, Any], marks)) == 1
        document.remove(["actuators", name, "unconfirmed", *([] if last else [key])])


@cache
def _shipped() -> list[dict[str, Any]]:
    return [cast(dict[str, Any], each.content) for each in shipped_files("linkwright.core.arm.actuators")]
