"""The report of a single arm."""

from __future__ import annotations

from linkwright.core.arm.evaluation import ErrorMap, Evaluation
from linkwright.core.optimize.robust.result import RobustFigure
from linkwright.report.contents import Contents
from linkwright.report.pictures.loads import loads_picture
from linkwright.report.pictures.sections import sections_grid
from linkwright.report.pictures.side_view import side_view
from linkwright.results.evaluation import describe

from . import design_pictures


def evaluation_report(evaluation: Evaluation, field: ErrorMap, robust: RobustFigure | None = None) -> Contents:
    """What the report shows."""
    named = (("", evaluation),)
    places, figures = design_pictures.maps(named, (field,))
    pictures = {
        "arms": design_pictures.arms(named),
        "side": side_view(evaluation.arm, evaluation.load_cases),
        "loads": loads_picture(evaluation),
        "map": places,
        "sections": sections_grid((("", evaluation.arm),)),
    }
    return Contents(describe(evaluation, robust), pictures, figures)
