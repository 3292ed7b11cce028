"""A gear does not turn evenly: the joint errs k times a turn (on a slide: k times a metre, a screw's pitch)."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import Scalar, plus, times
from linkwright.core.arm.effects.effect import Effect, OfDrives, Parameter, Settings, shape, size
from linkwright.core.arm.effects.traits import DriveTraits, Readings, RecordingTraits
from linkwright.core.sections.numeric import cos, sin

_LEAST_WAVES = 0.7
"""Of less of a wave neither its period nor that it is one shows: a scale or an eccentricity does as much."""


def _moved(state: PoseState, settings: Settings, index: int) -> Scalar:
    of_sine, of_cosine = settings.values.get("sine", 0.0), settings.values.get("cosine", 0.0)
    joint, order = state.joints[index], settings.values.get("order", 0.0)
    if order == 0.0:
        return 0.0
    phase = times(order if joint.revolute else 2.0 * math.pi * order, joint.coordinate)
    return plus(times(of_sine, sin(phase)), times(of_cosine, cos(phase)))


def _amplitude(name: str) -> Parameter:
    return size(name, "angle", -0.01, 0.01, (0.02e-3, 0.3e-3)).means(
        f"error that goes with the {name} of the order times the joint's angle",
        "makers' catalogues: transmission error of precision gears 0.3 to 2 arcmin",
    )


def _shown(readings: Readings, at: tuple[int, ...], shapes: Mapping[str, float]) -> bool:
    """Whether a joint went through most of a wave of the order, at enough different coordinates to see it."""
    q = readings.q[:, at[0]]
    waves = shapes["order"] * float(np.ptp(q)) / (2.0 * np.pi if readings.state.joints[at[0]].revolute else 1.0)
    different = len(np.unique(np.round(q, 3)))
    return waves >= _LEAST_WAVES and different >= max(8.0, 1.5 * waves)


GEAR_TRANSMISSION_ERROR = Effect(
    id="gear_transmission_error",
    title="transmission error of a gear",
    formula="sum J_i (a sin k q_i + b cos k q_i)",
    place="joint",
    drive=DriveTraits(needed=True),
    cause="angle errors",
    needs="dense travel of the joint: three readings a period or more",
    aliases=("encoder_eccentricity",),
    source="F. H. Ghorbel, P. S. Gandhi & F. Alpeter, On the kinematic error in harmonic drive gears, "
    "ASME Journal of Mechanical Design 123 (2001) 90-97",
    parameters=(
        _amplitude("sine"),
        _amplitude("cosine"),
        shape(
            "order",
            "dimensionless",
            0.1,
            5000.0,
            (2.0, 200.0),
            whole=True,
            grid=(*map(float, range(2, 61)), 72.0, 80.0, 100.0, 101.0, 120.0, 121.0, 160.0, 200.0, 240.0, 320.0),
        ).means(
            "periods in one turn of the joint (on a slide: in one metre)",
            "numbers of teeth of output stages; gear ratios, and twice those for harmonic drives",
        ),
    ),
    twists=OfDrives(_moved),
    enough=(("sine", "order"), ("cosine", "order")),
    rank=130,
    linear=True,
    recording=RecordingTraits(shown_by=_shown),
)
