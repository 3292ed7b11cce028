"""Bounds from control points: no point of a cell lies beyond them, and they close in on it as cells shrink."""

from __future__ import annotations

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm, Joint, LoadCase
from linkwright.core.arm.worst.hull import Axis, Pins, PlayedVector, Within, bound, played_vector
from linkwright.core.arm.worst.loose_bound import THOROUGH, loose_bound
from linkwright.core.arm.worst.polynomial import Coordinates, fit
from linkwright.core.sections.numeric import Array
from tests.arm.worst.test_worst_case import DOWN_Z, X, Y, Z, errors, rods, search_of
from tests.costs import slow_but

KINDS = [(True, 2), (False, 2), (True, 1)]


def basis(axis: Axis, x: Array) -> Array:
    """1, cos x, sin x, cos 2x, sin 2x or 1, x, x^2 at points (N,)."""
    if not axis.turns:
        return np.stack([np.ones_like(x), x, x * x], axis=1)
    rows = [np.ones_like(x)]
    for k in range(1, axis.degree + 1):
        rows += [np.cos(k * x), np.sin(k * x)]
    return np.stack(rows, axis=1)


@pytest.mark.parametrize(("turns", "degree"), KINDS)
@pytest.mark.parametrize("half", [1.4, 0.5, 0.1])
def test_functions_are_means_of_their_control_points(turns: bool, degree: int, half: float) -> None:
    """Weights nowhere negative that add up to 1 reproduce every function of the basis: they are the solution of a
    square system, so that this determines them."""
    axis = Axis(turns, degree, -1.0, 1.0)
    center = 0.4
    x = center + half * np.linspace(-1.0, 1.0, 41)
    control = axis.control(np.array([center]), np.array([half]))[0]
    weights = np.linalg.solve(control.T, basis(axis, x).T)
    assert weights.min() >= -1e-9
    assert weights.sum(axis=0) == pytest.approx(1.0, abs=1e-9)


def random_vector(seed: int, plays: int) -> PlayedVector:
    axes = (Axis(True, 2, -2.0, 3.1), Axis(False, 2, -1.0, 1.0), Axis(True, 1, -np.pi, np.pi))
    generator = np.random.default_rng(seed)
    return played_vector(axes, generator.normal(size=(3, 5, 3, 3)), 0.2 * generator.normal(size=(plays, 3, 5, 3, 3)))


def lengths(played: PlayedVector, x: Array) -> Array:
    """The length at points (N, n) with the play where it makes it longest, by trying all ways."""
    each = [basis(axis, x[:, j]) for j, axis in enumerate(played.axes)]
    vector = np.einsum("iabc,na,nb,nc->ni", played.vector, *each)
    intervals = np.einsum("kiabc,na,nb,nc->nki", played.intervals, *each)
    plays = len(played.intervals)
    signs = 2.0 * ((np.arange(2**plays)[:, None] >> np.arange(plays)) & 1) - 1.0
    whole = vector[:, None] + np.einsum("sk,nki->nsi", signs, intervals)
    return np.linalg.norm(whole, axis=2).max(axis=1)


@pytest.mark.parametrize("plays", [0, 2, 6])
@pytest.mark.parametrize("half", [0.7, 0.1, 0.01])
def test_no_point_of_a_cell_is_longer_than_its_bound(plays: int, half: float) -> None:
    played = random_vector(plays, plays)
    generator = np.random.default_rng(7)
    centers = generator.uniform(-0.3, 0.3, (30, 3))
    tops = played.longest(centers, np.full((30, 3), half))
    inside = centers[:, None] + half * generator.uniform(-1.0, 1.0, (30, 400, 3))
    reached = lengths(played, inside.reshape(-1, 3)).reshape(30, 400).max(axis=1)
    assert np.all(tops >= reached * (1.0 - 1e-12))
    if half == 0.01 and plays < 6:
        assert tops == pytest.approx(reached, rel=0.05)


@pytest.mark.parametrize("plays", slow_but([0, 2], 0))
@pytest.mark.parametrize("half", slow_but([0.7, 0.5], 0.5))
def test_no_point_within_is_longer_than_the_bound_of_a_cell_that_lies_mostly_outside(plays: int, half: float) -> None:
    """A vector that goes with two functions is much shorter where those are near nought than at a cell's far ends."""
    generator = np.random.default_rng(5)
    free = random_vector(3, plays)
    functions = generator.normal(size=(2, 5, 3, 3))
    along = np.einsum("ia,abcd->ibcd", generator.normal(size=(3, 2)), functions)
    vector = 2.0 * along + 0.1 * free.vector
    center, room = np.array([0.3, -0.2]), np.array([0.3, 0.4])
    axes = (Axis(True, 2, -2.0, 3.1), Axis(False, 2, -1.0, 1.0), Axis(True, 1, -np.pi, np.pi))
    plain = played_vector(axes, vector, 0.1 * free.intervals)
    played = played_vector(axes, vector, 0.1 * free.intervals, within=Within(functions, center, room))
    centers = generator.uniform(-0.5, 0.5, (40, 3))
    tops = played.longest(centers, np.full((40, 3), half))
    inside = (centers[:, None] + half * generator.uniform(-1.0, 1.0, (40, 20_000, 3))).reshape(-1, 3)
    each = [basis(axis, inside[:, j]) for j, axis in enumerate(axes)]
    places = np.einsum("iabc,na,nb,nc->ni", functions, *each)
    counts = np.all(np.abs(places - center) <= room, axis=1).reshape(40, -1)
    reached = np.where(counts, lengths(plain, inside).reshape(40, -1), 0.0).max(axis=1)
    assert (reached > 0.0).sum() > 5
    assert np.all(tops >= reached * (1.0 - 1e-12))
    assert np.median(tops / plain.longest(centers, np.full((40, 3), half))) < 0.7


@pytest.mark.parametrize("plays", [0, 2])
def test_bound_over_a_box_closes_in_on_the_longest(plays: int) -> None:
    played = random_vector(11, plays)
    generator = np.random.default_rng(8)
    lower, upper = (np.array([getattr(axis, end) for axis in played.axes]) for end in ("lower", "upper"))
    x = generator.uniform(lower, upper, (100_000, 3))
    result = lengths(played, x)
    near = x[np.argsort(-result)[:20]]
    x = np.clip(np.repeat(near, 2000, axis=0) + 0.05 * generator.normal(size=(40_000, 3)), lower, upper)
    known = float(lengths(played, x).max())
    bounds = [bound(played, known, gap=1e-4, effort=points) for points in (1_000, 100_000, 10_000_000)]
    assert bounds[0] >= bounds[1] >= bounds[2] >= known
    assert bounds[2] <= known * 1.001


def turning_pins(seed: int, plays: int) -> PlayedVector:
    """Two pins of 0.7 and 0.4 on axes that turn with the first coordinate and with the second, beside some play."""
    axes = (Axis(True, 2, -2.0, 3.1), Axis(True, 1, -1.0, 1.0))
    generator = np.random.default_rng(seed)
    normals = np.zeros((2, 3, 5, 3))
    normals[0, 0, 1, 0] = normals[0, 1, 2, 0] = 1.0  # (cos x, sin x, 0)
    normals[1, 2, 0, 1] = normals[1, 0, 0, 2] = 1.0  # (sin y, 0, cos y)
    pins = Pins(np.array([0.7, 0.4]), normals)
    return played_vector(axes, generator.normal(size=(3, 5, 3)), 0.2 * generator.normal(size=(plays, 3, 5, 3)), pins)


@pytest.mark.parametrize("plays", [0, 2, 6])
@pytest.mark.parametrize("half", [0.4, 0.05, 0.002])
def test_pins_reach_no_farther_than_the_bound_of_a_cell(plays: int, half: float) -> None:
    """Against the play and the pins' places drawn, all on the rims of their bores, and climbed to from the drawn."""
    played = turning_pins(plays, plays)
    generator = np.random.default_rng(9)
    centers = np.stack([generator.uniform(-1.9, 3.0, 20), generator.uniform(-0.9, 0.9, 20)], axis=1)
    tops = played.longest(centers, np.full((20, 2), half))
    x = (centers[:, None] + half * generator.uniform(-1.0, 1.0, (20, 200, 2))).reshape(-1, 2)
    first, second = (basis(axis, x[:, j]) for j, axis in enumerate(played.axes))
    vector = np.einsum("iab,na,nb->ni", played.vector, first, second)
    intervals = np.einsum("kiab,na,nb->nki", played.intervals, first, second)
    one = np.stack([np.cos(x[:, 0]), np.sin(x[:, 0]), 0.0 * x[:, 0]], axis=1)
    other = np.stack([np.sin(x[:, 1]), 0.0 * x[:, 1], np.cos(x[:, 1])], axis=1)
    reached = np.zeros(len(x))
    for start in generator.normal(size=(12, 3)):
        toward = np.tile(start, (len(x), 1))
        for _ in range(30):
            sides = np.where(np.einsum("nki,ni->nk", intervals, toward) >= 0.0, 1.0, -1.0)
            result = vector + np.einsum("nk,nki->ni", sides, intervals)
            for radius, normal in ((0.7, one), (0.4, other)):
                across = toward - (toward * normal).sum(axis=1, keepdims=True) * normal
                result = result + radius * across / np.linalg.norm(across, axis=1, keepdims=True)
            toward = result
        reached = np.maximum(reached, np.linalg.norm(toward, axis=1))
    reached = reached.reshape(20, 200).max(axis=1)
    assert np.all(tops >= reached * (1.0 - 1e-12))
    if half == 0.002 and plays < 6:
        assert tops == pytest.approx(reached, rel=0.01)


def test_real_coefficients_of_a_polynomial() -> None:
    coordinates = Coordinates((True, False), ((-1.0, 2.0), (0.0, 0.4)))

    def function(q: Array) -> Array:
        x = (q[:, 1] - 0.2) / 0.2
        return (np.cos(2.0 * q[:, 0]) * x - 3.0 * np.sin(q[:, 0]) * x**2 + 0.5)[:, None]

    expected = np.zeros((1, 5, 3))
    expected[0, 3, 1], expected[0, 2, 2], expected[0, 0, 0] = 1.0, -3.0, 0.5
    assert fit(function, coordinates).in_reals == pytest.approx(expected, abs=1e-12)


def leaning(joints: int, clearance: float = 0.0, backlash: float = 0.0) -> Arm:
    """No axis along gravity: all joints count."""
    axes = (Z, Y, Y, X, Y, Z)[:joints]
    made = tuple(
        Joint(axis=axis, range=(-2.0, 2.5), stiffness=2e4 / (1 + k), clearance=clearance, backlash=backlash)
        for k, axis in enumerate(axes)
    )
    lengths_m = (0.3, 0.5, 0.4, 0.2, 0.1, 0.1)[:joints]
    return rods(made, lengths_m, gravity=(2.0, 1.0, -9.6), payload=LoadCase(mass=3.0, force=(5.0, 0.0, 0.0)))


@pytest.mark.parametrize(
    ("arm", "gap"),
    [
        (leaning(5), 1.01e-4),
        pytest.param(leaning(6), 1.01e-4, marks=pytest.mark.slow),
        (leaning(3, clearance=5e-5), 1.01e-4),
        pytest.param(leaning(4, clearance=5e-3, backlash=3e-3), 1.01e-4, marks=pytest.mark.slow),
    ],
    ids=["five joints", "six joints", "clearance in space", "clearance and backlash"],
)
def test_bounds_hold_against_brute_force_and_are_near(arm: Arm, gap: float) -> None:
    search, p = search_of(arm)
    worst = search.worst(p)
    assert worst.upper_bound is not None
    q = np.random.default_rng(2).uniform(search.lower, search.upper, (20_000, arm.size))
    brute = float(errors(search, p, q).max())
    assert brute <= worst.error * (1.0 + 1e-9) <= worst.upper_bound * (1.0 + 2e-9)
    assert worst.upper_bound <= worst.error * (1.0 + gap)
    assert worst.certified == (worst.upper_bound <= worst.error * (1.0 + 1.01e-4))


def test_a_first_guess_at_the_worst_does_not_make_a_bound_too_low() -> None:
    """Told that a tenth of the worst error is reached, or ten times as much, the bound is one all the same."""
    arm = leaning(4, clearance=1e-4)
    search, p = search_of(arm)
    q = np.random.default_rng(3).uniform(search.lower, search.upper, (20_000, 4))
    brute = float(errors(search, p, q).max())
    coordinates = search._coordinates  # pyright: ignore[reportPrivateUsage]
    for known in (0.1 * brute, brute):
        result = loose_bound(
            search.model.cases[0], p, coordinates, known, planar=False, gap=1e-4, effort=THOROUGH // 10
        )
        assert result is not None
        assert result >= brute


def test_an_axis_of_no_width_is_a_point() -> None:
    arm = rods((Joint(axis=Y, range=(0.3, 0.3), stiffness=1e4),), (0.5,), gravity=DOWN_Z)
    search, p = search_of(arm)
    worst = search.worst(p)
    assert worst.upper_bound == pytest.approx(worst.error, rel=1e-6)
