"""Options and arguments that several commands share, and how a command reads its inputs."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from materials.catalogue import Catalogue, load_catalogue
from materials.quantities import InputError

JsonFile = Annotated[Path | None, typer.Option("--json", metavar="FILE", help="Write the result for machines.")]
CatalogueFile = Annotated[
    Path | None,
    typer.Option("--catalogue", metavar="FILE", help="Materials that add to the shipped ones, or replace them."),
]
OutFolder = Annotated[
    Path | None,
    typer.Option("--out", metavar="DIR", help="Write report.html and the other files there; nothing is without it."),
]


def catalogue_with(path: Path | None) -> Catalogue:
    """The catalogue, with a file of one's own over it. Raises `InputError`."""
    return load_catalogue([path] if path is not None else [])


@contextmanager
def asked_of(file: Path) -> Generator[None]:
    """Turn what the arm of a file lacks into wrong input that names the file."""
    from arm.effects.thermal_expansion import ThermalExpansionMissing
    from arm.model import PropertyNeeded

    try:
        yield
    except (PropertyNeeded, ThermalExpansionMissing) as error:
        raise InputError(file, "", str(error)) from None
