"""How much farther a target on the tool is from one beacon than from another: two microphones, two radio anchors.

A clap or a pulse from the tool arrives at both; the difference of the arrivals times the speed of the wave is the
difference of the distances, |p - a| - |p - b|. Nothing of it is unknown where both beacons are measured.
"""

from __future__ import annotations

from types import MappingProxyType

import numpy as np

import linkwright as lw
from linkwright.core.diagnose.instruments import Instrument, InstrumentKind, Modelled, Number, Part


def _difference(at, first, second):
    """|p - a| - |p - b| of tips p (N, 3), and how it grows with them (N, 3)."""
    far, near = at - np.array(first), at - np.array(second)
    sizes = [np.maximum(np.linalg.norm(away, axis=1), 1e-9)[:, None] for away in (far, near)]
    return sizes[0] - sizes[1], far / sizes[0] - near / sizes[1]


class _Part(Part):
    def model(self, state, at, frame):
        del state
        settings = dict(self.scene.instrument.settings)
        # The beacons stand in the measuring frame.
        beacons = [frame.rotation @ np.array(settings[name]) + frame.translation for name in RangeDifference.settings]
        values, slope = _difference(at, *beacons)
        return Modelled.of_place(values, slope[:, None, :])

    def in_frame(self):
        return self.mask


class RangeDifference(InstrumentKind):
    """The difference of two distances."""

    name = "range_difference"
    title = "how much farther the tip is from the beacon `first` than from `second`"
    blind = "What moves the tip along the hyperbola of equal difference does not show."
    numbers = (Number("range difference", "difference"),)
    settings = ("first", "second")
    elsewhere = True
    example = MappingProxyType({"first": (2.0, 0.0, 0.0), "second": (0.0, 2.0, 0.0)})

    def part(self, first, scene):
        """Nothing of it is unknown but the frame."""
        return _Part(self, first, scene)

    def read(self, mapping):
        """Both beacons: three lengths each."""
        return {"settings": tuple((name, tuple(mapping.vector(name, "length", 3))) for name in self.settings)}

    def asked(self, words, arm):
        """Both beacons, m."""
        del arm
        for name in self.settings:
            if words[name] is None or len(words[name]) != 3:
                raise lw.InputError("", name, "needs three numbers, m: where the beacon is")
        beacons = tuple((name, tuple(float(value) for value in words[name])) for name in self.settings)
        return {"instrument": Instrument((self.name,), settings=beacons)}

    def words(self, instrument):
        """Both beacons."""
        return dict(instrument.settings)

    def lines(self, instrument):
        """Both beacons."""
        written = {name: ", ".join(f"{1e3 * value:.9g} mm" for value in place) for name, place in instrument.settings}
        return tuple(f"{name}: [{place}]\n" for name, place in written.items())

    def simulated(self, stood, instrument, random):
        """The difference itself."""
        del random
        settings = dict(instrument.settings)
        return _difference(stood.tips, settings["first"], settings["second"])[0]


RANGE_DIFFERENCE = RangeDifference()
