"""The tip's place in the measuring frame, or some of its coordinates: trackers, portable arms, gauges."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.instruments.instrument import Instrument
from linkwright.core.diagnose.instruments.kind import Frame, InstrumentKind, Modelled, Number, Part, Scene, Stood
from linkwright.core.sections.numeric import Array


class _Part(Part):
    def model(self, state: Any, at: Array, frame: Frame) -> Modelled:
        """Turned and shifted into the measuring frame."""
        shown = np.broadcast_to(frame.rotation.T, (len(at), 3, 3))
        return Modelled.of_place((at - frame.translation) @ frame.rotation, shown)


class Position(InstrumentKind):
    """x, y and z, or some of them."""

    name = "position"
    title = "the tip's place (x, y, z), or some of its coordinates"
    numbers = (Number("x", "x"), Number("y", "y"), Number("z", "z", in_plane=False))
    framed = True
    elsewhere = True

    def part(self, first: int, scene: Scene) -> Part:
        """Nothing of it is unknown but the frame."""
        return _Part(self, first, scene)

    def asked(self, words: Mapping[str, Any], arm: Arm) -> Mapping[str, Any]:
        """The whole place needs no slots."""
        return {}

    def simulated(self, stood: Stood, instrument: Instrument, random: np.random.Generator) -> Array:
        """The place itself."""
        return stood.tips


POSITION = Position()
