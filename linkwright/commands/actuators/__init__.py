"""`linkwright actuators` and its parts."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import typer

HELP = """Gears and actuators by name: list, show; add, edit, price, remove, rename, undo; import, export, check."""


def group() -> typer.Typer:
    """The command group."""
    from .actuators import group as made

    return made()
