"""A link is longer or shorter than the file says."""

from __future__ import annotations

from collections.abc import Iterator

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.statics import PoseState, in_base_frame
from linkwright.core.arm.chain.vectors import add, is_zero, plus, scale, times
from linkwright.core.arm.effects.effect import Effect, Parameter, Settings, Twist, drive_motion, size
from linkwright.core.arm.effects.traits import RecordingTraits


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    length, stretch = settings.values.get("length", 0.0), settings.values.get("stretch", 0.0)
    x, y, z = (settings.values.get(name, 0.0) for name in ("x", "y", "z"))
    offset = (x, y, 0.0 if state.planar else z)
    if is_zero((length, stretch, 0.0)) and is_zero(offset):
        return
    for index, link in enumerate(state.links):
        if settings.acts_at(index):
            longer = scale(plus(length, times(stretch, link.beam.length)), link.along)
            yield Twist("link", index, add(longer, in_base_frame(state, index, offset)))
            joint = state.joints[index]
            if stretch != 0.0 and not joint.revolute and not state.arm.links[index].runs_out:
                yield from drive_motion(state, index, times(stretch, joint.coordinate))


def _given_by(arm: Arm, index: int) -> tuple[str, ...]:
    return arm.links[index].given_by


def _offset(axis: str, row: str = "") -> Parameter:
    label = f"further along {axis} by"
    return size(axis, "length", -0.1, 0.1, (0.1e-3, 1e-3), optional=True, out_of_plane=axis == "z", label=label).means(
        f"of a link askew in its frame: how much further along {axis} it ends than in the file{row}",
        "ISO 2768-1:1989, medium to coarse, at 0.2 to 1 m",
    )


LINK_LENGTH = Effect(
    id="link_length",
    title="true lengths of the links",
    formula="sum u_i (dL_i + e L_i) + x_i, y_i, z_i along the link's frame + e sum a_i q_i of slides",
    place="link",
    cause="geometry",
    needs="poses that differ in all angles",
    aliases=("tool_offset", "instrument_scale", "thermal_expansion"),
    source="B. W. Mooring, Z. S. Roth & M. R. Driels, Fundamentals of Manipulator Calibration (Wiley, 1991)",
    parameters=(
        size("length", "length", -0.1, 0.1, (0.1e-3, 1e-3), optional=True, label="longer by").means(
            "true length less the one in the file", "ISO 2768-1:1989, medium to coarse, at 0.2 to 1 m"
        ),
        _offset("x", " (a of a standard Denavit-Hartenberg row)"),
        _offset("y"),
        _offset("z", " (d of such a row)"),
        size("stretch", "dimensionless", -0.1, 0.1, (2e-5, 1e-3), of_all=True, label="longer in proportion by").means(
            "the same as a share of each link's length and each slide's travel: all in proportion, by one wrong gauge",
            "ISO 2768-1:1989, medium to coarse, over 0.2 to 1 m",
        ),
    ),
    twists=_twists,
    together=True,
    recording=RecordingTraits(sizes_at=_given_by),
    rank=30,
    linear=True,
    synonyms=("length", "dh_parameters", "geometry"),
)
