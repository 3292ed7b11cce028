"""An arm at a pose that sliders choose: in space, and from its side; its error there in words."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from functools import partial
from types import MappingProxyType

import numpy as np
from nicegui import events, ui

from linkwright.browser.pages.frame import picture, row
from linkwright.browser.server.drawings import at_pose, middle
from linkwright.browser.server.posed import Look, Posed
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.sections.numeric import Array
from linkwright.results.figures_in_words import figure, mm

_SIZE = 2.0
"""The arm's reach in units of the scene, for which its camera is made."""
_LINKS = ("#2f6fd6", "#6a9ff0")
_BENT, _ERROR = "#e69f00", "#d63a1f"
_SEEN_THROUGH = 0.6
"""Opacity of links: what they are bent to runs within them."""
_THIN, _TUBE = 0.014, 0.02
_ROOM = 3.3
"""How far the camera is off, in half sizes of what it looks at."""
_WAYS: Mapping[str, tuple[float, float, float]] = MappingProxyType(
    {"Oblique": (0.545, -0.741, 0.392), "Side": (0.0, -1.0, 0.0), "Above": (0.0, -0.01, 1.0)}
)
_LEAST_JOINT = 0.035
_ROUND = 28


class ArmScene:
    """The view; it is made once the browser is there, for it asks that for its colours."""

    def __init__(self, *, dark: bool) -> None:
        self._rest = "#aab4c0" if dark else "#56616f"
        self._posed: Posed | None = None
        self._looked_from: tuple[object, ...] = ()
        self._middle, self._far = np.zeros(3), _ROOM * _SIZE
        self._links: list[list[ui.scene.extrusion]] = []
        self._joints: list[ui.scene.cylinder] = []
        self._passing: list[ui.scene.cylinder | ui.scene.quadratic_bezier_tube] = []
        camera = ui.scene.perspective_camera(fov=40, near=0.05, far=100)
        back = "#1a212a" if dark else "#f4f6f9"
        self._scene = ui.scene(grid=False, camera=camera, background_color=back, fps=30, click_events=[])
        self._scene.classes("lw-scene").props('role=img aria-label="the arm in space"')
        with row().classes("lw-views"):
            for name, way in _WAYS.items():
                button = ui.button(name, on_click=partial(self._look_from, way))
                button.props(f'flat dense no-caps size=sm aria-label="{name} view"')

    def show(self, posed: Posed, look: Look, scale: float) -> None:
        """Draw an arm at a pose, displacements `scale` times as large."""
        fresh = posed is not self._posed
        self._posed = posed
        with self._scene:
            if fresh:
                self._build(posed, look)
            self._place(posed, look)
            self._draw_passing(posed, look, scale)
        kind = (posed.arm.name, posed.arm.size, round(float(np.log2(posed.size))))
        if kind != self._looked_from:  # another arm; else it is looked at from where it was turned to
            self._looked_from = kind
            corners = [np.zeros(3), look.tip, *(joint for joint, _ in look.joints)]
            low, high = (_SIZE / posed.size * edge(corners, axis=0) for edge in (np.min, np.max))
            self._middle = 0.5 * (low + high)
            self._far = _ROOM * max(0.5 * float(np.linalg.norm(high - low)), 0.3 * _SIZE)
            self._look_from(_WAYS["Oblique"])

    def _build(self, posed: Posed, look: Look) -> None:
        self._scene.delete_objects()
        self._passing.clear()
        unit = _SIZE / posed.size
        self._links = []
        for number, (pieces, placed) in enumerate(zip(posed.pieces, look.links, strict=True)):
            made: list[ui.scene.extrusion] = []
            for piece in pieces:
                outline = [[unit * x, unit * y] for x, y in piece.outline]
                solid = ui.scene.extrusion(outline, unit * placed.length * (piece.end - piece.begin))
                made.append(
                    solid.material(_LINKS[number % len(_LINKS)], opacity=_SEEN_THROUGH, side="both").with_name(
                        f"link {number + 1}"
                    )
                )
            self._links.append(made)
        self._joints = []
        for number in range(len(look.joints)):
            radius = _joint_radius(posed, number, unit)
            joint = ui.scene.cylinder(radius, radius, 2.6 * radius, _ROUND).material(self._rest)
            self._joints.append(joint.with_name(f"joint {number + 1}"))
        base = ui.scene.cylinder(0.16, 0.2, 0.03, _ROUND).material(self._rest, opacity=0.5)
        base.rotate_R(_turned(posed.up)).move(*(-0.015 * posed.up))
        ui.scene.axes_helper(0.35)

    def _place(self, posed: Posed, look: Look) -> None:
        unit = _SIZE / posed.size
        for pieces, solids, placed in zip(posed.pieces, self._links, look.links, strict=True):
            for piece, solid in zip(pieces, solids, strict=True):
                start = placed.start + piece.begin * placed.length * placed.rotation[:, 2]
                solid.rotate_R(placed.rotation.tolist()).move(*(unit * start).tolist())
        for joint, (where, axis) in zip(self._joints, look.joints, strict=True):
            joint.rotate_R(_turned(axis)).move(*(unit * where).tolist())

    def _draw_passing(self, posed: Posed, look: Look, scale: float) -> None:
        """What changes its form from pose to pose."""
        for item in self._passing:
            item.delete()
        unit = _SIZE / posed.size
        self._passing = [self._rod(unit * a, unit * b, _THIN, self._rest) for a, b in look.leads]
        if look.bent is not None:
            places, shifts = look.bent
            self._passing += _tubes(unit * (places + scale * shifts), (len(places) - 1) // posed.arm.size)
        if look.worst is not None and look.worst.error > 0.0:
            tip = unit * look.tip
            end = tip + unit * scale * np.array(look.worst.vector, dtype=float)
            neck = tip + 0.75 * (end - tip)
            self._passing.append(self._rod(tip, neck, 1.4 * _THIN, _ERROR).with_name("error"))
            self._passing.append(self._rod(neck, end, 3.2 * _THIN, _ERROR, far=0.0))

    def _rod(self, start: Array, end: Array, radius: float, colour: str, far: float = 1.0) -> ui.scene.cylinder:
        """A cylinder from one place to another; a cone where it has no radius at the `far` end."""
        way = end - start
        length = max(float(np.linalg.norm(way)), 1e-6)
        rod = ui.scene.cylinder(far * radius, radius, length, 14).material(colour)
        return rod.rotate_R(_turned(way / length)).move(*(0.5 * (start + end)).tolist())

    def _look_from(self, way: Sequence[float]) -> None:
        """Look at the arm from a side: along the base, across it and up, a unit vector."""
        if self._posed is None:
            return
        up = self._posed.up
        along = np.array([1.0, 0.0, 0.0]) if abs(up[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
        along = along - (along @ up) * up
        along /= np.linalg.norm(along)
        eye = self._middle + self._far * (way[0] * along + way[1] * np.cross(up, along) + way[2] * up)
        self._scene.move_camera(*eye.tolist(), *self._middle.tolist(), *up.tolist(), duration=0.2)


def _joint_radius(posed: Posed, number: int, unit: float) -> float:
    """Of a joint's drum: somewhat more than half of the thicker link beside it."""
    beside = [piece for link in posed.pieces[max(0, number - 1) : number + 1] for piece in link]
    halves = [0.5 * max(float(np.ptp(column)) for column in np.transpose(piece.outline)) for piece in beside]
    return max(_LEAST_JOINT, 0.55 * unit * max(halves, default=0.0))


def _tubes(course: Array, per_link: int) -> list[ui.scene.quadratic_bezier_tube]:
    """The bent course, a curve through three places of each link."""
    tubes: list[ui.scene.quadratic_bezier_tube] = []
    for first in range(0, len(course) - 1, per_link):
        start, middle, end = course[first], course[first + per_link // 2], course[first + per_link - 1]
        control = 2.0 * middle - 0.5 * (start + end)
        tube = ui.scene.quadratic_bezier_tube(start.tolist(), control.tolist(), end.tolist(), 16, _TUBE, 8)
        tubes.append(tube.material(_BENT).with_name("bent"))
    return tubes


def _turned(axis: Array) -> list[list[float]]:
    """A rotation that takes y, along which cylinders stand, to an axis."""
    y = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    helper = np.array([1.0, 0.0, 0.0]) if abs(y[0]) < 0.9 else np.array([0.0, 0.0, 1.0])
    z = np.cross(helper, y)
    z /= np.linalg.norm(z)
    return np.column_stack((np.cross(y, z), y, z)).tolist()


_SPACE, _SIDE = "In space", "From the side"
_HEAR_SCHEME = """<script>
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => emitEvent("lw-scheme"));
</script>"""


class PoseView:
    """The view and its sliders; `show` gives it an arm."""

    def __init__(self) -> None:
        self._posed: Posed | None = None
        self._pose: list[float] = []
        self._ranges: list[tuple[float, float]] = []
        self._asked = 0
        self._scene: ArmScene | None = None
        with ui.tabs().props("dense align=left no-caps") as tabs:
            space, side = ui.tab(_SPACE), ui.tab(_SIDE)
        panels = ui.tab_panels(tabs, value=_SPACE, animated=False, keep_alive=True, on_change=self._draw)
        with panels.classes("w-full"):
            with ui.tab_panel(space).classes("p-0"):
                self._place = ui.element("div").classes("lw-stack")
            with ui.tab_panel(side).classes("p-0"):
                self._picture = picture()
        self._panels = panels
        self._words = ui.label().classes("lw-note").props("role=status")
        self._sliders = ui.element("div").classes("lw-slides")
        ui.add_head_html(_HEAR_SCHEME)
        ui.on("lw-scheme", self._draw_anew)

    async def show(self, arm: Arm) -> None:
        """Draw an arm: at the pose that was chosen, or in the middle of its ranges where those are others."""
        self._posed = Posed(arm)
        ranges = [joint.range for joint in arm.joints]
        if ranges != self._ranges:
            self._ranges, self._pose = ranges, list(middle(arm))
            self._show_sliders(arm)
        await self._draw()

    def _show_sliders(self, arm: Arm) -> None:
        self._sliders.clear()
        with self._sliders:
            for index, joint in enumerate(arm.joints):
                if joint.driven:
                    with ui.element("div").classes("lw-slide"):
                        self._slider(index, joint.range, revolute=joint.revolute)

    def _slider(self, index: int, span: tuple[float, float], *, revolute: bool) -> None:
        low, high = span
        share = (self._pose[index] - low) / (high - low) if high > low else 0.5
        ui.label(f"joint {index + 1}").classes("lw-note")
        slider = ui.slider(min=0.0, max=1.0, step=0.01, value=round(share, 2))
        slider.props(f'dense aria-label="joint {index + 1}"')
        said = ui.label(_coordinate(self._pose[index], revolute)).classes("lw-note")

        async def moved(event: events.GenericEventArguments) -> None:
            # What the event brings: the slider's own value is told by another message, which may come later.
            self._pose[index] = low + float(event.args or 0.0) * (high - low)
            said.text = _coordinate(self._pose[index], revolute)
            await self._draw()

        slider.on("update:model-value", moved, throttle=0.08)

    async def _draw_anew(self) -> None:
        """The scene in the colours that the page has now."""
        self._place.clear()
        self._scene = None
        await self._draw()

    async def _draw(self) -> None:
        """Draw what is looked at; a pose that another has overtaken is passed over."""
        posed, pose = self._posed, tuple(self._pose)
        if posed is None:
            return
        self._asked += 1
        mine = self._asked
        if self._panels.value == _SIDE:
            svg = await asyncio.to_thread(at_pose, posed.arm, pose)
            if mine == self._asked:
                self._picture.content = svg
        look = await asyncio.to_thread(posed.at, pose)
        if mine != self._asked:
            return
        scale = posed.scale(look)
        if look.worst is None:
            self._words.text = "The error is not known. A mass or a material is missing."
        else:
            words = f"Error at this pose: {mm(look.worst.error, 3)}."
            larger = "" if scale == 1.0 else f" Both {figure(scale)} times as large."
            self._words.text = f"{words} Red: that error. Orange: the bent shape.{larger}"
        if self._panels.value == _SPACE:
            if self._scene is None:
                dark = False
                with suppress(TimeoutError):  # a page that is closed does not answer; it may come back
                    dark = await ui.run_javascript("matchMedia('(prefers-color-scheme: dark)').matches", timeout=10.0)
                if self._scene is None:
                    with self._place:
                        self._scene = ArmScene(dark=bool(dark))
            self._scene.show(posed, look, scale)


def _coordinate(value: float, revolute: bool) -> str:
    return f"{math.degrees(value):.0f}°" if revolute else f"{1e3 * value:.0f} mm"
