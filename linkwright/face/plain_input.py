"""What a program gives in place of a file: plain content with numbers in SI, and one key of it changed."""

from __future__ import annotations

import copy
import numbers
import re
from collections.abc import Collection, Iterable, Mapping
from os import PathLike
from pathlib import Path
from typing import Any, Protocol, cast, runtime_checkable

from linkwright.core.arm.effects import EFFECTS
from linkwright.core.sections.section import Section
from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import InputError, SIFloat, SIInt, read_quantity, shown

Quantity = str | float
"""A quantity as text with its unit (`"400 mm"`), or a number in SI."""
File = Path | str

_STEP = re.compile(r"([A-Za-z_]\w*)|\[(\d+)\]")


@runtime_checkable
class Part(Protocol):
    """Something that stands for a part of an arm file."""

    def in_file(self) -> object:
        """What would stand in the arm file."""
        ...


def plain(value: object) -> Any:
    """The value as the reader of files takes it: lists, mappings, text, and numbers marked as SI."""
    if isinstance(value, Part):
        return plain(value.in_file())
    if isinstance(value, Section):
        return plain({"shape": value.shape, **value.given()})
    if value is None or isinstance(value, bool | str | SIFloat | SIInt):
        return value
    if isinstance(value, numbers.Integral):
        return SIInt(int(value))
    if isinstance(value, numbers.Real):
        return SIFloat(float(value))
    if isinstance(value, PathLike):
        return str(Path(cast(PathLike[str], value)))
    if isinstance(value, Mapping):
        return {str(name): plain(item) for name, item in cast(Mapping[object, object], value).items()}
    if isinstance(value, Iterable):
        return [plain(item) for item in cast(Iterable[object], value)]
    return value


def path_of(given: object, name: str, kind: str) -> Path:
    """The path of the file that is given for `name`. Raises `InputError`, which says that a `kind` or the path of its
    file would do, for anything else."""
    if not isinstance(given, str | PathLike):
        raise InputError("", name, f"needs {kind} or the path of its file, not {type(given).__name__}")
    return Path(cast(str, given))


def in_si(value: Quantity, kind: str, key: str) -> float:
    """A quantity given as text or as a number in SI, in SI. Raises `InputError` with the key and what would do."""
    return read_quantity(plain(value), kind, file="", key=key)


def edited(content: Mapping[str, Any], key: str, value: object, what: str) -> dict[str, Any]:
    """The content with one key changed, such as `chain[1].link.length`; lists count from 1, as in messages.

    None takes a key out. Whether the key is known is for the reader to say, but a way to it there must be. Raises
    `InputError`.
    """
    steps = steps_of(key, what)
    made: dict[str, Any] = copy.deepcopy(dict(content))
    here: Any = made
    for at, step in enumerate(steps[:-1]):
        here = _entered(here, step, steps[at + 1], key, what)
    last = steps[-1]
    if isinstance(last, int):
        _item(here, last, key, what)
        here[last - 1] = plain(value)
    elif isinstance(here, dict):
        if value is None:
            cast(dict[str, Any], here).pop(last, None)
        else:
            here[last] = plain(value)
    else:
        raise InputError(what, key, f"{shown(here)} has no keys, so no '{last}'")
    return made


def steps_of(key: str, what: str) -> list[str | int]:
    """The steps to a key such as `chain[1].link.length`; lists count from 1. Raises `InputError`."""
    steps: list[str | int] = []
    at = 0
    while at < len(key):
        if key[at] == "." and 0 < at < len(key) - 1:
            at += 1
        step = _STEP.match(key, at)
        if step is None:
            break
        steps.append(step[1] if step[1] is not None else int(step[2]))
        at = step.end()
    if not steps or at < len(key):
        raise InputError(what, key, "is no key; write e.g. 'chain[1].link.length' (lists count from 1)")
    return steps


def _item(here: Any, number: int, key: str, what: str) -> None:
    if not isinstance(here, list):
        raise InputError(what, key, f"[{number}] asks for an entry of a list, which {shown(here)} is not")
    size = len(cast(list[Any], here))
    if not 1 <= number <= size:
        raise InputError(what, key, f"there is no entry {number}; the list holds {size}, counted from 1")


def _entered(here: Any, step: str | int, after: str | int, key: str, what: str) -> Any:
    """One step into the content; a mapping that is not there yet is made, a list is not."""
    if isinstance(step, int):
        _item(here, step, key, what)
        return here[step - 1]
    if not isinstance(here, dict):
        raise InputError(what, key, f"{shown(here)} has no keys, so no '{step}'")
    held = cast(dict[str, Any], here)
    if step not in held:
        if isinstance(after, int):
            raise InputError(what, key, f"there is no '{step}'{nearest(step, list(held))}")
        held[step] = {}
    return held[step]


def known_effects(names: Collection[str], key: str = "without") -> frozenset[str]:
    """Names of effects; raises `InputError` with the nearest for one that is not known."""
    for name in names:
        if name not in EFFECTS:
            raise InputError("", key, f"there is no effect '{name}'{nearest(name, EFFECTS)}")
    return frozenset(names)
