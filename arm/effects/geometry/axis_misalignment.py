"""A joint's axis stands a little askew and aside of where the file has it: the rest of an arm's geometry in space."""

from __future__ import annotations

from collections.abc import Iterator

from linkwright.core.arm.chain.chain import FloatVector, Joint
from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import Vector, add, cross, is_zero, plus, rotate, scale
from linkwright.core.arm.effects.effect import Effect, Parameter, Settings, Twist, size
from linkwright.core.arm.effects.traits import DriveTraits


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    if state.planar:
        return  # parallel axes stay parallel; shifts within the plane are lengths and offsets
    values = settings.values
    tilts = (values.get("tilt_u", 0.0), values.get("tilt_v", 0.0))
    shifts = (values.get("shift_u", 0.0), values.get("shift_v", 0.0))
    for index in range(1, len(state.joints)):
        if not settings.acts_at(index):
            continue
        u, v = _before(state, index)
        shift = _sum(shifts, u, v)
        turn = _sum(tilts, u, v)
        joint = state.joints[index]
        if not joint.revolute and not state.arm.links[index].runs_out:
            # A guide turns about where it begins, and the carriage stands some way along it.
            shift = add(shift, cross(turn, scale(plus(joint.coordinate, state.arm.joints[index].zero), joint.axis)))
        if not (is_zero(shift) and is_zero(turn)):
            yield Twist("joint", index, shift, turn)


def _sum(sizes: tuple[float, float], u: Vector, v: Vector) -> Vector:
    parts = [scale(size, axis) for size, axis in zip(sizes, (u, v), strict=True)]
    return (parts[0][0] + parts[1][0], parts[0][1] + parts[1][1], parts[0][2] + parts[1][2])


def _before(state: PoseState, index: int) -> tuple[Vector, Vector]:
    """Two directions across the joint's axis that stay with the link before it (the base for the first)."""
    first, second = across_axis(state.arm.joints[index])
    frame = state.frames.joints[index].frame
    return rotate(frame, first), rotate(frame, second)


def across_axis(joint: Joint) -> tuple[FloatVector, FloatVector]:
    """The two directions across a joint's axis, in its frame, along which its tilts and shifts are counted."""
    axis = joint.axis
    hint: FloatVector = (1.0, 0.0, 0.0) if abs(axis[0]) < 0.9 else (0.0, 1.0, 0.0)
    across = _product(axis, hint)
    length = (across[0] ** 2 + across[1] ** 2 + across[2] ** 2) ** 0.5
    first: FloatVector = (across[0] / length, across[1] / length, across[2] / length)
    return first, _product(axis, first)


def _product(a: FloatVector, b: FloatVector) -> FloatVector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _size(name: str, kind: str, meaning: str, bound: float, typical: tuple[float, float]) -> Parameter:
    source = "B. W. Mooring, Z. S. Roth & M. R. Driels, Fundamentals of Manipulator Calibration (Wiley, 1991)"
    return size(name, kind, -bound, bound, typical, across=True).means(meaning, source)


AXIS_MISALIGNMENT = Effect(
    id="axis_misalignment",
    title="misalignment of a joint's axis",
    formula="t + r x (p - o_i), t and r across the axis, fixed to the link before",
    place="joint",
    cause="geometry",
    needs="poses in space that differ in the angles before and after the joint",
    aliases=("encoder_offset", "link_length", "frame_misalignment"),
    source="S. A. Hayati, Robot arm geometric link parameter estimation, 22nd IEEE Conference on Decision and Control "
    "(1983): four parameters for each joint",
    parameters=(
        _size("tilt_u", "angle", "tilt of the axis about a first direction across it", 0.2, (0.1e-3, 5e-3)),
        _size("tilt_v", "angle", "tilt of the axis about the direction across both", 0.2, (0.1e-3, 5e-3)),
        _size("shift_u", "length", "shift of the axis along the first direction", 0.1, (0.05e-3, 2e-3)),
        _size("shift_v", "length", "shift of the axis along the second direction", 0.1, (0.05e-3, 2e-3)),
    ),
    twists=_twists,
    only="joints after the first",
    rank=110,
    linear=True,
    drive=DriveTraits(across=True),
)
