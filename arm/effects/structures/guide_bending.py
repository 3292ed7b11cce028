"""The beam along which a slide's carriage runs, held at both ends, bends and twists under the carriage.

It is in the model wherever a slide has a `beam`. With a and b from the carriage to the supports, EI and GA of the beam:

    simple supports: deflection F a^2 b^2/(3 EI L) + F a b/(GA L), slope F a b (b - a)/(3 EI L)
    clamped ends: the ends of two cantilevers, as long as a and b, that share the load

and by Maxwell the deflection under a moment is the slope under a force. Twist T a b/(GJ L), held at both ends; two
rails share the load. The beam's weight: w a (L^3 - 2 L a^2 + a^3)/(24 EI), or w a^2 b^2/(24 EI), and w a b/(2 GA).
"""

from __future__ import annotations

from collections.abc import Iterator

from linkwright.core.arm.chain.beam import Beam, elastic_beam
from linkwright.core.arm.chain.chain import GuideBeam
from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import (
    Scalar,
    Vector,
    add,
    cross,
    dot,
    minus,
    plus,
    rotate,
    scale,
    times,
)
from linkwright.core.arm.effects.effect import Effect, Settings, Twist
from linkwright.core.arm.effects.traits import LinkTraits

Give = tuple[Scalar, Scalar, Scalar]
"""At the carriage: deflection (m/N) and slope (rad/N) under a force, and slope (rad/(N*m)) under a moment."""


def beam_of_guide(guide: GuideBeam, temperature: float) -> Beam:
    """One rail as a beam. Raises `MissingProperty` for what its material lacks."""
    material = guide.material.at(temperature)
    ratio = 0.3 if material.poisson_ratio is None else material.poisson_ratio
    return elastic_beam(guide.length, guide.section.properties(ratio), material)


def give(a: Scalar, b: Scalar, flexural: float, shear: float, *, clamped: bool) -> Give:
    """What one rail gives at a carriage `a` and `b` (m) from its supports; rigidities in N*m^2 and N."""
    length = plus(a, b)
    if not clamped:
        product, ends = times(a, b), times(3.0 * flexural, length)
        deflection = plus(times(product, product) / ends, product / times(shear, length))
        turn = plus(minus(times(length, length), times(3.0, product)) / ends, 1.0 / times(shear, length))
        return deflection, times(product, minus(b, a)) / ends, turn
    soft = flexural / shear
    near, far = (plus(times(x, times(x, x)) / 12.0, times(soft, x)) for x in (a, b))
    # The stiffness of both sides, times near and far and over the flexural rigidity.
    across = plus(near, far)
    mixed = times(0.5, minus(times(b, near), times(a, far)))
    about = plus(
        times(plus(times(a, a) / 3.0, soft), far),
        times(plus(times(b, b) / 3.0, soft), near),
    )
    share = times(near, far) / times(flexural, minus(times(across, about), times(mixed, mixed)))
    return times(share, about), times(-1.0, times(share, mixed)), times(share, across)


def sag(a: Scalar, b: Scalar, flexural: float, shear: float, *, clamped: bool) -> tuple[Scalar, Scalar]:
    """Deflection (m) and slope (rad) there for a unit of the rail's weight per length (N/m)."""
    length, product = plus(a, b), times(a, b)
    sheared = product / (2.0 * shear)
    if clamped:
        deflection = times(product, product) / (24.0 * flexural)
        return plus(deflection, sheared), times(product, minus(b, a)) / (12.0 * flexural)
    square = times(length, length)
    deflection = times(product, plus(square, product)) / (24.0 * flexural)
    slope = times(minus(b, a), plus(square, times(2.0, product))) / (24.0 * flexural)
    return plus(deflection, sheared), slope


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    for index, joint in enumerate(state.joints):
        guide = state.arm.joints[index].guide
        if guide is None or not settings.acts_at(index):
            continue
        rail = beam_of_guide(guide, state.arm.temperature)
        a = minus(joint.coordinate, guide.begins_at)
        b = minus(guide.length, a)
        load, weight = add(joint.force, scale(joint.mass, state.gravity)), scale(rail.mass_per_length, state.gravity)
        shift: Vector = (0.0, 0.0, 0.0)
        turn: Vector = (0.0, 0.0, 0.0)
        height = rotate(state.frames.joints[index].before.matrix(), guide.height_direction)
        width = cross(joint.axis, height)
        planes = (
            (height, rail.flexural_rigidity_height, rail.shear_rigidity_height),
            (width, rail.flexural_rigidity_width, rail.shear_rigidity_width),
        )
        for direction, flexural, shear in planes[: 1 if state.planar else 2]:
            assert flexural is not None
            assert shear is not None
            about = cross(joint.axis, direction)
            clamped = guide.supports == "clamped"
            by_force, mixed, by_moment = give(a, b, flexural, shear, clamped=clamped)
            sagged, sloped = sag(a, b, flexural, shear, clamped=clamped)
            force, moment = (
                times(1.0 / guide.rails, dot(*pair)) for pair in ((load, direction), (joint.moment, about))
            )
            weight_across = dot(weight, direction)
            moved = plus(plus(times(by_force, force), times(mixed, moment)), times(sagged, weight_across))
            turned = plus(plus(times(mixed, force), times(by_moment, moment)), times(sloped, weight_across))
            shift, turn = add(shift, scale(moved, direction)), add(turn, scale(turned, about))
        if not state.planar:
            assert rail.torsional_rigidity is not None
            twisting = times(a, b) / (guide.rails * guide.length * rail.torsional_rigidity)
            turn = add(turn, scale(times(twisting, dot(joint.moment, joint.axis)), joint.axis))
        yield Twist("joint", index, shift, turn)


GUIDE_BENDING = Effect(
    id="guide_bending",
    title="bending of the beams along which slides run",
    formula="across the slide F a^2 b^2/(3 EI L) + M a b (b - a)/(3 EI L), a and b to the supports; slope and twist "
    "T a b/(GJ L)",
    place="joint",
    cause="flexibility",
    automatic=True,
    needs="several places along the slide, two loads",
    aliases=("column_bending", "rail_pitch", "base_compliance"),
    source="Roark's Formulas for Stress and Strain, beams on two supports, table 8.1 (1e, 1d, 3e, 3d); S. P. "
    "Timoshenko, Strength of Materials: shear",
    twists=_twists,
    only="joints that slide",
    rank=226,
    link=LinkTraits(flexible=True),
)
