"""The paper's figures as printed, read from `printed.yaml`, and what a table is once the truth stands beside it."""

from __future__ import annotations

from collections.abc import Mapping as MappingLike
from dataclasses import dataclass
from decimal import ROUND_HALF_UP, Decimal
from importlib.resources import files
from types import MappingProxyType
from typing import cast

from linkwright.core.units.quantities import InputError, read_quantity
from linkwright.core.units.reading import Mapping, parse_yaml


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


@dataclass(frozen=True)
class Parameters:
    """Table II: lengths and diameter in m, elastic modulus in Pa, density in kg/m^3."""

    lengths: tuple[float, float, float]
    elastic_modulus: float
    density: float
    diameter: float


@dataclass(frozen=True)
class PlayRow:
    """A row of Table III or IV: the joints (from 1) that have play, and PE without and with deformation."""

    joints: tuple[int, ...]
    printed: tuple[str, ...]


@dataclass(frozen=True)
class DirectionRow:
    """A row of Table V: the side at which each joint's backlash lies (1 or -1)."""

    signs: tuple[int, ...]
    printed: tuple[str, ...]


@dataclass(frozen=True)
class MaterialRow:
    """A row of Table VI at both ends of its range: moduli in Pa, densities in kg/m^3; `poisson_ratio` is supplied."""

    name: str
    elastic_modulus: tuple[float, float]
    density: tuple[float, float]
    printed: tuple[str, ...]
    poisson_ratio: float

    @property
    def one_figure(self) -> bool:
        """Whether the paper prints one figure, and no range."""
        return self.elastic_modulus[0] == self.elastic_modulus[1] and self.density[0] == self.density[1]


@dataclass(frozen=True)
class ShapeRow:
    """A row of Table VII: the shape and dimensions (m) as arm files have them, and the formula printed for I."""

    name: str
    shape: str
    dimensions: MappingLike[str, float]
    formula: str
    printed: tuple[str, ...]


@dataclass(frozen=True)
class Paper:
    """All of the paper that the tables and figures need, with what was inferred, fitted or supplied besides.

    `clearance_size` (m) and `backlash_size` (rad) are inferred; `weight_sag` and `tool_sag` (m) are fitted.
    """

    parameters: Parameters
    clearance: tuple[PlayRow, ...]
    backlash: tuple[PlayRow, ...]
    direction: tuple[DirectionRow, ...]
    material: tuple[MaterialRow, ...]
    shape: tuple[ShapeRow, ...]
    clearance_size: float
    backlash_size: float
    weight_sag: float
    tool_sag: float


def read_paper() -> Paper:
    """The paper as typed in the package. Raises `InputError` where the file is not what it should be."""
    content = parse_yaml(files("linkwright.paper").joinpath(FILE).read_text(encoding="utf-8"), file=FILE)
    with Mapping(content, file=FILE).reading() as mapping:
        with mapping.mapping("supplied").reading() as supplied, supplied.mapping("poisson_ratio").reading() as ratios:
            poisson = {name: ratios.number(name) for name in ratios.content}
        with mapping.mapping("inferred").reading() as inferred, mapping.mapping("fitted").reading() as fitted:
            return Paper(
                parameters=_parameters(mapping.mapping("parameters")),
                clearance=tuple(_play(row) for row in mapping.mappings("clearance")),
                backlash=tuple(_play(row) for row in mapping.mappings("backlash")),
                direction=tuple(_direction(row) for row in mapping.mappings("backlash_direction")),
                material=tuple(_material(row, poisson) for row in mapping.mappings("material")),
                shape=tuple(_shape(row) for row in mapping.mappings("shape")),
                clearance_size=inferred.quantity("clearance", "length"),
                backlash_size=inferred.quantity("backlash", "angle"),
                weight_sag=fitted.quantity("weight", "length"),
                tool_sag=fitted.quantity("tool", "length"),
            )


def _parameters(mapping: Mapping) -> Parameters:
    with mapping.reading():
        lengths = mapping.vector("lengths", "length", 3)
        return Parameters(
            lengths=(lengths[0], lengths[1], lengths[2]),
            elastic_modulus=mapping.quantity("elastic_modulus", "elastic_modulus"),
            density=mapping.quantity("density", "density"),
            diameter=mapping.quantity("diameter", "length"),
        )


def _printed(mapping: Mapping) -> tuple[str, ...]:
    figures = mapping.items("printed")
    if not all(isinstance(figure, str) for figure in figures):
        raise mapping.error("printed", "holds figures as texts, so that their last digit stays")
    return tuple(cast(list[str], figures))


def _whole(mapping: Mapping, name: str) -> tuple[int, ...]:
    return tuple(int(cast(int, number)) for number in mapping.items(name))


def _play(mapping: Mapping) -> PlayRow:
    with mapping.reading():
        return PlayRow(_whole(mapping, "joints"), _printed(mapping))


def _direction(mapping: Mapping) -> DirectionRow:
    with mapping.reading():
        return DirectionRow(_whole(mapping, "signs"), _printed(mapping))


def _material(mapping: Mapping, poisson: MappingLike[str, float]) -> MaterialRow:
    with mapping.reading():
        name = mapping.text("name")
        if name not in poisson:
            raise InputError(FILE, "supplied", f"has no Poisson's ratio for {name}")
        modulus = mapping.vector("elastic_modulus", "elastic_modulus", 2)
        density = mapping.vector("density", "density", 2)
        ends = (modulus[0], modulus[1]), (density[0], density[1])
        return MaterialRow(name, *ends, _printed(mapping), poisson[name])


def _shape(mapping: Mapping) -> ShapeRow:
    with mapping.reading():
        with mapping.mapping("dimensions").reading() as given:
            dimensions = {
                name: read_quantity(given.raw(name), "length", file=FILE, key=given.path_of(name))
                for name in given.content
            }
        return ShapeRow(
            mapping.text("name"),
            mapping.text("shape"),
            MappingProxyType(dimensions),
            mapping.text("formula"),
            _printed(mapping),
        )
