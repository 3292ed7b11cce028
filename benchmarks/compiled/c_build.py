"""C source to a loaded function: the compiler that is found, its cache, and the call through ctypes.

A library is kept in the user's cache folder under a hash of the source, the flags, and all macros the
compiler predefines with these flags: those tell its version and what the processor can do.
"""

from __future__ import annotations

import ctypes
import hashlib
import os
import platform
import shlex
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from platformdirs import user_cache_dir

from linkwright.core.sections.numeric import Array

from .c_code import BLOCK, ENTRY

SWITCH = "LINKWRIGHT_NO_COMPILER"
"""Environment variable that, set to anything but nothing or 0, keeps every compiler out."""

# No -ffast-math and no contraction: NaN, infinities and the sign of x*x - y*y stay what CasADi makes them.
FLAGS = ("-std=gnu11", "-O3", "-fPIC", "-fno-math-errno", "-fno-trapping-math", "-ffp-contract=off")
MACHINE_FLAGS = (("-march=native", "-mprefer-vector-width=512"), ("-march=native",), ("-mcpu=native",), ())
ROWS_PER_THREAD = 50_000
SECONDS = 120.0


class CompilerError(RuntimeError):
    """There is no C compiler, or it did not do its work; the message says why."""


@dataclass(frozen=True, slots=True)
class Library:
    """A compiled tape; `path` is the file it was loaded from."""

    path: Path
    entry: Any

    def run(self, inputs: Sequence[Array], outputs: Sequence[Array], threads: int) -> NDArray[np.bool_]:
        """Fill `outputs`, each (n_out_k, N) with contiguous rows, from inputs (n_in_k,) or (N, n_in_k).

        Gives for each block of BLOCK rows whether an angle in it was too far for the inline sine and
        cosine, so that its rows have to be computed in another way.
        """
        rows = outputs[0].shape[1] if outputs else 0
        blocks = -(-rows // BLOCK)
        far = np.zeros(blocks, dtype=np.uint8)
        parts = max(1, min(threads, rows // ROWS_PER_THREAD))
        bounds = [blocks * part // parts * BLOCK for part in range(parts)] + [rows]
        spans = list(pairwise(bounds))
        if parts == 1:
            self._span(inputs, outputs, far, 0, rows)
        else:
            with ThreadPoolExecutor(parts) as pool:
                for done in [pool.submit(self._span, inputs, outputs, far, *span) for span in spans]:
                    done.result()
        return far.astype(np.bool_)

    def _span(
        self, inputs: Sequence[Array], outputs: Sequence[Array], far: NDArray[np.uint8], start: int, stop: int
    ) -> None:
        if stop <= start:
            return
        item = np.dtype(np.float64).itemsize
        steps = [array.strides[0] if array.ndim == 2 else 0 for array in inputs]
        starts = [array.ctypes.data + start * step for array, step in zip(inputs, steps, strict=True)]
        self.entry(
            ctypes.c_int64(stop - start),
            _addresses(starts),
            _integers([step // item for step in steps]),
            _integers([array.strides[-1] // item for array in inputs]),
            _addresses([array.ctypes.data + start * item for array in outputs]),
            _integers([array.strides[0] // item for array in outputs]),
            ctypes.c_void_p(far.ctypes.data + start // BLOCK),
        )


def build(source: str) -> Library:
    """Library of `source`, from the cache or compiled now; raises `CompilerError`."""
    switch = os.environ.get(SWITCH, "")
    if switch not in ("", "0"):
        raise CompilerError(f"{SWITCH}={switch} is set")
    try:
        command, flags, identity = _compiler()
        key = hashlib.sha256("\0".join((source, *command, *flags, identity)).encode()).hexdigest()[:40]
        folder = Path(user_cache_dir("linkwright")) / "compiled"
        path = folder / f"{key}.so"
        if path.exists():
            try:
                return _loaded(path)
            except (OSError, AttributeError):
                pass  # A damaged file: make it anew.
        folder.mkdir(parents=True, exist_ok=True)
        # Built beside its place and moved there in one step: whoever looks sees all of it or nothing.
        with tempfile.TemporaryDirectory(dir=folder) as work:
            text, made = Path(work) / "tape.c", Path(work) / "tape.so"
            text.write_text(source, encoding="utf-8")
            _run([*command, *flags, "-shared", "-o", str(made), str(text), "-lm"])
            os.replace(made, path)
        return _loaded(path)
    except (OSError, AttributeError) as error:
        raise CompilerError(f"{type(error).__name__}: {error}") from error


def _compiler() -> tuple[list[str], list[str], str]:
    """Command, flags, and a text that differs between versions of the compiler and kinds of processor."""
    named = shlex.split(os.environ.get("CC", ""))
    candidates = [named] if named else [[name] for name in ("cc", "gcc", "clang")]
    command = next((words for words in candidates if shutil.which(words[0])), None)
    if command is None:
        raise CompilerError(f"no C compiler found (looked for {', '.join(words[0] for words in candidates)})")
    why = ""
    for machine_flags in MACHINE_FLAGS:
        flags = [*FLAGS, *machine_flags]
        try:
            macros = _run([*command, *flags, "-dM", "-E", "-x", "c", os.devnull])
        except CompilerError as error:
            why = str(error)
            continue
        return command, flags, f"{platform.system()} {platform.machine()}\n{macros}"
    raise CompilerError(why)


def _run(words: list[str]) -> str:
    """Standard output of a command; raises `CompilerError` with what it complained of."""
    try:
        done = subprocess.run(
            words, capture_output=True, text=True, timeout=SECONDS, check=True, stdin=subprocess.DEVNULL
        )
    except subprocess.CalledProcessError as error:
        complaint = (error.stderr or "").strip()[-500:]
        raise CompilerError(f"{words[0]} failed ({error.returncode}): {complaint}") from error
    except subprocess.TimeoutExpired as error:
        raise CompilerError(f"{words[0]} took more than {SECONDS:.0f} s") from error
    return done.stdout


def _loaded(path: Path) -> Library:
    entry = getattr(ctypes.CDLL(str(path)), ENTRY)
    entry.restype = None
    return Library(path, entry)


def _addresses(values: Sequence[int]) -> Any:
    return (ctypes.c_void_p * max(1, len(values)))(*values)


def _integers(values: Sequence[int]) -> Any:
    return (ctypes.c_int64 * max(1, len(values)))(*values)
