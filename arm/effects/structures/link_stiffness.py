"""A link whose far end moves by a 6 x 6 compliance: a housing or casting, of which finite elements gave the matrix.

Its weight acts as the forces and moments at the far end that move that as the weight does: those of a beam held at
both ends, over whose middle (its centre of mass) the mass is spread as evenly as the link's ends allow. For an even
mass on a uniform beam they are exact (half the weight, and a twelfth of weight times length).
"""

from __future__ import annotations

from collections.abc import Iterator

from linkwright.core.arm.chain.chain import Link
from linkwright.core.arm.chain.statics import PoseState, in_base_frame
from linkwright.core.arm.chain.vectors import ZERO, Scalar, Vector, add, cross, dot, plus, scale, subtract, times
from linkwright.core.arm.effects.effect import Effect, Settings, Twist
from linkwright.core.arm.effects.traits import LinkTraits


def weight_at_end(link: Link) -> tuple[float, float, float]:
    """What the far end carries of a link's weight: the shares of it along the link and across, and the lever (m) of the
    moment there that bends it back."""
    length = link.length
    share = 0.5 if link.center_of_mass is None or length == 0.0 else link.center_of_mass / length
    if share <= 0.0:
        return 0.0, 0.0, 0.0
    if share >= 1.0:
        return 1.0, 1.0, (1.0 - share) * length
    square = share**2 + min(share, 1.0 - share) ** 2 / 3.0
    cube = share**3 + share * min(share, 1.0 - share) ** 2
    return share, 3.0 * square - 2.0 * cube, (square - cube) * length


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    for index, link in enumerate(state.links):
        given = state.arm.links[index]
        if given.compliance is None or not settings.acts_at(index):
            continue
        along_share, across_share, lever = weight_at_end(given)
        weight = scale(link.beam.lumped_mass, state.gravity)
        along = scale(dot(weight, link.along), link.along)
        across = subtract(weight, along)
        force = add(link.force, add(scale(along_share, along), scale(across_share, across)))
        moment = subtract(link.moment, scale(lever, cross(link.along, across)))
        axes = [in_base_frame(state, index, axis) for axis in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))]
        # In the plane nothing acts across it: what rounding leaves there is not physics.
        used = (0, 1, 5) if state.planar else range(6)
        load: list[Scalar] = [*(dot(force, axis) for axis in axes), *(dot(moment, axis) for axis in axes)]
        moved: list[Scalar] = [0.0] * 6
        for row in used:
            for column in used:
                moved[row] = plus(moved[row], times(given.compliance[row][column], load[column]))
        yield Twist("link", index, _sum(axes, moved[:3]), _sum(axes, moved[3:]))


def _sum(axes: list[Vector], parts: list[Scalar]) -> Vector:
    total: Vector = ZERO
    for axis, part in zip(axes, parts, strict=True):
        total = add(total, scale(part, axis))
    return total


LINK_STIFFNESS = Effect(
    id="link_stiffness",
    title="flexibility of links given by a matrix",
    formula="K_i^-1 (F, M) at the far end of link i, with its weight's share there",
    place="link",
    cause="flexibility",
    automatic=True,
    needs="two payloads, and poses that differ in the angles beyond the link",
    aliases=("link_bending", "joint_compliance"),
    source="A. Klimchik, A. Pashkevich & D. Chablat, Fundamentals of manipulator stiffness modeling using matrix "
    "structural analysis, Mech. Mach. Theory 133 (2019) 365, doi:10.1016/j.mechmachtheory.2018.11.023: links by 6 x 6 "
    "matrices; Gere & Goodno, Mechanics of Materials, fixed-end moments",
    twists=_twists,
    rank=95,
    link=LinkTraits(flexible=True),
)
