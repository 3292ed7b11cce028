"""Plastic section moduli: the moment at which the whole section yields, over the yield strength.

The plastic modulus about an axis is the integral of the distance from the line, parallel to that axis, which halves
the area. That line minimises the integral, so it need not be known beforehand: the least value over one candidate
per layer is it. Where a section is symmetric about neither axis these are the moduli for a stress that changes sign
along a line parallel to y or z.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from linkwright.core.sections.numeric import Number, absolute, maximum, minimum


def layered_modulus(layers: Sequence[tuple[Number, Number]]) -> Number:
    """Plastic modulus of rectangles stacked on one another, (width, thickness) each from the bottom up (m), in m^3."""
    area = sum(width * thickness for width, thickness in layers)
    candidates: list[Number] = []
    bottom: Number = 0.0
    below: Number = 0.0
    for width, thickness in layers:
        candidates.append(bottom + minimum(maximum((0.5 * area - below) / width, 0.0), thickness))
        bottom, below = bottom + thickness, below + width * thickness
    least: Number = None
    for line in candidates:
        total = _distance_integral(layers, line)
        least = total if least is None else minimum(least, total)
    return least


def _distance_integral(layers: Sequence[tuple[Number, Number]], line: Number) -> Number:
    total: Number = 0.0
    bottom: Number = 0.0
    for width, thickness in layers:
        low, high = bottom - line, bottom + thickness - line
        total = total + 0.5 * width * (high * absolute(high) - low * absolute(low))
        bottom = bottom + thickness
    return total


def polygon_modulus(loops: Sequence[NDArray[np.float64]], axis: int) -> float:
    """Plastic modulus of the region left of the loops for bending about y (``axis`` 1) or z (``axis`` 0), m^3."""
    start = np.vstack(loops)[:, ::-1] if axis == 0 else np.vstack(loops)
    turned = [np.roll(loop, -1, axis=0) for loop in loops]
    end = np.vstack(turned)[:, ::-1] if axis == 0 else np.vstack(turned)
    sign = -1.0 if axis == 0 else 1.0

    def integrals(line: float) -> tuple[float, float]:
        """Area below the line less that above, and the integral of the distance from it."""
        y0, z0, y1, z1 = start[:, 0], start[:, 1] - line, end[:, 0], end[:, 1] - line
        crosses = z0 * z1 < 0.0
        share = np.where(crosses, z0 / np.where(crosses, z0 - z1, 1.0), 1.0)
        ym = y0 + share * (y1 - y0)
        zm = np.where(crosses, 0.0, z1)
        balance = distance = 0.0
        for ya, za, yb, zb in ((y0, z0, ym, zm), (ym, zm, y1, z1)):
            side = np.sign(za + zb)
            balance -= float((side * 0.5 * (ya + yb) * (zb - za)).sum())
            distance += float((side * (zb - za) * (2 * ya * za + ya * zb + yb * za + 2 * yb * zb) / 6.0).sum())
        return sign * balance, sign * distance

    low, high = float(start[:, 1].min()), float(start[:, 1].max())
    for _ in range(60):
        middle = 0.5 * (low + high)
        if integrals(middle)[0] < 0.0:
            low = middle
        else:
            high = middle
    return integrals(0.5 * (low + high))[1]
