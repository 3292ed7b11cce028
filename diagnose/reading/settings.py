"""recording.yaml: what a recording's header cannot say - foreign names, the layout, sigma, what is a nuisance."""

from __future__ import annotations

import datetime
import math
import os
import re
from collections.abc import Mapping as MappingOf
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Literal, cast

from linkwright.core.arm.avoid.obstacle import Obstacle
from linkwright.core.arm.files.avoid import read_avoid
from linkwright.core.diagnose.instruments.instrument import Instrument
from linkwright.core.diagnose.instruments.observes import read_instrument
from linkwright.core.diagnose.instruments.registry import INSTRUMENTS
from linkwright.core.units.quantities import InputError, shown
from linkwright.core.units.reading import Mapping, load_yaml, read_text

from .motion_settings import MotionSettings, read_motion_settings
from .table import Layout

_WHOSE = ("chain", "minimize")  # keys of an arm's or a problem's file that happens to have the recording's name


Sides = Literal["columns", "from_order"]


@dataclass(frozen=True)
class ReadingSettings:
    """What recording.yaml says.

    `columns` maps our headers (`q1_deg`) to formulas of the file's columns; where it is given, further columns are
    taken for strangers unless their headers are ours with a unit. `ignore` names columns to pass over, `rows`
    comparisons that a row must meet to be read at all, `time_format` how a time stamp is written (strptime, or `iso`).
    `sigma` (m, of tilts alone rad) is the standard deviation of each component of the tip, `sigma_axes` those of a
    camera's three axes where they differ (`sigma` is their root mean square then), `sigma_angle` (rad) that of its
    turns about each. `sides` tells whence the sides of approach are known: from columns `dirN`, or from the order of
    the rows where each joint went straight from row to row. `seat` is the key `orientation`: free uses orientations,
    how the target is turned on the tool being free. `unit` says which arm of a type was recorded, `date` when (ISO
    8601: `2026-05-16`). `instrument` is what is observed, None where nobody said: the tip's place. `tip` is
    which of several arms on one torso it is of. `avoid` are regions out of which proposed poses keep the arm. `motion`
    is what they say of a motion log, None where they are of no such.
    """

    file: str = ""
    columns: MappingOf[str, str] = field(default_factory=lambda: MappingProxyType({}))
    ignore: tuple[str, ...] = ()
    rows: tuple[str, ...] = ()
    time_format: str | None = None
    sigma: float | None = None
    frame: Literal["known", "free"] = "known"
    tool: Literal["known", "free"] = "known"
    seat: Literal["unused", "free"] = "unused"
    sigma_angle: float | None = None
    sigma_axes: tuple[float, ...] | None = None
    sides: Sides = "columns"
    layout: Layout = field(default_factory=Layout)
    unit: str = ""
    date: str = ""
    instrument: Instrument | None = None
    tip: str = ""
    avoid: tuple[Obstacle, ...] = ()
    motion: MotionSettings | None = None

    @property
    def kinds(self) -> tuple[str, ...]:
        """What is observed, beside or in place of the tip's whole place: `along`, `tilt`, .., `motion`."""
        observed = () if self.instrument is None else self.instrument.kinds
        return observed if self.motion is None else (*observed, "motion")


def find_settings(recording: Path) -> Path | None:
    """The settings beside a recording: a file of its name, or recording.yaml in its folder."""
    if not recording.name:
        return None  # a folder, which is said where it is read
    beside = recording.with_suffix(".yaml")
    if beside != recording and os.path.isfile(beside) and not _of_another(beside):
        return beside
    common = recording.parent / "recording.yaml"
    return common if os.path.isfile(common) else None


_POSITIVE = "must be positive; leave it out where nobody knows it"


def content_of(path: Path | None) -> MappingOf[str, object]:
    """What a settings file holds, as YAML gives it; nothing without one."""
    return {} if path is None or _says_nothing(path) else load_yaml(path).content


def read_settings(path: Path | None) -> ReadingSettings:
    """The settings that a file holds, the defaults without one. Raises `InputError`."""
    if path is None:
        return ReadingSettings()
    if _says_nothing(path):
        return ReadingSettings(file=str(path))
    mapping = load_yaml(path)
    with mapping.reading():
        columns: dict[str, str] = {}
        if mapping.has("columns"):
            body = mapping.mapping("columns")
            columns = {name: _formula(body, name) for name in body.content}
        motion = read_motion_settings(mapping)
        instrument = read_instrument(mapping) if motion is None else None
        camera = instrument is not None and "camera" in instrument.kinds
        sigma, axes = (None, None) if motion is not None else _sigma(mapping, instrument, camera=camera)
        if mapping.has("sigma_angle") and not camera:
            raise mapping.error("sigma_angle", "goes with `observes: camera`; write that as well")
        angle = mapping.optional_quantity("sigma_angle", "angle")
        if angle is not None and angle <= 0.0:
            raise mapping.error("sigma_angle", _POSITIVE)
        free = ("known", "free")
        # Where a camera and its target are nobody knows as a rule: that is what the arm tells.
        usual = "free" if camera else "known"
        return ReadingSettings(
            file=str(path),
            columns=MappingProxyType(columns),
            ignore=_texts(mapping, "ignore"),
            rows=_texts(mapping, "rows"),
            time_format=_time_format(mapping),
            sigma=sigma,
            sigma_angle=angle,
            sigma_axes=axes,
            frame=cast(Literal["known", "free"], mapping.choice("frame", free, usual)),
            tool=cast(Literal["known", "free"], mapping.choice("tool", free, usual)),
            seat=cast(
                Literal["unused", "free"],
                mapping.choice("orientation", ("unused", "free"), "free" if camera else "unused"),
            ),
            sides=cast(Sides, mapping.choice("sides", ("columns", "from_order"), "columns")),
            layout=_layout(mapping),
            unit=_name(mapping, "unit"),
            date=_date(mapping),
            instrument=instrument,
            tip=_name(mapping, "tip"),
            avoid=read_avoid(mapping),
            motion=motion,
        )


def _kind_of_sigma(mapping: Mapping, instrument: Instrument | None) -> str:
    """What sigma is: a length, of tilts alone an angle (or what a level rises by in a metre, which is the same)."""
    kinds = () if instrument is None else instrument.kinds
    numbers = [number for kind in kinds for number in INSTRUMENTS[kind].numbers]
    tilts = bool(numbers) and all(number.quantity == "angle" for number in numbers)
    text = mapping.content.get("sigma")
    unit = text.split()[-1].lower() if isinstance(text, str) and text.split() else ""
    return "angle" if tilts and not unit.endswith(("m", "inch")) else "length"


def _sigma(
    mapping: Mapping, instrument: Instrument | None, *, camera: bool
) -> tuple[float | None, tuple[float, ...] | None]:
    """The standard deviation of a component, and those of a camera's axes where a list gives them."""
    axes = _sigma_axes(mapping)
    if axes is None:
        sigma = mapping.optional_quantity("sigma", _kind_of_sigma(mapping, instrument))
    elif not camera:
        raise mapping.error("sigma", "of each axis goes with `observes: camera`; write one length, or that as well")
    else:
        sigma = math.sqrt(sum(axis * axis for axis in axes) / len(axes))
    if sigma is not None and min(axes or (sigma,)) <= 0.0:
        raise mapping.error("sigma", _POSITIVE)
    return sigma, axes


def _sigma_axes(mapping: Mapping) -> tuple[float, ...] | None:
    """The standard deviations along a camera's axes (x, y, depth), m, where a list gives them."""
    if not mapping.has("sigma") or not isinstance(mapping.raw("sigma"), list):
        return None
    return tuple(mapping.vector("sigma", "length", 3))


def _of_another(path: Path) -> bool:
    return not _says_nothing(path) and any(key in load_yaml(path).content for key in _WHOSE)


def _says_nothing(path: Path) -> bool:
    """Whether a file holds blank lines and comments only; every key is optional."""
    text = read_text(path)
    return all(not line.strip() or line.lstrip().startswith("#") for line in text.splitlines())


def _formula(body: Mapping, name: str) -> str:
    """A formula; a column called `7` and a constant such as 0 are plain numbers in YAML."""
    raw = body.raw(name, 'a formula such as "Joint 1 [rad]*57.29578"')
    if isinstance(raw, bool) or not isinstance(raw, str | int | float) or not str(raw).strip():
        raise body.error(name, f'needs a formula such as "Joint 1 [rad]*57.29578", not {shown(raw)}')
    return " ".join(str(raw).split())


def _name(mapping: Mapping, name: str) -> str:
    """A text; a serial number may be a number in YAML."""
    if not mapping.has(name):
        return ""
    raw = mapping.raw(name)
    if isinstance(raw, bool) or not isinstance(raw, str | int) or not str(raw).strip():
        raise mapping.error(name, f'needs a text such as "serial 7", not {shown(raw)}')
    return " ".join(str(raw).split())


def _date(mapping: Mapping) -> str:
    text = _name(mapping, "date")
    try:
        return text and datetime.datetime.fromisoformat(text).date().isoformat()
    except ValueError:
        raise mapping.error("date", f"needs a date such as 2026-05-16, not {shown(text)}") from None


def _texts(mapping: Mapping, name: str) -> tuple[str, ...]:
    if not mapping.has(name):
        return ()
    raw = mapping.raw(name)
    entries = cast(list[object], raw) if isinstance(raw, list) else [raw]
    for entry in entries:
        if not isinstance(entry, str) or not entry.strip():
            raise mapping.error(name, f"needs a text or a list of texts, not {shown(entry)}")
    return tuple(" ".join(str(entry).split()) for entry in entries)


def _time_format(mapping: Mapping) -> str | None:
    if not mapping.has("time_format"):
        return None
    form = mapping.text("time_format")
    try:
        datetime.datetime.strptime("", form)
    except re.error:
        raise mapping.error("time_format", f"{shown(form)} names a part of the time twice") from None
    except ValueError as error:
        if "directive" in str(error) or "stray" in str(error):
            message = f"{shown(form)} is no format of times; e.g. iso, unix or '%d.%m.%Y %H:%M:%S'"
            raise mapping.error("time_format", message) from None
    return form


def _layout(mapping: Mapping) -> Layout:
    separator = None
    if mapping.has("separator"):
        raw = mapping.raw("separator")
        separator = {"tab": "\t", "comma": ",", "semicolon": ";", "blank": " "}.get(str(raw), str(raw))
        if len(separator) != 1 or separator in '"\r\n':
            raise mapping.error("separator", f"is one character, or tab, comma, semicolon, blank; not {shown(raw)}")
    decimal = mapping.choice("decimal", (".", ",")) if mapping.has("decimal") else ""
    if separator == decimal:
        raise mapping.error("decimal", "cannot be the separator as well")
    skip = mapping.integer("skip_rows", 0)
    if skip < 0:
        raise mapping.error("skip_rows", "counts the lines before the header; it cannot be negative")
    comment = mapping.text("comment") if mapping.has("comment") else None
    encoding = mapping.text("encoding", "utf-8") if mapping.has("encoding") else ""
    try:
        "x".encode(encoding or "utf-8")  # codecs that are none of text (hex, zlib) are unknown here
    except (LookupError, ValueError):
        raise InputError(mapping.file, "encoding", f"there is no encoding {shown(encoding)}; e.g. latin-1") from None
    names = _texts(mapping, "names")
    for name in names:
        if names.count(name) > 1:
            raise mapping.error("names", f"holds {shown(name)} twice")
    sheet, topics = mapping.text("sheet", ""), _texts(mapping, "topics")
    return Layout(separator, decimal, comment, skip, encoding, names, sheet, topics)
