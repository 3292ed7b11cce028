"""Symbolic expressions as fast functions of many rows at once.

A formula is written once, as a CasADi SX expression, for the optimiser.  A scan over a million poses asks
for its values row by row, where CasADi's interpreter is slow.  `vectorise` turns the expression into NumPy
source that works through the rows in blocks.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from threading import Lock
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from linkwright.core.arm.compiled.numpy_code import NumpyProgram, numpy_program
from linkwright.core.arm.compiled.tape import Tape, read_tape
from linkwright.core.sections.numeric import Array

Pattern = tuple[bool, ...]


class VectorFunction:
    """A function of many rows; made by `vectorise`, safe to call from several threads.

    NumPy's sines and cosines are within 4e-16 (absolute) of the exact values; all else rounds as CasADi's
    evaluation does, up to the last digits of library functions. NaN and infinities are those of `ca.cse(outputs)` too
    (which takes y - y for 0), but for the sign of a NaN and the sign of fmin and fmax of two zeros.
    """

    def __init__(self, tape: Tape) -> None:
        self._tape = tape
        self._lock = Lock()
        self._programs: dict[Pattern, NumpyProgram] = {}

    def __call__(self, *arrays: ArrayLike) -> tuple[Array, ...]:
        """Values in every row: a tuple with one float64 array of shape (N, n_out_k) for each output.

        Each argument is (N, n_in_k), or (n_in_k,) for the same values in all rows; if all are of the latter
        kind, N is 1.  The results are stored column by column (Fortran order).  Raises `ValueError` if
        the number of arguments, a shape or the numbers of rows do not fit.
        """
        inputs, rows = self._checked(arrays)
        outputs = [np.empty((size, rows)) for size in self._tape.output_sizes]
        pattern = tuple(array.ndim == 1 for array in inputs)
        self._run(pattern, inputs, outputs)
        return tuple(output.T for output in outputs)

    def _run(self, pattern: Pattern, inputs: list[Array], outputs: list[Array]) -> None:
        """Fill `outputs`, each (n_out, rows); `pattern` says which inputs are the same in all rows."""
        self._program(pattern).run(inputs, outputs)

    def _program(self, pattern: Pattern) -> NumpyProgram:
        with self._lock:
            if pattern not in self._programs:
                self._programs[pattern] = numpy_program(self._tape, pattern)
            return self._programs[pattern]

    def _checked(self, arrays: Sequence[ArrayLike]) -> tuple[list[Array], int]:
        """Arguments as float64 arrays, and the number of rows."""
        sizes = self._tape.input_sizes
        if len(arrays) != len(sizes):
            raise ValueError(f"{len(arrays)} arguments given, {len(sizes)} needed")
        inputs = [np.asarray(array, dtype=np.float64) for array in arrays]
        for k, (array, size) in enumerate(zip(inputs, sizes, strict=True)):
            if array.ndim not in (1, 2) or array.shape[-1] != size:
                raise ValueError(f"argument {k} has shape {array.shape}; (N, {size}) or ({size},) is needed")
        counts = {len(array) for array in inputs if array.ndim == 2}
        if len(counts) > 1:
            raise ValueError(f"arguments differ in their number of rows: {sorted(counts)}")
        return inputs, counts.pop() if counts else 1


def vectorise(inputs: Sequence[ca.SX], outputs: Sequence[ca.SX]) -> VectorFunction:
    """Function that evaluates `outputs` for many rows of values of `inputs`.

    Inputs are SX columns of symbols, outputs SX columns (or scalars) that depend on no other symbol.

    Raises `ValueError` for a shape or symbol that does not fit, and `UnsupportedOperation` (a `ValueError`) for an
    operation without a vectorised form, named in the message.
    """
    return VectorFunction(read_tape(inputs, outputs))


@dataclass(frozen=True)
class Expressions:
    """`outputs` (columns) for symbols: `inputs` are a pose q, a design p and what else they depend on."""

    inputs: tuple[Any, ...]
    outputs: tuple[Any, ...]

    @cached_property
    def function(self) -> Any:
        """The CasADi function from inputs to outputs."""
        return ca.Function("expressions", list(self.inputs), list(self.outputs))

    @cached_property
    def vectorised(self) -> VectorFunction:
        """The same for many poses or designs."""
        return vectorise(self.inputs, self.outputs)
