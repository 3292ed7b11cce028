"""How the commands of `linkwright sections` read stock sizes."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from materials.quantities import InputError
from sections import SectionError, Stock, load_stock

StockFile = Annotated[
    Path | None,
    typer.Option("--catalogue", metavar="FILE", help="Stock sizes that add to the shipped ones, or replace them."),
]


def stock_with(catalogue: Path | None) -> Stock:
    """The stock sizes, with a file of one's own over them. Raises `InputError`."""
    try:
        return load_stock([catalogue] if catalogue is not None else [])
    except SectionError as error:
        raise InputError("", "", error.message) from None
