"""A link is longer or shorter than the file says."""

from __future__ import annotations

from collections.abc import Iterator

from ..statics import PoseState
from ..vectors import scale
from .effect import Effect, Parameter, Settings, Twist


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    length = settings.values.get("length", 0.0)
    for index, link in enumerate(state.links):
        if length != 0.0 and settings.acts_at(index):
            yield Twist("link", index, scale(length, link.along))


LINK_LENGTH = Effect(
    id="link_length",
    title="true lengths of the links",
    formula="sum u_i dL_i",
    place="link",
    cause="geometry",
    automatic=False,
    needs="poses that differ in all angles",
    aliases=("tool_offset", "instrument_scale", "thermal_expansion"),
    source="B. W. Mooring, Z. S. Roth & M. R. Driels, Fundamentals of Manipulator Calibration (Wiley, 1991)",
    parameters=(
        Parameter(
            "length",
            "length",
            "true length less the one in the file",
            -0.1,
            0.1,
            (0.1e-3, 1e-3),
            "ISO 2768-1:1989, medium to coarse, at 0.2 to 1 m",
            role="size",
        ),
    ),
    twists=_twists,
)
