"""Arithmetic on the columns of a table: `Joint 1 [rad]*57.29578`, read by a parser of our own and nothing evaluated.

A formula has numbers, + - * / **, parentheses, signs and column names. Names may hold blanks, brackets and
parentheses (`pos (2)`); the longest name that fits is meant. `backticks` around a name settle any doubt.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from materials.quantities import InputError, shown
from materials.reading import nearest

Array = NDArray[np.float64]
_Node = tuple[object, ...]

_NUMBER = re.compile(r"(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_WORD = re.compile(r"[^\W\d]\w*")
_LONGEST, _DEEPEST = 1000, 60
_OPERATIONS: Mapping[str, Callable[[Array, Array], Array]] = MappingProxyType(
    {"+": np.add, "-": np.subtract, "*": np.multiply, "/": np.divide, "**": np.float_power}
)
_RELATIONS: Mapping[str, Callable[[Array, Array], NDArray[np.bool_]]] = MappingProxyType(
    {
        "<=": np.less_equal,
        ">=": np.greater_equal,
        "==": np.equal,
        "!=": np.not_equal,
        "<": np.less,
        ">": np.greater,
    }
)


@dataclass(frozen=True)
class Formula:
    """A formula as read: its text, and the columns that it uses in the order of their first use."""

    text: str
    columns: tuple[str, ...]
    node: _Node

    def value(self, column: Callable[[str], Array], size: int) -> Array:
        """Its value in every row; what cannot be computed (1/0) is nan or infinite."""
        with np.errstate(all="ignore"):
            return np.broadcast_to(_value(self.node, column), (size,)).astype(float)


@dataclass(frozen=True)
class Condition:
    """A comparison of two formulas, such as `visit < 100`."""

    text: str
    left: Formula
    relation: str
    right: Formula

    def holds(self, column: Callable[[str], Array], size: int) -> NDArray[np.bool_]:
        """Whether it holds, in every row; never where a cell is no number."""
        left, right = self.left.value(column, size), self.right.value(column, size)
        with np.errstate(all="ignore"):
            return _RELATIONS[self.relation](left, right) & ~np.isnan(left) & ~np.isnan(right)


def read_formula(text: str, names: Sequence[str], *, file: object, key: str) -> Formula:
    """The formula that a text holds; `names` are the table's columns.

    Raises `InputError` that names the formula and the position of what is wrong.
    """
    parser = _Parser(text, names, file, key)
    node = parser.sum()
    parser.end()
    return Formula(text, tuple(parser.used), node)


def read_condition(text: str, names: Sequence[str], *, file: object, key: str) -> Condition:
    """The comparison that a text holds: FORMULA < FORMULA, with <, <=, >, >=, == or !=. Raises `InputError`."""
    parser = _Parser(text, names, file, key)
    node = parser.sum()
    left = Formula(text, tuple(parser.used), node)
    relation = next((each for each in _RELATIONS if parser.take(each)), None)
    if relation is None:
        raise parser.wrong("a comparison (<, <=, >, >=, ==, !=) is due here")
    node = parser.sum()
    parser.end()
    return Condition(text, left, relation, Formula(text, tuple(parser.used), node))


def _value(node: _Node, column: Callable[[str], Array]) -> Array:
    kind = node[0]
    if kind == "number":
        return np.asarray(node[1], dtype=float)
    if kind == "column":
        return column(str(node[1]))
    if kind == "minus":
        return -_value(_child(node[1]), column)
    return _OPERATIONS[str(kind)](_value(_child(node[1]), column), _value(_child(node[2]), column))


def _child(node: object) -> _Node:
    assert isinstance(node, tuple)
    return node


class _Parser:
    """sum: product {+- product}; product: signed {*/ signed}; signed: {+-} power; power: operand [** signed]."""

    def __init__(self, text: str, names: Sequence[str], file: object, key: str) -> None:
        self.text, self.file, self.key = text, file, key
        self.names = sorted((name for name in names if name), key=len, reverse=True)
        self.used: dict[str, None] = {}
        self.at = 0
        self.depth = 0
        if len(text) > _LONGEST:
            raise InputError(file, key, f"the formula is longer than {_LONGEST} characters")

    def wrong(self, message: str) -> InputError:
        self.blanks()
        return InputError(self.file, self.key, f"in the formula {shown(self.text)}, position {self.at + 1}: {message}")

    def blanks(self) -> None:
        while self.at < len(self.text) and self.text[self.at].isspace():
            self.at += 1

    def take(self, symbol: str) -> bool:
        self.blanks()
        if not self.text.startswith(symbol, self.at):
            return False
        if symbol == "*" and self.text.startswith("**", self.at):
            return False
        self.at += len(symbol)
        return True

    def end(self) -> None:
        self.blanks()
        if self.at < len(self.text):
            rest = self.text[self.at]
            power = "; a power is written **" if rest == "^" else ""
            raise self.wrong(f"{shown(rest)} is not expected; an operator (+ - * / **) or the end is{power}")

    def sum(self) -> _Node:
        node = self.product()
        while True:
            symbol = next((each for each in "+-" if self.take(each)), None)
            if symbol is None:
                return node
            node = (symbol, node, self.product())

    def product(self) -> _Node:
        node = self.signed()
        while True:
            symbol = next((each for each in "*/" if self.take(each)), None)
            if symbol is None:
                return node
            node = (symbol, node, self.signed())

    def signed(self) -> _Node:
        self.depth += 1
        if self.depth > _DEEPEST:
            raise self.wrong("nested too deeply")
        negative = self.take("-")
        if negative or self.take("+"):
            inner = self.signed()
            node = ("minus", inner) if negative else inner
        else:
            node = self.operand()
            if self.take("**"):
                node = ("**", node, self.signed())
        self.depth -= 1
        return node

    def operand(self) -> _Node:
        self.blanks()
        if self.take("`"):
            close = self.text.find("`", self.at)
            name = self.text[self.at : close] if close >= 0 else ""
            if name not in self.names:
                raise self.unknown(name or self.text[self.at :])
            self.at = close + 1
            return self.column(name)
        number = _NUMBER.match(self.text, self.at)
        name = self.name_here()
        if name is not None and (number is None or len(name) > len(number[0])):
            self.at += len(name)
            return self.column(name)
        if number is not None:
            self.at = number.end()
            if (value := float(number[0])) == float("inf"):
                raise self.wrong("a number is too large")
            return ("number", value)
        if self.take("("):
            node = self.sum()
            if not self.take(")"):
                raise self.wrong("a closing parenthesis is missing")
            return node
        if self.at >= len(self.text):
            raise self.wrong("ends where a number or a column is due")
        word = _WORD.match(self.text, self.at)
        if word is not None:
            raise self.unknown(word[0])
        raise self.wrong(f"{shown(self.text[self.at])} stands where a number or a column is due")

    def name_here(self) -> str | None:
        """The longest column name that stands here and does not end within a word."""
        for name in self.names:
            if self.text.startswith(name, self.at):
                after = self.text[self.at + len(name) : self.at + len(name) + 1]
                if not (_in_word(name[-1]) and after and _in_word(after)):
                    return name
        return None

    def column(self, name: str) -> _Node:
        self.used[name] = None
        return ("column", name)

    def unknown(self, name: str) -> InputError:
        return self.wrong(f"there is no column {shown(name)}{nearest(name, sorted(self.names))}")


def _in_word(character: str) -> bool:
    return character.isalnum() or character == "_"
