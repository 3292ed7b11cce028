"""Symbolic expressions as fast functions of many rows at once.

A formula is written once, as a CasADi SX expression, for the optimiser.  A scan over a million poses asks
for its values row by row, where CasADi's interpreter is slow.  `vectorise` turns the expression into NumPy
source that works through the rows in blocks, and into C where a compiler stands ready and the job is large.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from threading import Lock
from typing import Literal

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from .compile_c import BLOCK, c_source
from .compile_library import CompilerError, Library, build
from .compile_numpy import NumpyProgram, numpy_program
from .compile_tape import Tape, UnsupportedOperation, read_tape
from .compile_trig import NotQuadratic, TrigQuadratic

__all__ = [
    "CompilerError",
    "NotQuadratic",
    "TrigQuadratic",
    "UnsupportedOperation",
    "VectorFunction",
    "vectorise",
]

Array = NDArray[np.float64]
Compiler = Literal["auto", "never", "require"]
Pattern = tuple[bool, ...]

ROWS_WORTH_COMPILING = 200_000
"""With compiler="auto", nothing is compiled before a call asks for this many rows."""

MOST_THREADS = 2


class VectorFunction:
    """A function of many rows; made by `vectorise`, safe to call from several threads.

    NumPy's sines and cosines are within 4e-16 (absolute) of the exact values, those of the C code within
    2e-16; all else rounds as CasADi's own evaluation does, up to the last digits of library functions.
    NaN and infinities are those of `ca.cse(outputs)` too (which takes y - y for 0), but for the sign of a
    NaN and the sign of fmin and fmax of two zeros.
    """

    def __init__(self, tape: Tape, compiler: Compiler, threads: int) -> None:
        self._tape = tape
        self._compiler: Compiler = compiler
        self._threads = threads
        self._lock = Lock()
        self._programs: dict[Pattern, NumpyProgram] = {}
        self._libraries: dict[Pattern, Library] = {}
        self._why = {
            "never": "compiler='never'",
            "auto": f"no call with {ROWS_WORTH_COMPILING} rows yet",
            "require": "",
        }[compiler]
        self._given_up = compiler == "never"
        if compiler == "require":
            self._library((False,) * len(tape.input_sizes), ROWS_WORTH_COMPILING)

    @property
    def backend(self) -> Literal["numpy", "c"]:
        """What large calls run on: "c" once compiled code is loaded, "numpy" before or without it."""
        return "c" if self._libraries else "numpy"

    @property
    def why(self) -> str:
        """Why the backend is NumPy; empty where it is C."""
        return "" if self._libraries else self._why

    def __call__(self, *arrays: ArrayLike) -> tuple[Array, ...]:
        """Values in every row: a tuple with one float64 array of shape (N, n_out_k) for each output.

        Each argument is (N, n_in_k), or (n_in_k,) for the same values in all rows; if all are of the latter
        kind, N is 1.  The results are stored column by column (Fortran order).  Raises `ValueError` if
        the number of arguments, a shape or the numbers of rows do not fit, and `CompilerError` only where
        compiled code was required.
        """
        inputs, rows = self._checked(arrays)
        outputs = [np.empty((size, rows)) for size in self._tape.output_sizes]
        pattern = tuple(array.ndim == 1 for array in inputs)
        library = self._library(pattern, rows)
        if library is None:
            self._program(pattern).run(inputs, outputs)
        else:
            inputs = [_aligned(array) for array in inputs]
            for block in np.flatnonzero(library.run(inputs, outputs, self._threads)).tolist():
                span = slice(block * BLOCK, (block + 1) * BLOCK)
                part = [array[span] if array.ndim == 2 else array for array in inputs]
                self._program(pattern).run(part, [output[:, span] for output in outputs])
        return tuple(output.T for output in outputs)

    def _program(self, pattern: Pattern) -> NumpyProgram:
        with self._lock:
            if pattern not in self._programs:
                self._programs[pattern] = numpy_program(self._tape, pattern)
            return self._programs[pattern]

    def _library(self, pattern: Pattern, rows: int) -> Library | None:
        """Compiled code for this pattern of inputs, made if the job is worth it; None: use NumPy."""
        library = self._libraries.get(pattern)
        if library is not None or self._given_up:
            return library
        if self._compiler == "auto" and rows < ROWS_WORTH_COMPILING:
            return None
        with self._lock:
            if pattern not in self._libraries and not self._given_up:
                try:
                    self._libraries[pattern] = build(c_source(self._tape, pattern))
                except (CompilerError, UnsupportedOperation) as error:
                    if self._compiler == "require":
                        raise
                    self._given_up, self._why = True, str(error)
            return self._libraries.get(pattern)

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


def vectorise(
    inputs: Sequence[ca.SX],
    outputs: Sequence[ca.SX],
    *,
    compiler: Compiler = "auto",
    threads: int | None = None,
) -> VectorFunction:
    """Function that evaluates `outputs` for many rows of values of `inputs`.

    Inputs are SX columns of symbols, outputs SX columns (or scalars) that depend on no other symbol.
    `compiler`: "auto" compiles C code at the first call with 200,000 rows or more and stays with NumPy if
    that fails, "never" stays with NumPy, "require" compiles now.  `threads` (compiled code, many rows):
    by default two, or one where there is one processor.

    Raises `ValueError` for a shape or symbol that does not fit, `UnsupportedOperation` (a `ValueError`)
    for an operation without a vectorised form, named in the message, and `CompilerError` if required
    code cannot be had.
    """
    if compiler not in ("auto", "never", "require"):
        raise ValueError(f"compiler must be 'auto', 'never' or 'require', not {compiler!r}")
    if threads is not None and threads < 1:
        raise ValueError(f"threads must be at least 1, not {threads}")
    return VectorFunction(read_tape(inputs, outputs), compiler, threads or min(MOST_THREADS, _processors()))


def _processors() -> int:
    """Processors this process may use."""
    affinity = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity is not None else os.cpu_count() or 1


def _aligned(array: Array) -> Array:
    """The array, or a copy if its strides are not whole numbers of its items."""
    odd = any(stride % array.itemsize for stride in array.strides) or not array.flags.aligned
    return array.copy() if odd else array
