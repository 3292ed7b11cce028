"""A plan: the readings to take, what they will show, and what poses at random would."""

from __future__ import annotations

import math
from dataclasses import dataclass

from arm.chain.chain import Arm
from diagnose.recording import Recording

from .asked import Asked
from .promise import Promise, Shown


@dataclass(frozen=True)
class Planned:
    """`recording` holds the readings in their order (its tips are where the arm stands undeformed), `axes` the
    numbers that the instrument reads, `promise` what they will show, `random` what some plans at random would.
    `returns` are the visits (from 1) that go back to one pose, `with_time` the largest correlation of the order with a
    joint or a side, `tried` how many visits were tried. `after` is the recording that it goes on from (None: none).
    `interrupted`: it was stopped, and is the best until then, with as many plans at random as were made."""

    arm: Arm
    asked: Asked
    recording: Recording
    axes: tuple[str, ...]
    promise: Promise
    random: tuple[Promise, ...]
    returns: tuple[int, ...]
    with_time: float
    tried: int
    seconds: float
    after: Recording | None = None
    interrupted: bool = False

    @property
    def visits(self) -> Recording:
        """The first reading of each visit."""
        rows = self.recording.row
        return self.recording.kept((rows - 1) % self.asked.repeats == 0)

    def at_random(self, shown: Shown) -> float:
        """The smallest size of a parameter that the middle one of the plans at random shows; infinite where most do not
        show it."""
        found = [next((each.smallest for each in one.shown if _same(each, shown)), math.inf) for one in self.random]
        return sorted(found)[len(found) // 2] if found else math.inf

    @property
    def told_at_random(self) -> tuple[int, int]:
        """Of how many pairs of causes how many the middle one of the plans at random tells apart: (told, pairs). What a
        plan does not see has no pairs, so that plans have not the same number of them."""
        found = sorted(((one.told, one.pairs) for one in self.random), key=lambda each: each[0] / max(each[1], 1))
        return found[len(found) // 2] if found else (0, 0)


def _same(one: Shown, other: Shown) -> bool:
    """Whether two are one cause by sizes of one kind (of a sine and a cosine either may show least)."""
    return (one.effect, one.at, one.kind) == (other.effect, other.at, other.kind)
