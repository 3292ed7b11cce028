"""Numbers that can be: a set's likeliest within the bounds of their parameters."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize

from linkwright.core.arm.effects.friction.friction_coulomb import FRICTION_COULOMB
from linkwright.core.diagnose.motion.model.candidates import Group
from linkwright.core.diagnose.motion.model.evidence import Member, System
from linkwright.core.diagnose.motion.model.feasible import feasible

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
