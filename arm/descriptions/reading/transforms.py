"""Transforms (4, 4) and turns (3, 3) of what stands in a description."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from linkwright.core.arm.chain.vectors import about
from linkwright.core.sections.numeric import Array


def transform(rotation: Array | Sequence[Sequence[float]], translation: Sequence[float] | Array) -> Array:
    """A rotation (3, 3) and a shift as one matrix (4, 4)."""
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = np.asarray(rotation, dtype=float), np.asarray(translation, dtype=float)
    return matrix


def turned(axis: Array, angle: float) -> Array:
    """A turn (3, 3) about an axis."""
    x, y, z = (float(item) for item in axis / np.linalg.norm(axis))
    return np.array(about((x, y, z), math.cos(angle), math.sin(angle)), dtype=float)


def about_line(axis: Array, point: Array, angle: float) -> Array:
    """A turn (4, 4) about a line through a point."""
    rotation = turned(axis, angle)
    return transform(rotation, point - rotation @ point)
