"""The report page of a single arm."""

from __future__ import annotations

from arm.evaluation import ErrorMap, Evaluation
from linkwright.report.described import body
from linkwright.report.page import page
from linkwright.report.pictures.sections import sections_grid
from linkwright.results.evaluation import describe
from optimize.robust.result import RobustFigure

from . import design_pictures


def evaluation_page(evaluation: Evaluation, field: ErrorMap, robust: RobustFigure | None = None) -> str:
    """The page as one HTML file that loads nothing."""
    named = (("", evaluation),)
    places, figures = design_pictures.maps(named, (field,))
    pictures = {
        "arms": design_pictures.arms(named),
        "map": places,
        "sections": sections_grid((("", evaluation.arm),)),
    }
    described = describe(evaluation, robust)
    return page(described.title, described.headline, body(described, pictures), figures)
