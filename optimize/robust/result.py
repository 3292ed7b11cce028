"""What an arm's error is where not all of it is known, in SI."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from linkwright.core.optimize.uncertain import Scenario


@dataclass(frozen=True)
class RobustFigure:
    """The worst error (m) of an arm over what is uncertain of it: the worst of all (`share` 1), or what a share of all
    does not exceed.

    `nominal` is that of the arm as it is, `scenario` one at which it has the value. Of the worst, `looked_at` vertices
    and inner points were searched, without proof that none is worse. Of a share, `value` is the quantile of `looked_at`
    fresh samples, and `upper` what the share does not exceed with 95 % confidence (None where that takes more
    samples). `singles` are the worst errors (m) of each load case and point with a limit, by the limit's name.
    """

    share: float
    value: float
    nominal: float
    scenario: Scenario
    looked_at: int
    upper: float | None
    widths: Mapping[str, tuple[float, ...]]
    singles: Mapping[str, float] = field(default_factory=dict[str, float])

    @property
    def errors(self) -> dict[str, float]:
        """All errors (m) that a limit may be on, by its name."""
        return {"max_error": self.value, **self.singles}


@dataclass(frozen=True)
class Robust:
    """A robust optimum beside the nominal one: each design's robust figure, found by the same search with the same
    fresh samples, and how it was found.

    `scenarios` are those that the exchange ended with, `claimed` the error (m) over them. `rounds`: how many times the
    design was sought. `samples`: of which a share was held (0 for the worst). `doubts`: what fresh scenarios speak
    against, in words. `kept_nominal`: none was found that is better than the nominal optimum. `costs`: by how much (SI)
    the objective of the arm as it is becomes worse for it.
    """

    design: RobustFigure
    nominal_design: RobustFigure
    claimed: float
    scenarios: tuple[Scenario, ...]
    rounds: int
    samples: int
    kept_nominal: bool
    doubts: tuple[str, ...]
    costs: float = 0.0

    @property
    def loses(self) -> float:
        """By how much (m) the nominal optimum is worse than the robust one, where all that is uncertain counts."""
        return self.nominal_design.value - self.design.value
