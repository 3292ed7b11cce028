"""The rivals of a diagnosis on the same held-out parts, and which of them the file holds.

Written is what predicts held-out readings best; of rivals within one standard error of it the one with the fewest
numbers (the one-standard-error rule: L. Breiman et al., Classification and Regression Trees, 1984, sec. 3.4.3). Nothing
here has a unit: losses are compared within each branch, a joint's torque or the tip's position.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

import numpy as np

from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array

Name = Literal["nominal", "textbook", "named", "pair", "ridge"]

_ORDER: tuple[Name, ...] = ("nominal", "named", "pair", "textbook", "ridge")
"""Of rivals with as many numbers the first is preferred."""
_SUBJECT = MappingProxyType(
    {
        "nominal": "The arm as given",
        "textbook": "The textbook calibration",
        "named": "The arm with the named causes",
        "pair": "The arm with two plain sizes",
        "ridge": "The arm with the named causes and a small share of the rest",
    }
)


@dataclass(frozen=True)
class Rival:
    """One model of an arm, as its file would hold it, on readings that it was fitted to and on others.

    Attributes:
        name: Which rival it is.
        parameters: How many numbers were fitted for it.
        in_sample: RMS of what it leaves of the readings that it was fitted to.
        held_out: RMS of what it leaves of each part, fitted to the others.
        losses: (P, J) sums of squares that it leaves of each held-out part in each branch: joints, or one for tips.
            Parts are independent of each other: blocks of time, visits, cells, whole recordings.
        rows: (P, J) readings in each part and branch, the same for all rivals.
    """

    name: Name
    parameters: int
    in_sample: float
    held_out: float
    losses: Array
    rows: Array

    @property
    def subject(self) -> str:
        """What it is, at the beginning of a sentence."""
        return _SUBJECT[self.name]

    def rms(self) -> Array:
        """Held-out RMS (J,) of each branch; nan where no reading is."""
        count = self.rows.sum(axis=0)
        return np.where(count > 0, np.sqrt(self.losses.sum(axis=0) / np.maximum(count, 1)), np.nan)


@dataclass(frozen=True)
class Rivals:
    """All rivals, which of them is `written`, and `why` in one sentence."""

    table: tuple[Rival, ...]
    written: Name
    why: str

    def of(self, name: Name) -> Rival | None:
        """A rival by name; None where it was not tried."""
        return next((rival for rival in self.table if rival.name == name), None)


def chosen(rivals: Sequence[Rival], *, rules: Rules) -> Rivals:
    """Which rival the file holds.

    Args:
        rivals: The rivals, the arm as given (`nominal`) among them, all on the same parts and branches.
        rules: From which ratio on a rival is worse than the arm as given in some branch.

    Returns:
        The rivals with the one that is written: the best held out, or the one with the fewest numbers that is no more
        than one standard error worse; none that is worse than the arm as given, on the whole or in some branch by more
        than a standard error and the rule's ratio.

    Raises:
        ValueError: No nominal rival, or parts that differ.

    >>> from linkwright.core.diagnose.rules.rules import RULES
    >>> rows = np.full((4, 1), 10.0)
    >>> table = [
    ...     Rival("nominal", 0, 2.0, 2.0, np.full((4, 1), 40.0), rows),
    ...     Rival("named", 1, 1.0, 1.0, np.full((4, 1), 10.0), rows),
    ...     Rival("textbook", 9, 0.9, 1.0, np.array([[9.0], [10.5], [9.5], [10.5]]), rows),
    ... ]
    >>> chosen(table, rules=RULES).written
    'named'
    """
    nominal = next((rival for rival in rivals if rival.name == "nominal"), None)
    if nominal is None:
        raise ValueError("the arm as given is no rival")
    if any(rival.losses.shape != nominal.losses.shape or (rival.rows != nominal.rows).any() for rival in rivals):
        raise ValueError("rivals of different parts")
    weights = _weights(rivals)
    allowed = [
        rival for rival in rivals if rival is nominal or _no_worse(rival, nominal, weights, rules.fitting.no_worse)
    ]
    best = min(allowed, key=lambda rival: (_total(rival, weights), _ORDER.index(rival.name)))
    alike = [rival for rival in allowed if _within(rival, best, weights)]
    written = min(alike, key=lambda rival: (rival.parameters, _ORDER.index(rival.name)))
    return Rivals(tuple(rivals), written.name, _why(rivals, allowed, best, written))


def difference(one: Rival, other: Rival, weights: Array) -> tuple[float, float]:
    """How much more a rival leaves of held-out parts than another, branches weighed by `weights` (J,), and the standard
    error of that by how parts differ (infinite of a single part that differs)."""
    each = (one.losses - other.losses) @ weights
    each = each[(one.rows @ (weights > 0.0)) > 0]
    if len(each) < 2:
        return float(each.sum()), math.inf if each.any() else 0.0
    return float(each.sum()), math.sqrt(len(each) * float(np.var(each, ddof=1)))


def _weights(rivals: Sequence[Rival]) -> Array:
    """What a unit of loss counts in each branch (J,): as if the least that any rival leaves there were noise."""
    rows = rivals[0].rows.sum(axis=0)
    least = np.min([rival.losses.sum(axis=0) for rival in rivals], axis=0)
    return np.where(rows > 0, rows / np.maximum(least, 1e-30), 0.0)


def _total(rival: Rival, weights: Array) -> float:
    return float((rival.losses @ weights).sum())


def _within(rival: Rival, best: Rival, weights: Array) -> bool:
    """Whether a rival is no more than one standard error worse than the best."""
    more, error = difference(rival, best, weights)
    return rival is best or more <= (error if math.isfinite(error) else 0.0)


def _no_worse(rival: Rival, nominal: Rival, weights: Array, worse: float) -> bool:
    """Whether a rival is no worse than the arm as given: less on the whole, and in no branch more than chance and
    `worse` times its RMS."""
    if not np.isfinite(rival.losses).all() or difference(rival, nominal, weights)[0] >= 0.0:
        return False
    losses, given = rival.losses.sum(axis=0), nominal.losses.sum(axis=0)
    for branch in np.flatnonzero(losses > worse**2 * given):
        more, error = difference(rival, nominal, np.where(np.arange(len(weights)) == branch, weights, 0.0))
        if more > (error if math.isfinite(error) else 0.0):
            return False
    return True


def _why(rivals: Sequence[Rival], allowed: Sequence[Rival], best: Rival, written: Rival) -> str:
    subject = _SUBJECT[written.name]
    if written.name == "nominal" and len(allowed) == 1:
        return f"{subject} is written, because every rival is worse than that on held-out readings somewhere."
    if written is not best:
        other = _SUBJECT[best.name]
        return (
            f"{subject} is written, because it has fewer numbers and is within one standard error of "
            f"{other[0].lower()}{other[1:]} on held-out readings."
        )
    if len(allowed) < len(rivals) and _total(best, _weights(rivals)) > min(_total(r, _weights(rivals)) for r in rivals):
        return f"{subject} is written, because every better rival makes some joint worse than it was given."
    return f"{subject} is written, because it predicts held-out readings best."
