"""One thread of linear algebra for each worker: workers with a thread for every core only disturb each other."""

from __future__ import annotations

import ctypes
import os
import re
from collections.abc import Callable, Generator
from contextlib import contextmanager
from pathlib import Path

VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""What libraries read while they are loaded."""
_LIBRARY = re.compile(r"(/\S*openblas\S*)$")
# Names that end in an underscore after that are Fortran's, and take pointers.
_NAMES = tuple(
    (f"{before}openblas_get_num_threads{after}", f"{before}openblas_set_num_threads{after}")
    for before in ("", "scipy_")
    for after in ("", "64_")
)


@contextmanager
def one_thread_for_children() -> Generator[None]:
    """Processes started meanwhile have one thread: fresh ones read it in their environment (where that says nothing
    else), forked ones have the libraries as they are in their parent."""
    added = [name for name in VARIABLES if name not in os.environ]
    os.environ.update(dict.fromkeys(added, "1"))
    libraries = loaded()
    before = [get() for get, _ in libraries]
    for _, put in libraries:
        put(1)
    try:
        yield
    finally:
        for name in added:
            os.environ.pop(name, None)
        for (_, put), number in zip(libraries, before, strict=True):
            put(number)


def loaded() -> list[tuple[Callable[[], int], Callable[[int], None]]]:
    """What reads and sets the number of threads of each OpenBLAS that this process has loaded; none elsewhere than on
    Linux, where nothing is forked."""
    try:
        maps = Path("/proc/self/maps").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return []
    found: list[tuple[Callable[[], int], Callable[[int], None]]] = []
    for path in sorted({hit.group(1) for line in maps.splitlines() if (hit := _LIBRARY.search(line))}):
        try:
            library = ctypes.CDLL(path)
        except OSError:  # taken away since
            continue
        for get, put in _NAMES:
            if hasattr(library, get) and hasattr(library, put):
                found.append((getattr(library, get), getattr(library, put)))
    return found
