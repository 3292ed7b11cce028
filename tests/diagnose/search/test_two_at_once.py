"""Two causes of which neither alone is beyond chance, and visits that only scatter."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.diagnose.search.naming import Namer, name_missing
from linkwright.core.sections.numeric import Array
from tests.costs import slow_but
from tests.diagnose.core_cases import group_of, noise_of, prepared_null, with_residual

CAUSES = (("joint_compliance", (1,)), ("encoder_offset", (0,)))
LEVEL = 1e-9
"""A level at which each of the two below is missed by itself, and both together are not."""


def namer_of(vector: Array) -> Namer:
    """A namer of whitened readings, by that level."""
    null = prepared_null()
    prepared = with_residual(
        null, null.pool.projected(vector).reshape(null.observed.residual.shape) * null.observed.scale
    )
    namer = Namer(prepared, thorough=False, seed=1)
    namer.rules = replace(namer.rules, false_alarm=LEVEL)
    return namer


def both(times: float) -> Array:
    """A drive that gives and another's zero, each so many times the noise."""
    null = prepared_null()
    vector = null.observed.whitened(noise_of(null, np.random.default_rng(3)))
    for effect, at in CAUSES:
        first = null.pool.basis[:, null.pool.groups[group_of(null, effect, at)].start]
        vector = vector + times * np.sqrt(len(vector)) * first
    return vector


def test_two_causes_that_no_single_one_shows_are_named() -> None:
    namer = namer_of(both(10.0))
    assert min(test.p_value for test in namer.test(())) > LEVEL
    result = name_missing(namer, lambda _: None)
    assert result.gate[0].p_value <= LEVEL
    named = {(namer.pool.groups[m].candidate.effect, namer.pool.groups[m].candidate.at) for m in result.members}
    assert named in (set(CAUSES), {("servo_droop", (1,)), CAUSES[1]})  # one pattern to the tip


def test_they_are_not_sought_where_the_mismatch_may_be_noise() -> None:
    result = name_missing(namer_of(both(0.5)), lambda _: None)
    assert result.members == ()
    assert result.gate[0].p_value > LEVEL


@pytest.mark.parametrize("seed", slow_but(range(4), 2))
def test_loud_visits_that_only_scatter_get_no_two_names(seed: int) -> None:
    """Of all pairs the best is chosen, and its p-value allows for that: by the usual level nothing is found."""
    null = prepared_null()
    rng = np.random.default_rng(40 + seed)
    off = rng.standard_normal((int(null.visits[-1]) + 1, null.observed.residual.shape[1]))
    noise = null.observed.whitened(noise_of(null, rng)).reshape(null.observed.residual.shape)
    namer = namer_of((noise + 5.0 * off[null.visits]).reshape(-1))
    namer.rules = replace(namer.rules, false_alarm=0.003)
    result = name_missing(namer, lambda _: None)
    assert result.members == ()
    assert result.gate[0].p_value > 0.003
