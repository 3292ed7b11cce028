"""Recordings for programs: read from files or data frames, or made by a model."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from dataclasses import replace as replaced
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any

from linkwright.core.arm.avoid.poses import NoRoom
from linkwright.core.arm.chain.chain import EffectEntry
from linkwright.core.arm.files.read import arm_from
from linkwright.core.diagnose.columns.proposed_file import SETTINGS, Proposal
from linkwright.core.diagnose.instruments.observes import observed_by
from linkwright.core.diagnose.instruments.registry import INSTRUMENTS, labels
from linkwright.core.diagnose.plan.simulate import Plan
from linkwright.core.diagnose.plan.simulate import Simulation as Made
from linkwright.core.diagnose.plan.simulate import simulate as simulated
from linkwright.core.diagnose.plan.written import read_plan
from linkwright.core.diagnose.reading.files import table_of
from linkwright.core.diagnose.reading.foreign.proposal import IGNORED, Meaning
from linkwright.core.diagnose.reading.read import read_recording as read_file
from linkwright.core.diagnose.reading.read import recording_from
from linkwright.core.diagnose.reading.read_back import unlike, unlike_settings
from linkwright.core.diagnose.reading.settings import find_settings, read_settings
from linkwright.core.diagnose.reading.write import label_columns, recording_columns, recording_text, settings_text
from linkwright.core.diagnose.recording import Recording as RecordingResult
from linkwright.core.diagnose.residual.visits import visits
from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import InputError, format_quantity, shown
from linkwright.core.units.reading import Mapping as Reader
from linkwright.core.units.reading import load_yaml, parse_yaml
from linkwright.json.fields import fields
from linkwright.output.files import ReadBack, json_text, write_file
from linkwright.output.table_file import frame
from linkwright.results.document import Description, Item, Lines, Paragraph
from linkwright.results.document import table as shown_table

from .arm import Arm, arm_of, catalogue_of
from .plain_input import File, Quantity, in_si, path_of, plain
from .readings import Readings
from .result import Result, figure_of

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go

_SIDES = ("both", "one", "random")
_MOST_ROWS = 2_000_000
_SETTINGS = frozenset(
    {
        "sigma", "sigma_angle", "frame", "tool", "orientation", "observes", "tip",
    }
)  # fmt: skip
"""What settings of a simulated recording hold beside those of instruments."""


@dataclass(frozen=True, repr=False)
class Recording(Readings):
    """Readings of a real arm, less the rows that were set aside; `found` holds everything in SI."""

    arm: Arm
    found: RecordingResult

    @property
    def table(self) -> pd.DataFrame:
        """The readings by the columns of a recording file (`q1_deg`, `x_mm`, ...); the index is the row in the file."""
        import pandas as pd

        columns: dict[str, Any] = {name: values for name, values, _ in recording_columns(self.found, self.arm.model)}
        columns |= dict(label_columns(self.found))
        return pd.DataFrame(columns, index=pd.Index(self.found.row, name="row"))

    def save(self, path: File) -> Sequence[Path]:
        """Write the recording as CSV and its settings beside it, as `simulate --out` does, and read it back; gives
        which files. Raises `InputError`, also where settings of another's stand beside it."""
        text = recording_text(self.found, self.arm.model)
        return saved(path, text, settings_text(self.found), self._unlike)

    def _unlike(self, path: Path) -> Iterator[str]:
        """What the recording that is read from a file says otherwise."""
        back = read_file(path, self.arm.model, path.with_suffix(".yaml"))
        yield from unlike(self.found, back, self.arm.model)
        yield from unlike_settings(self.found, back)

    def _line(self) -> str:
        recording = self.found
        name = PurePath(recording.file).name or "made by a model"
        return f"{name}, {recording.size} readings{self._aside()}, frame {recording.frame}, tool {recording.tool}"


def read_recording(recording: File | pd.DataFrame, arm: Arm | File, *, settings: File | None = None) -> Recording:
    """The recording that a CSV, .xlsx or parquet file holds, or a data frame of the same columns, checked.

    `settings` is its recording.yaml; beside a file one of its name, or recording.yaml, counts by default. Rows that
    cannot be used are set aside with the reason. Raises `InputError` where nothing sensible can follow.

    >>> import linkwright as lw
    >>> arm = lw.read_arm("examples/hidden-backlash/arm.yaml")
    >>> rec = lw.read_recording("examples/hidden-backlash/recording.csv", arm)
    >>> rec
    <Recording: recording.csv, 192 readings, frame known, tool known>
    >>> lw.read_recording(rec.table, arm).found.size
    192
    """
    given = arm_of(arm, tips="first", unknown_origins=True)
    if isinstance(recording, str) or not hasattr(recording, "columns"):
        place = path_of(recording, "recording", "a DataFrame")
        return Recording(given, read_file(place, given.model, None if settings is None else Path(settings)))
    held = read_settings(None if settings is None else Path(settings))
    return Recording(given, recording_from(table_of(recording, "DataFrame"), given.model, held))  # pyright: ignore[reportArgumentType]


def read_recordings(
    recordings: Iterable[File | pd.DataFrame], arm: Arm | File, *, settings: File | None = None
) -> tuple[Recording, ...]:
    """Several recordings of one arm, each as `read_recording` reads it and with settings of its own.

    Raises `InputError`.

    >>> import linkwright as lw
    >>> folder = "examples/hidden-backlash"
    >>> files = [f"{folder}/recording.csv", f"{folder}/after-service.csv"]
    >>> [each.found.size for each in lw.read_recordings(files, f"{folder}/arm.yaml")]
    [192, 192]
    """
    given = arm_of(arm, tips="first", unknown_origins=True)
    return tuple(read_recording(recording, given, settings=settings) for recording in recordings)


@dataclass(frozen=True, repr=False)
class Simulation(Recording):
    """A recording that a model would give; `made` says what the physics moved the tip by, `plan` what was asked."""

    made: Made
    plan: Plan

    @property
    def _rms(self) -> float:
        return math.sqrt(float((self.made.error**2).sum(axis=1).mean()))

    @property
    def description(self) -> Description:
        """By how much the physics moves the tip, and what of it this recording cannot hold."""
        name, plan = self.arm.name, self.plan
        rms, scatter = (format_quantity(item, "length", digits=3) for item in (self._rms, plan.noise))
        what = f"the model moves the tip by {rms} RMS, noise {scatter} a component"
        idle = tuple(
            f"note: {item} moves nothing that this recording holds (linkwright effects show {item})"
            for item in dict.fromkeys(self.made.idle)
        )
        headline = f"{self.made.recording.size} readings of {plan.poses} poses; {what}"
        return Description(name, headline, (Lines(idle),) if idle else (), subject=f"{name}: ")

    def to_json(self) -> str:
        """What `simulate --json` writes."""
        content = {
            "arm": self.arm.name,
            "rows": self.made.recording.size,
            **fields(self.plan, "poses", "seed", "noise_mm"),
            "rms_error_mm": 1e3 * self._rms,
            "effects": [fields(effect, "effect", "at") for effect in self.arm.model.effects],
            **fields(self.made, "idle"),
        }
        return json_text(content)


def saved(path: File, text: str, settings: str | None, differs: Callable[[Path], Iterable[str]]) -> list[Path]:
    """Write a recording or log with its settings beside it, where it has any, and read it back (`ReadBack`); gives
    which files. Raises `InputError` where settings of another's stand there."""
    place = Path(path)
    beside = [] if settings is None else [settings_beside(place)]
    for file in beside:
        write_file(file, settings or "")
    write_file(place, ReadBack(text, differs))
    return [place, *beside]


def settings_beside(recording: Path) -> Path:
    """Where the settings of a recording stand that is to be written. Raises `InputError` where a YAML file is there
    that is not just a simulated recording's settings."""
    settings = recording.with_suffix(".yaml")
    if settings == recording:
        raise InputError(recording, "", "ends in .yaml; name a CSV file")
    known = _SETTINGS | {name for kind in INSTRUMENTS.values() for name in kind.settings}
    if os.path.isfile(settings) and not set(load_yaml(settings).content) <= known:
        message = "is there already and holds more than a simulation's settings; name another recording"
        raise InputError(settings, "", message)
    return settings


def settings_of(given: Mapping[str, Any] | Sequence[str]) -> Mapping[str, Any]:
    """Settings of an instrument by name; of `KEY=VALUE` numbers between commas, or text. Raises `InputError`."""
    if isinstance(given, Mapping):
        return given
    settings: dict[str, Any] = {}
    for text in given:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not equals or not name or not value:
            raise InputError("", "reads", f"needs KEY=VALUE such as 'beam=1, 0, 0', not {shown(text)}")
        try:
            settings[name] = [float(item) for item in value.split(",")]
        except ValueError:
            settings[name] = value
    return settings


def instrument_of(
    arm: Arm,
    at: File | None,
    observe: str,
    direction: Sequence[float] | None,
    anchor: Sequence[Quantity] | None,
    anchor_free: bool,
    tilt_link: str | int | None,
    bar: Sequence[Quantity] | None,
    camera: str | None,
    settings: Mapping[str, Any],
) -> dict[str, Any]:
    """What is read, and the readings of a plan or a recording that say where: fields of `Plan`. Raises `InputError`."""
    reads: dict[str, Any] = {
        "observe": observe, "direction": direction, "anchor": _lengths("anchor", anchor), "anchor_free": anchor_free,
        "tilt_link": tilt_link, "bar": _lengths("bar", bar), "camera": camera, "settings": settings,
    }  # fmt: skip
    if at is None:
        return observed_by(arm=arm.model, **reads)
    readings = read_plan(at, arm.model)
    if observe == "position":
        reads = _planned(Path(at), reads)
    if readings.bar_at is not None and reads["observe"] == "bar":
        reads["bar"] = sorted(set(readings.bar_at.tolist()))
    label = labels().get(reads["observe"])
    if label is not None and readings.instrument.kinds != (reads["observe"],):
        raise InputError("", "at", f"names nothing that is touched: it needs a {label} in each row")
    return {**observed_by(arm=arm.model, **reads), "at": readings}


def _planned(plan: Path, reads: dict[str, Any]) -> dict[str, Any]:
    """What a plan is for, as the settings beside it say, where a caller did not."""
    instrument = read_settings(find_settings(plan)).instrument
    if instrument is None or len(instrument.kinds) != 1 or instrument.kinds == ("position",):
        return reads
    kind = instrument.kinds[0]
    said = dict(INSTRUMENTS[kind].words(instrument))
    free = reads["anchor_free"] or bool(said.pop("anchor_free", False))
    known = {name: reads[name] if reads[name] is not None else value for name, value in said.items() if name in reads}
    further = {name: value for name, value in said.items() if name not in reads}
    return {**reads, **known, "settings": {**further, **reads["settings"]}, "observe": kind, "anchor_free": free}


def with_effects(arm: Arm, entries: Sequence[Mapping[str, Any] | str]) -> Arm:
    """The arm with further `effects` entries, those it holds taken as they are; an entry as text is one of a file,
    where a number needs its unit. Raises `InputError`."""
    if not entries:
        return arm
    # The entries are read in the place of the arm's own, so that a mistake names them.
    content = {**arm.content, "effects": [_entry(entry) for entry in entries]}
    reader = Reader(content, file="with_")
    added: tuple[EffectEntry, ...] = arm_from(reader, catalogue_of(arm.catalogue), tip=arm.model.tip).effects
    return Arm.of(replaced(arm.model, effects=(*arm.model.effects, *added)), catalogue=arm.catalogue)


def _entry(given: Mapping[str, Any] | str) -> Any:
    """An entry of `effects` as a file has it. Raises `InputError`."""
    entry = parse_yaml(given, file="with_") if isinstance(given, str) else plain(given)
    if not isinstance(entry, dict):
        example = "'{effect: joint_compliance, at: 2, compliance: 21 urad/(N*m)}'"
        raise InputError("", "with_", f"needs an entry such as {example}, not {given!r}")
    return entry


def torque_noise(given: Quantity | Sequence[Quantity] | None, arm: Arm) -> tuple[float, ...]:
    """What each drive's torque scatters by (n,), N*m, of slides N: one for all, or one for each; nothing where none was
    given. Raises `InputError`."""
    if given is None:
        return ()
    joints = arm.model.joints
    values = [given] if isinstance(given, str | int | float) else list(given)
    if len(values) == 1 and all(joint.revolute for joint in joints):
        values = values * len(joints)
    if len(values) != len(joints):
        kinds = ", ".join("0.5 N*m" if joint.revolute else "5 N" for joint in joints)
        raise InputError("", "torques", f"needs one scatter for all joints that turn, or one for each joint: {kinds}")
    noise = [
        in_si(value, "torque" if joint.revolute else "force", "torques")
        for value, joint in zip(values, joints, strict=True)
    ]
    if min(noise) <= 0.0:
        raise InputError("", "torques", "must be positive")
    return tuple(noise)


def _lengths(name: str, quantities: Sequence[Quantity] | None) -> list[float] | None:
    return None if quantities is None else [in_si(quantity, "length", name) for quantity in quantities]


def _span(temperature: tuple[Quantity, Quantity]) -> tuple[float, float]:
    low, high = (in_si(item, "temperature", "temperature") for item in temperature)
    return low, high


def masses_of(given: Sequence[Quantity]) -> tuple[float, ...]:
    """Payloads, kg. Raises `InputError`."""
    return tuple(in_si(item, "mass", "payloads") for item in given)


def plan_of(arm: Arm, reads: Mapping[str, Any], **asked: Any) -> Plan:
    """What to simulate. Raises `InputError`."""
    asked["noise"] = in_si(asked["noise"], "length", "noise")
    if asked["temperature"] is not None:
        asked["temperature"] = _span(asked["temperature"])
    if "at" in reads:
        asked |= {"poses": int(visits(reads["at"], arm.model)[-1]) + 1, "repeats": 1}
    if asked["sides"] not in _SIDES:
        sides = str(asked["sides"])
        raise InputError("", "sides", f"{shown(sides)} is not one of {', '.join(_SIDES)}{nearest(sides, _SIDES)}")
    if asked["noise"] < 0.0:
        raise InputError("", "noise", "cannot be negative")
    if any(mass < 0.0 for mass in asked["payloads"]):
        raise InputError("", "payloads", "cannot be negative")
    for key in ("poses", "repeats"):
        if asked[key] < 1:
            raise InputError("", key, f"needs at least 1, not {asked[key]}")
    if not 0.0 <= asked["outliers"] <= 0.5:
        raise InputError("", "outliers", "is a share from 0 to 0.5")
    if asked["hours"] is not None and not asked["hours"] > 0.0:
        raise InputError("", "hours", "must be positive")
    both = 2 if asked["sides"] == "both" else 1
    rows = asked["poses"] * asked["repeats"] * max(1, len(asked["payloads"])) * both
    if rows > _MOST_ROWS or not math.isfinite(rows):
        raise InputError("", "poses", f"would make {rows} rows; at most {_MOST_ROWS} are simulated")
    return Plan(**asked, **reads)


def simulated_by(arm: Arm, plan: Plan, *, declare_sigma: bool) -> Simulation:
    """The recording that an arm's model would give. Raises `InputError` where the arm has no room for it."""
    try:
        made = simulated(arm.model, plan)
    except NoRoom as error:
        raise InputError("", "avoid", str(error)) from None
    return Simulation(arm, plan.declared_in(made.recording) if declare_sigma else made.recording, made, plan)


def describe_columns(result: Proposal) -> Description:
    """The settings, and what is to be said of them."""
    name, kind = PurePath(result.file).name, "a motion log" if result.motion else "a recording"
    used = sum(meaning.named for meaning in result.meanings)
    reads = f", {result.reads}" if result.reads else ""
    headline = f"{name}: {kind}{reads}; {used} of {len(result.meanings)} columns tell of an arm"
    if result.doubts is not None:
        lines = tuple(f"{doubt.grade}: {doubt.text}" for doubt in result.doubts)
        said: Item = Lines(lines) if lines else Paragraph("Nothing is doubtful.")
        return Description(f"{name}: columns", headline, (said,), headline)
    rows = [(meaning.header, meaning.ours if meaning.named else "", _why(meaning)) for meaning in result.meanings]
    items: list[Item] = [Paragraph(result.wrong, "warning")] if result.wrong else []
    items.append(shown_table(("column", "is", ""), rows, first=60))
    if remarks := (*result.notes, *result.warnings):
        items.append(Lines(remarks))
    return Description(f"{name}: columns", headline, tuple(items), headline)


def _why(meaning: Meaning) -> str:
    return f"a guess {meaning.said}".strip() if meaning.guessed else meaning.said


@dataclass(frozen=True, repr=False)
class Columns(Result):
    """What the columns of a foreign file may mean for an arm, and the recording.yaml that says so."""

    _command = "columns"
    _describe = staticmethod(describe_columns)

    found: Proposal

    @property
    def settings(self) -> str:
        """The proposed recording.yaml."""
        return self.found.settings

    @property
    def table(self) -> pd.DataFrame:
        """A row for each column: its `column` in the file, what it `is` (empty: nothing of an arm), whether that is a
        `guess`, and `why`."""
        return frame(self._content()["columns"])

    def plot(self) -> go.Figure:
        """The table, as a figure."""
        rows = self.table
        cells = {"values": [rows[name].tolist() for name in rows.columns]}
        return figure_of({"data": [{"type": "table", "header": {"values": list(rows.columns)}, "cells": cells}]})

    def save(self, folder: File) -> Sequence[Path]:
        """Write the settings; into a folder as `recording.yaml`."""
        place = Path(folder)
        target = place / SETTINGS if place.is_dir() else place
        write_file(target, self.settings)
        return [target]

    def _content(self) -> Mapping[str, Any]:
        proposal = self.found
        columns = [
            {
                "column": meaning.header,
                "is": meaning.ours if meaning.named else "",
                "guess": meaning.guessed,
                "why": _why(meaning),
            }
            for meaning in proposal.meanings
            if meaning.what != IGNORED
        ]
        return {
            "file": proposal.file,
            "arm": proposal.arm,
            "observes": "motion" if proposal.motion else "position",
            "reads": proposal.reads,
            "wrong": proposal.wrong,
            "remedies": proposal.remedies,
            "columns": columns,
            "notes": [*proposal.notes, *proposal.warnings],
            "settings": proposal.settings,
            **({} if proposal.doubts is None else {"doubts": [vars(doubt) for doubt in proposal.doubts]}),
        }

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {"Columns": self.table}
