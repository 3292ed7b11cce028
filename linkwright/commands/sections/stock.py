"""The option that several commands of `linkwright sections` share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

StockFile = Annotated[
    Path | None,
    typer.Option("--catalogue", metavar="FILE", help="Stock sizes that add to the shipped ones, or replace them."),
]
