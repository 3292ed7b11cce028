"""The paper's figures as printed, read from `printed.yaml`, and what a table is once the truth stands beside it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from decimal import ROUND_HALF_UP, Decimal
from functools import cache
from importlib.resources import files
from types import MappingProxyType
from typing import Any

from linkwright.core.units.quantities import read_quantity
from linkwright.core.units.reading import parse_bundled_yaml


@dataclass(frozen=True)
class Row:
    """One row of a table.

    `printed` are the paper's figures as their text; `reproduced` (mm^2) the same by its conventions, to be compared at
    the printed figure's last digit; `as_read` and `corrected` are distances in m. `counted` says how many figures the
    paper prints here (a range printed as one figure counts once). `note` is the reason for every figure that differs.
    """

    label: str
    printed: tuple[str, ...]
    reproduced: tuple[float, ...]
    as_read: tuple[float, ...]
    corrected: tuple[float, ...]
    note: str
    counted: int

    @property
    def reproduced_printed(self) -> tuple[str, ...]:
        """The reproduced figures with as many decimals as the printed ones."""
        return tuple(at_digits_of(text, value) for text, value in zip(self.printed, self.reproduced, strict=True))

    @property
    def agrees(self) -> tuple[bool, ...]:
        """Which printed figures are met to their last digit."""
        return tuple(one == other for one, other in zip(self.printed, self.reproduced_printed, strict=True))

    @property
    def computed(self) -> Mapping[str, list[float]]:
        """What stands beside the printed figures, by names that carry the unit."""
        return {
            "reproduced_mm2": list(self.reproduced),
            "as_equations_read_mm": [1e3 * value for value in self.as_read],
            "corrected_mm": [1e3 * value for value in self.corrected],
        }


@dataclass(frozen=True)
class Table:
    """A table of the paper: `key` as in JSON, `number` as in the paper, `columns` what each row's figures stand for.

    `remarks` hold for the whole table.
    """

    key: str
    number: str
    title: str
    columns: tuple[str, ...]
    rows: tuple[Row, ...]
    remarks: tuple[str, ...]


@dataclass(frozen=True)
class Tally:
    """How many printed figures are met to their last digit, of how many."""

    met: int
    printed: int


def at_digits_of(printed: str, value: float) -> str:
    """A value with as many decimals as a printed figure, halves rounded up as in print."""
    exact = Decimal(repr(float(f"{value:.12g}")))
    exponent = Decimal(printed).as_tuple().exponent
    rounded = exact.quantize(Decimal(1).scaleb(int(exponent)), rounding=ROUND_HALF_UP)
    return "0" if rounded == 0 and Decimal(printed) == 0 else f"{rounded:f}"


def tally(tables: tuple[Table, ...]) -> Tally:
    """The count over whole tables."""
    rows = [row for table in tables for row in table.rows]
    return Tally(sum(sum(row.agrees[: row.counted]) for row in rows), sum(row.counted for row in rows))


FILE = "printed.yaml"
_KINDS = MappingProxyType(
    {
        "lengths": "length",
        "diameter": "length",
        "elastic_modulus": "elastic_modulus",
        "density": "density",
        "clearance": "length",
        "backlash": "angle",
        "weight": "length",
        "tool": "length",
        "dimensions": "length",
    }
)
"""What is a quantity in the file, by its key; everything else is words and whole numbers."""


@dataclass(frozen=True)
class Parameters:
    """Table II: lengths and diameter in m, elastic modulus in Pa, density in kg/m^3."""

    lengths: tuple[float, float, float]
    elastic_modulus: float
    density: float
    diameter: float


@dataclass(frozen=True)
class PrintedRow:
    """A row of Tables III to VII: the figures as printed, and what they are of.

    Attributes:
        printed: PE without and with deformation, at both ends of a range, or alone.
        joints: of Tables III and IV the joints (from 1) that have play.
        signs: of Table V the side at which each joint's backlash lies (1 or -1).
        name: of Tables VI and VII.
        elastic_modulus, density: of Table VI at both ends of the range, Pa and kg/m^3.
        poisson_ratio: of Table VI; supplied, not printed.
        shape, dimensions: of Table VII as arm files have them, m.
        formula: of Table VII, printed for I.
    """

    printed: tuple[str, ...]
    joints: tuple[int, ...] = ()
    signs: tuple[int, ...] = ()
    name: str = ""
    elastic_modulus: tuple[float, ...] = ()
    density: tuple[float, ...] = ()
    poisson_ratio: float = math.nan
    shape: str = ""
    dimensions: Mapping[str, float] = field(default_factory=dict[str, float])
    formula: str = ""

    @property
    def one_figure(self) -> bool:
        """Whether the paper prints one figure, and no range."""
        return len({*self.elastic_modulus}) == len({*self.density}) == 1


@dataclass(frozen=True)
class Paper:
    """All of the paper that the tables and figures need, with what was inferred, fitted or supplied besides.

    `clearance_size` (m) and `backlash_size` (rad) are inferred; `weight_sag` and `tool_sag` (m) are fitted.
    """

    parameters: Parameters
    clearance: tuple[PrintedRow, ...]
    backlash: tuple[PrintedRow, ...]
    direction: tuple[PrintedRow, ...]
    material: tuple[PrintedRow, ...]
    shape: tuple[PrintedRow, ...]
    clearance_size: float
    backlash_size: float
    weight_sag: float
    tool_sag: float


def read_paper() -> Paper:
    """The paper as typed in the package."""
    content = _of_package(FILE)
    inferred, fitted = _in_si(content["inferred"]), _in_si(content["fitted"])
    ratios = content["supplied"]["poisson_ratio"]
    return Paper(
        parameters=Parameters(**_in_si(content["parameters"])),
        clearance=_rows(content["clearance"]),
        backlash=_rows(content["backlash"]),
        direction=_rows(content["backlash_direction"]),
        material=_rows({**row, "poisson_ratio": ratios[row["name"]]} for row in content["material"]),
        shape=_rows(content["shape"]),
        clearance_size=inferred["clearance"],
        backlash_size=inferred["backlash"],
        weight_sag=fitted["weight"],
        tool_sag=fitted["tool"],
    )


@cache
def words() -> Mapping[str, Any]:
    """What is said of the tables and figures (`words.yaml`)."""
    return _of_package("words.yaml")


def _of_package(name: str) -> Mapping[str, Any]:
    content: Any = parse_bundled_yaml(files("linkwright.paper").joinpath(name).read_text(encoding="utf-8"))
    return content


def _rows(rows: Any) -> tuple[PrintedRow, ...]:
    return tuple(PrintedRow(**_in_si(row)) for row in rows)


def _in_si(entries: Mapping[str, Any]) -> dict[str, Any]:
    """Entries with quantities in SI and lists as tuples."""
    return {key: _value(entry, _KINDS.get(key)) for key, entry in entries.items()}


def _value(entry: Any, kind: str | None) -> Any:
    if isinstance(entry, Mapping):
        return MappingProxyType({key: _value(item, kind) for key, item in entry.items()})
    if isinstance(entry, Sequence) and not isinstance(entry, str):
        return tuple(_value(item, kind) for item in entry)
    return entry if kind is None else read_quantity(entry, kind, file=FILE, key=kind)
