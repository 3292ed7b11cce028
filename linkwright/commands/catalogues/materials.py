"""`linkwright materials`: what links can be made of, each figure with its source, and a catalogue of one's own."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any, Literal

import typer

import linkwright as lw
from linkwright.commands.catalogues.query import Query
from linkwright.commands.catalogues.user_catalogue import Names, UserCatalogue, value_of_text
from linkwright.commands.options import CatalogueFile, Commands, JsonFile, answer
from linkwright.core.catalogues.freecad_cards import read_card, write_card
from linkwright.core.catalogues.keyed import Entry
from linkwright.core.catalogues.materials import MATERIALS, find_entry, write_table
from linkwright.core.materials.catalogue import USER_CATALOGUE, Catalogue, load_layer, shipped_layers
from linkwright.core.materials.material import Constant, Material, Property, PropertyName, property_kinds
from linkwright.core.materials.plausible import doubts_of
from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import InputError, format_quantity
from linkwright.core.units.temperature import REFERENCE_TEMPERATURE, ZERO_CELSIUS
from linkwright.json.fields import fields
from linkwright.output.files import check_target, write_file
from linkwright.screen.console import console, table, tell

Asked = PropertyName | Literal["magnetic"]
"""What a material can be listed, chosen and compared by."""
SHORT: Mapping[Asked, str] = MappingProxyType(
    {
        "elastic_modulus": "E",
        "poisson_ratio": "nu",
        "shear_modulus": "G",
        "yield_strength": "yield",
        "tensile_strength": "tensile",
        "fatigue_strength": "fatigue",
        "thermal_expansion": "expansion",
        "thermal_conductivity": "conductivity",
        "highest_service_temperature": "usable to",
    }
)
"""Headings shorter than the properties' names."""
DIGITS = 6


def value(material: Material, name: Asked) -> float | None:
    """A material's property at 20 degC in SI, 1 or 0 whether it is magnetic; None where nobody knows."""
    if name == "magnetic":
        return None if material.magnetic is None else float(material.magnetic)
    return material.need(name) if material.has(name) else None


QUERY = Query[Material, Asked](
    names=lambda: (*property_kinds(), "magnetic"),
    short=SHORT,
    usual=("elastic_modulus", "density", "yield_strength", "cost"),
    every=(*property_kinds(), "magnetic"),
    kind=lambda name: "dimensionless" if name == "magnetic" else property_kinds()[name],
    value=value,
    yes_or_no=("magnetic",),
    lacks="there is no property '{}'",
    example="density < 3 g/cm^3",
)


def written(value: float, name: PropertyName, digits: int = DIGITS) -> str:
    """A value of a property with its unit."""
    return format_quantity(value, property_kinds()[name], digits=digits)


def value_of(material: Material, name: Asked) -> str:
    """A material's property at 20 degC, or whether it is magnetic; a dash where nobody knows."""
    if name == "magnetic":
        return "–" if material.magnetic is None else "yes" if material.magnetic else "no"
    return written(material.need(name, REFERENCE_TEMPERATURE), name) if material.has(name) else "–"


def is_unconfirmed(material: Material, name: Asked) -> bool:
    """Whether a material's property could not be found in the source that it names."""
    return bool(material.magnetic_unconfirmed if name == "magnetic" else material.unconfirmed(name))


def marked(material: Material, name: Asked) -> str:
    """`value_of`, with a question mark behind what could not be found in its source."""
    return value_of(material, name) + (" ?" if is_unconfirmed(material, name) else "")


_HELPS = MappingProxyType(
    {
        "add": """Add a material to your catalogue.

Example: linkwright materials add my-alloy elastic_modulus='80 GPa' density='3000 kg/m^3' --source 'Data sheet 12'
""",
        "edit": """Change keys of a material, or the catalogue file in $EDITOR; a shipped material is copied to yours.

Keys are such as density, E, cost.spread or title; several at once are one edit: KEY=VALUE KEY=VALUE.

Example: linkwright materials edit steel-s355 cost '1.30 EUR/kg' --source 'Offer of 3 March'
""",
        "import": """Put materials from a .yaml, .FCMat, .csv or .xlsx file into your catalogue; names wrong rows.

Example: linkwright materials import Steel-S235JR.FCMat --name steel-freecad
""",
        "check": "Check catalogue files: units, ranges, sources, E, G and nu. Without a file the shipped ones and "
        "yours.",
    }
)


def _made(name: str, values: dict[str, str], source: str) -> Entry:
    content = {key: value_of_text(value, key) for key, value in values.items()}
    return Entry(name, {**content, "source": "own"}, {"own": source}) if source else Entry(name, content)


CATALOGUE = UserCatalogue(
    group="materials",
    editor=MATERIALS,
    user_file=USER_CATALOGUE.path,
    entry="material",
    called="catalogue",
    key="material",
    count=lambda path: len(load_layer(path).materials),
    shipped=lambda: [(layer.file, len(layer.materials)) for layer in shipped_layers()],
    example="my-alloy",
    helps=_HELPS,
    such_as="density='3000 kg/m^3'",
    made=_made,
    finder=lambda path: partial(find_entry, lw.materials.with_file(path).catalogue),
    known=lambda path: lw.materials.with_file(path),
    doubts=lambda path: [doubt for material in load_layer(path).materials.values() for doubt in doubts_of(material)],
    keys=MappingProxyType({short: name for name, short in SHORT.items()}),
    read={
        ".yaml": MATERIALS.entries,
        ".FCMat": lambda path: (read_card(path),),
        ".csv": MATERIALS.read_table,
        ".xlsx": MATERIALS.read_table,
    },
)


def export_materials(
    names: Names = None,
    out: Annotated[
        Path, typer.Option("--out", metavar="FILE", help="A .yaml, .FCMat, .csv, .parquet or .md file.")
    ] = Path("materials.yaml"),
    old: Annotated[bool, typer.Option("--freecad-0.21", help="The card format up to FreeCAD 0.21.")] = False,
    catalogue: CatalogueFile = None,
) -> None:
    """Write materials to a file: .yaml with everything, .FCMat (FreeCAD) or .csv with the values at 20 degC.

    Their figures alone to .md or .parquet.

    Example: linkwright materials export steel-s355 aluminium-6061-t6 --out metals.csv
    """
    known = lw.materials.with_file(catalogue).catalogue

    def materials(entries: Sequence[Entry]) -> list[Material]:
        return [known.find(entry.name) for entry in entries]

    def card(entries: Sequence[Entry]) -> str:
        if len(entries) != 1:
            raise InputError(out, "", f"a card holds one material, not {len(entries)}; name one")
        return write_card(materials(entries)[0], "ini" if old else "yaml")

    def table(entries: Sequence[Entry]) -> str:
        return write_table(materials(entries))

    ways = {".yaml": MATERIALS.text, ".FCMat": card, ".csv": table}
    CATALOGUE.write(out, [known.find(name).name for name in names] if names else list(known.names), catalogue, ways)


_BAR = 40
_STEPS = 12
_UNCONFIRMED = "?: could not be found in its source; `materials show NAME` says what was looked for"


def list_materials(
    family: Annotated[list[str] | None, typer.Option("--family", help="Only this family. May be repeated.")] = None,
    where: Annotated[
        list[str] | None,
        typer.Option("--where", metavar="CONDITION", help="Only those that keep it, e.g. 'density < 3 g/cm^3'."),
    ] = None,
    sort: Annotated[
        str | None, typer.Option("--sort", metavar="PROPERTY", help="In this order. --sort=-density: largest first.")
    ] = None,
    columns: Annotated[
        str | None, typer.Option("--columns", metavar="A,B,...", help="Which properties to show, or 'all'.")
    ] = None,
    json: JsonFile = None,
    catalogue: CatalogueFile = None,
) -> None:
    """Every material of the catalogue at 20 degC.

    Example: linkwright materials list --family aluminium --where 'density < 3 g/cm^3' --sort=-yield
    --columns E,yield,cost
    """
    check_target(json, catalogue)
    names = QUERY.columns(columns)
    known = lw.materials.with_file(catalogue).catalogue
    families = sorted({material.family for material in known})
    for each in family or ():
        if each not in families:
            raise InputError("", "--family", f"there is no family '{each}'{nearest(each, families)}")
    materials = QUERY.chosen((item for item in known if not family or item.family in family), where, sort)
    content = {"materials": [_as_json(known, material) for material in materials]}
    if not materials:
        answer(json, "materials", content, "no material of the catalogue is so")
        return
    headings = (SHORT.get(name, name.replace("_", " ")) for name in names)
    shown = table("material", "family", *headings, numbers=tuple(range(2, 2 + len(names))))
    for material in materials:
        shown.add_row(material.name, material.family, *(marked(material, name) for name in names))
    doubtful = any(is_unconfirmed(material, name) for material in materials for name in names)
    answer(json, "materials", content, shown, _UNCONFIRMED if doubtful else "")


def show_material(
    name: Annotated[str, typer.Argument(metavar="NAME", help="The material's name.")],
    plot: Annotated[
        Path | None,
        typer.Option("--plot", metavar="FILE.html", help="Write the properties over temperature as a plot."),
    ] = None,
    json: JsonFile = None,
    catalogue: CatalogueFile = None,
) -> None:
    """One material: each property with its range of temperature, its spread and its source; E over temperature.

    Example: linkwright materials show aluminium-6061-t6 --plot aluminium.html
    """
    check_target(json, catalogue)
    check_target(plot, catalogue)
    known = lw.materials.with_file(catalogue).catalogue
    material = known.find(name)
    if plot is not None:
        write_file(plot, _plot(material))
    shown = table("property", "at 20 degC", "valid", "spread", "source", numbers=(1,))
    for row in _property_rows(material):
        shown.add_row(*row)
    answer(
        json,
        "materials",
        _as_json(known, material),
        shown,
        title=f"{material.name}: {material.title or material.family}",
    )
    modulus = material.properties.get("elastic_modulus")
    if modulus is not None and _varies(modulus):
        tell(*_bars(modulus), title="elastic modulus over temperature")
        console().print()
    for key, text in material.references.items():
        console().print(f"{key}: {text}")
    places = dict.fromkeys(item.found_in for item in material.properties.values() if item.found_in)
    tell(*(f"found in: {text}" for text in places), f"from {', then '.join(known.where(material.name))}")


def _property_rows(material: Material) -> Iterator[tuple[str, ...]]:
    """A row for each property, and one for what is said of it beside."""
    for name in property_kinds():
        prop = material.properties.get(name)
        if prop is None:
            continue
        spread = "" if prop.spread is None else " to ".join(written(x, name) for x in prop.spread)
        yield name.replace("_", " "), value_of(material, name), _valid(prop.valid), spread, prop.source
        note = "; ".join(text for text in (prop.date and f"price of {prop.date}", prop.note) if text)
        yield from _beside(note, prop.unconfirmed)
    if material.magnetic is not None:
        yield "magnetic", "yes" if material.magnetic else "no", "", "", material.magnetic_source
        yield from _beside("", material.magnetic_unconfirmed)


def _beside(note: str, unconfirmed: str) -> Iterator[tuple[str, ...]]:
    if note:
        yield "", "", "", "", note
    if unconfirmed:
        yield "", "", "", "", f"not confirmed: {unconfirmed}"


def compare_materials(
    names: Annotated[list[str], typer.Argument(metavar="NAME", help="The materials' names.")],
    json: JsonFile = None,
    catalogue: CatalogueFile = None,
) -> None:
    """Several materials side by side at 20 degC.

    Example: linkwright materials compare steel-s355 aluminium-6061-t6 cfrp-quasi-isotropic
    """
    check_target(json, catalogue)
    if len(names) < 2:
        raise InputError("", "NAME", "needs two materials or more to compare")
    known = lw.materials.with_file(catalogue).catalogue
    materials = [known.find(name) for name in names]
    content = {"materials": [_as_json(known, material) for material in materials]}
    shown = table("property", *names, numbers=tuple(range(1, len(names) + 1)))
    for name in property_kinds():
        if any(material.has(name) for material in materials):
            shown.add_row(name.replace("_", " "), *(marked(material, name) for material in materials))
    if any(material.magnetic is not None for material in materials):
        shown.add_row("magnetic", *(marked(material, "magnetic") for material in materials))
    if all(material.has("elastic_modulus") and material.has("density") for material in materials):
        ratios = (material.need("elastic_modulus") / material.need("density") / 1e6 for material in materials)
        shown.add_row("E / density", *(f"{ratio:.4g} MN*m/kg" for ratio in ratios))
    doubtful = any(is_unconfirmed(material, name) for material in materials for name in QUERY.every)
    answer(json, "materials", content, shown, _UNCONFIRMED if doubtful else "")


def _varies(item: Property) -> bool:
    return not isinstance(item.law, Constant) and math.isfinite(item.valid[1])


def _over_temperature(item: Property, steps: int) -> list[tuple[float, float]]:
    """Temperatures in degC over the valid range, and the values (SI) there."""
    low, high = item.valid
    kelvins = [low + (high - low) * step / steps for step in range(steps + 1)]
    return [(kelvin - ZERO_CELSIUS, item.law.value(kelvin)) for kelvin in kelvins]


def _bars(item: Property) -> list[str]:
    """The values over temperature as bars from zero, a line a temperature."""
    points = _over_temperature(item, _STEPS)
    largest = max(value for _, value in points)
    return [
        f"{celsius:8.0f} degC {'█' * max(1, round(_BAR * value / largest)):<{_BAR}} "
        f"{written(value, 'elastic_modulus', 4)}"
        for celsius, value in points
    ]


def _plot(material: Material) -> str:
    """Every property that changes with temperature as a curve on a page of its own that needs no network."""
    import plotly.graph_objects as go

    varying: dict[PropertyName, Property] = {name: item for name, item in material.properties.items() if _varies(item)}
    if not varying:
        raise InputError("", "--plot", f"no property of {material.name} is given over temperature")
    figure = go.Figure()
    for name, item in varying.items():
        points = _over_temperature(item, 200)
        at_reference = item.law.value(REFERENCE_TEMPERATURE)
        label = f"{name.replace('_', ' ')} ({written(at_reference, name, 4)} at 20 degC; {item.source})"
        shares = [100 * value / at_reference for _, value in points]
        words = [written(value, name, 4) for _, value in points]
        celsius = [point[0] for point in points]
        figure.add_scatter(x=celsius, y=shares, text=words, name=label, mode="lines", hoverinfo="x+text+name")
    figure.update_layout(
        title=f"{material.name}: {material.title}",
        xaxis_title="temperature in degC",
        yaxis_title="% of the value at 20 degC",
        showlegend=True,
        legend={"orientation": "h", "y": -0.2},
    )
    return str(figure.to_html(include_plotlyjs=True))


def _valid(valid: tuple[float, float]) -> str:
    low, high = valid
    if low <= 0.0 and math.isinf(high):
        return ""
    return f"{low - ZERO_CELSIUS:g} to {high - ZERO_CELSIUS:g} degC"


def _as_json(catalogue: Catalogue, material: Material) -> dict[str, Any]:
    """A material's figures at 20 degC: as written, and in SI."""
    properties: dict[str, Any] = {}
    for name, result in material.properties.items():
        low, high = result.valid
        properties[name] = {
            "value": written(result.law.value(REFERENCE_TEMPERATURE), name),
            "si": result.law.value(REFERENCE_TEMPERATURE),
            "valid_degC": None if math.isinf(high) else [low - ZERO_CELSIUS, high - ZERO_CELSIUS],
            "spread": None if result.spread is None else [written(x, name) for x in result.spread],
            "source": material.references.get(result.source, result.source),
            "note": result.note or None,
            "date": result.date or None,
            "unconfirmed": result.unconfirmed or None,
            "found_in": result.found_in or None,
        }
    return {
        **fields(material, "name", "title", "family", "isotropic", "magnetic"),
        "magnetic_unconfirmed": material.magnetic_unconfirmed or None,
        "properties": properties,
        "files": list(catalogue.where(material.name)),
    }


def group() -> Commands:
    """The commands of the group."""
    look = {"list": list_materials, "show": show_material, "compare": compare_materials}
    return {**look, **CATALOGUE.commands(export_materials)}
