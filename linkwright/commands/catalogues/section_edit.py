"""Stock sizes for the command line: what a list can be asked for, and the edits of tables of one's own."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Annotated

import typer

import linkwright as lw
from linkwright.commands.catalogues.own import (
    Changes,
    Name,
    Names,
    OwnCatalogue,
    OwnFile,
    Source,
    TableFile,
    changes_of,
    say,
)
from linkwright.commands.catalogues.query import Query
from linkwright.core.catalogues.stock_csv import read_table, write_table
from linkwright.core.catalogues.stock_editor import STOCK, Row, cell, columns_of, row_of, rows_text
from linkwright.core.sections import SHAPES, SectionProperties, StockSize
from linkwright.core.sections.stock.tables import shipped_sizes, user_stock_path
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import read_text
from linkwright.results.figures_in_words import figure

POISSON_RATIO = 0.3
"""With which shear areas are listed; it changes them by some per cent at most."""

FIGURES: Mapping[str, tuple[str, int]] = MappingProxyType(
    {
        "area": ("area", 2),
        "second_moment_y": ("second moment about y", 4),
        "second_moment_z": ("second moment about z", 4),
        "torsion_constant": ("torsion constant", 4),
        "shear_area_y": ("shear area along y", 2),
        "shear_area_z": ("shear area along z", 2),
        "section_modulus_y": ("section modulus about y", 3),
        "section_modulus_z": ("section modulus about z", 3),
        "plastic_modulus_y": ("plastic modulus about y", 3),
        "plastic_modulus_z": ("plastic modulus about z", 3),
    }
)
"""What is computed of a size: its name in words, and the power of cm in which it is shown."""

SHORT: Mapping[str, str] = MappingProxyType(
    {
        "area": "A",
        "second_moment_y": "I_y",
        "second_moment_z": "I_z",
        "torsion_constant": "J",
        "shear_area_y": "A_sy",
        "shear_area_z": "A_sz",
        "section_modulus_y": "W_y",
        "section_modulus_z": "W_z",
        "plastic_modulus_y": "W_pl,y",
        "plastic_modulus_z": "W_pl,z",
    }
)
"""Headings shorter than the figures' names."""

_KINDS = MappingProxyType({2: "area", 3: "section_modulus", 4: "second_moment_of_area"})
_POWERS = "\N{SUPERSCRIPT TWO}\N{SUPERSCRIPT THREE}\N{SUPERSCRIPT FOUR}"


def properties_of(size: StockSize) -> SectionProperties:
    """The size's properties, for a Poisson's ratio of 0.3."""
    return size.section.properties(POISSON_RATIO)


def value_of(size: StockSize, name: str) -> float | None:
    """A figure or dimension in SI; None where the size has no such dimension.

    `width` and `height` are those of the bounding box, so that a round tube has them too.
    """
    if name in FIGURES or name in ("width", "height"):
        return float(getattr(properties_of(size), name))
    return size.dimensions.get(name)


def unit_of(name: str) -> str:
    """The unit in which a figure or dimension is shown."""
    return f"cm{_POWERS[FIGURES[name][1] - 2]}" if name in FIGURES else "mm"


def written(size: StockSize, name: str) -> str:
    """A figure or dimension of a size in its unit, a dash where it has none."""
    value = value_of(size, name)
    if value is None:
        return "–"
    return figure(value * 100.0 ** FIGURES[name][1], 4) if name in FIGURES else figure(1e3 * value, 5)


def heading(name: str) -> str:
    """A column's heading, with its unit."""
    return f"{SHORT.get(name, name.replace('_', ' '))} {unit_of(name)}"


def _names() -> tuple[str, ...]:
    dimensions = (each.name for kind in SHAPES.values() for each in kind.dimensions if each.kind != "points")
    return tuple(dict.fromkeys([*FIGURES, "width", "height", *dimensions]))


QUERY = Query[StockSize, str](
    names=_names,
    short=SHORT,
    usual=("area", "second_moment_y", "second_moment_z", "torsion_constant"),
    every=tuple(FIGURES),
    kind=lambda name: _KINDS[FIGURES[name][1]] if name in FIGURES else "length",
    value=value_of,
    lacks="a section has no '{}'",
    example="area < 10 cm^2",
)


StockFile = Annotated[
    Path | None,
    typer.Option("--catalogue", metavar="FILE", help="Stock sizes that add to the shipped ones, or replace them."),
]
_HELPS = MappingProxyType(
    {
        "add": """Add a stock size to your tables; printed figures, where given, must be those of its dimensions.

Example: linkwright sections add 'TUBE 60x4' shape=tube diameter='60 mm' thickness='4 mm' --source 'Offer 12'
""",
        "import": """Put stock sizes from a .yaml, .csv or .xlsx file into your tables; all of it or nothing.

Example: linkwright sections import supplier.csv
""",
        "check": "Recompute A and I of every row of stock tables; without a file those of the shipped ones and yours.",
    }
)


def _made(name: str, given: dict[str, str], source: str) -> Row:
    if "shape" not in given:
        raise InputError("", "shape", "is missing; write shape=tube, say")
    if not source:
        raise InputError("", "--source", "is missing: say where the size is from")
    shape = given.pop("shape")
    columns_of(shape)
    found = re.match(r"[^\d]*[^\d\s]", name)
    family = given.pop("family", found[0] if found else name)
    return Row(name, family, shape, source, dict(cell(shape, key, value) for key, value in given.items()))


def _found(catalogue: Path | None) -> Callable[[str], Row]:
    stock = lw.sections.with_file(catalogue).stock
    return lambda name: row_of(stock.find(name))


OWN = OwnCatalogue(
    group="sections",
    editor=STOCK,
    own=lambda: user_stock_path(),
    entry="stock size",
    called="tables",
    key="section",
    count=lambda path: len(STOCK.check(read_text(path), path)),
    shipped=lambda: [("shipped tables", len(shipped_sizes()))],
    examples=("'TUBE 60x4'", "'OUR 60x4'"),
    helps=_HELPS,
    such_as="thickness='4 mm'",
    made=_made,
    found=_found,
    known=lambda path: lw.sections.with_file(path),
    read={
        ".yaml": lambda path: [row_of(size) for size in STOCK.check(read_text(path), path)],
        ".csv": read_table,
        ".xlsx": read_table,
    },
)


def edit_section(
    name: Name,
    changes: Changes = None,
    source: Source = "",
    unset: Annotated[str | None, typer.Option("--unset", metavar="KEY", help="Take this key away.")] = None,
    catalogue: OwnFile = None,
) -> None:
    """Change keys of a stock size, or the file in $EDITOR; a shipped size is copied to yours.

    Example: linkwright sections edit 'TUBE 60x4' thickness '5 mm'
    """
    path = OWN.path(catalogue)
    if unset is not None:
        if changes or source:
            raise InputError("", "--unset", "stands alone")
        say(STOCK.remove_cell(path, name, unset), path)
    elif changes or source:
        say(STOCK.change_cells(path, name, changes_of(changes or [], OWN.such_as), source=source), path)
    else:
        OWN.edit_in_editor(path, name)


def export_sections(
    names: Names = None,
    family: Annotated[list[str] | None, typer.Option("--family", help="This family too; may be repeated.")] = None,
    out: TableFile = Path("sections.yaml"),
    catalogue: StockFile = None,
) -> None:
    """Write stock sizes to a .yaml or .csv file, or to .tex, .md, .parquet; all without a name or family.

    Example: linkwright sections export --family IPE --out ipe.csv
    """
    known = lw.sections.with_file(catalogue)
    found = [*(known[name] for name in names or ()), *known.of_family(*family or ())]
    chosen = found if names or family else known.values()
    OWN.write(
        out, list(dict.fromkeys(size.name for size in chosen)), catalogue, {".yaml": rows_text, ".csv": write_table}
    )
