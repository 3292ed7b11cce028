"""What was chosen of counterweights and counterbalances, beside what the arm as given has."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwright.core.optimize.result import ChosenBalance

if TYPE_CHECKING:
    from linkwright.core.optimize.choice.combinations import Choice
    from linkwright.core.optimize.problem import Problem

_AT_BOUND = 1e-4
"""So near (relative to the range) a number counts as at its bound."""


def balance_of(problem: Problem, choice: Choice) -> tuple[ChosenBalance, ...]:
    """What a choice has of each number that was free."""
    values = choice.space.balance([float(value) for value in choice.exchanged.x])
    chosen: list[ChosenBalance] = []
    for balance in problem.balances:
        value = float(values[balance.place, balance.field])
        near = _AT_BOUND * (balance.upper - balance.lower)
        bound = "least" if value < balance.lower + near else "greatest" if value > balance.upper - near else None
        chosen.append(
            ChosenBalance(balance.words, balance.place + 1, balance.field, balance.kind, balance.given, value, bound)
        )
    return tuple(chosen)
