"""Series of estimates by chance alone, many watches at once."""

import numpy as np
from scipy import stats

from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.diagnose.watch.evidence import doubted, in_common, level, looked_for, scatter

RULE = RULES.watch


def told_at(values, errors, *, chance=RULE.false_alarm):
    """The number of recordings (G, P) after which each parameter of G watches (G, P, N) is first told to have moved,
    nought where it never is."""
    watches, series, count = values.shape
    asked = level(chance, RULE.over, series)
    told = np.zeros((watches, series), dtype=int)
    for so_far in range(3, count + 1):
        held, own = (item[:, :, :so_far].reshape(-1, so_far) for item in (values, errors))
        common = np.repeat(in_common(scatter(held, own).factor.reshape(watches, series)), series)
        columns = looked_for(np.arange(float(so_far)))
        t, freedom = doubted(held, own, np.ones((so_far, 1)), columns, common, RULE.prior)
        beyond = (2.0 * stats.t.sf(t.max(axis=1), freedom) <= asked).reshape(watches, series)
        told = np.where((told == 0) & beyond, so_far, told)
    return told
