"""The report of an optimisation: before and after, what binds, and how the design was found."""

from __future__ import annotations

from linkwright.core.optimize.result import OptimizationResult
from linkwright.report.contents import Contents
from linkwright.report.page import figure_place
from linkwright.report.pictures.loads import loads_picture
from linkwright.report.pictures.plots import exchange_figure
from linkwright.report.pictures.sections import sections_grid
from linkwright.report.pictures.side_view import side_view
from linkwright.report.pictures.svg import text
from linkwright.results.optimization import describe, effort_words

from . import design_pictures

_EXCHANGE = "The exchange ends where no pose is worse than those it has already designed for."


def optimization_report(result: OptimizationResult) -> Contents:
    """What the report shows."""
    named = (("before", result.before), ("after", result.after))
    places, figures = design_pictures.maps(named, (result.before_map, result.after_map))
    pictures = {
        "arms": design_pictures.arms(named),
        "side": side_view(result.after.arm, result.after.load_cases),
        "loads": loads_picture(result.after),
        "map": places,
        "sections": sections_grid((("before", result.before.arm), ("after", result.after.arm))),
    }
    if len(result.iterations) > 1:
        figures = {**figures, "exchange": exchange_figure(result.iterations, result.minimize)}
        words = f"Objective over the iterations: {effort_words(result)}."
        pictures["exchange"] = figure_place("exchange", words, text(_EXCHANGE))
    if result.rounded is not None:
        pictures["rounded"] = sections_grid((("before", result.arm), ("after", result.rounded.arm)))
    return Contents(describe(result), pictures, figures)
