"""Materials by name."""

from __future__ import annotations

import math
from collections.abc import ValuesView
from dataclasses import dataclass
from typing import TYPE_CHECKING

from linkwright.core.materials.catalogue import Catalogue as Models
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.materials.material import Material as Model
from linkwright.core.materials.material import MaterialValues, PropertyName
from linkwright.core.units.temperature import ZERO_CELSIUS
from linkwright.face.catalogues.catalogue_lists import Catalogue
from linkwright.face.plain_input import Quantity, in_si
from linkwright.output.table_file import frame

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, repr=False)
class Material:
    """A material of the catalogue: `model` holds its properties with their sources and ranges."""

    model: Model

    @property
    def name(self) -> str:
        """Its name in the catalogue."""
        return self.model.name

    def at(self, temperature: Quantity = "20 degC") -> MaterialValues:
        """Its properties at a temperature (text, or K), in SI; None for those that it lacks, which `need` asks for.

        Raises `InputError` where the elastic modulus or the density is not known at that temperature.
        """
        return self.model.at(in_si(temperature, "temperature", "temperature"))

    def in_file(self) -> str:
        """Its name, as an arm file has it."""
        return self.model.name

    def __repr__(self) -> str:
        """One line."""
        title = f", {self.model.title}" if self.model.title else ""
        return f"<Material: {self.model.name}{title}>"


class Materials(Catalogue[Material]):
    """The catalogue of materials by name, the shipped one with the user's over it.

    >>> import linkwright as lw
    >>> lw.materials["steel-s355"].at("80 degC").elastic_modulus
    210000000000.0
    >>> lw.materials["steel-s335"]
    Traceback (most recent call last):
    ...
    linkwright.InputError: material: there is no material 'steel-s335'; did you mean 'steel-s355'?
    """

    def __getitem__(self, name: str) -> Material:
        """The material of a name; raises `InputError` with the nearest known one."""
        return Material(self.catalogue.find(name))

    @property
    def catalogue(self) -> Models:
        """All of them, with the files that they are from. Raises `InputError`."""
        return load_catalogue(self._files)

    def _names(self) -> list[str]:
        return list(self.catalogue.names)

    def values(self) -> ValuesView[Material]:
        """All of them, sorted by name."""
        return {material.name: Material(material) for material in self.catalogue}.values()

    @property
    def table(self) -> pd.DataFrame:
        """All materials at 20 degC: name, title, family, E (GPa), density (kg/m^3), yield strength (MPa), cost
        (EUR/kg), highest service temperature (degC); NaN where one has no such figure; whether it is magnetic, None
        where nobody knows."""
        figures: tuple[tuple[PropertyName, float], ...] = (
            ("elastic_modulus", 1e9),
            ("density", 1.0),
            ("yield_strength", 1e6),
            ("cost", 1.0),
        )
        rows = [
            (
                item.name,
                item.model.title,
                item.model.family,
                *(item.model.need(name) / unit if item.model.has(name) else math.nan for name, unit in figures),
                item.model.need("highest_service_temperature") - ZERO_CELSIUS
                if item.model.has("highest_service_temperature")
                else math.nan,
                item.model.magnetic,
            )
            for item in self.values()
        ]
        named = ["name", "title", "family", "elastic_modulus_GPa", "density_kg_per_m3", "yield_strength_MPa"]
        return frame(rows, [*named, "cost_EUR_per_kg", "highest_service_temperature_degC", "magnetic"])


materials = Materials()
