"""Robust scale: the Qn of P. J. Rousseeuw and C. Croux, and the resolution to which numbers were written."""

from __future__ import annotations

import numpy as np

from linkwright.core.sections.numeric import Array

HUBER = 2.5
"""Scatters beyond which a reading weighs less (P. J. Huber), or counts as that far off."""
_MOST = 1500
"""Values whose pairs are all compared."""
_QN = 2.21914
_SMALL = (0.399, 0.994, 0.512, 0.844, 0.611, 0.857, 0.669, 0.872)


def qn(values: Array) -> float:
    """The robust scale Qn of at least two values: the standard deviation where they are Gaussian.

    P. J. Rousseeuw, C. Croux, J. Am. Stat. Assoc. 88 (1993) 1273, doi:10.1080/01621459.1993.10476408; factors for small
    samples from C. Croux, P. J. Rousseeuw, COMPSTAT 1992, p. 411. Half of the values may be wrong. Of more than
    1500 an even share is taken, because all their pairs are compared.
    """
    if len(values) > _MOST:
        values = values[np.linspace(0, len(values) - 1, _MOST).astype(int)]
    count = len(values)
    half = count // 2 + 1
    rank = half * (half - 1) // 2
    first, second = np.triu_indices(count, 1)
    apart = np.abs(values[first] - values[second])
    quantile = float(np.partition(apart, rank - 1)[rank - 1])
    large = count / (count + 1.4) if count % 2 else count / (count + 3.8)
    return _QN * (_SMALL[count - 2] if count <= 9 else large) * quantile


def resolution(values: Array) -> float | None:
    """The coarsest step 1, 2, 2.5 or 5 times a power of ten (SI) that all values are multiples of, None where there is
    none above 1e-10 or all values are the same."""
    largest = float(np.abs(values).max(initial=0.0))
    if not len(values) or np.ptp(values) == 0.0:
        return None
    for power in range(11):
        for lead in (5.0, 2.5, 2.0, 1.0):
            step = lead * 10.0 ** -(power + 1)
            if largest / step > 1e11:
                return None
            counts = values / step
            # What lies within a hair of zero is a multiple of nothing: some values must be steps apart.
            if np.ptp(np.round(counts)) > 0.0 and np.all(np.abs(counts - np.round(counts)) < 1e-4):
                return step
    return None
