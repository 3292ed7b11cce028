"""The contract of effects: every shipped one keeps it, and each way of breaking it is told."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.effects import EFFECTS, Disc, Effect, Interval, Parameter, Settings, Twist
from linkwright.core.arm.effects.contract import check
from linkwright.core.arm.effects.effect import drive_motion
from linkwright.core.arm.effects.torques import OfEachDrive
from linkwright.core.arm.effects.traits import LinkTraits, PlayTraits, RecordingTraits
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError

OFFSET = EFFECTS["encoder_offset"]
SIZE = OFFSET.parameters[0]


@pytest.mark.parametrize("effect", EFFECTS.values(), ids=EFFECTS)
def test_every_shipped_effect_keeps_the_contract(effect: Effect) -> None:
    check(effect)


def test_an_effect_need_not_be_registered() -> None:
    check(replace(OFFSET, id="an_offset_of_mine"))


def sized(**changes: object) -> Effect:
    """The offset with its one parameter changed."""
    return replace(OFFSET, parameters=(replace(SIZE, **changes),))


SHAPE = Parameter("lag", "time", "a lag", 0.0, 10.0, (1.0, 2.0), "a test", role="shape", grid=(0.0, 1.0))


@pytest.mark.parametrize(
    ("effect", "said"),
    [
        (replace(OFFSET, id="My Offset"), "the id 'My Offset' needs small letters"),
        (replace(OFFSET, title=" "), "title is empty"),
        (replace(OFFSET, source=""), "source is empty"),
        (replace(OFFSET, place="elbow"), "place 'elbow' is not one of joint, link, base, tip"),
        (replace(OFFSET, cause="magic"), "cause 'magic' is not one of geometry"),
        (replace(OFFSET, aliases=("encoder_ofset",)), "alias 'encoder_ofset' is no effect"),
        (replace(OFFSET, aliases=("encoder_offset",)), "alias 'encoder_offset' is itself"),
        (replace(OFFSET, requires=("weather",)), "requires 'weather', which is not one of time"),
        (replace(OFFSET, only="joints on Sundays"), "only 'joints on Sundays' is not one of"),
        (replace(OFFSET, parameters=(SIZE, SIZE)), "two parameters have one name"),
        (replace(OFFSET, parameters=(SHAPE,)), "has shapes but no size"),
        (replace(OFFSET, enough=(("ofset",),)), "`enough` names ofset, which are no parameters"),
        (
            replace(OFFSET, link=LinkTraits(in_modes=True)),
            "in_modes does not go with the rest: it must be flexible and automatic",
        ),
        (replace(OFFSET, recording=RecordingTraits(free_with="frame")), "free_with does not go with the rest"),
        (sized(kind="angel"), "parameter offset: there is no kind of quantity 'angel'"),
        (sized(typical=(0.1, 0.6)), "typical 0.1 to 0.6 must lie within the bounds -0.5 to 0.5"),
        (sized(lower=0.05, typical=(0.1, 0.1)), "the bounds of a size must hold 0"),
        (sized(role="form"), "role 'form' is not one of size, shape, given"),
        (sized(grid=(0.1,)), "only a shape has a grid"),
        (replace(OFFSET, parameters=(SIZE, replace(SHAPE, grid=()))), "a shape needs a grid"),
        (replace(OFFSET, parameters=(SIZE, replace(SHAPE, grid=(1.0, 0.5)))), "the grid must rise"),
        (replace(OFFSET, parameters=(SIZE, replace(SHAPE, grid=(1.0, 11.0)))), "the grid must lie within the bounds"),
        (replace(OFFSET, parameters=(SIZE, replace(SHAPE, grid=(0.5, 1.0), whole=True))), "must hold whole numbers"),
    ],
)
def test_a_wrong_entry_is_told(effect: Effect, said: str) -> None:
    with pytest.raises(InputError) as caught:
        check(effect)
    assert said in str(caught.value)
    assert str(caught.value).startswith(f"effect {effect.id}: ")
    assert "\n" not in str(caught.value)


RUBS = EFFECTS["friction_coulomb"]


@pytest.mark.parametrize(
    ("torques", "said"),
    [
        (lambda motion, _: {9: np.ones(motion.size)}, "takes torque of joint 9, which the chain does not have"),
        (lambda *_: {0: np.ones(3)}, "has torques of shape (3,), where one for each instant is due"),
        (lambda motion, _: {0: np.full(motion.size, np.nan)}, "gives torques that are not finite"),
        (lambda motion, _: {0: np.ones(motion.size)}, "takes torque at a size of 0"),
        (
            lambda motion, settings: {0: np.full(motion.size, settings.values["torque"] ** 2)},
            "has torques that are not linear in its sizes",
        ),
        (lambda *_: {}, "the size torque takes no torque, on no chain"),
        (lambda _, settings: {0: settings.values["tork"]}, "raises KeyError ('tork') on a motion"),
        (None, "has a size of the torque, but no torques"),
    ],
)
def test_torques_that_break_the_contract_are_told(torques: Any, said: str) -> None:
    with pytest.raises(InputError) as caught:
        check(replace(RUBS, torques=torques))
    assert said in str(caught.value)


def test_a_default_that_is_not_what_the_torques_go_by_is_told() -> None:
    stribeck = EFFECTS["friction_stribeck"]
    size, speed = stribeck.parameters
    with pytest.raises(InputError, match="another torque where a shape is not named than at its default"):
        check(replace(stribeck, parameters=(size, replace(speed, default=0.3))))


def test_friction_that_drives_is_told() -> None:
    """Friction takes energy from steady motion, whichever law it follows."""
    viscous = EFFECTS["friction_viscous"]

    def driving(motion: Motion, settings: Settings) -> dict[int, Array]:
        assert viscous.torques is not None
        return {joint: -torque for joint, torque in viscous.torques(motion, settings).items()}

    with pytest.raises(InputError, match="helps joints on that it should brake"):
        check(replace(viscous, torques=driving))


def test_torque_of_a_joint_without_a_drive_is_told() -> None:
    def everywhere(motion: Motion, settings: Settings) -> dict[int, Array]:
        acting = (index for index in range(motion.arm.size) if settings.acts_at(index))
        return {index: settings.values.get("torque", 0.0) * motion.velocity[:, index] for index in acting}

    with pytest.raises(InputError, match="takes torque of a joint without a drive"):
        check(replace(RUBS, torques=everywhere))


def test_torque_where_an_effect_cannot_act_is_told() -> None:
    place = EFFECTS["friction_place"]
    everywhere = OfEachDrive(lambda motion, values, joint: values.get("sine", 0.0) * motion.velocity[:, joint])
    cosine = replace(place, parameters=place.parameters[:1], torques=everywhere)
    with pytest.raises(InputError, match="takes torque where it cannot act"):
        check(cosine)


def test_all_faults_are_told_at_once() -> None:
    with pytest.raises(InputError) as caught:
        check(replace(sized(kind="angel"), title="", cause="magic"))
    assert all(said in str(caught.value) for said in ("title is empty", "cause 'magic'", "kind of quantity 'angel'"))


def offset_of(state: PoseState, settings: Settings) -> float:
    del state
    return settings.values.get("offset", 0.0)


def never_still(state: PoseState, settings: Settings) -> Iterator[Twist]:
    yield from drive_motion(state, 0, 1e-3 + offset_of(state, settings))


def squared(state: PoseState, settings: Settings) -> Iterator[Twist]:
    yield from drive_motion(state, 0, offset_of(state, settings) ** 2)


def endless(state: PoseState, settings: Settings) -> Iterator[Twist]:
    yield from drive_motion(state, 0, offset_of(state, settings) * np.inf if offset_of(state, settings) else 0.0)


def by_other_rows(state: PoseState, settings: Settings) -> Iterator[Twist]:
    yield from drive_motion(state, 0, offset_of(state, settings) * (1.0 + np.size(state.joints[0].coordinate)))


def other_for_symbols(state: PoseState, settings: Settings) -> Iterator[Twist]:
    numbers = isinstance(state.joints[0].coordinate, float | np.ndarray)
    yield from drive_motion(state, 0, offset_of(state, settings) * (1.0 if numbers else 2.0))


def for_one_pose(state: PoseState, settings: Settings) -> Iterator[Twist]:
    yield from drive_motion(state, 0, offset_of(state, settings) * math.sin(state.joints[0].coordinate))


def nothing(state: PoseState, settings: Settings) -> Iterator[Twist]:
    del state, settings
    yield from ()


def beyond_the_chain(state: PoseState, settings: Settings) -> Iterator[Twist]:
    yield Twist("joint", 9, (offset_of(state, settings), 0.0, 0.0))


def words(state: PoseState, settings: Settings) -> Iterator[Twist]:
    del state, settings
    yield "a twist"  # type: ignore[misc]


def empty_play(state: PoseState, settings: Settings) -> Iterator[Interval | Disc]:
    del state, settings
    yield Interval((), 0.0)


def negative_play(state: PoseState, settings: Settings) -> Iterator[Interval | Disc]:
    del state, settings
    yield Disc(0, -1.0, (0.0, 0.0, 1.0), (0.0, 0.0, 0.0))


@pytest.mark.parametrize(
    ("effect", "said"),
    [
        (replace(OFFSET, twists=never_still), "moves something at a size of 0"),
        (replace(OFFSET, twists=squared), "is not linear in its sizes, though it promises so"),
        (replace(OFFSET, twists=endless), "not finite"),
        (replace(OFFSET, twists=by_other_rows), "gives other values for floats than for arrays"),
        (replace(OFFSET, twists=other_for_symbols), "gives other values for CasADi's symbols than for floats"),
        (replace(OFFSET, twists=for_one_pose), "raises TypeError"),
        (replace(OFFSET, twists=nothing), "the size offset moves nothing, on no chain"),
        (replace(OFFSET, twists=beyond_the_chain), "has a twist at joint 9, which the chain does not have"),
        (replace(OFFSET, twists=words), "gives what is no Twist: 'a twist'"),
        (replace(OFFSET, play=PlayTraits(free=empty_play)), "has an interval of play without a twist"),
        (replace(OFFSET, play=PlayTraits(free=negative_play)), "has a disc of play of negative radius"),
        (replace(OFFSET, requires=("time",)), "moves something without time, which it requires"),
        (replace(OFFSET, only="joints that slide"), "moves something where it cannot act (joints that slide)"),
    ],
)
def test_wrong_physics_is_told(effect: Effect, said: str) -> None:
    with pytest.raises(InputError) as caught:
        check(effect)
    assert said in str(caught.value)


def test_what_does_not_promise_to_be_linear_need_not_be() -> None:
    check(replace(OFFSET, twists=squared, linear=False))
