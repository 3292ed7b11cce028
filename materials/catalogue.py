"""The catalogue of materials: files by family, the user's laid over the shipped one, every entry checked.

A catalogue file:

```yaml
format_version: 1
family: steel                          # optional; the file's name without ending otherwise
references:
  en-1993-1-1: "EN 1993-1-1:2005, Eurocode 3: ..."
found_in:                              # optional: in which text the values of a source were found
  en-1993-1-1: "eurocodeapplied.com, ..."
materials:
  steel-s355:
    title: S355 structural steel
    source: en-1993-1-1                # for all properties that name none
    elastic_modulus: 210 GPa           # see catalogue_entry.py for what a property can be
    density: {value: 7850 kg/m^3, source: en-1993-1-2}
prices:                                # of materials of other catalogues (or this one), which stay as they are
  steel-s275: {value: 1.4 EUR/kg, date: 2026-03, source: Offer 12}
```
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from collections.abc import Mapping as MappingLike
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType

from linkwright.core.materials.material import Constant, Material, Property
from linkwright.core.units.files import UserFile
from linkwright.core.units.names import nearest
from linkwright.core.units.prices import Price, read_prices
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import Mapping, load_yaml, shipped_files

from .catalogue_entry import read_entry, read_inline

FORMAT_VERSION = 1
"""The version of the catalogue format that this code reads and writes."""

USER_CATALOGUE = UserFile("LINKWRIGHT_CATALOGUE", "materials.yaml")
"""The user's catalogue."""


@dataclass(frozen=True)
class Layer:
    """One catalogue file: where it stands, the name of its family, its materials by name, and its prices (EUR/kg) of
    materials, most of them of other files."""

    file: str
    family: str
    materials: MappingLike[str, Material]
    prices: MappingLike[str, Price] = field(default_factory=lambda: MappingProxyType({}))


@dataclass(frozen=True)
class Catalogue:
    """Materials by name, from layers of which a later one hides what an earlier one has under the same
    name."""

    layers: tuple[Layer, ...]

    @property
    def materials(self) -> MappingLike[str, Material]:
        """Every visible material by name."""
        visible: dict[str, Material] = {}
        for layer in self.layers:
            visible.update(layer.materials)
            visible.update(
                {name: _priced(visible[name], layer.prices[name]) for name in layer.prices if name in visible}
            )
        return MappingProxyType(visible)

    @property
    def names(self) -> tuple[str, ...]:
        """The names of every visible material, sorted."""
        return tuple(sorted(self.materials))

    def __iter__(self) -> Iterator[Material]:
        """Iterate over the visible materials by name."""
        return (self.materials[name] for name in self.names)

    def __contains__(self, name: object) -> bool:
        """Tell whether a material of that name is visible."""
        return name in self.materials

    def find(self, name: str, *, file: object = "", key: str = "material") -> Material:
        """Return the material called `name`; raises `InputError` for file and key with the nearest known
        name."""
        materials = self.materials
        if name not in materials:
            raise InputError(file, key, f"there is no material '{name}'{nearest(name, self.names)}")
        return materials[name]

    def read(self, value: object, *, file: object, key: str) -> Material:
        """Return the material that a file names, or describes in place; raises `InputError`."""
        if isinstance(value, dict):
            return read_inline(value, file=file, key=key, find=self.materials.get)
        if isinstance(value, str) and value.strip():
            return self.find(value.strip(), file=file, key=key)
        raise InputError(file, key, "needs a material's name, or properties, e.g. {elastic_modulus: 71 GPa}")

    def where(self, name: str) -> tuple[str, ...]:
        """Return the files that have the material, the visible one last."""
        return tuple(layer.file for layer in self.layers if name in layer.materials or name in layer.prices)

    def check_prices(self) -> None:
        """Raise `InputError` where a layer has a price of what no layer has."""
        visible = self.materials
        for layer in self.layers:
            for name in layer.prices:
                if name not in visible:
                    raise InputError(
                        layer.file, f"prices.{name}", f"there is no such material{nearest(name, self.names)}"
                    )


def _priced(material: Material, price: Price) -> Material:
    key = f"price of {material.name}"
    cost = Property(Constant(price.value), source=key, spread=price.spread, note=price.note, date=price.date)
    references = {**material.references, key: price.source}
    return replace(material, properties={**material.properties, "cost": cost}, references=references)


def read_layer(mapping: Mapping, default_family: str) -> Layer:
    """Return the checked layer that a catalogue file's mapping holds; raises `InputError`."""
    mapping.version(FORMAT_VERSION)
    family = mapping.text("family", default_family)
    references = _texts(mapping, "references")
    found_in = _texts(mapping, "found_in")
    for key in set(found_in) - set(references):
        raise mapping.error(f"found_in.{key}", f"is none of the file's references{nearest(key, list(references))}")
    materials: dict[str, Material] = {}

    def find(ply: str) -> Material | None:
        """Of this file so far, or of the shipped ones; those name no plies."""
        if ply in materials:
            return materials[ply]
        return next((layer.materials[ply] for layer in shipped_layers() if ply in layer.materials), None)

    if mapping.has("materials"):
        entries = mapping.mapping("materials")
        for name in entries.content:
            if not name.strip() or name != name.strip() or "\n" in name:
                raise entries.error("", f"{name!r} cannot be a material's name")
            materials[name] = read_entry(entries.mapping(name), name, references, family, find, found_in)
    prices = read_prices(mapping, "cost_per_mass")
    mapping.close("materials")
    return Layer(str(mapping.file), family, MappingProxyType(materials), MappingProxyType(prices))


def _texts(mapping: Mapping, key: str) -> dict[str, str]:
    if not mapping.has(key):
        return {}
    texts = mapping.mapping(key)
    return {name: texts.text(name) for name in texts.content}


def load_layer(path: Path | str) -> Layer:
    """Return the layer of one catalogue file; raises `InputError`."""
    return read_layer(load_yaml(path), Path(path).stem)


@lru_cache(maxsize=1)
def shipped_layers() -> tuple[Layer, ...]:
    """Return the layers that come with the program, one per family, read from its package data and
    checked."""
    return tuple(
        read_layer(file, Path(str(file.file)).stem) for file in shipped_files("linkwright.core.materials", "catalogue")
    )


def load_catalogue(paths: Sequence[Path | str] = (), *, user: bool = True) -> Catalogue:
    """Return the shipped catalogue, over it the user's own (where it exists and `user` is true), over that
    `paths`.

    A file named by the environment variable or in `paths` must exist. Raises `InputError`.
    """
    catalogue = Catalogue((*shipped_layers(), *map(load_layer, USER_CATALOGUE.over(paths, user=user))))
    catalogue.check_prices()
    return catalogue
