"""How a group of commands is put together."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

import typer

PLAIN: Mapping[str, Any] = MappingProxyType({"add_completion": False, "pretty_exceptions_enable": False})
"""How every level of the command line is set up: completion scripts come from the root alone, and a defect shows a
plain traceback."""
Commands = Mapping[str, tuple[Callable[..., None], str]]


def helpless_group(context: typer.Context) -> None:
    """Show a group's help where no command of it is named."""
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())


def command_group(help_text: str, commands: Commands) -> typer.Typer:
    """A group of commands, each with its function and its help."""
    made: Any = typer.Typer(help=help_text, callback=helpless_group, invoke_without_command=True, **PLAIN)
    for name, (function, text) in commands.items():
        made.command(name, help=text)(function)
    return made
