"""NumPy source from a tape: blocks of rows that stay in the cache, and no allocation inside the loop.

Two functions are generated.  `uniform` computes once, as scalars, what is the same in all rows; `block`
computes one block of rows, every step a ufunc that writes into a register (a buffer reused as soon as its
value is no longer needed) or straight into the block of the output.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType
from typing import Any

import numpy as np
from scipy import special

from linkwright.core.sections.numeric import Array

from .tape import Node, Tape, literal, with_half_angles

BLOCK_BYTES = 3 << 20
"""Registers, inputs and outputs of one block share about this much memory: in smaller blocks, which a level-2 cache
would hold, the calls cost more than the cache saves, and the more so the longer the arm."""

UFUNCS = MappingProxyType({
    "add": "add", "sub": "subtract", "mul": "multiply", "div": "divide", "neg": "negative",
    "exp": "exp", "log": "log", "pow": "power", "constpow": "power", "sqrt": "sqrt", "sq": "square",
    "sin": "sin", "cos": "cos", "tan": "tan", "asin": "arcsin", "acos": "arccos", "atan": "arctan",
    "lt": "less", "le": "less_equal", "eq": "equal", "ne": "not_equal", "not": "logical_not",
    "and": "logical_and", "or": "logical_or", "floor": "floor", "ceil": "ceil", "fmod": "fmod",
    "fabs": "fabs", "copysign": "copysign", "fmin": "fmin", "fmax": "fmax",
    "inv": "reciprocal", "sinh": "sinh", "cosh": "cosh", "tanh": "tanh", "asinh": "arcsinh",
    "acosh": "arccosh", "atanh": "arctanh", "atan2": "arctan2", "log1p": "log1p", "expm1": "expm1",
    "hypot": "hypot",
})  # fmt: skip


def _if_else_zero(condition: Any, value: Any, out: Array | None = None) -> Any:
    """`value` where the condition is not zero (a NaN is not zero), else 0; `out` must alias neither."""
    if out is None:
        return value if condition != 0.0 else 0.0
    out.fill(0.0)
    np.copyto(out, value, where=np.not_equal(condition, 0.0))
    return out


def _sign(x: Any, out: Array | None = None) -> Any:
    """Sign of x as CasADi has it: a zero keeps its sign; `out` must not alias x."""
    return np.copysign(np.sign(x, out=out), x, out=out)


def _remainder(x: Any, y: Any, out: Array | None = None) -> Any:
    """IEEE remainder x - y*n, n the integer nearest to x/y, ties to even; exact, unlike that formula."""
    size = np.fabs(y)
    rest = np.fabs(np.fmod(x, 2.0 * size))
    once = rest - size
    nearest = np.where(2.0 * rest > size, np.where(2.0 * once >= size, once - size, once), rest)
    result = np.where(np.signbit(x), -nearest, nearest)
    if out is None:
        return np.float64(result)
    np.copyto(out, result)
    return out


NOT_IN_PLACE = frozenset({"if_else_zero", "remainder", "sign"})


@dataclass(frozen=True, slots=True)
class NumpyProgram:
    """Generated functions for one pattern of inputs that are the same in all rows.

    `source` is the Python text they come from, `registers` the number of buffers a block needs.
    """

    source: str
    registers: int
    rows_per_block: int
    uniform: Callable[..., Sequence[Any]]
    block: Callable[..., None]

    def run(self, inputs: Sequence[Array], outputs: Sequence[Array]) -> None:
        """Fill `outputs`, each (n_out_k, N) with contiguous rows.

        Inputs are (n_in_k,) where the program takes them as uniform, (N, n_in_k) elsewhere.
        """
        rows = outputs[0].shape[1] if outputs else 0
        if rows == 0:
            return
        size = min(self.rows_per_block, rows)
        registers = [np.empty(size) for _ in range(self.registers)]
        varying = [array for array in inputs if array.ndim == 2]
        copies = [np.empty((array.shape[1], size)) for array in varying]
        with np.errstate(all="ignore"):
            scalars = self.uniform(*(array.tolist() for array in inputs if array.ndim == 1))
            for start in range(0, rows, size):
                stop = min(start + size, rows)
                if stop - start < size:
                    registers = [register[: stop - start] for register in registers]
                    copies = [copy[:, : stop - start] for copy in copies]
                columns: list[Array] = []
                for array, copy in zip(varying, copies, strict=True):
                    if array.strides[0] == array.itemsize:
                        columns.extend(array[start:stop].T)
                    else:
                        np.copyto(copy, array[start:stop].T)
                        columns.extend(copy)
                ends = [row for output in outputs for row in output[:, start:stop]]
                self.block(columns, scalars, registers, ends)


@cache
def tangent_is_vectorised() -> bool:
    """Whether this NumPy on this machine has a vectorised float64 tangent (eight times a sine's speed)."""
    introspect = getattr(np.lib, "introspect", None)
    if introspect is None:
        return False
    info = introspect.opt_func_info(func_name="^tan$").get("tan", {}).get("dd", {})
    return "baseline" not in info.get("current", "baseline")


def numpy_program(tape: Tape, uniform_inputs: Sequence[bool]) -> NumpyProgram:
    """Program of `tape` where `uniform_inputs` says which inputs are the same in all rows."""
    if tangent_is_vectorised():
        tape = with_half_angles(tape)
    uniform = tape.uniform_nodes(uniform_inputs)
    source, registers = _source(tape, uniform_inputs, uniform)
    columns = sum(size for size, same in zip(tape.input_sizes, uniform_inputs, strict=True) if not same) + sum(
        tape.output_sizes
    )
    space = {name: getattr(np, name) for name in set(UFUNCS.values())}
    space |= {"erf": special.erf, "copyto": np.copyto, "float64": np.float64}
    space |= {"NAN": np.nan, "INFINITY": np.inf, "__builtins__": {}}
    space |= {"if_else_zero": _if_else_zero, "remainder": _remainder, "sign": _sign}
    exec(compile(source, "<linkwright tape>", "exec"), space)
    rows = BLOCK_BYTES // (8 * max(1, registers + columns))
    rows = max(1024, min(8192, rows // 256 * 256))
    return NumpyProgram(source, registers, rows, space["uniform"], space["block"])


def _call(op: str, args: Sequence[str], out: str) -> str:
    """Text of one step; `out` is empty for a scalar."""
    if op == "twice":
        op, args = "add", (args[0], args[0])
    return f"{UFUNCS.get(op, op)}({', '.join(args)}{', ' + out if out else ''})"


class _Registers:
    """Buffers of a block, reused as soon as their values are no longer needed."""

    def __init__(self) -> None:
        self.count = 0
        self._free: list[str] = []

    def take(self) -> str:
        """A buffer that is free."""
        if self._free:
            return self._free.pop()
        self.count += 1
        return f"r{self.count - 1}"

    def release(self, names: Sequence[str]) -> None:
        """Buffers whose values are no longer needed."""
        self._free.extend(names)


def _source(tape: Tape, uniform_inputs: Sequence[bool], uniform: Sequence[bool]) -> tuple[str, int]:
    """Python text of the two functions, and the number of registers."""
    last_use = {arg: position for position, node in enumerate(tape.nodes) for arg in node.args}
    ends = [node for output in tape.outputs for node in output]
    place = {node: f"o{k}" for k, node in reversed(list(enumerate(ends)))}
    column_of = _columns(tape, uniform_inputs)
    name: dict[int, str] = {}
    scalar_lines: list[str] = []
    scalars: list[str] = []
    lines: list[str] = []
    registers = _Registers()

    def step(position: int, node: Node) -> None:
        """One step of a block: into its output, or a register."""
        ended = sorted(a for a in set(node.args) if last_use[a] == position and name[a].startswith("r"))
        in_place = node.op not in NOT_IN_PLACE
        args, done = [name[arg] for arg in node.args], [name[arg] for arg in ended]
        registers.release(done if in_place else ())
        name[position] = place[position] if position in place else registers.take()
        registers.release(() if in_place else done)
        lines.append("    " + _call(node.op, args, name[position]))

    for position, node in enumerate(tape.nodes):
        if node.op == "const":
            name[position] = literal(node.value)
        elif node.op == "input" and not uniform[position]:
            name[position] = f"c{column_of[node.source]}"
        elif uniform[position]:
            args = [name[arg] for arg in node.args]
            name[position] = f"u{position}"
            value = "a{}[{}]".format(*node.source) if node.op == "input" else _call(node.op, args, "")
            scalar_lines.append(f"    u{position} = float64({value})")
            scalars.append(name[position])
        else:
            step(position, node)
    lines += [f"    copyto(o{k}, {name[node]})" for k, node in enumerate(ends) if name[node] != f"o{k}"]
    return _text(uniform_inputs, scalar_lines, scalars, len(column_of), registers.count, len(ends), lines)


def _text(
    uniform_inputs: Sequence[bool],
    scalar_lines: Sequence[str],
    scalars: Sequence[str],
    columns: int,
    registers: int,
    ends: int,
    lines: Sequence[str],
) -> tuple[str, int]:
    """The two functions around their lines, and the number of registers."""
    head = [f"a{k}" for k, same in enumerate(uniform_inputs) if same]
    text = [f"def uniform({', '.join(head)}):", *scalar_lines, f"    return {_tuple(scalars)}", ""]
    text.append("def block(columns, scalars, registers, ends):")
    unpacked = (
        ("columns", [f"c{k}" for k in range(columns)]),
        ("scalars", scalars),
        ("registers", [f"r{k}" for k in range(registers)]),
        ("ends", [f"o{k}" for k in range(ends)]),
    )
    text.extend(f"    {_tuple(names)} = {source}" for source, names in unpacked if names)
    text.extend([*lines, "    return None", ""])
    return "\n".join(text), registers


def _columns(tape: Tape, uniform_inputs: Sequence[bool]) -> dict[tuple[int, int], int]:
    """Number of the column that holds each component of the inputs that vary from row to row."""
    sources = [
        (k, j)
        for k, (size, same) in enumerate(zip(tape.input_sizes, uniform_inputs, strict=True))
        if not same
        for j in range(size)
    ]
    return {source: column for column, source in enumerate(sources)}


def _tuple(names: Sequence[str]) -> str:
    return f"({', '.join(names)}{',' if names else ''})"
