"""That a plane was touched: a granite table, a squared block."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from linkwright.core.diagnose.instruments.kind import Frame, InstrumentKind, Modelled, Number, Part, Scene, Seen
from linkwright.core.diagnose.instruments.look import Look
from linkwright.core.diagnose.instruments.touched import touched_planes
from linkwright.core.sections.numeric import Array
from linkwright.core.units.lists import rows_text
from linkwright.core.units.quantities import InputError

from .same_point import TouchPart


def across(direction: Array, *, flat: bool) -> Array:
    """Directions across one (3,), (2, 3); in the plane the one, (1, 3)."""
    return np.array([[-direction[1], direction[0], 0.0]]) if flat else np.linalg.svd(direction[None])[2][1:]


TILTS = ("offset", "tilt", "other tilt")


def tilted(away: Array, normal: Array, *, flat: bool) -> Array:
    """How far places (N, 3) on a plane, seen from its middle, go along its normal (3,) as it is moved and tilted:
    (N, 3) for `TILTS`, (N, 2) in the plane."""
    return np.stack([np.ones(len(away)), *(away @ tangent for tangent in across(normal, flat=flat))], axis=1)


class _Part(TouchPart):
    """The state are the planes' normals (labels, 3) and how far from the base each is (labels,), m."""

    def refit(self, state: Any, at: Array) -> Any:
        """The planes that fit the touches best."""
        scene = self.scene
        normals, offsets, _ = touched_planes(at, scene.touches, len(scene.instrument.labels), flat=scene.flat)
        before = np.zeros(normals.shape) if state is None else state[0]
        # The side from which a plane is looked at is nobody's: it stays the same from fit to fit.
        same = np.where(np.sum(normals * before, axis=1) < 0.0, -1.0, 1.0)
        return normals * same[:, None], offsets * same

    def model(self, state: Any, at: Array, frame: Frame) -> Modelled:
        """How far from the plane the tip is."""
        normals, offsets = state
        values, shown = np.zeros((len(at), 1)), np.zeros((len(at), 1, 3))
        label = self.label()
        values[self.rows, 0] = np.sum(at[self.rows] * normals[label], axis=1) - offsets[label]
        shown[self.rows, 0] = normals[label]
        return Modelled.of_place(values, shown)

    def of_label(self, state: Any, seen: Seen, label: int) -> tuple[Array, Sequence[str]]:
        """The plane's place and tilts."""
        rows = self.scene.touches == label
        moved = tilted(seen.at - seen.at[rows].mean(axis=0), state[0][label], flat=self.scene.flat)
        return np.where(self.only(label)[:, :, None], moved[:, None, :], 0.0), TILTS[: moved.shape[1]]

    def settled(self, state: Any, at: Array, settled: Array) -> None:
        """On the plane."""
        normals, label = state[0][self.label()], self.label()
        off = np.sum(at[self.rows] * normals, axis=1) - state[1][label]
        settled[self.rows] = at[self.rows] - off[:, None] * normals


class Plane(InstrumentKind):
    """A plane that is touched."""

    name = "plane"
    title = "nothing but that the same plane was touched, by labels"
    blind = "The recording shows where the planes are. What moves the tip along a plane does not show."
    numbers = (Number("plane"),)
    label = "plane"

    def part(self, first: int, scene: Scene) -> Part:
        """Where the planes are is unknown."""
        return _Part(self, first, scene)

    def refuse(self, look: Look) -> None:
        """Planes that were touched on a line (in the plane: lines touched at a spot) could be turned about it."""
        recording, tips = look.recording, look.tips
        if recording.touches is None:
            return
        share, touched = look.rules.residual.level_places, np.where(look.numbers.any(axis=1), recording.touches, -1)
        _, _, reach = touched_planes(tips, touched, len(recording.instrument.labels), flat=look.flat)
        size = float(np.linalg.norm(np.ptp(tips, axis=0)))
        for label, name in enumerate(recording.instrument.labels):
            rows = touched == label
            narrow = reach[label, 1] <= share * max(reach[label, 0], share * size)
            if rows.any() and narrow:
                where = "at one spot" if look.flat else "on a line"
                raise InputError(
                    recording.file,
                    "plane",
                    f"'{name}' is touched {where} only ({rows_text(recording.row[rows])}): it could be turned about "
                    "it; touch it elsewhere too",
                )


PLANE = Plane()
