"""Robust figures as JSON: what an arm errs by where not all of it is known."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from linkwright.core.optimize.robust.result import Robust, RobustFigure

from .fields import fields


def figure_json(found: RobustFigure) -> dict[str, Any]:
    """One arm's robust figure; `upper_mm` is null for the worst, and where the samples are too few for it."""
    return {
        **fields(found, "share", "max_error_mm=value", "nominal_mm", "upper_mm", "looked_at"),
        "rests_on": "sampled",
        "scenario": asdict(found.scenario),
        "uncertain": {name: list(widths) for name, widths in found.widths.items()},
    }


def robust_json(found: Robust) -> dict[str, Any]:
    """A robust optimum beside the nominal one."""
    return {
        **figure_json(found.design),
        "nominal_optimum": figure_json(found.nominal_design),
        **fields(found, "loses_mm", "claimed_mm", "rounds", "samples", "kept_nominal", "doubts"),
        "scenarios": [asdict(each) for each in found.scenarios],
    }
