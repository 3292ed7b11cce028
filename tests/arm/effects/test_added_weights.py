"""Friction and play under weights that the arm's effects add: as under the same weights in the file, whose loads are
solved for as a whole."""

from __future__ import annotations

from dataclasses import replace
from types import MappingProxyType

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm, EffectEntry
from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.effects.loads.added_weights import bearing, borne_wholly
from linkwright.core.arm.errors.exact import deformed
from linkwright.core.arm.errors.tip import active_effects, tip_error
from linkwright.core.sections.numeric import Array
from tests.arm.effects.effect_states import ROWS, Posed, moved, planar, spatial

MASS, HOSE = 4.0, 2.5
OUT_OF_PROPORTION: tuple[tuple[str, dict[str, float]], ...] = (
    ("friction_windup", {"windup": 1e-4, "windup_per_load": 1e-6}),
    ("backlash", {"total": 4e-4, "held_below": 40.0}),
    ("clearance", {"radius": 3e-5}),
)


def entry(effect: str, values: dict[str, float], *at: int) -> EffectEntry:
    return EffectEntry(effect, at, MappingProxyType(values))


def added(posed: Posed) -> PoseState:
    """A heavier payload, and a hose on link 2, as effects."""
    return posed.solved(
        replace(posed.arm, effects=(entry("payload", {"mass": MASS}), entry("link_mass", {"mass": HOSE}, 2)))
    )


def declared(posed: Posed) -> PoseState:
    """The same in the file."""
    arm, beam = posed.arm, posed.beams[1]
    heavier = replace(beam, mass_per_length=beam.mass_per_length + HOSE / beam.length)
    payload = replace(arm.payload, mass=arm.payload.mass + MASS)
    return posed.solved(replace(arm, payload=payload), (posed.beams[0], heavier, *posed.beams[2:]))


@pytest.mark.parametrize("posed", [planar(), planar(2), spatial(), spatial(3)], ids=("plane", "other", "space", "more"))
@pytest.mark.parametrize(("effect", "values"), OUT_OF_PROPORTION, ids=[item for item, _ in OUT_OF_PROPORTION])
def test_added_weights_count_as_declared_ones(posed: Posed, effect: str, values: dict[str, float]) -> None:
    for joint in range(posed.arm.size):
        expected = moved(declared(posed), effect, values, (joint,))
        assert moved(added(posed), effect, values, (joint,)) == pytest.approx(expected, rel=1e-9, abs=1e-15)


def test_the_weights_change_what_is_asked_above() -> None:
    """Without them each of these would move the tip otherwise at some pose."""
    for effect, values in OUT_OF_PROPORTION:
        change = moved(added(planar()), effect, values) - moved(planar().state, effect, values)
        assert np.abs(change).max() > 1e-9, effect


def test_loads_that_are_the_whole_stay() -> None:
    """What hangs there is not put on twice."""
    once = borne_wholly(added(spatial()))
    twice = bearing(once)
    for joint, other, given in zip(twice.joints, once.joints, declared(spatial()).joints, strict=True):
        assert np.asarray(joint.drive_load) == pytest.approx(np.asarray(other.drive_load))
        assert np.asarray(joint.drive_load) == pytest.approx(np.asarray(given.drive_load))


def rigid(payload: float, effects: tuple[EffectEntry, ...]) -> Arm:
    """Nothing gives in proportion here, so that added and declared weights are the same thing."""
    posed = planar()
    joints = tuple(replace(joint, stiffness=None, backlash=3e-4, clearance=0.0) for joint in posed.arm.joints)
    load = replace(posed.arm.payload, mass=payload)
    left_out = ("link_bending", "slope_propagation", "axial", "shear_deformation", "torsion")
    return replace(posed.arm, joints=joints, payload=load, effects=effects, leave_out=frozenset(left_out))


def tip(arm: Arm, *, exact: bool) -> Array:
    state, effects = planar().solved(arm), active_effects(arm)
    if exact:
        return deformed(state, effects, ROWS).tip
    result = tip_error(state, effects)
    loads = [np.broadcast_to(interval.seating, (ROWS,)) for interval in result.intervals]
    return np.stack([*(np.broadcast_to(item, (ROWS,)) for item in result.vector), *loads])


@pytest.mark.parametrize("exact", [True, False])
def test_a_rigid_arm_cannot_tell_an_added_payload_from_a_declared_one(exact: bool) -> None:
    drives = (entry("friction_windup", {"windup_per_load": 2e-6}),)
    extra = entry("payload", {"mass": MASS})
    result, expected = tip(rigid(3.0, (*drives, extra)), exact=exact), tip(rigid(3.0 + MASS, drives), exact=exact)
    assert result == pytest.approx(expected, rel=1e-9, abs=1e-12)
    assert np.abs(tip(rigid(3.0, drives), exact=exact) - expected).max() > 1e-6
