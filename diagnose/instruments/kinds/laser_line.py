"""How far a beam that turns with the tool goes until it meets a flat surface: laser line scanners, distance sensors.

The beam leaves the tip along a direction u of the last link and meets the plane n x = c, at the distance
d = (c - n p) / (n u). Where the surface is nobody need know: the points that the beam met lie on it.
"""

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
from linkwright.core.diagnose.instruments.settings import read_direction, unit_along
from linkwright.core.diagnose.instruments.touched import touched_planes
from linkwright.core.sections.numeric import Array
from linkwright.core.units.lists import rows_text
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import Mapping as Reader

from .plane import TILTS, across, tilted

_STEPS = 4
_GRAZING = 0.2
"""A beam that meets the surface at a smaller sine than this tells nothing."""
_OFF, _ASKEW = (0.2, 0.4), 0.05
"""m; how far the nearest reading of a simulation is from its surface, from and to; how far that is askew (rad)."""


@dataclass(frozen=True)
class ChangeOfRange(Change):
    """What changes distances `read` (N,), m, of beams (N, 3) to a surface of a normal (3,)."""

    mask: Marked
    read: Array
    beams: Array
    normal: Array

    def exact(self, moved: Array, turned: Array) -> Array:
        """The change of the distance itself; zero of beams that graze."""
        before, after = self.beams @ self.normal, Rotation.from_rotvec(turned).apply(self.beams) @ self.normal
        meets = (before >= _GRAZING) & (after >= 0.5 * _GRAZING)
        now = (self.read * before - moved @ self.normal) / np.where(meets, after, 1.0)
        return np.where(self.mask, np.where(meets, now - self.read, 0.0)[:, None], 0.0)


class _Part(Part):
    """The state is the surface: its normal (3,), along the beams, and how far it is from the base's origin, m."""

    def __init__(self, kind: InstrumentKind, first: int, scene: Scene) -> None:
        super().__init__(kind, first, scene)
        beam = np.array(scene.instrument.setting("beam"))
        self.beams = scene.directions @ beam
        self.read = np.where(self.mask, scene.read, 0.0).sum(axis=1)
        self.rows = self.rows & (self.read > 0.0)  # of a plan some beams meet nothing

    def start(self) -> Any:
        """Through the points that the beam met."""
        return self.refit(None, self.scene.tips)

    def refit(self, state: Any, at: Array) -> Any:
        """The surface that leaves least of the distances read."""
        scene = self.scene
        met = at + self.read[:, None] * self.beams
        normals, offsets, _ = touched_planes(met, np.where(self.rows, 0, -1), 1, flat=scene.flat)
        ahead = 1.0 if float(np.median(self.beams[self.rows] @ normals[0])) >= 0.0 else -1.0
        normal, offset = ahead * normals[0], ahead * float(offsets[0])
        for _ in range(_STEPS):
            rows = self.rows & (self.beams @ normal >= _GRAZING)
            if rows.sum() <= scene.width:
                break
            modelled = self.model((normal, offset), at, _NOWHERE)
            met = at[rows] + modelled.values[rows] * self.beams[rows]
            tangents = across(normal, flat=scene.flat)
            moved = np.column_stack([np.ones(len(met)), *(-(met @ tangent) for tangent in tangents)])
            left = self.read[rows] - modelled.values[rows, 0]
            sine = self.beams[rows] @ normal
            step = np.linalg.lstsq(moved / sine[:, None], left, rcond=1e-12)[0]
            turned = normal + step[1:] @ tangents
            size = float(np.linalg.norm(turned))
            normal, offset = turned / size, (offset + float(step[0])) / size
        return normal, offset

    def model(self, state: Any, at: Array, frame: Frame) -> Modelled:
        """How far the beam goes; a beam that grazes shows nothing."""
        normal, offset = state
        sine = self.beams @ normal
        meets = self.rows & (sine >= _GRAZING)
        steep = np.where(meets, sine, 1.0)
        values = np.where(meets, (offset - at @ normal) / steep, self.read)
        shown = np.where(meets[:, None], -normal / steep[:, None], 0.0)
        turning = np.where(meets[:, None], -values[:, None] * np.cross(self.beams, normal) / steep[:, None], 0.0)
        return Modelled(values[:, None], shown[:, None, :], turning[:, None, :])

    def beside(self, state: Any, seen: Seen) -> tuple[list[Array], list[str]]:
        """The surface's place and tilts."""
        normal, _ = state
        modelled = self.model(state, seen.at, _NOWHERE)
        met = seen.at + modelled.values * self.beams
        sine = self.beams @ normal
        meets = sine >= _GRAZING
        moved = tilted(met - met[self.rows].mean(axis=0), normal, flat=self.scene.flat)
        moved = np.where(meets[:, None], moved / np.where(meets, sine, 1.0)[:, None], 0.0)
        names = [f"surface {what}" for what in TILTS[: moved.shape[1]]]
        return [np.where(self.mask[:, :, None], moved[:, None, :], 0.0)], names

    def change(self, state: Any, seen: Seen, frame: Frame) -> Change | None:
        """Distances along a beam that turns are not linear."""
        return ChangeOfRange(self.mask, self.model(state, seen.at, frame).values[:, 0], self.beams, state[0])


_NOWHERE = Frame(np.eye(3), np.zeros(3))


class LaserLine(InstrumentKind):
    """A distance along a beam that turns with the tool, to a flat surface that stands anywhere."""

    name = "laser_line"
    title = "how far a `beam` that turns with the tool goes until it meets a flat surface"
    blind = "What moves the tip along the surface and turns nothing does not show."
    numbers = (Number("range", "range"),)
    settings = ("beam",)
    example = MappingProxyType({"beam": (1.0, 0.0, 0.0)})
    alone = True
    turns_with = "tool"

    def part(self, first: int, scene: Scene) -> Part:
        """Where the surface is is unknown."""
        return _Part(self, first, scene)

    def impossible(self, values: Array) -> tuple[Marked, str, str]:
        """No distance is negative."""
        return values < 0.0, "is negative; a range cannot be", "is negative in most rows (row {row}); no range is"

    def read(self, mapping: Reader) -> Mapping[str, Any]:
        """`beam`."""
        would_do = "which way the beam leaves the tool, by the last link's axes, e.g."
        return {"settings": (("beam", read_direction(mapping, "beam", would_do)),)}

    def asked(self, words: Mapping[str, Any], arm: Arm) -> Mapping[str, Any]:
        """`beam`, which in the plane lies in it."""
        beam = words["beam"]
        if beam is None:
            raise InputError("", "beam", "is missing; write which way the beam leaves the tool, e.g. 1, 0, 0")
        unit = unit_along("beam", beam)
        if arm.planar() and abs(unit[2]) > 1e-9:
            raise InputError("", "beam", "is out of the plane in which the arm moves; name one within it")
        return {"instrument": Instrument((self.name,), settings=(("beam", unit),))}

    def words(self, instrument: Instrument) -> Mapping[str, Any]:
        """The beam."""
        return {"beam": instrument.setting("beam")}

    def lines(self, instrument: Instrument) -> tuple[str, ...]:
        """The beam."""
        return (f"beam: [{', '.join(f'{value:.9g}' for value in instrument.setting('beam'))}]\n",)

    def said(self, instrument: Instrument, *, anchor_free: bool) -> str:
        """Along what."""
        beam = ", ".join(f"{value:.4g}" for value in instrument.setting("beam"))
        return (
            f"Read is how far a beam along {beam} of the last link goes. A flat surface stands across most beams, some "
            "0.3 m beyond the nearest tip. The recording shows where the surface is."
        )

    def simulated(self, stood: Stood, instrument: Instrument, random: np.random.Generator) -> Array:
        """A surface across most of the beams, a little askew; nan where a beam does not meet it."""
        assert stood.axes is not None
        beams = stood.axes @ np.array(instrument.setting("beam"))
        middle = beams.mean(axis=0)
        if np.linalg.norm(middle) < 1e-6:
            middle = beams[0]
        normal = middle / np.linalg.norm(middle)
        tangents = across(normal, flat=stood.arm.planar())
        normal = normal + random.uniform(-_ASKEW, _ASKEW, len(tangents)) @ tangents
        normal /= np.linalg.norm(normal)
        sine = beams @ normal
        meets = sine >= _GRAZING
        offset = float((stood.tips[meets] @ normal).max()) + random.uniform(*_OFF)
        return np.where(meets, (offset - stood.tips @ normal) / np.where(meets, sine, 1.0), np.nan)[:, None]

    def refuse(self, look: Look) -> None:
        """A surface that was met on a line could be turned about it."""
        recording, rows = look.recording, look.numbers.any(axis=1)
        places = look.tips + np.where(rows, recording.tip[:, 0], 0.0)[:, None] * (
            look.axes @ np.array(recording.instrument.setting("beam"))
        )
        reach = touched_planes(places, np.where(rows, 0, -1), 1, flat=look.flat)[2][0]
        share, size = look.rules.residual.level_places, float(np.linalg.norm(np.ptp(look.tips, axis=0)))
        if reach[1] <= share * max(reach[0], share * size):
            where = "at one spot" if look.flat else "on a line"
            raise InputError(
                recording.file,
                "range_mm",
                f"the beam meets its surface {where} only ({rows_text(recording.row[rows])}), which could be turned "
                "about it; measure elsewhere too",
            )


LASER_LINE = LaserLine()
