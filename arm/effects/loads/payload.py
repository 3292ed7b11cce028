"""The payload is heavier or lighter than declared, and what bends gives more or less.

A tip shows its mass. The torques of a motion show where its centre stands and how it is spread, too.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from linkwright.core.arm.chain.beam import Beam
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.effects.effect import Effect, Parameter, Settings, Twist, given, size
from linkwright.core.arm.effects.elastic.cantilever import elastic_twists, under_other_loads
from linkwright.core.arm.effects.traits import LinkTraits, WatchTraits

from .inertial import OfInertia, inertial_sizes, of_tip
from .link_mass import mass_declared


def payload_alone(state: PoseState, settings: Settings) -> PoseState | None:
    """The same pose under that mass alone; None where there is none."""
    mass = settings.values.get("mass", 0.0)
    return None if mass == 0.0 else under_other_loads(state, payload_mass=mass, weightless=True)


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    alone = payload_alone(state, settings)
    if alone is not None:
        yield from elastic_twists(alone)


def _declared(arm: Arm, beams: Sequence[Beam], _place: int) -> float:
    """The payload, and the last link with it: what that weighs less than the file says shows at the tip."""
    return arm.payload.mass + mass_declared(arm, beams, arm.size - 1)


def _centre(axis: str) -> Parameter:
    return given(f"centre_{axis}", "length", -10.0, 10.0, (-0.1, 0.2)).means(
        f"of that mass: how far its centre stands from the tip along {axis} of the last link's end; only a motion's "
        "torques show it",
        "tools and workpieces: up to some hundred mm",
    )


PAYLOAD = Effect(
    id="payload",
    title="extra mass at the tip",
    formula="sum over what bends, under the weight m g at the tip; of a motion the torque that moves it",
    place="tip",
    cause="loads",
    needs="known stiffness, or two payloads",
    aliases=("joint_compliance", "link_mass"),
    source="C. G. Atkeson, C. H. An & J. M. Hollerbach, Estimation of inertial parameters of manipulator loads and "
    "links, International Journal of Robotics Research 5 (1986) 101-119",
    parameters=(
        size("mass", "mass", -100.0, 1000.0, (0.1, 3.0)).means(
            "mass at the tip beyond the payload declared",
            "tool changers, targets, cables and fillings missing from the figure declared",
        ),
        *inertial_sizes("of what hangs at the tip, beyond the mass at the centre given", "the tip", mass=False),
        *map(_centre, "xyz"),
    ),
    twists=_twists,
    torques=OfInertia(of_tip),
    link=LinkTraits(through_flexibility=True, declared=_declared),
    watch=WatchTraits(lasts="a recording"),
    rank=50,
    linear=True,
    synonyms=("tip_mass", "tool_mass", "tip_load", "load", "extra_mass"),
)
