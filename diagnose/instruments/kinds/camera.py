"""Where and how turned a camera sees a target, one of both on the tool."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.instruments.instrument import Instrument
from linkwright.core.diagnose.instruments.kind import InstrumentKind, Number, Scene
from linkwright.core.diagnose.instruments.look import Look
from linkwright.core.units.quantities import InputError, format_quantity, shown
from linkwright.core.units.reading import Mapping as Reader
from linkwright.core.units.reading import refusal

_PLACES = ("fixed", "on_tool")


class Camera(InstrumentKind):
    """A camera's three numbers; its turns are the recording's orientations. Both its frames are fitted by themselves
    (`instruments.camera`), which `view.viewed` asks for."""

    name = "camera"
    title = "where and how turned a `camera` (fixed, or on_tool) sees a target (x, y, depth, orientation)"
    blind = "Where camera and target are the recording tells, and an error of the focal length with it."
    numbers = (Number("camera x", "x"), Number("camera y", "y"), Number("camera depth", "z"))
    settings = ("camera",)
    example = MappingProxyType({"camera": "fixed"})
    alone = True
    turns_with = "tool"

    def part(self, first: int, scene: Scene) -> None:
        """None: both its frames are fitted at once."""

    def read(self, mapping: Reader) -> Mapping[str, Any]:
        """`camera`."""
        would_do = "`camera: fixed` (the target is on the tool) or `camera: on_tool` (the target is fixed)"
        if not mapping.has("camera"):
            raise mapping.error("camera", f"is missing; write where the camera is: {would_do}")
        raw = mapping.raw("camera")
        if raw not in _PLACES:
            raise mapping.error("camera", f"{shown(raw)} is no place of a camera; write {would_do}")
        return {"camera": raw}

    def asked(self, words: Mapping[str, Any], arm: Arm) -> Mapping[str, Any]:
        """`camera`."""
        if arm.planar():
            raise InputError("", "observe", "camera needs an arm in space; of one in the plane, take position")
        if words["camera"] not in _PLACES:
            raise InputError("", "camera", "needs fixed (the target is on the tool) or on_tool (the target is fixed)")
        return {"instrument": Instrument(("camera",), camera=words["camera"])}

    def words(self, instrument: Instrument) -> Mapping[str, Any]:
        """Where it is."""
        return {"camera": instrument.camera}

    def lines(self, instrument: Instrument) -> tuple[str, ...]:
        """Where it is."""
        return (f"camera: {instrument.camera}\n",)

    def said(self, instrument: Instrument, *, anchor_free: bool) -> str:
        """Where it is, and what is foreseen."""
        on_tool = instrument.camera == "on_tool"
        where = "is on the tool and sees a fixed target" if on_tool else "is fixed and sees a target on the tool"
        still = "the target" if on_tool else "the camera (facing their middle)"
        return (
            f"The camera {where}. The recording shows where both are. The forecast has {still} 1.5 to 2 times as far "
            "from the middle of the places reached as the outermost of them. Whether the target is in view is not "
            "checked."
        )

    def refuse(self, look: Look) -> None:
        """A camera that is where its target is said to be."""
        recording = look.recording
        if look.off is None or self.name not in recording.instrument.kinds:
            return
        camera = recording.instrument.camera
        other = "fixed" if camera == "on_tool" else "on_tool"
        tried = look.view(replace(recording, instrument=replace(recording.instrument, camera=other)))
        off, instead = (float(np.median(np.linalg.norm(item, axis=1))) for item in (look.off, tried.residual))
        if instead < look.rules.mistakes.better * off:
            far, near = (format_quantity(item, "length", digits=2) for item in (off, instead))
            message = f"is {camera}, which leaves {far} in the middle reading; {other} leaves {near}"
            raise refusal(recording.file, "camera", message, {"camera": other})


CAMERA = Camera()
