"""Diagnosis: a recording dropped, the meaning of its columns proposed and corrected, the report."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from dataclasses import replace
from pathlib import PurePosixPath
from typing import Any

from nicegui import events, ui

import linkwright as lw
from diagnose.reading.settings import read_settings
from diagnose.reading.table import Table, read_table
from linkwright.browser.server.desk import Desk
from linkwright.browser.server.folder import arm_from_text, staged
from linkwright.browser.server.guard import MOST_UPLOADED
from linkwright.browser.server.jobs import Job
from linkwright.browser.server.mapping import (
    IGNORED,
    OTHER,
    Meaning,
    known_names,
    proposed,
    settings_text,
    units_of,
)
from units.quantities import InputError

from .frame import Problem, framed, heading, panel, row, stack
from .job_panel import JobPanel
from .result_view import show_result

_SETTINGS = "recording.yaml"
_ENDINGS = (".csv", ".txt", ".tsv", ".dat", ".parquet", ".pq", ".xlsx")
_LAYOUT = ("skip_rows", "separator", "decimal", "encoding")


class DiagnosisPage:
    """The page of one visitor; what they dropped is held until they leave."""

    def __init__(self, desk: Desk) -> None:
        self._desk = desk
        self._arm: Any = None
        self._name, self._content = "", b""
        self._meanings: list[Meaning] = []
        self._fields: dict[str, ui.input | ui.select] = {}
        with framed("Diagnosis", "Drop a recording of the real arm; what its model leaves out is looked for."):
            with ui.element("div").classes("lw-two"):
                with stack():
                    with panel():
                        self._choice = ui.select([], label="Arm file", on_change=self._arm_chosen)
                        self._choice.props("dense outlined").classes("w-full")
                        self._upload = ui.upload(
                            label=f"Recording: drop it here (at most {MOST_UPLOADED // 1024**2} MB)",
                            auto_upload=True,
                            max_file_size=MOST_UPLOADED,
                            on_upload=self._dropped,
                            on_rejected=self._too_large,
                        ).props('flat bordered accept="' + ",".join(_ENDINGS) + '"')
                    self._problem = Problem()
                    with panel() as self._asked:
                        self._ask()
                with stack():
                    self._panel = JobPanel(self._ended)
                    with panel() as self._map_panel:
                        heading("What its columns are")
                        self._map = stack()
            self._result = stack()
        self._asked.visible = self._map_panel.visible = False

    def _ask(self) -> None:
        """What is known of the recording beside its columns, and the button."""
        self._line = ui.label().classes("lw-done")
        self._notes = ui.label().classes("lw-note")
        with ui.element("div").classes("lw-fields"):
            for name, label, options in (
                ("frame", "Measuring frame", {"": "known: the arm's base", "free": "free: to be fitted"}),
                ("tool", "Tool point", {"": "known", "free": "free: to be fitted"}),
                ("decimal", "Decimal sign", {"": "point", ",": "comma"}),
            ):
                chosen = ui.select(options, value="", label=label, on_change=self._reread).props("dense outlined")
                self._fields[name] = chosen
            for name, label, hint in (
                ("sigma", "Standard deviation", "15 um, where known"),
                ("skip_rows", "Lines above the header", "0"),
                ("separator", "Separator", "found by itself"),
                ("encoding", "Encoding", "utf-8"),
            ):
                field = ui.input(label, placeholder=hint).props("dense outlined")
                field.on("blur", self._reread)
                field.on("keydown.enter", self._reread)
                self._fields[name] = field
        with row():
            self._thorough = ui.checkbox("thorough: calibrates the whole search, takes longer").props("dense")
        self._go = ui.button("Diagnose", on_click=self._start).props("no-caps")

    async def begin(self) -> None:
        """List the arms."""
        names = await asyncio.to_thread(self._desk.folder.names, "arm")
        self._choice.set_options(names, value=names[0] if names else None)

    async def _arm_chosen(self) -> None:
        name = self._choice.value
        if not isinstance(name, str):
            return
        try:
            text = await asyncio.to_thread(self._desk.folder.read, name)
            self._arm = await asyncio.to_thread(arm_from_text, name, text)
        except InputError as error:
            self._arm = None
            self._problem.say(str(error))
            return
        self._problem.say("")
        if self._content:
            await self._propose()

    def _too_large(self) -> None:
        self._problem.say(f"a recording has at most {MOST_UPLOADED // 1024**2} MB and ends in {', '.join(_ENDINGS)}")

    async def _dropped(self, event: events.UploadEventArguments) -> None:
        name = PurePosixPath(event.file.name.replace("\\", "/")).name
        self._upload.reset()
        if PurePosixPath(name).suffix.lower() not in _ENDINGS or event.file.size() > MOST_UPLOADED:
            self._too_large()
            return
        letters = "".join(each if each.isalnum() or each in "._- " else "-" for each in name)
        self._name, self._content = letters[-80:].lstrip(".") or "recording.csv", await event.file.read()
        self._result.clear()
        await self._propose()

    def _told(self, *names: str) -> dict[str, str]:
        """The settings that are told in the fields."""
        return {name: str(self._fields[name].value or "").strip() for name in names}

    async def _propose(self) -> None:
        """Read the header anew, and propose what its columns are."""
        self._asked.visible = True
        if self._arm is None:
            self._problem.say("choose an arm file first; the Arm page can put an example into the folder")
            return
        try:
            table = await asyncio.to_thread(_table, self._name, self._content, self._told(*_LAYOUT))
        except InputError as error:
            self._map_panel.visible = False
            self._problem.say(str(error))
            self._go.enabled = False
            return
        self._meanings = list(proposed(table, self._arm.model))
        self._show_map()
        await self._check()

    async def _reread(self) -> None:
        if self._content:
            await self._propose()

    def _show_map(self) -> None:
        self._map.clear()
        self._map_panel.visible = True
        model = self._arm.model
        names = {name: name for name in known_names(model)}
        choices = {OTHER: "of its own, a possible cause", IGNORED: "not used", **names}
        with self._map:
            for number, meaning in enumerate(self._meanings):
                with ui.element("div").classes("lw-map"):
                    ui.label(meaning.header).tag = "span"
                    what = ui.select(choices, value=meaning.what).props(f'dense outlined aria-label="{number + 1} is"')
                    unit = ui.select([], value=None).props(f'dense outlined aria-label="unit of {number + 1}"')
                    _offer_units(unit, meaning, units_of(meaning.what, model))
                    what.on_value_change(self._changed(number, what, unit))
                    unit.on_value_change(self._changed(number, what, unit))

    def _changed(self, number: int, what: ui.select, unit: ui.select) -> Callable[[], Any]:
        async def changed() -> None:
            before = self._meanings[number]
            units = units_of(str(what.value), self._arm.model)
            chosen = str(unit.value) if unit.value in units else units[0] if units else ""
            now = replace(before, what=str(what.value), unit=chosen, guessed=False)
            if (now.what, now.unit) == (before.what, before.unit):
                return
            self._meanings[number] = now
            if now.what != before.what:
                _offer_units(unit, now, units)
            await self._check()

        return changed

    async def _check(self) -> None:
        """Read the recording as it is described now; what is wrong is a line."""
        try:
            text = self._settings()
            read = await asyncio.to_thread(_read_recording, self._arm, self._name, self._content, text)
        except InputError as error:
            self._problem.say(str(error))
            self._line.text = self._notes.text = ""
            self._go.enabled = False
            return
        self._problem.say("")
        self._go.enabled = True
        self._line.text = repr(read)[1:-1]
        guessed = [each for each in self._meanings if each.guessed]
        notes = [f"{each.header}: {each.unit} is a guess by the size of its numbers." for each in guessed]
        self._notes.text = " ".join([*notes, *read.warnings])

    def _settings(self) -> str:
        twice = [each.what for each in self._meanings if each.what not in (OTHER, IGNORED)]
        again = next((name for k, name in enumerate(twice) if name in twice[:k]), None)
        if again is not None:
            raise InputError(self._name, again, "is what two columns are said to be; choose one of them")
        return settings_text(self._meanings, self._told(*_LAYOUT, "frame", "tool", "sigma"))

    async def _start(self) -> None:
        arm = str(self._choice.value)
        try:
            text = await asyncio.to_thread(self._desk.folder.read, arm)
            inputs = {arm: text.encode(), f"told/{self._name}": self._content, f"told/{_SETTINGS}": b""}
            inputs[f"told/{_SETTINGS}"] = self._settings().encode()
            asked = {
                "arm": arm,
                "recording": f"told/{self._name}",
                "settings": f"told/{_SETTINGS}",
                "thorough": bool(self._thorough.value),
            }
            job = self._desk.jobs.start("diagnose", f"{arm} by {self._name}", inputs, asked)
        except InputError as error:
            self._panel.refuse(str(error))
            return
        self._result.clear()
        self._panel.follow(job)

    def _ended(self, job: Job) -> None:
        with self._result:
            show_result(self._desk, job.result or 0)


def _offer_units(select: ui.select, meaning: Meaning, units: tuple[str, ...]) -> None:
    select.set_options(list(units), value=meaning.unit if meaning.unit in units else None)
    select.visible = bool(units)


def _table(name: str, content: bytes, layout: dict[str, str]) -> Table:
    with staged({name: content, _SETTINGS: settings_text((), layout).encode()}) as root:
        return read_table(root / name, read_settings(root / _SETTINGS).layout)


def _read_recording(arm: Any, name: str, content: bytes, settings: str) -> Any:
    with staged({name: content, _SETTINGS: settings.encode()}) as root:
        return lw.read_recording(root / name, arm, settings=root / _SETTINGS)
