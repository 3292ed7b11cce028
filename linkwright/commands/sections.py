"""`linkwright sections`: the shapes that links can have, and the standard sizes."""

from __future__ import annotations

import difflib
from pathlib import Path
from typing import Annotated, Any

import typer

from linkwright.as_json import program_version
from linkwright.words import figure
from linkwright.writing import check_target, write_json
from materials.quantities import InputError
from sections import SHAPES, Section, SectionError, SectionProperties, Stock, StockSize, load_stock

from .groups import command_group
from .options import JsonFile

HELP = """The shapes that links can have and the standard sizes: list, show."""
LIST_HELP = """Every shape with its dimensions, and every stock size.

Example: linkwright sections list --family IPE
"""
SHOW_HELP = """One shape, or one stock size with its properties.

Example: linkwright sections show "IPE 80"
"""
StockFile = Annotated[
    Path | None,
    typer.Option("--catalogue", metavar="FILE", help="Stock sizes that add to the shipped ones, or replace them."),
]
_POISSON_RATIO = 0.3


def list_sections(
    family: Annotated[
        str | None, typer.Option("--family", metavar="NAME", help="Only the stock sizes of this family, one a line.")
    ] = None,
    json: JsonFile = None,
    catalogue: StockFile = None,
) -> None:
    """Run `sections list`."""
    from linkwright.screen.console import console

    check_target(json, catalogue)
    stock = _stock(catalogue)
    try:
        sizes = stock.sizes if family is None else stock.of_family(family)
    except SectionError as error:
        raise InputError("", "--family", error.message) from None
    shapes = [_shape_json(kind) for kind in SHAPES.values()] if family is None else []
    _write(json, {"shapes": shapes, "stock": [_stock_json(size) for size in sizes]})
    if family is None:
        _print_shapes()
        _print_families(stock)
        console().print("`linkwright sections list --family NAME` lists a family's sizes")
    else:
        _print_sizes(sizes)


def show_section(
    name: Annotated[str, typer.Argument(metavar="NAME", help="A shape, or a stock size.")],
    json: JsonFile = None,
    catalogue: StockFile = None,
) -> None:
    """Run `sections show`."""
    check_target(json, catalogue)
    if name in SHAPES:
        _write(json, _shape_json(SHAPES[name]))
        _print_shape(SHAPES[name])
        return
    stock = _stock(catalogue)
    try:
        size = stock.find(name)
    except SectionError as error:
        near = difflib.get_close_matches(name, SHAPES, n=1, cutoff=0.7)
        message = f"there is no shape or stock size {name!r}; did you mean {near[0]}?" if near else error.message
        raise InputError("", "section", message) from None
    _write(json, _stock_json(size))
    _print_size(size)


def _stock(catalogue: Path | None) -> Stock:
    try:
        return load_stock([catalogue] if catalogue is not None else [])
    except SectionError as error:
        raise InputError("", "", error.message) from None


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
        shown.add_row(family, str(len(sizes)), sizes[0].name, sizes[-1].name, ", ".join(sources))
    console().print(shown)


def _print_sizes(sizes: tuple[StockSize, ...]) -> None:
    from linkwright.screen.console import console, table

    shown = table("size", "dimensions in mm", "A cm²", "I_y cm⁴", "I_z cm⁴", "J cm⁴", numbers=(2, 3, 4, 5))
    for size in sizes:
        found = size.section.properties(_POISSON_RATIO)
        moments = (found.second_moment_y, found.second_moment_z, found.torsion_constant)
        dimensions = ", ".join(figure(1e3 * value, 5) for value in size.dimensions.values())
        shown.add_row(size.name, dimensions, _cm(found.area, 2), *(_cm(value, 4) for value in moments))
    console().print(shown)
    names = ", ".join(name.replace("_", " ") for name in sizes[0].dimensions)
    console().print(f"dimensions: {names}; {sizes[0].source}", soft_wrap=True)


def _print_size(size: StockSize) -> None:
    from linkwright.screen.console import console, table

    screen = console()
    screen.print(f"{size.name}: {size.shape.replace('_', ' ')}", style="bold")
    shown = table("what", "value", "printed", numbers=(1, 2))
    for name, value in size.dimensions.items():
        shown.add_row(name.replace("_", " "), f"{figure(1e3 * value, 5)} mm", "")
    found = size.section.properties(_POISSON_RATIO)
    for name, label, power in _SHOWN:
        unit = "cm" + "\N{SUPERSCRIPT TWO}\N{SUPERSCRIPT THREE}\N{SUPERSCRIPT FOUR}"[power - 2]
        printed = size.printed.get(f"{name}_cm{power}")
        shown.add_row(label, f"{_cm(getattr(found, name), power)} {unit}", "" if printed is None else f"{printed:g}")
    screen.print(shown)
    figures = "printed figures checked against the dimensions" if size.printed else "figures computed"
    screen.print(f"{size.source}; {figures}; from {size.file}", soft_wrap=True)


_SHOWN = (
    ("area", "area", 2),
    ("second_moment_y", "second moment about y", 4),
    ("second_moment_z", "second moment about z", 4),
    ("torsion_constant", "torsion constant", 4),
    ("shear_area_y", "shear area along y", 2),
    ("shear_area_z", "shear area along z", 2),
    ("section_modulus_y", "section modulus about y", 3),
    ("section_modulus_z", "section modulus about z", 3),
    ("plastic_modulus_y", "plastic modulus about y", 3),
    ("plastic_modulus_z", "plastic modulus about z", 3),
)


def _cm(value: float, power: int) -> str:
    return figure(value * 100.0**power, 4)


def _print_shape(kind: type[Section]) -> None:
    from linkwright.screen.console import console, table

    shown = table("dimension", "what", "")
    for dimension in kind.dimensions:
        shown.add_row(dimension.name, dimension.meaning, "may be left out" if dimension.optional else "")
    console().print(kind.shape, style="bold")
    console().print(shown)


def _stock_json(size: StockSize) -> dict[str, Any]:
    found: SectionProperties = size.section.properties(_POISSON_RATIO)
    return {
        "name": size.name,
        "family": size.family,
        "shape": size.shape,
        "dimensions_mm": {name: float(f"{1e3 * value:.10g}") for name, value in size.dimensions.items()},
        **{f"{name}_cm{power}": float(f"{getattr(found, name) * 100.0**power:.6g}") for name, _, power in _SHOWN},
        "printed": dict(size.printed) or None,
        "source": size.source,
        "file": size.file,
    }


def _dimension_words(kind: type[Section]) -> list[str]:
    return [f"[{each.name}]" if each.optional else each.name for each in kind.dimensions]


def _shape_json(kind: type[Section]) -> dict[str, Any]:
    return {
        "name": kind.shape,
        "dimensions": [
            {"name": each.name, "meaning": each.meaning, "kind": each.kind, "optional": each.optional}
            for each in kind.dimensions
        ],
        "can_be_optimised": bool(kind.variables),
    }


def _write(json: Path | None, content: dict[str, Any]) -> None:
    write_json(json, {"made_by": f"linkwright sections {program_version()}", **content})


def group() -> typer.Typer:
    """The command group."""
    return command_group(HELP, {"list": (list_sections, LIST_HELP), "show": (show_section, SHOW_HELP)})
