"""Arithmetic on the columns of a table: `Joint 1 [rad]*57.29578`, parsed by `ast`; nothing of it is evaluated.

A formula has numbers, + - * / **, parentheses, signs and column names. Names may hold blanks, brackets and
parentheses (`pos (2)`); the longest name that fits is meant. `backticks` around a name settle any doubt. All
arithmetic is on floats, so that no power grows without end: `9**9**9` is infinite at once.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from linkwright.core.sections.numeric import Array
from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import InputError, shown

_NUMBER = re.compile(r"(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_WORD = re.compile(r"[^\W\d]\w*")
_SIGN, _OPERATOR = re.compile(r"[+-]"), re.compile(r"\*\*|[-+*/]")
_RELATION = re.compile(r"<=|>=|==|!=|<|>")
_LONGEST, _DEEPEST = 1000, 60
_OPERATIONS: Mapping[type[ast.operator], Callable[[Array, Array], Array]] = MappingProxyType(
    {ast.Add: np.add, ast.Sub: np.subtract, ast.Mult: np.multiply, ast.Div: np.divide, ast.Pow: np.float_power}
)
_RELATIONS: Mapping[type[ast.cmpop], Callable[[Array, Array], NDArray[np.bool_]]] = MappingProxyType(
    {
        ast.LtE: np.less_equal,
        ast.GtE: np.greater_equal,
        ast.Eq: np.equal,
        ast.NotEq: np.not_equal,
        ast.Lt: np.less,
        ast.Gt: np.greater,
    }
)


@dataclass(frozen=True)
class Formula:
    """A formula as read: its text, and the columns that it uses in the order of their first use."""

    text: str
    columns: tuple[str, ...]
    node: ast.expr

    def value(self, column: Callable[[str], Array], size: int) -> Array:
        """Its value in every row; what cannot be computed (1/0) is nan or infinite."""
        with np.errstate(all="ignore"):
            return np.broadcast_to(_value(self.node, column, self.columns), (size,)).astype(float)


@dataclass(frozen=True)
class Condition:
    """A comparison of two formulas, such as `visit < 100`."""

    text: str
    left: Formula
    relation: type[ast.cmpop]
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
    words = _Words(text, names, file, key)
    source = words.sum()
    words.end()
    return Formula(text, tuple(words.used), ast.parse(source, mode="eval").body)


def read_condition(text: str, names: Sequence[str], *, file: object, key: str) -> Condition:
    """The comparison that a text holds: FORMULA < FORMULA, with <, <=, >, >=, == or !=. Raises `InputError`."""
    words = _Words(text, names, file, key)
    left = words.sum()
    relation = words.take(_RELATION)
    if not relation:
        raise words.wrong("a comparison (<, <=, >, >=, ==, !=) is due here")
    right = words.sum()
    words.end()
    node = ast.parse(f"{left} {relation} {right}", mode="eval").body
    assert isinstance(node, ast.Compare)
    columns = tuple(words.used)
    one, other = Formula(text, columns, node.left), Formula(text, columns, node.comparators[0])
    return Condition(text, one, type(node.ops[0]), other)


def _value(node: ast.expr, column: Callable[[str], Array], columns: Sequence[str]) -> Array:
    """The value of what the words below can come to, and of nothing else."""
    match node:
        case ast.Constant(value=float(number)):
            return np.asarray(number)
        case ast.Name(id=name):
            return column(columns[int(name[1:])])
        case ast.UnaryOp(op=ast.UAdd() | ast.USub() as sign, operand=inner):
            value = _value(inner, column, columns)
            return -value if isinstance(sign, ast.USub) else value
        case ast.BinOp(left=left, op=operator, right=right) if type(operator) in _OPERATIONS:
            operation = _OPERATIONS[type(operator)]
            return operation(_value(left, column, columns), _value(right, column, columns))
        case _:
            raise ValueError(f"{type(node).__name__} is no part of a formula")


class _Words:
    """A text read word by word into the same formula as Python writes it, column k named `ck`; whatever is not due is
    refused where it stands, so that what is left is sound."""

    def __init__(self, text: str, names: Sequence[str], file: object, key: str) -> None:
        self.text, self.file, self.key = text, file, key
        self.names = sorted((name for name in names if name), key=len, reverse=True)
        self.used: list[str] = []
        self.at = 0
        if len(text) > _LONGEST:
            raise InputError(file, key, f"the formula is longer than {_LONGEST} characters")

    def wrong(self, message: str) -> InputError:
        self.blanks()
        return InputError(self.file, self.key, f"in the formula {shown(self.text)}, position {self.at + 1}: {message}")

    def blanks(self) -> None:
        while self.at < len(self.text) and self.text[self.at].isspace():
            self.at += 1

    def take(self, pattern: re.Pattern[str]) -> str:
        """The word of this pattern that stands here, empty for none."""
        self.blanks()
        token = pattern.match(self.text, self.at)
        self.at = token.end() if token else self.at
        return token[0] if token else ""

    def here(self, symbol: str) -> bool:
        self.blanks()
        there = self.text.startswith(symbol, self.at)
        self.at += len(symbol) if there else 0
        return there

    def end(self) -> None:
        self.blanks()
        if self.at < len(self.text):
            rest = self.text[self.at]
            power = "; a power is written **" if rest == "^" else ""
            raise self.wrong(f"{shown(rest)} is not expected; an operator (+ - * / **) or the end is{power}")

    def sum(self) -> str:
        """Operands with operators between them, each behind its signs and parentheses, as far as they go."""
        words: list[str] = []
        outer: list[int] = []  # how deep each open parenthesis stands
        depth = 0
        while True:
            while sign := self.take(_SIGN) or ("(" if self.here("(") else ""):
                if sign == "(":
                    outer.append(depth)
                words.append(sign)
                depth += 1
            if depth > _DEEPEST:
                raise self.wrong("nested too deeply")
            words.append(self.operand())
            while outer and self.here(")"):
                words.append(")")
                depth = outer.pop()
            operator = self.take(_OPERATOR)
            if not operator:
                break
            words.append(operator)
            depth = depth + 1 if operator == "**" else outer[-1] + 1 if outer else 0
        if outer:
            raise self.wrong("a closing parenthesis is missing")
        return " ".join(words)

    def operand(self) -> str:
        """A number or a column."""
        if self.here("`"):
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
            return repr(value)
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

    def column(self, name: str) -> str:
        if name not in self.used:
            self.used.append(name)
        return f"c{self.used.index(name)}"

    def unknown(self, name: str) -> InputError:
        return self.wrong(f"there is no column {shown(name)}{nearest(name, sorted(self.names))}")


def _in_word(character: str) -> bool:
    return character.isalnum() or character == "_"
