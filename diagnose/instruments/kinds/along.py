"""The tip's height along a direction: dial gauges, lasers that stand still, height gauges."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.instruments.instrument import Instrument
from linkwright.core.diagnose.instruments.kind import Frame, InstrumentKind, Modelled, Number, Part, Scene, Stood
from linkwright.core.diagnose.instruments.settings import read_direction, unit_along
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError, shown
from linkwright.core.units.reading import Mapping as Reader


class _Part(Part):
    def model(self, state: Any, at: Array, frame: Frame) -> Modelled:
        """Along the direction, once turned into the measuring frame."""
        direction = np.array(self.scene.instrument.direction or (0.0, 0.0, 0.0))
        values = ((at - frame.translation) @ frame.rotation) @ direction
        return Modelled.of_place(values[:, None], np.broadcast_to(frame.rotation @ direction, (len(at), 1, 3)))

    def rotations(self) -> Iterator[Array]:
        """So that the heights rise along the direction."""
        scene, direction = self.scene, self.scene.instrument.direction
        if direction is None or self.rows.sum() <= scene.width + 1:
            return
        at = scene.tips[self.rows] - scene.tips[self.rows].mean(axis=0)
        read = scene.read[self.rows][self.mask[self.rows]]
        up = np.linalg.lstsq(at, read - read.mean(), rcond=1e-6)[0]
        if np.linalg.norm(up) > 0.0:
            yield Rotation.align_vectors(up[None], np.array([direction]))[0].as_matrix()


class Along(InstrumentKind):
    """A height along a direction that stays."""

    name = "along"
    title = "the tip's height along a `direction` that stays"
    blind = "What moves the tip across the direction does not show."
    numbers = (Number("along", "along"),)
    settings = ("direction",)
    example = MappingProxyType({"direction": (0.0, 1.0, 0.0)})
    framed = True
    elsewhere = True

    def part(self, first: int, scene: Scene) -> Part:
        """Nothing of it is unknown but the frame."""
        return _Part(self, first, scene)

    def read(self, mapping: Reader) -> Mapping[str, Any]:
        """`direction`."""
        return {"direction": read_direction(mapping, "direction", "the direction measured along, e.g.")}

    def asked(self, words: Mapping[str, Any], arm: Arm) -> Mapping[str, Any]:
        """`direction`, which in the plane lies in it."""
        direction = words["direction"]
        if direction is None:
            raise InputError("", "direction", "is missing; write the direction of the height, e.g. 0, 0, 1")
        unit = unit_along("direction", direction)
        if arm.planar() and not any(unit[:2]):
            raise InputError("", "direction", "is out of the plane in which the arm moves; name one within it")
        return {"instrument": Instrument(("along",), direction=unit)}

    def words(self, instrument: Instrument) -> Mapping[str, Any]:
        """The direction."""
        return {"direction": instrument.direction}

    def lines(self, instrument: Instrument) -> tuple[str, ...]:
        """The direction."""
        assert instrument.direction is not None
        return (f"direction: [{', '.join(f'{value:.9g}' for value in instrument.direction)}]\n",)

    def said(self, instrument: Instrument, *, anchor_free: bool) -> str:
        """Along what."""
        assert instrument.direction is not None
        return f"Read is the tip's height along {', '.join(f'{value:.4g}' for value in instrument.direction)}."

    def simulated(self, stood: Stood, instrument: Instrument, random: np.random.Generator) -> Array:
        """The height itself."""
        assert instrument.direction is not None, shown(instrument)
        return stood.tips @ np.array(instrument.direction)[:, None]


ALONG = Along()
