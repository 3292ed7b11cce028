"""The tip's distance from an anchor: ballbars, laser rangers, ultrasound."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.instruments.instrument import Instrument
from linkwright.core.diagnose.instruments.kind import (
    Change,
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
from linkwright.core.diagnose.instruments.look import Look
from linkwright.core.diagnose.instruments.settings import read_anchor
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError, format_quantity
from linkwright.core.units.reading import Mapping as Reader


@dataclass(frozen=True)
class ChangeOfDistance(Change):
    """What moves the tip that is `away` (N, 3), m, from the anchor."""

    mask: Marked
    away: Array

    def exact(self, moved: Array, turned: Array) -> Array:
        """The change of the distance itself."""
        change = np.linalg.norm(self.away + moved, axis=1) - np.linalg.norm(self.away, axis=1)
        return np.where(self.mask, change[:, None], 0.0)


class DistancePart(Part):
    """The state is the anchor's place in the base frame (3,), m, where that is free, else None."""

    def __init__(self, kind: InstrumentKind, first: int, scene: Scene) -> None:
        super().__init__(kind, first, scene)
        known = scene.instrument.anchor is not None
        # A known place in a frame that stands anywhere is an unknown place, unless more is measured in that frame.
        self.free = bool(self.mask.any()) and (not known or (scene.frame_free and not scene.framed.any()))
        self.own_names = ("anchor x", "anchor y", "anchor z") if self.free else ()

    def start(self) -> Any:
        """The anchor that distances tell by their squares."""
        return self.by_squares()[0] if self.free else None

    def by_squares(self, *beside: Array) -> tuple[Array, Array]:
        """The anchor, which is linear in squares of readings but for one number, and the coefficients (k,) of columns
        (R,) that stand beside it."""
        scene = self.scene
        read = scene.read[self.mask]
        middle = scene.tips[self.rows].mean(axis=0)
        at = scene.tips[self.rows] - middle
        design = np.column_stack([-2.0 * at, *beside, np.ones(len(at))])
        size = np.maximum(np.linalg.norm(design, axis=0), 1e-12)
        values = np.linalg.lstsq(design / size, read**2 - np.sum(at**2, axis=1), rcond=1e-6)[0] / size
        anchor, further = values[:3], values[3:-1]
        # What the places reached leave open (a plane of them) goes across it.
        across = np.linalg.svd(at, full_matrices=True)[2][-1]
        missing = float(values[-1] - anchor @ anchor) + float(further @ further)
        spread = np.linalg.svd(at, compute_uv=False)
        level = spread[-1] < scene.rules.level_places * spread[0]
        return middle + anchor + (across * np.sqrt(max(missing, 0.0)) if level else 0.0), further

    def anchor(self, state: Any, frame: Frame) -> Array:
        """Where the anchor is in the base frame (3,), m."""
        if state is not None:
            return state
        return frame.rotation @ np.array(self.scene.instrument.anchor or (0.0, 0.0, 0.0)) + frame.translation

    def model(self, state: Any, at: Array, frame: Frame) -> Modelled:
        """How far the tip is from it."""
        away = at - self.anchor(state, frame)
        distance = np.linalg.norm(away, axis=1)
        return Modelled.of_place(distance[:, None], (away / np.maximum(distance, 1e-9)[:, None])[:, None, :])

    def in_frame(self) -> Marked:
        """An anchor that is known stands in the measuring frame."""
        return np.zeros(self.mask.shape, dtype=np.bool_) if self.free else self.mask

    def own_columns(self, state: Any, seen: Seen) -> Array:
        """The anchor moved is the tip moved the other way."""
        if not self.free:
            return super().own_columns(state, seen)
        return -np.where(self.mask[:, :, None], seen.shown, 0.0)

    def stepped(self, state: Any, step: Array) -> Any:
        """The anchor moved."""
        return state + step if self.free else state

    def untold(self, shares: Array) -> tuple[str, ...]:
        """Where the anchor stands about a line."""
        if not self.free or shares[: self.scene.width].sum() <= self.scene.rules.named_part:
            return ()
        return ("The places reached lie on a line or closer: where the anchor stands about it cannot be told.",)

    def change(self, state: Any, seen: Seen, frame: Frame) -> Change | None:
        """Distances are not linear in where the tip is."""
        return ChangeOfDistance(self.mask, seen.at - self.anchor(state, frame))


class Distance(InstrumentKind):
    """A distance from an anchor."""

    name = "distance"
    title = "the tip's distance from an `anchor`, which may be free"
    blind = "What moves the tip across the line to the anchor does not show."
    numbers = (Number("distance", "distance"),)
    settings = ("anchor",)
    example = MappingProxyType({"anchor": (1.0, 0.5, 0.0)})
    elsewhere = True

    def part(self, first: int, scene: Scene) -> Part:
        """The anchor may be unknown."""
        return DistancePart(self, first, scene)

    def impossible(self, values: Array) -> tuple[Marked, str, str]:
        """No distance is negative."""
        return values < 0.0, "is negative; a distance cannot be", "is negative in most rows (row {row}); no distance is"

    def read(self, mapping: Reader) -> Mapping[str, Any]:
        """`anchor`."""
        return {"anchor": read_anchor(mapping)}

    def asked(self, words: Mapping[str, Any], arm: Arm) -> Mapping[str, Any]:
        """`anchor`, m, and whether recordings tell it."""
        anchor = words["anchor"]
        if anchor is None or len(anchor) not in (2, 3):
            would_do = "where distances are measured from, e.g. 1 m, 0 m, 0.3 m"
            raise InputError("", "anchor", f"needs three lengths: {would_do}")
        x, y, z = [*anchor, 0.0][:3]
        return {"instrument": Instrument((self.name,), anchor=(x, y, z)), "anchor_free": words["anchor_free"]}

    def words(self, instrument: Instrument) -> Mapping[str, Any]:
        """The anchor, or that it is free."""
        return {"anchor": instrument.anchor, "anchor_free": instrument.anchor is None}

    def lines(self, instrument: Instrument) -> tuple[str, ...]:
        """The anchor."""
        if instrument.anchor is None:
            return ("anchor: free\n",)
        return (f"anchor: [{', '.join(f'{1e3 * value:.9g} mm' for value in instrument.anchor)}]\n",)

    def said(self, instrument: Instrument, *, anchor_free: bool) -> str:
        """From where."""
        where = ", ".join(format_quantity(value, "length", "mm", 4) for value in instrument.anchor or ())
        known = "about there; the recording has to tell just where" if anchor_free else "which is known"
        return f"Read is the tip's distance from {where}, {known}."

    def recorded(self, instrument: Instrument, *, anchor_free: bool) -> Instrument:
        """Without an anchor that recordings do not tell."""
        return replace(instrument, anchor=None) if anchor_free else instrument

    def simulated(self, stood: Stood, instrument: Instrument, random: np.random.Generator) -> Array:
        """The distance itself."""
        return np.linalg.norm(stood.tips - np.array(instrument.anchor), axis=1)[:, None]

    def refuse(self, look: Look) -> None:
        """An anchor that nobody knows needs more distances than its place has numbers."""
        recording = look.recording
        if recording.instrument.anchor is not None and (recording.frame != "free" or look.framed):
            return
        share, at = look.rules.residual.level_places, look.tips[look.numbers.any(axis=1)]
        apart = max(share * float(np.linalg.norm(np.ptp(at, axis=0))), 1e-6)
        places = len(np.unique(np.round(at / apart), axis=0))
        least = (3 if look.flat else 4) + self._more
        if places < least:
            raise InputError(
                recording.file,
                "anchor",
                f"is free, and distances from {places} place{'s' if places != 1 else ''} fit some anchor always; "
                f"measure from {least} places or more, or say where it is",
            )

    _more = 0
    """How many unknowns there are beside the anchor."""


DISTANCE = Distance()
