"""The singular values of a tall matrix."""

from __future__ import annotations

import numpy as np
from scipy.linalg import svd

from benchmarks.real.textbook.chain import Array


def thin_svd(matrix: Array) -> tuple[Array, Array, Array]:
    """Left vectors (N, k), values (k,) and right vectors (k, k) of a matrix (N, k).

    By way of its triangle, and not by LAPACK's divide and conquer, which fails to converge on some columns that depend
    on each other.
    """
    basis, triangle = np.linalg.qr(matrix)
    left, values, right = svd(triangle, full_matrices=False, lapack_driver="gesvd")
    return basis @ left, np.asarray(values, dtype=float), np.asarray(right, dtype=float)
