"""A joint's angle errs by a separate curve: all low orders at once, as gears and encoders make them together.

Where single orders stand out, `gear_transmission_error` says more. Here the curve is irregular and repeats each turn:
measured joints of light arms show it (0.2 to 0.3 mrad RMS, bending every 10 to 25 degrees), with no order that leads.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import Scalar, plus, times
from linkwright.core.arm.effects.effect import Effect, OfDrives, Parameter, Settings, shape, size
from linkwright.core.arm.effects.traits import DriveTraits, Readings, RecordingTraits
from linkwright.core.sections.numeric import cos, sin

ORDERS = 32
"""The highest order: a wave of 11 degrees."""
_FOR_EACH = 8.0
"""Different angles for each coefficient of a joint's curve."""


def waviness(coordinate: Scalar, values: Mapping[str, float]) -> Scalar:
    """A joint's error (rad) at an angle (rad), by the effect's parameters."""
    total: Scalar = 0.0
    highest = values.get("orders", float(ORDERS))
    for order in range(1, ORDERS + 1):
        if order > highest:
            break
        of_sine, of_cosine = values.get(f"sine_{order}", 0.0), values.get(f"cosine_{order}", 0.0)
        if of_sine != 0.0:
            total = plus(total, times(of_sine, sin(times(float(order), coordinate))))
        if of_cosine != 0.0:
            total = plus(total, times(of_cosine, cos(times(float(order), coordinate))))
    return total


def _moved(state: PoseState, settings: Settings, index: int) -> Scalar:
    return waviness(state.joints[index].coordinate, settings.values)


def _shown(readings: Readings, at: tuple[int, ...], shapes: Mapping[str, float]) -> bool:
    """Whether the joint was read at enough different angles for every coefficient."""
    angles = np.unique(np.round(readings.q[:, at[0]], 3))
    return len(angles) >= _FOR_EACH * 2.0 * shapes["orders"]


def _amplitude(name: str, order: int) -> Parameter:
    return size(f"{name}_{order}", "angle", -2e-3, 2e-3, (5e-6, 30e-6)).means(
        f"error that goes with the {name} of {order} times the joint's angle",
        "transmission error of precision gears, 0.3 to 2 arcmin in makers' catalogues, shared by many orders",
    )


_SIZES = tuple(_amplitude(name, order) for order in range(1, ORDERS + 1) for name in ("sine", "cosine"))

JOINT_WAVINESS = Effect(
    id="joint_waviness",
    title="periodic error of a joint's angle",
    formula="sum J_i sum_k (a_k sin k q_i + b_k cos k q_i), k from 1 to 32",
    place="joint",
    cause="angle errors",
    needs="dense travel of the joint: eight different angles for each coefficient",
    aliases=("gear_transmission_error", "encoder_eccentricity", "encoder_scale"),
    source="F. H. Ghorbel, P. S. Gandhi & F. Alpeter, On the kinematic error in harmonic drive gears, "
    "ASME Journal of Mechanical Design 123 (2001) 90-97",
    parameters=(
        *_SIZES,
        shape(
            "orders",
            "dimensionless",
            1.0,
            float(ORDERS),
            (8.0, 32.0),
            whole=True,
            default=float(ORDERS),
            grid=(8.0, 16.0, 32.0),
        ).means("the highest order that takes part", "the shortest wave that readings some degrees apart can show"),
    ),
    twists=OfDrives(_moved, "joints that turn"),
    enough=tuple((size.name,) for size in _SIZES),
    only="joints that turn",
    rank=140,
    linear=True,
    recording=RecordingTraits(shown_by=_shown),
    drive=DriveTraits(curve=waviness),
)
