"""The length that a wire is drawn out from an anchor to the tip: string potentiometers, cable gauges.

The counter starts at zero anywhere, so that a constant is added to the distance, which nobody knows. ISO/TR 13309
(1995) has cables from several anchors among the equipment that robots are tested with; each is a separate recording.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from linkwright.core.diagnose.instruments.instrument import Instrument
from linkwright.core.diagnose.instruments.kind import (
    Frame,
    InstrumentKind,
    Marked,
    Modelled,
    Number,
    Part,
    Scene,
    Seen,
    Stood,
)
from linkwright.core.sections.numeric import Array

from .distance import Distance, DistancePart

_ZERO = 0.1
"""m; how much a simulated counter begins with at most."""


class _Part(DistancePart):
    """The state is the anchor, or None where it is known, and the counter's zero, m."""

    def __init__(self, kind: InstrumentKind, first: int, scene: Scene) -> None:
        super().__init__(kind, first, scene)
        self.own_names = (*self.own_names, "zero of the wire")

    def start(self) -> Any:
        """By squares: (read - zero)^2 is linear in anchor and zero but for one number."""
        if not self.free:
            return None, 0.0
        anchor, (zero,) = self.by_squares(2.0 * self.scene.read[self.mask])
        return anchor, float(zero)

    def model(self, state: Any, at: Array, frame: Frame) -> Modelled:
        """The distance, and the counter's zero."""
        anchor, zero = state
        modelled = super().model(anchor, at, frame)
        return Modelled.of_place(modelled.values + zero, modelled.shown)

    def own_columns(self, state: Any, seen: Seen) -> Array:
        """The zero is in every reading of it."""
        return np.concatenate([super().own_columns(state, seen), np.where(self.mask[:, :, None], 1.0, 0.0)], axis=2)

    def stepped(self, state: Any, step: Array) -> Any:
        """Both."""
        anchor, zero = state
        return (anchor + step[:3] if self.free else anchor), zero + float(step[-1])

    def untold(self, shares: Array) -> tuple[str, ...]:
        """A zero that goes with the anchor's distance."""
        if shares[-1] > self.scene.rules.named_part:
            return ("The places reached do not tell the wire's zero from how far off its anchor is.",)
        return super().untold(shares)

    def change(self, state: Any, seen: Seen, frame: Frame) -> Any:
        """As of a distance."""
        return super().change(state[0], seen, frame)


class DrawWire(Distance):
    """A distance from an anchor, and a constant."""

    name = "draw_wire"
    title = "how far a wire is drawn out from an `anchor` (which may be free) to the tip, from any zero"
    blind = "What moves the tip across the wire does not show, nor does a distance from the anchor that is off alike."
    numbers = (Number("wire", "wire"),)
    _more = 1

    def part(self, first: int, scene: Scene) -> Part:
        """The zero is unknown, and the anchor may be."""
        return _Part(self, first, scene)

    def impossible(self, values: Array) -> tuple[Marked, str, str]:
        """A counter may begin anywhere."""
        return np.zeros(len(values), dtype=np.bool_), "", ""

    def said(self, instrument: Instrument, *, anchor_free: bool) -> str:
        """From where."""
        text = super().said(instrument, anchor_free=anchor_free)
        return text.replace("the tip's distance from", "how far a wire is drawn out from")

    def simulated(self, stood: Stood, instrument: Instrument, random: np.random.Generator) -> Array:
        """The distance from a counter that begins anywhere."""
        return super().simulated(stood, instrument, random) + random.uniform(-_ZERO, _ZERO)


DRAW_WIRE = DrawWire()
