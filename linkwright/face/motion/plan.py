"""A motion worth logging, by which named causes are distinguished."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from linkwright.core.arm.avoid.poses import NoRoom, room_of
from linkwright.core.arm.chain.chain import Arm as Model
from linkwright.core.diagnose.motion.uses.plan import Apart, NothingToTell, plan_motion
from linkwright.core.diagnose.motion.uses.plan import MotionPlan as MotionPlanResult
from linkwright.core.diagnose.motion.uses.trajectory import motion_columns, read_motion
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
from linkwright.results.diagnoses.words import effect_words
from linkwright.results.document import Description, Item, Lines, Value, count, share, table
from linkwright.results.figures_in_words import coordinate, figure, percent, with_unit
from linkwright.results.motion.words import torque

from .diagnosis import MotionDiagnosis, diagnosed_motion
from .log import logs_of

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go

_SHOWN = 12
"""Pairs that a screen shows."""


def describe(result: MotionPlanResult) -> Description:
    """What the motion tells apart, and what it keeps to."""
    model, motion = result.arm, result.motion
    worst = result.apart[0]
    seconds = with_unit(float(motion.time[-1]), "s", 3)
    headline = (
        f"{seconds} of motion: of {effect_words(*worst.one)} {percent(worst.share)} cannot be taken for "
        f"{effect_words(*worst.other)}, the pair told worst (at random {percent(worst.random)})"
    )
    rows = [
        (effect_words(*item.one), effect_words(*item.other), share(item.share), share(item.random), torque(item.left))
        for item in result.apart
    ]
    headings = ("what", "told from", "of its pattern is left", "motion at random", "at usual size")
    joints = [
        (
            count(number),
            Value(f"{coordinate(model, number - 1, low)} to {coordinate(model, number - 1, high)}"),
            Value(f"{figure(speed, 3)} {'rad/s' if joint.revolute else 'm/s'}"),
        )
        for number, (joint, low, high, speed) in enumerate(
            zip(
                model.joints,
                motion.q.min(axis=0).tolist(),
                motion.q.max(axis=0).tolist(),
                np.abs(motion.velocity).max(axis=0).tolist(),
                strict=True,
            ),
            start=1,
        )
    ]
    items: list[Item] = [
        table(headings, rows, first=_SHOWN, rest=f"and {len(rows) - _SHOWN} more, in the JSON"),
        table(("joint", "moves over", "fastest"), joints),
    ]
    lines = [f"{result.tried} motions were tried. Ranges and speeds of the arm file are kept."]
    guessed = [str(number) for number, joint in enumerate(model.joints, start=1) if joint.velocity is None]
    if guessed:
        some = f"joint{'s' if len(guessed) > 1 else ''} {listed(guessed)}"
        lines.append(f"The arm file tells no greatest speed of {some} (`velocity`): 1 rad/s or 0.25 m/s is taken.")
    if result.unseen:
        lines.append(f"Does not act on this arm's torques: {listed([effect_words(*item) for item in result.unseen])}.")
    items.append(Lines(tuple(lines)))
    return Description(f"{model.name}: a motion worth logging", headline, tuple(items), headline, f"{model.name}: ")


@dataclass(frozen=True, repr=False)
class MotionPlan(Result):
    """A motion to log, within ranges, speeds and regions to avoid, and which causes it tells apart; `found` in SI."""

    _command = "plan"
    _describe = staticmethod(describe)

    arm: Arm
    found: MotionPlanResult

    interrupted = Field[bool]("Whether Ctrl-C ended the choice. This is the best motion until then.")

    @property
    def table(self) -> pd.DataFrame:
        """The motion, 100 rows a second: `t_s`, `q1_rad`, `dq1_radps`, `ddq1_radps2` ..., of slides in m."""
        return frame(motion_columns(self.found.motion))

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
            "seconds": float(motion.time[-1]),
            "samples": motion.size,
            "apart": [_apart(item) for item in plan.apart],
            "unseen": [{"effect": effect, "at": list(at)} for effect, at in plan.unseen],
            "joints": [_joint(plan.arm, plan, index) for index in range(plan.arm.size)],
            **fields(plan, "tried", "seed", "interrupted"),
        }

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {"Told apart": self.apart}


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
    seconds: float,
    seed: int,
    progress: Progress | None,
) -> MotionPlan:
    """The motion that tells effects apart, or `after` logs (or their diagnosis) what these could not. Raises
    `InputError`, and `NoAnswer` where there is nothing to tell apart."""
    places = [place_of(name, arm) for name in for_]
    wanted = [(effect, tuple(index + 1 for index in at)) for effect, at in places]
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
