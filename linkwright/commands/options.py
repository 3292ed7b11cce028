"""Options that several commands share, groups of commands, and how a command tells its result."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer

from linkwright.core.units.quantities import InputError, NoAnswer

if TYPE_CHECKING:
    from linkwright.core.executors import Executor


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


def answer(json: Path | None, command: str, content: Mapping[str, Any], *parts: Any, title: str = "") -> None:
    """Write what a command found as `write_content` does, then print it (`screen.console.tell`)."""
    from linkwright.screen.console import tell

    write_content(json, command, content)
    tell(*parts, title=title)


JsonFile = Annotated[
    Path | None, typer.Option("--json", metavar="FILE", help="Write the result for machines (- for standard output).")
]
MarkdownFile = Annotated[
    Path | None, typer.Option("--markdown", metavar="FILE", help="Write the result as Markdown, for notes and issues.")
]
PdfFile = Annotated[
    Path | None,
    typer.Option("--pdf", metavar="FILE", help="Write the report as a PDF of A4 pages, by Chromium, Chrome or Edge."),
]
CatalogueFile = Annotated[
    Path | None,
    typer.Option("--catalogue", metavar="FILE", help="Materials that add to the shipped ones, or replace them."),
]
Author = Annotated[str, typer.Option("--author", metavar="NAME", help="Who made the report, named at its end.")]
Comment = Annotated[str, typer.Option("--comment", metavar="TEXT", help="What the report shall say beside that.")]

Tip = Annotated[
    str | None,
    typer.Option(
        "--tip",
        metavar="NAME",
        help="Which arm counts, of several on one torso (`branches`). For URDF or MJCF its end.",
    ),
]

Workers = Annotated[
    int | None,
    typer.Option("--workers", metavar="N", min=1, help="Processes for what takes long. Default: one for each core."),
]
Dask = Annotated[
    str | None,
    typer.Option("--dask", metavar="ADDRESS", help="A cluster for what takes long: its scheduler, tcp://HOST:8786."),
]


Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Show the answer and warnings alone, and no progress.")]
Verbose = Annotated[bool, typer.Option("--verbose", "-v", help="Show what is else left to the report too.")]


def check_pdf(path: Path | None) -> None:
    """Refuse, before any work is done, a PDF that could not be made. Raises `InputError`."""
    if path is not None:
        from linkwright.output.files import OUTPUT
        from linkwright.report.page import need_browser

        if path == OUTPUT:
            raise InputError("", "--pdf", "needs the name of a file; a PDF is nothing for standard output")
        need_browser()


def tell_written(written: Sequence[Path], unwritten: str = "") -> None:
    """List the files that were written, or say that there are none, but for whoever wants the answer alone."""
    from linkwright.screen.console import console, loudness

    if loudness() != "answer":
        for line in [f"written: {path}" for path in written] or ([unwritten] if unwritten else []):
            console().print(line, soft_wrap=True)


@contextmanager
def not_lost(answer: Callable[[], None]) -> Generator[None]:
    """While an answer is written: where that fails (a full disk), or what was written does not read back as it, it is
    shown before the error is told."""
    from linkwright.output.files import NotAsWritten

    try:
        yield
    except (InputError, NotAsWritten, OSError):
        answer()
        raise


@contextmanager
def crew_of(workers: int | None, dask: str | None) -> Generator[Executor]:
    """The processes or the cluster that the options ask for. Where they are lost before there is any answer, one line
    says so."""
    from linkwright.core.executors import Cluster, Processes, WorkersLost

    if dask is not None and workers is not None:
        raise InputError("", "--workers", "goes without --dask, whose workers are the cluster's own; leave one out")
    with Processes(workers) if dask is None else Cluster(dask) as made:
        try:
            yield made
        except WorkersLost as error:
            raise NoAnswer(str(error)) from None


def stop(crew: Executor, kept: str) -> NoReturn:
    """End a command that was stopped, with one line of what is kept: as Ctrl-C does, or, where those who did the work
    are lost, as what has no answer."""
    from linkwright.screen.console import console

    if crew.lost is not None:
        raise NoAnswer(f"{crew.lost}; {kept}")
    console(errors=True).print(f"stopped: {kept}", soft_wrap=True)
    raise KeyboardInterrupt


@contextmanager
def as_options() -> Generator[None]:
    """Name what a call was given wrongly as the command line has it: `family` is `--family`."""
    try:
        yield
    except InputError as error:
        if error.file or not error.key.isidentifier():
            raise
        raise InputError("", f"--{error.key}", error.message) from None


@contextmanager
def asked_of(file: Path) -> Generator[None]:
    """Turn what the arm of a file lacks into wrong input that names the file."""
    from linkwright.core.arm.bodies.beams import MassNeeded, PropertyNeeded
    from linkwright.core.arm.effects.thermal.thermal_expansion import ThermalExpansionMissing

    try:
        yield
    except MassNeeded as error:
        from linkwright.face.arm import DESCRIPTIONS

        if file.suffix.lower() not in DESCRIPTIONS:
            raise InputError(file, "", str(error)) from None
        from linkwright.core.arm.descriptions.imported import weight_to_write

        raise InputError(file, "", f"{error.what}; {weight_to_write(file, error.link)}{error.beyond}") from None
    except (PropertyNeeded, ThermalExpansionMissing) as error:
        raise InputError(file, "", str(error)) from None
