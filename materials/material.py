"""What a link is made of: properties with their sources, as functions of temperature within a range that is
enforced.

Reading and checking of files is in `catalogue.py`; here is what the rest of the project computes with.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Mapping as MappingLike
from dataclasses import dataclass, field, fields, replace
from types import MappingProxyType
from typing import Literal, Protocol, get_args

from linkwright.core.units.quantities import InputError
from linkwright.core.units.temperature import REFERENCE_TEMPERATURE, ZERO_CELSIUS

from .walls import Orthotropic, WallCompliance, orthotropic, wall_compliance

PropertyName = Literal[
    "elastic_modulus",
    "poisson_ratio",
    "shear_modulus",
    "transverse_modulus",
    "density",
    "yield_strength",
    "tensile_strength",
    "fatigue_strength",
    "thermal_expansion",
    "transverse_expansion",
    "thermal_conductivity",
    "heat_capacity",
    "damping",
    "cost",
    "machining_cost",
    "highest_service_temperature",
]


def property_kinds() -> dict[PropertyName, str]:
    """Return the properties a material can have, each with its kind of quantity (`units.kinds()`).

    `transverse_modulus` and `transverse_expansion` are those across the link, in the plane of its walls, of a material
    that is not isotropic; its `poisson_ratio` is the contraction across under pull along.
    `fatigue_strength` is the stress amplitude at R = -1 that is endured for the number of cycles its note
    tells; `damping` is the loss factor of the material (2*zeta near resonance); `machining_cost` is what work on it
    costs for each kilogram of the finished part.
    """
    return {
        "elastic_modulus": "elastic_modulus",
        "poisson_ratio": "dimensionless",
        "shear_modulus": "elastic_modulus",
        "transverse_modulus": "elastic_modulus",
        "density": "density",
        "yield_strength": "pressure",
        "tensile_strength": "pressure",
        "fatigue_strength": "pressure",
        "thermal_expansion": "thermal_expansion",
        "transverse_expansion": "thermal_expansion",
        "thermal_conductivity": "conductivity",
        "heat_capacity": "heat_capacity",
        "damping": "dimensionless",
        "cost": "cost_per_mass",
        "machining_cost": "cost_per_mass",
        "highest_service_temperature": "temperature",
    }


class OutOfRange(InputError):
    """A property was asked for at a temperature for which its source gives none.

    `material`, `property_name`, `asked` (K) and `valid` (lowest and highest, K) say which and where.
    """

    def __init__(self, material: str, property_name: str, asked: float, valid: tuple[float, float]) -> None:
        self.material = material
        self.property_name = property_name
        self.asked = asked
        self.valid = valid
        low, high = (f"{kelvin - ZERO_CELSIUS:g} degC" for kelvin in valid)
        message = f"is known from {low} to {high}, not at {asked - ZERO_CELSIUS:g} degC"
        super().__init__(material, property_name, message)

    def __reduce__(self) -> tuple[object, ...]:
        """Keep the fields when the error crosses between processes."""
        return OutOfRange, (self.material, self.property_name, self.asked, self.valid)


class MissingProperty(InputError):
    """A question needs a figure that is not given: `material` and `property_name` say which, or `message` does."""

    __module__ = "linkwright"  # as people import it, and as a traceback shows it

    def __init__(self, material: str, property_name: str, message: str = "") -> None:
        self.material = material
        self.property_name = property_name
        edit = f"linkwright materials edit NAME {property_name}=VALUE --source TEXT"
        lacking = f"is needed here and is not given; add it to the material (to the catalogue's by `{edit}`)"
        super().__init__(material, property_name, message or lacking)

    def __reduce__(self) -> tuple[object, ...]:
        """Keep the fields when the error crosses between processes."""
        return MissingProperty, (self.material, self.property_name, self.message)


class Law(Protocol):
    """How a value depends on temperature (K); the value in SI."""

    def value(self, temperature: float) -> float:
        """Return the value at `temperature` (K)."""
        ...


@dataclass(frozen=True)
class Constant:
    """The same value at every temperature of the range."""

    constant: float

    def value(self, temperature: float) -> float:  # noqa: ARG002 - the same at every temperature
        """Return the value."""
        return self.constant


@dataclass(frozen=True)
class Table:
    """Points with linear interpolation between them; beyond the first and last point their value holds."""

    temperatures: tuple[float, ...]
    values: tuple[float, ...]

    def value(self, temperature: float) -> float:
        """Return the interpolated value at `temperature` (K)."""
        if temperature <= self.temperatures[0]:
            return self.values[0]
        if temperature >= self.temperatures[-1]:
            return self.values[-1]
        upper = bisect_right(self.temperatures, temperature)
        t0, t1 = self.temperatures[upper - 1], self.temperatures[upper]
        share = (temperature - t0) / (t1 - t0)
        return self.values[upper - 1] * (1 - share) + self.values[upper] * share


@dataclass(frozen=True)
class Polynomial:
    """`c0 + c1*(T - origin) + c2*(T - origin)^2 + ...`, T and origin in kelvin, coefficients in SI per
    kelvin^n."""

    coefficients: tuple[float, ...]
    origin: float

    def value(self, temperature: float) -> float:
        """Return the polynomial at `temperature` (K), by Horner's rule."""
        total = 0.0
        for coefficient in reversed(self.coefficients):
            total = total * (temperature - self.origin) + coefficient
        return total


@dataclass(frozen=True)
class Property:
    """One property of a material.

    `law` gives its value (SI) at a temperature; `valid` is the range (K) for which the source gives it;
    `source` is a key of the catalogue's references (empty for a material described in place); `spread` is the
    lowest and highest value to expect at the reference temperature, where known; `note` says what a reader
    should know; `date` is when a price was such (`2026-01`), empty for what is no price;
    `unconfirmed` says what was looked for in vain where nobody could find the value in its source, `found_in` in which
    text that anybody can look up it was found; both are empty where nobody looked.
    """

    law: Law
    valid: tuple[float, float] = (0.0, math.inf)
    source: str = ""
    spread: tuple[float, float] | None = None
    note: str = ""
    date: str = ""
    unconfirmed: str = ""
    found_in: str = ""


@dataclass(frozen=True)
class MaterialValues:
    """The values of a material at one temperature, in SI; None where there is none.

    `cost` is EUR/kg. `shear_modulus` is the entry's own or, for an isotropic material, E/(2(1+nu)). `beyond`
    names the properties that the entry has, but not at this temperature, with their valid ranges (K).
    `walls` tells how thin walls buckle; None where their stiffnesses are not known.
    `stiffness_when_calibrated` and `shear_when_calibrated` are the elastic and the shear modulus at the temperature of
    a calibration over those here.
    """

    material: str
    temperature: float
    elastic_modulus: float | None = None
    poisson_ratio: float | None = None
    shear_modulus: float | None = None
    density: float | None = None
    yield_strength: float | None = None
    thermal_expansion: float | None = None
    cost: float | None = None
    machining_cost: float | None = None
    transverse_modulus: float | None = None
    transverse_expansion: float | None = None
    walls: WallCompliance | None = None
    highest_service_temperature: float | None = None
    tensile_strength: float | None = None
    fatigue_strength: float | None = None
    thermal_conductivity: float | None = None
    heat_capacity: float | None = None
    damping: float | None = None
    beyond: tuple[tuple[PropertyName, tuple[float, float]], ...] = ()
    stiffness_when_calibrated: float = 1.0
    shear_when_calibrated: float = 1.0

    def need(self, name: PropertyName) -> float:
        """Return the value; raises `MissingProperty` where there is none, `OutOfRange` where not at this
        T."""
        value: float | None = getattr(self, name)
        if value is None:
            for beyond, valid in self.beyond:
                if beyond == name:
                    raise OutOfRange(self.material, name, self.temperature, valid)
            raise MissingProperty(self.material, name)
        return value

    @property
    def wall_modulus(self) -> float | None:
        """The modulus (Pa) of an isotropic material whose flat walls would buckle under the same compression."""
        return None if self.walls is None else self.walls.modulus


@dataclass(frozen=True)
class Material:
    """A material: its name, its properties by name, and where they come from.

    `in_place` holds the keys by which a file described it where it stands, and it is written so; None for one that a
    catalogue names. `magnetic` tells whether it is ferromagnetic (None: not known). `isotropic` materials have
    consistent E, G and nu; for others the elastic modulus is the one along the link. `family` is the catalogue file's
    name.
    `references` holds the text of each source that a property names. `magnetic_unconfirmed` and `magnetic_found_in` say
    of `magnetic` what those of a `Property` say of its value. `bending` is 12 D/t^3 of a wall of plies, None where a
    wall is the same all through.
    """

    name: str
    properties: MappingLike[PropertyName, Property]
    title: str = ""
    family: str = ""
    isotropic: bool = True
    magnetic: bool | None = None
    magnetic_source: str = ""
    references: MappingLike[str, str] = field(default_factory=lambda: MappingProxyType(dict[str, str]()))
    magnetic_unconfirmed: str = ""
    magnetic_found_in: str = ""
    bending: Orthotropic | None = None
    in_place: MappingLike[str, object] | None = field(default=None, compare=False)

    def __post_init__(self) -> None:
        """Freeze the mappings too."""
        object.__setattr__(self, "properties", MappingProxyType(dict(self.properties)))
        object.__setattr__(self, "references", MappingProxyType(dict(self.references)))

    def __hash__(self) -> int:
        """Hash by name; equality compares everything."""
        return hash(self.name)

    def __reduce__(self) -> tuple[object, ...]:
        """Copy and pickle by plain dictionaries, so that a material can cross between processes."""
        values = (getattr(self, item.name) for item in fields(self))
        return Material, tuple(dict(value) if isinstance(value, MappingProxyType) else value for value in values)

    def has(self, name: PropertyName) -> bool:
        """Tell whether the property is given or, for the shear modulus, follows from E and nu."""
        if name == "shear_modulus" and self.isotropic and name not in self.properties:
            return self.has("elastic_modulus") and self.has("poisson_ratio")
        return name in self.properties

    def unconfirmed(self, name: PropertyName) -> str:
        """What was looked for in vain where nobody could find a property in its source; a shear modulus that follows is
        as sure as what it follows from."""
        if name == "shear_modulus" and name not in self.properties:
            marks = (self.unconfirmed(item) for item in ("elastic_modulus", "poisson_ratio"))
            return next((mark for mark in marks if mark), "")
        return self.properties[name].unconfirmed if name in self.properties else ""

    def need(self, name: PropertyName, temperature: float = REFERENCE_TEMPERATURE) -> float:
        """Return one property at `temperature` (K), in SI.

        Raises `MissingProperty` where the entry lacks it and `OutOfRange` beyond its valid range.
        """
        entry = self.properties.get(name)
        if entry is None:
            if name == "shear_modulus" and self.has(name):
                poisson_ratio = self.need("poisson_ratio", temperature)
                return self.need("elastic_modulus", temperature) / (2 * (1 + poisson_ratio))
            raise MissingProperty(self.name, name)
        low, high = entry.valid
        # A hair's breadth for conversions between scales; it is far below what a property can depend on.
        if not low - 1e-9 <= temperature <= high + 1e-9:
            raise OutOfRange(self.name, name, temperature, entry.valid)
        return entry.law.value(temperature)

    def spread(self, name: PropertyName) -> tuple[float, float]:
        """Return the lowest and highest value to expect at 20 degC; both the value itself where no spread is
        given."""
        if name in self.properties and (spread := self.properties[name].spread) is not None:
            return spread
        value = self.need(name)
        return value, value

    def at(self, temperature: float = REFERENCE_TEMPERATURE, calibrated_at: float | None = None) -> MaterialValues:
        """Return every property at `temperature` (K), None for those the entry lacks; `calibrated_at` (K) is where the
        arm was calibrated (None: at `temperature`).

        Raises `OutOfRange` where the elastic modulus or the density is not known at this temperature, or the modulus
        where it was calibrated; for any other property that happens when the values are asked for it by `need`.
        """
        values: dict[str, float] = {}
        beyond: list[tuple[PropertyName, tuple[float, float]]] = []
        for name in get_args(PropertyName):
            if not self.has(name):
                continue
            try:
                values[name] = self.need(name, temperature)
            except OutOfRange as error:
                if name in ("elastic_modulus", "density"):
                    raise
                beyond.append((name, error.valid))
        result = MaterialValues(self.name, temperature, beyond=tuple(beyond), walls=None, **values)
        result = replace(result, walls=self._walls(result))
        if calibrated_at is None or calibrated_at == temperature or result.elastic_modulus is None:
            return result
        softer = self.need("elastic_modulus", calibrated_at) / result.elastic_modulus
        shear = softer
        if result.shear_modulus is not None:
            shear = self.need("shear_modulus", calibrated_at) / result.shear_modulus
        return replace(result, stiffness_when_calibrated=softer, shear_when_calibrated=shear)

    def _walls(self, values: MaterialValues) -> WallCompliance | None:
        """How thin walls buckle, by the values at one temperature."""
        along, poisson_ratio = values.elastic_modulus, values.poisson_ratio
        if along is None:
            return None
        if self.isotropic:
            # As for sections: what has no Poisson's ratio takes that of most metals.
            poisson_ratio = 0.3 if poisson_ratio is None else poisson_ratio
            return wall_compliance(orthotropic(along, along, 0.5 * along / (1.0 + poisson_ratio), poisson_ratio))
        around, shear = values.transverse_modulus, values.shear_modulus
        if around is None or shear is None or poisson_ratio is None:
            return None
        return wall_compliance(orthotropic(along, around, shear, poisson_ratio), self.bending)

    def at_bound(self, which: Literal["low", "high"], **bounds: bool) -> Material:
        """Return the material with the properties named true at one end of their spread, constant over their
        range.

        `material.at_bound("low", elastic_modulus=True)` is the softest one, as for a table row "196 to 216
        GPa".
        """
        changed = dict(self.properties)
        for name in get_args(PropertyName):
            if bounds.get(name) and name in changed:
                value = self.spread(name)[which == "high"]
                changed[name] = replace(changed[name], law=Constant(value))
        return replace(self, properties=changed)
