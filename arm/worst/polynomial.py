"""Functions of the joint coordinates as trigonometric polynomials, exactly.

Under dead loads every component of the tip's error is a polynomial of degree two in the cosine and sine of each
revolute joint's angle and in each slide's position: the load on a joint or link has degree one in each, its lever to
the tip too. So a few samples give it whole, and its derivatives and their bounds with it, whatever the chain.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from linkwright.core.sections.numeric import Array

ComplexArray = NDArray[np.complex128]

_FEW_FUNCTIONS = 8
_NEGLIGIBLE = 1e-14
_ROWS_AT_ONCE = 1024
_ENOUGH_ROWS = 48
"""Points of one function from which on products of its whole table pay."""


class NotPolynomial(ValueError):
    """A function is no trigonometric polynomial of the degree that was asked for."""


@dataclass(frozen=True)
class Coordinates:
    """The joints' kinds and, for slides, the range (m) that is scaled to -1..1."""

    revolute: tuple[bool, ...]
    ranges: tuple[tuple[float, float], ...]

    def scaled(self, q: Array) -> Array:
        """Joint coordinates with slides scaled to -1..1 (angles as they are)."""
        out = np.array(q, dtype=float, copy=True)
        for j, turns in enumerate(self.revolute):
            if not turns:
                low, high = self.ranges[j]
                out[..., j] = (out[..., j] - 0.5 * (low + high)) / (0.5 * (high - low) or 1.0)
        return out

    def unscaled(self, x: Array) -> Array:
        """The inverse of `scaled`."""
        out = np.array(x, dtype=float, copy=True)
        for j, turns in enumerate(self.revolute):
            if not turns:
                low, high = self.ranges[j]
                out[..., j] = 0.5 * (low + high) + 0.5 * (high - low) * out[..., j]
        return out

    @property
    def moving(self) -> tuple[int, ...]:
        """The joints whose range has some width."""
        return tuple(j for j, (low, high) in enumerate(self.ranges) if high > low)

    def of(self, joints: Sequence[int]) -> Coordinates:
        """Those of some of the joints."""
        return Coordinates(tuple(self.revolute[j] for j in joints), tuple(self.ranges[j] for j in joints))

    def placed(self, joints: Sequence[int], q: Array) -> Array:
        """Poses of all joints from coordinates q (N, k) of some; the others stand in the middle of their range."""
        out = np.tile([0.5 * (low + high) for low, high in self.ranges], (len(q), 1))
        out[:, list(joints)] = q
        return out

    def nodes(self, joint: int, degree: int) -> Array:
        """Sample points (scaled) that determine a polynomial of `degree` in one joint."""
        count = 2 * degree + 1
        if self.revolute[joint]:
            return 2.0 * np.pi * np.arange(count) / count
        return np.cos(np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1))

    def basis(self, joint: int, degree: int, points: Array) -> ComplexArray:
        """exp(i k q), k = -degree..degree, or 1, x, .. x^degree, at scaled points: (N, basis)."""
        if self.revolute[joint]:
            return np.exp(1j * np.outer(points, np.arange(-degree, degree + 1)))
        return np.vander(points, degree + 1, increasing=True).astype(complex)


def _along(tensor: ComplexArray, matrix: ComplexArray, axis: int) -> ComplexArray:
    return np.moveaxis(np.tensordot(matrix, tensor, axes=(1, axis)), 0, axis)


# What follows depends on the joints alone, and a search asks for it again with every design.


@lru_cache(maxsize=64)
def sample_grid(coordinates: Coordinates, degree: int) -> Array:
    """The sample points (unscaled, rows) that determine polynomials of `degree` in every joint."""
    nodes = [coordinates.nodes(j, degree) for j in range(len(coordinates.revolute))]
    if not nodes:
        return np.zeros((1, 0))
    mesh = np.stack(np.meshgrid(*nodes, indexing="ij"), axis=-1).reshape(-1, len(nodes))
    return _kept(coordinates.unscaled(mesh))


@lru_cache(maxsize=64)
def trial_poses(coordinates: Coordinates, count: int = 32) -> Array:
    """Seeded poses (count, n) from whole circles and whole slides."""
    size = len(coordinates.revolute)
    reach = np.where(coordinates.revolute, np.pi, 1.0)
    return _kept(coordinates.unscaled(np.random.default_rng(size).uniform(-reach, reach, (count, size))))


@lru_cache(maxsize=64)
def _to_coefficients(turns: bool, degree: int) -> ComplexArray:
    """From a joint's values at its nodes to its coefficients."""
    joint = Coordinates((turns,), ((-1.0, 1.0),))
    return _kept(np.linalg.inv(joint.basis(0, degree, joint.nodes(0, degree))).astype(complex))


@lru_cache(maxsize=64)
def _to_values(turns: bool, degree: int, at_degree: int) -> ComplexArray:
    """From a joint's coefficients to its values at the nodes of another degree."""
    joint = Coordinates((turns,), ((-1.0, 1.0),))
    return _kept(joint.basis(0, degree, joint.nodes(0, at_degree)))


@lru_cache(maxsize=64)
def _in_reals(turns: bool, degree: int) -> ComplexArray:
    """From coefficients of exp(i k q) to those of 1, cos q, sin q, cos 2q, ..; slides keep theirs."""
    if not turns:
        return _kept(np.eye(degree + 1, dtype=complex))
    matrix = np.zeros((2 * degree + 1, 2 * degree + 1), dtype=complex)
    matrix[0, degree] = 1.0
    for k in range(1, degree + 1):
        matrix[2 * k - 1, [degree - k, degree + k]] = 1.0
        matrix[2 * k, [degree - k, degree + k]] = (-1j, 1j)
    return _kept(matrix)


@lru_cache(maxsize=64)
def _pairs(revolute: tuple[bool, ...], degree: int) -> tuple[Array, Array, Array]:
    """The terms' frequencies and powers (terms, joints), and whether each is the one (1) of a pair of opposite
    frequencies that stands for both, the other (-1), or neither (0)."""
    spans = [np.arange(-degree, degree + 1) if turns else np.arange(degree + 1) for turns in revolute]
    rows = list(itertools.product(*spans))
    index = np.array(rows, dtype=float).reshape(len(rows), len(revolute))
    turns = np.array(revolute, dtype=bool)
    frequency = np.where(turns, index, 0.0)
    sign = np.zeros(len(frequency))
    for j in range(len(revolute)):
        sign = np.where(sign == 0.0, np.sign(frequency[:, j]), sign)
    return _kept(frequency), _kept(np.where(turns, 0.0, index)), _kept(sign)


def _kept(array: NDArray[Any]) -> NDArray[Any]:
    array.setflags(write=False)
    return array


@dataclass(frozen=True)
class Coefficients:
    """Coefficient tensors (functions, basis of joint 1, basis of joint 2, ...) of polynomials of one degree."""

    coordinates: Coordinates
    degree: int
    tensor: ComplexArray

    def values_on(self, degree: int) -> ComplexArray:
        """The functions' values on the sample grid of a higher degree: (functions, grid of joint 1, ...)."""
        values = self.tensor
        for j, turns in enumerate(self.coordinates.revolute):
            values = _along(values, _to_values(turns, self.degree, degree), j + 1)
        return values

    @cached_property
    def in_reals(self) -> Array:
        """The coefficients (functions, basis of joint 1, ...) of 1, cos q, sin q, cos 2q, sin 2q, .. or 1, x, x^2."""
        tensor = self.tensor
        for j, turns in enumerate(self.coordinates.revolute):
            if turns:
                tensor = _along(tensor, _in_reals(turns, self.degree), j + 1)
        return np.ascontiguousarray(tensor.real)


def fit(
    function: Callable[[Array], Array], coordinates: Coordinates, degree: int = 2, *, check: int = 32
) -> Coefficients:
    """The coefficients of functions given as q (N, n) -> (N, functions), from samples on a grid.

    Raises `NotPolynomial` where the result misses the function at `check` seeded poses by more than 1e-9 of its size.
    """
    trial = trial_poses(coordinates, check)
    return fitted(function(sample_grid(coordinates, degree)), function(trial), coordinates, degree)


def fitted(values: Array, expected: Array, coordinates: Coordinates, degree: int = 2) -> Coefficients:
    """The coefficients of functions from their values (N, functions) on the sample grid; `NotPolynomial` where they
    miss what is expected at the trial poses (`trial_poses`, as many as there are rows) by more than 1e-9 of the size.
    """
    shape = [len(coordinates.nodes(j, degree)) for j in range(len(coordinates.revolute))]
    coefficients = from_values(coordinates, degree, values.T.reshape(-1, *shape).astype(complex))
    got = evaluate(coefficients, trial_poses(coordinates, len(expected)))
    scale = max(np.abs(values).max(initial=0.0), 1e-300)
    if np.abs(got - expected).max(initial=0.0) > 1e-9 * scale:
        raise NotPolynomial(f"no trigonometric polynomial of degree {degree} in each joint")
    return coefficients


def from_values(coordinates: Coordinates, degree: int, values: ComplexArray) -> Coefficients:
    """The coefficients of functions from their values on the sample grid of `degree`."""
    for j, turns in enumerate(coordinates.revolute):
        values = _along(values, _to_coefficients(turns, degree), j + 1)
    return Coefficients(coordinates, degree, values)


def evaluate(coefficients: Coefficients, q: Array) -> Array:
    """The functions' values (N, functions) at unscaled joint coordinates q (N, n)."""
    x = coefficients.coordinates.scaled(np.atleast_2d(q))
    size = len(coefficients.coordinates.revolute)
    table = coefficients.in_reals
    if size == 0:
        return np.broadcast_to(table, (len(x), len(table))).copy()
    turning = enumerate(coefficients.coordinates.revolute)
    bases = [_real_basis(turns, coefficients.degree, x[:, j], 0)[0] for j, turns in turning]
    if len(table) <= _FEW_FUNCTIONS:
        # Joint after joint: the table of all products of the bases would be far larger than what comes of it.
        left = np.moveaxis(table, 0, -1)
        values = left.reshape(len(left), -1).T @ bases[0]
        for basis in bases[1:]:
            values = np.einsum("bn,brn->rn", basis, values.reshape(len(basis), -1, len(x)))
        return np.ascontiguousarray(values.T)
    weights = bases[0]
    for basis in bases[1:]:
        weights = (weights[:, None, :] * basis[None, :, :]).reshape(-1, len(x))
    return np.ascontiguousarray((table.reshape(len(table), -1) @ weights).T)


@dataclass(frozen=True)
class Terms:
    """Functions f_v(x) = Re sum_k amplitude_vk exp(i frequency_k . x) prod_j x_j^power_kj of scaled coordinates x.

    `frequency` and `power` are (terms, joints), integers as floats; `amplitude` is (functions, terms), complex.
    `neglected` bounds, for each function, what was dropped. `whole` are the same functions with nothing dropped.
    """

    frequency: Array
    power: Array
    amplitude: ComplexArray
    neglected: Array
    whole: Coefficients

    def at(self, x: Array, which: NDArray[np.intp], order: int = 2) -> tuple[Array, Array, Array]:
        """Value (N,), gradient (N, n) and Hessian (N, n, n) of function `which[i]` at scaled x[i]; |x_j| <= 1 for
        slides.

        Derivatives beyond `order` come back empty.
        """
        n = x.shape[1]
        if n and (self.power.any() or len(x) >= _ENOUGH_ROWS * len(self.amplitude)):
            return self._by_tables(x, which, order)
        terms = np.exp(1j * (x @ self.frequency.T)) * self.amplitude[which]
        value = terms.real.sum(axis=1)
        gradient = -(terms.imag @ self.frequency) if order >= 1 else np.empty((0, 0))
        if order < 2:
            return value, gradient, np.empty((0, 0, 0))
        squares = (self.frequency[:, :, None] * self.frequency[:, None, :]).reshape(len(self.frequency), n * n)
        return value, gradient, -(terms.real @ squares).reshape(len(x), n, n)

    def _by_tables(self, x: Array, which: NDArray[np.intp], order: int) -> tuple[Array, Array, Array]:
        """The same, by products of each function's table of coefficients with the joints' bases, joint after joint."""
        count, n = x.shape
        value = np.empty(count)
        gradient = np.empty((count, n)) if order >= 1 else np.empty((0, 0))
        hessian = np.empty((count, n, n)) if order >= 2 else np.empty((0, 0, 0))
        for function, table in enumerate(self.whole.in_reals):
            rows = np.flatnonzero(which == function)
            for start in range(0, len(rows), _ROWS_AT_ONCE):
                some = rows[start : start + _ROWS_AT_ONCE]
                for orders, derivative in _derivatives(table, self.whole, x[some], order).items():
                    joints = [j for j, times in enumerate(orders) for _ in range(times)]
                    if not joints:
                        value[some] = derivative
                    elif len(joints) == 1:
                        gradient[some, joints[0]] = derivative
                    else:
                        hessian[some, joints[0], joints[1]] = hessian[some, joints[1], joints[0]] = derivative
        return value, gradient, hessian

    def remainder(self, half: Array, order: int) -> Array:
        """Bound (functions, N) on what a Taylor polynomial of `order` misses within +-`half` (N, n) of any point.

        For slides |x| + half <= 1 bounds every power, so the derivatives' bounds hold over the whole cell.
        """
        if len(half) > 1 and np.all(half == half[0]):
            return np.repeat(self.remainder(half[:1], order), len(half), axis=1)
        reach = half @ (np.abs(self.frequency) + self.power).T
        # Derivatives of x^p with |x| <= 1 are at most p^k, those of exp(i w x) at most w^k, so (p + w)^k bounds both.
        factorial = {0: 1.0, 1: 2.0, 2: 6.0}[order]
        return np.abs(self.amplitude) @ (reach ** (order + 1)).T / factorial


def terms_of(coefficients: Coefficients) -> Terms:
    """The polynomials as real parts of terms, conjugate pairs joined and negligible terms dropped (and bounded)."""
    frequency, power, sign = _pairs(coefficients.coordinates.revolute, coefficients.degree)
    flat = coefficients.tensor.reshape(len(coefficients.tensor), -1)
    # One of each pair of opposite frequencies stands for both: the functions are real.
    amplitude = np.where(sign > 0.0, 2.0 * flat, np.where(sign == 0.0, flat.real, 0.0))
    scale = np.abs(amplitude).max(initial=0.0)
    relevant = np.abs(amplitude).max(axis=0, initial=0.0) > _NEGLIGIBLE * scale
    neglected = np.abs(amplitude[:, ~relevant]).sum(axis=1)
    return Terms(frequency[relevant], power[relevant], amplitude[:, relevant].astype(complex), neglected, coefficients)


def _derivatives(table: Array, whole: Coefficients, x: Array, order: int) -> dict[tuple[int, ...], Array]:
    """All derivatives (N,) up to an order of the function of a table (basis of joint 1, ...) at scaled x (N, n), by how
    often each joint is derived by."""
    count = len(x)
    turning = enumerate(whole.coordinates.revolute)
    first, *rest = [_real_basis(turns, whole.degree, x[:, j], order) for j, turns in turning]
    flat = table.reshape(len(table), -1).T
    parts: dict[tuple[int, ...], Array] = {(times,): flat @ first[times] for times in range(order + 1)}
    for bases in rest:
        parts = {
            (*orders, times): np.einsum("bn,brn->rn", bases[times], part.reshape(len(bases[times]), -1, count))
            for orders, part in parts.items()
            for times in range(order - sum(orders) + 1)
        }
    return {orders: part[0] for orders, part in parts.items()}


def _real_basis(turns: bool, degree: int, x: Array, order: int) -> list[Array]:
    """1, cos x, sin x, cos 2x, .. or 1, x, x^2, .. (basis, N), and its derivatives up to an order."""
    if turns:
        table = np.ones((2 * degree + 1, len(x)))
        cosine, sine = np.cos(x), np.sin(x)
        if degree:
            table[1], table[2] = cosine, sine
        for k in range(2, degree + 1):
            table[2 * k - 1] = table[2 * k - 3] * cosine - table[2 * k - 2] * sine
            table[2 * k] = table[2 * k - 2] * cosine + table[2 * k - 3] * sine
        tables = [table]
        frequency = np.arange(1, degree + 1)[:, None]
        for _ in range(order):
            last, slope = tables[-1], np.zeros_like(table)
            slope[1::2], slope[2::2] = -frequency * last[2::2], frequency * last[1::2]
            tables.append(slope)
        return tables
    powers = np.vander(x, degree + 1, increasing=True).T
    tables = [powers]
    for _ in range(order):
        slope = np.zeros_like(powers)
        slope[1:] = np.arange(1, degree + 1)[:, None] * tables[-1][:-1]
        tables.append(slope)
    return tables
