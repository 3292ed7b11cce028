"""`linkwright sections`: the shapes that links can have, the standard sizes, and tables of one's own."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any

import typer
from rich.table import Table

import linkwright as lw
from linkwright.commands.catalogues.query import Query
from linkwright.commands.catalogues.user_catalogue import (
    Changes,
    Name,
    Names,
    Source,
    TableFile,
    UserCatalogue,
    UserFile,
    changes_of,
    say,
)
from linkwright.commands.options import Commands, JsonFile, answer, as_options, write_content
from linkwright.core.catalogues.stock_csv import read_table, write_table
from linkwright.core.catalogues.stock_editor import STOCK, Row, cell, columns_of, row_of, rows_text
from linkwright.core.sections import SHAPES, Section, SectionProperties, Stock, StockSize
from linkwright.core.sections.stock.tables import USER_STOCK, shipped_sizes
from linkwright.core.units.names import meant
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import read_text
from linkwright.json.fields import fields
from linkwright.output.files import check_target
from linkwright.results.figures_in_words import figure
from linkwright.screen.console import table, tell

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
    dimensions = (
        dimension.name for kind in SHAPES.values() for dimension in kind.dimensions if dimension.kind != "points"
    )
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
        "import": """Put stock sizes from a .yaml, .csv or .xlsx file into your tables; each wrong row is named.

Example: linkwright sections import supplier.csv
""",
        "check": "Recompute A and I of every row of stock tables. Without a file those of the shipped ones and yours.",
    }
)


def _made(name: str, values: dict[str, str], source: str) -> Row:
    if "shape" not in values:
        raise InputError("", "shape", "is missing; write shape=tube, say")
    if not source:
        raise InputError("", "--source", "is missing: say where the size is from")
    shape = values.pop("shape")
    columns_of(shape)
    designation = re.match(r"[^\d]*[^\d\s]", name)
    family = values.pop("family", designation[0] if designation else name)
    return Row(name, family, shape, source, dict(cell(shape, key, value) for key, value in values.items()))


def _finder(catalogue: Path | None) -> Callable[[str], Row]:
    stock = lw.sections.with_file(catalogue).stock
    return lambda name: row_of(stock.find(name))


CATALOGUE = UserCatalogue(
    group="sections",
    editor=STOCK,
    user_file=USER_STOCK.path,
    entry="stock size",
    called="tables",
    key="section",
    count=lambda path: len(STOCK.check(read_text(path), path)),
    shipped=lambda: [("shipped tables", len(shipped_sizes()))],
    example="'TUBE 60x4'",
    helps=_HELPS,
    such_as="thickness='4 mm'",
    made=_made,
    finder=_finder,
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
    catalogue: UserFile = None,
) -> None:
    """Change keys of a stock size, or the file in $EDITOR; a shipped size is copied to yours.

    Example: linkwright sections edit 'TUBE 60x4' thickness '5 mm'
    """
    path = CATALOGUE.path(catalogue)
    if unset is not None:
        if changes or source:
            raise InputError("", "--unset", "stands alone")
        say(STOCK.remove_cell(path, name, unset), path)
    elif changes or source:
        say(STOCK.change_cells(path, name, changes_of(changes or [], CATALOGUE.such_as), source=source), path)
    else:
        CATALOGUE.edit_in_editor(path, name)


def export_sections(
    names: Names = None,
    family: Annotated[list[str] | None, typer.Option("--family", help="This family too. May be repeated.")] = None,
    out: TableFile = Path("sections.yaml"),
    catalogue: StockFile = None,
) -> None:
    """Write stock sizes to a .yaml or .csv file, or to .md, .parquet; all without a name or family.

    Example: linkwright sections export --family IPE --out ipe.csv
    """
    known = lw.sections.with_file(catalogue)
    sizes = [*(known[name] for name in names or ()), *known.of_family(*family or ())]
    chosen = sizes if names or family else known.values()
    CATALOGUE.write(
        out, list(dict.fromkeys(size.name for size in chosen)), catalogue, {".yaml": rows_text, ".csv": write_table}
    )


UNCONFIRMED = "?: could not be found in its source; `sections show NAME` says what was looked for"


def list_sections(
    family: Annotated[
        list[str] | None,
        typer.Option("--family", metavar="NAME", help="Only the sizes of this family. May be repeated."),
    ] = None,
    where: Annotated[
        list[str] | None,
        typer.Option("--where", metavar="CONDITION", help="Only those that keep it, e.g. 'area < 10 cm^2'."),
    ] = None,
    sort: Annotated[
        str | None, typer.Option("--sort", metavar="FIGURE", help="In this order. --sort=-area: largest first.")
    ] = None,
    columns: Annotated[
        str | None, typer.Option("--columns", metavar="A,B,...", help="Which figures to show, or 'all'.")
    ] = None,
    json: JsonFile = None,
    catalogue: StockFile = None,
) -> None:
    """Every shape with its dimensions and every family of stock sizes; with an option, stock sizes one a line.

    Example: linkwright sections list --family IPE --where 'I_y > 500 cm^4' --sort=-area --columns height,area,W_y
    """
    check_target(json, catalogue)
    names = QUERY.columns(columns)
    known = lw.sections.with_file(catalogue)
    with as_options():
        sizes = QUERY.chosen(known.of_family(*family) if family else known.values(), where, sort)
    every = not (family or where or sort or columns)
    if json is not None:
        shapes = [_shape_json(kind) for kind in SHAPES.values()] if every else []
        write_content(json, "sections", {"shapes": shapes, "stock": [_stock_json(size) for size in sizes]})
    if every:
        _print_shapes()
        _print_families(known.stock)
        tell("`linkwright sections list --family NAME` lists a family's sizes")
    elif sizes:
        _print_sizes(sizes, names, dimensions=not columns)
    else:
        tell("no stock size is so")


def show_section(
    name: Annotated[str, typer.Argument(metavar="NAME", help="A shape, or a stock size.")],
    json: JsonFile = None,
    catalogue: StockFile = None,
) -> None:
    """One shape, or one stock size with its properties.

    Example: linkwright sections show "IPE 80"
    """
    check_target(json, catalogue)
    if name in SHAPES:
        kind = SHAPES[name]
        shown = table("dimension", "what", "")
        for dimension in kind.dimensions:
            shown.add_row(dimension.name, dimension.meaning, "optional" if dimension.optional else "")
        answer(json, "sections", _shape_json(kind), shown, title=kind.shape)
        return
    try:
        size = lw.sections.with_file(catalogue)[name]
    except InputError as error:
        if error.key != "section":
            raise
        near = meant(name, SHAPES, 0.7)
        message = error.message if near is None else f"there is no shape or stock size {name!r}; did you mean '{near}'?"
        raise InputError("", "section", message) from None
    answer(
        json, "sections", _stock_json(size), *_size_shown(size), title=f"{size.name}: {size.shape.replace('_', ' ')}"
    )


def compare_sections(
    names: Annotated[list[str], typer.Argument(metavar="NAME", help="The sizes' names.")],
    json: JsonFile = None,
    catalogue: StockFile = None,
) -> None:
    """Several stock sizes side by side.

    Example: linkwright sections compare "IPE 80" "RHS 80x40x3" "CHS 60.3x4"
    """
    check_target(json, catalogue)
    if len(names) < 2:
        raise InputError("", "NAME", "needs two sizes or more to compare")
    known = lw.sections.with_file(catalogue)
    sizes = [known[name] for name in names]
    marked = (size.name + (" ?" if size.unconfirmed else "") for size in sizes)
    shown = table("what", *marked, numbers=tuple(range(1, len(sizes) + 1)))
    shown.add_row("shape", *(size.shape.replace("_", " ") for size in sizes))
    for name in dict.fromkeys(["height", "width", *(name for size in sizes for name in size.dimensions), *FIGURES]):
        label = FIGURES[name][0] if name in FIGURES else name.replace("_", " ")
        shown.add_row(f"{label}, {unit_of(name)}", *(written(size, name) for size in sizes))
    for name in ("second_moment_y", "second_moment_z"):
        ratios = ((value_of(size, name) or 0.0) / (value_of(size, "area") or 1.0) for size in sizes)
        label = "I_y" if name.endswith("y") else "I_z"
        shown.add_row(f"{label} / A, cm²", *(figure(1e4 * ratio, 4) for ratio in ratios))
    content = {"stock": [_stock_json(size) for size in sizes]}
    answer(json, "sections", content, shown, UNCONFIRMED if any(size.unconfirmed for size in sizes) else "")


def _print_shapes() -> None:
    shown = table("shape", "dimensions")
    for name, kind in SHAPES.items():
        shown.add_row(name, ", ".join(_dimension_words(kind)))
    tell(shown)


def _print_families(stock: Stock) -> None:
    shown = table("family", "sizes", "from", "to", "source", numbers=(1,))
    for family in stock.families:
        sizes = stock.of_family(family)
        sources = dict.fromkeys(size.source.partition(",")[0] for size in sizes)
        marked = any(size.unconfirmed for size in sizes)
        name = family + (" ?" if marked else "")
        shown.add_row(name, str(len(sizes)), sizes[0].name, sizes[-1].name, ", ".join(sources))
    tell(shown, UNCONFIRMED if any(size.unconfirmed for size in stock) else "")


def _print_sizes(sizes: list[StockSize], names: tuple[str, ...], *, dimensions: bool) -> None:
    leading = ("size", "dimensions in mm") if dimensions else ("size",)
    numbers = tuple(range(len(leading), len(leading) + len(names)))
    shown = table(*leading, *(heading(name) for name in names), numbers=numbers)
    for size in sizes:
        values = [", ".join(figure(1e3 * value, 5) for value in size.dimensions.values())] if dimensions else []
        shown.add_row(size.name + (" ?" if size.unconfirmed else ""), *values, *(written(size, name) for name in names))
    note = f"sources: {'; '.join(dict.fromkeys(size.source for size in sizes))}"
    if len({(size.source, tuple(size.dimensions)) for size in sizes}) == 1:
        note = f"dimensions: {', '.join(name.replace('_', ' ') for name in sizes[0].dimensions)}; {sizes[0].source}"
    tell(shown, note, UNCONFIRMED if any(size.unconfirmed for size in sizes) else "")


def _size_shown(size: StockSize) -> tuple[Table | str, ...]:
    shown = table("what", "value", "printed", numbers=(1, 2))
    for name, value in size.dimensions.items():
        shown.add_row(name.replace("_", " "), f"{figure(1e3 * value, 5)} mm", "")
    for name, (label, power) in FIGURES.items():
        shown.add_row(label, f"{written(size, name)} {unit_of(name)}", _printed(size, name, power))
    figures = "printed figures checked against the dimensions" if size.printed else "figures computed"
    unconfirmed = f"not confirmed: {size.unconfirmed}" if size.unconfirmed else ""
    return (
        shown,
        f"{size.source}; {figures}; from {size.file}",
        size.found_in and f"found in: {size.found_in}",
        unconfirmed,
    )


def _printed(size: StockSize, name: str, power: int) -> str:
    """A figure as its source prints it, with its unit where that is in inches."""
    if (metric := size.printed.get(f"{name}_cm{power}")) is not None:
        return f"{metric:g}"
    inches = size.printed.get(f"{name}_in{power}")
    return "" if inches is None else f"{inches:g} in{_POWERS[power - 2]}"


def _stock_json(size: StockSize) -> dict[str, Any]:
    properties = properties_of(size)
    figures = {
        f"{name}_cm{power}": float(f"{getattr(properties, name) * 100.0**power:.6g}")
        for name, (_, power) in FIGURES.items()
    }
    return {
        **fields(size, "name", "family", "shape"),
        "dimensions_mm": {name: float(f"{1e3 * value:.10g}") for name, value in size.dimensions.items()},
        **figures,
        "printed": dict(size.printed) or None,
        "source": size.source,
        "found_in": size.found_in or None,
        "unconfirmed": size.unconfirmed or None,
        "file": size.file,
    }


def _dimension_words(kind: type[Section]) -> list[str]:
    return [f"[{dimension.name}]" if dimension.optional else dimension.name for dimension in kind.dimensions]


def _shape_json(kind: type[Section]) -> dict[str, Any]:
    dimensions = [fields(dimension, "name", "meaning", "kind", "optional") for dimension in kind.dimensions]
    return {"name": kind.shape, "dimensions": dimensions, "can_be_optimised": bool(kind.variables)}


def group() -> Commands:
    """The commands of the group."""
    look = {"list": list_sections, "show": show_section, "compare": compare_sections}
    return {**look, **CATALOGUE.commands(export_sections, edit_section)}
