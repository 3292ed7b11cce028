"""The error that is left to an arm that was calibrated: only what changes from the calibrated state counts.

At the calibration's payload and temperature, at every pose, the error vector was measured and is subtracted from then
on; what counts is the error vector now less the error vector there, at the same pose. Offsets, gravity's sag of the
arm itself and whatever else is the same in both cancel. Play does not: a calibration takes the mean of both sides of
approach, as ISO 230-2 does for the systematic deviation of a position, so that it takes the middle of the play and
leaves half of it either way (`worst`, `statistical`). Where play lies as its load pushes it (`loaded`), the load of the
calibration pushed it too: what counts is the difference of both places, nothing where both loads push it the same way.
A deviation that nobody knows but that repeats at a pose (a rail's) is taken whole.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from types import MappingProxyType

from linkwright.core.arm.chain.chain import Arm, LoadCase, PlayMode
from linkwright.core.arm.chain.statics import PoseState, solve
from linkwright.core.arm.chain.vectors import is_zero, scale, subtract
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.units.temperature import REFERENCE_TEMPERATURE

from .tip import ActiveEffect, Counted, TipError, tip_error


def calibrated_temperature(loads: Sequence[LoadCase]) -> float | None:
    """The temperature (K) at which the arm was calibrated, None for that at which it works; raises `ValueError` where
    load cases differ in that."""
    temperatures = {load.relative_to.temperature for load in loads if load.relative_to is not None}
    if len(temperatures) > 1:
        raise ValueError("load cases count from calibrations at several temperatures")
    return next(iter(temperatures), None)


def planar_in(arm: Arm, load: LoadCase) -> bool:
    """Whether everything stays in the x-y plane under a load case, and where its error counts from."""
    arm, calibrated = arm.on(load.tip), load.when_calibrated
    return arm.planar(load) and (calibrated is None or arm.planar(calibrated))


def calibrated_state(state: PoseState) -> PoseState:
    """The arm at the same pose (coordinates, beams and load case of `state`) as it was when it was calibrated."""
    reference, load = state.load.relative_to, state.load.when_calibrated
    assert reference is not None
    assert load is not None
    warm = reference.temperature is not None
    return solve(
        state.arm,
        [joint.coordinate for joint in state.joints],
        [link.beam.calibrated if warm else link.beam for link in state.links],
        load,
        warming=None if reference.temperature is None else reference.temperature - REFERENCE_TEMPERATURE,
        frames=state.frames,
    )


def when_calibrated(effects: Sequence[ActiveEffect], load: LoadCase) -> list[ActiveEffect]:
    """An arm's effects in the state that the errors of a load case count from: where that has a temperature, all links
    have it, and a `warming` that an effect was given is of work alone."""
    reference = load.relative_to
    if reference is None or reference.temperature is None:
        return list(effects)
    results: list[ActiveEffect] = []
    for active in effects:
        values = {name: value for name, value in active.settings.values.items() if name != "warming"}
        results.append(replace(active, settings=replace(active.settings, values=MappingProxyType(values))))
    return results


def error_since_calibrated(
    state: PoseState, effects: Sequence[ActiveEffect], mode: PlayMode, counted: Counted = "position"
) -> TipError:
    """The tip's error at a pose less that in the calibrated state, with the play that a calibration leaves; `mode` is
    how play counts, `counted` as for `tip_error`."""
    now = tip_error(state, effects, counted)
    there = tip_error(calibrated_state(state), when_calibrated(effects, state.load), counted)
    intervals = [interval for interval in now.intervals if not EFFECTS[interval.effect].play.repeats]
    discs = [disc for disc in now.discs if not EFFECTS[disc.effect].play.repeats]
    if mode == "loaded":
        # Where the calibration's load had pushed the play, on the other side of what counts now.
        intervals += [
            replace(interval, vector=scale(-1.0, interval.vector), taken=True)
            for interval in there.intervals
            if not EFFECTS[interval.effect].play.repeats and not is_zero((interval.seating, 0.0, 0.0))
        ]
        discs += [
            replace(disc, seating=scale(-1.0, disc.seating), taken=True)
            for disc in there.discs
            if not EFFECTS[disc.effect].play.repeats and not is_zero(disc.seating)
        ]
    kinks = (*now.kinks, *(replace(kink, vector=scale(-1.0, kink.vector)) for kink in there.kinks))
    return TipError(subtract(now.vector, there.vector), tuple(intervals), tuple(discs), kinks)
