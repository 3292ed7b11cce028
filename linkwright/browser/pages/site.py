"""The pages by their addresses."""

from __future__ import annotations

from typing import Protocol

from nicegui import ui

from linkwright.browser.server.desk import Desk

from .arm import ArmPage
from .catalogues import CataloguesPage
from .diagnosis import DiagnosisPage
from .optimise import ProblemPage
from .results import ResultPage, ResultsPage
from .tradeoff import TradeoffPage


class _Page(Protocol):
    async def begin(self) -> None: ...


async def _begun(page: _Page) -> None:
    """Show the page as it is at once, and what takes a moment once the browser has it."""
    await ui.context.client.connected()
    await page.begin()


def add_pages(desk: Desk) -> None:
    """Add every page of a server. NiceGUI keeps pages for the whole process, so there is one server in each."""

    async def arm() -> None:
        await _begun(ArmPage(desk))

    async def optimise() -> None:
        lead = "The best design within a problem's limits. Stop leaves the best so far."
        await _begun(ProblemPage(desk, "Optimise", lead))

    async def tradeoff() -> None:
        await _begun(TradeoffPage(desk))

    async def diagnosis() -> None:
        await _begun(DiagnosisPage(desk))

    async def catalogues() -> None:
        await _begun(CataloguesPage())

    async def results() -> None:
        await _begun(ResultsPage(desk))

    async def result(number: int) -> None:
        await _begun(ResultPage(desk, number))

    pages = {
        "/": arm,
        "/optimise": optimise,
        "/tradeoff": tradeoff,
        "/diagnosis": diagnosis,
        "/catalogues": catalogues,
        "/results": results,
        "/results/{number}": result,
    }
    for address, page in pages.items():
        ui.page(address)(page)
