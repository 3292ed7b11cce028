"""Two kinds of list: catalogues that files of the user's are laid over, and registries that programs add to."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Collection, Iterator, Mapping
from typing import Generic, Self, TypeVar

from linkwright.core.registries import Registry
from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import InputError
from linkwright.face.plain_input import File

T = TypeVar("T")


class Named(Mapping[str, T], Generic[T]):
    """Entries by name."""

    @abstractmethod
    def _names(self) -> Collection[str]:
        """The names, in the list's order."""

    def __contains__(self, name: object) -> bool:
        """Whether there is an entry of that name."""
        return name in self._names()

    def __iter__(self) -> Iterator[str]:
        """The names."""
        return iter(self._names())

    def __len__(self) -> int:
        """How many there are."""
        return len(self._names())

    def __repr__(self) -> str:
        """One line."""
        return f"<{type(self).__name__}: {len(self)} by name>"


class Catalogue(Named[T]):
    """Entries by name: the shipped ones, the user's over them, and over those the file that `with_file` names."""

    def __init__(self, file: File | None = None) -> None:
        self._files = () if file is None else (file,)

    def with_file(self, file: File | None) -> Self:
        """The same with a file of the user's laid over it; raises `InputError` as soon as an entry is asked for."""
        return type(self)(file)


class Open(Named[T]):
    """Entries by name: what is shipped, what installed packages bring, what `register` adds for this process."""

    def __init__(self, what: str, known: Registry[T]) -> None:
        self._what, self._known = what, known

    def __getitem__(self, name: str) -> T:
        """The entry of a name; raises `InputError` with the nearest known one."""
        if name not in self._known:
            raise InputError("", self._what, f"there is no {self._what} '{name}'{nearest(name, list(self._known))}")
        return self._known[name]

    def _names(self) -> Collection[str]:
        return self._known

    def register(self, entry: T) -> None:
        """Add an entry for this process. Raises `InputError` where it is none, or its name is taken."""
        self._known.register(entry)

    def withdraw(self, name: str) -> None:
        """Take a registered entry away again. Raises `InputError` where there is none of that name."""
        self._known.withdraw(name)
