"""Curves by which joints' angles err, drawn over the travel that was recorded."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from linkwright.core.arm.chain.vectors import Scalar
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.result import Diagnosis, Finding

from .svg import element, text
from .svg_plot import Plot, course, spanned

_WIDTH, _HEIGHT, _POINTS = 270.0, 130.0, 400


def joint_curves(diagnosis: Diagnosis) -> str:
    """A small plot for each joint whose angle errs by a curve; nothing where none does."""
    single = [each for each in diagnosis.findings if each.effect in EFFECTS and len(each.at) == 1]
    curves = [(each, EFFECTS[each.effect].curve) for each in single]
    panels = [_panel(diagnosis, each, curve) for each, curve in curves if curve is not None]
    if not panels:
        return ""
    heading = element("h3", text("How joints err over their travel"))
    return heading + element("div", *panels, class_="multiples")


def _panel(diagnosis: Diagnosis, finding: Finding, curve: Callable[[Scalar, Mapping[str, float]], Scalar]) -> str:
    joint = finding.at[0]
    travelled = diagnosis.recording.q[:, joint - 1]
    angle = np.linspace(travelled.min(), travelled.max(), _POINTS)
    values = {fitted.parameter: fitted.value for fitted in finding.parameters}
    error = 1e3 * np.asarray(curve(angle, values), dtype=float)
    across = (float(np.degrees(angle[0])), float(np.degrees(angle[-1])))
    plot = Plot(_WIDTH, _HEIGHT, across, spanned(error))
    about = f"Error of joint {joint} over its travel, within {np.abs(error).max():.2g} mrad."
    drawn = course(plot.x(np.degrees(angle)), plot.y(error), "after")
    return plot.drawn(about, (f"joint {joint} in degrees", "error in mrad"), drawn)
