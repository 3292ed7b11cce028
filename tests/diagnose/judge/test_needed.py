"""Names that held-out readings need stand first, and what can be left out together is small."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from linkwright.core.diagnose.judge.needed import needed
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.diagnose.core_cases import recorded, with_effects
from tests.diagnose.made_diagnosis import made_arm


def held_out(patterns, sizes, sigma):
    """Held-out RMS in closed form with names left out: noise, and the part of their patterns (N, k) that others do not
    take over, which least squares of the rest leaves (G. A. F. Seber, Linear Regression Analysis, 1977, ch. 3)."""

    def left(out):
        kept = np.delete(patterns, list(out), axis=1)
        missing = patterns[:, list(out)] @ sizes[list(out)]
        rest = missing - kept @ np.linalg.lstsq(kept, missing, rcond=None)[0] if kept.shape[1] else missing
        return np.array([np.sqrt(sigma**2 + np.mean(rest**2))])

    return left


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 6), st.floats(0.05, 2.0))
def test_small_names_can_be_left_out_together_and_no_more_can(seed, count, sigma):
    """However patterns resemble each other: without all small ones held-out readings get worse by less than the rule
    says, with any other name left out beside them by more; one name always stays."""
    rng = np.random.default_rng(seed)
    patterns = rng.standard_normal((60, count)) @ (np.eye(count) + 0.6 * rng.standard_normal((count, count)))
    left = held_out(patterns, np.exp(1.5 * rng.standard_normal(count)), sigma)
    made = needed([0.0] * count, left, rules=RULES)
    most = (1.0 + RULES.answer.small) * left(())
    assert sorted(made.order) == list(range(count))
    assert len(made.small) < count
    assert set(made.order[len(made.order) - len(made.small) :]) == set(made.small)
    assert (left(made.small) <= most).all()
    first, *others = [place for place in made.order if place not in made.small]
    assert all((left((*made.small, place)) > most).all() for place in others)
    assert all((made.without[first] >= each).all() for each in made.without)


def test_names_that_stand_for_each_other_are_not_both_small():
    """Two equal patterns cost nothing one by one and everything together."""
    patterns = np.random.default_rng(1).standard_normal((60, 2))
    left = held_out(patterns[:, [0, 1, 1]], np.array([3.0, 1.0, 1.0]), 0.3)
    made = needed([0.0] * 3, left, rules=RULES)
    assert made.order[0] == 0
    assert len(made.small) == 1


def test_what_a_single_joint_needs_is_not_small():
    """Of several branches one that gets worse is enough, however little that is in all together; nor is small what
    moves half of the mismatch."""

    def left(out):
        return np.array([10.0 + 5.0 * (0 in out), 0.1 + 0.02 * (1 in out)])

    assert needed([0.0] * 3, left, rules=RULES).small == (2,)
    assert needed([0.0, 0.0, 0.5], left, rules=RULES).small == ()


def test_a_small_cause_stands_last_with_what_it_moves():
    """Two drives that give by a lot, and a zero off by less than the noise: it is named last and called small, as
    held-out readings are no worse without it."""
    true = with_effects(
        made_arm(),
        ("joint_compliance", (2,), {"compliance": 2e-5}),
        ("joint_compliance", (3,), {"compliance": 4e-5}),
        ("encoder_offset", (3,), {"offset": 2e-5}),
    )
    result = diagnose(made_arm(), recorded(true, poses=60, repeats=3, noise=2e-5, seed=3))
    assert [(item.effect, item.at, item.small) for item in result.findings] == [
        ("joint_compliance", (2,), False),
        ("joint_compliance", (3,), False),
        ("encoder_offset", (3,), True),
    ]
    assert result.small_together == pytest.approx(result.findings[2].rms_explained)
