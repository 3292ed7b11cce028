"""Diagnosis: recordings dropped, the meaning of their columns proposed and corrected, the report."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from pathlib import PurePosixPath
from typing import Any

from nicegui import events, ui

from linkwright.browser.server.answers import Desk
from linkwright.browser.server.dropped import (
    IGNORED,
    OTHER,
    Dropped,
    Meaning,
    known_names,
    plain_name,
    question,
    units_of,
    with_another,
)
from linkwright.browser.server.folder import arm_from_text
from linkwright.browser.server.guard import MOST_UPLOADED
from linkwright.core.units.quantities import InputError

from .frame import Problem, framed, heading, panel, row, stack
from .result_view import Asking

_ENDINGS = (".csv", ".txt", ".tsv", ".dat", ".parquet", ".pq", ".xlsx")


class DiagnosisPage(Asking):
    """The page of one visitor; what they dropped is held until they leave."""

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk)
        self._arm: Any = None
        self._held: list[Dropped] = []
        self._shown: Dropped | None = None
        self._fields: dict[str, ui.input | ui.select] = {}
        with framed("Diagnosis", "Drop recordings of the real arm; what its model leaves out is looked for."):
            with ui.element("div").classes("lw-two"):
                with stack():
                    with panel():
                        self._choice = ui.select([], label="Arm file", on_change=self._arm_chosen)
                        self._choice.props("dense outlined").classes("w-full")
                        self._upload = ui.upload(
                            label=f"Recordings: drop them here (at most {MOST_UPLOADED // 1024**2} MB)",
                            multiple=True,
                            auto_upload=True,
                            max_file_size=MOST_UPLOADED,
                            on_upload=self._dropped,
                            on_rejected=self._too_large,
                        ).props('flat bordered accept="' + ",".join(_ENDINGS) + '"')
                        self._upload.on("finish", self._upload.reset)
                    self._problem = Problem()
                    with panel() as self._asked:
                        self._ask()
                with stack():
                    self._work()
                    with panel() as self._map_panel:
                        self._map_heading = heading("What its columns are")
                        self._map = stack()
            self._answers()
        self._asked.visible = self._map_panel.visible = False

    def _ask(self) -> None:
        """Which recordings there are, what is known of the one that is shown beside its columns, and the button."""
        with row() as self._several:
            self._which = ui.select([], label="Recording", on_change=self._chosen).props("dense outlined")
            self._which.classes("grow min-w-40")
            ui.button("Take out", on_click=self._take_out).props("outline dense no-caps")
        self._line = ui.label().classes("lw-done whitespace-pre-line")
        self._notes = ui.label().classes("lw-note")
        with ui.element("div").classes("lw-fields lw-roomy"):
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
            self._thorough = ui.checkbox("thorough: more draws, takes longer").props("dense")
            self._units = ui.checkbox("of several arms of one type: anything may differ").props("dense")
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
        for each in self._held:
            await self._propose(each)
        self._show()

    def _too_large(self) -> None:
        self._problem.say(f"a recording has at most {MOST_UPLOADED // 1024**2} MB and ends in {', '.join(_ENDINGS)}")

    async def _dropped(self, event: events.UploadEventArguments) -> None:
        name = plain_name(event.file.name)
        if PurePosixPath(name).suffix.lower() not in _ENDINGS or event.file.size() > MOST_UPLOADED:
            self._too_large()
            return
        # What is told of the one before is likely so of the next as well.
        told = dict(self._shown.told) if self._shown is not None else {}
        fresh = Dropped(name, await event.file.read(), told)
        try:
            self._held = with_another(self._held, fresh)
        except InputError as error:
            self._problem.say(str(error))
            return
        self._result.clear()
        await self._propose(fresh, self._shown)
        self._shown = fresh
        self._show()

    async def _propose(self, each: Dropped, like: Dropped | None = None) -> None:
        """Read a header anew, propose what its columns are, and read the recording so."""
        if self._arm is not None:
            await asyncio.to_thread(each.propose, self._arm, like)
            if not each.problem:
                await asyncio.to_thread(each.check, self._arm)

    def _show(self) -> None:
        """The recording that is looked at: its fields, its columns, and what is read of all."""
        shown = self._shown
        self._asked.visible = shown is not None
        if shown is None:
            self._map_panel.visible = False
            self._problem.say("")
            return
        if self._arm is None:
            self._problem.say("choose an arm file first; the Arm page can put an example into the folder")
            return
        for name, field in self._fields.items():
            field.value = shown.told.get(name, "")
        self._show_map()
        self._tell()

    def _tell(self) -> None:
        """What is read of all, and what is wrong with the first that anything is wrong with."""
        shown = self._shown
        names = [each.name for each in self._held]
        self._which.set_options(names, value=None if shown is None else shown.name)
        self._several.visible = self._units.visible = len(self._held) > 1
        wrong = [each.problem for each in self._held if each.problem]
        own = shown.problem if shown is not None else ""
        self._problem.say(own or next(iter(wrong), ""))
        self._line.text = "\n".join(each.line for each in self._held if each.line)
        self._notes.text = "" if shown is None else shown.notes
        self._go.enabled = bool(self._held) and not wrong

    def _chosen(self) -> None:
        found = next((each for each in self._held if each.name == self._which.value), None)
        if found is not None and found is not self._shown:
            self._shown = found
            self._show()

    def _take_out(self) -> None:
        self._held = [each for each in self._held if each is not self._shown]
        self._shown = self._held[-1] if self._held else None
        self._show()

    async def _reread(self) -> None:
        shown = self._shown
        told = {name: str(field.value or "").strip() for name, field in self._fields.items()}
        if shown is None or told == {name: shown.told.get(name, "") for name in told}:
            return
        shown.told = told
        await self._propose(shown)
        self._show()

    def _show_map(self) -> None:
        self._map.clear()
        shown = self._shown
        self._map_panel.visible = shown is not None and bool(shown.meanings)
        if shown is None:
            return
        self._map_heading.text = f"What the columns of {shown.name} are" if len(self._held) > 1 else _COLUMNS
        model = self._arm.model
        names = {name: name for name in known_names(model)}
        choices = {OTHER: "of its own, a possible cause", IGNORED: "not used", **names}
        with self._map:
            for number, meaning in enumerate(shown.meanings):
                with ui.element("div").classes("lw-map"):
                    ui.label(meaning.header).tag = "span"
                    what = ui.select(choices, value=meaning.what).props(f'dense outlined aria-label="{number + 1} is"')
                    unit = ui.select([], value=None).props(f'dense outlined aria-label="unit of {number + 1}"')
                    _offer_units(unit, meaning, units_of(meaning.what, model))
                    what.on_value_change(self._changed(shown, number, what, unit))
                    unit.on_value_change(self._changed(shown, number, what, unit))

    def _changed(self, shown: Dropped, number: int, what: ui.select, unit: ui.select) -> Callable[[], Any]:
        async def changed() -> None:
            before = shown.meanings[number]
            units = units_of(str(what.value), self._arm.model)
            chosen = str(unit.value) if unit.value in units else units[0] if units else ""
            if not shown.change(number, str(what.value), chosen):
                return
            if str(what.value) != before.what:
                _offer_units(unit, shown.meanings[number], units)
            await asyncio.to_thread(shown.check, self._arm)
            self._tell()

        return changed

    async def _start(self) -> None:
        arm = str(self._choice.value)
        try:
            text = await asyncio.to_thread(self._desk.folder.read, arm)
            several = len(self._held) > 1 and bool(self._units.value)
            title, inputs, asked = question(arm, text, self._held, thorough=bool(self._thorough.value), units=several)
            self._begin("diagnose", title, inputs, asked)
        except InputError as error:
            self._panel.refuse(str(error))


_COLUMNS = "What its columns are"


def _offer_units(select: ui.select, meaning: Meaning, units: tuple[str, ...]) -> None:
    select.set_options(list(units), value=meaning.unit if meaning.unit in units else None)
    select.visible = bool(units)
