"""A mast or boom bends: its bending length is the coordinate of the slide that travels along it."""

from __future__ import annotations

from collections.abc import Iterator

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import Scalar, add, cross, dot, is_zero, scale, subtract, times
from linkwright.core.arm.effects.effect import Effect, Settings, Twist, given, size
from linkwright.core.arm.effects.loads.unknown_weight import under_unit_weights, unit_sag
from linkwright.core.arm.effects.traits import DriveTraits, LinkTraits, RecordingTraits
from linkwright.core.sections.numeric import absolute


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    """What bends is a cantilever between the slide's zero (or `length_at_zero` before it) and its carriage."""
    product = settings.values.get("unit_sag", 0.0)
    weighed = under_unit_weights(state) if product != 0.0 else None
    if weighed is not None:
        yield from _bent(weighed, settings, product)
    yield from _bent(state, settings, settings.values.get("flexibility", 0.0))


def _bent(state: PoseState, settings: Settings, flexibility: Scalar) -> Iterator[Twist]:
    if isinstance(flexibility, float) and flexibility == 0.0:
        return
    before = settings.values.get("length_at_zero", 0.0)
    for index, joint in enumerate(state.joints):
        if joint.revolute or not settings.acts_at(index) or state.arm.links[index].runs_out:
            continue  # what runs out of its slide bends as the link that it is
        # A coordinate that runs towards the clamped end is as long a cantilever.
        length, along = absolute(joint.coordinate + before), joint.axis
        square = times(length, length)
        load = add(joint.force, scale(joint.mass, state.gravity))
        force = subtract(load, scale(dot(along, load), along))
        moment = subtract(joint.moment, scale(dot(along, joint.moment), along))
        if is_zero(force) and is_zero(moment):
            continue
        shift = add(scale(times(square, length) / 3.0, force), scale(0.5 * square, cross(moment, along)))
        turn = add(scale(0.5 * square, cross(along, force)), scale(length, moment))
        yield Twist("joint", index, scale(flexibility, shift), scale(flexibility, turn))


COLUMN_BENDING = Effect(
    id="column_bending",
    title="bending of a mast or boom along which a slide travels",
    formula="(F h^3/3 + M h^2/2)/EI across the slide, slope (F h^2/2 + M h)/EI carried on, h its coordinate",
    place="joint",
    cause="flexibility",
    needs="several places along the slide, two loads",
    aliases=("base_compliance", "rail_pitch", "link_bending"),
    source="Gere & Goodno, Mechanics of Materials, cantilever beams under an end force and an end moment",
    parameters=(
        size("flexibility", "flexibility", 0.0, 1e-2, (1e-8, 1e-4)).means(
            "1/EI of the mast or boom", "the reciprocal of EI from 1e4 to 1e8 N*m^2, profiles and masts of gantries"
        ),
        given("length_at_zero", "length", -10.0, 10.0, (0.0, 1.0)).means(
            "bending length where the slide stands at zero (nothing, if not given)",
            "clamping distances of linear axes",
        ),
        unit_sag("a metre of the mast or boom"),
    ),
    twists=_twists,
    enough=(("flexibility",), ("unit_sag",)),
    only="joints that slide",
    rank=225,
    linear=True,
    drive=DriveTraits(across=True),
    link=LinkTraits(flexible=True),
    recording=RecordingTraits(under_forces=True),
)
