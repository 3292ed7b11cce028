"""The base does not stand plumb: gravity comes from another side, and what bends gives another way.

Masses added by the arm's other effects are pulled at from that side too. The measuring frame is taken to stand with the
base; where it does not, its turn is a `frame_misalignment`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import ZERO, Vector, cross, is_zero
from linkwright.core.arm.effects.effect import Effect, Parameter, Settings, Twist, size
from linkwright.core.arm.effects.elastic.cantilever import elastic_twists, under_other_loads
from linkwright.core.arm.effects.traits import LinkTraits, RecordingTraits, WatchTraits
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.arm.motion.rigid import gravity_torque
from linkwright.core.sections.numeric import Array

from .added_weights import under_weight_alone, weights_added


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    change = _change(state.arm.gravity, settings, planar=state.planar)
    if is_zero(change):
        return
    yield from elastic_twists(under_other_loads(state, gravity=change, tip_force=ZERO, tip_moment=(0.0, 0.0, 0.0)))
    for entry in weights_added(state.arm.effects):
        alone = under_weight_alone(replace(state, gravity=change), entry)
        if alone is not None:
            yield from elastic_twists(alone)


def _change(gravity: Vector, settings: Settings, *, planar: bool) -> Vector:
    """A base that is turned sees gravity turned back; in the plane only what stays there counts."""
    about_x, about_y, about_z = _turned(settings)
    return cross(gravity, (0.0, 0.0, about_z) if planar else (about_x, about_y, about_z))


def _torques(motion: Motion, settings: Settings) -> Mapping[int, Array]:
    arm = motion.arm
    change = _change(arm.gravity, settings, planar=arm.planar())
    if is_zero(change):
        return {}
    return dict(enumerate(gravity_torque(arm, motion.of_links.q, change, motion.payload_mass).T))


def _turned(settings: Settings) -> Vector:
    values = settings.values
    return (values.get("about_x", 0.0), values.get("about_y", 0.0), values.get("about_z", 0.0))


def _turn(axis: str) -> Parameter:
    return size(f"about_{axis}", "angle", -0.15, 0.15, (0.1e-3, 30e-3)).means(
        f"turn of the base about {axis} against the plumb line" + ("" if axis == "z" else " (nothing in a planar arm)"),
        "machines levelled by a spirit level: 0.1 mrad; carts and gantries: tens of mrad",
    )


BASE_TILT = Effect(
    id="base_tilt",
    title="tilt of the base against gravity",
    formula="sum over what bends, under the change of gravity g x tilt; of a motion the torque that holds it",
    place="base",
    cause="loads",
    needs="an inclinometer, or known stiffness",
    aliases=("joint_compliance", "frame_misalignment"),
    source="B. Siciliano, L. Sciavicco, L. Villani & G. Oriolo, Robotics: Modelling, Planning and Control "
    "(Springer, 2009), gravity in the base frame, doi:10.1007/978-1-84628-642-1",
    parameters=(_turn("x"), _turn("y"), _turn("z")),
    twists=_twists,
    torques=_torques,
    recording=RecordingTraits(against_plumb=_turned),
    link=LinkTraits(through_flexibility=True),
    watch=WatchTraits(lasts="a while"),
    rank=240,
    linear=True,
)
