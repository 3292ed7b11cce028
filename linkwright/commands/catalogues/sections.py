"""`linkwright sections`: the shapes that links can have, and the standard sizes."""

from __future__ import annotations

from typing import Annotated, Any

import typer

import linkwright as lw
from linkwright.commands.catalogues.section_edit import (
    FIGURES,
    QUERY,
    heading,
    properties_of,
    unit_of,
    value_of,
    written,
)
from linkwright.commands.groups import Commands, write_content
from linkwright.commands.options import JsonFile, as_options
from linkwright.core.sections import SHAPES, Section, Stock, StockSize
from linkwright.core.units.names import meant
from linkwright.core.units.quantities import InputError
from linkwright.json.fields import fields
from linkwright.output.files import check_target
from linkwright.results.figures_in_words import figure

from .section_edit import OWN, StockFile, edit_section, export_sections

UNCONFIRMED = "?: could not be found in its source; `sections show NAME` says what was looked for"


def list_sections(
    family: Annotated[
        list[str] | None,
        typer.Option("--family", metavar="NAME", help="Only the sizes of this family; may be repeated."),
    ] = None,
    where: Annotated[
        list[str] | None,
        typer.Option("--where", metavar="CONDITION", help="Only those that keep it, e.g. 'area < 10 cm^2'."),
    ] = None,
    sort: Annotated[
        str | None, typer.Option("--sort", metavar="FIGURE", help="In this order; --sort=-area: largest first.")
    ] = None,
    columns: Annotated[
        str | None, typer.Option("--columns", metavar="A,B,...", help="Which figures to show; 'all' for all.")
    ] = None,
    json: JsonFile = None,
    catalogue: StockFile = None,
) -> None:
    """Every shape with its dimensions and every family of stock sizes; with an option, stock sizes one a line.

    Example: linkwright sections list --family IPE --where 'I_y > 500 cm^4' --sort=-area --columns height,area,W_y
    """
    from linkwright.screen.console import console

    check_target(json, catalogue)
    names = QUERY.columns(columns)
    known = lw.sections.with_file(catalogue)
    with as_options():
        sizes = QUERY.chosen(known.of_family(*family) if family else known.values(), where, sort)
    every = not (family or where or sort or columns)
    shapes = [_shape_json(kind) for kind in SHAPES.values()] if every else []
    write_content(json, "sections", {"shapes": shapes, "stock": [_stock_json(size) for size in sizes]})
    if every:
        _print_shapes()
        _print_families(known.stock)
        console().print("`linkwright sections list --family NAME` lists a family's sizes")
    elif sizes:
        _print_sizes(sizes, names, dimensions=not columns)
    else:
        console().print("no stock size is so")


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
        write_content(json, "sections", _shape_json(SHAPES[name]))
        _print_shape(SHAPES[name])
        return
    try:
        size = lw.sections.with_file(catalogue)[name]
    except InputError as error:
        if error.key != "section":
            raise
        near = meant(name, SHAPES, 0.7)
        message = error.message if near is None else f"there is no shape or stock size {name!r}; did you mean '{near}'?"
        raise InputError("", "section", message) from None
    write_content(json, "sections", _stock_json(size))
    _print_size(size)


def compare_sections(
    names: Annotated[list[str], typer.Argument(metavar="NAME...", help="The sizes' names.")],
    json: JsonFile = None,
    catalogue: StockFile = None,
) -> None:
    """Several stock sizes side by side.

    Example: linkwright sections compare "IPE 80" "RHS 80x40x3" "CHS 60.3x4"
    """
    from linkwright.screen.console import console, table

    check_target(json, catalogue)
    if len(names) < 2:
        raise InputError("", "NAME", "needs two sizes or more to compare")
    known = lw.sections.with_file(catalogue)
    sizes = [known[name] for name in names]
    write_content(json, "sections", {"stock": [_stock_json(size) for size in sizes]})
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
    console().print(shown)
    if any(size.unconfirmed for size in sizes):
        console().print(UNCONFIRMED, soft_wrap=True)


def _print_shapes() -> None:
    from linkwright.screen.console import console, table

    shown = table("shape", "dimensions")
    for name, kind in SHAPES.items():
        shown.add_row(name, ", ".join(_dimension_words(kind)))
    console().print(shown)


def _print_families(stock: Stock) -> None:
    from linkwright.screen.console import console, table

    shown = table("family", "sizes", "from", "to", "source", numbers=(1,))
    for family in stock.families:
        sizes = stock.of_family(family)
        sources = dict.fromkeys(size.source.partition(",")[0] for size in sizes)
        marked = any(size.unconfirmed for size in sizes)
        name = family + (" ?" if marked else "")
        shown.add_row(name, str(len(sizes)), sizes[0].name, sizes[-1].name, ", ".join(sources))
    console().print(shown)
    if any(size.unconfirmed for size in stock):
        console().print(UNCONFIRMED, soft_wrap=True)


def _print_sizes(sizes: list[StockSize], names: tuple[str, ...], *, dimensions: bool) -> None:
    from linkwright.screen.console import console, table

    leading = ("size", "dimensions in mm") if dimensions else ("size",)
    numbers = tuple(range(len(leading), len(leading) + len(names)))
    shown = table(*leading, *(heading(name) for name in names), numbers=numbers)
    for size in sizes:
        own = [", ".join(figure(1e3 * value, 5) for value in size.dimensions.values())] if dimensions else []
        shown.add_row(size.name + (" ?" if size.unconfirmed else ""), *own, *(written(size, name) for name in names))
    console().print(shown)
    if len({(size.source, tuple(size.dimensions)) for size in sizes}) == 1:
        words = ", ".join(name.replace("_", " ") for name in sizes[0].dimensions)
        console().print(f"dimensions: {words}; {sizes[0].source}", soft_wrap=True)
    else:
        console().print(f"sources: {'; '.join(dict.fromkeys(size.source for size in sizes))}", soft_wrap=True)
    if any(size.unconfirmed for size in sizes):
        console().print(UNCONFIRMED, soft_wrap=True)


def _print_size(size: StockSize) -> None:
    from linkwright.screen.console import console, table

    screen = console()
    screen.print(f"{size.name}: {size.shape.replace('_', ' ')}", style="bold")
    shown = table("what", "value", "printed", numbers=(1, 2))
    for name, value in size.dimensions.items():
        shown.add_row(name.replace("_", " "), f"{figure(1e3 * value, 5)} mm", "")
    for name, (label, power) in FIGURES.items():
        printed = size.printed.get(f"{name}_cm{power}")
        shown.add_row(label, f"{written(size, name)} {unit_of(name)}", "" if printed is None else f"{printed:g}")
    screen.print(shown)
    figures = "printed figures checked against the dimensions" if size.printed else "figures computed"
    screen.print(f"{size.source}; {figures}; from {size.file}", soft_wrap=True)
    if size.found_in:
        screen.print(f"found in: {size.found_in}", soft_wrap=True)
    if size.unconfirmed:
        screen.print(f"not confirmed: {size.unconfirmed}", soft_wrap=True)


def _print_shape(kind: type[Section]) -> None:
    from linkwright.screen.console import console, table

    shown = table("dimension", "what", "")
    for dimension in kind.dimensions:
        shown.add_row(dimension.name, dimension.meaning, "may be left out" if dimension.optional else "")
    console().print(kind.shape, style="bold")
    console().print(shown)


def _stock_json(size: StockSize) -> dict[str, Any]:
    found = properties_of(size)
    figures = {
        f"{name}_cm{power}": float(f"{getattr(found, name) * 100.0**power:.6g}") for name, (_, power) in FIGURES.items()
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
    return [f"[{each.name}]" if each.optional else each.name for each in kind.dimensions]


def _shape_json(kind: type[Section]) -> dict[str, Any]:
    dimensions = [fields(each, "name", "meaning", "kind", "optional") for each in kind.dimensions]
    return {"name": kind.shape, "dimensions": dimensions, "can_be_optimised": bool(kind.variables)}


def group() -> Commands:
    """The commands of the group."""
    look = {"list": list_sections, "show": show_section, "compare": compare_sections}
    return {**look, **OWN.commands(export_sections, edit_section)}
