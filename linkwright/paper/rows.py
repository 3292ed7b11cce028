"""What a table of the paper is once the truth stands beside it; plain data for screen, Markdown, CSV and JSON."""

from __future__ import annotations

from dataclasses import dataclass
from decimal import ROUND_HALF_UP, Decimal


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
