"""The commands put together, and how their ends become exit statuses (see `linkwright.cli`)."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping, Sequence
from importlib import import_module
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any

import typer

from linkwright.commands.options import PLAIN, command_group
from linkwright.core.units.quantities import InputError, NoAnswer
from linkwright.output.stream import (
    OutputClosed,
    drop_errors,
    drop_output,
    forget_odd_measures,
    open_closed_streams,
    printable,
    results_alone,
)
from linkwright.version import program_version

if TYPE_CHECKING:
    from .commands.made import Made

VERSION = "--version"
NO_ANSWER, WRONG_INPUT, READER_GONE = 1, 2, 141

PANELS = ("Design", "Diagnose", "Files", "Catalogues", "Paper", "Program")
"""The parts of the help, in their order."""
CATALOGUES: Mapping[str, str] = MappingProxyType(
    {
        "materials": "What links can be made of: list, show, compare, add, edit, remove, import, export, check.",
        "sections": "Shapes and standard sizes: list, show, compare, add, edit, remove, import, export, check.",
        "actuators": "Gears and actuators by name: list, show, add, edit, remove, import, export, check.",
        "effects": "The physics that the models know: list, show.",
    }
)
"""The commands that have commands of their own, and their help: `group()` of the module of that name."""

PROGRAM = ("serve", "doctor")
"""The commands that call no function of `linkwright`: `HELP` and a function of its name, in the module of that name."""

STATUSES = (
    "Exit status: 0 done, 1 a well-formed question without an answer, 2 wrong input (one line says which). "
    "130 interrupted (standard error says what is kept), 141 nobody reads the output."
)
HELP = """Design robot arms for the least worst-case error, and find from recordings what the model of a real arm lacks.

Example: linkwright optimize problem.yaml --out result
"""


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"linkwright {program_version()}")
        raise typer.Exit


def _start(
    context: typer.Context,
    version: Annotated[  # noqa: ARG001 - its callback does it all
        bool, typer.Option(VERSION, help="Show the version.", callback=_version, is_eager=True)
    ] = False,
) -> None:
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())


def commands() -> Mapping[str, str]:
    """Every command with the part of the help where it stands, in the help's order."""
    own = dict.fromkeys(CATALOGUES, "Catalogues") | dict.fromkeys(PROGRAM, "Program")
    every = {name: command.panel for name, command in _made().items()} | own
    return dict(sorted(every.items(), key=lambda item: PANELS.index(item[1])))


def _made() -> Mapping[str, Made]:
    from linkwright.commands.from_face import commands as made  # here, for a look into a catalogue needs none of them

    return made()


def command_line(asked: str = "") -> typer.Typer:
    """The command line with the command that is asked for; for any other word, with all, the groups by their help only.

    Nothing that the word cannot come to is imported.
    """
    root: dict[str, Any] = {**PLAIN, "add_completion": True}
    made: Any = typer.Typer(help=HELP, epilog=STATUSES, callback=_start, invoke_without_command=True, **root)
    for name, panel in _wanted(asked).items():
        if name in CATALOGUES and name != asked:
            made.add_typer(command_group(CATALOGUES[name], {}), name=name, rich_help_panel=panel)
        elif name in CATALOGUES:
            module: Any = import_module(f"linkwright.commands.catalogues.{name}")
            made.add_typer(command_group(CATALOGUES[name], module.group()), name=name, rich_help_panel=panel)
        elif name in PROGRAM:
            module = import_module(f"linkwright.commands.{name}")
            made.command(name, help=module.HELP, rich_help_panel=panel)(getattr(module, name))
        else:
            command = _made()[name]
            settings = {"ignore_unknown_options": True} if command.negative else {}
            made.command(name, help=command.help, context_settings=settings, rich_help_panel=panel)(command.typed())
    return made


def _wanted(asked: str) -> Mapping[str, str]:
    """The commands that a word can come to, with their parts of the help."""
    if asked == VERSION:
        return {}
    if asked in CATALOGUES or asked in PROGRAM:
        return {asked: ""}
    every = commands()
    return {asked: every[asked]} if asked in every else every


def outcome(arguments: Sequence[str] | None = None) -> int:
    """Run the command line with these arguments (the process's own by default) and return the exit status."""
    open_closed_streams()
    forget_odd_measures()
    for stream in (sys.stdout, sys.stderr):
        reconfigure = getattr(stream, "reconfigure", None)
        if reconfigure is not None:
            reconfigure(errors="replace")  # a terminal that cannot show a symbol shows a question mark
    given = sys.argv[1:] if arguments is None else list(arguments)
    command = next((word for word in _typed() or given if word != "--"), "")
    try:
        with results_alone(given):
            status: object = command_line(command)(args=given, prog_name="linkwright", standalone_mode=False)
        sys.stdout.flush()
    except InputError as error:
        return _failed(str(error), WRONG_INPUT)
    except _usage_error() as error:
        words: Any = getattr(error, "format_message", error.__str__)
        return _failed(f"linkwright: {words()}", WRONG_INPUT)
    except typer.Abort:
        raise KeyboardInterrupt from None
    except OutputClosed:
        return READER_GONE
    except BrokenPipeError:
        drop_output()
        return READER_GONE
    except OSError as error:
        if error.filename is not None:
            return _failed(f"{error.filename}: {error.strerror or error}", WRONG_INPUT)
        drop_output()
        return _failed(f"standard output: cannot be written: {error.strerror}", WRONG_INPUT)
    except NoAnswer as error:
        return _failed(str(error), NO_ANSWER)
    except MemoryError:
        return _failed("linkwright: there is not enough memory for this; ask for less at once", NO_ANSWER)
    return status if isinstance(status, int) else 0


def _typed() -> list[str]:
    """What is being typed where a shell asks how it goes on, by the protocols of bash and fish, and of zsh."""
    words = os.environ.get("COMP_WORDS") or os.environ.get("_TYPER_COMPLETE_ARGS") or ""
    return words.split()[1:] if "_LINKWRIGHT_COMPLETE" in os.environ else []


def _usage_error() -> type[Exception]:
    """What a wrong use of the command line raises; its home moved between releases, its heir BadParameter did not."""
    ancestors = [kind for kind in typer.BadParameter.__mro__ if issubclass(kind, Exception)]
    return next(kind for kind in reversed(ancestors) if hasattr(kind, "exit_code"))


def _failed(message: str, status: int) -> int:
    try:
        print(printable(" ".join(message.split())), file=sys.stderr, flush=True)
    except OSError:
        drop_errors()  # nobody can be told
    return status
