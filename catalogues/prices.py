"""Prices in a catalogue of one's own for what stands in another, which is not copied for that."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from linkwright.core.catalogues.editor import E, Editor
from linkwright.core.catalogues.yaml_edit import YamlText
from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import InputError


def set_price(editor: Editor[E], path: Path | str, name: str, price: Mapping[str, Any], known: Sequence[str]) -> str:
    """Write the price of an entry, and nothing else of it; `known` are the names that other
    catalogues have. Says what it did.

    `price` has `value`, `date` and `source`, and may have `spread` and `note`. Raises `InputError`.
    """

    def change(document: YamlText) -> str:
        if name not in (*known, *editor.names(document)):
            raise InputError(path, f"prices.{name}", f"there is no such {editor.what}{nearest(name, list(known))}")
        document.set(["prices", name], dict(price))
        return f"set the price of {name}"

    return editor.edit(path, change)


def remove_price(editor: Editor[E], path: Path | str, name: str) -> str:
    """Take the price of an entry out of the file; says what it did. Raises `InputError` where there is none."""

    def change(document: YamlText) -> str:
        priced: dict[str, Any] = document.get(["prices"]) or {}
        if name not in priced:
            raise InputError(
                path, f"prices.{name}", f"there is no price of that in this file{nearest(name, list(priced))}"
            )
        document.remove(["prices"] if len(priced) == 1 else ["prices", name])
        return f"removed the price of {name}"

    return editor.edit(path, change)
