"""The ranges of a link's sizes: what `subject_to` says of its length, its outer dimensions, its walls and its taper."""

from __future__ import annotations

from dataclasses import dataclass

from linkwright.core.arm.figures import RANGES

Span = tuple[float, float]
"""The least and the greatest value."""


@dataclass(frozen=True)
class Ranges:
    """The ranges of one link (m) as a problem says them, None where it does not: a length then stays, and so does a
    `taper` (the size of the far end over that at the joint); dimensions have a range by default. `steps` are the
    thicknesses that walls are sold in, least first; none where any will do."""

    section_size: Span | None = None
    thickness: Span | None = None
    link_length: Span | None = None
    taper: Span | None = None
    steps: tuple[float, ...] = ()

    @property
    def sizes(self) -> tuple[Span, Span]:
        """Of every outer dimension and of every wall, m."""
        return self.section_size or RANGES["section_size"], self.thickness or RANGES["thickness"]

    @property
    def by_kind(self) -> dict[str, Span]:
        """The same, by the kind of dimension."""
        outer, wall = self.sizes
        return {"outer": outer, "wall": wall}

    @property
    def spans(self) -> dict[str, Span]:
        """All that holds, by its key in problem files."""
        outer, walls = self.sizes
        every = {"section_size": outer, "thickness": walls, "link_length": self.link_length, "taper": self.taper}
        return {name: span for name, span in every.items() if span is not None}
