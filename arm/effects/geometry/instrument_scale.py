"""The instrument's metre is not a metre: every measured position is too far out or too near in proportion."""

from __future__ import annotations

from collections.abc import Iterator

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import scale
from linkwright.core.arm.effects.effect import Effect, Settings, Twist, size
from linkwright.core.arm.effects.traits import RecordingTraits, WatchTraits


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    share = settings.values.get("scale", 0.0)
    if share != 0.0:
        yield Twist("tip", len(state.links) - 1, scale(share, state.tip()))


INSTRUMENT_SCALE = Effect(
    id="instrument_scale",
    title="scale of the measuring instrument",
    formula="e p",
    place="tip",
    cause="measurement",
    needs="a certified length within the measured volume",
    aliases=("link_length", "thermal_expansion"),
    source="ISO 10360-10:2021 (laser trackers: length measurement error)",
    parameters=(
        size("scale", "dimensionless", -0.05, 0.05, (5e-6, 4e-4)).means(
            "share by which the instrument reads distances from the base too long",
            "laser trackers: 5 to 20 ppm; camera systems without a scale bar: hundreds of ppm",
        ),
    ),
    twists=_twists,
    watch=WatchTraits(lasts="a recording"),
    rank=260,
    linear=True,
    recording=RecordingTraits(of_instrument=True),
)
