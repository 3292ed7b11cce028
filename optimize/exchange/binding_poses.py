"""The binding poses found so far: what the finite problem of the exchange knows of the infinite one."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Anchor:
    """What holds a pose while lengths change: its tip (m), and the directions (rows) in which joints move without it.

    `side` (-1 or 1) is the sign of the determinant of the tip's Jacobian with those rows below it: where an arm is
    nearly stretched, its elbow could otherwise flip to the other side, where the error is another.
    """

    tip: tuple[float, float, float]
    null: tuple[tuple[float, ...], ...]
    side: float


@dataclass(frozen=True)
class ErrorCut:
    """A pose at which the error binds: joint coordinates, load case, and where its play stands (signs, shift in m)."""

    q: tuple[float, ...]
    load_case: int
    signs: tuple[float, ...]
    shift: tuple[float, float, float]
    anchor: Anchor | None = None


@dataclass(frozen=True)
class StrengthCut:
    """A pose at which a stress, a compression or the load on a drive binds."""

    q: tuple[float, ...]
    load_case: int


@dataclass(frozen=True)
class ModeCut:
    """A pose and trial shape at which the first frequency binds, with the payload (kg) then carried."""

    q: tuple[float, ...]
    payload: float
    shape: tuple[float, ...]


@dataclass(frozen=True)
class Room:
    """Slots of a compiled program: for each load case's errors, for each load case's strengths, for modes, and for each
    load case's drive loads."""

    errors: tuple[int, ...]
    strengths: tuple[int, ...]
    modes: int
    torques: tuple[int, ...] = ()

    def holds(self, other: Room) -> bool:
        """Whether there is room for what `other` needs; a load case without poses of its own cannot fill its slots."""
        pairs = [*zip(self.errors, other.errors, strict=True), *zip(self.strengths, other.strengths, strict=True)]
        pairs += zip(self.torques, other.torques, strict=True)
        return all(_fits(have, need) for have, need in [*pairs, (self.modes, other.modes)])

    def spare(self, errors: int = 1) -> Room:
        """Room to grow: the next power of two, at least `errors` for each load case's errors."""
        return Room(
            tuple(max(_grown(need), errors if need else 0) for need in self.errors),
            tuple(map(_grown, self.strengths)),
            _grown(self.modes),
            tuple(map(_grown, self.torques)),
        )


def _fits(have: int, need: int) -> bool:
    return need <= have and (need > 0 or have == 0)


def _grown(need: int) -> int:
    return 0 if need == 0 else 2 ** math.ceil(math.log2(need + 1))


@dataclass(frozen=True)
class Pool:
    """All binding poses found so far."""

    errors: tuple[ErrorCut, ...] = ()
    strengths: tuple[StrengthCut, ...] = ()
    modes: tuple[ModeCut, ...] = ()
    torques: tuple[StrengthCut, ...] = ()

    @property
    def size(self) -> int:
        """How many poses there are."""
        return len(self.errors) + len(self.strengths) + len(self.modes) + len(self.torques)

    def room(self, cases: int) -> Room:
        """How many slots a program needs for these poses."""
        return Room(
            tuple(sum(cut.load_case == case for cut in self.errors) for case in range(cases)),
            tuple(sum(cut.load_case == case for cut in self.strengths) for case in range(cases)),
            len(self.modes),
            tuple(sum(cut.load_case == case for cut in self.torques) for case in range(cases)),
        )

    def joined(self, other: Pool) -> Pool:
        """The poses of both pools, repeats left out."""
        modes = tuple(mode for mode in other.modes if mode not in self.modes)
        grown = self.with_errors(other.errors).with_strengths(other.strengths).with_modes(modes)
        return grown.with_torques(other.torques)

    def with_errors(self, cuts: tuple[ErrorCut, ...]) -> Pool:
        """The pool with more error cuts, repeats left out."""
        known = {_key(cut) for cut in self.errors}
        fresh: list[ErrorCut] = []
        for cut in cuts:
            if _key(cut) not in known:
                known.add(_key(cut))
                fresh.append(cut)
        return replace(self, errors=self.errors + tuple(fresh))

    def with_strengths(self, cuts: tuple[StrengthCut, ...]) -> Pool:
        """The pool with more strength cuts, repeats left out."""
        fresh = tuple(cut for cut in dict.fromkeys(cuts) if cut not in self.strengths)
        return replace(self, strengths=self.strengths + fresh)

    def with_torques(self, cuts: tuple[StrengthCut, ...]) -> Pool:
        """The pool with more poses at which drives are loaded most, repeats left out."""
        fresh = tuple(cut for cut in dict.fromkeys(cuts) if cut not in self.torques)
        return replace(self, torques=self.torques + fresh)

    def with_modes(self, cuts: tuple[ModeCut, ...]) -> Pool:
        """The pool with more modes."""
        return replace(self, modes=self.modes + cuts)


def _key(cut: ErrorCut) -> tuple[object, ...]:
    place = tuple(round(value, 7) for value in cut.q)
    return place, cut.load_case, cut.signs, tuple(round(value, 9) for value in cut.shift)
