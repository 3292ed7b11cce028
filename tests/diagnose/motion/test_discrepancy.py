"""Discrepancies that logs tell, where it is known how far columns are off without a name."""

from types import SimpleNamespace

import numpy as np
import pytest

from linkwright.core.diagnose.motion.model.evidence import discrepancies, unnamed
from linkwright.core.diagnose.motion.model.products import JointRows, products

COLUMNS, ROWS, NOISE = 30, 300, 0.02
LEAST = np.array([0.01, 0.01])
OWN = np.arange(COLUMNS), COLUMNS + np.arange(COLUMNS)
POOL = SimpleNamespace(width=2 * COLUMNS, groups=())


def drawn(rng, more):
    """Two joints of noise one; each one's columns, alike in part, are off by `more` (2,) times the least, and its first
    by one besides. The products of both."""
    joints = []
    for at, least, times in zip(OWN, LEAST, more, strict=True):
        design = rng.normal(size=(ROWS, COLUMNS)) + rng.normal(size=(ROWS, 1))
        off = times * least * rng.normal(size=COLUMNS) / np.sqrt(np.mean(design**2, axis=0))
        off[0] += 1.0
        target = design @ off + NOISE * rng.normal(size=ROWS)
        block, every = np.arange(ROWS) // 30, np.ones(ROWS, dtype=bool)
        joints.append(JointRows(at, design, target, block, np.zeros(ROWS, dtype=np.int64), every, every))
    return products(joints, POOL.width, near=False)


NAMED = np.eye(POOL.width)[:, [OWN[0][0], OWN[1][0]]]


def told(made):
    more = unnamed(POOL, made, np.full(2, NOISE**-2), NAMED, LEAST)
    return np.hypot(more, discrepancies(POOL, made, LEAST))


@pytest.mark.parametrize("more", [(1.0, 8.0), (4.0, 1.0), (16.0, 16.0)])
def test_logs_tell_how_far_the_columns_of_each_joint_are_off(more):
    """By their scatter: within a step of what is tried, from as many columns at most draws."""
    made = drawn(np.random.default_rng(1), more)
    ratio = told(made) / discrepancies(POOL, made, LEAST)
    for at, times in zip(OWN, more, strict=True):
        assert times / 2.0 <= ratio[at[0]] <= 2.0 * times
        np.testing.assert_allclose(ratio[at], ratio[at[0]])


def test_intervals_beside_what_has_no_name_hold_the_truth():
    """Of 300 sizes, columns alike in part off beside them: 19 of 20, and far fewer by the least discrepancy."""
    held = {True: [], False: []}
    for seed in range(150):
        made = drawn(np.random.default_rng(seed), (8.0, 4.0))
        gram, against, _ = made.whole(np.full(2, NOISE**-2))
        for known in held:
            off = told(made) if known else discrepancies(POOL, made, LEAST)
            spread = np.column_stack((np.diag(off), NAMED))
            prior = np.append(np.ones(POOL.width), [0.01, 0.01])
            inverse = np.linalg.inv(spread.T @ gram @ spread + np.diag(prior))
            size, error = (inverse @ spread.T @ against)[-2:], np.sqrt(np.diagonal(inverse))[-2:]
            held[known] += (np.abs(size - 1.0) < 1.96 * error).tolist()
    assert 0.92 < np.mean(held[True]) < 0.98
    assert np.mean(held[False]) < 0.85
