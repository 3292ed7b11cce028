"""Materials, stock sizes and actuators by name."""

from __future__ import annotations

import math
from collections.abc import Iterable, ValuesView
from dataclasses import dataclass
from typing import TYPE_CHECKING

from linkwright.core.arm.actuators import Actuator, load_actuators
from linkwright.core.arm.actuators import Actuators as ActuatorModels
from linkwright.core.materials.catalogue import Catalogue as Models
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.materials.material import Material as Model
from linkwright.core.materials.material import MaterialValues, PropertyName
from linkwright.core.sections import Stock, StockSize, load_stock
from linkwright.core.units.temperature import ZERO_CELSIUS
from linkwright.face.catalogues.catalogue_lists import Catalogue
from linkwright.face.plain_input import Quantity, in_si
from linkwright.json.fields import fields
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
        return self.table_of(self)

    def table_of(self, names: Iterable[str]) -> pd.DataFrame:
        """The rows of `table` of these names alone, in their order. Raises `InputError` for one that there is not."""
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
            for item in map(Material, map(self.catalogue.find, names))
        ]
        named = ["name", "title", "family", "elastic_modulus_GPa", "density_kg_per_m3", "yield_strength_MPa"]
        return frame(rows, [*named, "cost_EUR_per_kg", "highest_service_temperature_degC", "magnetic"])


materials = Materials()


class Actuators(Catalogue[Actuator]):
    """The gears that joints can name: the shipped ones with the user's over them; figures in SI.

    >>> import linkwright as lw
    >>> lw.actuators["RV-20E"].rated_torque
    167.0
    >>> lw.actuators["RV-2E"]
    Traceback (most recent call last):
    ...
    linkwright.InputError: actuator: there is no actuator 'RV-2E'; did you mean 'RV-20E'?
    """

    def __getitem__(self, name: str) -> Actuator:
        """The actuator of a name; raises `InputError` with the nearest known one."""
        return self._all.find(name)

    @property
    def _all(self) -> ActuatorModels:
        return load_actuators(self._files)

    def _names(self) -> list[str]:
        return list(self._all.by_name)

    def values(self) -> ValuesView[Actuator]:
        """All of them, maker by maker."""
        return self._all.by_name.values()

    @property
    def table(self) -> pd.DataFrame:
        """All actuators: maker, gear, torques (N*m), stiffness of drive and bearing (N*m/rad), backlash (rad), mass
        (kg), cost (EUR)."""
        return self.table_of(self)

    def table_of(self, names: Iterable[str]) -> pd.DataFrame:
        """The rows of `table` of these names alone, in their order. Raises `InputError` for one that there is not."""
        torques = ("rated_torque_Nm", "peak_torque_Nm", "stiffness_Nm_per_rad", "tilting_stiffness_Nm_per_rad")
        keys = ("name", "maker", "gear", *torques, "backlash_rad=backlash", "mass_kg", "cost_EUR")
        return frame(
            [fields(item, *keys) for item in map(self._all.find, names)], [key.partition("=")[0] for key in keys]
        )


actuators = Actuators()


class Sections(Catalogue[StockSize]):
    """The stock sizes by name, whatever its case and spaces: the shipped ones with the user's over them.

    Each holds its `section`, `family`, `dimensions` (m), `source` and what its maker or standard `printed`.

    >>> import linkwright as lw
    >>> round(1e6 * lw.sections["ipe80"].section.properties(poisson_ratio=0.3).area, 1)
    764.3
    >>> lw.sections["IPE 81"]
    Traceback (most recent call last):
    ...
    linkwright.InputError: section: there is no stock size 'IPE 81'; did you mean 'IPE 80'?
    """

    @property
    def stock(self) -> Stock:
        """All of them, by families. Raises `InputError`."""
        return load_stock(self._files)

    def __getitem__(self, name: str) -> StockSize:
        """The size of a name; raises `InputError` with the nearest known one."""
        return self.stock.find(name)

    def _names(self) -> list[str]:
        return [size.name for size in self.stock]

    def values(self) -> ValuesView[StockSize]:
        """All of them, in the order of their tables."""
        return {size.name: size for size in self.stock}.values()

    def of_family(self, *families: str) -> tuple[StockSize, ...]:
        """The sizes of some families; raises `InputError` for one that there is not, with those that there are."""
        return tuple(size for family in families for size in self.stock.of_family(family))

    @property
    def table(self) -> pd.DataFrame:
        """All sizes: name, family, shape, area (cm^2), second moments (cm^4), torsion constant (cm^4)."""
        return self.table_of(self)

    def table_of(self, names: Iterable[str]) -> pd.DataFrame:
        """The rows of `table` of these names alone, in their order. Raises `InputError` for one that there is not."""
        powers = {"area": 2, "second_moment_y": 4, "second_moment_z": 4, "torsion_constant": 4}
        rows: list[tuple[object, ...]] = []
        for size in map(self.stock.find, names):
            properties = size.section.properties(0.3)
            figures = [float(getattr(properties, name)) * 100.0**power for name, power in powers.items()]
            rows.append((size.name, size.family, size.shape, *figures))
        headings = [f"{name}_cm{power}" for name, power in powers.items()]
        return frame(rows, ["name", "family", "shape", *headings])


sections = Sections()
