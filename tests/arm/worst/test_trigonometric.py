"""Trigonometric polynomials: samples give them whole, derivatives are right, remainders are bounds."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from linkwright.core.arm.worst.certificate import maximise, upper_bounds
from linkwright.core.arm.worst.polynomial import Coordinates, NotPolynomial, Terms, evaluate, fit, terms_of
from linkwright.core.sections.numeric import Array

KINDS = [(True,), (False,), (True, True), (True, False), (False, True, True), (True, True, True)]


def coordinates_of(kinds: tuple[bool, ...]) -> Coordinates:
    """Revolute joints all round; slides from -0.2 m to 0.5 m."""
    return Coordinates(kinds, tuple((-math.pi, math.pi) if turns else (-0.2, 0.5) for turns in kinds))


def random_expression(seed: int, kinds: tuple[bool, ...]) -> tuple[ca.SX, ca.SX]:
    """A random polynomial of degree two in each joint's cosine and sine, or position, as symbols."""
    rng = np.random.default_rng(seed)
    q = ca.SX.sym("q", len(kinds))
    factors = []
    for index, turns in enumerate(kinds):
        x = q[index]
        basis = [1, ca.cos(x), ca.sin(x), ca.cos(x) * ca.sin(x), ca.cos(x) ** 2] if turns else [1, x, x**2]
        factors.append(basis)
    return q, sum(float(rng.normal()) * ca.vertcat(*pick)[0] * math.prod(pick[1:], start=1)
                  for pick in itertools.product(*factors))  # fmt: skip


def as_function(q: ca.SX, expression: ca.SX) -> Callable[[Array], Array]:
    function = ca.Function("f", [q], [expression])
    return lambda points: np.array(function.map(len(points))(points.T)).reshape(-1, len(points)).T


def poses(rng: np.random.Generator, coordinates: Coordinates, count: int) -> Array:
    low, high = np.array(coordinates.ranges).T
    return rng.uniform(low, high, (count, len(low)))


@pytest.mark.parametrize("kinds", KINDS)
def test_many_points_at_once_give_what_each_gives_alone(kinds: tuple[bool, ...]) -> None:
    """Both ways of `Terms.at`: by terms for few points, by tables for many; two functions, all orders."""
    coordinates = coordinates_of(kinds)
    functions = [as_function(*random_expression(seed, kinds)) for seed in (3, 4)]
    terms = terms_of(fit(lambda q: np.hstack([function(q) for function in functions]), coordinates))
    rng = np.random.default_rng(5)
    x, which = coordinates.scaled(poses(rng, coordinates, 3000)), rng.integers(0, 2, 3000).astype(np.intp)
    for order in (0, 1, 2):
        many = terms.at(x, which, order)
        few = [terms.at(x[k : k + 10], which[k : k + 10], order) for k in range(0, 3000, 10)]
        for derivative in range(order + 1):
            alone = np.concatenate([item[derivative] for item in few])
            assert many[derivative] == pytest.approx(alone, abs=1e-12 * np.abs(alone).max())


@pytest.mark.parametrize("kinds", KINDS)
@pytest.mark.parametrize("seed", [0, 1])
def test_fit_gives_values_gradients_and_curvatures_back(kinds: tuple[bool, ...], seed: int) -> None:
    """Against CasADi's own derivatives."""
    q, expression = random_expression(seed, kinds)
    coordinates = coordinates_of(kinds)
    coefficients = fit(as_function(q, expression), coordinates)
    points = poses(np.random.default_rng(seed), coordinates, 20)
    exact = as_function(q, expression)(points)
    assert evaluate(coefficients, points) == pytest.approx(exact, abs=1e-12 * np.abs(exact).max())
    value, gradient, hessian = terms_of(coefficients).at(coordinates.scaled(points), np.zeros(20, dtype=np.intp))
    slope = np.array([1.0 if turns else 0.5 * 0.7 for turns in kinds])  # d q / d x
    assert value == pytest.approx(exact[:, 0], abs=1e-12 * np.abs(exact).max())
    n = len(kinds)
    first = as_function(q, ca.gradient(expression, q))(points) * slope
    second = as_function(q, ca.reshape(ca.hessian(expression, q)[0], -1, 1))(points).reshape(-1, n, n)
    assert gradient == pytest.approx(first, abs=1e-11 * np.abs(first).max())
    assert hessian == pytest.approx(second * slope[:, None] * slope, abs=1e-11 * np.abs(second).max())


@given(
    seed=st.integers(0, 10**6),
    kinds=st.sampled_from(KINDS),
    order=st.sampled_from([0, 1, 2]),
    size=st.floats(1e-3, 1.0),
)
@settings(max_examples=60, deadline=None)
def test_remainder_bounds_what_a_taylor_polynomial_misses(
    seed: int, kinds: tuple[bool, ...], order: int, size: float
) -> None:
    q, expression = random_expression(seed, kinds)
    coordinates = coordinates_of(kinds)
    terms = terms_of(fit(as_function(q, expression), coordinates))
    rng = np.random.default_rng(seed)
    half = size * rng.uniform(0.0, 1.0, len(kinds))
    limits = np.array([math.pi if turns else 1.0 for turns in kinds])
    center = rng.uniform(-1.0, 1.0, len(kinds)) * (limits - np.minimum(half, limits))
    zero = np.zeros(1, dtype=np.intp)
    value, gradient, hessian = terms.at(center[None], zero)
    bound = terms.remainder(half[None], order)[0, 0]
    for step in rng.uniform(-1.0, 1.0, (100, len(kinds))) * half:
        taylor = value[0]
        taylor += gradient[0] @ step if order >= 1 else 0.0
        taylor += 0.5 * step @ hessian[0] @ step if order >= 2 else 0.0
        true = terms.at((center + step)[None], zero)[0][0]
        assert abs(true - taylor) <= bound * (1.0 + 1e-9) + 1e-12


@given(seed=st.integers(0, 10**6), kinds=st.sampled_from(KINDS), size=st.floats(0.01, 1.0))
@settings(max_examples=60, deadline=None)
def test_upper_bound_over_a_cell_is_one(seed: int, kinds: tuple[bool, ...], size: float) -> None:
    q, expression = random_expression(seed, kinds)
    coordinates = coordinates_of(kinds)
    terms = terms_of(fit(as_function(q, expression), coordinates))
    rng = np.random.default_rng(seed)
    half = np.array([size * (3.0 if turns else 1.0) for turns in kinds])
    center = np.zeros(len(kinds)) if size > 0.5 else rng.uniform(-0.5, 0.5, len(kinds))
    half = np.minimum(half, np.where(kinds, 10.0, 1.0 - np.abs(center)))
    zero = np.zeros(1, dtype=np.intp)
    _, top = upper_bounds(terms, center[None], half[None], zero)
    x = center + rng.uniform(-1.0, 1.0, (2000, len(kinds))) * half
    assert terms.at(x, np.zeros(2000, dtype=np.intp))[0].max() <= top[0]


@given(seed=st.integers(0, 10**6), kinds=st.sampled_from(KINDS))
@settings(max_examples=25, deadline=None)
def test_branch_and_bound_holds_the_largest_value_within_its_gap(seed: int, kinds: tuple[bool, ...]) -> None:
    q, expression = random_expression(seed, kinds)
    coordinates = coordinates_of(kinds)
    terms = terms_of(fit(as_function(q, expression), coordinates))
    limits = np.array([math.pi if turns else 1.0 for turns in kinds])
    result = maximise(terms, -limits, limits, gap=1e-3)
    x = np.random.default_rng(seed).uniform(-limits, limits, (20_000, len(kinds)))
    assert result.complete
    assert terms.at(x, np.zeros(len(x), dtype=np.intp))[0].max() <= result.bound
    assert result.bound <= result.value + 1e-3 * abs(result.value) + 1e-12
    assert terms.at(result.point[None], np.zeros(1, dtype=np.intp))[0][0] == pytest.approx(result.value, rel=1e-12)


def test_a_search_cut_short_still_bounds() -> None:
    kinds = (True, True, True)
    q, expression = random_expression(5, kinds)
    terms = terms_of(fit(as_function(q, expression), coordinates_of(kinds)))
    limits = np.full(3, math.pi)
    short, whole = (maximise(terms, -limits, limits, gap=1e-6, most_cells=cells) for cells in (400, 10**7))
    assert not short.complete
    assert whole.complete
    assert short.bound >= whole.value


@pytest.mark.parametrize(
    "function",
    [
        lambda q: np.abs(np.sin(q)),
        lambda q: np.cos(3.0 * q),
        lambda q: np.sqrt(1.5 + np.cos(q)),
        lambda q: np.cos(0.5 * q),
    ],
)
def test_what_is_no_polynomial_of_degree_two_is_refused(function: Callable[[Array], Array]) -> None:
    with pytest.raises(NotPolynomial):
        fit(function, coordinates_of((True,)))


def test_a_cubic_slide_is_refused() -> None:
    with pytest.raises(NotPolynomial):
        fit(lambda q: q**3, coordinates_of((False,)))


def test_functions_of_no_joint_at_all_are_constants() -> None:
    terms = terms_of(fit(lambda q: np.full((len(q), 1), 3.0), coordinates_of(())))
    result = maximise(terms, np.zeros(0), np.zeros(0), gap=1e-6)
    assert result.value == pytest.approx(3.0)
    assert result.bound == pytest.approx(3.0)


def test_dropped_terms_are_bounded() -> None:
    """A term 1e-15 the size of the largest is dropped, and its size stays in `neglected`."""
    coefficients = fit(lambda q: np.cos(q) + 1e-15 * np.cos(2.0 * q), coordinates_of((True,)))
    terms: Terms = terms_of(coefficients)
    assert 0.0 < terms.neglected[0] < 1e-14
