"""The catalogue of materials: its schema, its editor and its tables."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, cast

from linkwright.core.catalogues.csv_table import marks_text, table_text
from linkwright.core.catalogues.keyed import Column, Entry, KeyedEditor, Schema
from linkwright.core.materials.catalogue import Catalogue, read_layer, shipped_layers
from linkwright.core.materials.material import Material, property_kinds
from linkwright.core.units.quantities import InputError, format_quantity, read_quantity
from linkwright.core.units.reading import Mapping as Keys
from linkwright.core.units.reading import load_yaml, shipped_files


def _figures() -> tuple[str, ...]:
    return (*property_kinds(), "magnetic")


def _inherited(data: Mapping[str, Any], stem: str, content: Mapping[str, Any]) -> Mapping[str, Any]:
    """With its family, and where each property was found: what the file says of its sources said of the properties."""
    in_source = data.get("found_in")
    by_source = cast(dict[str, str], in_source) if isinstance(in_source, dict) else {}
    missing, found_in = content.get("unconfirmed") or {}, dict[str, str](content.get("found_in") or {})
    for key in _figures():
        if key in content and key not in missing and key not in found_in:
            value = content[key]
            source = cast(dict[str, Any], value).get("source") if isinstance(value, dict) else None
            text = by_source.get(source or content.get("source", ""))
            found_in |= {key: text} if text else {}
    return {"family": data.get("family") or stem, **content, **({"found_in": found_in} if found_in else {})}


def _columns() -> list[Column]:
    figures = [Column(name, partial(_cell, kind)) for name, kind in property_kinds().items()]
    marks = [Column("source"), *figures, Column("unconfirmed")]
    return [Column("name", needed=True), Column("title"), Column("family"), Column("isotropic", _yes_or_no), *marks]


def _yes_or_no(text: str, path: Path | str, where: str) -> bool:
    if text not in ("yes", "no"):
        raise InputError(path, where, "needs yes or no")
    return text == "yes"


def _cell(kind: str, text: str, path: Path | str, where: str) -> str | float:
    value = read_quantity(text, kind, file=path, key=where)
    return value if kind == "dimensionless" else text


def _read(keys: Keys) -> object:
    return read_layer(keys, Path(str(keys.file)).stem)


MATERIALS = KeyedEditor(
    Schema(
        what="material",
        under="materials",
        read=_read,
        shipped=lambda: shipped_files("linkwright.core.materials", "catalogue"),
        figures=_figures,
        has_sources=True,
        inherited=_inherited,
        columns=_columns,
    )
)


def find_entry(catalogue: Catalogue, name: str) -> Entry:
    """The entry of the visible material of that name as its file writes it, with the price that another gives it.
    Raises `InputError`."""
    catalogue.find(name)
    layers = [layer for layer in catalogue.layers if layer not in shipped_layers()]
    entry = MATERIALS.entry(name, [layer.file for layer in layers])
    assert entry is not None  # it is visible
    last = max((number for number, layer in enumerate(layers) if name in layer.materials), default=0)
    for layer in layers[last:]:
        if name in layer.prices:
            price = dict(cast(dict[str, Any], load_yaml(layer.file).content["prices"])[name])
            cost = {**price, "source": "price"}
            references = {**entry.references, "price": str(price["source"])}
            entry = replace(entry, content={**entry.content, "cost": cost}, references=references)
    return entry


def write_table(materials: Iterable[Material]) -> str:
    """The table of the materials, their values at 20 degC; tables over temperature, spreads and notes have no place in
    it."""
    return table_text(MATERIALS.schema.heading, (_row(material) for material in materials))


def _row(material: Material) -> dict[str, str]:
    kinds = property_kinds()
    return {
        "name": material.name,
        "title": material.title,
        "family": material.family,
        "isotropic": "yes" if material.isotropic else "no",
        **{name: format_quantity(material.need(name), kinds[name]) for name in kinds if name in material.properties},
        "source": "; ".join(" ".join(text.split()) for text in material.references.values()),
        "unconfirmed": marks_text({k: item.unconfirmed for k, item in material.properties.items() if item.unconfirmed}),
    }
