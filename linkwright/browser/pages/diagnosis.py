"""Diagnosis: recordings dropped, the meaning of their columns proposed and corrected, the report."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Mapping
from functools import partial
from pathlib import PurePosixPath
from typing import Any

from nicegui import events, ui

from linkwright.browser.server.answers import Desk
from linkwright.browser.server.asked import Asked
from linkwright.browser.server.dropped import FURTHER, Dropped, plain_name, question, simulated, with_another
from linkwright.browser.server.folder import arm_among, is_description
from linkwright.browser.server.guard import MOST_UPLOADED
from linkwright.core.diagnose.reading.foreign.proposal import IGNORED, OTHER, Meaning, known_names, units_of
from linkwright.core.units.quantities import InputError, NoAnswer, read_number
from linkwright.core.units.reading import yaml_line

from .asking import Asking
from .frame import Problem, dropped_or_chosen, explained, framed, panel, row, sides, stack

_ENDINGS = (".csv", ".txt", ".tsv", ".dat", ".parquet", ".pq", ".xlsx")


class DiagnosisPage(Asking):
    """The page of one visitor; what they dropped is held until they leave."""

    _edits = False

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk, "diagnose")
        self._arm: Any = None
        self._held: list[Dropped] = []
        self._looked_at: Dropped | None = None
        self._arm_text = ""
        self._fields: dict[str, ui.input | ui.select | ui.textarea] = {}
        lead = "Drop recordings of the real arm. The diagnosis finds what its file is missing."
        with framed("Diagnosis", lead), sides("lw-diagnosis") as (left, right):
            with left:
                with panel():
                    self._choice = ui.select([], label="Arm file", on_change=self._arm_chosen)
                    self._choice.props("dense outlined").classes("w-full")
                    self._upload = ui.upload(
                        multiple=True,
                        auto_upload=True,
                        max_file_size=MOST_UPLOADED,
                        on_upload=self._dropped,
                        on_rejected=self._too_large,
                    ).props('flat bordered accept="' + ",".join(_ENDINGS) + '"')
                    self._upload.on("finish", self._upload.reset)
                    dropped_or_chosen(
                        self._upload,
                        f"Drop recordings here (at most {MOST_UPLOADED // 1024**2} MB)",
                        "Choose recordings",
                    )
                self._problem = Problem()
                self._offers = row()
                with panel().classes("lw-asked") as self._asked:
                    self._ask()
            with right:
                with panel() as self._first:
                    self._explain()
                with ui.expansion(_COLUMNS, value=True).classes("lw-panel lw-columns") as self._map_panel:
                    self._map = stack()
                self._answers()
        self._asked.visible = self._map_panel.visible = False

    def _explain(self) -> None:
        """What a recording is, while there is none."""
        explained(
            "What a recording is", _KINDS, "A table of poses, measured or logged. Its columns may have any names."
        )
        self._example = ui.button("Try a simulated recording of this arm", on_click=self._simulated)
        self._example.props("outline dense no-caps").classes("self-start")

    async def _simulated(self) -> None:
        """Drop a recording that the arm itself makes, with an encoder that is off."""
        if self._arm is None:
            await self._arm_chosen()  # its file may still be on the way
        if self._arm is None:
            self._problem.say(_NO_ARM)
            return
        self._example.enabled = False
        try:
            fresh = await asyncio.to_thread(simulated, self._arm)
        except (InputError, NoAnswer) as error:
            self._problem.say(str(error))
            return
        finally:
            self._example.enabled = True
        await self._add(fresh)

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
            further = ui.textarea("Further lines of recording.yaml", placeholder="gear_ratios: [100, 100]")
            further.props("dense outlined autogrow").classes("lw-wide").on("blur", self._reread)
            self._fields[FURTHER] = further
        with row():
            self._thorough = ui.checkbox("thorough: more draws, takes longer").props("dense")
            self._units = ui.checkbox("of several arms of one type: anything may differ").props("dense")
        self._go = ui.button("Diagnose", on_click=self._start).props("no-caps")

    def _now(self) -> tuple[str, str]:
        return str(self._choice.value or "") if self._arm_text else "", self._arm_text

    async def _open(self, asked: Asked | None) -> None:
        names = await asyncio.to_thread(self._desk.folder.names, "arm", "description")
        first = names[0] if names else None
        self._choice.props(remove="hint") if names else self._choice.props(f'hint="{_NONE}"')
        self._example.enabled = bool(names)
        self._first.visible = self._runs.last is None
        self._choice.set_options(names, value=asked.file if asked is not None and asked.file in names else first)

    async def _open_as_it_was(self, asked: Asked) -> None:
        await self._open(asked)  # an arm is edited on its page

    async def _arm_chosen(self) -> None:
        name = self._choice.value
        if not isinstance(name, str):
            return
        try:
            files = await asyncio.to_thread(self._desk.folder.arm, name)
            self._arm = await asyncio.to_thread(arm_among, name, files)
        except InputError as error:
            self._arm, self._arm_text = None, ""
            asks = error.key == "tip" and is_description(name)
            self._problem.say(f"{error}{_ASKS_FOR_TIP if asks else ''}")
            await self._compare()
            return
        self._arm_text = files[name].decode(errors="replace")
        await self._compare()
        self._problem.say("")
        for item in self._held:
            await self._propose(item)
        self._show()

    def _too_large(self) -> None:
        self._problem.say(f"a recording has at most {MOST_UPLOADED // 1024**2} MB and ends in {', '.join(_ENDINGS)}")

    async def _dropped(self, event: events.UploadEventArguments) -> None:
        name = plain_name(event.file.name)
        if PurePosixPath(name).suffix.lower() not in _ENDINGS or event.file.size() > MOST_UPLOADED:
            self._too_large()
            return
        # What is told of the one before is likely so of the next as well.
        settings = dict(self._looked_at.given) if self._looked_at is not None else {}
        await self._add(Dropped(name, await event.file.read(), settings))

    async def _add(self, fresh: Dropped) -> None:
        """Look at another recording."""
        try:
            self._held = with_another(self._held, fresh)
        except InputError as error:
            self._problem.say(str(error))
            return
        self._clear()
        await self._propose(fresh, self._looked_at)
        self._looked_at = fresh
        self._show()

    async def _propose(self, recording: Dropped, like: Dropped | None = None) -> None:
        """Read a header anew, propose what its columns are, and read the recording so."""
        arm = None
        while arm is not self._arm:  # another one may be chosen meanwhile
            arm = self._arm
            await asyncio.to_thread(recording.propose, arm, like)
            if not recording.problem:
                await asyncio.to_thread(recording.check, arm)

    def _show(self) -> None:
        """The recording that is looked at: its fields, its columns, and what is read of all."""
        shown = self._looked_at
        self._asked.visible = shown is not None
        self._first.visible = shown is None and self._runs.last is None
        if shown is None:
            self._map_panel.visible = False
            self._problem.say("")
            self._offers.clear()
            return
        if self._arm is None:
            self._problem.say(_NO_ARM)
            return
        for name, field in self._fields.items():
            field.value = shown.given.get(name, "")
        self._show_map()
        self._tell()

    def _tell(self) -> None:
        """What is read of all, and what is wrong with the first that anything is wrong with."""
        shown = self._looked_at
        names = [item.name for item in self._held]
        self._which.set_options(names, value=None if shown is None else shown.name)
        self._several.visible = self._units.visible = len(self._held) > 1
        wrong = [item.problem for item in self._held if item.problem]
        problem = shown.problem if shown is not None else ""
        self._problem.say(problem or next(iter(wrong), ""))
        self._offers.clear()
        with self._offers:
            for remedy in () if shown is None else shown.remedies:
                settings = ", ".join(f"{key}: {yaml_line(value)}" for key, value in remedy.items())
                ui.button(f"Take {settings}", on_click=partial(self._take, remedy)).props("outline dense no-caps")
        self._line.text = "\n".join(item.line for item in self._held if item.line)
        self._notes.text = "" if shown is None else shown.notes
        for name in ("frame", "tool"):  # of a tip that was measured
            self._fields[name].visible = shown is None or not shown.log
        self._go.enabled = bool(self._held) and not wrong

    def _chosen(self) -> None:
        recording = next((item for item in self._held if item.name == self._which.value), None)
        if recording is not None and recording is not self._looked_at:
            self._looked_at = recording
            self._show()

    def _take_out(self) -> None:
        self._held = [item for item in self._held if item is not self._looked_at]
        self._looked_at = self._held[-1] if self._held else None
        self._show()

    async def _reread(self) -> None:
        shown = self._looked_at
        settings = {name: str(field.value or "").strip() for name, field in self._fields.items()}
        if shown is None or settings == {name: shown.given.get(name, "") for name in settings}:
            return
        shown.given = settings
        await self._propose(shown)
        self._show()

    def _show_map(self) -> None:
        self._map.clear()
        self._map_panel.value = True
        shown = self._looked_at
        self._map_panel.visible = shown is not None and bool(shown.meanings)
        if shown is None:
            return
        self._map_panel.text = f"What the columns of {shown.name} are" if len(self._held) > 1 else _COLUMNS
        model = self._arm.model
        names = {name: name for name in known_names(model)}
        choices = {OTHER: "other data (tested as a cause)", IGNORED: "not used", **names}
        with self._map:
            for number, meaning in enumerate(shown.meanings):
                with ui.element("div").classes("lw-map") as place:
                    _ColumnRow(place, number, meaning, choices, model, partial(self._changed, shown, number))

    async def _changed(self, shown: Dropped, number: int, what: str, unit: str, factor: float, zero: float) -> None:
        if shown.change(number, what, unit, factor, zero):
            await asyncio.to_thread(shown.check, self._arm)
            self._tell()

    async def _take(self, remedy: Mapping[str, Any]) -> None:
        """Settle the recording that is looked at as its refusal proposes."""
        shown = self._looked_at
        if shown is None:
            return
        try:
            shown.take(remedy)
        except InputError as error:
            self._problem.say(str(error))
            return
        await asyncio.to_thread(shown.check, self._arm)
        self._show()

    async def _start(self) -> None:
        arm = str(self._choice.value)
        try:
            files = await asyncio.to_thread(self._desk.folder.arm, arm)
            several = len(self._held) > 1 and bool(self._units.value)
            title, inputs, request = question(
                arm, files, self._held, thorough=bool(self._thorough.value), units=several
            )
            self._begin(title, inputs, request)
            self._map_panel.value = False  # the answer takes its place
        except InputError as error:
            self._runs.refuse(str(error))


_COLUMNS = "What its columns are"
_NONE = "The folder has no arm file, URDF or MJCF. The Arm page begins one, or adds an example."
_ASKS_FOR_TIP = ". On the Arm page a new arm begins from it, which asks for the tip"
_NO_ARM = "choose an arm file first; the Arm page can put an example into the folder"
_KINDS = (
    ("Measured tips", "Joint angles, and where a tracker or a dial gauge saw the tip."),
    ("A motion log", "Time, joint angles and torques, currents or voltages, as a controller logs them."),
)


class _ColumnRow:
    """A column: what it is, in which unit, by which factor and zero; `changed` is awaited with all of it."""

    def __init__(
        self,
        place: ui.element,
        number: int,
        meaning: Meaning,
        choices: dict[str, str],
        arm: Any,
        changed: Callable[..., Awaitable[None]],
    ) -> None:
        self._place, self._arm, self._changed = place, arm, changed
        with ui.element("span"):
            ui.label(meaning.header)
            if meaning.formula:
                ui.label(f"= {meaning.made_of}").classes("lw-note")
        self._what = ui.select(choices, value=meaning.what, with_input=True)
        self._what.props(f'dense outlined aria-label="{number + 1} is"')
        self._unit = ui.select([], value=None).props(f'dense outlined aria-label="unit of {number + 1}"')
        self._factor = self._number(f"factor of {number + 1}", "×", meaning.factor)
        self._zero = self._number(f"zero of {number + 1}", "+", meaning.zero)
        self._sign = ui.button("±", on_click=self._turned).props(f'flat dense aria-label="other sign of {number + 1}"')
        self._offer(meaning.what, meaning.unit)
        self._what.on_value_change(self._entered)
        self._unit.on_value_change(self._entered)

    def _number(self, label: str, prefix: str, value: float) -> ui.input:
        field = ui.input(value=f"{value:.12g}").props(f'dense outlined prefix="{prefix}" aria-label="{label}"')
        field.on("blur", self._entered)
        field.on("keydown.enter", self._entered)
        return field

    def _offer(self, what: str, unit: str) -> str:
        """The units that it can be in; gives the one that is chosen."""
        units = units_of(what, self._arm)
        chosen = unit if unit in units else units[0] if units else ""
        self._unit.set_options(list(units), value=chosen or None)
        self._unit.visible = bool(units)
        alone = what in (OTHER, IGNORED)
        for item in (self._factor, self._zero, self._sign):
            item.visible = not alone
        self._place.classes(add="lw-alone" if alone else "", remove="" if alone else "lw-alone")
        return chosen

    async def _turned(self) -> None:
        factor = str(self._factor.value or "").strip()
        self._factor.value = factor.removeprefix("-") if factor.startswith("-") else f"-{factor}"
        await self._entered()

    async def _entered(self) -> None:
        what = str(self._what.value or OTHER)
        unit = self._offer(what, str(self._unit.value or ""))
        numbers: list[float] = []
        for field in (self._factor, self._zero):
            try:
                numbers.append(read_number(float(str(field.value or "").replace(",", ".")), file="", key=""))
                field.error = None
            except (ValueError, InputError):
                field.error = "needs a number"
        if len(numbers) == 2:
            await self._changed(what, unit, *numbers)
