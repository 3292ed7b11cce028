"""Polynomials with the least greatest error, and the data files that hold their coefficients."""

from __future__ import annotations

import itertools
import json
import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np

import linkwright.core.sections.fits
from linkwright.core.sections.fits.fit import fits

Fits = dict[str, tuple]
"""Coefficients by the name of their fit."""
WORST_POISSON = (0.45 / 1.45) ** 2
"""(nu / (1 + nu))^2 at the largest Poisson's ratio."""


def powers(features: tuple[np.ndarray, ...], degree: int) -> tuple[np.ndarray, list[tuple[int, ...]]]:
    """All monomials of at most this total degree, as columns, and their exponents."""
    exponents = [e for e in itertools.product(range(degree + 1), repeat=len(features)) if sum(e) <= degree]
    columns = [np.prod([f**k for f, k in zip(features, e, strict=True)], axis=0) for e in exponents]
    return np.column_stack(columns), exponents


def minimax(matrix: np.ndarray, target: np.ndarray, weight: np.ndarray, rounds: int = 60) -> np.ndarray:
    """Coefficients that nearly minimise the greatest weighted residual (Lawson's reweighted least
    squares)."""
    scale, best, least = weight / weight.max(), None, np.inf
    for _ in range(rounds):
        coefficients = np.linalg.lstsq(matrix * scale[:, None], target * scale, rcond=1e-11)[0]
        error = np.abs(matrix @ coefficients - target) * weight
        if error.max() < least:
            best, least = coefficients, error.max()
        scale *= np.sqrt(0.3 + error / error.max())
        scale /= scale.max()
    assert best is not None
    return best


def nest(exponents: list[tuple[int, ...]], coefficients: np.ndarray) -> tuple:
    """Coefficients as nested tuples for `sections.numeric.polynomial`."""
    table = dict(zip(exponents, coefficients, strict=True))
    if len(exponents[0]) == 1:
        return tuple(float(f"{table[(k,)]:.10g}") for k in range(len(table)))
    out = []
    for k in range(max(e[0] for e in exponents) + 1):
        rest = [e[1:] for e in exponents if e[0] == k]
        out.append(nest(rest, np.array([table[(k, *e)] for e in rest])))
    return tuple(out)


def save(file: str, found: Mapping[str, tuple]) -> None:
    """Put coefficients in the place of the old ones in a data file; all that describes them there stays."""
    path = Path(linkwright.core.sections.fits.__file__).with_name(f"{file}.json")
    tables = json.loads(path.read_text(encoding="utf-8"))
    for name, coefficients in found.items():
        tables[name]["coefficients"] = coefficients
    text = json.dumps(tables, indent=1)
    # Lists of numbers on one line each.
    text = re.sub(r"\[\s+([^\[\]]*?)\s+\]", lambda match: "[" + " ".join(match[1].split()) + "]", text)
    path.write_text(text + "\n", encoding="utf-8")
    fits.cache_clear()
