"""That a bar with balls was touched, and where along it: a ball bar, a calibrated length."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.instruments.instrument import Instrument
from linkwright.core.diagnose.instruments.kind import Frame, InstrumentKind, Modelled, Number, Part, Scene, Seen
from linkwright.core.diagnose.instruments.look import SCALES, Look
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError

from .plane import across
from .same_point import TouchPart


class _Part(TouchPart):
    """The state are the middles of the bars' touches (labels, 3), m, and which way the bars point (labels, 3), unit."""

    def __init__(self, kind: InstrumentKind, first: int, scene: Scene) -> None:
        super().__init__(kind, first, scene)
        self.along = np.zeros(len(scene.read))
        if scene.bar_at is not None:
            for label in range(len(scene.instrument.labels)):
                rows = (scene.touches == label) & self.rows
                if rows.any():
                    self.along[rows] = scene.bar_at[rows] - scene.bar_at[rows].mean()

    def refit(self, state: Any, at: Array) -> Any:
        """The bars that fit the touches best."""
        bars, there = np.zeros((len(self.scene.instrument.labels), 3)), self.scene.touches >= 0
        np.add.at(bars, self.scene.touches[there], (self.along[:, None] * at)[there])
        return self.middles(at), bars / np.maximum(np.linalg.norm(bars, axis=1, keepdims=True), 1e-12)

    def _there(self, state: Any) -> Array:
        """Where the bars' places are that are touched."""
        points, bars = state
        return points[self.label()] + self.along[self.rows, None] * bars[self.label()]

    def model(self, state: Any, at: Array, frame: Frame) -> Modelled:
        """How far from the place along the bar the tip is."""
        values = np.zeros((len(at), 3))
        values[self.rows] = at[self.rows] - self._there(state)
        return Modelled.of_place(values, np.broadcast_to(np.eye(3), (len(at), 3, 3)))

    def of_label(self, state: Any, seen: Seen, label: int) -> tuple[Array, Sequence[str]]:
        """The bar's place and turns."""
        width, directions = self.scene.width, self.shifts(seen, label)
        sideways = across(state[1][label], flat=self.scene.flat)[:, :width]
        turned = np.einsum("nwa,ka->nwk", directions, sideways) * self.along[:, None, None]
        return np.concatenate([directions, turned], axis=2), [*"xyz"[:width], *("turn", "other turn")[: len(sideways)]]

    def settled(self, state: Any, at: Array, settled: Array) -> None:
        """At its place along the bar."""
        settled[self.rows] = self._there(state)


class Bar(InstrumentKind):
    """A bar that is touched at places along it."""

    name = "bar"
    title = "nothing but that the same bar was touched, at a known place along it (`bar_mm`), by labels"
    blind = "The recording shows where the bars are. Their known lengths give the scale."
    numbers = (Number("x of a bar"), Number("y of a bar"), Number("z of a bar", in_plane=False))
    settings = ("bar",)
    example = MappingProxyType({"bar": (0.0, 0.2)})
    label = "bar"

    def part(self, first: int, scene: Scene) -> Part:
        """Where the bars are is unknown."""
        return _Part(self, first, scene)

    def asked(self, words: Mapping[str, Any], arm: Arm) -> Mapping[str, Any]:
        """`bar`, the places along it, m."""
        bar = words["bar"]
        if bar is None or len(set(bar)) < 2:
            raise InputError("", "bar", "needs two places along the bar or more, e.g. 0 mm, 500 mm")
        return {"instrument": Instrument(("bar",)), "bar": tuple(bar)}

    def refuse(self, look: Look) -> None:
        """Bars of another length than the tips' places have."""
        recording, bars = look.recording, look.numbers
        if look.off is None or recording.bar_at is None:
            return
        there = bars.any(axis=1)
        length = float(np.sqrt(np.mean((recording.bar_at[there] - recording.bar_at[there].mean()) ** 2)))
        misfit = float(np.sqrt(np.mean(look.off[bars] ** 2)))
        at = look.view(recording).at[there]
        apart = max(length, float(np.sqrt(np.mean((at - at.mean()) ** 2))))
        if misfit <= look.rules.reading.elsewhere * apart:
            return
        for scale, words in SCALES:
            other = np.abs(look.view(replace(recording, bar_at=recording.bar_at * scale)).residual)[bars]
            if float(np.sqrt(np.mean(other**2))) < look.rules.mistakes.better * misfit:
                message = (
                    f"looks as if its numbers were {words} than the header's unit says; correct the unit in the header"
                )
                raise InputError(recording.file, "bar_mm", message)


BAR = Bar()
