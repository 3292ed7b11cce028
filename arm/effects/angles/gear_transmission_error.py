"""A gear does not turn evenly: the joint errs k times a turn (on a slide: k times a metre, a screw's pitch)."""

from __future__ import annotations

import math
from collections.abc import Iterator

from ..statics import PoseState
from ..vectors import plus, times
from .effect import Effect, Parameter, Settings, Twist, drive_motion
from .functions import cosine, sine


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    of_sine, of_cosine = settings.values.get("sine", 0.0), settings.values.get("cosine", 0.0)
    order = settings.values.get("order")
    if order is None or (of_sine == 0.0 and of_cosine == 0.0):
        return
    for index, joint in enumerate(state.joints):
        if settings.acts_at(index):
            phase = times(order if joint.revolute else 2.0 * math.pi * order, joint.coordinate)
            yield from drive_motion(state, index, plus(times(of_sine, sine(phase)), times(of_cosine, cosine(phase))))


def _amplitude(name: str) -> Parameter:
    return Parameter(
        name,
        "angle",
        f"error that goes with the {name} of the order times the joint's angle",
        -0.01,
        0.01,
        (0.02e-3, 0.3e-3),
        "makers' catalogues: transmission error of precision gears 0.3 to 2 arcmin",
        role="size",
    )


GEAR_TRANSMISSION_ERROR = Effect(
    id="gear_transmission_error",
    title="transmission error of a gear",
    formula="sum J_i (a sin k q_i + b cos k q_i)",
    place="joint",
    cause="angle errors",
    automatic=False,
    needs="dense travel of the joint: three readings a period or more",
    aliases=("encoder_eccentricity",),
    source="F. H. Ghorbel, P. S. Gandhi & F. Alpeter, On the kinematic error in harmonic drive gears, "
    "ASME Journal of Mechanical Design 123 (2001) 90-97",
    parameters=(
        _amplitude("sine"),
        _amplitude("cosine"),
        Parameter(
            "order",
            "dimensionless",
            "periods in one turn of the joint (on a slide: in one metre)",
            0.1,
            5000.0,
            (2.0, 200.0),
            "numbers of teeth of output stages; gear ratios, and twice those for harmonic drives",
            role="shape",
            grid=(*map(float, range(2, 61)), 72.0, 80.0, 100.0, 101.0, 120.0, 121.0, 160.0, 200.0, 240.0, 320.0),
        ),
    ),
    twists=_twists,
    enough=(("sine", "order"), ("cosine", "order")),
)
