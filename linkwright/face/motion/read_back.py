"""Verification of a motion or log that was written: read back and compared."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

_ROUNDED = 1e-5
"""The share of the largest figure by which one may differ that is read back: files of motions hold seven digits."""


def unlike_arrays(meant: object, back: object, *names: str) -> Iterator[str]:
    """The attributes (arrays of any shape, SI) in which what was read back is not what was meant."""
    for name in names:
        ours, theirs = (np.asarray(getattr(item, name), dtype=float) for item in (meant, back))
        bound = _ROUNDED * max(1.0, float(np.abs(ours).max(initial=0.0)))
        if ours.shape != theirs.shape or not np.allclose(ours, theirs, rtol=0.0, atol=bound):
            yield f"another {name}"
