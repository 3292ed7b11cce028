"""Buckling of a long orthotropic strip by Rayleigh and Ritz: what the formulas under test are held against.

A strip of unit width, simply supported at its ends far away and along y = 0; its edge at y = 1 is held too, or free.
Deflections are f(y) exp(i k x) with polynomials f, so that every wavelength and shear are taken exactly; the least over
k counts (S. P. Timoshenko and J. M. Gere, Theory of Elastic Stability, 1961, chapter 9)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.polynomial import Legendre, Polynomial
from scipy.linalg import eigh
from scipy.optimize import minimize_scalar

_TERMS = 14
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(40)
_Y, _W = 0.5 * (_NODES + 1.0), 0.5 * _WEIGHTS


def _shapes(free: bool) -> list[Any]:
    edge = Polynomial([0.0, 1.0]) if free else Polynomial([0.0, 1.0, -1.0])
    results: list[Any] = [[], [], []]
    for order in range(_TERMS):
        bulge = Legendre.basis(order).convert(kind=Polynomial)(Polynomial([-1.0, 2.0]))
        for derivative in range(3):
            results[derivative].append((edge * bulge).deriv(derivative)(_Y) if derivative else (edge * bulge)(_Y))
    return [np.array(rows) for rows in results]


_SHAPES = {free: _shapes(free) for free in (False, True)}


def critical(
    bending: tuple[float, float, float, float],
    held: float,
    other: float,
    shear: float = 0.0,
    *,
    free: bool = False,
) -> float:
    """The factor on N (compression per length, `held` at y = 0, `other` at y = 1) and on shear at which the strip
    buckles, for D11, D12, D22, D66."""
    d11, d12, d22, d66 = bending
    f, slope, curve = _SHAPES[free]

    def energy(one: Any, two: Any, weight: Any = 1.0) -> Any:
        return (one * (_W * weight)) @ two.T

    pressed = energy(f, f, held + (other - held) * _Y)
    sheared = energy(f, slope)
    plain, turned, bent, mixed = energy(f, f), energy(slope, slope), energy(curve, curve), energy(f, curve)

    def largest(log_k: float) -> float:
        k = np.exp(log_k)
        stiff = d11 * k**4 * plain - d12 * k**2 * (mixed + mixed.T) + d22 * bent + 4.0 * d66 * k**2 * turned
        load = k**2 * pressed + 1j * k * shear * (sheared - sheared.T)
        return -float(eigh(load, stiff.astype(complex), eigvals_only=True)[-1])

    waves = np.log(np.geomspace(0.02, 60.0, 90) * (d22 / d11) ** 0.25)
    least = int(np.argmin([largest(wave) for wave in waves]))
    if least in (0, len(waves) - 1):
        return -1.0 / largest(waves[least])  # the longest waves: an edge that is free turns as a whole
    span = (waves[least - 1], waves[least + 1])
    return -1.0 / minimize_scalar(largest, bounds=span, method="bounded", options={"xatol": 1e-7}).fun
