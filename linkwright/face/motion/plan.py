"""A motion worth logging, by which named causes are distinguished."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from linkwright.core.arm.avoid.poses import NoRoom, room_of
from linkwright.core.arm.chain.chain import Arm as Model
from linkwright.core.diagnose.motion.uses.expected import Expected, Place, expected_by
from linkwright.core.diagnose.motion.uses.plan import Apart, NothingToTell, plan_motion
from linkwright.core.diagnose.motion.uses.plan import MotionPlan as MotionPlanResult
from linkwright.core.diagnose.motion.uses.trajectory import limits_of, motion_columns, read_motion
from linkwright.core.diagnose.motion.written import table_text
from linkwright.core.units.lists import listed
from linkwright.core.units.quantities import InputError, NoAnswer
from linkwright.face.arm import Arm
from linkwright.face.motion.log import unlike_arrays
from linkwright.face.plain_input import File
from linkwright.face.planning.request import place_of, regions_of
from linkwright.face.progress import Progress, reporting
from linkwright.face.recording import saved
from linkwright.face.result import Field, Result, drawn
from linkwright.json.fields import fields
from linkwright.json.motion import OBSERVES
from linkwright.output.table_file import frame
from linkwright.results.diagnoses.words import effect_words, quantity
from linkwright.results.document import Cell, Description, Lines, Table, Value, count, share, table
from linkwright.results.figures_in_words import coordinate, figure, percent, with_unit
from linkwright.results.motion.words import torque

from .diagnosis import MotionDiagnosis, diagnosed_motion
from .log import logs_of

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go

_SHOWN = 12
"""Names and pairs that a screen shows."""


def describe(result: MotionPlanResult) -> Description:
    """How far the motion tells each name, what it tells apart, and what it keeps to."""
    model, motion = result.arm, result.motion
    seconds = with_unit(float(motion.time[-1] - motion.time[0]), "s", 3)
    shown = [item for item in result.expected if item.shown]
    least = f", the worst of them {_name(shown[0])} to {percent(shown[0].share)} of its usual size" if shown else ""
    headline = f"{seconds} of motion: {len(shown)} of {len(result.expected)} names are told{least}"
    best = [item.share / item.random for item in shown if item.random > 0.0]
    if best:
        headline += f". Intervals are {figure(float(np.median(best)), 2)} times those of motions at random."
    items = (*_tables(result), _kept(result), Lines(tuple(_notes(result))))
    title = "a motion worth logging" if result.tried else "what a log tells"
    return Description(f"{model.name}: {title}", headline, items, headline, f"{model.name}: ")


def _tables(result: MotionPlanResult) -> list[Table]:
    """How far the motion tells each name, and what it tells apart."""
    rows = [
        (
            _name(item),
            f"to {percent(item.share)}" if item.shown else _why(item),
            Value(f"± {quantity(item.half, item.kind, 2)}") if item.shown else Value("–"),
            *([share(item.random)] if result.tried else []),
        )
        for item in result.expected
    ]
    apart = [
        (effect_words(*item.one), effect_words(*item.other), share(item.share), share(item.random), torque(item.left))
        for item in result.apart
    ]
    against = ("what", "told from", "of its pattern is left", "motion at random", "at usual size")
    told = _shown(("name", "told", "95 % interval", *(["motions at random"] if result.tried else [])), rows)
    return [told, _shown(against, apart)] if apart else [told]


def _notes(result: MotionPlanResult) -> Iterator[str]:
    """What the figures rest on, a line each."""
    number = len(result.expected)
    together = f"if all {number} causes listed were there at once" if number > 1 else "if that cause were there"
    fewer = "; fewer (`--for`) are told more narrowly" if number > 1 else ""
    yield f"Shares are of the usual size. Intervals hold {together}, beside the terms that every drive has{fewer}."
    yield "They count white noise alone. A diagnosis counts coloured noise and what the model lacks too, and is wider."
    if result.tried:
        yield f"{result.tried} motions were tried. Ranges, speeds and peak torques of the arm file are kept."
    guessed = [str(number) for number, joint in enumerate(result.arm.joints, start=1) if joint.velocity is None]
    if guessed and result.tried:
        some = f"joint{'s' if len(guessed) > 1 else ''} {listed(guessed)}"
        yield f"The arm file tells no greatest speed of {some} (`velocity`): 1 rad/s or 0.25 m/s is taken."
    if result.unseen:
        yield f"Does not act on this arm's torques: {listed([effect_words(*item) for item in result.unseen])}."


def _shown(headings: Sequence[str], rows: Sequence[Sequence[Cell]]) -> Table:
    return table(headings, rows, first=_SHOWN, rest=f"and {len(rows) - _SHOWN} more, in the JSON")


def _name(item: Expected) -> str:
    return effect_words(*item.name)


def _why(item: Expected) -> str:
    """Why the motion does not show the size of a name."""
    if item.beside is None:
        return "no: too little of it acts"
    return f"cannot be told: goes with {effect_words(*item.beside)}"


def _kept(result: MotionPlanResult) -> Table:
    """What each joint moves over, and how fast it gets."""
    low, high = (end(axis=0).tolist() for end in (result.motion.q.min, result.motion.q.max))
    fastest = np.abs(result.motion.velocity).max(axis=0).tolist()
    rows = [
        (
            count(k + 1),
            Value(f"{coordinate(result.arm, k, low[k])} to {coordinate(result.arm, k, high[k])}"),
            Value(f"{figure(fastest[k], 3)} {'rad/s' if joint.revolute else 'm/s'}"),
        )
        for k, joint in enumerate(result.arm.joints)
    ]
    return table(("joint", "moves over", "fastest"), rows)


@dataclass(frozen=True, repr=False)
class MotionPlan(Result):
    """A motion to log, within ranges, speeds, peak torques and regions to avoid, how far it tells the size of each
    cause, and which causes it tells apart; `found` in SI."""

    _command = "plan"
    _describe = staticmethod(describe)

    arm: Arm
    found: MotionPlanResult

    interrupted = Field[bool]("Whether Ctrl-C ended the choice. This is the best motion until then.")

    @property
    def table(self) -> pd.DataFrame:
        """The motion, 100 rows a second: `time_s`, `q1_deg`, `qd1_deg_s`, `qdd1_deg_s2` ..., of slides in mm."""
        return frame(motion_columns(self.found.motion))

    @property
    def expected(self) -> pd.DataFrame:
        """A row for each name: half the 95 % interval that is to be expected of its first `parameter` (`half`, in SI),
        as `share` of the usual size, at motions at `random`, and with which name it goes where it is not `shown`."""
        return frame(self._content()["expected"])

    @property
    def apart(self) -> pd.DataFrame:
        """A row for each pair of causes: what of the first's pattern the second cannot take up (`share`), at motions at
        random, and the RMS of that at usual size (N*m), the worst told first."""
        return frame(self._content()["apart"])

    def text(self) -> str:
        """The motion as CSV."""
        return table_text(motion_columns(self.found.motion))

    def save(self, folder: File) -> Sequence[Path]:
        """Write the motion as CSV, as `plan --out` does; gives which file."""
        return saved(folder, self.text(), None, self._unlike)

    def _unlike(self, path: Path) -> Iterator[str]:
        """What the motion that is read from a file says otherwise."""
        return unlike_arrays(self.found.motion, read_motion(path, self.arm.model), "time", "q", "velocity")

    def plot(self) -> go.Figure:
        """The coordinates of the joints against time."""
        motion = self.found.motion
        lines = {f"joint {number}": column.tolist() for number, column in enumerate(motion.q.T, start=1)}
        return drawn(motion.time.tolist(), lines, "time in s", "rad (m)", mode="lines")

    def _content(self) -> Mapping[str, Any]:
        plan, motion = self.found, self.found.motion
        return {
            "arm": plan.arm.name,
            **OBSERVES,
            "seconds": float(motion.time[-1] - motion.time[0]),
            "samples": motion.size,
            "expected": [_expected(item) for item in plan.expected],
            "apart": [_apart(item) for item in plan.apart],
            "unseen": [{"effect": effect, "at": list(at)} for effect, at in plan.unseen],
            "joints": [_joint(plan.arm, plan, index) for index in range(plan.arm.size)],
            **fields(plan, "tried", "seed", "interrupted"),
        }

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {"Expected": self.expected, "Told apart": self.apart}


def _expected(item: Expected) -> dict[str, Any]:
    effect, at = item.name
    beside = None if item.beside is None else [item.beside[0], list(item.beside[1])]
    random = item.random if np.isfinite(item.random) else None
    figures = fields(item, "parameter", "kind", "half", "share", "shown")
    return {"effect": effect, "at": list(at), **figures, "random": random, "goes_with": beside}


def _apart(apart: Apart) -> dict[str, Any]:
    return {
        "effect": apart.one[0],
        "at": list(apart.one[1]),
        "other": apart.other[0],
        "other_at": list(apart.other[1]),
        **fields(apart, "share", "random", "left_rms=left"),
    }


def _joint(arm: Model, plan: MotionPlanResult, index: int) -> dict[str, Any]:
    motion, unit = plan.motion, "rad" if arm.joints[index].revolute else "m"
    q, speed = motion.q[:, index], np.abs(motion.velocity[:, index])
    return {
        "joint": index + 1,
        f"moves_over_{unit}": [float(q.min()), float(q.max())],
        f"fastest_{unit}ps": float(speed.max()),
        f"limit_{unit}ps": float(plan.limits.speed[index]),
    }


def planned_motion(
    arm: Arm,
    for_: Sequence[str],
    avoid: Sequence[Any],
    after: object,
    at: File | None,
    seconds: float,
    seed: int,
    progress: Progress | None,
) -> MotionPlan:
    """The motion that tells effects apart, or `after` logs (or their diagnosis) what these could not. Raises
    `InputError`, and `NoAnswer` where there is nothing to tell apart."""
    places = [place_of(name, arm) for name in for_]
    wanted = [(effect, tuple(index + 1 for index in where)) for effect, where in places]
    if at is not None:
        return _of_log(arm, at, wanted)
    if after is not None:
        before = after if isinstance(after, MotionDiagnosis) else _diagnosed(after, arm, progress)
        wanted = wanted or _undecided(before)
    room = room_of(arm.model, None, regions_of(avoid))
    with reporting(progress) as tell:
        try:
            plan = plan_motion(arm.model, wanted, room, seconds=seconds, seed=seed, progress=tell)
        except NothingToTell as error:
            raise NoAnswer(f"--for {error}") from None
        except NoRoom as error:
            raise InputError("", "avoid", str(error)) from None
    return MotionPlan(arm, plan)


def _of_log(arm: Arm, file: File, wanted: Sequence[Place]) -> MotionPlan:
    """How far a log tells names, before any diagnosis."""
    logs = logs_of(file, arm)
    if not logs:
        raise InputError(str(file), "", "holds the tip's place; name a motion log")
    motion, patterns, expected = expected_by(arm.model, logs[0].found, wanted)
    limits = limits_of(arm.model, room_of(arm.model, None, ()), np.random.default_rng(1))
    return MotionPlan(arm, MotionPlanResult(arm.model, motion, limits, (), expected, patterns.unseen, 0, 1))


def _diagnosed(after: object, arm: Arm, progress: Progress | None) -> MotionDiagnosis:
    from linkwright.core.diagnose.options import Options

    logs = logs_of(after, arm)
    if not logs:
        raise InputError("", "after", "holds the tip's place; a plan for motion goes on from motion logs")
    with reporting(progress) as tell:
        return diagnosed_motion(arm, logs, Options(), tell)


def _undecided(before: MotionDiagnosis) -> list[tuple[str, tuple[int, ...]]]:
    """The findings that have other names, and those."""
    open_ = [finding for finding in before.found.findings if finding.alternatives]
    return list(
        dict.fromkeys(
            place
            for finding in open_
            for place in (
                (finding.effect, finding.at),
                *(one for alternative in finding.alternatives for one in alternative.effects),
            )
        )
    )
