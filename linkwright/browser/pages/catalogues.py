"""The catalogues: materials, stock sizes and actuators as tables that are edited in place."""

from __future__ import annotations

import asyncio
from collections.abc import Callable

from nicegui import events, ui

from linkwright.browser.server.answers import Desk
from linkwright.browser.server.tables import ActuatorsTable, CatalogueTable, MaterialsTable, SectionsTable
from linkwright.core.units.quantities import InputError

from .frame import Problem, framed, row, stack
from .runs import Runs

_ROW_ID = "(params) => params.data.name"


class CataloguesPage:
    """The page of one visitor: a tab for each catalogue."""

    def __init__(self, desk: Desk) -> None:
        lead = "Click twice on a cell to change it, as the command line would. An empty cell removes the figure."
        with framed("Catalogues", lead):
            Runs(desk.jobs)
            tables = (MaterialsTable(), SectionsTable(), ActuatorsTable())
            with ui.tabs().props("dense align=left no-caps") as tabs:
                made = [ui.tab(table.title) for table in tables]
            self._views: list[TableView] = []
            panels = ui.tab_panels(tabs, value=tables[0].title, animated=False, on_change=self.begin).classes("w-full")
            with panels:
                for tab, table in zip(made, tables, strict=True):
                    with ui.tab_panel(tab).classes("p-0"):
                        self._views.append(TableView(table))
            self._panels = panels

    async def begin(self) -> None:
        """Show the catalogue that is looked at, where it is not there yet."""
        for view in self._views:
            if view.title == self._panels.value and not view.begun:
                await view.show()


class TableView:
    """A catalogue as a grid, and what can be done with its entries."""

    def __init__(self, table: CatalogueTable) -> None:
        self._table = table
        self.title, self.begun = table.title, False
        self._group = ""
        with stack():
            with row():
                self._filter = ui.input("Show only", on_change=self._filtered).props("dense outlined clearable")
                self._filter.classes("grow min-w-40")
                self._groups = ui.select([], label="Shape", on_change=self._regrouped)
                self._groups.props("dense outlined").classes("grow min-w-40").set_visibility(False)
                self._source = ui.input("Source of your figures").props("dense outlined").classes("grow min-w-40")
            self._problem = Problem()
            self._said = ui.label().classes("lw-note").props("role=status")
            self._place = stack()
            with row():
                self._name = ui.select([], label="Entry", with_input=True).props("dense outlined")
                self._name.classes("grow min-w-40")
                self._new = ui.input("New name").props("dense outlined").classes("grow min-w-32")
                ui.button("Copy as", on_click=self._copy).props("outline dense no-caps")
                ui.button("Take out", on_click=self._remove).props("outline dense no-caps")
            self._user_file = ui.label(f"Your own: {table.path}").classes("lw-note")

    async def show(self) -> None:
        """Draw the grid anew, with the columns of its group."""
        self.begun = True
        try:
            groups = await asyncio.to_thread(self._table.groups)
            self._group = self._group or next(iter(groups), "")
            rows = await asyncio.to_thread(self._table.rows, self._group)
        except InputError as error:
            self._problem.say(str(error))
            return
        self._groups.set_options({name: name.replace("_", " ") for name in groups}, value=self._group or None)
        self._groups.set_visibility(bool(groups))
        self._name.set_options([item["name"] for item in rows], value=None)
        there = {key for item in rows for key in item if item[key]}
        columns = [name for name in self._table.columns(self._group) if name in there or name in self._table.always]
        definitions = [
            {"field": "name", "pinned": "left", "width": 165, "sortable": True, "tooltipField": "name"},
            {"field": "own", "width": 75, "sortable": True},
            *({"field": column, "headerName": column.replace("_", " "), "editable": True} for column in columns),
        ]
        if "unconfirmed" in there:
            definitions.append({"field": "unconfirmed", "headerName": "not confirmed", "tooltipField": "unconfirmed"})
        self._place.clear()
        with self._place:
            self._grid = ui.aggrid(
                {
                    "columnDefs": definitions,
                    "rowData": rows,
                    "defaultColDef": {"sortable": True, "resizable": True, "width": 150},
                    ":getRowId": _ROW_ID,
                    "stopEditingWhenCellsLoseFocus": True,
                    "suppressColumnVirtualisation": True,
                },
                auto_size_columns=False,
            ).classes("lw-grid")
            self._grid.on("cellValueChanged", self._edited)

    def _filtered(self) -> None:
        self._grid.run_grid_method("setGridOption", "quickFilterText", self._filter.value or "")

    async def _regrouped(self, event: events.ValueChangeEventArguments[str]) -> None:
        if event.value and event.value != self._group:
            self._group = event.value
            await self.show()

    async def _edited(self, event: events.GenericEventArguments) -> None:
        name, column = str(event.args["data"]["name"]), str(event.args["colId"])
        text = "" if event.args.get("newValue") is None else str(event.args["newValue"])
        source = self._source.value or ""
        await self._done(lambda: self._table.change(name, column, text.strip(), source), name)

    async def _copy(self) -> None:
        name, new = str(self._name.value or ""), str(self._new.value or "")
        await self._done(lambda: self._table.copy(name, new), new.strip())

    async def _remove(self) -> None:
        name = str(self._name.value or "")
        await self._done(lambda: self._table.remove(name))

    async def _done(self, edit: Callable[[], str], name: str = "") -> None:
        """Do an edit, tell of it, and show what there is now: a refused one is as it was."""
        try:
            message = await asyncio.to_thread(edit)
            doubts = await asyncio.to_thread(self._table.doubts, name) if name else []
        except InputError as error:
            message, doubts = "", []
            self._problem.say(str(error))
        else:
            self._problem.say("")
        self._said.text = " ".join([message, *(f"WARNING: {doubt}" for doubt in doubts)]).strip()
        rows = await asyncio.to_thread(self._table.rows, self._group)
        self._name.set_options([item["name"] for item in rows], value=None)
        self._grid.run_grid_method("setGridOption", "rowData", rows)
