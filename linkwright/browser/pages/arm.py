"""The arm: drawn to scale while it is edited, evaluated."""

from __future__ import annotations

import asyncio
import math
from typing import Any

from nicegui import ui

from linkwright.browser.server.answers import Desk
from linkwright.browser.server.asked import Asked
from linkwright.browser.server.drawings import at_pose, middle
from linkwright.browser.server.folder import arm_from_text
from linkwright.core.units.quantities import InputError

from .asking import Asking
from .edit.file_choice import FileChoice
from .frame import Problem, framed, panel, picture, sides


class ArmPage(Asking):
    """The page of one visitor."""

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk, "evaluate")
        self._arm: Any = None
        self._pose: list[float] = []
        self._ranges: list[tuple[float, float]] = []
        with framed("Arm", "Edit an arm, see it to scale, and ask for its worst error."), sides() as (left, right):
            with left:
                self._choice = FileChoice(desk, "arm", self._check)
            with right:
                self._problem = Problem()
                with panel():
                    self._line = ui.label().classes("lw-done")
                    self._picture = picture()
                    self._sliders = ui.element("div").classes("lw-slides")
                self._ask = ui.button("Evaluate", on_click=self._evaluate).props("no-caps")
                self._ask.enabled = False  # until the file is read
                self._answers()

    def _now(self) -> tuple[str, str]:
        return self._choice.editor.name, self._choice.editor.text

    async def _open(self, asked: Asked | None) -> None:
        await self._choice.begin(asked)

    async def _open_as_it_was(self, asked: Asked) -> None:
        await self._choice.open_as_it_was(asked)

    async def _check(self) -> None:
        name, text = self._choice.editor.name, self._choice.editor.text
        await self._compare()
        try:
            self._arm = await asyncio.to_thread(arm_from_text, name, text)
        except InputError as error:
            self._problem.say(str(error))
            self._choice.editor.mark(error)
            self._ask.enabled = False
            return
        self._problem.say("")
        self._choice.editor.mark(None)
        self._ask.enabled = True
        self._line.text = repr(self._arm)[1:-1]
        ranges = [joint.range for joint in self._arm.model.joints]
        if ranges != self._ranges:  # another arm; else it stays at the pose that was chosen
            self._ranges, self._pose = ranges, list(middle(self._arm.model))
            self._show_sliders()
        await self._draw()

    def _show_sliders(self) -> None:
        self._sliders.clear()
        with self._sliders:
            for index, joint in enumerate(self._arm.model.joints):
                low, high = joint.range
                if not joint.driven:
                    continue
                with ui.element("div").classes("lw-slide"):
                    ui.label(f"joint {index + 1}").classes("lw-note")
                    slider = ui.slider(min=0.0, max=1.0, step=0.01, value=0.5).props("dense")
                    label = ui.label(_coordinate(0.5 * (low + high), joint.revolute)).classes("lw-note")

                    async def moved(index: int = index, slider: ui.slider = slider, said: ui.label = label) -> None:
                        joint = self._arm.model.joints[index]
                        low, high = joint.range
                        self._pose[index] = low + slider.value * (high - low)
                        said.text = _coordinate(self._pose[index], joint.revolute)
                        await self._draw()

                    slider.on("update:model-value", moved, throttle=0.08)

    async def _draw(self) -> None:
        self._picture.content = await asyncio.to_thread(at_pose, self._arm.model, tuple(self._pose))

    async def _evaluate(self) -> None:
        name = self._choice.editor.name
        try:
            self._desk.folder.place(name)
            self._begin(self._arm.name, {name: self._choice.editor.text.encode()}, {"arm": name})
        except InputError as error:
            self._runs.refuse(str(error))


def _coordinate(value: float, revolute: bool) -> str:
    return f"{math.degrees(value):.0f}°" if revolute else f"{1e3 * value:.0f} mm"
