"""Names that are parts of a form that none of them is: each moves the tip by more than all together."""

import numpy as np
import pytest

from linkwright.core.diagnose.answer.guard.balance import balance_each_other
from linkwright.core.diagnose.rules.rules import RULES

ANGLES = np.linspace(-0.5, 0.5, 101)
BUMP = np.exp(-((ANGLES / 0.3) ** 2))


def rms(values):
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def parts_of(target, *patterns):
    """Least squares of a curve by patterns: what each makes of it (RMS), all at joint 2."""
    design = np.column_stack(patterns)
    sizes = np.linalg.lstsq(design, target, rcond=None)[0]
    return [((2,), rms(column)) for column in (design * sizes).T]


def test_an_offset_and_waves_that_draw_a_bump_balance_each_other():
    """Over a radian a bump is a constant less the cosine of the angle and of twice the angle, each larger than it."""
    parts = parts_of(BUMP, np.ones_like(ANGLES), np.cos(ANGLES), np.cos(2.0 * ANGLES))
    assert balance_each_other(parts, rms(BUMP), rules=RULES.answer)


@pytest.mark.parametrize("seed", range(5))
def test_causes_that_have_nothing_to_do_with_each_other_do_not(seed):
    """Patterns at random angles add up in squares."""
    rng = np.random.default_rng(seed)
    angles = rng.uniform(-2.0, 2.0, (40, 3))
    patterns = [np.sin(angles[:, 0]), np.cos(angles[:, 1]), np.sin(3.0 * angles[:, 2])]
    target = sum(rng.uniform(0.5, 1.0) * pattern for pattern in patterns)
    assert not balance_each_other(parts_of(target, *patterns), rms(target), rules=RULES.answer)


def test_one_name_is_balanced_by_none():
    """It moves what it explains; names at other joints do not count with it."""
    assert not balance_each_other([((1,), 1.0), ((2,), 1.0), ((3,), 1.0)], 1.0, rules=RULES.answer)
    assert not balance_each_other([], 0.0, rules=RULES.answer)
