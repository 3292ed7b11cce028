"""Several recordings as one: readings one after the other, each knowing the recording that it is from."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import PurePath
from types import MappingProxyType
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.diagnose.instruments.registry import kinds_of
from linkwright.core.diagnose.instruments.split import as_scalars
from linkwright.core.diagnose.motion.log import MotionLog
from linkwright.core.diagnose.recording import Earlier, Recording, RejectedRow
from linkwright.core.diagnose.rules.residual_rules import ResidualRules
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.sections.numeric import Array
from linkwright.core.units.lists import rows_text
from linkwright.core.units.quantities import InputError

from .sessions import earlier, gone_on_from

_PAUSE = 0.05
"""The share of all that was recorded by which the clocks of two recordings are set apart."""


@dataclass(frozen=True)
class Several(Recording):
    """The readings of R recordings of one arm (or of arms of one type, `units`), one recording after the other.

    `source` (N,) is the recording (from 0) that a reading is from, `each` the recordings themselves: their frame, tool,
    declared sigma and file count, their readings are here. `row` numbers all readings of all files through (see
    `place_of`); `time` runs on from one recording to the next, `began` (R,) is where each clock starts, s. `before`
    (R,) is the recording that each goes on from, None where it begins anew. `frame` and `tool` are free where any
    recording's is.
    """

    source: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    each: tuple[Recording, ...] = ()
    first_row: tuple[int, ...] = ()
    began: tuple[float, ...] = ()
    before: tuple[int | None, ...] = ()

    @property
    def which(self) -> NDArray[np.int64]:
        """The recording (N,), from 0, that each reading is from."""
        return self.source

    @property
    def singles(self) -> tuple[Recording, ...]:
        """The recordings themselves."""
        return self.each

    def parts(self) -> tuple[Recording, ...]:
        """The recordings with the readings that are left of each, on clocks of their own, and what they know of those
        that they go on from."""
        parts = [self._part(index) for index in range(len(self.each))]
        return tuple(replace(part, earlier=self._earlier(parts, index)) for index, part in enumerate(parts))

    def _earlier(self, parts: Sequence[Recording], index: int) -> Earlier | None:
        chain: list[int] = []
        at = self.before[index] if self.before else None
        while at is not None:
            chain.insert(0, at)
            at = self.before[at]
        start_here = self.each[index].started
        runs = [
            (parts[k], start - start_here)
            for k in chain
            if (start := parts[k].started) is not None and start_here is not None
        ]
        runs = [(part, start) for part, start in runs if part.size]
        return earlier([part for part, _ in runs], [start for _, start in runs]) if runs else None

    def _part(self, index: int) -> Recording:
        rows, recording = self.which == index, self.each[index]
        taken: dict[str, Array | NDArray[np.int64] | None] = {}
        for name in _COLUMNS:
            values = getattr(self, name)
            taken[name] = None if values is None else values[rows]
        if self.time is not None:
            taken["time"] = self.time[rows] - self.began[index]
        other = MappingProxyType({name: values[rows] for name, values in self.other.items()})
        return replace(recording, **taken, other=other, seat=self.seat)  # pyright: ignore[reportArgumentType]

    def place_of(self, row: int) -> tuple[int, int]:
        """The recording (from 0) and the row in its file of a reading by its number in `row`."""
        index = int(np.searchsorted(self.first_row, row, side="right")) - 1
        return index, row - self.first_row[index] + 1

    def of_parts(self, parts: Sequence[Recording], arm: Arm, rules: ResidualRules) -> Several:
        """Other `parts` together, called and numbered as these are."""
        names, first_row = self.names, self.first_row
        return together(parts, arm, units=self.units, names=names, first_row=first_row, rules=rules)

    def rows_of(self, rows: Sequence[int]) -> str:
        """Readings by their numbers in `row`, as words."""
        texts: list[str] = []
        for index, name in enumerate(self.names):
            rows_here = [at for where, at in map(self.place_of, rows) if where == index]
            texts += [f"{rows_text(rows_here)} of {name}"] if rows_here else []
        return ", ".join(texts)


_COLUMNS = (
    "q", "tip", "row", "orientation", "time", "sides", "payload_mass", "temperature", "link_temperature", "velocity",
    "acceleration", "commanded", "last_moves", "joint_side", "torque", "force", "moment", "base_target", "slots",
    "touches", "bar_at",
)  # fmt: skip


def names_of(recordings: Sequence[Recording | MotionLog]) -> tuple[str, ...]:
    """What to call each recording: its unit, date or both where these tell them apart, else its file's name."""
    count = len(recordings)
    for said in (
        [recording.unit for recording in recordings],
        [recording.date for recording in recordings],
        [
            f"{recording.unit} of {recording.date}" if recording.unit and recording.date else ""
            for recording in recordings
        ],
        [PurePath(recording.file).name for recording in recordings],
        [recording.file for recording in recordings],
    ):
        if all(said) and len(set(said)) == count:
            return tuple(said)
    return tuple(f"recording {number}" for number in range(1, count + 1))


def together(
    recordings: Sequence[Recording],
    arm: Arm,
    *,
    units: bool = False,
    first_row: Sequence[int] | None = None,
    names: Sequence[str] | None = None,
    rules: ResidualRules = RULES.residual,
) -> Several:
    """Recordings of one arm as one. What only some of them hold counts where it is sure what the others would hold
    (the arm file's payload, no force, no known side, standing still, 20 degC); else it is left out, and said.

    `first_row` says with which number the rows of each file begin (by default so that none has two), `names` what they
    are called.
    """
    names = tuple(names or names_of(recordings))
    recordings = _alike([_with_payload(recording, arm, recordings) for recording in recordings])
    width = min(recording.tip.shape[1] for recording in recordings)
    notes: list[str] = []
    counts = [recording.size for recording in recordings]
    columns = _Columns(names, recordings, notes)
    column = columns.joined
    size = arm.size
    still: Callable[[int], Array] = lambda count: np.zeros((count, size))  # noqa: E731
    seats = {recording.seat for recording in recordings}
    seat: Literal["unused", "free"] = "free" if seats == {"free"} else "unused"
    orientation = column("orientation", None, "orientations") if seat == "free" else None
    starts = _through(recordings) if first_row is None else tuple(first_row)
    rows = [recording.row + start - 1 for recording, start in zip(recordings, starts, strict=True)]
    time, began = _clocks(recordings)
    before = gone_on_from(recordings, rules=rules)
    notes += _of_clocks(names, recordings, time, before)
    common = set.intersection(*(set(recording.other) for recording in recordings))
    return Several(
        file=_files(names, recordings),
        q=np.concatenate([recording.q for recording in recordings]),
        tip=np.concatenate([recording.tip[:, :width] for recording in recordings]),
        row=np.concatenate(rows),
        orientation=orientation,
        time=time,
        sides=column("sides", still, "the sides of approach", "they are unknown"),
        payload_mass=column(
            "payload_mass", lambda count: np.full(count, arm.payload.mass), "the payload", "the arm file's counts"
        ),
        temperature=column(
            "temperature", lambda count: np.full(count, arm.temperature), "the temperature", "the arm file's counts"
        ),
        link_temperature=column("link_temperature", None, "temperatures of the links"),
        velocity=column("velocity", still, "velocities", "the arm is taken to stand still"),
        acceleration=column("acceleration", still, "accelerations", "there are taken to be none"),
        commanded=column("commanded", None, "commanded coordinates"),
        last_moves=column("last_moves", None, "moves"),
        joint_side=column("joint_side", None, "encoders on the joints' own side"),
        torque=column("torque", None, "torques"),
        force=column("force", lambda count: np.zeros((count, 3)), "a force at the tip", "none is taken to act"),
        moment=columns.filled("moment", lambda count: np.zeros((count, 3))),
        base_target=column("base_target", None, "a target on the base"),
        slots=column("slots", None, "which number each row is"),
        touches=columns.filled("touches", lambda count: np.full(count, -1)),
        bar_at=columns.filled("bar_at", np.zeros),
        frame=_free_if_any(recording.frame for recording in recordings),
        tool=_free_if_any(recording.tool for recording in recordings),
        seat=seat,
        rejected=tuple(_rejected(recordings, starts)),
        warnings=(*_warnings(names, recordings), *notes),
        other=MappingProxyType(
            {n: np.concatenate([recording.other[n] for recording in recordings]) for n in sorted(common)}
        ),
        avoid=tuple(dict.fromkeys(region for recording in recordings for region in recording.avoid)),
        source=np.repeat(np.arange(len(recordings)), counts).astype(np.int64),
        each=tuple(recordings),
        names=names,
        first_row=starts,
        began=began,
        before=before,
        units=units,
    )


@dataclass(frozen=True)
class _Columns:
    """The columns of several recordings, one under the other; what only some hold is noted."""

    names: tuple[str, ...]
    recordings: Sequence[Recording]
    notes: list[str]

    def joined(
        self, name: str, instead: Callable[[int], Array] | None, words: str, said: str = ""
    ) -> NDArray[Any] | None:
        """A column, of so many rows `instead` where a recording lacks it; without `instead` it is then not used."""
        given = [getattr(recording, name) for recording in self.recordings]
        have = [label for label, values in zip(self.names, given, strict=True) if values is not None]
        if not have:
            return None
        if len(have) == len(given):
            return np.concatenate(given)
        only = " and ".join(have)
        if instead is None:
            self.notes.append(f"Only {only} holds {words}: not used." if len(have) == 1 else f"{words}: not in all.")
            return None
        self.notes.append(f"Only {only} holds {words}. Elsewhere {said}.")
        return self.filled(name, instead)

    def filled(self, name: str, instead: Callable[[int], NDArray[Any]]) -> NDArray[Any] | None:
        """A column with rows `instead` where a recording lacks it, without a word; None where all lack it."""
        given = [getattr(recording, name) for recording in self.recordings]
        if all(values is None for values in given):
            return None
        rows = zip(given, self.recordings, strict=True)
        return np.concatenate([instead(one.size) if values is None else values for values, one in rows])


def _of_clocks(
    names: Sequence[str], recordings: Sequence[Recording], time: Array | None, before: Sequence[int | None]
) -> Iterator[str]:
    """Which recordings go on from which, and whether times are of no use."""
    for later, other in enumerate(before):
        if other is not None:
            stayed = "payloads that stayed count from there, lags too"
            yield f"{names[later]} goes on from {names[other]}, by its clock: {stayed}."
    if time is None and any(recording.time is not None for recording in recordings):
        yield "Not all recordings hold times: they are not used."


def _rejected(recordings: Sequence[Recording], starts: Sequence[int]) -> Iterator[RejectedRow]:
    """The rows set aside, numbered through."""
    for recording, start in zip(recordings, starts, strict=True):
        for aside in recording.rejected:
            yield RejectedRow(aside.row + start - 1, aside.reason)


def _warnings(names: Sequence[str], recordings: Sequence[Recording]) -> Iterator[str]:
    """Each recording's warnings, with its name."""
    for label, recording in zip(names, recordings, strict=True):
        yield from (f"{label}: {text}" for text in recording.warnings)


def _files(names: Sequence[str], recordings: Sequence[Recording]) -> str:
    labels = zip(names, recordings, strict=True)
    return " + ".join(PurePath(recording.file).name or label for label, recording in labels)


def _free_if_any(given: Iterable[Literal["known", "free"]]) -> Literal["known", "free"]:
    return "free" if "free" in given else "known"


def nominal_tips(arm: Arm, recording: Recording) -> Array:
    """Where the tip that each reading is of nominally is (N, 3), m."""
    tips = [tip_position(arm.on(name), recording.q) for name in sorted({item.branch for item in recording.singles})]
    return np.stack(tips)[recording.tips, np.arange(recording.size)]


def _with_payload(recording: Recording, arm: Arm, all_of_them: Sequence[Recording]) -> Recording:
    """A recording of one of several arms on a torso with that arm's payload in a column, where others have one."""
    if not arm.branches or recording.payload_mass is not None or all(item.payload_mass is None for item in all_of_them):
        return recording
    return replace(recording, payload_mass=np.full(recording.size, arm.on(recording.branch).payload.mass))


def _alike(recordings: Sequence[Recording]) -> Sequence[Recording]:
    """The recordings as they are where all hold the same; else each number of theirs is a separate reading."""
    alone = [_alone(recording) for recording in recordings]
    if len(set(alone)) > 1:
        number = next(index for index, name in enumerate(alone) if name)
        message = f"is of a {alone[number]}, and other recordings are not; diagnose them apart"
        raise InputError(recordings[number].file, "observes", message)
    kinds = {
        None if recording.slots is None else tuple(map(tuple, np.unique(recording.slots, axis=0)))
        for recording in recordings
    }
    if len(kinds) == 1 or all(recording.slots is None for recording in recordings):
        return recordings
    return [as_scalars(recording) for recording in recordings]


def _through(recordings: Sequence[Recording]) -> tuple[int, ...]:
    """The number with which the rows of each file begin, so that no two have the same."""
    last = [max([int(recording.row.max()), *(aside.row for aside in recording.rejected)]) for recording in recordings]
    return (1, *(1 + np.cumsum(last)[:-1]).tolist())


def _clocks(recordings: Sequence[Recording]) -> tuple[Array | None, tuple[float, ...]]:
    """One clock that runs through all recordings, and where on it the clock of each starts."""
    times = [recording.time for recording in recordings if recording.time is not None]
    if len(times) < len(recordings):
        return None, ()
    pause = _PAUSE * sum(float(np.ptp(time)) for time in times)
    began: list[float] = []
    end = 0.0
    for time in times:
        began.append(end - float(time.min()) if began else 0.0)
        end = began[-1] + float(time.max()) + pause
    return np.concatenate([time + start for time, start in zip(times, began, strict=True)]), tuple(began)


def _alone(recording: Recording) -> str:
    """The kind of a recording that goes with no other kind; empty where there is none."""
    kinds = () if recording.slots is None else kinds_of(recording.slots)
    return next((kind.name for kind in kinds if kind.alone), "")
