"""What links of unknown mass weigh, up to one factor that nobody knows: one set of weights that all that gives shares.

How far a drive sags under links that nobody has weighed is the product of its compliance and their weight, and nothing
but the product shows. So the weights are written as multiples of one unknown weight (`mass`, and the first moments
`along`, `height` and `width` of each link about its joint as levers of that weight), and what gives says by its
`unit_sag` how far it turns under that weight on a lever of a metre.
"""

from __future__ import annotations

from dataclasses import replace

from linkwright.core.arm.chain.beam import Beam
from linkwright.core.arm.chain.chain import Arm, EffectEntry, LoadCase
from linkwright.core.arm.chain.statics import PoseState, solve, unladen
from linkwright.core.arm.chain.vectors import ZERO, scale
from linkwright.core.arm.effects.effect import Effect, Parameter, given

MOMENTS = ("along", "height", "width")
"""The parameters that are levers, in the order of a `Beam`'s first moment."""

_STANDARD_GRAVITY = 9.80665
"""m/s^2; the unknown weight is what the unknown mass weighs under it."""


def unit_weights(arm: Arm) -> tuple[EffectEntry, ...]:
    """The entries of an arm that say what its links weigh, as multiples of an unknown weight."""
    return tuple(entry for entry in arm.effects if entry.effect == UNKNOWN_WEIGHT.id)


def without_unit_weights(arm: Arm) -> Arm:
    """The arm without them."""
    return replace(arm, effects=tuple(entry for entry in arm.effects if entry.effect != UNKNOWN_WEIGHT.id))


def under_unit_weights(state: PoseState) -> PoseState | None:
    """The same pose where nothing but the unknown weights acts, moments in m (lever, of the unknown weight); None where
    the arm names none."""
    entries = unit_weights(state.arm)
    if not entries:
        return None
    mass = [0.0] * len(state.links)
    moment = [[0.0, 0.0, 0.0] for _ in state.links]
    for entry in entries:
        for index in [number - 1 for number in entry.at] or range(len(mass)):
            mass[index] += entry.parameters.get("mass", 0.0)
            for place, name in enumerate(MOMENTS):
                moment[index][place] += entry.parameters.get(name, 0.0)
    beams = [
        Beam(length=link.beam.length, lumped_mass=mass[index], first_moment=(first[0], first[1], first[2]))
        for index, (link, first) in enumerate(zip(state.links, moment, strict=True))
    ]
    joints = tuple(replace(joint, mass=0.0, counterbalance=None) for joint in state.arm.joints)
    bare = replace(state.arm, joints=joints).with_links(tuple(replace(link, masses=()) for link in state.arm.links))
    bare = unladen(bare)
    return solve(
        bare,
        [joint.coordinate for joint in state.joints],
        beams,
        LoadCase(),
        gravity=scale(1.0 / _STANDARD_GRAVITY, state.gravity),
        conditions=state.conditions,
        payload_mass=0.0,
        tip_force=ZERO,
        frames=state.frames,
    )


def unit_sag(of: str) -> Parameter:
    """The parameter by which an effect says how far something gives under the unknown weight on a lever of a metre."""
    return given("unit_sag", "angle", -1.0, 1.0, (1e-5, 1e-2)).means(
        f"turn of {of} under the unknown weight of `unknown_weight` on a lever of 1 m: compliance times weight, which "
        "cannot be separated",
        "a stiff drive under a light link to a soft one under a heavy link",
    )


UNKNOWN_WEIGHT = Effect(
    id="unknown_weight",
    title="weights of links, up to one unknown factor",
    formula="mass, along, height and width of link i times one unknown weight; moves the tip through each `unit_sag`",
    place="link",
    cause="loads",
    needs="several postures, and something that gives",
    aliases=("link_mass", "payload"),
    source="C. G. Atkeson, C. H. An & J. M. Hollerbach, Estimation of inertial parameters of manipulator loads and "
    "links, International Journal of Robotics Research 5 (1986) 101-119",
    parameters=(
        given("mass", "dimensionless", -1e3, 1e3, (0.0, 10.0)).means(
            "the link's mass over the unknown one", "links of one arm weigh within a factor of ten"
        ),
        *(
            given(name, "length", -1e3, 1e3, (-1.0, 1.0)).means(
                f"the link's mass times how far its centre lies {where} from its joint, over the unknown mass; "
                "where masses alone do not show, with those of the links carried",
                "lengths of links",
            )
            for name, where in (
                ("along", "along the link"),
                ("height", "along its section's height"),
                ("width", "along its section's width"),
            )
        ),
    ),
    rank=245,
    linear=True,
)
