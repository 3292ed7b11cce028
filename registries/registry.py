"""A list by name that users add to: shipped entries first, then those of installed packages, then registered ones.

A package brings entries by an entry point of the registry's group, whose value is an entry or a tuple of them. They are
loaded when somebody first asks for a name that is not shipped, or for all names: `import` alone loads nothing of them.

A registry belongs to its process. Worker processes that are forked have what their parent registered; those that are
started anew (`spawn`, the only way on Windows and macOS's default) find installed packages by themselves, but what a
program registers must be registered in a module that the worker imports, or by the pool's `initializer`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from threading import RLock
from typing import TYPE_CHECKING, Generic, TypeVar, cast

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

    from linkwright.core.units.quantities import InputError

T = TypeVar("T")

_NAME = re.compile(r"[a-z][a-z0-9_-]*")
_FAILURES = (
    ArithmeticError,
    AssertionError,
    AttributeError,
    ImportError,
    LookupError,
    NameError,
    OSError,
    RuntimeError,
    SyntaxError,
    TypeError,
    ValueError,
)
"""What a foreign module raises while it loads, from a missing dependency to a slip of the pen."""


class Registry(Mapping[str, T], Generic[T]):
    """Entries by name, in the order shipped, installed (by package), registered.

    `what` is the word for an entry in messages, `name_of` its name, `fault` says what is wrong with an object that is
    meant to be one (None: nothing), `group` is that of the entry points. `home` (`module:name`) is where it stands:
    sent to another process, it becomes the one that stands there.
    """

    def __init__(
        self,
        what: str,
        group: str,
        name_of: Callable[[T], str],
        fault: Callable[[object], str | None],
        home: str = "",
    ) -> None:
        self._home = home
        self._what, self._group, self._name_of, self._fault = what, group, name_of, fault
        self._shipped: dict[str, T] = {}
        self._added: dict[str, T] = {}
        self._sought = self._seeking = False
        self._lock = RLock()

    def ship(self, *entries: T) -> None:
        """Add what the project brings itself; for the module that owns the registry."""
        self._shipped.update({self._name_of(entry): entry for entry in entries})

    def register(self, entry: T) -> None:
        """Add an entry for this process. Raises `InputError` where it is none, or its name is taken."""
        with self._lock:
            self._seek()
            self._take(entry, "")

    def withdraw(self, name: str) -> None:
        """Take an entry that is not shipped away again. Raises `InputError` where there is none of that name."""
        with self._lock:
            if name not in self._added:
                state = "is shipped, and stays" if name in self._shipped else "is not registered"
                raise _refusal(f"the {self._what} '{name}' {state}")
            del self._added[name]

    def __getitem__(self, name: str) -> T:
        """The entry of that name. Raises KeyError, and `InputError` where an installed package is broken."""
        if name in self._shipped:
            return self._shipped[name]
        return self._others()[name]

    def __iter__(self) -> Iterator[str]:
        """All names."""
        return iter((*self._shipped, *self._others()))

    def __len__(self) -> int:
        """How many there are."""
        return len(self._shipped) + len(self._others())

    def __reduce__(self) -> tuple[object, ...]:
        """By its home; one without stays where it is."""
        if not self._home:
            raise TypeError(f"the list of {self._what}s belongs to its process")
        return _at_home, (self._home,)

    def __repr__(self) -> str:
        """How many, of what."""
        return f"<{len(self)} {self._what}s>"

    def _others(self) -> dict[str, T]:
        """What is not shipped."""
        if not self._sought:
            with self._lock:
                self._seek()
        return self._added

    def _seek(self) -> None:
        """Load what installed packages bring, once; all of it or nothing."""
        if self._sought or self._seeking:  # a package may look up or register entries while it loads
            return
        from importlib.metadata import entry_points

        self._seeking, before = True, dict(self._added)
        try:
            for point in sorted(entry_points(group=self._group), key=lambda item: (_package(item), item.name)):
                self._load(point)
            self._sought = True
        finally:
            self._seeking = False
            if not self._sought:
                self._added = before

    def _load(self, point: EntryPoint) -> None:
        who = f"the installed package {_package(point)} (entry point {point.name} = {point.value})"
        try:
            result: object = point.load()
        except _FAILURES as error:
            reason = f"{type(error).__name__}: {error}"
            raise _refusal(f"{who} cannot be loaded: {reason}; mend or uninstall it") from error
        entries = cast("tuple[object, ...]", result) if isinstance(result, tuple) else (result,)
        for entry in entries:
            self._take(entry, f"{who}: ")

    def _take(self, entry: object, who: str) -> None:
        fault = self._fault(entry)
        if fault is not None:
            raise _refusal(f"{who}{fault}")
        good = cast("T", entry)
        name = self._name_of(good)
        if not _NAME.fullmatch(name):
            raise _refusal(f"{who}the name of {self._what} {name!r} needs small letters, digits and underscores")
        if self._added.get(name) is good:
            return
        if name in self._shipped or name in self._added:
            hint = "choose another name" if name in self._shipped else f"another name, or withdraw('{name}') first"
            raise _refusal(f"{who}there is {_article(self._what)} '{name}' already; {hint}")
        self._added[name] = good


def _at_home(home: str) -> object:
    from importlib import import_module

    module, _, name = home.partition(":")
    return getattr(import_module(module), name)


def _package(point: EntryPoint) -> str:
    return f"{point.dist.name} {point.dist.version}" if point.dist is not None else point.module


def _refusal(line: str) -> InputError:
    from linkwright.core.units.quantities import InputError

    return InputError("", "", line)


def _article(word: str) -> str:
    return f"{'an' if word[0] in 'aeiou' else 'a'} {word}"
