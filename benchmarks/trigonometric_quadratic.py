"""The tip error of a planar arm as what it is: a polynomial of second degree in sines and cosines.

Under gravity and forces fixed in the base frame, every component of the error is

    e = a + sum_i b_i z_i + sum_ij C_ij z_i z_j,    z = (cos phi_1, .., cos phi_n, sin phi_1, .., sin phi_n),

with phi = P q the absolute angles (bending: direction times force across, both of first degree; slopes:
moment times lever).  The general expression does not know that and repeats itself; `TrigQuadratic` finds
a, b, C from values at random poses, checks them at others, and writes the polynomial out with few terms.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from linkwright.core.sections.numeric import Array

TOLERANCE = 1e-12
"""Largest difference at any random pose, relative to the largest error among them."""

NEGLIGIBLE = 1e-14
"""Coefficients below this, relative to the largest error, are rounding noise and taken for zero."""


class NotQuadratic(ValueError):
    """An expression is no polynomial of second degree in the sines and cosines of the phases."""


@dataclass(frozen=True, eq=False, slots=True)
class TrigQuadratic:
    """Coefficients of m components in the n phases `phases` @ q, in the unit of the components.

    `constant` (m,), `linear` (m, 2n), `quadratic` (m, 2n, 2n) upper triangular, both over z, cosines first;
    sin phi_i * sin phi_i does not occur (it is 1 - cos phi_i * cos phi_i).  `residual` is the largest
    difference at the poses of the check, relative to the largest error among them.
    """

    phases: Array
    constant: Array
    linear: Array
    quadratic: Array
    residual: float

    @classmethod
    def detect(cls, error: ca.SX, q: ca.SX, phases: ArrayLike | None = None, *, seed: int = 0) -> TrigQuadratic:
        """Coefficients of `error`, an SX column that depends on the SX column `q` (angles in rad) only.

        `phases` is the integer matrix P, shape (n, len(q)); without it phi_i = q_1 + .. + q_i.  Raises
        `NotQuadratic` if the polynomial misses `error` by more than 1e-12 of its largest value at any of
        the random poses it is checked at, `ValueError` if shapes or symbols do not fit.
        """
        joints = q.numel()
        matrix = np.tril(np.ones((joints, joints))) if phases is None else np.array(phases, dtype=np.float64)
        if matrix.ndim != 2 or matrix.shape[1] != joints:
            raise ValueError(f"phases has shape {matrix.shape}; (n, {joints}) is needed")
        if not np.array_equal(matrix, np.rint(matrix)):
            raise ValueError("phases must be whole numbers: the angles count modulo a full turn")
        if error.numel() == 0 or error.size2() != 1:
            raise ValueError(f"error has shape {error.shape}; a column vector is needed")
        known = {q[j].element_hash() for j in range(joints)}
        others = [str(s) for s in ca.symvar(error) if s.element_hash() not in known]
        if others:
            raise ValueError(f"error depends on more than q: {', '.join(others)}")

        size = 2 * len(matrix)
        pairs = [(i, j) for i in range(size) for j in range(i, size) if not i == j >= len(matrix)]
        count = 1 + size + len(pairs)
        # Twice as many poses as coefficients keep the fit well conditioned; as many again check it.
        angles = np.random.default_rng(seed).uniform(-np.pi, np.pi, (3 * count + 30, joints))
        values = _values(error, q, angles)
        scale = float(np.max(np.abs(values)))
        if not np.isfinite(scale):
            raise NotQuadratic("the error is not finite at every pose")
        terms = _terms(angles @ matrix.T, pairs)
        fitted = 2 * count
        solution = np.linalg.lstsq(terms[:fitted], values[:fitted], rcond=1e-10)[0]
        found = solution.astype(np.float64)
        found[np.abs(found) <= NEGLIGIBLE * scale] = 0.0
        worst = float(np.max(np.abs(terms @ found - values)))
        if worst > TOLERANCE * scale:
            raise NotQuadratic(
                f"no polynomial of second degree in the sines and cosines of {len(matrix)} phases: "
                f"the best one is off by {worst / scale:.1e} of the largest error"
            )
        quadratic = np.zeros((error.numel(), size, size))
        for row, (i, j) in zip(found[1 + size :], pairs, strict=True):
            quadratic[:, i, j] = row
        return cls(matrix, found[0], found[1 : 1 + size].T, quadratic, worst / scale if scale > 0 else 0.0)

    def expression(self, q: ca.SX) -> ca.SX:
        """The components as an SX column in the angles `q` (rad), for `vectorise` or for derivatives."""
        z = self._sines_and_cosines(q)
        components = [
            _factored(float(constant), linear, quadratic, z)
            for constant, linear, quadratic in zip(self.constant, self.linear, self.quadratic, strict=True)
        ]
        return ca.vertcat(*components)

    def size(self, q: ca.SX) -> ca.SX:
        """Euclidean length of the error as an SX scalar in the angles `q` (rad)."""
        return ca.sqrt(ca.sumsqr(self.expression(q)))

    def _sines_and_cosines(self, q: ca.SX) -> list[ca.SX]:
        if q.numel() != self.phases.shape[1]:
            raise ValueError(f"q has {q.numel()} angles; {self.phases.shape[1]} are needed")
        angles: list[ca.SX] = []
        done: list[Array] = []
        for row in self.phases:
            # The next angle of a chain is the last one plus a joint: fewer sums than starting anew.
            start, left = ca.SX(0), row
            if done and np.count_nonzero(row - done[-1]) < np.count_nonzero(row):
                start, left = angles[-1], row - done[-1]
            for j in np.flatnonzero(left).tolist():
                start = start + float(left[j]) * q[j]
            angles.append(start)
            done.append(row)
        return [ca.cos(angle) for angle in angles] + [ca.sin(angle) for angle in angles]


def _values(error: ca.SX, q: ca.SX, angles: Array) -> Array:
    """Components at each pose, shape (N, m)."""
    function = ca.Function("error", [q], [ca.densify(error)])
    return np.array(function.map(len(angles))(angles.T)).reshape(error.numel(), -1).T


def _terms(phi: Array, pairs: list[tuple[int, int]]) -> Array:
    """1, z and the products of z named by `pairs`, shape (N, number of terms)."""
    z = np.hstack([np.cos(phi), np.sin(phi)])
    products = [z[:, i] * z[:, j] for i, j in pairs]
    return np.column_stack([np.ones(len(phi)), z, *products])


def _factored(constant: float, linear: Array, quadratic: Array, z: list[ca.SX]) -> ca.SX:
    """The polynomial with the variable of most products taken out first, then the next, and so on."""
    left = quadratic + quadratic.T  # Symmetric, the diagonal doubled.
    total = ca.SX(constant)
    open_linear = linear.copy()
    while np.any(left):
        i = int(np.argmax(np.count_nonzero(left, axis=1)))
        inner = ca.SX(float(open_linear[i]))
        for j in np.flatnonzero(left[i]).tolist():
            inner = inner + float(left[i, j] / (2.0 if i == j else 1.0)) * z[j]
        total = total + inner * z[i]
        open_linear[i] = 0.0
        left[i, :] = 0.0
        left[:, i] = 0.0
    for i in np.flatnonzero(open_linear).tolist():
        total = total + float(open_linear[i]) * z[i]
    return total
