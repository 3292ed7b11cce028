"""A joint's angle errs by a curve of its own: all low orders at once, as gears and encoders make them together.

Where single orders stand out, `gear_transmission_error` says more. Here the curve is irregular and repeats each turn:
measured joints of light arms show it (0.2 to 0.3 mrad RMS, bending every 10 to 25 degrees), with no order that leads.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ..statics import PoseState
from ..vectors import Scalar, plus, times
from .effect import Effect, Parameter, Settings, Twist, drive_motion
from .functions import cosine, sine

ORDERS = 32
"""The highest order: a wave of 11 degrees."""


def waviness(coordinate: Scalar, values: Mapping[str, float]) -> Scalar:
    """A joint's error (rad) at an angle (rad), by the effect's parameters."""
    total: Scalar = 0.0
    highest = values.get("orders", float(ORDERS))
    for order in range(1, ORDERS + 1):
        if order > highest:
            break
        of_sine, of_cosine = values.get(f"sine_{order}", 0.0), values.get(f"cosine_{order}", 0.0)
        if of_sine != 0.0:
            total = plus(total, times(of_sine, sine(times(float(order), coordinate))))
        if of_cosine != 0.0:
            total = plus(total, times(of_cosine, cosine(times(float(order), coordinate))))
    return total


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    for index, joint in enumerate(state.joints):
        if joint.revolute and settings.acts_at(index):
            yield from drive_motion(state, index, waviness(joint.coordinate, settings.values))


def _amplitude(name: str, order: int) -> Parameter:
    return Parameter(
        f"{name}_{order}",
        "angle",
        f"error that goes with the {name} of {order} times the joint's angle",
        -2e-3,
        2e-3,
        (5e-6, 30e-6),
        "transmission error of precision gears, 0.3 to 2 arcmin in makers' catalogues, shared by many orders",
        role="size",
    )


_SIZES = tuple(_amplitude(name, order) for order in range(1, ORDERS + 1) for name in ("sine", "cosine"))

JOINT_WAVINESS = Effect(
    id="joint_waviness",
    title="periodic error of a joint's angle",
    formula="sum J_i sum_k (a_k sin k q_i + b_k cos k q_i), k from 1 to 32",
    place="joint",
    cause="angle errors",
    automatic=False,
    needs="dense travel of the joint: eight different angles for each coefficient",
    aliases=("gear_transmission_error", "encoder_eccentricity", "encoder_scale"),
    source="F. H. Ghorbel, P. S. Gandhi & F. Alpeter, On the kinematic error in harmonic drive gears, "
    "ASME Journal of Mechanical Design 123 (2001) 90-97",
    parameters=(
        *_SIZES,
        Parameter(
            "orders",
            "dimensionless",
            "the highest order that takes part",
            1.0,
            float(ORDERS),
            (8.0, 32.0),
            "the shortest wave that readings some degrees apart can show",
            role="shape",
            grid=(8.0, 16.0, 32.0),
        ),
    ),
    twists=_twists,
    enough=tuple((size.name,) for size in _SIZES),
    only="joints that turn",
)
