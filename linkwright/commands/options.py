"""Options and arguments that several commands share, and how a command reads its inputs."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from units.quantities import InputError

JsonFile = Annotated[Path | None, typer.Option("--json", metavar="FILE", help="Write the result for machines.")]
MarkdownFile = Annotated[
    Path | None, typer.Option("--markdown", metavar="FILE", help="Write the result as Markdown, for notes and issues.")
]
CatalogueFile = Annotated[
    Path | None,
    typer.Option("--catalogue", metavar="FILE", help="Materials that add to the shipped ones, or replace them."),
]
OutFolder = Annotated[
    Path | None,
    typer.Option("--out", metavar="DIR", help="Write report.html and the other files there; nothing is without it."),
]


@contextmanager
def as_options(**named: str) -> Generator[None]:
    """Name what a call was given wrongly as the command line has it: `payload` is `--payload`, unless `named`."""
    try:
        yield
    except InputError as error:
        if error.file == "with_":
            raise InputError("--with", error.key, error.message) from None
        if error.file or not error.key.isidentifier():
            raise
        option = f"--{error.key.rstrip('_').replace('_', '-')}"
        raise InputError("", named.get(error.key, option), error.message) from None


@contextmanager
def asked_of(file: Path) -> Generator[None]:
    """Turn what the arm of a file lacks into wrong input that names the file."""
    from arm.effects.thermal.thermal_expansion import ThermalExpansionMissing
    from arm.errors.model import PropertyNeeded

    try:
        yield
    except (PropertyNeeded, ThermalExpansionMissing) as error:
        raise InputError(file, "", str(error)) from None
