"""A link is heavier than the file says (cables, hoses, covers, a valve block), and what bends gives more.

Of a lump somewhere on a link the drives below tell the first moment about the link's joint, mass times place; the mass
by itself shows only in what carries that joint. So a lump may be given by its first moment alone, and counts as spread
along the link then; by mass and first moment it acts where it hangs, but bends its link as if it were spread.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from linkwright.core.arm.chain.beam import Beam
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import Scalar, minus, plus, times
from linkwright.core.arm.effects.effect import Effect, Settings, Twist, given, size
from linkwright.core.arm.effects.elastic.cantilever import elastic_twists, under_other_loads
from linkwright.core.arm.effects.traits import LinkTraits, RecordingTraits, Sum


def link_masses_alone(state: PoseState, settings: Settings) -> PoseState | None:
    """The same pose under those masses alone; None where there are none."""
    added = [
        _added(link.beam, settings.values) if settings.acts_at(index) else (0.0, 0.0)
        for index, link in enumerate(state.links)
    ]
    masses, moments = tuple(mass for mass, _ in added), tuple(moment for _, moment in added)
    if all(isinstance(value, float) and value == 0.0 for value in (*masses, *moments)):
        return None
    return under_other_loads(state, link_masses=masses, link_moments=moments, weightless=True)


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    alone = link_masses_alone(state, settings)
    if alone is not None:
        yield from elastic_twists(alone)


def _added(beam: Beam, values: Mapping[str, float]) -> tuple[Scalar, Scalar]:
    """The mass (kg) that is spread along a link, and the first moment (kg*m) beyond that of such a mass."""
    middle, off_centre = _middle(beam), values.get("off_centre", 0.0)
    if "first_moment" not in values:
        return values.get("mass", 0.0), off_centre
    moment = plus(values["first_moment"], off_centre)
    if "mass" in values:
        return values["mass"], minus(moment, times(values["mass"], middle))
    return (0.0, moment) if isinstance(middle, float) and middle == 0.0 else (moment / middle, 0.0)


def _middle(beam: Beam) -> Scalar:
    """How far from its joint (m) the centre lies of a mass that is spread along a link."""
    return times(beam.taper.balance, beam.length)


def _factors(beams: Sequence[Beam], link: int) -> Mapping[str, float] | None:
    middle = _middle(beams[link])
    # Of a boom that runs out the middle goes with it.
    return {"mass": float(middle), "off_centre": 1.0} if np.ndim(middle) == 0 and float(middle) > 0.0 else None


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
    enough=(("mass",), ("first_moment",), ("off_centre",)),
    parameters=(
        size("mass", "mass", -100.0, 1000.0, (0.2, 5.0)).means(
            "mass beyond that of the file, spread along the link as its own is (for each link named)",
            "hose and cable packages: 0.5 to 5 kg a metre",
        ),
        size("off_centre", "first_moment", -100.0, 100.0, (0.02, 1.0), optional=True).means(
            "mass times how far its centre lies along the link beyond the middle of one that is spread",
            "a few kg, some hundred mm from the middle",
        ),
        given("first_moment", "first_moment", -1000.0, 1000.0, (0.02, 5.0)).means(
            "first moment about the link's joint: mass times how far its centre lies along the link; without `mass`, "
            "of a mass spread along the link",
            "a few kg, some hundred mm from the joint",
        ),
    ),
    twists=_twists,
    link=LinkTraits(through_flexibility=True, declared=mass_declared),
    rank=250,
    linear=True,
    recording=RecordingTraits(told_as=Sum("first_moment", _factors, beside="mass")),
    synonyms=("link_weight", "link_load"),
)
