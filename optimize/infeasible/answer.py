"""What is said where no design keeps all limits: what each would have to be alone, and the smallest joint change."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from linkwright.core.arm.figures import Limit
from linkwright.core.units.quantities import NoAnswer, format_quantity


@dataclass(frozen=True)
class OutOfReach:
    """A limit that no design of any combination keeps, whatever becomes of the others: the best (SI) that it could be
    at all, and why (`because`, a phrase)."""

    limit: Limit
    best: float
    because: str

    @property
    def text(self) -> str:
        """A phrase for people."""
        best = format_quantity(self.best, self.limit.figure.kind, digits=4)
        least = "at most" if self.limit.relation == ">=" or self.best < self.limit.value else "at least"
        return f"{self.limit.text} is out of reach: {self.because} {least} {best}"


@dataclass(frozen=True)
class Needed:
    """A limit with what it would have to be (SI) for a design to keep all others as they are.

    `needed` is None where no value does (`outcome` is `none`), where the limit is not in the way (`kept`: the others
    stand in each other's way without it counts as `none`), or where the solver failed (`undecided`).
    """

    limit: Limit
    needed: float | None
    outcome: Literal["found", "none", "undecided"]

    @property
    def text(self) -> str:
        """A phrase for people."""
        if self.needed is not None:
            return f"{self.limit.text} would have to be {changed(self.limit, self.needed)}"
        if self.outcome == "none":
            return f"no value of {self.limit.name} does"
        return f"what {self.limit.text} would have to be could not be decided"


@dataclass(frozen=True)
class Change:
    """A limit and its value (SI) in the smallest joint change."""

    limit: Limit
    needed: float


@dataclass(frozen=True)
class Infeasibility:
    """Why a problem has no answer.

    `verdict`: `infeasible`, or `undecided` where the solver failed on `unsolved` of the combinations that were looked
    at and no bound speaks for them. `joint` are the limits of the smallest joint change, `joint_sum` the sum of the
    logarithms of their ratios to what was asked (for small changes, of the relative changes); None where none was
    found. `rests_on` says over which combinations the figures were found, `kept` which ranges of sizes were kept.
    """

    verdict: Literal["infeasible", "undecided"]
    out_of_reach: tuple[OutOfReach, ...]
    limits: tuple[Needed, ...]
    joint: tuple[Change, ...]
    joint_sum: float | None
    combinations: int
    looked_at: int
    unsolved: int
    rests_on: str
    kept: str

    @property
    def text(self) -> str:
        """The whole in one line."""
        parts = [item.text for item in self.out_of_reach]
        alone = [limit.text for limit in self.limits]
        if len(alone) == 1:
            parts += alone
        elif alone:
            parts.append(f"each alone, the others kept: {', '.join(alone)}")
            if self.joint and self.joint_sum is not None:
                joint = " and ".join(f"{item.limit.name} {changed(item.limit, item.needed)}" for item in self.joint)
                parts.append(f"smallest change of the limits, together: {joint}")
        if self.verdict == "undecided":
            words = f"could not be decided: the solver failed on {self.unsolved} of {self.looked_at} combinations"
            text = f"{words}, the others keep no set of limits" if self.unsolved < self.looked_at else words
        else:
            text = "no design keeps all limits"
        return f"{text}: {'; '.join(parts)} ({self.rests_on}; {self.kept})" if parts else f"{text} ({self.kept})"


def changed(limit: Limit, value: float) -> str:
    """The limit with another value (SI), as people write it."""
    return f"{limit.relation} {format_quantity(value, limit.figure.kind, digits=4)}"


class Infeasible(NoAnswer):
    """No design keeps all limits, or none was found; `infeasible` says all that is known of it."""

    def __init__(self, infeasible: Infeasibility, more: str = "") -> None:
        super().__init__(infeasible.text + more)
        self.infeasible = infeasible
        self._more = more

    def __reduce__(self) -> tuple[object, ...]:
        """Keep what is known when the error crosses between processes."""
        return Infeasible, (self.infeasible, self._more)
