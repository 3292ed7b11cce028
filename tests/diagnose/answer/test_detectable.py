"""The smallest size that would have been found is found nine times in ten."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import stats

from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.answer.detectable import POWER, _needed, detectable
from linkwright.core.diagnose.patterns.library import parameter_of
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.diagnose.search.calibrate import p_value
from linkwright.core.diagnose.search.naming import Namer
from tests.costs import slow_but
from tests.diagnose.core_cases import group_of, noise_of, prepared_null, with_residual

TRIALS = 240
LEVEL = RULES.search.false_alarm


@pytest.fixture(scope="module", params=[False, True], ids=["plane", "space"])
def gate(request):
    null = prepared_null(request.param)
    tested = Namer(null, thorough=True, seed=1).test(())[0]
    return null, tested


def statistic(prepared, number):
    """The statistic of one group alone: what its part of the residual is worth in the criterion."""
    group = prepared.pool.groups[number]
    along = prepared.pool.basis[:, group.start : group.stop].T @ prepared.vector
    share = float(along @ along) / float(prepared.vector @ prepared.vector)
    return -prepared.criterion.count * np.log1p(-share) - float(prepared.criterion.price[number])


EFFECTS_TRIED = ("encoder_offset", "joint_compliance", "encoder_eccentricity", "payload")


@pytest.mark.parametrize("effect", slow_but(EFFECTS_TRIED, "encoder_eccentricity", "payload"))
def test_power_at_the_stated_size(gate, effect):
    """Monte Carlo: noise and the effect at that size, how often its own statistic passes the gate."""
    null, tested = gate
    at = () if effect == "payload" else (1,)
    result = next(
        d
        for d in detectable(null, tested, 1.0, LEVEL)
        if (d.effect, d.at) == (effect, tuple(index + 1 for index in at))
    )
    number = group_of(null, effect, at)
    names = null.pool.groups[number].candidate.sizes
    signal = result.value * null.columns[number][:, :, names.index(result.parameter)]
    rng = np.random.default_rng(7)
    passed = 0
    for _ in range(TRIALS):
        trial = with_residual(null, signal + noise_of(null, rng))
        passed += p_value(statistic(trial, number), tested.drawn) <= LEVEL
    # Binomial scatter of 240 trials is 0.019; three of them, and 0.02 for the level's own (2999 draws).
    assert passed / TRIALS == pytest.approx(0.9, abs=0.08)
    tip = signal[:, : null.observed.components]
    assert result.rms == pytest.approx(np.sqrt(np.mean(np.sum(tip**2, axis=1))))
    assert result.kind == parameter_of(EFFECTS[effect], result.parameter).kind


def test_twice_the_noise_hides_twice_as_much(gate):
    null, tested = gate
    once, twice = (
        detectable(null, tested, 1.0, LEVEL),
        detectable(null, tested, 2.0, LEVEL),
    )
    size = {(item.effect, item.at): item.value for item in once}
    ratio = [item.value / size[item.effect, item.at] for item in twice]
    assert ratio == pytest.approx([2.0] * len(twice))
    assert len(once) >= len(twice) > 0.8 * len(once)  # what could only be shown beyond its bounds is not listed


def test_a_pattern_within_the_nuisances_shows_only_what_is_left():
    """With the frame free, an offset of encoder 1 is a turn of the frame; encoder 3 must be larger to be seen."""
    known, free = prepared_null(), prepared_null(free_frame=True)
    sizes = []
    for prepared in (known, free):
        tested = Namer(prepared, thorough=False, seed=1).test(())[0]
        results = {(d.effect, d.at): d for d in detectable(prepared, tested, 1.0, LEVEL)}
        sizes.append(results)
    assert ("encoder_offset", (1,)) in sizes[0]
    assert ("encoder_offset", (1,)) not in sizes[1]
    assert ("instrument_scale", ()) in sizes[1]
    ratio = sizes[1]["encoder_offset", (2,)].value / sizes[0]["encoder_offset", (2,)].value
    assert ratio > 1.3
    visible = sizes[1]["encoder_offset", (2,)].visible
    assert ratio == pytest.approx(1.0 / visible, rel=0.25)


def test_gate_gives_each_group_its_own_statistic(gate):
    """What the test above computes by hand is what the gate computes."""
    null, tested = gate
    rng = np.random.default_rng(9)
    trial = with_residual(null, noise_of(null, rng))
    namer = Namer(trial, thorough=False, seed=1)
    result = namer.test(())[0]
    for effect in ("encoder_offset", "joint_compliance"):
        number = group_of(trial, effect, (1,))
        assert result.each[number] == pytest.approx(statistic(trial, number), rel=1e-6, abs=1e-6)
    assert tested.p_value > LEVEL


def needed(count, threshold, rank=2, price=5.0):
    criterion = SimpleNamespace(count=count)
    return _needed(SimpleNamespace(criterion=criterion), threshold)(rank, price)


def test_the_power_asked_is_had():
    """By the definition: a non-central chi-square passes the limit as often as asked."""
    result = needed(200, 20.0)
    limit = 198 * math.expm1(25.0 / 200)
    assert stats.ncx2.sf(limit, 2, result) == pytest.approx(POWER, rel=1e-6)


@pytest.mark.parametrize("threshold", [100.0, 300.0, 600.0])
def test_few_readings_under_a_high_threshold_need_the_more(threshold):
    """Where squares of normal numbers are huge their root is normal: sqrt(limit) and the quantile of the power."""
    limit = 10.0 * math.expm1((threshold + 5.0) / 12)
    normal = (limit**0.5 + stats.norm.ppf(POWER)) ** 2
    assert needed(12, threshold) == pytest.approx(normal, rel=1e-2)
