"""Numbers that can be: a set's likeliest within the bounds of their parameters, and of links that are bodies."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize

from linkwright.core.arm.effects.friction.friction_coulomb import FRICTION_COULOMB
from linkwright.core.arm.effects.loads.link_inertial import LINK_INERTIAL
from linkwright.core.arm.motion.rigid import pseudo_inertia
from linkwright.core.diagnose.motion.model.evidence import Member, System
from linkwright.core.diagnose.motion.model.feasible import feasible
from linkwright.core.diagnose.motion.model.groups import Body, Group

USUAL, SCALE = 0.5, 4.0


def system(factor, target, bounds):
    """A set of single numbers whose products are those of a factor (k, k) and a target (k,)."""
    groups = tuple(
        Group(
            FRICTION_COULOMB,
            (number + 1,),
            {},
            np.array([number]),
            np.eye(1),
            np.array([USUAL]),
            USUAL * np.array(bound)[:, None],
            (FRICTION_COULOMB.parameters[0],),
            ((number + 1, "torque"),),
            ("friction", (number + 1,)),
            1,
        )
        for number, bound in enumerate(bounds)
    )
    size = len(groups)
    unit = np.eye(size)
    return System(groups, factor.T @ factor, factor.T @ target, np.arange(size), unit, unit > 0.0, unit)


@settings(max_examples=40, deadline=None, derandomize=True)
@given(st.integers(0, 2**31), st.integers(1, 5))
def test_the_likeliest_within_bounds_is_that_of_a_general_search(seed, size):
    """By L-BFGS-B on the same squares, prior included: numbers and what they cost."""
    rng = np.random.default_rng(seed)
    factor, target = rng.normal(size=(size + 2, size)), 3.0 * rng.normal(size=size + 2)
    low = rng.uniform(-1.0, 0.0, size)
    bounds = list(zip(low, low + rng.uniform(0.1, 2.0, size), strict=True))
    members = [Member(number, SCALE) for number in range(size)]

    def nats(x):
        return 0.5 * float(np.sum((factor @ x - target) ** 2)) + 0.5 * float(np.sum((x / SCALE) ** 2))

    result = feasible(system(factor, target, bounds), members)
    free = feasible(system(factor, target, [(-np.inf, np.inf)] * size), members)
    best = minimize(nats, np.mean(bounds, axis=1), method="L-BFGS-B", bounds=bounds, options={"ftol": 1e-15})
    np.testing.assert_allclose(result.numbers, best.x, atol=2e-5)
    assert all(low <= x <= high for x, (low, high) in zip(result.numbers, bounds, strict=True))
    assert result.worse == pytest.approx(nats(result.numbers) - nats(free.numbers), abs=1e-8)
    assert free.worse == 0.0


def test_a_log_without_noise_is_held_to_bounds_too():
    """Columns that are alike but for rounding, weighed by hardly any noise: their prior is lost beside them."""
    rng = np.random.default_rng(3)
    factor = 1e7 * rng.normal(size=(40, 3)) @ rng.normal(size=(3, 6))
    with pytest.raises(np.linalg.LinAlgError):
        np.linalg.cholesky(factor.T @ factor + np.eye(6) / SCALE**2)
    made = system(factor, factor @ np.full(6, 0.8), [(-0.5, 0.5)] * 6)
    numbers = feasible(made, [Member(number, SCALE) for number in range(6)]).numbers
    assert np.abs(numbers).max() <= 0.5
    assert np.linalg.norm(factor @ (numbers - 0.8)) < np.linalg.norm(factor @ np.full(6, 0.8))


def of_bodies(factor, target, had):
    """A set of whole links, ten numbers each, with what the arm file has of them `had` (L, 10)."""
    groups = tuple(
        Group(
            LINK_INERTIAL,
            (link + 1,),
            {},
            10 * link + np.arange(10),
            np.eye(10),
            np.ones(10),
            np.array([[-np.inf], [np.inf]]) * np.ones(10),
            LINK_INERTIAL.torque_sizes,
            tuple(((link + 1,), size.name) for size in LINK_INERTIAL.torque_sizes),
            (LINK_INERTIAL.id, (link + 1,)),
            1,
            body=Body(link, own, np.eye(10), np.arange(10)),
        )
        for link, own in enumerate(had)
    )
    unit = np.eye(10 * len(had))
    starts = 10 * np.arange(len(had))
    return System(groups, factor.T @ factor, factor.T @ target, starts, unit, unit > 0.0, unit)


@settings(max_examples=25, deadline=None, derandomize=True)
@given(st.integers(0, 2**31), st.integers(1, 4))
def test_the_likeliest_bodies_leave_no_better_ones(seed, links):
    """Bodies are a convex cone that is its own dual, so the likeliest are known by two signs: no body has less along
    the slope there, and what the links have lies at right angles to it. The numbers hang together and differ a
    thousandfold in weight, as those of a chain of links do; logs ask for what no body has."""
    rng = np.random.default_rng(seed)
    size = 10 * links
    factor = rng.normal(size=(size + 5, size)) * 10.0 ** rng.uniform(-1.0, 2.0, size)
    target = factor @ rng.normal(size=size)
    points = rng.normal(size=(links, 6, 4)) * [0.2, 0.2, 0.2, 1.0]
    cone = np.stack([pseudo_inertia(unit).reshape(-1) for unit in np.eye(10)])
    had = np.stack([np.linalg.lstsq(cone.T, (own.T @ own).reshape(-1))[0] for own in points])
    made = of_bodies(factor, target, had)
    members = [Member(link, SCALE) for link in range(links)]
    result = feasible(made, members)
    slope = (made.gram + np.eye(size) / SCALE**2) @ result.numbers - made.against
    for own, file, part in zip(slope.reshape(links, 10), had, result.numbers.reshape(links, 10), strict=True):
        dual = np.linalg.lstsq(cone, own)[0].reshape(4, 4)
        assert np.linalg.eigvalsh(pseudo_inertia(file + part))[0] > -1e-9
        assert np.linalg.eigvalsh(dual)[0] > -1e-3 * (1.0 + np.linalg.norm(dual))
        assert abs(own @ (file + part)) < 2e-2
    free = made.numbers(members)
    assert result.worse == pytest.approx(
        0.5 * float((result.numbers - free) @ (made.gram + np.eye(size) / SCALE**2) @ (result.numbers - free))
    )
