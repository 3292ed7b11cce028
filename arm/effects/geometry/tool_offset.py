"""The tip sits elsewhere on the last link than the file says."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from linkwright.core.arm.chain.kinematics import section_directions
from linkwright.core.arm.chain.statics import PoseState, in_base_frame
from linkwright.core.arm.chain.vectors import Vector, add, is_zero, scale
from linkwright.core.arm.effects.effect import Effect, Parameter, Settings, Twist, size
from linkwright.core.arm.effects.traits import RecordingTraits, WatchTraits


def last_link_axes(state: PoseState) -> tuple[Vector, Vector, Vector]:
    """Unit vectors along the last link, across it in the plane in which its joint turns it, and out of that plane."""
    ends = [branch.end - 1 for branch in state.arm.branches] or [len(state.links) - 1]
    # Of the last links of several branches those that the tip is not of have no directions.
    along, across, out = _axes(state, ends[0])
    for end in ends[1:]:
        more = _axes(state, end)
        along, across, out = add(along, more[0]), add(across, more[1]), add(out, more[2])
    return along, across, out


def _axes(state: PoseState, index: int) -> tuple[Vector, Vector, Vector]:
    link, joint, last = state.arm.links[index], state.arm.joints[index], state.links[index]
    if link.height_direction is None:
        return last.along, last.height, last.width
    across, out = section_directions(replace(link, height_direction=None), joint)
    return last.along, in_base_frame(state, index, across), in_base_frame(state, index, out)


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    along, across, out = last_link_axes(state)
    moved = add(
        scale(settings.values.get("along", 0.0), along),
        add(
            scale(settings.values.get("across", 0.0), across),
            scale(0.0 if state.planar else settings.values.get("out", 0.0), out),
        ),
    )
    if not is_zero(moved):
        yield Twist("tip", len(state.links) - 1, moved)


def _offset(name: str, direction: str) -> Parameter:
    return size(name, "length", -0.2, 0.2, (0.1e-3, 2e-3), out_of_plane=name == "out").means(
        f"where the tip truly is, {direction}", "tool centre points taught by hand"
    )


TOOL_OFFSET = Effect(
    id="tool_offset",
    title="offset of the tool",
    formula="a u_n + b n_n (+ c u_n x n_n in space)",
    place="tip",
    cause="geometry",
    needs="turns of the wrist",
    aliases=("link_length", "encoder_offset"),
    source="B. W. Mooring, Z. S. Roth & M. R. Driels, Fundamentals of Manipulator Calibration (Wiley, 1991)",
    parameters=(
        _offset("along", "along the last link"),
        _offset("across", "across the last link, in the plane in which its joint turns it"),
        _offset("out", "out of that plane (nothing in a planar arm)"),
    ),
    twists=_twists,
    watch=WatchTraits(lasts="a recording"),
    rank=100,
    linear=True,
    recording=RecordingTraits(free_with="tool"),
    synonyms=("tcp", "tcp_offset", "tool"),
)
