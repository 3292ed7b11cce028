"""One thread of linear algebra: what Linkwright multiplies is small, and threads that wait for each other beside other
work cost several times what they save."""

from __future__ import annotations

import os
from collections.abc import Generator
from contextlib import contextmanager

from threadpoolctl import threadpool_info, threadpool_limits

VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""What libraries read while they are loaded."""
_LINEAR_ALGEBRA = "blas"


@contextmanager
def one_thread() -> Generator[None]:
    """The libraries that are loaded take one thread meanwhile; afterwards what they took before."""
    with threadpool_limits(1, user_api=_LINEAR_ALGEBRA):
        yield


@contextmanager
def one_thread_for_children() -> Generator[None]:
    """Processes started meanwhile have one thread: fresh ones read it in their environment (where that says nothing
    else), forked ones have the libraries as they are in their parent."""
    added = [name for name in VARIABLES if name not in os.environ]
    os.environ.update(dict.fromkeys(added, "1"))
    try:
        with one_thread():
            yield
    finally:
        for name in added:
            os.environ.pop(name, None)


def threads() -> list[int]:
    """How many threads each library of linear algebra that is loaded takes."""
    return [int(item["num_threads"]) for item in threadpool_info() if item["user_api"] == _LINEAR_ALGEBRA]
