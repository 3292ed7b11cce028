"""An arm at a pose that sliders choose: in space, and from its side; its error there in words."""

from __future__ import annotations

import asyncio
import math

from nicegui import ui

from linkwright.browser.server.drawings import at_pose, middle
from linkwright.browser.server.posed import Posed
from linkwright.core.arm.chain.chain import Arm
from linkwright.results.figures_in_words import figure, mm

from .frame import picture
from .scene import ArmScene

_SPACE, _SIDE = "In space", "From the side"


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

        async def moved() -> None:
            self._pose[index] = low + float(slider.value or 0.0) * (high - low)
            said.text = _coordinate(self._pose[index], revolute)
            await self._draw()

        slider.on("update:model-value", moved, throttle=0.08)

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
                dark = await ui.run_javascript("matchMedia('(prefers-color-scheme: dark)').matches", timeout=10.0)
                if self._scene is None:
                    with self._place:
                        self._scene = ArmScene(dark=bool(dark))
            self._scene.show(posed, look, scale)


def _coordinate(value: float, revolute: bool) -> str:
    return f"{math.degrees(value):.0f}°" if revolute else f"{1e3 * value:.0f} mm"
