"""The straight-line program of a symbolic expression, read off CasADi.

An SX expression is a graph; `ca.Function` puts it in an order of execution.  `read_tape` takes that
order down as nodes in single-assignment form (a node is written once and named by its position), which
is what both code generators, NumPy and C, start from.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

UNARY = frozenset(
    {"neg", "exp", "log", "sqrt", "sq", "twice", "sin", "cos", "tan", "asin", "acos", "atan", "not", "floor"}
    | {"ceil", "fabs", "sign", "erf", "inv", "sinh", "cosh", "tanh", "asinh", "acosh", "atanh", "log1p"}
    | {"expm1"}
)
COMMUTATIVE = frozenset({"add", "mul", "eq", "ne", "and", "or", "hypot"})
BINARY = COMMUTATIVE.union(
    {"sub", "div", "pow", "constpow", "lt", "le", "fmod", "copysign", "if_else_zero", "atan2", "remainder"}
    | {"fmin", "fmax"}  # Not commutative: of two zeros, CasADi takes the first.
)
# Left out on purpose: erfinv, which CasADi computes by an approximation good to a few 1e-6 only.


class UnsupportedOperation(ValueError):
    """An expression holds an operation that has no vectorised form; the message names it."""


@dataclass(frozen=True, slots=True)
class Node:
    """One step of a tape: an operation on earlier nodes, a constant, or a component of an input.

    `op` is CasADi's name in lower case ("add", "sin", ...), or "const" (with `value`), or "input" (with
    `source` = which input, which component); `args` are positions of earlier nodes.
    """

    op: str
    args: tuple[int, ...] = ()
    value: float = 0.0
    source: tuple[int, int] = (0, 0)


@dataclass(frozen=True, slots=True)
class Tape:
    """A straight-line program: `nodes` in order, and for every output the node of each component."""

    nodes: tuple[Node, ...]
    outputs: tuple[tuple[int, ...], ...]
    input_sizes: tuple[int, ...]

    @property
    def output_sizes(self) -> tuple[int, ...]:
        """Number of components of each output."""
        return tuple(len(output) for output in self.outputs)

    def uniform_nodes(self, uniform_inputs: Sequence[bool]) -> tuple[bool, ...]:
        """Whether each node is the same in all rows, given which inputs are the same in all rows."""
        uniform: list[bool] = []
        for node in self.nodes:
            if node.op == "input":
                uniform.append(uniform_inputs[node.source[0]])
            else:
                uniform.append(all(uniform[arg] for arg in node.args))
        return tuple(uniform)


def read_tape(inputs: Sequence[ca.SX], outputs: Sequence[ca.SX]) -> Tape:
    """Tape of `outputs` as functions of `inputs`, common subexpressions merged.

    Both are sequences of SX columns; inputs consist of symbols only.  Raises `ValueError` for a shape or a
    symbol that does not belong, `UnsupportedOperation` for an operation without a vectorised form.
    """
    _check_columns(inputs, outputs)
    sizes = [output.numel() for output in outputs]
    stacked = ca.cse(ca.densify(ca.vertcat(ca.SX(0, 1), *outputs)))
    arguments = [ca.vertcat(ca.SX(0, 1), *inputs)]
    owners = [(k, j) for k, column in enumerate(inputs) for j in range(column.numel())]
    function = ca.Function("tape", arguments, [stacked])
    names = {getattr(ca, name): name[3:].lower() for name in dir(ca) if name.startswith("OP_")}

    nodes: list[Node] = []
    known: dict[tuple[object, ...], int] = {}
    slots: dict[int, int] = {}
    results: dict[int, int] = {}

    def add(node: Node) -> int:
        # The sign of a zero matters (1/-0.0), and a NaN never equals itself: key constants by their text.
        key = (node.op, node.args, node.value.hex(), node.source)
        if key not in known:
            known[key] = len(nodes)
            nodes.append(node)
        return known[key]

    for step in range(function.n_instructions()):
        op = names.get(function.instruction_id(step), f"number {function.instruction_id(step)}")
        to = function.instruction_output(step)
        if op == "const":
            slots[to[0]] = add(Node("const", value=float(function.instruction_constant(step))))
        elif op == "input":
            slots[to[0]] = add(Node("input", source=owners[function.instruction_input(step)[1]]))
        elif op == "output":
            results[to[1]] = slots[function.instruction_input(step)[0]]
        elif op in ("assign", "lift"):
            slots[to[0]] = slots[function.instruction_input(step)[0]]
        elif op in UNARY or op in BINARY:
            args = tuple(slots[arg] for arg in function.instruction_input(step))
            args = args[:1] if op in UNARY else args
            if op in COMMUTATIVE and args[0] > args[1]:
                args = (args[1], args[0])
            slots[to[0]] = add(Node(op, args))
        else:
            raise UnsupportedOperation(f"the operation {op} of CasADi has no vectorised form")

    ends: list[tuple[int, ...]] = []
    start = 0
    for size in sizes:
        ends.append(tuple(results[j] for j in range(start, start + size)))
        start += size
    return Tape(tuple(nodes), tuple(ends), tuple(column.numel() for column in inputs))


def with_half_angles(tape: Tape) -> Tape:
    """The same program with t = tan(x/2) for every sine and cosine: 2t/(1 + t^2) and 2/(1 + t^2) - 1.

    Off by at most 4e-16 (absolute) from sine and cosine, about what one rounding of x does; the tangent's
    poles do no harm, as t^2 stays below 1e33.  It pays where a tangent costs less than a sine.
    """
    nodes: list[Node] = []
    moved: list[int] = []
    parts: dict[int, tuple[int, int]] = {}

    def add(op: str, *args: int, value: float = 0.0) -> int:
        nodes.append(Node(op, args, value))
        return len(nodes) - 1

    if not any(node.op in ("sin", "cos") for node in tape.nodes):
        return tape
    half, one, two = (add("const", value=value) for value in (0.5, 1.0, 2.0))
    for node in tape.nodes:
        args = tuple(moved[arg] for arg in node.args)
        if node.op in ("sin", "cos"):
            angle = args[0]
            if angle not in parts:
                tangent = add("tan", add("mul", angle, half))
                parts[angle] = add("div", two, add("add", add("sq", tangent), one)), tangent
            weight, tangent = parts[angle]
            moved.append(add("sub", weight, one) if node.op == "cos" else add("mul", weight, tangent))
        else:
            nodes.append(Node(node.op, args, node.value, node.source))
            moved.append(len(nodes) - 1)
    outputs = tuple(tuple(moved[node] for node in output) for output in tape.outputs)
    return Tape(tuple(nodes), outputs, tape.input_sizes)


def literal(value: float) -> str:
    """A float as source text that both Python and C read back to the same number."""
    if math.isnan(value):
        return "NAN"
    if math.isinf(value):
        return "INFINITY" if value > 0 else "(-INFINITY)"
    return repr(value) if math.copysign(1.0, value) > 0 else f"({value!r})"


def _check_columns(inputs: Sequence[ca.SX], outputs: Sequence[ca.SX]) -> None:
    """Raise `ValueError` unless inputs are columns of distinct symbols that cover all of the outputs."""
    for kind, columns in (("input", inputs), ("output", outputs)):
        for k, column in enumerate(columns):
            if column.numel() > 0 and column.size2() != 1:
                raise ValueError(f"{kind} {k} has shape {column.shape}; a column vector is needed")
    for k, column in enumerate(inputs):
        if column.numel() > 0 and not (column.is_dense() and column.is_valid_input()):
            raise ValueError(f"input {k} is not made of symbols only: {column}")
    symbols = [column[j] for column in inputs for j in range(column.numel())]
    if len({symbol.element_hash() for symbol in symbols}) < len(symbols):
        raise ValueError("a symbol stands more than once among the inputs")
    given = {symbol.element_hash() for symbol in symbols}
    free = [s for s in ca.symvar(ca.vertcat(ca.SX(0, 1), *outputs)) if s.element_hash() not in given]
    if free:
        raise ValueError(f"outputs depend on symbols that are no input: {', '.join(map(str, free))}")
