"""Cache of expressions by the structure of an arm: designs that differ in lengths, sections and materials share them.

An arm's expressions take each link's length and rigidities as symbols (`arm.errors.model.beam_symbols`), so they depend
on all else that the arm holds, and on the effects that are registered.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass, replace
from functools import lru_cache, wraps
from typing import Any, Concatenate, ParamSpec, TypeVar, cast

import numpy as np

from linkwright.core.arm.chain.chain import Arm, Link
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.sections.taper import FreeTaper, Tapered

Options = ParamSpec("Options")
Result = TypeVar("Result")

_CACHED = 16
"""Structures whose expressions are cached: some megabytes for each of a long arm."""
_SYMBOLS = ("length", "section", "section_name", "material")
"""What symbols take the place of in a uniform elastic link."""


class Identity:
    """Values by all that they hold, as a key: equal where every number, name and flag is, and the registered effects
    are the same."""

    def __init__(self, *values: Any) -> None:
        self.values, self._effects = values, tuple(EFFECTS.values())
        self._key = (self._entries(), tuple(map(id, self._effects)))
        self._hash = hash(self._key)

    def _entries(self) -> object:
        return entries(self.values)

    def __hash__(self) -> int:
        return self._hash

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and self._key == cast("Identity", other)._key


class Structure(Identity):
    """An arm by what its expressions depend on: without the sizes and materials that are symbols in them."""

    def __init__(self, arm: Arm) -> None:
        self.arm = arm
        super().__init__(arm)

    def _entries(self) -> object:
        arm = self.arm
        links = tuple(link_entries(link) for link in arm.links)
        # A row of dh only says again where a joint stands, lengths among it.
        joints = tuple(entries(replace(joint, dh=None)) for joint in arm.joints)
        rest = (entries(getattr(arm, field.name)) for field in fields(arm) if field.name not in ("joints", "links"))
        return (joints, links, *rest)


def link_entries(link: Link) -> object:
    """What expressions depend on of a link."""
    if link.section is None or isinstance(link.section, Tapered | FreeTaper):
        return entries(link)
    expands = link.material is not None and link.material.has("thermal_expansion")
    rest = (entries(getattr(link, field.name)) for field in fields(link) if field.name not in _SYMBOLS)
    return (replace(link.asymmetry, warps=False), expands, *rest)


def entries(value: object) -> object:
    """A value as something to compare and to hash: dataclasses by all their fields, those that their comparison
    leaves out too; mappings, lists and arrays by what they hold."""
    if isinstance(value, tuple | list):
        return tuple(map(entries, cast("tuple[object, ...] | list[object]", value)))
    if is_dataclass(value):
        return (type(value), *(entries(getattr(value, field.name)) for field in fields(value)))
    if isinstance(value, Mapping):
        held = cast("Mapping[object, object]", value)
        return tuple(sorted(((str(key), entries(item)) for key, item in held.items()), key=lambda pair: pair[0]))
    if isinstance(value, np.ndarray):
        array = cast("np.ndarray[Any, Any]", value)
        return (array.shape, array.tobytes())
    return value


def by_structure(
    build: Callable[Concatenate[Arm, Options], Result],
) -> Callable[Concatenate[Arm, Options], Result]:
    """A function of an arm (and of what can be hashed) that is called once for all arms of one structure."""

    @lru_cache(maxsize=_CACHED)
    def cached(structure: Structure, *args: Options.args, **options: Options.kwargs) -> Result:
        return build(structure.arm, *args, **options)

    @wraps(build)
    def of_arm(arm: Arm, *args: Options.args, **options: Options.kwargs) -> Result:
        return cast("Callable[..., Result]", cached)(Structure(arm), *args, **options)

    return of_arm
