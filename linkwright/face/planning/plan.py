"""Which poses, payloads and sides are worth recording, and what they will show."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from linkwright.core.arm.avoid.poses import NoRoom, room_of
from linkwright.core.arm.avoid.regions import Region
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.files.avoid import read_avoid
from linkwright.core.diagnose.instruments.asked import observed_by
from linkwright.core.diagnose.instruments.instrument import LABELS, Instrument
from linkwright.core.diagnose.plan.asked import INSTRUMENTS, Asked, Place, seen_axes
from linkwright.core.diagnose.plan.planned import Planned
from linkwright.core.diagnose.plan.planning import NothingToSee
from linkwright.core.diagnose.plan.planning import plan as planned
from linkwright.core.diagnose.plan.tried import TooFewPostures
from linkwright.core.diagnose.plan.written import ALONG_BAR, READ, plan_text, read_plan
from linkwright.core.diagnose.reading.read_back import unlike
from linkwright.core.diagnose.reading.write import settings_text
from linkwright.core.diagnose.recording import Recording as Readings
from linkwright.core.diagnose.result import Diagnosis as Found
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.diagnose.several.recordings import Several
from linkwright.core.diagnose.simulate import Plan as Noise
from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import InputError, NoAnswer, shown
from linkwright.core.units.reading import Mapping as Reader
from linkwright.face.arm import Arm, arm_of
from linkwright.face.diagnosis import Diagnosis, diagnose, recordings_of
from linkwright.face.given import File, Quantity, in_si, plain
from linkwright.face.progress import Progress, interrupts, told
from linkwright.face.recording import Recording, recording_columns, torque_noise
from linkwright.face.result import Result, figure_of
from linkwright.json.planning import plan_json
from linkwright.output.files import write_file
from linkwright.output.read_back import ReadBack
from linkwright.results.planning import cause

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go

_NOISE = 15e-6
_MOST_POSES, _MOST_READINGS = 500, 5000


@dataclass(frozen=True, repr=False)
class Plan(Result):
    """Readings to take, in their order, and what they will show; `found` holds everything in SI."""

    _command = "plan"

    arm: Arm
    found: Planned

    @property
    def interrupted(self) -> bool:
        """Whether Ctrl-C ended the choice; this is the best plan until then."""
        return self.found.interrupted

    @property
    def visits(self) -> pd.DataFrame:
        """A row for each visit by the columns of a recording: `q1_deg`, `dir1`, `payload_kg`, ..."""
        import pandas as pd

        visits = self.found.visits
        columns: dict[str, Any] = {
            name: values for name, values, _ in recording_columns(visits, self.arm.model) if name not in READ
        }
        return pd.DataFrame(columns, index=pd.RangeIndex(1, visits.size + 1, name="visit"))

    @property
    def shown(self) -> pd.DataFrame:
        """The smallest size of each cause that will be seen, in `unit`, and what poses at random show (nan: nothing);
        from which size on it is told from other causes, and how many it is not told from."""
        import pandas as pd

        keys = ("effect", "at", "parameter", "unit", "usual", "smallest", "random", "told_from", "not_told")
        rows = [{**{key: each[key] for key in keys[:-1]}, "not_told": len(each["not_told"])} for each in self._shown]
        return pd.DataFrame(rows, columns=list(keys))

    @property
    def _shown(self) -> list[dict[str, Any]]:
        return self._content()["shown"]

    def text(self) -> str:
        """The plan as CSV: a recording whose tip is still blank."""
        held = bool(self.found.asked.torque_noise)
        return plan_text(self.found.recording, self.arm.model, self.found.axes, torques=held)

    @property
    def settings(self) -> str | None:
        """What stands beside a plan as recording.yaml: of heights or distances what reads them, of several arms on one
        torso whose tip it is; None where it need not."""
        return settings_text(self.found.recording) if self.found.asked.slots or self.arm.model.branches else None

    def save(self, folder: File) -> None:
        """Write the plan as CSV, and beside it what it reads where that is no place, as `plan --out` does. Raises
        `InputError`."""
        if self.settings is not None:
            write_file(Path(folder).with_suffix(".yaml"), self.settings)
        write_file(Path(folder), ReadBack(self.text(), self._unlike))

    def _unlike(self, path: Path) -> Iterator[str]:
        """What the plan that is read from a file says otherwise; what it leaves blank says nothing."""
        back = read_plan(path, self.arm.model)
        return unlike(self.found.recording, back, self.arm.model, without=(*READ, *LABELS.values(), ALONG_BAR))

    def plot(self) -> go.Figure:
        """The smallest size of each cause over what is usual at most: this plan, and poses at random."""
        found = self.found.promise.shown
        names = [cause(each.effect, each.at) for each in found]
        random = [self.found.at_random(each) for each in found]
        bars = [
            {"type": "bar", "name": "planned", "x": names, "y": [each.smallest / each.usual for each in found]},
            {
                "type": "bar",
                "name": "at random",
                "x": names,
                "y": [
                    size / each.usual if math.isfinite(size) else None for size, each in zip(random, found, strict=True)
                ],
            },
        ]
        axis = {"title": {"text": "smallest size over what is usual"}, "type": "log"}
        return figure_of({"data": bars, "layout": {"yaxis": axis}})

    def _content(self) -> Mapping[str, Any]:
        return plan_json(self.found)

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {"Shown": self.shown, "Visits": self.visits}


def plan(
    arm: Arm | File,
    *,
    poses: int = 30,
    for_: Iterable[str] = (),
    instrument: str = "tracker",
    sigma: Quantity | None = None,
    repeats: int = 3,
    payloads: Sequence[Quantity] | None = None,
    frame: Literal["known", "free"] = "known",
    tool: Literal["known", "free"] = "known",
    avoid: Sequence[Mapping[str, Any] | tuple[Sequence[Quantity], Sequence[Quantity]]] = (),
    after: Recording | Diagnosis | File | Sequence[Recording | File] | None = None,
    direction: Sequence[float] | None = None,
    anchor: Sequence[Quantity] | None = None,
    anchor_free: bool = False,
    tilt_link: str | int | None = None,
    camera: Literal["fixed", "on_tool"] | None = None,
    bar: Sequence[Quantity] | None = None,
    bars: int | None = None,
    sigma_depth: Quantity | None = None,
    sigma_angle: Quantity | None = None,
    torques: Quantity | Sequence[Quantity] | None = None,
    seed: int = 1,
    progress: Progress | None = None,
) -> Plan:
    """What to record, so that causes are seen small and told apart: `poses` visits of `repeats` readings each.

    `for_` names effects (`"backlash"`, or `"backlash:2"` at one joint or link); none: all that a diagnosis can seek.
    `instrument` sees x, y and z (`tracker`), or some of them (`z`, `xy`), the height `along` a `direction`, or the
    `distance` from an `anchor` (lengths; with `anchor_free` it stands about there, and nobody knows just where), each
    with a scatter of `sigma` (text, or m; 15 um, or what the recording `after` scatters by; that recording's
    instrument is taken). So it sees the `tilt` of a level on a `tilt_link` (`"base"`, or a link's number), whose
    `sigma` is an angle (15 urad), or where a `camera` (`"fixed"`, or `"on_tool"`) sees a target: `sigma` is what
    that scatters by across its view, `sigma_depth` in depth (five times that), `sigma_angle` in turns (that over
    0.1 m), and where camera and target are is found along. And it plans to touch the `same_point` (a ball in a
    socket) or a `plane` again in several postures, places that nobody need know exactly, or places along a `bar`
    (lengths: `["0 mm", "500 mm"]` are its ends), which lies anywhere, in `bars` places (1: it is fixed; by default one
    for every six visits). `torques`, what a drive's
    measured torque scatters by (text, or N m; one for each joint, of a slide a force), reads those as well: what
    they will tell of weights and friction is planned for beside the causes. `payloads` are masses (text, or kg); by
    default none and the arm's own.
    `avoid` holds regions as an arm file does (`{"below": {"z": "0 mm"}}`), or boxes by two corners (text, or m), in
    the base frame, beside those of the arm file and of what it goes on from; where nobody says any, a plan `after` a
    recording stays in the box in which that has the joints and the tip. `after` is a recording that is there
    already, or several, or their diagnosis: what that could not tell apart is planned for, with frame and tool free
    where they were. The same `seed` gives the same plan. Ctrl-C, once there are as many visits as asked for, ends the
    choice with the best so far, marked `interrupted`. Of several arms on one torso it is for the tip that the arm was
    read for (`read_arm(..., tip=)`), with poses of the others chosen too.
    Raises `InputError`, `MissingProperty`, and `NoAnswer` where nothing of what is asked for can be seen.

    >>> import linkwright as lw
    >>> found = lw.plan("examples/welding-arm/arm.yaml", poses=10, for_=["backlash:2"], repeats=2)
    >>> len(found.visits), list(found.shown["effect"])
    (10, ['backlash'])
    """
    given = arm_of(arm, tips="one")
    effects = tuple(_place(name, given) for name in for_)
    least = RULES.search.least_visits
    if not least <= poses <= _MOST_POSES:
        raise InputError("", "poses", f"is from {least} (fewer tell nothing) to {_MOST_POSES}, not {poses}")
    if repeats < 1 or poses * repeats > _MOST_READINGS:
        raise InputError("", "repeats", f"is at least 1, and {_MOST_READINGS} readings in all at most, not {repeats}")
    if instrument not in INSTRUMENTS:
        hint = nearest(instrument, list(INSTRUMENTS))
        raise InputError("", "instrument", f"{shown(instrument)} is not one of {', '.join(INSTRUMENTS)}{hint}")
    for key, value in (("frame", frame), ("tool", tool)):
        if value not in ("known", "free"):
            raise InputError("", key, f"is known or free, not {shown(value)}")
    many = _bars(bars, instrument, poses)
    regions = _avoid(avoid)
    masses = _payloads(payloads, given)
    held = torque_noise(torques, given)
    _refuse_unknown_weights(held, given)
    try:
        seen_axes(instrument, given.model)
    except ValueError as error:
        raise InputError("", "instrument", str(error)) from None

    def reading(there: Readings | None) -> _Reads:
        said = _Reads(instrument, direction, anchor, anchor_free, tilt_link, camera, bar)
        found = _reading(said, given, there)
        _refuse_free(found.instrument, frame, tool)
        return _with_noise(found, there, sigma, sigma_depth, sigma_angle)

    if after is None:
        reading(None)
    before = _diagnosed(after, given, progress, reading)
    apart = () if before is None or effects else _undecided(before)
    if before is not None:
        # The instrument that is there stays where it stands.
        frame = "free" if before.recording.frame == "free" else frame
        tool = "free" if before.recording.tool == "free" else tool
    reads = reading(None if before is None else before.recording)
    noise = reads.sigma or (_NOISE if before is None else _scatter(before))
    if reads.instrument == "camera":
        # Where camera and target are nobody knows: that is what the arm tells.
        frame = tool = "free"
    recorded = None if before is None else before.recording
    regions = (*regions, *(() if recorded is None else recorded.avoid))
    room = room_of(given.model, None if recorded is None else recorded.q, regions)
    asked = Asked(
        poses, effects or apart, reads.instrument, noise, repeats, masses, frame, tool, room, seed,
        pairs_only=bool(apart), camera_noise=reads.of_camera(noise), torque_noise=held, bars=many, **reads.asked,
    )  # fmt: skip
    with told(progress) as hear, interrupts() as check:

        def heard(text: str, share: float) -> None:
            check()
            hear(text, share)

        try:
            found = planned(given.model, asked, heard, recorded)
        except NothingToSee:
            raise NoAnswer("nothing of what is asked for moves anything that this instrument sees") from None
        except TooFewPostures as error:
            raise InputError("", "instrument", f"{shown(reads.instrument)} {error}") from None
        except NoRoom as error:
            raise InputError("", "avoid", str(error)) from None
    return Plan(given, found)


@dataclass(frozen=True)
class _Reads:
    """What an instrument reads, in a caller's words; `asked` is that as a plan is asked for, `sigma` its scatter (None:
    nobody said), `deep` and `turns` those of a camera's depths and turns."""

    instrument: str
    direction: Sequence[float] | None
    anchor: Sequence[Quantity] | None
    anchor_free: bool
    tilt_link: str | int | None
    camera: Literal["fixed", "on_tool"] | None
    bar: Sequence[Quantity] | None
    asked: Mapping[str, Any] = field(default_factory=dict[str, Any])
    sigma: float | None = None
    deep: float | None = None
    turns: float | None = None

    def of_camera(self, sigma: float) -> tuple[float, float]:
        """The scatter of a camera's depths (m) and turns (rad) where that across its view is `sigma`."""
        usual = Noise(1, noise=sigma).of_camera
        return self.deep or usual[0], self.turns or usual[1]


_OWN = (("direction", "along"), ("anchor", "distance"), ("tilt_link", "tilt"), ("camera", "camera"), ("bar", "bar"))
"""What says how an instrument reads, and the instrument that it goes with."""
_TOUCHES = ("same_point", "plane")


def _reading(said: _Reads, arm: Arm, before: Readings | None) -> _Reads:
    """The instrument, and what says how it reads: as asked, or as the recording before did."""
    there = None if before is None else _instrument_of(before, said.instrument)
    if before is not None and there is not None:
        said = _of_before(said, there, before)
    instrument = said.instrument
    for name, kind in _OWN:
        if getattr(said, name) is not None and instrument != kind:
            raise InputError("", name, f"goes with the instrument {kind}, not {shown(instrument)}")
    if said.anchor_free and instrument != "distance":
        raise InputError("", "anchor_free", f"goes with the instrument distance, not {shown(instrument)}")
    if instrument not in (*dict(_OWN).values(), *_TOUCHES):
        return said
    seen_axes(instrument, arm.model)
    at = None if said.anchor is None else [in_si(each, "length", "anchor") for each in said.anchor]
    found = observed_by(
        instrument,
        said.direction,
        at,
        arm.model,
        anchor_free=said.anchor_free,
        tilt_link=said.tilt_link,
        camera=said.camera,
        bar=None if said.bar is None else [in_si(each, "length", "bar") for each in said.bar],
    )
    own: Instrument = found["instrument"]
    if arm.model.planar() and own.direction is not None and not any(own.direction[:2]):
        raise InputError("", "direction", "is out of the plane in which the arm moves; name one within it")
    asked = {"slots": found["slots"], "reads": own, "anchor_free": said.anchor_free, "bar": found.get("bar", ())}
    return replace(said, asked=asked)


def _of_before(said: _Reads, there: Instrument, before: Readings) -> _Reads:
    """What is said, and otherwise what the instrument that is there already tells."""
    kind = there.kinds[0]
    if kind == "distance" and said.anchor is None and there.anchor is None:
        raise InputError("", "anchor", "is missing: the recording does not tell where it is; say about where")
    link, camera = there.tilt_link or "base", there.camera
    for name, given, own in (("tilt_link", said.tilt_link, link), ("camera", said.camera, camera)):
        if given is not None and kind == dict(_OWN)[name] and str(given) != str(own):
            raise InputError("", name, f"is {own} in the recording to go on from, not {shown(given)}")
    return replace(
        said,
        instrument=kind,
        direction=said.direction or there.direction,
        anchor=said.anchor or there.anchor,
        anchor_free=said.anchor_free or (kind == "distance" and there.anchor is None),
        tilt_link=link if kind == "tilt" else said.tilt_link,
        camera=camera if kind == "camera" else said.camera,
        bar=said.bar if kind != "bar" or said.bar is not None else _places_along(before),
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
    said: _Reads, before: Readings | None, sigma: Quantity | None, deep: Quantity | None, turns: Quantity | None
) -> _Reads:
    """The same with what it scatters by, as far as anybody said."""
    camera = said.instrument == "camera"
    kind = "angle" if said.instrument == "tilt" else "length"
    found: dict[str, float | None] = {}
    for name, given, of in (("sigma", sigma, kind), ("sigma_depth", deep, "length"), ("sigma_angle", turns, "angle")):
        if given is not None and name != "sigma" and not camera:
            raise InputError("", name, f"goes with the instrument camera, not {shown(said.instrument)}")
        found[name] = value = None if given is None else in_si(given, of, name)
        if value is not None and value <= 0.0:
            raise InputError("", name, "must be positive")
    across, depth, angle = found["sigma"], found["sigma_depth"], found["sigma_angle"]
    if camera and before is not None:
        each = before.each[0] if isinstance(before, Several) else before
        if before.orientation is None:
            raise InputError("", "after", f"{before.file} holds no orientations; a plan for a camera needs them")
        axes, angle = each.sigma_axes, angle or each.sigma_angle
        across, depth = across or (axes[0] if axes else None), depth or (axes[2] if axes else None)
        if across is None:
            raise InputError("", "sigma", f"is missing: {before.file} does not declare what its camera scatters by")
    return replace(said, sigma=across, deep=depth, turns=angle)


def _refuse_unknown_weights(torques: Sequence[float], arm: Arm) -> None:
    """What torques tell of weights is foreseen from the arm file's."""
    links = enumerate(arm.model.links, start=1)
    none = [str(number) for number, link in links if link.section is None and link.mass is None]
    if torques and none:
        said = f"needs the mass of each link; give one to link{'s' * (len(none) > 1)} {', '.join(none)}"
        raise InputError("", "torques", said)


def _refuse_free(instrument: str, frame: str, tool: str) -> None:
    """A level minds neither where a frame stands nor where a target sits, touches have no frame."""
    for name, given in (("frame", frame), ("tool", tool)):
        if instrument == "tilt" and given == "free":
            raise InputError("", name, "goes with an instrument that reads the tip's place; a level does not see it")
        if instrument in (*_TOUCHES, "bar") and given == "free" and name == "frame":
            raise InputError("", name, "goes with an instrument that reads the tip's place; touches are in no frame")


def _instrument_of(recording: Readings, instrument: str) -> Instrument | None:
    """The instrument of heights, distances, tilts, touches or a camera that a recording was made with, None of the
    tip's place.
    Raises `InputError` for others, and where another one is asked for."""
    each = recording.each if isinstance(recording, Several) else (recording,)
    if recording.slots is None:
        if instrument in (*dict(_OWN).values(), *_TOUCHES):
            raise InputError("", "after", f"{recording.file} holds the tip's place; its own instrument goes on from it")
        return None
    kinds = {one.instrument.kinds for one in each}
    if not kinds <= {(kind,) for kind in (*dict(_OWN).values(), *_TOUCHES)} or len(kinds) > 1:
        said = "is not of one instrument that a plan goes on from: the tip's place, heights, distances, tilts, a camera"
        said += ", touches of points, planes or bars"
        raise InputError("", "after", f"{recording.file} {said}")
    if instrument not in ("tracker", each[0].instrument.kinds[0]):
        raise InputError("", "after", f"{recording.file} holds its {each[0].instrument.kinds[0]}, not {instrument}")
    return each[0].instrument


def _place(name: str, arm: Arm) -> Place:
    effect, _, number = str(name).strip().partition(":")
    if effect not in EFFECTS:
        raise InputError("", "for_", f"there is no effect {shown(effect)}{nearest(effect, list(EFFECTS))}")
    if not number:
        return effect, ()
    if not number.isdigit() or not 1 <= int(number) <= arm.model.size:
        raise InputError("", "for_", f"{shown(name)} names no joint or link from 1 to {arm.model.size}")
    return effect, (int(number) - 1,)


def _avoid(given: Sequence[Mapping[str, Any] | tuple[Sequence[Quantity], Sequence[Quantity]]]) -> tuple[Region, ...]:
    """Regions as an arm file holds them; a pair of corners is a box."""
    entries = [each if isinstance(each, Mapping) else {"box": [list(corner) for corner in each]} for each in given]
    try:
        return read_avoid(Reader({"avoid": plain(entries)}, file=""))
    except InputError as error:
        raise InputError("", "avoid", f"{error.key.removeprefix('avoid')}: {error.message}") from None


def _payloads(given: Sequence[Quantity] | None, arm: Arm) -> tuple[float, ...]:
    if given is None:
        return tuple(dict.fromkeys((0.0, arm.model.payload.mass)))
    masses = tuple(dict.fromkeys(in_si(each, "mass", "payloads") for each in given))
    if not masses or any(mass < 0.0 for mass in masses):
        raise InputError("", "payloads", "needs masses that are not negative, e.g. '0 kg'")
    return masses


def _diagnosed(
    after: Recording | Diagnosis | File | Sequence[Recording | File] | None,
    arm: Arm,
    progress: Progress | None,
    check: Callable[[Readings], object],
) -> Found | None:
    if after is None:
        return None
    read = after if isinstance(after, Diagnosis) else recordings_of(after, arm)
    there = read.found.recording if isinstance(read, Diagnosis) else read.found
    check(there)
    return read.found if isinstance(read, Diagnosis) else diagnose(arm, read, progress=progress).found


def _undecided(before: Found) -> tuple[Place, ...]:
    """The findings that have other names, and those; nothing where all is decided."""
    open_ = [each for each in before.findings if each.alternatives]
    places = [(each.effect, each.at) for finding in open_ for each in (finding, *finding.alternatives)]
    return tuple(dict.fromkeys((effect, tuple(number - 1 for number in at)) for effect, at in places))


def _scatter(before: Found) -> float:
    """What each component scatters by: the noise floor's, or what was declared."""
    if before.noise_floor:
        return before.noise_floor / math.sqrt(before.recording.tip.shape[1])
    return before.recording.sigma or _NOISE
