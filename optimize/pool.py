"""The binding poses found so far: what the finite problem of the exchange knows of the infinite one."""

from __future__ import annotations

from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Anchor:
    """What holds a pose while lengths change: its tip (m), and the directions (rows) in which joints can move without it."""

    tip: tuple[float, float, float]
    null: tuple[tuple[float, ...], ...]


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
    """A pose at which a stress or a compression binds."""

    q: tuple[float, ...]
    load_case: int


@dataclass(frozen=True)
class ModeCut:
    """A pose and trial shape at which the first frequency binds, with the payload (kg) then carried."""

    q: tuple[float, ...]
    payload: float
    shape: tuple[float, ...]


@dataclass(frozen=True)
class Pool:
    """All binding poses found so far."""

    errors: tuple[ErrorCut, ...] = ()
    strengths: tuple[StrengthCut, ...] = ()
    modes: tuple[ModeCut, ...] = ()

    @property
    def size(self) -> int:
        """How many poses there are."""
        return len(self.errors) + len(self.strengths) + len(self.modes)

    def room(self, cases: int) -> tuple[int, int, int]:
        """How many slots a program needs for each load case's errors, each load case's strengths, and modes."""
        errors = max(sum(cut.load_case == case for cut in self.errors) for case in range(cases))
        strengths = max(sum(cut.load_case == case for cut in self.strengths) for case in range(cases))
        return errors, strengths, len(self.modes)

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

    def with_modes(self, cuts: tuple[ModeCut, ...]) -> Pool:
        """The pool with more modes."""
        return replace(self, modes=self.modes + cuts)


def _key(cut: ErrorCut) -> tuple[object, ...]:
    place = tuple(round(value, 7) for value in cut.q)
    return place, cut.load_case, cut.signs, tuple(round(value, 9) for value in cut.shift)
