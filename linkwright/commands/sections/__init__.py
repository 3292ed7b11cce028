"""`linkwright sections` and its parts."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import typer

HELP = """Shapes and standard sizes: list, show, compare; add, edit, remove, rename, undo; import, export, check."""


def group() -> typer.Typer:
    """The command group."""
    from .sections import group as made

    return made()
