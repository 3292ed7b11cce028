"""Functions of many rows in C, where a compiler stands ready; alike to `arm.compiled.vectorise` in all else."""

from __future__ import annotations

import os
from collections.abc import Sequence
from threading import Lock

import casadi as ca
import numpy as np

from linkwright.core.arm.compiled.tape import Tape, read_tape
from linkwright.core.arm.compiled.vectorise import Pattern, VectorFunction
from linkwright.core.sections.numeric import Array

from .c_build import Library, build
from .c_code import BLOCK, c_source

MOST_THREADS = 2


class CompiledFunction(VectorFunction):
    """A function of many rows in C; made by `compiled`, safe to call from several threads.

    Sines and cosines are within 2e-16 (absolute) of the exact values; blocks with angles too far for that are left to
    the NumPy code.
    """

    def __init__(self, tape: Tape, threads: int) -> None:
        super().__init__(tape)
        self._threads = threads
        self._building = Lock()
        self._libraries: dict[Pattern, Library] = {}
        self._library((False,) * len(tape.input_sizes))

    def _run(self, pattern: Pattern, inputs: list[Array], outputs: list[Array]) -> None:
        inputs = [_aligned(array) for array in inputs]
        far = self._library(pattern).run(inputs, outputs, self._threads)
        for block in np.flatnonzero(far).tolist():
            span = slice(block * BLOCK, (block + 1) * BLOCK)
            part = [array[span] if array.ndim == 2 else array for array in inputs]
            super()._run(pattern, part, [output[:, span] for output in outputs])

    def _library(self, pattern: Pattern) -> Library:
        with self._building:
            if pattern not in self._libraries:
                self._libraries[pattern] = build(c_source(self._tape, pattern))
            return self._libraries[pattern]


def compiled(inputs: Sequence[ca.SX], outputs: Sequence[ca.SX], *, threads: int | None = None) -> CompiledFunction:
    """Function that evaluates `outputs` for many rows of values of `inputs`, as `vectorise` does, compiled now.

    `threads`: by default two, or one where there is one processor. Raises what `vectorise` raises, and `CompilerError`
    where compiled code cannot be had.
    """
    if threads is not None and threads < 1:
        raise ValueError(f"threads must be at least 1, not {threads}")
    return CompiledFunction(read_tape(inputs, outputs), threads or min(MOST_THREADS, _processors()))


def _processors() -> int:
    """Processors this process may use."""
    affinity = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity is not None else os.cpu_count() or 1


def _aligned(array: Array) -> Array:
    """The array, or a copy if its strides are not whole numbers of its items."""
    odd = any(stride % array.itemsize for stride in array.strides) or not array.flags.aligned
    return array.copy() if odd else array
