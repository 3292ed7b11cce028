"""How far first order, in which worst cases are found and certified, is from the arm as it really stands."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.chain.statics import PoseState, solve
from linkwright.core.sections.numeric import Array

from .calibrated import calibrated_state, when_calibrated
from .exact import deformed
from .model import beams_of
from .recorded import Asked, seen
from .tip import ActiveEffect, active_effects


@dataclass(frozen=True)
class BeyondFirstOrder:
    """What finite motions and loads on the deformed shape move the tip by beyond first order, m.

    `at_worst` is that at the worst pose, `largest` the most of it at `poses` poses spread over the workspace for each
    load case, the worst ones among them, and `longer` the most by which the error's length grows there: sampled, not
    proved. `at_worst` is None where the arm finds no shape there under its loads, `largest` and `longer` where it finds
    none at some pose.
    """

    at_worst: float | None
    largest: float | None
    longer: float | None
    poses: int


def beyond_first_order(
    arm: Arm,
    cases: Sequence[LoadCase],
    worst: tuple[Sequence[float], int],
    poses: Array,
    projections: Array | None = None,
) -> BeyondFirstOrder:
    """For an arm, at its worst pose (coordinates in rad and m, number of the load case) and at poses (N, n); where
    errors count from a calibrated state, of the difference. `projections` (1 + N, 3, 3) leave the part of the error
    that counts at each of them, all of it by default.

    Play lies in both where the loads of the undeformed pose seat it: worst and statistical play count every place of it
    as it is. Where `loaded` play counts, it lies on the shape where the shape's loads seat it. Valid as
    `arm.errors.exact.deformed` is: small strains, straight links.
    """
    q, number = np.vstack([[worst[0]], poses]), worst[1]
    effects = active_effects(arm)
    channels = Asked(len(q))
    most, longer, at_worst = 0.0, 0.0, None
    settled = True
    for index, case in enumerate(cases):
        state = solve(arm, [q[:, joint] for joint in range(arm.size)], beams_of(arm, (case,)), case)
        exact, first, result = _exact_and_linear(state, effects, channels)
        if case.relative_to is not None:
            exact_there, first_there, solved_there = _exact_and_linear(
                calibrated_state(state), when_calibrated(effects, case), channels
            )
            exact, first, result = exact - exact_there, first - first_there, result & solved_there
        if projections is not None:
            exact, first = (np.einsum("nij,nj->ni", projections, item) for item in (exact, first))
        off: Array = np.linalg.norm(exact - first, axis=1)
        settled = settled and bool(result.all())
        most = max(most, float(off.max()))
        longer = max(longer, float((np.linalg.norm(exact, axis=1) - np.linalg.norm(first, axis=1)).max()))
        if index == number and result[0]:
            at_worst = float(off[0])
    return BeyondFirstOrder(at_worst, most if settled else None, longer if settled else None, len(q))


def _exact_and_linear(
    state: PoseState, effects: Sequence[ActiveEffect], channels: Asked
) -> tuple[Array, Array, NDArray[np.bool_]]:
    """How far the tip has moved (N, 3), as it stands and to first order, m; and where it finds a shape."""
    shape = deformed(state, effects, channels.rows, play_stays=state.arm.play != "loaded")
    first = sum(
        (seen(state, effect.effect, effect.settings, channels).tip for effect in effects), np.zeros((channels.rows, 3))
    )
    return shape.tip, first, shape.settled
