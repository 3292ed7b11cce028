"""The height of sections over their width."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from linkwright.core.sections.numeric import maximum

from .figure import Figure, OfLinks

if TYPE_CHECKING:
    from linkwright.core.materials.material import MaterialValues
    from linkwright.core.sections import Section


def _aspect(section: Section, material: MaterialValues) -> tuple[Any, ...]:
    """Height over width, both outer; 1 for a round or a regular one."""
    del material
    given = section.given()
    outer = [each.name for each in section.dimensions if each.kind == "outer" and each.name in given]
    if "height" in outer:
        widths = [given[name] for name in outer if name.endswith("width")]
        if len(widths) == 3:  # a flange that has a width of its own does not take the common one
            widths = [given["top_flange_width"], given["bottom_flange_width"]]
        width = widths[0] if len(widths) == 1 else maximum(*widths)
        return (given["height"] / width,)
    if outer:
        return (1.0,)
    # From its corners alone: plain numbers, as nobody optimises them.
    corners = np.vstack(section.outline())
    return (float(np.ptp(corners[:, 1]) / np.ptp(corners[:, 0])),)


ASPECT = Figure(
    name="aspect",
    synonyms=("aspect_ratio", "proportions"),
    title="height over width",
    senses=("<=",),
    key="aspect",
    follows=OfLinks(_aspect),
    note="greatest of any section",
)
