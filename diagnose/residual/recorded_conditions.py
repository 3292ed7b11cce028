"""What held at each reading of a recording, as effects ask for it."""

from __future__ import annotations

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.conditions import Conditions, Past
from linkwright.core.diagnose.recording import Earlier, Recording
from linkwright.core.diagnose.rules.residual_rules import ResidualRules
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.sections.numeric import Array
from linkwright.core.units.temperature import REFERENCE_TEMPERATURE


def conditions_of(recording: Recording, arm: Arm, *, rules: ResidualRules = RULES.residual) -> Conditions:
    """The conditions of the N readings, in arrays of N.

    The warming of a link is its temperature's where the recording has that, else the air's, else None. The
    present payload counts as taken up at its first reading since it last changed; what was there at the first reading
    of all counts from then. Where the recording goes on from others, the first of those began it: time runs from
    there, a payload that stayed counts from where it was taken up, and a lag goes on.
    """
    earlier = recording.earlier
    time, began = recording.time, 0.0 if earlier is None else float(earlier.time[0])
    return Conditions(
        time=None if time is None else time - began,
        warming=_warming(recording, arm),
        sides=_by_joint(recording.sides),
        velocities=_by_joint(recording.velocity),
        accelerations=_by_joint(recording.acceleration),
        commanded=_by_joint(recording.commanded),
        last_moves=_by_joint(recording.last_moves),
        loaded_for=_loaded_since(recording, rules),
        past=None if earlier is None else Past(earlier.time - began, _warming(earlier, arm)),
    )


def _loaded_since(recording: Recording, rules: ResidualRules) -> Array | None:
    earlier, time, payload = recording.earlier, recording.time, recording.payload_mass
    if earlier is None or time is None:
        return loaded_for(time, payload, rules=rules)
    if payload is not None:
        payload = None if earlier.payload_mass is None else np.concatenate([earlier.payload_mass, payload])
    whole = loaded_for(np.concatenate([earlier.time, time]), payload, rules=rules)
    return None if whole is None else whole[len(earlier.time) :]


def _warming(conditions: Recording | Earlier, arm: Arm) -> tuple[Array, ...] | None:
    if conditions.link_temperature is not None:
        return _by_joint(conditions.link_temperature - REFERENCE_TEMPERATURE)
    if conditions.temperature is None:
        return None
    return (conditions.temperature - REFERENCE_TEMPERATURE,) * arm.size


def _by_joint(values: Array | None) -> tuple[Array, ...] | None:
    return None if values is None else tuple(values[:, index] for index in range(values.shape[1]))


def loaded_for(time: Array | None, payload: Array | None, *, rules: ResidualRules = RULES.residual) -> Array | None:
    """How long (s) each reading's payload (N, kg) had been carried, None without time (N, s)."""
    if time is None:
        return None
    order = np.argsort(time, kind="stable")
    since = np.full(len(time), float(time[order[0]]))
    if payload is not None:
        start, held = float(time[order[0]]), float(payload[order[0]])
        for index in order.tolist():
            if abs(payload[index] - held) > rules.same_payload:
                start, held = float(time[index]), float(payload[index])
            since[index] = start
    return time - since
