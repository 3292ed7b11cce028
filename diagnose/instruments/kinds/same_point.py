"""That a point was touched again in another posture: a ball in a socket, a probe in a cone."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import Any

import numpy as np

from linkwright.core.diagnose.instruments.kind import Frame, InstrumentKind, Modelled, Number, Part, Scene, Seen
from linkwright.core.sections.numeric import Array


class TouchPart(Part):
    """Readings that touch what has a label: what is read is zero, and how far off the tip is what is modelled."""

    def label(self) -> Any:
        """The label of each row that touches something of this kind."""
        return self.scene.touches[self.rows]

    def touched(self) -> list[int]:
        """The labels that rows of this kind touch."""
        return sorted(set(self.label().tolist()))

    def name(self, label: int) -> str:
        """What is touched."""
        return f"{self.kind.label} {self.scene.instrument.labels[label]}"

    def only(self, label: int) -> Any:
        """Which numbers are of a label (N, W)."""
        return self.mask & (self.scene.touches == label)[:, None]

    def middles(self, at: Array) -> Array:
        """The middle of the tips that touch each label (labels, 3), m; zero for others."""
        count, touches = len(self.scene.instrument.labels), self.scene.touches
        places = [
            at[touches == label].mean(axis=0) if (touches == label).any() else np.zeros(3) for label in range(count)
        ]
        return np.array(places).reshape(count, 3)

    def start(self) -> Any:
        """As the modelled tips have it."""
        return self.refit(None, self.scene.tips)

    def beside(self, state: Any, seen: Seen) -> tuple[list[Array], list[str]]:
        """What is unknown of each thing that is touched."""
        touched = [(self.name(label), *self.of_label(state, seen, label)) for label in self.touched()]
        return [columns for _, columns, _ in touched], [
            f"{name} {what}" for name, _, whats in touched for what in whats
        ]

    @abstractmethod
    def of_label(self, state: Any, seen: Seen, label: int) -> tuple[Array, Sequence[str]]:
        """How readings move with what is unknown of one thing (N, W, k), and what each of these is."""
        ...

    def shifts(self, seen: Seen, label: int) -> Array:
        """What readings of one thing show of the tip's place (N, W, width)."""
        return np.where(self.only(label)[:, :, None], seen.shown[:, :, : self.scene.width], 0.0)


class _Part(TouchPart):
    """The state are the points (labels, 3), m."""

    def refit(self, state: Any, at: Array) -> Any:
        """The middle of the touches."""
        return self.middles(at)

    def model(self, state: Any, at: Array, frame: Frame) -> Modelled:
        """How far from the point the tip is."""
        values = np.zeros((len(at), 3))
        values[self.rows] = at[self.rows] - state[self.label()]
        return Modelled.of_place(values, np.broadcast_to(np.eye(3), (len(at), 3, 3)))

    def of_label(self, state: Any, seen: Seen, label: int) -> tuple[Array, Sequence[str]]:
        """The point's place."""
        return -self.shifts(seen, label), "xyz"[: self.scene.width]

    def settled(self, state: Any, at: Array, settled: Array) -> None:
        """At the point."""
        settled[self.rows] = state[self.label()]


class SamePoint(InstrumentKind):
    """A point that is touched again."""

    name = "same_point"
    title = "nothing but that the same point was touched again, by labels"
    blind = "The recording shows where the points are. What moves the tip alike in every posture does not show."
    numbers = (Number("x of a point"), Number("y of a point"), Number("z of a point", in_plane=False))
    label = "point"

    def part(self, first: int, scene: Scene) -> Part:
        """Where the points are is unknown."""
        return _Part(self, first, scene)


SAME_POINT = SamePoint()
