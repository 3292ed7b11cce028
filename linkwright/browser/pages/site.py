"""The pages by their addresses."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from nicegui import ui

from linkwright.browser.pages.edited import ArmPage, ProblemPage, TradeoffPage
from linkwright.browser.pages.results import ResultPage, ResultsPage
from linkwright.browser.server.answers import Desk

from .asking import Asking
from .catalogues import CataloguesPage
from .diagnosis import DiagnosisPage


class _Page(Protocol):
    async def begin(self) -> None: ...


def _add(address: str, made: Callable[[], _Page]) -> None:
    """A page as it is at once, and what takes a moment once the browser has it."""

    async def shown() -> None:
        page = made()
        await ui.context.client.connected()
        await page.begin()

    ui.page(address)(shown)


def _add_asking(address: str, made: Callable[[], Asking]) -> None:
    """A page that asks; `?result=NUMBER` opens what a kept result is of."""

    async def shown(result: int | None = None) -> None:
        page = made()
        await ui.context.client.connected()
        await page.begin(result)

    ui.page(address)(shown)


def add_pages(desk: Desk) -> None:
    """Add every page of a server. NiceGUI keeps pages for the whole process, so there is one server in each."""
    lead = "The best design within a problem's limits. Stop leaves the best so far."
    _add_asking("/", lambda: ArmPage(desk))
    _add_asking("/optimise", lambda: ProblemPage(desk, "optimize", "Optimise", lead))
    _add_asking("/tradeoff", lambda: TradeoffPage(desk))
    _add_asking("/diagnosis", lambda: DiagnosisPage(desk))
    _add("/catalogues", lambda: CataloguesPage(desk))
    _add("/results", lambda: ResultsPage(desk))

    async def result(number: int) -> None:
        page = ResultPage(desk, number)
        await ui.context.client.connected()
        await page.begin()

    ui.page("/results/{number}")(result)
