"""Motion logs for programs: read from files or data frames."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from linkwright.core.arm.chain.chain import Arm as Model
from linkwright.core.arm.errors.unknown_mass import of_unknown_mass, without_unknown
from linkwright.core.diagnose.motion.log import TORQUE, MotionLog
from linkwright.core.diagnose.motion.reading.read import holds_motion, is_motion_log, logs_from, table_of_log
from linkwright.core.diagnose.motion.written import log_columns
from linkwright.core.diagnose.reading.files import table_of
from linkwright.core.diagnose.reading.settings import ReadingSettings, read_settings
from linkwright.core.diagnose.reading.table import Table
from linkwright.core.units.quantities import InputError
from linkwright.face.arm import Arm, arm_of
from linkwright.face.plain_input import File
from linkwright.face.readings import Readings, paired
from linkwright.results.figures_in_words import figure

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, repr=False)
class Log(Readings):
    """A motion log of a real arm: joint coordinates and drive torques against time, less the samples that were set
    aside; `found` holds everything in SI."""

    arm: Arm
    found: MotionLog

    @property
    def table(self) -> pd.DataFrame:
        """The samples by the columns of a log's file (`t_s`, `q1_rad`, `tau1_Nm`, ...); the index is the row there."""
        import pandas as pd

        return pd.DataFrame(log_columns(self.found, self.arm.model), index=pd.Index(self.found.row, name="row"))

    def _line(self) -> str:
        log = self.found
        name = PurePath(log.file).name or "made by a model"
        seconds = float(log.time[-1] - log.time[0]) if log.size else 0.0
        what = f"{(log.drive if log.torque_constants_free else TORQUE).words} of {log.q.shape[1]} joints"
        return f"{name}, {log.size} samples in {figure(seconds, 3)} s{self._aside()}, {what}"


def read_log(log: File | pd.DataFrame, arm: Arm | File, *, settings: File | None = None) -> Log:
    """The motion log that a file holds (.csv, .xlsx, .parquet, .mcap, a ROS 2 bag), or a data frame of the same
    columns, checked against the arm.

    `settings` is its recording.yaml; beside a file one of its name, or recording.yaml, counts by default. Samples that
    cannot be used are set aside with the reason. Raises `InputError` where nothing sensible can follow.

    >>> import linkwright as lw
    >>> arm = lw.read_arm("examples/motion-log/robot.urdf")
    >>> lw.read_log("examples/motion-log/log.csv", arm)
    <Log: log.csv, 2500 samples in 25 s, torques of 4 joints>
    """
    given = arm_of(arm, tips="first")
    return _read([(log, settings)], given)[0]


def _read(pairs: Sequence[tuple[object, File | None]], arm: Arm) -> list[Log]:
    tables: list[tuple[Table, ReadingSettings]] = []
    for given, settings in pairs:
        held = None if settings is None else Path(settings)
        if _is_frame(given):
            tables.append((table_of(cast(Any, given), "DataFrame"), read_settings(held)))
        else:
            tables.append(table_of_log(str(given), held))
    said = [f"{sentence}." for sentence in arm.unread]
    if unknown := of_unknown_mass(arm.model):
        links = ", ".join(str(index + 1) for index in unknown)
        said.append(
            f"The mass of link{'s' * (len(unknown) > 1)} {links} is unknown. It counts as 0 kg, also in the arm file "
            "that is written, and what is identified of its weight is all of it."
        )
    return [Log(arm, log.saying(*said)) for log in logs_from(tables, with_known_weights(arm.model))]


def with_known_weights(arm: Model) -> Model:
    """The arm that motion logs are set against: links of unknown mass weigh nothing, and the logs tell what they do."""
    return without_unknown(arm, of_unknown_mass(arm))


def logs_of(given: object, arm: Arm, settings: File | Sequence[File] | None = None) -> tuple[Log, ...]:
    """The motion logs that are given or named; none where these are recordings of a tip. Raises `InputError` for logs
    beside recordings, and for a log that is named twice."""
    several = list(cast("Sequence[object]", given)) if isinstance(given, list | tuple) else [given]
    if not several or arm.model.unknown_origins:
        return ()
    pairs = paired(several, settings)
    kinds = [_is_motion(one, arm, held) for one, held in pairs]
    if not any(kinds):
        return ()
    if not all(kinds):
        message = "are motion logs and recordings of a tip; diagnose each kind by itself"
        raise InputError("", "recording", message)
    fresh = iter(_read([pair for pair in pairs if not isinstance(pair[0], Log)], arm))
    logs = tuple(one if isinstance(one, Log) else next(fresh) for one, _ in pairs)
    files = [Path(log.found.file).absolute() for log in logs if log.found.file and Path(log.found.file).exists()]
    twice = next((file for k, file in enumerate(files) if file in files[:k]), None)
    if twice is not None:
        raise InputError(twice, "", "is named twice; each log counts once")
    return logs


def of_tips_alone(**said: bool) -> None:
    """Refuse what is asked of recordings of a tip alone. Raises `InputError`."""
    for name in (name for name, given in said.items() if given):
        raise InputError("", name, "goes with recordings of a tip; a motion log has none")


def _is_motion(given: object, arm: Arm, settings: File | None) -> bool:
    if isinstance(given, Log):
        return True
    held = None if settings is None else Path(settings)
    if isinstance(given, str | Path):
        return is_motion_log(Path(given), arm.model, held)
    return _is_frame(given) and holds_motion(table_of(cast(Any, given), "DataFrame"), arm.model, read_settings(held))


def _is_frame(given: object) -> bool:
    return not isinstance(given, str) and hasattr(given, "columns")


_ROUNDED = 1e-5
"""The share of the largest figure by which one may differ that is read back: files of motions hold seven digits."""


def unlike_arrays(meant: object, back: object, *names: str) -> Iterator[str]:
    """The attributes (arrays of any shape, SI) in which what was read back is not what was meant."""
    for name in names:
        ours, theirs = (np.asarray(getattr(item, name), dtype=float) for item in (meant, back))
        bound = _ROUNDED * max(1.0, float(np.abs(ours).max(initial=0.0)))
        if ours.shape != theirs.shape or not np.allclose(ours, theirs, rtol=0.0, atol=bound):
            yield f"another {name}"
