"""The whole search calibrated, selection included: what the best subset gains on recordings that hold nothing."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .calibrate import drawn_anew, p_value
from .naming import Named, Namer
from .subsets import best_subsets


def whole_search_p(namer: Namer, named: Named, seed: int, tell: Callable[[float], None]) -> float:
    """The p-value of what was named: the residual drawn anew by visits as the gate does it, and the best subset of up
    to as many members (three at most) sought in each draw, over library and forms alike.

    The statistic is the drop of the criterion from the model as given. `tell` hears the share of the work done.
    """
    prepared, pool, criterion = namer.prepared, namer.prepared.pool, namer.criterion
    largest = min(max(len(named.everything), 1), 3)
    width = prepared.observed.residual.shape[1]
    table = prepared.vector.reshape(-1, width)
    rng = np.random.default_rng(seed)
    drawn: list[float] = []
    rules = namer.rules
    for number in range(rules.whole_draws):
        vector = pool.projected(drawn_anew(table, namer.visits, rng, rules=rules).reshape(-1))
        found = best_subsets(pool, vector, criterion, largest=largest)
        nothing = found[0][0].criterion
        drawn.append(max(nothing - subsets[0].criterion for subsets in found.values()))
        tell((number + 1) / rules.whole_draws)
    gained = namer.criterion_of(()) - namer.criterion_of(named.everything)
    return p_value(gained, np.array(drawn))
