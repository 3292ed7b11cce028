"""How warm a link is, for the effects of temperature, and the lag that they share."""

from __future__ import annotations

from collections.abc import Mapping

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import Scalar
from linkwright.core.arm.effects.effect import shape

LAG = shape(
    "lag",
    "time",
    0.0,
    2e5,
    (1e3, 7.2e3),
    grid=(0.0, 300.0, 600.0, 1200.0, 1800.0, 2700.0, 3600.0, 5400.0, 7200.0, 10800.0, 14400.0, 21600.0),
    requires=("time", "warming"),
).means(
    "time constant with which the part follows the temperature recorded",
    "links of robots and machine columns: 0.3 to 2 h (ISO 230-3:2020, thermal effects)",
)


def warming_of(state: PoseState, link: int, values: Mapping[str, float]) -> Scalar:
    """Temperature (K) of `link` (from 0) above 20 degC, behind the `lag` of `values`: that recorded, or the arm's own
    where no temperature was."""
    if state.conditions.warming is None:
        return state.links[link].warming
    return state.conditions.lagged_warming(link, values.get("lag", 0.0))
