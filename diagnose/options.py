"""What may be asked of a diagnosis."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from linkwright.core.diagnose.rules.rules import RULES, Rules

Progress = Callable[[str, float], None]
"""Hears what is being done, and what share of the whole is behind it (0 to 1)."""


def silent(_text: str, _share: float) -> None:
    """Nobody listens."""


@dataclass(frozen=True)
class Options:
    """`thorough` makes every test with more draws; `without` takes effects out of the candidates; `seed` fixes all
    random draws; `rules` are the thresholds that everything is judged by. With `rollout`, motion logs are simulated
    too."""

    thorough: bool = False
    without: frozenset[str] = frozenset()
    seed: int = 1
    rules: Rules = RULES
    rollout: bool = False
