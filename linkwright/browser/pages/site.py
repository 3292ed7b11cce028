"""The pages by their addresses."""

from __future__ import annotations

from nicegui import ui

from linkwright.browser.server.desk import Desk

from .arm import ArmPage
from .optimise import ProblemPage
from .results import show_one, show_results


def add_pages(desk: Desk) -> None:
    """Add every page of a server. NiceGUI keeps pages for the whole process, so there is one server in each."""

    async def arm() -> None:
        await ArmPage(desk).begin()

    async def optimise() -> None:
        lead = "The best design within a problem's limits. Stop leaves the best so far."
        await ProblemPage(desk, "Optimise", lead).begin()

    def results() -> None:
        show_results(desk)

    def result(number: int) -> None:
        show_one(desk, number)

    for address, page in (("/", arm), ("/optimise", optimise), ("/results", results), ("/results/{number}", result)):
        ui.page(address)(page)
