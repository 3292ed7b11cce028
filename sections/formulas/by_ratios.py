"""Properties of a shape by its outline, kept by the ratios of its dimensions and fitted to one of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Protocol, TypeAlias

import numpy as np

from linkwright.core.sections.formulas.outlines import Fit, Outlined, about_centroid, fit
from linkwright.core.sections.numeric import Array, Number, is_symbol

FITTED = 2
"""Dimensions of a shape whose properties are fitted."""
_THINNEST, _SLIMMEST = 0.0125, 10.0
"""Down to which wall over its size, and up to which ratio of outer sizes, they are."""


class Drawn(Protocol):
    """A section that has an outline."""

    def outline(self) -> list[Array]:
        """Closed polylines, m."""
        ...


Kind: TypeAlias = Callable[..., Drawn]
"""What makes a section of its dimensions (m) by name."""


def fitted_range(part: str, most_wall: float) -> tuple[float, float]:
    """The ratios of a dimension of that kind to the first at which an outline is fitted."""
    return (_THINNEST, most_wall) if part == "wall" else (1.0 / _SLIMMEST, _SLIMMEST)


def figures_by_ratios(
    kind: Kind, size: str, ratios: Mapping[str, Number], span: tuple[float, float] | None
) -> Mapping[str, Number] | None:
    """The figures (`Outlined.figures`) of a shape whose dimension `size` is one and whose others have these ratios to
    it: fitted where one ratio lies in the span, else each solved by itself; None for symbols that are not fitted."""
    names, values = tuple(ratios), tuple(ratios.values())
    if any(is_symbol(value) for value in values):
        return None if span is None else _fit(kind, size, names[0], span).at(values[0])
    table = np.stack(np.broadcast_arrays(*values), axis=-1) if values else np.zeros(0)
    if span is not None and np.all((table >= span[0]) & (table <= span[1])):
        return _fit(kind, size, names[0], span).at(values[0])
    if table.ndim == 1:
        return _solved(kind, size, names, _rounded(table))
    rows = [_solved(kind, size, names, _rounded(row)) for row in table.reshape(-1, len(names))]
    return {name: np.array([row[name] for row in rows]).reshape(table.shape[:-1]) for name in rows[0]}


def _rounded(ratios: Array) -> tuple[float, ...]:
    return tuple(float(f"{ratio:.9g}") for ratio in ratios.tolist())


@lru_cache(maxsize=4096)
def _solved(kind: Kind, size: str, names: tuple[str, ...], ratios: tuple[float, ...]) -> Mapping[str, float]:
    section = kind(**{size: 1.0}, **dict(zip(names, ratios, strict=True)))
    return Outlined(about_centroid([loop[:-1] for loop in section.outline()])).figures


@lru_cache(maxsize=64)
def _fit(kind: Kind, size: str, name: str, span: tuple[float, float]) -> Fit:
    return fit(lambda ratio: _solved(kind, size, (name,), (ratio,)), *span)
