"""Links bend as cantilevers: the displacement of each link's far end against its joint."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from linkwright.core.arm.chain.beam import Beam, BendingFactors
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.statics import LinkState, PoseState
from linkwright.core.arm.chain.vectors import Scalar, Vector, add, cross, dot, minus, plus, scale, subtract, times
from linkwright.core.arm.effects.effect import Effect, Settings, Twist, size
from linkwright.core.arm.effects.loads.unknown_weight import under_unit_weights, unit_sag
from linkwright.core.arm.effects.traits import LinkTraits, RecordingTraits


def in_both_planes(link: LinkState, towards_height: Scalar, towards_width: Scalar) -> tuple[Scalar, Scalar]:
    """Loads towards the section's height and width divided by the rigidities that resist them.

    A section without an axis of symmetry bends askew: with E I_yz between the two planes,
    k_h = (m_h - m_w I_yz/I_z) / (E I_y - E I_yz^2/I_z), and alike for the width. A rigid link gives nothing.
    """
    height, width = link.beam.flexural_rigidity_height, link.beam.flexural_rigidity_width
    coupling = link.beam.flexural_rigidity_coupling
    if height is None or width is None:
        return 0.0, 0.0
    if isinstance(coupling, float) and coupling == 0.0:
        return times(towards_height, 1.0 / height), times(towards_width, 1.0 / width)
    rest = height * width - coupling * coupling
    in_height = minus(times(towards_height, width), times(towards_width, coupling))
    in_width = minus(times(towards_width, height), times(towards_height, coupling))
    return times(in_height, 1.0 / rest), times(in_width, 1.0 / rest)


def end_bent(
    link: LinkState, forces: Callable[[BendingFactors], Vector], by_moment: Callable[[BendingFactors], Scalar]
) -> tuple[Scalar, Scalar]:
    """What bends a cantilever's far end along the section's height and width over what resists it: `forces` times the
    length, and its moment times `by_moment`, each by the factors of a plane."""
    taper = link.beam.taper

    def load(force: Vector, direction: Vector, turning: Vector, factors: BendingFactors) -> Scalar:
        """`turning` is the axis about which a positive moment bends towards `direction`."""
        moment = times(by_moment(factors), dot(link.moment, turning))
        return plus(times(link.beam.length, dot(force, direction)), moment)

    by_height = forces(taper.height)
    by_width = by_height if taper.width is taper.height else forces(taper.width)
    towards_height = load(by_height, link.height, link.width, taper.height)
    towards_width = load(by_width, link.width, scale(-1.0, link.height), taper.width)
    return in_both_planes(link, towards_height, towards_width)


def bent_end(link: LinkState) -> tuple[Scalar, Scalar]:
    """Deflection (m) of a cantilever's far end along the section's height and width: (F L^3/3 + M L^2/2 + w
    L^4/8)/EI."""

    def forces(factors: BendingFactors) -> Vector:
        return add(scale(1.0 / 3.0, link.force), scale(0.125 * factors.weight_deflection, link.weight))

    in_height, in_width = end_bent(link, forces, lambda factors: 0.5 * factors.moment_deflection)
    squared = link.beam.length * link.beam.length
    return times(in_height, squared), times(in_width, squared)


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    product = settings.values.get("unit_sag", 0.0)
    weighed = under_unit_weights(state) if product != 0.0 else None
    for index, link in enumerate(state.links):
        if not settings.acts_at(index):
            continue
        if weighed is not None and not (isinstance(link.beam.length, float) and link.beam.length == 0.0):
            yield _more_flexible(weighed, index, product / link.beam.length)
        if "flexibility" in settings.values:
            yield _more_flexible(state, index, settings.values["flexibility"])
        if "flexibility" in settings.values or "unit_sag" in settings.values:
            continue
        if link.beam.flexural_rigidity_height is None:
            continue
        along_height, along_width = bent_end(link)
        yield Twist("link", index, add(scale(along_height, link.height), scale(along_width, link.width)))


def _more_flexible(state: PoseState, index: int, flexibility: Scalar) -> Twist:
    """Deflection and end slope of a link that bends alike in all planes, by a flexibility 1/EI beyond the model's.

    The mass of a link of unknown section lies along it with a density that is linear and has its centre of mass: with
    k = 3 (2 a/L - 1), a weight P bends the end by P L^3 (1/8 + 7 k/120) and turns it by P L^2 (1/6 + k/12).
    """
    link = state.links[index]
    length = link.beam.length
    square, mass = times(length, length), link.beam.lumped_mass
    # The mass times k and the length: linear in the link's first moment, whatever that is.
    leaning = minus(
        times(6.0, plus(times(mass, link.beam.lumped_at), link.beam.first_moment[0])), times(3.0 * mass, length)
    )
    heavy = _across(link, scale(times(mass, square), state.gravity))
    leaned = _across(link, scale(times(leaning, length), state.gravity))
    across = _across(link, add(scale(1.0 / 3.0, link.force), scale(0.125, link.weight)))
    turning = _across(link, add(scale(0.5, link.force), scale(1.0 / 6.0, link.weight)))
    moment = _across(link, link.moment)
    # A moment m bends the far end towards m x u, u along the link.
    shift = add(scale(times(length, times(length, length)), across), scale(times(0.5, times(length, length)),
                cross(moment, link.along)))  # fmt: skip
    turn = add(scale(times(length, length), cross(link.along, turning)), scale(length, moment))
    shift = add(shift, scale(length, add(scale(0.125, heavy), scale(7.0 / 120.0, leaned))))
    turn = add(turn, cross(link.along, add(scale(1.0 / 6.0, heavy), scale(1.0 / 12.0, leaned))))
    return Twist("link", index, scale(flexibility, shift), scale(flexibility, turn))


def _across(link: LinkState, vector: Vector) -> Vector:
    return subtract(vector, scale(dot(link.along, vector), link.along))


def _declared(_arm: Arm, beams: Sequence[Beam], link: int) -> float:
    """The link's 1/EI, of its softer direction."""
    beam = beams[link]
    rigidities = (beam.flexural_rigidity_height, beam.flexural_rigidity_width)
    return max((1.0 / float(rigidity) for rigidity in rigidities if rigidity is not None), default=0.0)


LINK_BENDING = Effect(
    id="link_bending",
    title="bending of the links",
    formula="n_i (F L^3/3 + M L^2/2 + w L^4/8)/EI",
    place="link",
    cause="flexibility",
    automatic=True,
    needs="two slopes of the link, or two payloads",
    aliases=("joint_compliance",),
    source="Gere & Goodno, Mechanics of Materials, deflections of cantilever beams; Roark's Formulas, beam tables",
    parameters=(
        size("flexibility", "flexibility", -1e-2, 1e-2, (1e-7, 1e-4)).means(
            "1/EI of the link beyond what the arm file gives it, its end's slope included",
            "the reciprocal of EI from 1e4 to 1e7 N*m^2, links of industrial robots",
        ),
        unit_sag("the link's far end"),
    ),
    twists=_twists,
    rank=90,
    linear=True,
    link=LinkTraits(flexible=True, in_modes=True, along=True, declared=_declared),
    recording=RecordingTraits(under_forces=True, weights_named=True),
    synonyms=("bending", "sag", "deflection"),
)
