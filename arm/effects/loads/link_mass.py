"""A link is heavier than the file says (cables, hoses, covers), and what bends gives more."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from arm.chain.beam import Beam
from arm.chain.chain import Arm
from arm.chain.statics import PoseState
from arm.chain.vectors import plus
from arm.effects.effect import Effect, Settings, Twist, size
from arm.effects.elastic.cantilever import elastic_twists, under_other_loads


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    mass = settings.values.get("mass", 0.0)
    if mass != 0.0:
        extra = tuple(mass if settings.acts_at(index) else 0.0 for index in range(len(state.links)))
        yield from elastic_twists(under_other_loads(state, link_masses=extra, weightless=True))


def mass_declared(arm: Arm, beams: Sequence[Beam], link: int) -> float:
    """What an arm file says that a link (from 0) weighs, kg; infinite where it leaves that open."""
    unknown = arm.links[link].mass is None and not arm.links[link].elastic
    # Of a boom the same at every pose: what has run out, and what has not.
    return math.inf if unknown else float(np.max(plus(beams[link].mass, beams[link].housed)))


LINK_MASS = Effect(
    id="link_mass",
    title="extra mass along the links",
    formula="sum over what bends, under the weight m_i g spread along link i",
    place="link",
    cause="loads",
    needs="known stiffness",
    aliases=("payload", "joint_compliance"),
    source="C. G. Atkeson, C. H. An & J. M. Hollerbach, Estimation of inertial parameters of manipulator loads and "
    "links, International Journal of Robotics Research 5 (1986) 101-119",
    parameters=(
        size("mass", "mass", -100.0, 1000.0, (0.2, 5.0)).means(
            "mass beyond that of the file, spread along the link as its own is (for each link named)",
            "hose and cable packages: 0.5 to 5 kg a metre",
        ),
    ),
    twists=_twists,
    through_flexibility=True,
    rank=250,
    linear=True,
    declared=mass_declared,
)
