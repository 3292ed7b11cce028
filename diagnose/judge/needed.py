"""Which names the held-out figure needs, and which are small: those that can be left out together."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array


@dataclass(frozen=True)
class Needed:
    """The places of names in the `order` in which they are shown, and those of them that are `small`, which stand
    last: each part by what leaving a name out costs held-out readings, the dearest first. `without` is the held-out RMS
    (J,) of each branch with a name left out, name by name."""

    order: tuple[int, ...]
    small: tuple[int, ...]
    without: tuple[Array, ...]


def needed(moves: Sequence[float], left: Callable[[Sequence[int]], Array], *, rules: Rules) -> Needed:
    """The names that held-out readings need.

    Of all but the dearest name the cheapest is left out, then the next beside it, as long as held-out readings do not
    get worse in any branch by the rule's share: names that stand for each other are not both small. What moves much is
    not small, though others would take its place.

    Args:
        moves: How much each name adds, as a share of the mismatch (RMS, the largest of all branches).
        left: Held-out RMS (J,) of each branch with the names at some places left out and the rest fitted again.
        rules: From which share on held-out readings need a name.

    >>> from linkwright.core.diagnose.rules.rules import RULES
    >>> size = np.array([0.1, 2.0, 0.2])
    >>> left = lambda out: np.array([np.sqrt(1.0 + np.sum(size[list(out)] ** 2))])
    >>> made = needed([0.05, 0.9, 0.1], left, rules=RULES)
    >>> made.order, made.small
    ((1, 2, 0), (2, 0))
    """
    count = len(moves)
    whole, without = left(()), tuple(left((place,)) for place in range(count))
    cost = [float(np.max(each / np.maximum(whole, 1e-30))) for each in without]
    order = sorted(range(count), key=lambda place: -cost[place])
    most = (1.0 + rules.answer.small) * whole
    small: list[int] = []
    for place in reversed(order[1:]):
        if moves[place] >= rules.answer.kept_anyway:
            continue
        if (without[place] <= most).all() and (not small or (left((*small, place)) <= most).all()):
            small.append(place)
    return Needed(tuple(sorted(order, key=lambda place: place in small)), tuple(reversed(small)), without)


def small_words(count: int, together: str) -> str:
    """Small names as one; `together` is what they add, with its unit."""
    return f"{count} small {'one' if count == 1 else 'ones, together'} {together} RMS"
