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

COMMANDS: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        **dict.fromkeys(("evaluate", "optimize", "tradeoff", "inverse", "seam", "budget"), ("from_face", "Design")),
        **dict.fromkeys(("diagnose", "compare", "predict", "compensate"), ("from_face", "Diagnose")),
        **dict.fromkeys(("plan", "watch", "simulate"), ("from_face", "Diagnose")),
        **dict.fromkeys(("import", "export", "columns"), ("from_face", "Files")),
        **{name: (f"catalogues.{name}", "Catalogues") for name in ("materials", "sections", "actuators", "effects")},
        **dict.fromkeys(("tables", "figures"), ("from_face", "Paper")),
        "serve": ("serve", "Program"),
        "doctor": ("doctor", "Program"),
    }
)
"""Every command with its module and the part of the help where it stands, in their order. A module has `commands()`,
those that are made of the functions of `linkwright`, by name; or `HELP` and a function of the command's name; or
`group()`, the commands that a command has of its own. What they work with they import inside their functions, for the
help of all commands imports every one of these modules but those of catalogues."""

CATALOGUES: Mapping[str, str] = MappingProxyType(
    {
        "materials": "What links can be made of: list, show, compare, add, edit, remove, import, export, check.",
        "sections": "Shapes and standard sizes: list, show, compare, add, edit, remove, import, export, check.",
        "actuators": "Gears and actuators by name: list, show, add, edit, remove, import, export, check.",
        "effects": "The physics that the models know: list, show.",
    }
)
"""The commands that have commands of their own, and their help."""

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


def command_line(asked: str = "") -> typer.Typer:
    """The command line with the command that is asked for; for any other word, with all, the groups by their help only.

    Nothing that the word cannot come to is imported.
    """
    root: dict[str, Any] = {**PLAIN, "add_completion": True}
    made: Any = typer.Typer(help=HELP, epilog=STATUSES, callback=_start, invoke_without_command=True, **root)
    for name in (asked,) if asked in COMMANDS else () if asked == VERSION else COMMANDS:
        home, panel = COMMANDS[name]
        if name in CATALOGUES and name != asked:
            made.add_typer(command_group(CATALOGUES[name], {}), name=name, rich_help_panel=panel)
            continue
        module: Any = import_module(f"linkwright.commands.{home}")
        if name in CATALOGUES:
            made.add_typer(command_group(CATALOGUES[name], module.group()), name=name, rich_help_panel=panel)
        elif hasattr(module, "commands"):
            command: Made = module.commands()[name]
            settings = {"ignore_unknown_options": True} if command.negative else {}
            made.command(name, help=command.help, context_settings=settings, rich_help_panel=panel)(command.typed())
        else:
            made.command(name, help=module.HELP, rich_help_panel=panel)(getattr(module, name))
    return made


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
