"""The solutions of a search: a combination that comes back under the same conditions, among near ties say, is not
solved again.

The key of a solution is all that it depends on: the arm, the combination, the poses known, the start, the objective to
beat.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from typing import Any

import numpy as np

from linkwright.core.optimize.exchange.binding_poses import Room
from linkwright.core.optimize.exchange.exchange import Exchanged
from linkwright.core.optimize.exchange.program import Solution
from linkwright.core.optimize.result import Iteration


@dataclass(frozen=True)
class Answer:
    """What became of a combination solved for the poses known: its solution with the objective (SI), or neither, and
    whether the solver failed then; `relaxed` is where limits give way. `room` is that of the program."""

    room: Room
    objective: float | None
    solution: Solution | None
    unsolved: bool
    relaxed: Solution | None


@dataclass(frozen=True)
class Ended:
    """How an exchange ended (`done`, with its objective in SI), or did not: with lengths that lead nowhere
    (`unreachable`), for limits that no design near kept (`infeasible`), or for the solver; and its rounds."""

    room: Room
    done: Exchanged | None
    objective: float | None
    infeasible: bool
    unreachable: bool
    rounds: tuple[Iteration, ...]


class Solutions(dict[Hashable, Any]):
    """Answers by their keys; the drives that are chosen make several arms, whose answers stand in one cache."""


def key_of(*conditions: object) -> Hashable:
    """Numbers and arrays among the conditions by their values."""
    return tuple(
        (item.shape, tuple(item.ravel().tolist())) if isinstance(item, np.ndarray) else item for item in conditions
    )
