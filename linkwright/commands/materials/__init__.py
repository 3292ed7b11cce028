"""`linkwright materials` and its parts."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import typer

HELP = (
    """What links can be made of: list, show, compare; add, edit, price, remove, rename, undo; import, export, check."""
)


def group() -> typer.Typer:
    """The command group."""
    from .materials import group as made

    return made()
