"""The whole search calibrated, selection included: what the best subset gains on recordings that hold nothing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from linkwright.core.diagnose.patterns.pool import Pool
from linkwright.core.executors import Executor, Here, Work
from linkwright.core.sections.numeric import Array

from .calibrate import drawn_anew, p_value
from .naming import Named, Namer
from .subsets import Criterion, best_subsets


@dataclass(frozen=True)
class _Sought:
    """What is sought in each draw: the best subset of up to so many groups of a pool."""

    pool: Pool
    criterion: Criterion
    largest: int


def _same(sought: _Sought) -> _Sought:
    return sought


def _gained(sought: _Sought, drawn: Array) -> float:
    """How far the criterion drops from the model as given, for a draw (n,)."""
    found = best_subsets(sought.pool, sought.pool.projected(drawn), sought.criterion, largest=sought.largest)
    nothing = found[0][0].criterion
    return max(nothing - subsets[0].criterion for subsets in found.values())


def whole_search_p(
    namer: Namer, named: Named, seed: int, tell: Callable[[float], None], executor: Executor | None = None
) -> float:
    """The p-value of what was named: the residual drawn anew by visits as the gate does it, and the best subset of up
    to as many members (three at most) sought in each draw, over library and forms alike.

    The statistic is the drop of the criterion from the model as given. `tell` hears the share of the work done, the
    draws are searched by `executor`.
    """
    prepared, pool, criterion = namer.prepared, namer.prepared.pool, namer.criterion
    largest = min(max(len(named.everything), 1), 3)
    width = prepared.observed.residual.shape[1]
    table = prepared.vector.reshape(-1, width)
    rng = np.random.default_rng(seed)
    rules = namer.rules
    draws = [drawn_anew(table, namer.visits, rng, rules=rules).reshape(-1) for _ in range(rules.whole_draws)]
    work = Work(partial(_same, _Sought(pool, criterion, largest)), _gained)
    done = 0

    def count(number: int, result: float) -> None:
        nonlocal done
        del number, result
        done += 1

    drawn = (executor or Here()).map(work, draws, lambda: tell(done / len(draws)), count)
    gained = namer.criterion_of(()) - namer.criterion_of(named.everything)
    return p_value(gained, np.array(drawn))
