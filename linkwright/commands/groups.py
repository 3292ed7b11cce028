"""How a group of commands is put together."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import typer

PLAIN: Mapping[str, Any] = MappingProxyType({"add_completion": False, "pretty_exceptions_enable": False})
"""How every level of the command line is set up: completion scripts come from the root alone, and a defect shows a
plain traceback."""
Commands = Mapping[str, Callable[..., None]]


def helpless_group(context: typer.Context) -> None:
    """Show a group's help where no command of it is named."""
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())


def command_group(help_text: str, commands: Commands) -> typer.Typer:
    """A group of commands, each a function whose docstring is its help."""
    made: Any = typer.Typer(help=help_text, callback=helpless_group, invoke_without_command=True, **PLAIN)
    for name, function in commands.items():
        made.command(name, help=f"{inspect.getdoc(function)}\n")(function)
    return made


def write_content(json: Path | None, command: str, content: Mapping[str, Any]) -> None:
    """Write what a command found where `--json` names a file, and which command that was. Raises `InputError`."""
    from linkwright.output.files import write_json
    from linkwright.version import program_version

    write_json(json, {"made_by": f"linkwright {command} {program_version()}", **content})
