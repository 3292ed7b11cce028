"""The units that may stand at the door, and the kinds of quantity they measure.

The pint registry here is built from the short list below instead of pint's file, for two reasons: an
angle is a separate dimension (so `12 kN*m` is not taken for a torsional stiffness, nor `3 rad/s` for a
frequency), and nothing exotic can be read by accident (pint's `e` is the elementary charge). Factors are
decimal, so `25 um` reads as exactly the float `2.5e-05`. Conversion factors: BIPM SI Brochure (9th ed.) Table
8 and NIST SP 811 Appendix B.
"""

from __future__ import annotations

from dataclasses import dataclass
from decimal import Decimal
from functools import cache
from threading import Lock
from typing import TYPE_CHECKING, Any, cast

if TYPE_CHECKING:
    import pint

_PI = "3.14159265358979323846264338327950288"

_DEFINITIONS = f"""
pico- = 1e-12 = p-
nano- = 1e-9 = n-
micro- = 1e-6 = u- = µ- = μ-
milli- = 1e-3 = m-
centi- = 1e-2 = c-
deci- = 1e-1 = d-
hecto- = 1e2 = h-
kilo- = 1e3 = k-
mega- = 1e6 = M-
giga- = 1e9 = G-
tera- = 1e12 = T-
meter = [length] = m = metre
second = [time] = s = sec
kilogram = [mass] = kg
gram = 1e-3 * kilogram = g
kelvin = [temperature]; offset: 0 = K
radian = [angle] = rad
ampere = [current] = A
euro = [currency] = EUR
one = [] = _
percent = 0.01 = %
ppm = 1e-6
degree = {_PI} / 180 * radian = deg
arcminute = degree / 60 = arcmin
arcsecond = degree / 3600 = arcsec
turn = 360 * degree = rev = revolution
degree_Celsius = kelvin; offset: 273.15 = degC = celsius
degree_Fahrenheit = 5 / 9 * kelvin; offset: 255.372222222222222222222222 = degF = fahrenheit
inch = 0.0254 * meter = in
foot = 0.3048 * meter = ft = _ = feet
thou = 25.4e-6 * meter = mil
minute = 60 * second = min
hour = 3600 * second = h
day = 24 * hour = d
hertz = 1 / second = Hz
rpm = turn / minute
newton = kilogram * meter / second ** 2 = N
newton_meter = newton * meter = Nm
pascal = newton / meter ** 2 = Pa
bar = 1e5 * pascal
joule = newton * meter = J
watt = joule / second = W
volt = watt / ampere = V
tonne = 1000 * kilogram = t
pound = 0.45359237 * kilogram = lb
ounce = pound / 16 = oz
standard_gravity = 9.80665 * meter / second ** 2 = gn
pound_force = pound * standard_gravity = lbf
kilogram_force = kilogram * standard_gravity = kgf
psi = pound_force / inch ** 2
ksi = 1000 * psi
liter = 1e-3 * meter ** 3 = L = l = litre
"""


_ONE_AT_A_TIME = Lock()


def registry() -> pint.UnitRegistry[Any]:
    """Return the project's pint registry: decimal factors, angle as a dimension, EUR as the only currency.

    There is one only, whichever thread asks first: units of two do not go together.
    """
    with _ONE_AT_A_TIME:
        return _registry()


@cache
def _registry() -> pint.UnitRegistry[Any]:
    import pint  # here, for importing it takes longer than a command that reads no quantity

    # pint's annotations know neither an empty registry nor decimal factors; both are documented features.
    units = pint.UnitRegistry[Any](cast(str, None), non_int_type=cast(type[float], Decimal))
    units.load_definitions(_DEFINITIONS.strip().splitlines())
    return units


@dataclass(frozen=True)
class Kind:
    """A kind of quantity.

    `si` is the unit of the float used inside; `choices` lists units for writing, each with the smallest
    magnitude (in SI) from which it reads well, in ascending order; `zero` is the unit that a plain zero gets.
    Nothing of an arm measures more than `most` (SI), so that what is made of quantities stays finite.
    """

    name: str
    si: str
    choices: tuple[tuple[float, str], ...]
    zero: str
    example: str
    most: float = 1e24

    @property
    def units(self) -> tuple[str, ...]:
        """Units to propose to somebody who wrote none."""
        return tuple(unit for _, unit in self.choices)


def _kind(name: str, si: str, example: str, *choices: tuple[float, str]) -> Kind:
    zero = example.split(" ", 1)[1] if " " in example else ""
    most = 1e12 if si in ("m", "rad", "kg", "m/s^2", "K") else 1e24
    return Kind(name, si, choices or ((0.0, si),), zero, example, most)


@cache
def kinds() -> dict[str, Kind]:
    """Return every kind of quantity by name."""
    pressure = ((0.0, "Pa"), (1e3, "kPa"), (1e5, "MPa"), (1e9, "GPa"))
    moment = ((0.0, "N*m"), (1e4, "kN*m"))
    torsional = ((0.0, "N*m/rad"), (1e3, "kN*m/rad"), (1e7, "MN*m/rad"))
    rows = (
        _kind("dimensionless", "", "0.3"),
        _kind("length", "m", "400 mm", (0.0, "nm"), (1e-7, "um"), (1e-5, "mm"), (10.0, "m")),
        _kind("area", "m^2", "7854 mm^2", (0.0, "mm^2"), (0.1, "m^2")),
        _kind("volume", "m^3", "25000 mm^3", (0.0, "mm^3"), (1e-3, "m^3")),
        _kind("section_modulus", "m^3", "77.3 cm^3", (0.0, "mm^3"), (1e-7, "cm^3"), (1e-2, "m^3")),
        _kind("second_moment_of_area", "m^4", "318 cm^4", (0.0, "mm^4"), (1e-10, "cm^4"), (1e-2, "m^4")),
        _kind("angle", "rad", "0.5 deg", (0.0, "urad"), (1e-5, "mrad"), (1e-3, "deg")),
        _kind("mass", "kg", "0.7 kg", (0.0, "g"), (0.1, "kg"), (1e5, "t")),
        _kind("first_moment", "kg*m", "0.3 kg*m"),
        _kind("density", "kg/m^3", "2700 kg/m^3", (0.0, "kg/m^3")),
        _kind("elastic_modulus", "Pa", "71 GPa", *pressure),
        _kind("pressure", "Pa", "250 MPa", *pressure),
        _kind("force", "N", "43 N", (0.0, "N"), (1e4, "kN")),
        _kind("moment", "N*m", "12 N*m", *moment),
        _kind("torque", "N*m", "12 N*m", *moment),
        _kind("acceleration", "m/s^2", "9.81 m/s^2"),
        _kind("temperature", "K", "20 degC", (0.0, "degC")),
        _kind("temperature_difference", "K", "30 K"),
        _kind("torsional_stiffness", "N*m/rad", "60 kN*m/rad", *torsional),
        _kind("compliance", "rad/(N*m)", "2e-5 rad/(N*m)", (0.0, "urad/(N*m)"), (1e-3, "rad/(N*m)")),
        _kind("linear_stiffness", "N/m", "50 N/um", (0.0, "N/m"), (1e3, "N/mm"), (1e7, "N/um")),
        _kind("linear_compliance", "m/N", "20 um/N", (0.0, "um/N"), (1e-3, "mm/N")),
        _kind("flexibility", "1/(N*m^2)", "2e-6 1/(N*m^2)"),
        _kind("bending_stiffness", "N*m^2", "12000 N*m^2"),
        _kind("thermal_expansion", "1/K", "23 um/(m*K)", (0.0, "um/(m*K)")),
        _kind("curvature_per_temperature", "1/(m*K)", "2e-5 1/(m*K)"),
        _kind("cost", "EUR", "200 EUR"),
        _kind("cost_per_mass", "EUR/kg", "30 EUR/kg"),
        _kind("cost_per_length", "EUR/m", "40 EUR/m"),
        _kind("frequency", "Hz", "20 Hz", (0.0, "Hz"), (1e4, "kHz")),
        _kind("conductivity", "W/(m*K)", "167 W/(m*K)"),
        _kind("heat_capacity", "J/(kg*K)", "896 J/(kg*K)"),
        _kind("speed", "m/s", "250 mm/s", (0.0, "um/s"), (1e-4, "mm/s"), (1.0, "m/s")),
        _kind("angular_speed", "rad/s", "90 deg/s", (0.0, "urad/s"), (1e-4, "deg/s")),
        _kind("angular_acceleration", "rad/s^2", "90 deg/s^2", (0.0, "deg/s^2")),
        _kind("mass_per_length", "kg/m", "10.4 kg/m"),
        _kind("force_per_length", "N/m", "12 N/m", (0.0, "N/m"), (1e5, "kN/m")),
        _kind("inertia", "kg*m^2", "0.02 kg*m^2"),
        _kind("time", "s", "30 s", (0.0, "ms"), (1.0, "s"), (600.0, "min"), (7200.0, "h")),
        _kind("rate", "1/s", "0.01 1/s"),
        _kind("viscous_friction", "N*m*s/rad", "3 N*m*s/rad"),
        _kind("linear_viscous_friction", "N*s/m", "200 N*s/m"),
        _kind("quadratic_friction", "N*m*s^2/rad^2", "2 N*m*s^2/rad^2"),
        _kind("linear_quadratic_friction", "N*s^2/m^2", "50 N*s^2/m^2"),
        _kind("torque_per_temperature", "N*m/K", "-0.1 N*m/K"),
        _kind("force_per_temperature", "N/K", "-2 N/K"),
        _kind("angle_per_temperature", "rad/K", "8 urad/K", (0.0, "urad/K"), (1e-3, "mrad/K")),
        _kind("angle_per_length", "rad/m", "0.1 mrad/m", (0.0, "mrad/m"), (1.0, "rad/m")),
        _kind("length_per_temperature", "m/K", "5 um/K", (0.0, "um/K"), (1e-3, "mm/K")),
        _kind("power", "W", "250 W", (0.0, "W"), (1e4, "kW")),
        _kind("current", "A", "2 A"),
        _kind("torque_constant", "N*m/A", "11.2 N*m/A"),
        _kind("voltage", "V", "12 V"),
        _kind("torque_per_voltage", "N*m/V", "0.4 N*m/V"),
        _kind("per_angle", "1/rad", "5 1/rad"),
        _kind("energy", "J", "12 J", (0.0, "J"), (1e4, "kJ")),
    )
    return {row.name: row for row in rows}
