"""Catalogues whose entries stand under their names: what they hold by schema, entries as they are written, and edits.

Edits, imports and exports work on entries as text, so that notes, tables and spreads travel as they are written.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, cast

from linkwright.core.catalogues.csv_table import marks_of, read_rows
from linkwright.core.catalogues.editor import Editor, Place
from linkwright.core.catalogues.yaml_edit import YamlText
from linkwright.core.units.reading import Mapping as Keys
from linkwright.core.units.reading import parse_yaml, read_text

_LAWS = ("value", "table", "polynomial")
_MARKS = ("unconfirmed", "found_in")
_LAST = ("source", "found_in", "unconfirmed")
"""What is said of the figures of a row stands behind them."""


@dataclass(frozen=True)
class Entry:
    """An entry as a catalogue file writes it: its keys as YAML gives them, and the sources that they name."""

    name: str
    content: Mapping[str, Any]
    references: Mapping[str, str] = field(default_factory=dict[str, str])


@dataclass(frozen=True)
class Column:
    """A key of an entry as a column of its tables: how a cell is read (text as it is by default), for file and key; and
    whether every row needs it."""

    name: str
    read: Callable[[str, Path | str, str], Any] = lambda text, _path, _key: text
    needed: bool = False


@dataclass(frozen=True)
class Schema:
    """One kind of catalogue.

    Attributes:
        what: an entry, in one word.
        under: the key of a file that holds its entries.
        read: checks a file's content and returns its entries; raises `InputError`.
        shipped: the files that come with the program.
        figures: the names of the figures that can be marked as not confirmed in their source.
        has_sources: whether each figure can have a separate source (as `{value: ..., source: ...}`); otherwise an
            entry has one for all.
        inherited: an entry's content with what its file (given with the name of its family) says of all its entries.
        columns: the keys that have a place in tables, in the order of a file's entry.
    """

    what: str
    under: str
    read: Callable[[Keys], object]
    shipped: Callable[[], Iterable[Keys]]
    figures: Callable[[], Sequence[str]]
    has_sources: bool
    inherited: Callable[[Mapping[str, Any], str, Mapping[str, Any]], Mapping[str, Any]]
    columns: Callable[[], Sequence[Column]]

    @property
    def new_file(self) -> str:
        """What a file begins as."""
        return f"format_version: 1\nreferences: {{}}\n{self.under}: {{}}\n"

    @property
    def heading(self) -> tuple[str, ...]:
        """The columns of tables, in order."""
        names = [column.name for column in self.columns()]
        return (*(name for name in names if name not in _LAST), *(name for name in _LAST if name in names))


class KeyedEditor(Editor[Entry]):
    """Edits of one kind of catalogue whose entries stand under their names."""

    def __init__(self, schema: Schema) -> None:
        self.schema = schema
        self.what = schema.what
        self.new_file = schema.new_file
        self._shipped: list[tuple[dict[str, Any], str]] | None = None

    def check(self, text: str, path: Path | str) -> None:
        """As it is checked on load."""
        self.schema.read(Keys(parse_yaml(text, file=path), file=path))

    def names(self, document: YamlText) -> list[str]:
        """The entries of a file."""
        return list(document.get([self.schema.under]) or {})

    def find(self, document: YamlText, name: str) -> Place | None:
        """Under the schema's key."""
        place: Place = [self.schema.under, name]
        return place if isinstance(document.get(place), dict) else None

    def shipped(self, name: str) -> Entry | None:
        """The shipped entry as it is written, with what its file says of all."""
        if self._shipped is None:
            files = ((cast(dict[str, Any], item.content), Path(str(item.file)).stem) for item in self.schema.shipped())
            self._shipped = list(files)
        return next((entry for data, stem in self._shipped if (entry := self._entry(data, stem, name))), None)

    def put(self, document: YamlText, entries: Sequence[Entry]) -> None:
        """With the sources that they name; a source's key that the file has for another text gets a new name."""
        if document.get(["references"]) is None:
            document.set(["references"], {})
        under = self.schema.under
        known: dict[str, str] = dict(document.get(["references"]))
        fresh: dict[str, str] = {}
        contents: dict[str, Mapping[str, Any]] = {}
        for entry in entries:
            renamed: dict[str, str] = {}
            for key, text in entry.references.items():
                renamed[key] = _free_key(known, key, text)
                if renamed[key] not in known:
                    known[renamed[key]] = fresh[renamed[key]] = text
            contents[entry.name] = _with_sources(entry.content, renamed)
        document.extend(["references"], fresh)
        for name in [name for name in contents if document.get([under, name]) is not None]:
            document.set([under, name], contents.pop(name), block=True)
        document.extend([under], contents)

    def take_out(self, document: YamlText, place: Place) -> None:
        """With all its keys; sources stay."""
        document.remove(place)

    def key(self, name: str) -> str:
        """Where it stands."""
        return f"{self.schema.under}.{name}"

    def entries(self, path: Path | str) -> tuple[Entry, ...]:
        """The entries of a file, checked. Raises `InputError`."""
        text = read_text(path)
        data = YamlText(text, file=path).data
        self.check(text, path)
        entries = (self._entry(data, Path(path).stem, name) for name in data.get(self.schema.under) or {})
        return tuple(entry for entry in entries if entry is not None)

    def entry(self, name: str, files: Sequence[Path | str]) -> Entry | None:
        """The entry as it is written in the last of the files that has it, or else in the shipped ones."""
        for path in reversed(files):
            if (entry := self._entry(YamlText(read_text(path), file=path).data, Path(path).stem, name)) is not None:
                return entry
        return self.shipped(name)

    def text(self, entries: Iterable[Entry]) -> str:
        """The entries as the text of a separate file."""
        document = YamlText(self.new_file, file="")
        self.put(document, list(entries))
        return document.text

    def read_table(self, path: Path | str) -> tuple[Entry, ...]:
        """The entries of a table, a row each; columns may be missing or in another order. The `source` of a row is one
        text for all of it. Raises `InputError`."""
        columns = self.schema.columns()

        def entry(cells: dict[str, str], where: str) -> Entry:
            row = {"source": f"table {Path(path).name}", **cells}
            content: dict[str, Any] = {
                column.name: column.read(row[column.name], path, f"{where}: {column.name}")
                for column in columns
                if column.name in row
            }
            source, content["source"] = content["source"], "table"
            marks = content.pop("unconfirmed", "")
            if marks:
                content["unconfirmed"] = marks_of(marks, self.schema.figures(), path, f"{where}: unconfirmed")
            return Entry(content.pop("name"), content, {"table": source})

        return read_rows(path, self.schema.heading, [column.name for column in columns if column.needed], entry)

    def _entry(self, data: Mapping[str, Any], stem: str, name: str) -> Entry | None:
        content = (data.get(self.schema.under) or {}).get(name)
        if not isinstance(content, dict):
            return None
        references: dict[str, str] = data.get("references") or {}
        content = cast(dict[str, Any], content)
        used = {key: references[key] for key in dict.fromkeys(_sources_of(content)) if key in references}
        return Entry(name, self.schema.inherited(data, stem, content), used)

    def set_keys(self, path: Path | str, name: str, values: Mapping[str, Any], *, source: str = "") -> str:
        """Set keys of an entry, such as `title`, `density` or `cost.spread`, all of them or none.

        A plain value given to a figure that is written as a mapping becomes its value, and the rest of the mapping
        (source, note, range) stays. `source` is the text of the source that the new values are from.
        """

        def change(document: YamlText) -> str:
            copied, at = self.copy_shipped(document, path, name), [self.schema.under, name]
            for key, value in values.items():
                keys = key.split(".")
                _set(document, at, keys, value)
                whole = len(keys) == 1 or keys[1] in _LAWS
                if whole:
                    self._unmark(document, at, keys[0], "found_in")
                if not self.schema.has_sources:
                    self._unmark(document, at, key, "unconfirmed")
                elif source:
                    self._cite(document, at, keys[0], source, fresh=len(keys) == 1 and not isinstance(value, dict))
            if source and not self.schema.has_sources:
                known = (document.get(["references"]) or {}).get(document.get([*at, "source"]), "")
                text = f"{known}; {', '.join(values)}: {source}" if known and known != source else source
                document.set([*at, "source"], _reference(document, source, text))
            done = ", ".join(f"{name}.{key}" for key in values)
            return f"set {done}" + (", copied from the shipped catalogue" if copied else "")

        return self.edit(path, change)

    def remove_key(self, path: Path | str, name: str, key: str) -> str:
        """Take one key of an entry away."""

        def change(document: YamlText) -> str:
            self.copy_shipped(document, path, name)
            document.remove([self.schema.under, name, *key.split(".")])
            for mark in _MARKS:
                self._unmark(document, [self.schema.under, name], key, mark)
            return f"removed {name}.{key}"

        return self.edit(path, change)

    def _cite(self, document: YamlText, at: Sequence[str], figure: str, source: str, *, fresh: bool) -> None:
        """Make `source` the source of one figure, or of the whole entry for a key that is no figure.

        With a `fresh` value, what was said of the old one goes: its note, its spread, that it is unconfirmed.
        """
        key = _reference(document, source, source)
        path = [*at, figure]
        value = document.get(path)
        if fresh:
            for mark in _MARKS:
                self._unmark(document, at, figure, mark)
        if isinstance(value, dict):
            document.set([*path, "source"], key)
            for stale in ("note", "spread"):
                if fresh and stale in value:
                    document.remove([*path, stale])
        elif figure in self.schema.figures():
            document.set(path, {"value": value, "source": key})
        else:
            document.set([*at, "source"], key)

    def _unmark(self, document: YamlText, at: Sequence[str], figure: str, mark: str) -> None:
        """Take away what is said of whether a figure was found in its source."""
        marks = document.get([*at, mark])
        if isinstance(marks, str) and mark == "unconfirmed" and figure in self.schema.figures():  # of all figures
            document.set([*at, mark], {item: marks for item in self.schema.figures() if item != figure})
        if isinstance(marks, dict) and figure in marks:
            last = len(cast(dict[str, Any], marks)) == 1
            document.remove([*at, mark, *([] if last else [figure])])


def _set(document: YamlText, at: Sequence[str], keys: Sequence[str], value: Any) -> None:
    path = [*at, *keys]
    old = document.get(path)
    if len(keys) == 1 and isinstance(old, dict) and not isinstance(value, dict):
        laws = [law for law in _LAWS if law in old]
        if laws == ["value"]:
            document.set([*path, "value"], value)
        else:
            content = {key: entry for key, entry in cast(dict[str, Any], old).items() if key not in _LAWS}
            document.set(path, {"value": value, **content})
        return
    parent = document.get(path[:-1])
    if len(keys) > 1 and parent is not None and not isinstance(parent, dict):
        document.set(path[:-1], {"value": parent, keys[-1]: value})
        return
    document.set(path, value)


def _with_sources(content: Mapping[str, Any], renamed: Mapping[str, str]) -> dict[str, Any]:
    made: dict[str, Any] = {}
    for key, value in content.items():
        if isinstance(value, dict):
            made[key] = _with_sources(cast(dict[str, Any], value), renamed)
        else:
            made[key] = renamed.get(value, value) if key == "source" and isinstance(value, str) else value
    return made


def _sources_of(content: Mapping[str, Any]) -> Iterator[str]:
    for key, value in content.items():
        if isinstance(value, dict):
            yield from _sources_of(cast(dict[str, Any], value))
        elif key == "source" and isinstance(value, str):
            yield value


def _reference(document: YamlText, source: str, text: str) -> str:
    """The key under which the file cites `text`, made of its `source` and added where it is not there yet."""
    slug = re.sub(r"[^a-z0-9]+", "-", source.lower()).strip("-")[:40].strip("-")
    known: dict[str, str] = document.get(["references"]) or {}
    key = _free_key(known, slug, text)
    if key not in known:
        document.set(["references", key] if known else ["references"], text if known else {key: text}, block=not known)
    return key


def _free_key(known: Mapping[str, str], key: str, text: str) -> str:
    """The key that has `text` already, or else one like `key` that has none yet."""
    for other, written in known.items():
        if written == text:
            return other
    base = free = key or "source"
    number = 1
    while free in known:
        number += 1
        free = f"{base}-{number}"
    return free
