"""The base gives under the moment that the whole arm puts on it: it tilts, and all tilts with it."""

from __future__ import annotations

from collections.abc import Iterator

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import Vector, add, cross, is_zero, scale, times
from linkwright.core.arm.effects.effect import Effect, Settings, Twist, size
from linkwright.core.arm.effects.loads.unknown_weight import under_unit_weights, unit_sag
from linkwright.core.arm.effects.traits import LinkTraits, WatchTraits


def base_moment(state: PoseState) -> Vector:
    """The moment of all loads about the base's origin, N*m: that on the first joint, and its step from the base."""
    first = state.joints[0]
    force = add(first.force, scale(first.mass, state.gravity))
    return add(first.moment, cross(state.leads[0], force))


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    product = settings.values.get("unit_sag", 0.0)
    weighed = under_unit_weights(state) if product != 0.0 else None
    if weighed is not None:
        # About its z a weight does not turn the base; in the plane there is no other way.
        moment = base_moment(weighed)
        sagged: Vector = (times(product, moment[0]), times(product, moment[1]), 0.0)
        yield Twist("base", 0, rotation=(0.0, 0.0, times(product, moment[2])) if state.planar else sagged)
    compliance = settings.values.get("compliance", 0.0)
    about_z = compliance if state.planar else settings.values.get("compliance_about_z", 0.0)
    if compliance == 0.0 and about_z == 0.0:
        return
    moment = base_moment(state)
    turn: Vector = (times(compliance, moment[0]), times(compliance, moment[1]), times(about_z, moment[2]))
    if not is_zero(turn):
        yield Twist("base", 0, rotation=turn)


BASE_COMPLIANCE = Effect(
    id="base_compliance",
    title="compliance of the base",
    formula="c M_0 x p, M_0 the moment of all loads about the base's origin; in the plane z x p tau_1 / K_0",
    place="base",
    cause="flexibility",
    needs="a target on the base",
    aliases=("joint_compliance",),
    source="A. H. Slocum, Precision Machine Design (Prentice Hall, 1992), structural loop and foundation",
    parameters=(
        size("compliance", "compliance", 0.0, 1e-2, (1e-7, 1e-6)).means(
            "tilt about x and y of the base for one unit of moment (in a planar arm: about z)",
            "anchored pedestals: 1e6 to 1e7 N*m/rad",
        ),
        size("compliance_about_z", "compliance", 0.0, 1e-2, (1e-7, 1e-6)).means(
            "turn about the base's z for one unit of moment (nothing in a planar arm)",
            "anchored pedestals: 1e6 to 1e7 N*m/rad",
        ),
        unit_sag("the base"),
    ),
    enough=(("compliance",), ("compliance_about_z",), ("unit_sag",)),
    twists=_twists,
    watch=WatchTraits(lasts="a while"),
    rank=230,
    linear=True,
    link=LinkTraits(flexible=True),
)
