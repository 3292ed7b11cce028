"""How a level on the base or a link is tilted about its two axes: inclinometers, electronic levels."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

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
from linkwright.core.diagnose.instruments.placement import UNDETERMINED
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError, format_quantity, shown
from linkwright.core.units.reading import Mapping as Reader

_START_STEPS = 6
_BETTER = 0.9
"""Of an earlier start's RMS, which turns less: another start must fit so much better."""
_LONGEST = 0.5
"""rad; how far one step turns a level at most."""
_ASKEW = 5e-3
"""rad; how far from straight a simulated level sits, about each axis."""


@dataclass(frozen=True)
class ChangeOfTilt(Change):
    """What turns a level of which an axis `rises` (N, W, 3) towards `up` (3,)."""

    mask: Marked
    rises: Array
    up: Array

    def exact(self, moved: Array, turned: Array) -> Array:
        """How much more or less the axes rise."""
        now = np.einsum("nab,nwb->nwa", Rotation.from_rotvec(turned).as_matrix(), self.rises)
        return (now - self.rises) @ self.up


class _Part(Part):
    """The state is how a level sits on what it stands on (3, 3)."""

    def start(self) -> Any:
        """On a link turned anyhow, on the base but a little."""
        stand = self.scene.stand
        if stand is None:
            return np.eye(3)
        quarters = sorted(Rotation.create_group("O").as_matrix(), key=lambda turn: -float(np.trace(turn)))
        best, least = np.eye(3), np.inf
        for turn in [np.eye(3)] if stand.known else quarters:
            tried = stand.seat @ turn
            for _ in range(_START_STEPS):
                tried = self._levelled(tried)
            off = float(np.sqrt(np.mean(self._left(tried) ** 2)))
            # An earlier one is turned less from level at zero angles: what fits as well is rather that.
            if off < _BETTER * least:
                best, least = tried, off
        for _ in range(_START_STEPS):
            best = self._levelled(best)
        return best

    def _of(self, values: Array) -> Array:
        """Of values of both axes (N, 2, ..) those of each number (N, W, ..), zero elsewhere."""
        index = np.clip(self.scene.slots - self.first, 0, 1)
        taken = np.stack([values[np.arange(len(values)), index[:, k]] for k in range(index.shape[1])], axis=1)
        return np.where(self.mask.reshape(*self.mask.shape, *[1] * (taken.ndim - 2)), taken, 0.0)

    def _rises(self, seat: Array) -> Array:
        """The axes of which the tilts tell how far they rise (N, 2, 3)."""
        assert self.scene.stand is not None
        axes = self.scene.stand.axes @ seat
        # A level turned about its x has its y rise; turned about its y, its x sinks.
        return np.stack([axes[:, :, 1], -axes[:, :, 0]], axis=1)

    def _left(self, seat: Array) -> Array:
        assert self.scene.stand is not None
        return (self.scene.read - self._of(self._rises(seat) @ self.scene.stand.up))[self.mask]

    def _sits(self, seat: Array) -> Array:
        """How readings move with small turns of a level about its axes, (N, W, 3)."""
        stand = self.scene.stand
        assert stand is not None
        turning = np.cross(self._of(self._rises(seat)), stand.up)
        turned = np.einsum("nwa,nab->nwb", turning, stand.axes @ seat)
        # About what stays upright, a turn shows nothing but rounding.
        size = np.linalg.norm(turned.reshape(-1, 3), axis=0)
        return np.where(size > UNDETERMINED * size.max(), turned, 0.0)

    def _levelled(self, seat: Array) -> Array:
        """One of Gauss and Newton's steps for how a level sits."""
        step = np.linalg.lstsq(self._sits(seat)[self.mask], self._left(seat), rcond=UNDETERMINED)[0]
        size = float(np.linalg.norm(step))
        step = step * min(1.0, _LONGEST / size) if size > 0.0 else step
        return seat @ Rotation.from_rotvec(step).as_matrix()

    def model(self, state: Any, at: Array, frame: Frame) -> Modelled:
        """How far the level's axes rise in a metre."""
        nothing = np.zeros((len(at), 2, 3))
        if self.scene.stand is None:
            return Modelled.of_place(nothing[:, :, 0], nothing)
        rises, up = self._rises(state), self.scene.stand.up
        return Modelled(rises @ up, nothing, np.cross(rises, up))

    def also(self, state: Any, seen: Seen) -> tuple[list[Array], list[str]]:
        """How the level sits."""
        if self.scene.stand is None:
            return [], []
        return [self._sits(state)], [f"level about {axis}" for axis in "xyz"]

    def change(self, state: Any, seen: Seen, frame: Frame) -> Change | None:
        """Tilts are not linear in turns."""
        if self.scene.stand is None:
            return None
        return ChangeOfTilt(self.mask, self._of(self._rises(state)), self.scene.stand.up)


class Tilt(InstrumentKind):
    """A level's two tilts."""

    name = "tilt"
    title = "how a level on the base or on a link (`tilt_link`) is tilted about its x and y"
    blind = "What moves the tip and turns nothing does not show, nor does what turns beyond the level's link."
    numbers = (Number("tilt x", "tilt_x", "angle"), Number("tilt y", "tilt_y", "angle", in_plane=False))
    settings = ("tilt_link",)
    example = MappingProxyType({"tilt_link": 2})
    turns_with = "link"
    of_place = False

    def part(self, first: int, scene: Scene) -> Part:
        """How it sits is unknown."""
        return _Part(self, first, scene)

    def of_file(self, values: Array) -> Array:
        """What it rises in a metre."""
        return np.sin(values)

    def to_file(self, values: Array) -> Array:
        """The angle."""
        return np.arcsin(np.clip(values, -1.0, 1.0))

    def read(self, mapping: Reader) -> Mapping[str, Any]:
        """`tilt_link`."""
        would_do = "where the level stands: `tilt_link: base`, or the number of a link, from 1 at the base"
        if not mapping.has("tilt_link"):
            raise mapping.error("tilt_link", f"is missing; write {would_do}")
        raw = mapping.raw("tilt_link")
        if raw == "base":
            return {"tilt_link": 0}
        if isinstance(raw, bool) or not isinstance(raw, int) or raw < 1:
            raise mapping.error("tilt_link", f"{shown(raw)} is no link; write {would_do}")
        return {"tilt_link": raw}

    def asked(self, words: Mapping[str, Any], arm: Arm) -> Mapping[str, Any]:
        """`tilt_link`."""
        given = words["tilt_link"]
        text = str(given).strip() if given is not None else ""
        if text == "base":
            return {"instrument": Instrument(("tilt",))}
        if text.isdecimal() and 1 <= int(text) <= arm.size:
            return {"instrument": Instrument(("tilt",), tilt_link=int(text))}
        message = f"needs base or the number of a link, 1 to {arm.size}, on which the level stands"
        raise InputError("", "tilt_link", message)

    def words(self, instrument: Instrument) -> Mapping[str, Any]:
        """Where it stands."""
        return {"tilt_link": instrument.tilt_link or "base"}

    def lines(self, instrument: Instrument) -> tuple[str, ...]:
        """Where it stands."""
        return (f"tilt_link: {instrument.tilt_link or 'base'}\n",)

    def said(self, instrument: Instrument, *, anchor_free: bool) -> str:
        """Where it stands."""
        where = f"link {instrument.tilt_link}" if instrument.tilt_link else "the base"
        return f"Read is how a level on {where} is tilted. The recording shows how the level sits there."

    def simulated(self, stood: Stood, instrument: Instrument, random: np.random.Generator) -> Array:
        """What a level reads that sits a little askew."""
        assert stood.stand is not None
        axes = stood.stand.axes @ (stood.stand.seat @ Rotation.from_rotvec(random.normal(0.0, _ASKEW, 3)).as_matrix())
        return np.stack([axes[:, :, 1] @ stood.stand.up, -axes[:, :, 0] @ stood.stand.up], axis=1)

    def refuse(self, look: Look) -> None:
        """Tilts that are not what the joints say, wherever the level sits."""
        recording, tilts = look.recording, look.numbers
        if look.off is None or float(np.median(look.off[tilts])) <= look.rules.reading.elsewhere:
            return
        link = recording.instrument.tilt_link or "base"
        by = format_quantity(float(np.arcsin(min(1.0, float(np.median(look.off[tilts]))))), "angle", digits=2)
        message = f"the middle tilt is {by} from what a level would read there, however it sits"
        raise InputError(
            recording.file, "tilt_x", f"{message}: check `tilt_link: {link}`, the unit in the header and signs"
        )


TILT = Tilt()
