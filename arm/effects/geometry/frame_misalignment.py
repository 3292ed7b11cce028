"""The arm's base does not stand where the measuring frame has it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import Scalar, Vector, is_zero, scale
from linkwright.core.arm.effects.effect import Effect, Parameter, Settings, Twist, size
from linkwright.core.arm.effects.traits import RecordingTraits, WatchTraits


def moved_base(state: PoseState, values: Mapping[str, float], factor: Scalar = 1.0) -> Iterator[Twist]:
    """The base shifted by `x`, `y`, `z` and turned by `about_x`, `about_y`, `about_z`, times a factor; in the plane
    what leaves it counts nothing."""
    flat = state.planar
    shift: Vector = (values.get("x", 0.0), values.get("y", 0.0), 0.0 if flat else values.get("z", 0.0))
    about_x, about_y = (0.0, 0.0) if flat else (values.get("about_x", 0.0), values.get("about_y", 0.0))
    turn: Vector = (about_x, about_y, values.get("about_z", 0.0))
    if not (is_zero(shift) and is_zero(turn)):
        yield Twist("base", 0, scale(factor, shift), scale(factor, turn))


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    yield from moved_base(state, settings.values)


def _shift(name: str) -> Parameter:
    return size(name, "length", -1.0, 1.0, (10e-6, 5e-3), out_of_plane=name == "z", optional=True).means(
        f"shift of the base along {name}", "fits of a measuring frame to a base by hand"
    )


def _turn(axis: str) -> Parameter:
    return size(f"about_{axis}", "angle", -0.2, 0.2, (0.1e-3, 1e-3), out_of_plane=axis != "z", optional=True).means(
        f"turn of the base about {axis}", "fits of a measuring frame to a base by hand"
    )


FRAME_MISALIGNMENT = Effect(
    id="frame_misalignment",
    title="misalignment of the measuring frame",
    formula="t + r x p; in the plane t + r z x p",
    place="base",
    cause="measurement",
    needs="nothing more than poses",
    aliases=("encoder_offset", "clearance"),
    source="B. W. Mooring, Z. S. Roth & M. R. Driels, Fundamentals of Manipulator Calibration (Wiley, 1991)",
    parameters=(_shift("x"), _shift("y"), _shift("z"), _turn("x"), _turn("y"), _turn("z")),
    twists=_twists,
    watch=WatchTraits(lasts="a recording"),
    rank=170,
    linear=True,
    recording=RecordingTraits(of_instrument=True, free_with="frame"),
    synonyms=("base_frame", "base_offset", "frame"),
)
