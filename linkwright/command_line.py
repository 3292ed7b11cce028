"""The commands put together, and how their ends become exit statuses (see `linkwright.cli`)."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import Annotated, Any

import typer

from linkwright.screen.console import OutputClosed, drop_output
from materials.quantities import InputError

from .as_json import program_version
from .commands import (
    actuators,
    compare,
    compensate,
    diagnose,
    effects,
    evaluate,
    figures,
    materials,
    optimize,
    seam,
    sections,
    simulate,
    tables,
    tradeoff,
)
from .commands.groups import PLAIN

NO_ANSWER, WRONG_INPUT, READER_GONE = 1, 2, 141

HELP = """Design robot arms for the least worst-case position error.

Example: linkwright optimize problem.yaml --out result
"""


def _version(asked: bool) -> None:
    if asked:
        typer.echo(f"linkwright {program_version()}")
        raise typer.Exit


def _start(
    context: typer.Context,
    version: Annotated[  # noqa: ARG001 - its callback does it all
        bool, typer.Option("--version", help="Show the version.", callback=_version, is_eager=True)
    ] = False,
) -> None:
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())


def command_line() -> typer.Typer:
    """The whole command line."""
    made: Any = typer.Typer(help=HELP, callback=_start, invoke_without_command=True, **PLAIN)
    made.command("evaluate", help=evaluate.HELP)(evaluate.evaluate)
    made.command("optimize", help=optimize.HELP)(optimize.optimize)
    made.command("tables", help=tables.HELP)(tables.tables)
    made.command("figures", help=figures.HELP)(figures.figures)
    made.command("seam", help=seam.HELP)(seam.seam)
    made.command("simulate", help=simulate.HELP)(simulate.simulate)
    made.command("tradeoff", help=tradeoff.HELP)(tradeoff.tradeoff)
    made.command("diagnose", help=diagnose.HELP)(diagnose.diagnose)
    made.command("compare", help=compare.HELP)(compare.compare)
    made.command("compensate", help=compensate.HELP)(compensate.compensate)
    made.add_typer(materials.group(), name="materials")
    made.add_typer(sections.group(), name="sections")
    made.add_typer(effects.group(), name="effects")
    made.add_typer(actuators.group(), name="actuators")
    return made


def outcome(arguments: Sequence[str] | None = None) -> int:
    """Run the command line with these arguments (the process's own by default) and return the exit status."""
    for stream in (sys.stdout, sys.stderr):
        reconfigure = getattr(stream, "reconfigure", None)
        if reconfigure is not None:
            reconfigure(errors="replace")  # a terminal that cannot show a symbol shows a question mark
    given = None if arguments is None else list(arguments)
    try:
        status: object = command_line()(args=given, prog_name="linkwright", standalone_mode=False)
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
            raise
        drop_output()
        return _failed(f"standard output: cannot be written: {error.strerror}", WRONG_INPUT)
    except _unanswerable() as error:
        return _failed(str(error), NO_ANSWER)
    return status if isinstance(status, int) else 0


def _usage_error() -> type[Exception]:
    """What a wrong use of the command line raises; its home moved between releases, its heir BadParameter did not."""
    ancestors = [kind for kind in typer.BadParameter.__mro__ if issubclass(kind, Exception)]
    return next(kind for kind in reversed(ancestors) if hasattr(kind, "exit_code"))


def _unanswerable() -> tuple[type[Exception], ...]:
    """What a well-formed question without an answer raises; looked up only once something has gone wrong."""
    from arm.workspace import Unreachable
    from optimize.problem import NoAnswer

    return Unreachable, NoAnswer


def _failed(message: str, status: int) -> int:
    print(" ".join(message.split()), file=sys.stderr)
    return status
