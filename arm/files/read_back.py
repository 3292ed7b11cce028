"""An arm that was written and read back, beside the one that was meant."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass, replace
from typing import Any, cast

from linkwright.core.arm.chain.chain import Arm, Joint
from linkwright.core.materials.material import Material

_AS_WRITTEN = 1e-9
"""How far a number may be from what it was, of it: twelve digits are written, and sums of them are taken."""
_NOTHING = 1e-11
"""What a sum leaves where nothing is, SI."""


def differences(meant: Arm, back: Arm) -> Iterator[str]:
    """What an arm that was read back says otherwise than the one that was meant, by the keys of an arm file, numbers in
    SI; nothing where it is the same arm."""
    yield from _differing(_file_values(meant), _file_values(back), "")


def _file_values(arm: Arm) -> dict[str, Any]:
    """What a file tells of an arm, by its keys."""
    chain = [{"joint": _joint(joint), "link": link} for joint, link in zip(arm.joints, arm.links, strict=True)]
    whole = {field.name: getattr(arm, field.name) for field in fields(arm) if field.compare}
    return {name: value for name, value in whole.items() if name not in ("joints", "links")} | {"chain": chain}


def _joint(joint: Joint) -> Joint:
    """A joint without the range of one that only follows, which has no coordinate of its own."""
    return joint if joint.driven else replace(joint, range=(0.0, 0.0))


def _differing(meant: Any, back: Any, at: str) -> Iterator[str]:
    if isinstance(meant, float | int) and isinstance(back, float | int):
        if not math.isclose(meant, back, rel_tol=_AS_WRITTEN, abs_tol=_NOTHING):
            yield f"{at} was {meant:.9g} and reads {back:.9g}"
    elif type(meant) is not type(back) and not (isinstance(meant, Mapping) and isinstance(back, Mapping)):
        yield f"{at} was {_brief(meant)} and reads {_brief(back)}"
    elif isinstance(meant, Mapping):
        held, read = cast(Mapping[Any, Any], meant), cast(Mapping[Any, Any], back)
        for name in dict.fromkeys((*held, *read)):
            key = f"{at}.{name}" if at else str(name)
            if name not in held or name not in read:
                yield f"{key} {'is new' if name in read else 'is gone'}"
            else:
                yield from _differing(held[name], read[name], key)
    elif isinstance(meant, tuple | list):
        one, other = cast(tuple[Any, ...], meant), cast(tuple[Any, ...], back)
        if len(one) != len(other):
            yield f"{at} had {len(one)} entries and reads {len(other)}"
            return
        for number, (item, read) in enumerate(zip(one, other, strict=True), start=1):
            yield from _differing(item, read, f"{at}[{number}]")
    elif is_dataclass(meant) and not isinstance(meant, type):
        yield from _differing(_fields(meant), _fields(back), at)
    elif meant != back:
        yield f"{at} was {_brief(meant)} and reads {_brief(back)}"


def _fields(part: Any) -> dict[str, Any]:
    """The fields of a part that count; a material described in place is called after where it stands."""
    values = {field.name: getattr(part, field.name) for field in fields(part) if field.compare}
    if isinstance(part, Material) and part.in_place is not None:
        del values["name"]
    return values


def _brief(value: Any) -> str:
    return type(value).__name__ if is_dataclass(value) else f"{value!s:.40}"
