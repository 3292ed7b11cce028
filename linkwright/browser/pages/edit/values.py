"""Values of YAML as fields show them, and keys as people write them."""

from __future__ import annotations

import re
from typing import Any, cast

from linkwright.browser.server.keys import Place
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import parse_yaml, yaml_line
from linkwright.face.plain_input import steps_of


def shown(value: Any) -> str:
    """A value as a field for words has it."""
    return value if isinstance(value, str) else "" if value is None else yaml_line(value)


def meant(value: Any, before: Any) -> Any:
    """What a field says as YAML has it: words stay words, lists are lists, numbers what they were."""
    if isinstance(value, list):
        return cast(list[Any], value)
    words = str(value).strip()
    if words.startswith(("[", "{")) or not isinstance(before, str | None):
        try:
            parsed = parse_yaml(f"[{words}]", file="the field")
        except InputError:
            return words
        entries = cast(list[Any], parsed) if isinstance(parsed, list) else []
        return entries[0] if len(entries) == 1 else entries if isinstance(before, list) else words
    if before is None and re.fullmatch(r"true|false|-?[0-9]+(\.[0-9]+)?", words):
        return cast(list[Any], parse_yaml(f"[{words}]", file="the field"))[0]
    return words


def place_of(key: str, file: str) -> Place:
    """A key such as chain[1].joint.backlash as a place; lists count from 1."""
    steps = steps_of(key.strip(), file)
    if 0 in steps:
        raise InputError(file, key.strip(), "is no key; write e.g. 'chain[1].link.length' (lists count from 1)")
    return tuple(step - 1 if isinstance(step, int) else step for step in steps)
