"""The measuring frame wanders against the base as time goes."""

from __future__ import annotations

from collections.abc import Iterator

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.effects.effect import Effect, Parameter, Settings, Twist, size
from linkwright.core.arm.effects.traits import RecordingTraits, WatchTraits

from .frame_misalignment import moved_base


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    if state.conditions.time is not None:
        yield from moved_base(state, settings.values, state.conditions.time)


def _shift(name: str) -> Parameter:
    return size(name, "speed", -1e-4, 1e-4, (10e-6 / 3600.0, 150e-6 / 3600.0)).means(
        f"drift of the base along {name}", "tripods and floors: 10 to 150 um an hour (ISO 230-3:2020 tests it)"
    )


def _turn(axis: str) -> Parameter:
    return size(f"about_{axis}", "angular_speed", -1e-4, 1e-4, (5e-6 / 3600.0, 100e-6 / 3600.0)).means(
        f"turning of the base about {axis}", "tripods and floors: 5 to 100 urad an hour"
    )


FRAME_DRIFT = Effect(
    id="frame_drift",
    title="drift of the measuring frame",
    formula="(t' + r' x p) t, t since the recording began",
    place="base",
    cause="measurement",
    needs="time, and a fixed target",
    aliases=("gearbox_thermal",),
    source="ISO 230-3:2020 (environmental temperature variation error)",
    parameters=(_shift("x"), _shift("y"), _shift("z"), _turn("x"), _turn("y"), _turn("z")),
    twists=_twists,
    requires=("time",),
    watch=WatchTraits(lasts="a recording"),
    rank=270,
    linear=True,
    recording=RecordingTraits(of_instrument=True),
)
