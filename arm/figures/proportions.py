"""The proportions of sections, and the room for cables through them."""

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
    dimensions = section.given()
    outer = [
        dimension.name for dimension in section.dimensions if dimension.kind == "outer" and dimension.name in dimensions
    ]
    if "height" in outer:
        widths = [dimensions[name] for name in outer if name.endswith("width")]
        if len(widths) == 3:  # a flange that has a width of its own does not take the common one
            widths = [dimensions["top_flange_width"], dimensions["bottom_flange_width"]]
        width = widths[0] if len(widths) == 1 else maximum(*widths)
        return (dimensions["height"] / width,)
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
    by=("link",),
)


def _inner(section: Section, material: MaterialValues) -> tuple[Any, ...] | None:
    """The widths of the section's closed hollow, the least of which the thickest round cable has that fits through it;
    0 where it has none."""
    del material
    return section.inner_widths


def _unknown(section: Section, material: MaterialValues) -> str:
    del material
    return f"what fits through link {{link}} ({section.shape}) is not known"


INNER_SIZE = Figure(
    name="inner_size",
    synonyms=("inner_diameter", "bore", "cable_diameter", "inner_width", "hollow"),
    title="inner size",
    kind="length",
    unit="mm",
    factor=1e3,
    senses=(">=",),
    key="inner_size_mm",
    follows=OfLinks(_inner, _unknown),
    more_is_better=True,
    note="least free inner diameter of any link",
    # Where a link is solid it is zero, which no axis can show.
    traded=False,
    everywhere=False,
    by=("link",),
)
