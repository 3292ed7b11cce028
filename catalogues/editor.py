"""Edits of a catalogue file: each is checked as the whole file would be on load, and lands whole or not at all.

What surrounds an edit, its comments, order and layout, stays as it is (`catalogues.yaml_edit`); locking and
atomic replacement are in `edit_text`. What is shipped is never written: changing an entry of it puts a copy
into the file first, where it hides the shipped one. What the kinds of catalogue differ in is in the subclasses.

Beside `NAME` stand `.NAME.lock` (`units.files.locked`) and `.NAME.new` (the next content, only while an edit runs). The
order of an edit is: lock, read, change, check, write the neighbour, flush it to the disk, rename it over the file. A
process killed at any instant leaves the old or the new file.
"""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Generic, Protocol, TypeAlias, TypeVar, cast

from linkwright.core.catalogues.csv_table import WrongRows
from linkwright.core.catalogues.yaml_edit import YamlText
from linkwright.core.units.files import locked, write_whole
from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import load_yaml, read_text


def edit_text(path: Path | str, change: Callable[[str | None], tuple[str, str]]) -> str:
    """Replace the file's text by what `change` makes of it, under the lock, and return what it says it did.

    `change` gets the text (None where there is no file) and gives the new text and a description; whatever it raises
    leaves the file as it was. A text that stays the same is not written. Raises `InputError` where the file or its
    folder cannot be read or written.
    """
    try:
        target = Path(path).resolve()  # a link to the file stays a link and has the same lock
    except (OSError, ValueError, RuntimeError) as error:
        raise InputError(path, "", f"cannot be read: {error}") from None
    with locked(target):
        before = read_text(target) if os.path.exists(target) else None
        after, what = change(before)
        if after != before:
            try:
                write_whole(target, after, flush=True, ending="new")
            except OSError as error:
                raise InputError(path, "", f"cannot be written: {error.strerror or error}") from None
        return what


Place: TypeAlias = list[str | int]
"""Where an entry stands in a file: the keys and numbers on the way to it."""


class Named(Protocol):
    """An entry of a catalogue."""

    @property
    def name(self) -> str:
        """By which it is asked for."""
        ...


E = TypeVar("E", bound=Named)


class Editor(ABC, Generic[E]):
    """Edits of one kind of catalogue. Each returns what it did, and raises `InputError` where it cannot."""

    what: str
    """What an entry is, in one word."""
    new_file: str
    """What a missing or empty file begins as."""

    @abstractmethod
    def check(self, text: str, path: Path | str) -> object:
        """Raise `InputError` where a text is no such catalogue."""

    @abstractmethod
    def names(self, document: YamlText) -> list[str]:
        """The entries of a file."""

    @abstractmethod
    def find(self, document: YamlText, name: str) -> Place | None:
        """Where the entry of that name stands."""

    @abstractmethod
    def shipped(self, name: str) -> E | None:
        """The shipped entry of that name."""

    @abstractmethod
    def put(self, document: YamlText, entries: Sequence[E]) -> None:
        """Write entries, each in the place of the one that has its name."""

    @abstractmethod
    def take_out(self, document: YamlText, place: Place) -> None:
        """Take the entry at a place away."""

    def plain(self, name: str) -> str:
        """The form in which two names of the same entry are equal."""
        return name

    def key(self, name: str) -> str:
        """An entry in messages."""
        return name

    def document(self, text: str | None, path: Path | str) -> YamlText:
        """The text of a file, ready for an edit."""
        return YamlText(self.new_file if text is None or not text.strip() else text, file=path)

    def edit(self, path: Path | str, change: Callable[[YamlText], str]) -> str:
        """Change a file under its lock; returns what `change` says that it did."""

        def whole(before: str | None) -> tuple[str, str]:
            document = self.document(before, path)
            what = change(document)
            self.check(document.text, path)
            return document.text, what

        return edit_text(path, whole)

    def add(self, path: Path | str, entries: Sequence[E], *, replace: bool = False) -> str:
        """Add entries, all of them or none; with `replace` they take the place of those of the same names."""

        def change(document: YamlText) -> str:
            names = [self.plain(entry.name) for entry in entries]
            taken = [entry.name for entry in entries if self.find(document, entry.name) is not None]
            for entry in entries:
                if names.count(self.plain(entry.name)) > 1:
                    raise InputError(path, self.key(entry.name), "comes twice")
            if taken and not replace:
                would_do = "edit it, use another name, or replace it"
                raise InputError(path, self.key(taken[0]), f"is there already; {would_do}")
            self.put(document, entries)
            return f"{'replaced' if len(taken) == len(entries) else 'added'} {', '.join(e.name for e in entries)}"

        return self.edit(path, change)

    def check_each(self, file: Path | str, entries: Sequence[E]) -> None:
        """Raise `WrongRows` where some of the entries that were read from a file may stand in none."""
        if self._fault(file, entries) is None:
            return
        good: list[E] = []
        faults: list[InputError] = []
        for batch in self._halves(file, entries):
            fault = self._fault(file, [*good, *batch]) if len(batch) == 1 else None
            if fault is None:
                good.extend(batch)
            else:
                faults.append(fault)
        if faults:
            raise WrongRows(good, faults)

    def _halves(self, file: Path | str, entries: Sequence[E]) -> Iterator[Sequence[E]]:
        """Batches that may stand in a file, and each of the other entries alone."""
        if len(entries) == 1 or self._fault(file, entries) is None:
            yield entries
            return
        middle = len(entries) // 2
        yield from self._halves(file, entries[:middle])
        yield from self._halves(file, entries[middle:])

    def _fault(self, file: Path | str, entries: Sequence[E]) -> InputError | None:
        """What is wrong with a file of these entries alone."""
        document = self.document(None, file)
        try:
            self.put(document, entries)
            self.check(document.text, file)
        except InputError as error:
            return error
        return None

    def remove(self, path: Path | str, name: str) -> str:
        """Take an entry out of the file."""

        def change(document: YamlText) -> str:
            self.take_out(document, self.required(document, path, name))
            return f"removed {name}"

        return self.edit(path, change)

    def set_price(self, path: Path | str, name: str, price: Mapping[str, Any], known: Sequence[str]) -> str:
        """Write the price of an entry, and nothing else of it; `known` are the names that other catalogues have.

        `price` has `value`, `date` and `source`, and may have `spread` and `note`.
        """

        def change(document: YamlText) -> str:
            if name not in (*known, *self.names(document)):
                raise InputError(path, f"prices.{name}", f"there is no such {self.what}{nearest(name, list(known))}")
            document.set(["prices", name], dict(price))
            return f"set the price of {name}"

        return self.edit(path, change)

    def remove_price(self, path: Path | str, name: str) -> str:
        """Take the price of an entry out of the file."""

        def change(document: YamlText) -> str:
            priced: dict[str, Any] = document.get(["prices"]) or {}
            if name not in priced:
                message = f"there is no price of that in this file{nearest(name, list(priced))}"
                raise InputError(path, f"prices.{name}", message)
            document.remove(["prices"] if len(priced) == 1 else ["prices", name])
            return f"removed the price of {name}"

        return self.edit(path, change)

    def draft(self, path: Path | str, name: str) -> tuple[str | None, str]:
        """The file's text (None where there is no file) and the text to hand to an editor, which has the entry."""
        before = read_text(path) if os.path.exists(path) else None
        document = self.document(before, path)
        self.copy_shipped(document, path, name)
        return before, document.text

    def land(self, path: Path | str, before: str | None, text: str) -> str:
        """Put an edited text in place of the file, unless the file is no longer as it was `before`."""

        def whole(current: str | None) -> tuple[str, str]:
            if current != before:
                raise InputError(path, "", "has been changed by somebody else meanwhile; nothing was written")
            self.check(text, path)
            return text, "edited the file"

        return edit_text(path, whole)

    def required(self, document: YamlText, path: Path | str, name: str) -> Place:
        """Where the entry stands in the file."""
        place = self.find(document, name)
        if place is not None:
            return place
        if self.shipped(name) is not None:
            message = "is not in this file but shipped with the program, and stays there"
        else:
            message = f"there is no such {self.what} in this file{nearest(name, self.names(document))}"
        raise InputError(path, self.key(name), message)

    def copy_shipped(self, document: YamlText, path: Path | str, name: str) -> bool:
        """Put a shipped entry into the file where the file has none of that name; tells whether it did."""
        shipped = self.shipped(name)
        if self.find(document, name) is not None or shipped is None:
            self.required(document, path, name)
            return False
        self.put(document, [shipped])
        return True

    def uses(self, path: Path | str, name: str, key: str) -> bool:
        """Tell whether an arm or problem file has the name anywhere under the key, alone or in a list."""
        wanted = self.plain(name)

        def names(value: object) -> bool:
            if isinstance(value, dict):
                for item, inner in cast(dict[str, object], value).items():
                    listed = cast(list[object], inner) if isinstance(inner, list) else [inner]
                    if item == key and any(isinstance(one, str) and self.plain(one) == wanted for one in listed):
                        return True
                    if names(inner):
                        return True
            return isinstance(value, list) and any(names(inner) for inner in cast(list[object], value))

        return names(load_yaml(path).content)
