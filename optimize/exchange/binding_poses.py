"""The binding poses found so far: what the finite problem of the exchange knows of the infinite one."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from linkwright.core.arm.figures import Cut


@dataclass(frozen=True)
class Anchor:
    """What holds a pose while lengths change: its tip (m), and the directions (rows) in which its joints stay.

    `side` (-1 or 1) is the sign of the determinant of the tip's Jacobian with those rows below it: where an arm is
    nearly stretched, its elbow could otherwise flip to the other side, where the error is another. `free`: joints to
    spare may move as they like, for the pose is there so that the place is reached, in whatever way.
    """

    tip: tuple[float, float, float]
    held: tuple[tuple[float, ...], ...]
    side: float
    free: bool = False


@dataclass(frozen=True)
class ErrorCut:
    """A pose at which the error binds: joint coordinates, load case, and where its play stands (signs, shift in m)."""

    q: tuple[float, ...]
    load_case: int
    signs: tuple[float, ...]
    shift: tuple[float, float, float]
    anchor: Anchor | None = None

    @property
    def group(self) -> int:
        """The load case, by the name that it has for other poses."""
        return self.load_case


@dataclass(frozen=True)
class Room:
    """Slots of a compiled program: for each load case's errors, and for each group of poses of each family of figures
    (by its name)."""

    errors: tuple[int, ...]
    held: tuple[tuple[str, tuple[int, ...]], ...] = ()

    def slots(self, family: str, groups: int) -> tuple[int, ...]:
        """The slots of each group of a family's poses."""
        return dict(self.held).get(family, (0,) * groups)

    def holds(self, other: Room) -> bool:
        """Whether there is room for what `other` needs; a group without poses cannot fill its slots."""
        pairs = list(zip(self.errors, other.errors, strict=True))
        for family in dict(self.held) | dict(other.held):
            groups = max(len(dict(item.held).get(family, ())) for item in (self, other))
            pairs += zip(self.slots(family, groups), other.slots(family, groups), strict=True)
        return all(_fits(have, need) for have, need in pairs)

    def spare(self, errors: int = 1) -> Room:
        """Room to grow: the next power of two, at least `errors` for each load case's errors."""
        return Room(
            tuple(max(_grown(need), errors if need else 0) for need in self.errors),
            tuple((family, tuple(map(_grown, slots))) for family, slots in self.held),
        )


def _fits(have: int, need: int) -> bool:
    return need <= have and (need > 0 or have == 0)


def _grown(need: int) -> int:
    return 0 if need == 0 else 2 ** math.ceil(math.log2(need + 1))


@dataclass(frozen=True)
class Pool:
    """All binding poses found so far: those of the error, and those of each family of figures (by its name)."""

    errors: tuple[ErrorCut, ...] = ()
    held: tuple[tuple[str, tuple[Cut, ...]], ...] = ()

    @property
    def size(self) -> int:
        """How many poses there are."""
        return len(self.errors) + sum(len(cuts) for _, cuts in self.held)

    def of(self, family: str) -> tuple[Cut, ...]:
        """A family's poses."""
        return dict(self.held).get(family, ())

    def room(self, cases: int, groups: Mapping[str, int]) -> Room:
        """How many slots a program needs for these poses, given the load cases and the groups of each family."""
        return Room(
            tuple(sum(cut.load_case == case for cut in self.errors) for case in range(cases)),
            tuple(
                (family, tuple(sum(cut.group == group for cut in self.of(family)) for group in range(count)))
                for family, count in groups.items()
            ),
        )

    def joined(self, other: Pool) -> Pool:
        """The poses of both pools, repeats left out."""
        grown = self.with_errors(other.errors)
        for family, cuts in other.held:
            grown = grown.with_cuts(family, cuts)
        return grown

    def with_errors(self, cuts: tuple[ErrorCut, ...]) -> Pool:
        """The pool with more error cuts, repeats left out."""
        known = {_key(cut) for cut in self.errors}
        fresh: list[ErrorCut] = []
        for cut in cuts:
            if _key(cut) not in known:
                known.add(_key(cut))
                fresh.append(cut)
        return replace(self, errors=self.errors + tuple(fresh))

    def with_cuts(self, family: str, cuts: Sequence[Cut]) -> Pool:
        """The pool with more poses of a family, repeats left out."""
        cuts_before = self.of(family)
        fresh = tuple(cut for cut in dict.fromkeys(cuts) if cut not in cuts_before)
        return replace(self, held=tuple((dict(self.held) | {family: cuts_before + fresh}).items())) if fresh else self


def _key(cut: ErrorCut) -> tuple[object, ...]:
    place = tuple(round(value, 7) for value in cut.q)
    return place, cut.load_case, cut.signs, tuple(round(value, 9) for value in cut.shift)
