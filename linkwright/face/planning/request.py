"""The request of a plan: by the names of its parameters, and as the selection of visits takes it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np

import linkwright as lw
from linkwright.core.arm.avoid.obstacle import Obstacle
from linkwright.core.arm.avoid.poses import NoRoom, room_of
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.files.avoid import read_avoid
from linkwright.core.diagnose.instruments.instrument import Instrument
from linkwright.core.diagnose.instruments.observes import observed_by
from linkwright.core.diagnose.instruments.registry import INSTRUMENTS, with_setting
from linkwright.core.diagnose.plan.plan_request import Asked, Place, instruments, seen_axes
from linkwright.core.diagnose.plan.planned import Planned
from linkwright.core.diagnose.plan.planning import NothingToSee
from linkwright.core.diagnose.plan.planning import plan as planned
from linkwright.core.diagnose.plan.simulate import Plan as Noise
from linkwright.core.diagnose.plan.tried import TooFewPostures
from linkwright.core.diagnose.recording import Recording as Readings
from linkwright.core.diagnose.result import Diagnosis as DiagnosisResult
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import InputError, NoAnswer, shown
from linkwright.core.units.reading import Mapping as Reader
from linkwright.face.arm import Arm
from linkwright.face.diagnosis import Diagnosis, recordings_of
from linkwright.face.motion.diagnosis import MotionDiagnosis
from linkwright.face.motion.log import Log
from linkwright.face.plain_input import File, Quantity, in_si, plain
from linkwright.face.progress import Progress, interrupts, reporting
from linkwright.face.recording import Recording

After = Recording | Log | Diagnosis | MotionDiagnosis | File | Sequence[Recording | Log | File] | None
"""What a plan goes on from."""
_NOISE = 15e-6
_MOST_POSES, _MOST_READINGS = 500, 5000


@dataclass(frozen=True)
class Request:
    """What `linkwright.plan` is asked for, by the names of its parameters; `reads` is the instrument, `torque_noise`
    what each drive's torque scatters by, SI."""

    poses: int
    for_: Iterable[str]
    reads: Reads
    sigma: Quantity | None
    sigma_depth: Quantity | None
    sigma_angle: Quantity | None
    repeats: int
    payloads: Sequence[Quantity] | None
    frame: Literal["known", "free"]
    tool: Literal["known", "free"]
    avoid: Sequence[Mapping[str, Any] | tuple[Sequence[Quantity], Sequence[Quantity]]]
    bars: int | None
    torque_noise: tuple[float, ...]
    seed: int

    def check(self, arm: Arm) -> None:
        """Refuse, before any recording is read, what no plan can be. Raises `InputError`."""
        poses, repeats, instrument = self.poses, self.repeats, self.reads.instrument
        least = RULES.search.least_visits
        if not least <= poses <= _MOST_POSES:
            raise InputError("", "poses", f"is from {least} (fewer tell nothing) to {_MOST_POSES}, not {poses}")
        if repeats < 1 or poses * repeats > _MOST_READINGS:
            message = f"is at least 1, and {_MOST_READINGS} readings in all at most, not {repeats}"
            raise InputError("", "repeats", message)
        if instrument not in instruments():
            hint = nearest(instrument, list(instruments()))
            raise InputError("", "instrument", f"{shown(instrument)} is not one of {', '.join(instruments())}{hint}")
        for key, value in (("frame", self.frame), ("tool", self.tool)):
            if value not in ("known", "free"):
                raise InputError("", key, f"is known or free, not {shown(value)}")
        _bars(self.bars, instrument, poses)
        _refuse_unknown_weights(self.torque_noise, arm)
        try:
            seen_axes(instrument, arm.model)
        except ValueError as error:
            raise InputError("", "instrument", str(error)) from None

    def reading(self, arm: Arm, there: Readings | None) -> Reads:
        """What is read, after the readings that are there. Raises `InputError`."""
        result = _reading(self.reads, arm, there)
        _refuse_free(result.instrument, self.frame, self.tool)
        return _with_noise(result, there, self.sigma, self.sigma_depth, self.sigma_angle)


def planned_for(
    arm: Arm,
    request: Request,
    after: After,
    progress: Progress | None,
) -> Planned:
    """The visits that are worth making, `after` what is there already. Raises `InputError`, and `NoAnswer` where
    nothing of what is asked for can be seen."""
    effects = tuple(place_of(name, arm) for name in request.for_)
    request.check(arm)
    regions, masses = regions_of(request.avoid), _payloads(request.payloads, arm)
    if after is None:
        request.reading(arm, None)
    before = _diagnosed(after, arm, progress, lambda there: request.reading(arm, there))
    recorded = None if before is None else before.recording
    apart = () if before is None or effects else _undecided(before)
    reads = request.reading(arm, recorded)
    noise = reads.sigma or (_NOISE if before is None else _scatter(before))
    # The instrument that is there stays where it stands; where camera and target are nobody knows, and the arm tells.
    camera = reads.instrument == "camera"
    frame = "free" if camera or (recorded is not None and recorded.frame == "free") else request.frame
    tool = "free" if camera or (recorded is not None and recorded.tool == "free") else request.tool
    regions = (*regions, *(() if recorded is None else recorded.avoid))
    room = room_of(arm.model, None if recorded is None else recorded.q, regions)
    asked = Asked(
        request.poses, effects or apart, reads.instrument, noise, request.repeats, masses, frame, tool, room,
        request.seed, pairs_only=bool(apart), camera_noise=reads.of_camera(noise), torque_noise=request.torque_noise,
        bars=_bars(request.bars, request.reads.instrument, request.poses), **reads.request,
    )  # fmt: skip
    with reporting(progress) as hear, interrupts() as check:

        def heard(text: str, share: float) -> None:
            check()
            hear(text, share)

        try:
            return planned(arm.model, asked, heard, recorded)
        except NothingToSee:
            raise NoAnswer("nothing of what is asked for moves anything that this instrument sees") from None
        except TooFewPostures as error:
            raise InputError("", "instrument", f"{shown(reads.instrument)} {error}") from None
        except NoRoom as error:
            raise InputError("", "avoid", str(error)) from None


@dataclass(frozen=True)
class Reads:
    """What an instrument reads, in a caller's words; `request` is that as a plan takes it, `sigma` its scatter (None:
    nobody said), `deep` and `turns` those of a camera's depths and turns."""

    instrument: str
    direction: Sequence[float] | None
    anchor: Sequence[Quantity] | None
    anchor_free: bool
    tilt_link: str | int | None
    camera: Literal["fixed", "on_tool"] | None
    bar: Sequence[Quantity] | None
    settings: Mapping[str, Any] = field(default_factory=dict[str, Any])
    request: Mapping[str, Any] = field(default_factory=dict[str, Any])
    sigma: float | None = None
    deep: float | None = None
    turns: float | None = None

    def of_camera(self, sigma: float) -> tuple[float, float]:
        """The scatter of a camera's depths (m) and turns (rad) where that across its view is `sigma`."""
        usual = Noise(1, noise=sigma).of_camera
        return self.deep or usual[0], self.turns or usual[1]


_WORDS = ("direction", "anchor", "tilt_link", "camera", "bar")
"""The settings of instruments that are parameters; others come by name in `settings`."""


def _reading(reads: Reads, arm: Arm, before: Readings | None) -> Reads:
    """The instrument, and what says how it reads: as asked, or as the recording before did."""
    there = None if before is None else _instrument_of(before, reads.instrument)
    if before is not None and there is not None:
        reads = _of_before(reads, there, before)
    instrument = reads.instrument
    given = {name: getattr(reads, name) for name in _WORDS} | dict(reads.settings)
    for name, value in given.items():
        if value is not None and instrument not in with_setting(name):
            kinds = " or ".join(with_setting(name)) or "none"
            raise InputError("", name, f"goes with the instrument {kinds}, not {shown(instrument)}")
    if reads.anchor_free and instrument not in with_setting("anchor"):
        raise InputError("", "anchor_free", f"goes with the instrument distance, not {shown(instrument)}")
    if instrument not in INSTRUMENTS:
        return reads
    seen_axes(instrument, arm.model)
    at = None if reads.anchor is None else [in_si(item, "length", "anchor") for item in reads.anchor]
    settings = observed_by(
        instrument,
        reads.direction,
        at,
        arm.model,
        anchor_free=reads.anchor_free,
        tilt_link=reads.tilt_link,
        camera=reads.camera,
        bar=None if reads.bar is None else [in_si(item, "length", "bar") for item in reads.bar],
        settings=reads.settings,
    )
    request = {
        "slots": settings["slots"],
        "reads": settings["instrument"],
        "anchor_free": reads.anchor_free,
        "bar": settings.get("bar", ()),
    }
    return replace(reads, request=request)


def _of_before(reads: Reads, there: Instrument, before: Readings) -> Reads:
    """What is said, and otherwise what the instrument that is there already tells."""
    kind = INSTRUMENTS[there.kinds[0]]
    said = dict(kind.words(there))
    free = bool(said.pop("anchor_free", False))
    if free and reads.anchor is None:
        raise InputError("", "anchor", "is missing: the recording does not tell where it is; say about where")
    for name in ("tilt_link", "camera"):
        given = getattr(reads, name)
        if given is not None and name in said and str(given) != str(said[name]):
            raise InputError("", name, f"is {said[name]} in the recording to go on from, not {shown(given)}")
    known = {name: getattr(reads, name) or said[name] for name in said if name in _WORDS}
    further = {name: value for name, value in said.items() if name not in _WORDS}
    if "bar" in kind.settings and reads.bar is None:
        known["bar"] = _places_along(before)
    return replace(
        reads,
        instrument=kind.name,
        anchor_free=reads.anchor_free or free,
        settings={**further, **reads.settings},
        **known,
    )


def _places_along(before: Readings) -> list[float]:
    """Where along its bars a recording touches, m."""
    assert before.bar_at is not None
    return sorted(set(np.round(before.bar_at, 8).tolist()))


def _bars(given: int | None, instrument: str, poses: int) -> int:
    """In how many places a bar is to lie, 0 where nobody said. Raises `InputError`."""
    if given is None:
        return 0
    if instrument != "bar":
        raise InputError("", "bars", f"goes with the instrument bar, not {shown(instrument)}")
    if not 1 <= given <= poses // 2:
        raise InputError("", "bars", f"is from 1 to {poses // 2}, two visits or more to each place, not {given}")
    return given


def _with_noise(
    reads: Reads, before: Readings | None, sigma: Quantity | None, deep: Quantity | None, turns: Quantity | None
) -> Reads:
    """The same with what it scatters by, as far as anybody said."""
    camera = reads.instrument == "camera"
    kind = "angle" if _of_angles(reads.instrument) else "length"
    noise: dict[str, float | None] = {}
    for name, given, of in (("sigma", sigma, kind), ("sigma_depth", deep, "length"), ("sigma_angle", turns, "angle")):
        if given is not None and name != "sigma" and not camera:
            raise InputError("", name, f"goes with the instrument camera, not {shown(reads.instrument)}")
        noise[name] = value = None if given is None else in_si(given, of, name)
        if value is not None and value <= 0.0:
            raise InputError("", name, "must be positive")
    across, depth, angle = noise["sigma"], noise["sigma_depth"], noise["sigma_angle"]
    if camera and before is not None:
        first = before.singles[0]
        if before.orientation is None:
            raise InputError("", "after", f"{before.file} holds no orientations; a plan for a camera needs them")
        axes, angle = first.sigma_axes, angle or first.sigma_angle
        across, depth = across or (axes[0] if axes else None), depth or (axes[2] if axes else None)
        if across is None:
            raise InputError("", "sigma", f"is missing: {before.file} does not declare what its camera scatters by")
    return replace(reads, sigma=across, deep=depth, turns=angle)


def _refuse_unknown_weights(torques: Sequence[float], arm: Arm) -> None:
    """What torques tell of weights is foreseen from the arm file's."""
    links = enumerate(arm.model.links, start=1)
    none = [str(number) for number, link in links if link.section is None and link.mass is None]
    if torques and none:
        message = f"needs the mass of each link; give one to link{'s' * (len(none) > 1)} {', '.join(none)}"
        raise InputError("", "torques", message)


def _of_angles(instrument: str) -> bool:
    return instrument in INSTRUMENTS and INSTRUMENTS[instrument].numbers[0].quantity == "angle"


def _refuse_free(instrument: str, frame: str, tool: str) -> None:
    """A level minds neither where a frame stands nor where a target sits, touches have no frame."""
    kind = INSTRUMENTS.get(instrument)
    for name, given in (("frame", frame), ("tool", tool)):
        if kind is not None and not kind.of_place and given == "free":
            raise InputError("", name, "goes with an instrument that reads the tip's place; a level does not see it")
        if kind is not None and kind.label and given == "free" and name == "frame":
            raise InputError("", name, "goes with an instrument that reads the tip's place; touches are in no frame")


def _instrument_of(recording: Readings, instrument: str) -> Instrument | None:
    """The instrument that a recording was made with, None of the tip's place.
    Raises `InputError` for several, and where another one is asked for."""
    if recording.slots is None:
        if instrument in INSTRUMENTS:
            raise InputError("", "after", f"{recording.file} holds the tip's place; its own instrument goes on from it")
        return None
    first, kinds = recording.singles[0].instrument, {one.instrument.kinds for one in recording.singles}
    if any(len(item) > 1 or item == ("position",) for item in kinds) or len(kinds) > 1:
        message = (
            "is not of one instrument that a plan goes on from: the tip's place, heights, distances, tilts, a camera"
        )
        message += ", touches of points, planes or bars"
        raise InputError("", "after", f"{recording.file} {message}")
    if instrument not in ("tracker", first.kinds[0]):
        raise InputError("", "after", f"{recording.file} holds its {first.kinds[0]}, not {instrument}")
    return first


def place_of(name: str, arm: Arm) -> Place:
    """An effect and where it acts (from 0), of `backlash:2`; everywhere without a number. Raises `InputError`."""
    effect, _, number = str(name).strip().partition(":")
    if effect not in EFFECTS:
        raise InputError("", "for_", f"there is no effect {shown(effect)}{nearest(effect, EFFECTS)}")
    if not number:
        return effect, ()
    if not number.isdigit() or not 1 <= int(number) <= arm.model.size:
        raise InputError("", "for_", f"{shown(name)} names no joint or link from 1 to {arm.model.size}")
    return effect, (int(number) - 1,)


def regions_of(
    given: Sequence[Mapping[str, Any] | tuple[Sequence[Quantity], Sequence[Quantity]]],
) -> tuple[Obstacle, ...]:
    """Regions as an arm file holds them; a pair of corners is a box."""
    entries = [item if isinstance(item, Mapping) else {"box": [list(corner) for corner in item]} for item in given]
    try:
        return read_avoid(Reader({"avoid": plain(entries)}, file=""))
    except InputError as error:
        raise InputError("", "avoid", f"{error.key.removeprefix('avoid')}: {error.message}") from None


def _payloads(quantities: Sequence[Quantity] | None, arm: Arm) -> tuple[float, ...]:
    if quantities is None:
        return tuple(dict.fromkeys((0.0, arm.model.payload.mass)))
    masses = tuple(dict.fromkeys(in_si(quantity, "mass", "payloads") for quantity in quantities))
    if not masses or any(mass < 0.0 for mass in masses):
        raise InputError("", "payloads", "needs masses that are not negative, e.g. '0 kg'")
    return masses


def _diagnosed(
    after: After,
    arm: Arm,
    progress: Progress | None,
    check: Callable[[Readings], object],
) -> DiagnosisResult | None:
    if after is None:
        return None
    if isinstance(after, MotionDiagnosis):
        raise InputError("", "after", "is of motion logs; a plan goes on from it with the instrument motion")
    read = after if isinstance(after, Diagnosis) else recordings_of(after, arm)
    there = read.found.recording if isinstance(read, Diagnosis) else read.found
    check(there)
    result = read.found if isinstance(read, Diagnosis) else lw.diagnose(arm, read, progress=progress).found
    assert isinstance(result, DiagnosisResult)
    return result


def _undecided(before: DiagnosisResult) -> tuple[Place, ...]:
    """The findings that have other names, and those; nothing where all is decided."""
    open_ = [finding for finding in before.findings if finding.alternatives]
    places = [
        (alternative.effect, alternative.at) for finding in open_ for alternative in (finding, *finding.alternatives)
    ]
    return tuple(dict.fromkeys((effect, tuple(number - 1 for number in at)) for effect, at in places))


def _scatter(before: DiagnosisResult) -> float:
    """What each component scatters by: the noise floor's, or what was declared; where nobody knows, what was found
    leaves no more than that, and is no less than what a tracker scatters by."""
    share = math.sqrt(before.recording.tip.shape[1])
    if before.noise_floor:
        return before.noise_floor / share
    return before.recording.sigma or max(before.rms_after / share, _NOISE)
