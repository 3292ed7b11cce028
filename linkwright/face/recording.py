"""Recordings for programs: read from files or data frames, or made by a model."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from dataclasses import replace as replaced
from functools import partial
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any, Literal

from linkwright.core.arm.avoid.poses import NoRoom
from linkwright.core.arm.chain.chain import EffectEntry
from linkwright.core.arm.files.read import arm_from
from linkwright.core.diagnose.instruments.asked import observed_by
from linkwright.core.diagnose.instruments.instrument import LABELS
from linkwright.core.diagnose.plan.written import read_plan
from linkwright.core.diagnose.reading.read import read_recording as read_file
from linkwright.core.diagnose.reading.read import recording_from
from linkwright.core.diagnose.reading.read_back import unlike, unlike_settings
from linkwright.core.diagnose.reading.settings import find_settings, read_settings
from linkwright.core.diagnose.reading.table import table_of
from linkwright.core.diagnose.reading.write import label_columns, recording_columns, recording_text, settings_text
from linkwright.core.diagnose.recording import Recording as Found
from linkwright.core.diagnose.residual.visits import visits
from linkwright.core.diagnose.simulate import Plan
from linkwright.core.diagnose.simulate import Simulation as Made
from linkwright.core.diagnose.simulate import simulate as simulated
from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import InputError, shown
from linkwright.core.units.reading import Mapping as Reader
from linkwright.json.simulation import simulation_json
from linkwright.output.files import json_text, write_file
from linkwright.output.read_back import ReadBack

from .arm import Arm, arm_of, catalogue_of
from .given import File, Quantity, in_si, plain

if TYPE_CHECKING:
    import pandas as pd

_SIDES = ("both", "one", "random")
_MOST_ROWS = 2_000_000


@dataclass(frozen=True, repr=False)
class Recording:
    """Readings of a real arm, less the rows that were set aside; `found` holds everything in SI."""

    arm: Arm
    found: Found

    @property
    def table(self) -> pd.DataFrame:
        """The readings by the columns of a recording file (`q1_deg`, `x_mm`, ...); the index is the row in the file."""
        import pandas as pd

        columns: dict[str, Any] = {name: values for name, values, _ in recording_columns(self.found, self.arm.model)}
        columns |= dict(label_columns(self.found))
        return pd.DataFrame(columns, index=pd.Index(self.found.row, name="row"))

    @property
    def rejected(self) -> pd.DataFrame:
        """The rows that were set aside, and why."""
        import pandas as pd

        rows = [(each.row, each.reason) for each in self.found.rejected]
        return pd.DataFrame(rows, columns=["row", "reason"])

    @property
    def warnings(self) -> tuple[str, ...]:
        """Sentences on what was not used, and why."""
        return self.found.warnings

    def save(self, path: File) -> None:
        """Write the recording as CSV and its settings beside it, as `simulate --out` does, and read it back. Raises
        `InputError`."""
        place = Path(path)
        settings = place.with_suffix(".yaml")
        write_file(settings, settings_text(self.found))
        write_file(place, ReadBack(recording_text(self.found, self.arm.model), partial(self._unlike, settings)))

    def _unlike(self, settings: Path, path: Path) -> Iterator[str]:
        """What the recording that is read from a file says otherwise."""
        back = read_file(path, self.arm.model, settings)
        yield from unlike(self.found, back, self.arm.model)
        yield from unlike_settings(self.found, back)

    def _line(self) -> str:
        found, aside = self.found, len(self.found.rejected)
        set_aside = f", {aside} rows set aside" if aside else ""
        name = PurePath(found.file).name or "made by a model"
        return f"{name}, {found.size} readings{set_aside}, frame {found.frame}, tool {found.tool}"

    def __repr__(self) -> str:
        """One line."""
        return f"<{type(self).__name__}: {self._line()}>"

    def _repr_html_(self) -> str:
        """The line and the first readings, for a notebook."""
        import html

        return f"<p>{html.escape(repr(self)[1:-1])}</p>\n{self.table.head(10).to_html(border=0)}"


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
        place = Path(str(recording))
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
    return tuple(read_recording(each, given, settings=settings) for each in recordings)


@dataclass(frozen=True, repr=False)
class Simulation(Recording):
    """A recording that a model would give; `made` says what the physics moved the tip by, `plan` what was asked."""

    made: Made
    plan: Plan

    def to_json(self) -> str:
        """What `simulate --json` writes."""
        return json_text(simulation_json(self.made, self.arm.model, self.plan))


def simulate(
    arm: Arm | File,
    *,
    poses: int = 40,
    with_: Sequence[Mapping[str, Any]] = (),
    noise: Quantity = "15 um",
    repeats: int = 3,
    payloads: Sequence[Quantity] = (),
    sides: Literal["both", "one", "random"] = "both",
    temperature: tuple[Quantity, Quantity] | None = None,
    hours: float | None = None,
    seed: int = 1,
    frame_free: bool = False,
    outliers: float = 0.0,
    joint_side: bool = False,
    commands: bool = False,
    base_target: bool = False,
    orientation: bool = False,
    declare_sigma: bool = False,
    observe: str = "position",
    direction: Sequence[float] | None = None,
    anchor: Sequence[Quantity] | None = None,
    anchor_free: bool = False,
    tilt_link: str | int | None = None,
    bar: Sequence[Quantity] | None = None,
    camera: Literal["fixed", "on_tool"] | None = None,
    torques: Quantity | Sequence[Quantity] | None = None,
    at: File | None = None,
) -> Simulation:
    """A recording from a model, with noise and repeats: poses spread over the joint ranges.

    `with_` holds entries of an arm file's `effects` beside the arm's own. `noise` is the standard deviation of each
    component (text, or m), `payloads` masses (text, or kg), `temperature` from and to (text, or K), between which it
    wanders. `at` is a plan (or a recording), whose poses, sides, payloads and times are taken instead of `poses`,
    `repeats`, `payloads`, `sides`, `temperature` and `hours`. `sides`: joints arrive from both, one, or random ones.
    `outliers` is a share of readings. The same `seed` gives the same recording. `observe` says what is read: the
    `position`, some of its coordinates (`z`, `xy`), the height `along` a `direction`, or the `distance` from an
    `anchor` (lengths; `anchor_free`: the recording does not tell where it is), the `tilt` of a level on a `tilt_link`
    (`base`, or a link's number; its noise counts in a metre: 15 um are 15 urad), or that the `same_point` or `plane`
    was touched again, or a `bar` at places along it (lengths), or where a `camera` (`fixed`, or `on_tool`) sees a
    target: its depths are five times noisier, and its turns by the noise over 0.1 m. `torques` is what
    a drive's measured torque scatters by (text, or N m; one for each joint, of a slide a force): what each holds at
    rest is written then, without friction. Raises `InputError`, and `MissingProperty` where the arm lacks a figure.

    >>> import linkwright as lw
    >>> lw.simulate(
    ...     "examples/welding-arm/arm.yaml",
    ...     poses=5,
    ...     with_=[{"effect": "encoder_offset", "at": 2, "offset": "0.05 deg"}],
    ... )
    <Simulation: made by a model, 30 readings, frame known, tool known>
    """
    given = with_effects(arm_of(arm, tips="one"), with_)
    readings = None if at is None else read_plan(at, given.model)
    reads: dict[str, Any] = {
        "observe": observe, "direction": direction, "anchor": _lengths("anchor", anchor), "anchor_free": anchor_free,
        "tilt_link": tilt_link, "bar": _lengths("bar", bar), "camera": camera,
    }  # fmt: skip
    if at is not None and observe == "position":
        reads = _planned(Path(at), reads)
    if readings is not None and readings.bar_at is not None and reads["observe"] == "bar":
        reads["bar"] = sorted(set(readings.bar_at.tolist()))
    if readings is not None and reads["observe"] in LABELS and readings.instrument.kinds != (reads["observe"],):
        raise InputError("", "at", f"names nothing that is touched: it needs a {LABELS[reads['observe']]} in each row")
    plan = _plan(
        poses=poses if readings is None else int(visits(readings, given.model)[-1]) + 1,
        noise=in_si(noise, "length", "noise"),
        repeats=repeats if readings is None else 1,
        payloads=tuple(in_si(each, "mass", "payloads") for each in payloads),
        sides=sides,
        temperature=None if temperature is None else _span(temperature),
        hours=hours,
        seed=seed,
        free_frame=frame_free,
        outliers=outliers,
        joint_side=joint_side,
        commands=commands,
        base_target=base_target,
        orientation=orientation,
        torque_noise=torque_noise(torques, given),
        **observed_by(arm=given.model, **reads),
        at=readings,
    )
    try:
        made = simulated(given.model, plan)
    except NoRoom as error:
        raise InputError("", "avoid", str(error)) from None
    recording = plan.declared_in(made.recording) if declare_sigma else made.recording
    return Simulation(given, recording, made, plan)


def _planned(plan: Path, reads: dict[str, Any]) -> dict[str, Any]:
    """What a plan is for, as the settings beside it say, where a caller did not."""
    own = read_settings(find_settings(plan)).instrument
    if own is None or len(own.kinds) != 1 or own.kinds == ("position",):
        return reads
    kind = own.kinds[0]
    said: dict[str, Any] = {
        "direction": own.direction if kind == "along" else None,
        "anchor": own.anchor if kind == "distance" else None,
        "tilt_link": (own.tilt_link or "base") if kind == "tilt" else None,
        "camera": own.camera if kind == "camera" else None,
    }
    found = {name: reads[name] if said.get(name) is None or reads[name] is not None else said[name] for name in reads}
    free = reads["anchor_free"] or (kind == "distance" and own.anchor is None)
    return {**found, "observe": kind, "anchor_free": free}


def with_effects(arm: Arm, entries: Sequence[Mapping[str, Any]], *, as_in_files: bool = False) -> Arm:
    """The arm with further `effects` entries, those it holds taken as they are; `as_in_files`, where a number needs its
    unit. Raises `InputError`."""
    if not entries:
        return arm
    # The entries are read in the place of the arm's own, so that a mistake names them.
    content = {**arm.content, "effects": [each if as_in_files else plain(each) for each in entries]}
    reader = Reader(content, file="with_")
    added: tuple[EffectEntry, ...] = arm_from(reader, catalogue_of(arm.catalogue), tip=arm.model.tip).effects
    return Arm.of(replaced(arm.model, effects=(*arm.model.effects, *added)), catalogue=arm.catalogue)


def torque_noise(given: Quantity | Sequence[Quantity] | None, arm: Arm) -> tuple[float, ...]:
    """What each drive's torque scatters by (n,), N*m, of slides N: one for all, or one for each; nothing where none was
    given. Raises `InputError`."""
    if given is None:
        return ()
    joints = arm.model.joints
    each = [given] if isinstance(given, str | int | float) else list(given)
    if len(each) == 1 and all(joint.revolute for joint in joints):
        each = each * len(joints)
    if len(each) != len(joints):
        kinds = ", ".join("0.5 N*m" if joint.revolute else "5 N" for joint in joints)
        raise InputError("", "torques", f"needs one scatter for all joints that turn, or one for each joint: {kinds}")
    found = [
        in_si(value, "torque" if joint.revolute else "force", "torques")
        for value, joint in zip(each, joints, strict=True)
    ]
    if min(found) <= 0.0:
        raise InputError("", "torques", "must be positive")
    return tuple(found)


def _lengths(name: str, given: Sequence[Quantity] | None) -> list[float] | None:
    return None if given is None else [in_si(each, "length", name) for each in given]


def _span(temperature: tuple[Quantity, Quantity]) -> tuple[float, float]:
    low, high = (in_si(each, "temperature", "temperature") for each in temperature)
    return low, high


def _plan(**asked: Any) -> Plan:
    if asked["sides"] not in _SIDES:
        given = str(asked["sides"])
        raise InputError("", "sides", f"{shown(given)} is not one of {', '.join(_SIDES)}{nearest(given, _SIDES)}")
    if asked["noise"] < 0.0:
        raise InputError("", "noise", "cannot be negative")
    if any(mass < 0.0 for mass in asked["payloads"]):
        raise InputError("", "payloads", "cannot be negative")
    for key in ("poses", "repeats"):
        if asked[key] < 1:
            raise InputError("", key, f"needs at least 1, not {asked[key]}")
    if not 0.0 <= asked["outliers"] <= 0.5 or (asked["hours"] is not None and not asked["hours"] > 0.0):
        key = "hours" if 0.0 <= asked["outliers"] <= 0.5 else "outliers"
        raise InputError("", key, "must be positive" if key == "hours" else "is a share from 0 to 0.5")
    both = 2 if asked["sides"] == "both" else 1
    rows = asked["poses"] * asked["repeats"] * max(1, len(asked["payloads"])) * both
    if rows > _MOST_ROWS or not math.isfinite(rows):
        raise InputError("", "poses", f"would make {rows} rows; at most {_MOST_ROWS} are simulated")
    return Plan(**asked)
