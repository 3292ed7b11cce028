"""The search for what a recording is meant as: transformations alone and composed, against the recording as it stands.

Whatever was recorded says how likely it is under each: the sum of the logs of the shares that the arm then leaves of it
(`Judged.total`), what is fitted beside allowed for, and a cost for each transformation. No world has rules of its own.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Protocol

from .transformation import Transformation, apart


@dataclass(frozen=True, eq=False)
class Judged:
    """Transformations together.

    Args:
        parts: What was tried.
        transformation: All of it, with the torques that then count the other way.
        total: The sum of the logs of what is left, with what it costs.
        left: What the middle reading is off by, m; of torques the largest share of a joint's that is left.
        explains: Whether what is left is as little as the arm's physics leaves.
        settled: Whether so little is left that nothing more is looked for.
    """

    parts: tuple[Transformation, ...]
    transformation: Transformation
    total: float
    left: float
    explains: bool
    settled: bool = False


class Evidence(Protocol):
    """What a recording says of transformations."""

    def judged(self, several: Sequence[tuple[Transformation, ...]]) -> list[Judged]:
        """Each of several sets of transformations, in their order."""
        ...

    def sized(self, parts: tuple[Transformation, ...]) -> list[tuple[Transformation, ...]]:
        """`parts` beside transformations of one number, all numbers of the likeliest sizes."""
        ...

    def beam(self, depth: int, *, explained: bool, gained: bool) -> int:
        """Upon how many of the likeliest sets of `depth` transformations one more is tried; 0: none. `explained`: some
        set explains the recording; `gained`: the likeliest of these is likelier than any of fewer."""
        ...


def likeliest(
    evidence: Evidence, given: Judged, singles: Sequence[Transformation], again: Sequence[Transformation]
) -> list[Judged]:
    """Transformations alone and composed, the likeliest first.

    Args:
        evidence: What was recorded.
        given: The recording as it stands.
        singles: Single transformations, those that are made most first.
        again: Those of them that are tried beside another one.
    """
    results = evidence.judged([()])
    beam, more, depth = [given], singles, 0
    order = {id(single): number for number, single in enumerate(singles)}

    def judged(made: Iterable[tuple[Transformation, ...]]) -> list[Judged]:
        tried: dict[tuple[int, ...], tuple[Transformation, ...]] = {}
        for parts in made:
            in_order = tuple(sorted(parts, key=lambda part: order.get(id(part), len(order))))
            if apart(parts):
                tried.setdefault(tuple(id(part) for part in in_order), in_order)
        return evidence.judged(list(tried.values()))

    while beam:
        before = min(each.total for each in results) if depth else float("inf")
        level = judged((*kept.parts, single) for kept in beam for single in more if single not in kept.parts)
        if not any(each.settled for each in level):
            alike = {round(each.total, _ALIKE): each for each in reversed(beam)}
            fewer = list(reversed(alike.values()))[: 1 if any(each.explains for each in results) else _SIZED]
            level += judged(parts for kept in fewer for parts in evidence.sized(kept.parts))
        level.sort(key=lambda each: each.total)
        results += level
        depth += 1
        gained = bool(level) and level[0].total < before
        explained = any(each.explains for each in results)
        further = not any(each.settled for each in results)
        beam = level[: evidence.beam(depth, explained=explained, gained=gained)] if further else []
        more = again
    return sorted(results, key=lambda each: each.total)


_SIZED, _ALIKE = 16, 6
"""Of the likeliest sets, beside how many sizes are fitted, and digits to which totals differ between them."""
