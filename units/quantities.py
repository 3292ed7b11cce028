"""Quantities at the door: `400 mm` in a file, `0.4` inside, and back again.

Every dimensional value in a file is a string with its unit; inside, everything is a float in SI. A quantity
is `NUMBER UNIT` and nothing else: no arithmetic is ever evaluated. Whatever is wrong becomes an `InputError`,
one line that names the file, the key and what would do.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import Context, Decimal
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Literal, cast

from linkwright.core.units.names import meant
from linkwright.core.units.units import Kind, kinds, registry

if TYPE_CHECKING:
    import pint

Relation = Literal["<=", "==", ">="]

_LONGEST = 100
_LONGEST_FILE, _LONGEST_KEY, _LONGEST_MESSAGE = 900, 400, 1600
_LEAST = 1e-30
"""Less than this, in SI, is nothing of an arm, and its powers are zero."""
_NUMBER = r"[+-]?(?:[0-9]{1,40}(?:\.[0-9]{0,40})?|\.[0-9]{1,40})(?:[eE][+-]?[0-9]{1,3})?"
_FACTOR = r"[A-Za-zµμ%_]+(?:(?:\^|\*\*)-?[1-9])?"
_PRODUCT = rf"{_FACTOR}(?:[*/]{_FACTOR})*"
_TERM = rf"(?:{_FACTOR}|\({_PRODUCT}\))"
_UNIT = re.compile(rf"(?:1/)?{_TERM}(?:[*/]{_TERM})*")
_QUANTITY = re.compile(rf"({_NUMBER})\s*(.*)", re.DOTALL)
_PURE = re.compile(_NUMBER)
_BOUND = re.compile(r"(<=|>=|==|=<|=>|≤|≥|=|<|>)\s*(.*)", re.DOTALL)
_NOT_FINITE = re.compile(r"[+-]?\.?(?:nan|inf|infinity)\b.*", re.IGNORECASE | re.DOTALL)
_CURRENCY = re.compile(
    r"\b(USD|GBP|CHF|JPY|CNY|CAD|AUD|SEK|NOK|DKK|PLN|CZK|INR|KRW|dollars?|cents?)\b|[$£¥]", re.IGNORECASE
)
_WRITTEN_OTHERWISE = str.maketrans(
    {"−": "-", "–": "-", "·": "*", "⋅": "*", "×": "*", "²": "^2", "³": "^3", "⁴": "^4", "\u00a0": " "}
)
_SYMBOLS = (("°C", "degC"), ("°F", "degF"), ("°", "deg"), ("€", "EUR"))
_ARITHMETIC = Context(prec=34)


def _bounded(text: str, longest: int) -> str:
    return text if len(text) <= longest else text[: longest - 3] + "..."


class InputError(Exception):
    """The input is wrong: the one exception of the project for that (exit status 2).

    `file` is where it was read, `key` the entry, `message` what is wrong and what would do; `str()` joins the
    three into one line. `file` and `key` may be empty, and are then left out of the line. `remedies` are settings of
    which any would do, as they can be written beside the data (see `units.reading.refusal`).
    """

    __module__ = "linkwright"  # as people import it, and as a traceback shows it

    def __init__(self, file: object, key: str, message: str, *remedies: Mapping[str, Any]) -> None:
        self.file, self.remedies = str(file), remedies
        self.key = _bounded(key, _LONGEST_KEY)
        self.message = _bounded(" ".join(message.split()), _LONGEST_MESSAGE)
        file_shown = _bounded(" ".join(self.file.splitlines()), _LONGEST_FILE)
        super().__init__(": ".join(part for part in (file_shown, " ".join(self.key.split()), self.message) if part))

    def __reduce__(self) -> tuple[object, ...]:
        """Keep the fields when an error crosses between processes."""
        return InputError, (self.file, self.key, self.message, *self.remedies)


class NoAnswer(Exception):
    """A well-formed question without an answer (exit status 1); the message says what stands in the way.

    `infeasible` holds, where no design keeps all limits, all that is known of why, in SI (an
    `optimize.infeasible.answer.Infeasibility`); None elsewhere.
    """

    __module__ = "linkwright"  # as people import it, and as a traceback shows it

    infeasible: Any = None


class SIFloat(float):
    """A float that stands for a quantity in SI, as a program gives it; a file's bare number is never one."""


class SIInt(int):
    """The same of a whole number; where a count is due it is that count."""


@dataclass(frozen=True)
class Bound:
    """A limit such as `<= 26 kg`: the relation and the limit's value in SI."""

    relation: Relation
    value: float

    def holds(self, value: float, tolerance: float = 1e-9) -> bool:
        """Tell whether `value` (SI) keeps the limit, within `tolerance` relative to the limit."""
        slack = tolerance * max(abs(self.value), 1e-300)
        if self.relation == "<=":
            return value <= self.value + slack
        if self.relation == ">=":
            return value >= self.value - slack
        return abs(value - self.value) <= slack


def shown(value: object, longest: int = 60) -> str:
    """Return `value` as it can stand in a one-line message: quoted, without line breaks, not too long."""
    text = " ".join(repr(value).split())
    return text if len(text) <= longest else text[: longest - 3] + "..."


def _with_ascii_symbols(text: str) -> str:
    text = text.strip().translate(_WRITTEN_OTHERWISE)
    for symbol, plain in _SYMBOLS:
        text = text.replace(symbol, plain)
    return text


def kind_of(name: str) -> Kind:
    """Return the kind called `name`; raises `KeyError` for no such kind (a mistake in code, not in input)."""
    return kinds()[name]


def _what_would_do(kind: Kind) -> str:
    if not kind.si:
        return f"e.g. {kind.example}"
    return f"e.g. '{kind.example}' ({', '.join(kind.units)})"


@lru_cache(maxsize=2048)
def _unit(text: str) -> pint.Unit | None:
    """Parse a unit, None if it is not one; the strict grammar keeps numbers and arithmetic out. An exponent may follow
    its unit as data sheets write it: `g/cm3`, `N/mm2`."""
    compact = re.sub(r"\s*([*/()^])\s*", r"\1", text.strip()).replace(" ", "*")
    compact = re.sub(r"(?<=[A-Za-z])([2-9])(?=[*/)]|$)", r"^\1", compact)
    if not _UNIT.fullmatch(compact):
        return None
    import pint

    try:
        return registry().parse_units(compact)
    except (pint.PintError, ValueError, AttributeError, TypeError):
        return None


@lru_cache(maxsize=2048)
def _factor(unit: pint.Unit, si: str) -> Decimal:
    """Return what one `unit` is in `si` (both without offset); raises pint.DimensionalityError."""
    return Decimal(registry().convert(Decimal(1), unit, registry().parse_units(si)))


def _unknown_unit(text: str, kind: Kind) -> str:
    if _CURRENCY.search(text):
        return f"money is in EUR only, {shown(text)} is not converted; write {_what_would_do(kind)}"
    near = meant(text, kind.units, 0.5)
    hint = f"did you mean '{near}'?" if near else "write " + _what_would_do(kind)
    return f"{shown(text)} is not a unit known here; {hint}"


def _read_pure(value: object, kind: Kind, file: object, key: str) -> float:
    if isinstance(value, str):
        text = _with_ascii_symbols(value)
        if _PURE.fullmatch(text):
            value = float(text)
        elif len(text) <= _LONGEST and _PURE.fullmatch(text.rstrip("%").rstrip()) and text.endswith("%"):
            value = float(Decimal(text.rstrip("%").rstrip()) / 100)
        elif len(text) <= _LONGEST and (result := _QUANTITY.fullmatch(text)) and _unit(result[2]) is not None:
            would_do = _what_would_do(kind)
            raise InputError(file, key, f"takes a pure number ({would_do}), not {shown(value)} with a unit")
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(file, key, f"needs a pure number ({_what_would_do(kind)}), not {shown(value)}")
    return _finite(value, file, key)


def _finite(value: float, file: object, key: str) -> float:
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise InputError(file, key, "needs a finite number")
    return number


def read_number(value: object, *, file: object, key: str) -> float:
    """Return a pure number as a finite float; a string such as `1e3` (YAML leaves it a string) counts."""
    return _read_pure(value, kind_of("dimensionless"), file, key)


def read_quantity(value: object, kind: str, *, file: object, key: str) -> float:
    """Return the quantity `value` in SI.

    `value` is what YAML gave: a string `NUMBER UNIT` (`400 mm`, `12 kN*m/rad`, `30 EUR/kg`), or a bare number
    where `kind` is `dimensionless`; or an `SIFloat` or `SIInt` that a program gave. Zero needs no unit, but
    of temperature. Temperatures are absolute (`20 degC` is 293.15). `kind` is a name in
    `units.kinds()`. Raises `InputError` for a missing or unknown unit, a wrong dimension, nan or infinity, or
    anything else.
    """
    due = kind_of(kind)
    if not due.si:
        return _read_pure(value, due, file, key)
    if isinstance(value, SIFloat | SIInt):
        return _si_number(float(value), due, file, key)
    would_do = _what_would_do(due)
    if isinstance(value, bool) or value is None or not isinstance(value, str | int | float):
        raise InputError(file, key, f"needs a quantity with its unit, {would_do}, not {shown(value)}")
    if isinstance(value, int | float) or _PURE.fullmatch(value.strip()):
        number = _finite(value if isinstance(value, int | float) else float(value.strip()), file, key)
        if number == 0.0 and due.name != "temperature":
            return 0.0
        raise InputError(file, key, f"needs a unit, {would_do}, not the bare number {shown(value)}")
    number, unit = _number_and_unit(value, due, file, key)
    si_value = _finite(_to_si(number, unit, due, value, file, key), file, key)
    if abs(si_value) > due.most or 0.0 < abs(si_value) < _LEAST:
        than = f"less than {_LEAST:g} {due.si}; write 0" if abs(si_value) < _LEAST else f"beyond {due.most:g} {due.si}"
        raise InputError(file, key, f"{shown(value)} is no {due.name.replace('_', ' ')} of an arm ({than})")
    return si_value


def _number_and_unit(value: str, due: Kind, file: object, key: str) -> tuple[str, pint.Unit]:
    """The two parts of a quantity as text. Raises `InputError`."""
    text, would_do = _with_ascii_symbols(value), _what_would_do(due)
    if _NOT_FINITE.fullmatch(text):
        raise InputError(file, key, f"needs a finite number, {would_do}, not {shown(value)}")
    result = _QUANTITY.fullmatch(text) if len(text) <= _LONGEST else None
    if not result:
        raise InputError(file, key, f"{shown(value)} is not a quantity; write {would_do}")
    unit = _unit(result[2])
    if unit is not None:
        return result[1], unit
    if re.fullmatch(r",[0-9]+\b.*", result[2]):
        raise InputError(file, key, f"{shown(value)} has a decimal comma; write a point, {would_do}")
    if _CURRENCY.search(result[2]) or re.fullmatch(r"[A-Za-zµμ°%_*/^() 1-9-]+", result[2]):
        raise InputError(file, key, _unknown_unit(result[2].strip(), due))
    raise InputError(file, key, f"{shown(value)} is not a quantity; write {would_do}")


def _si_number(value: float, due: Kind, file: object, key: str) -> float:
    if due.name == "temperature" and value < 0.0:
        raise InputError(file, key, f"{value:g} K is below absolute zero")
    return _finite(value, file, key)


def _to_si(number: str, unit: pint.Unit, due: Kind, given: str, file: object, key: str) -> float:
    import pint

    _finite(float(number), file, key)
    offset = unit in (registry().degC, registry().degF)
    if due.name == "temperature_difference" and offset:
        raise InputError(file, key, f"is a difference of temperature; write '30 K', not {shown(given)}")
    try:
        si_value = _converted(Decimal(number), unit, due)
    except (pint.DimensionalityError, pint.OffsetUnitCalculusError):
        is_not = f"is {_described(unit)}, not {_with_article(due)}"
        raise InputError(file, key, f"{shown(given)} {is_not}; write {_what_would_do(due)}") from None
    if due.name == "temperature" and si_value < 0:
        raise InputError(file, key, f"{shown(given)} is below absolute zero")
    return si_value


def _converted(number: Decimal, unit: pint.Unit, kind: Kind) -> float:
    if kind.name == "temperature":
        return float(registry().convert(number, unit, registry().K))
    return float(_ARITHMETIC.multiply(number, _factor(unit, kind.si)))


def _with_article(kind: Kind) -> str:
    name = kind.name.replace("_", " ")
    return ("an " if name[0] in "aeiou" else "a ") + name


def _described(unit: pint.Unit) -> str:
    """Name the kind of quantity that `unit` measures, for the message about a wrong dimension."""
    for kind in kinds().values():
        if kind.si and registry().parse_units(kind.si).dimensionality == unit.dimensionality:
            return _with_article(kind)
    return "of dimension " + str(unit.dimensionality).replace(" ", "")


def _plain(number: Decimal) -> str:
    """Write a decimal without exponent where that stays readable."""
    number = number.normalize()
    if number == 0:
        return "0"
    if -5 <= number.adjusted() < 9:
        return f"{number:f}"
    mantissa, _, exponent = f"{number:e}".partition("e")
    return f"{mantissa}e{int(exponent)}"


def _good_unit(si_value: float, kind: Kind) -> str:
    if si_value == 0:
        return kind.zero
    chosen = kind.choices[0][1]
    for least, unit in kind.choices:
        if abs(si_value) >= least * (1 - 1e-12):
            chosen = unit
    return chosen


def format_quantity(si_value: float, kind: str, unit: str | None = None, digits: int | None = None) -> str:
    """Return the SI value as `400 mm`, `71 GPa`, `60 kN*m/rad`: short symbols, in a unit that suits its size.

    `unit` asks for a certain unit. Without `digits` the shortest number that reads back within 1e-12 of the
    value is written; `digits` rounds to that many significant digits. What no reader takes, as it is less than any
    size of an arm, is written as 0. Raises `ValueError` where the value is not finite or `unit` does not measure this
    kind.
    """
    if not math.isfinite(si_value):
        raise ValueError(f"a {kind} of {si_value} cannot be written")
    due = kind_of(kind)
    symbol = _good_unit(si_value, due) if unit is None else unit
    if due.si and abs(si_value) < _LEAST:
        si_value = 0.0
    value = Decimal(float(si_value))
    pint_unit = None
    if due.si:
        pint_unit = _unit(symbol)
        if pint_unit is None or pint_unit.dimensionality != registry().parse_units(due.si).dimensionality:
            raise ValueError(f"{symbol!r} is not a unit of {kind}")
        if due.name == "temperature":
            value = Decimal(registry().convert(value, registry().K, pint_unit))
        else:
            value = _ARITHMETIC.divide(value, _factor(pint_unit, due.si))
    for count in range(1, 18) if digits is None else (digits,):
        written = _plain(Context(prec=count).plus(value))
        text = f"{written} {symbol}" if due.si and symbol else written
        if digits is not None:
            return text
        back = float(written) if pint_unit is None else _converted(Decimal(written), pint_unit, due)
        if abs(back - si_value) <= 1e-12 * abs(si_value):
            return text
    return f"{_plain(Context(prec=34).plus(value))} {symbol}".strip()


def read_bound(
    text: object, kind: str, *, file: object, key: str, senses: Sequence[Relation] = ("<=", "==", ">=")
) -> Bound:
    """Return the limit written as `<= 26 kg`, `== 1240 mm` or `>= 2`, in SI; raises `InputError`, which says how it
    would be written with the relations that it can have (`senses`)."""
    result = _BOUND.fullmatch(text.strip()) if isinstance(text, str) else None
    if not result:
        raise InputError(file, key, f"{shown(text)} is not a limit; write {_as_limit(text, kind, senses)}")
    relation = {"≤": "<=", "=<": "<=", "≥": ">=", "=>": ">=", "=": "=="}.get(result[1], result[1])
    if relation in ("<", ">"):
        raise InputError(file, key, f"{shown(text)}: a strict limit has no optimum; write '{relation}='")
    return Bound(cast(Relation, relation), read_quantity(result[2], kind, file=file, key=key))


def _as_limit(text: object, kind: str, senses: Sequence[Relation]) -> str:
    """How a limit is written that says no relation, or what one looks like."""
    value = kind_of(kind).example
    if isinstance(text, str | int | float) and not isinstance(text, bool):
        number = str(text).strip()
        bare = _PURE.fullmatch(number) is not None and bool(kind_of(kind).si)
        try:
            read_quantity(f"{number} {kind_of(kind).zero}" if bare else text, kind, file="", key="")
        except InputError:
            pass
        else:
            value = f"{number} {kind_of(kind).zero}" if bare else number
            return " or ".join(f"'{relation} {value}'" for relation in senses)
    return "a relation and a limit, e.g. " + " or ".join(f"'{relation} {value}'" for relation in senses)


def read_range(value: object, kind: str, *, file: object, key: str) -> tuple[float, float]:
    """Return `[low, high]` in SI, low <= high; raises `InputError` for anything but two in that order."""
    due = kind_of(kind)
    if not isinstance(value, list | tuple) or len(cast(Sequence[object], value)) != 2:
        would_do = f"e.g. [{f'0 {due.zero}'.strip()}, {due.example}]"
        raise InputError(file, key, f"needs a range of two, lowest and highest, {would_do}, not {shown(value)}")
    pair = cast(Sequence[object], value)
    low = read_quantity(pair[0], kind, file=file, key=f"{key}[1]")
    high = read_quantity(pair[1], kind, file=file, key=f"{key}[2]")
    if low > high:
        raise InputError(file, key, f"the range is reversed: {shown(pair[0])} is above {shown(pair[1])}")
    return low, high
