"""Scatter of visits, drawn here from first principles, against offsets that know of the visit before."""

import numpy as np
import pytest

from linkwright.core.diagnose.answer.guard.scatter import follows
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.sections.numeric import Array
from tests.diagnose.by_cosines import SIGMA, file, noise, poses, recording, tips

VISITS = 60


def p_value(seed: int, offsets: Array, *, straight: bool = False) -> float:
    """Of what is left when visits stand off by `offsets` (V, 2), m, perhaps with a straight line in time fitted."""
    q = np.repeat(poses(seed, VISITS), 3, axis=0)
    observed = observe(file(), recording(q, tips(q)))
    left = np.repeat(offsets, 3, axis=0) + noise(seed, len(q))
    columns = np.zeros((*observed.residual.shape, 4))
    columns[:, 0, 0] = columns[:, 1, 1] = 1.0
    if straight:
        columns[:, 0, 2] = columns[:, 1, 3] = np.linspace(-1.0, 1.0, len(q))
    design = columns.reshape(-1, 4)
    left = left - (design @ np.linalg.lstsq(design, left.reshape(-1), rcond=None)[0]).reshape(left.shape)
    return follows(observed, left, columns, seed=0, rules=RULES)


def scattered(seed: int) -> Array:
    return 3.0 * SIGMA * np.random.default_rng(seed).standard_normal((VISITS, 2))


def test_scatter_knows_nothing_of_the_visit_before() -> None:
    """P-values of chance are even: of 60 some 12 lie in each fifth, and few below 0.02."""
    result = np.array([p_value(seed, scattered(seed), straight=True) for seed in range(60)])
    assert np.sum(result < RULES.answer.scatter_follows) <= 4
    assert np.all(np.histogram(result, np.linspace(0.0, 1.0, 6))[0] >= 4)


@pytest.mark.parametrize("seed", range(4))
def test_what_settles_is_like_the_visit_before(seed: int) -> None:
    """An exponential of a tenth of the recording, of which a straight line leaves most; scatter as large beside it."""
    course = 6.0 * SIGMA * np.exp(-np.arange(VISITS) / 6.0)
    settling = np.outer(course, [1.0, -1.0]) * 3.0 + 0.3 * scattered(seed)
    assert p_value(seed, settling, straight=True) < RULES.answer.scatter_follows


@pytest.mark.parametrize("seed", range(4))
def test_what_a_block_of_visits_has_in_common_is_like_the_visits_before(seed: int) -> None:
    """Half of what is left is alike for fifteen visits, half is scatter: each visit says little of the next alone."""
    blocks = 1.5 * SIGMA * np.where(np.arange(VISITS) // 15 % 2, 1.0, -1.0)
    assert p_value(seed, np.outer(blocks, [1.0, -1.0]) + 0.7 * scattered(seed)) < RULES.answer.scatter_follows
