"""Where a joint turns round, friction builds up over a small angle: what touches gives before it slides."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

import numpy as np

from linkwright.core.arm.effects.effect import shape, torque
from linkwright.core.arm.effects.torques import direction, drive_effect
from linkwright.core.arm.effects.traits import WatchTraits
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.sections.numeric import Array


def _dahl(q: Array, distance: float) -> Array:
    """Friction over its limit (N,) by coordinates q in their order: exact between turning points, and begun as if the
    joint had come from far."""
    moved = np.diff(q)
    way = np.sign(moved)
    # A joint that stands keeps what it has.
    turned = np.flatnonzero(np.diff(way) != 0.0) + 1
    bounds = np.concatenate([[0], turned, [len(moved)]])
    state = next((sign for sign in way if sign), 0.0)
    states = np.full(len(q), state)
    for first, last in pairwise(bounds.tolist()):
        sign = way[first] if last > first else 0.0
        if sign:
            fallen = np.exp(-np.cumsum(np.abs(moved[first:last])) / distance)
            states[first + 1 : last + 1] = sign + (state - sign) * fallen
        else:
            states[first + 1 : last + 1] = state
        state = float(states[last])
    return states


def _torque(motion: Motion, values: Mapping[str, float], joint: int) -> Array:
    built = _dahl(motion.q[:, joint], values.get("distance", 3e-3))
    return motion.sampled * values.get("torque", 0.0) * (built - direction(motion.velocity[:, joint]))


FRICTION_REVERSAL = drive_effect(
    _torque,
    id="friction_reversal",
    title="friction that builds up after a reversal",
    formula="f_i (z_i - sign(q'_i)), dz/dq = (sign(q'_i) - z)/x_i (Dahl)",
    cause="friction in motion",
    needs="reversals, sampled densely",
    aliases=("friction_stribeck", "friction_coulomb"),
    source="P. R. Dahl, A solid friction model, Aerospace Corporation TOR-0158(3107-18)-1 (1968); J. Swevers, F. "
    "Al-Bender, C. G. Ganseman & T. Prajogo, An integrated friction model structure with improved presliding "
    "behavior, IEEE Trans. Automatic Control 45 (2000) 675-686, doi:10.1109/9.847103",
    parameters=(
        torque("torque", "torque", 0.0, 1e4, (0.1, 8.0)).means(
            "friction that builds up over a distance, not at once", "25 to 50 % of the dry friction"
        ),
        shape("distance", "angle", 1e-5, 0.5, (1e-3, 10e-3), grid=(1e-3, 3e-3, 10e-3), default=3e-3).means(
            "motion after which 63 % of it is there", "harmonic drives and rolling bearings: 1 to 10 mrad at the joint"
        ),
    ),
    watch=WatchTraits(lasts="a while"),
    rank=135,
)
