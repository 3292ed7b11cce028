"""Rollouts drawn: each joint's coordinate as measured, and as the arm is simulated before and after."""

from __future__ import annotations

from pathlib import PurePath

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.motion.result import Rollout, RolloutTraces
from linkwright.core.sections.numeric import Array
from linkwright.report.page import side_by_side
from linkwright.report.pictures.residual_map import chosen_rows
from linkwright.report.pictures.svg import Plot, course, element, spanned, text

_WIDTH, _HEIGHT = 420.0, 150.0
_WINDOWS, _INSTANTS = 20, 14
"""Windows that are drawn, one after the other, and instants of each."""
_KEYS = (("measured", "measured"), ("before", "simulated before"), ("after", "simulated after"))


def rolled_out_against_time(arm: Arm, rollout: Rollout) -> str:
    """The windows, one after the other, in which the arm as written is furthest off, a picture a joint."""
    worst = [_worst(trace) for trace in rollout.traces]
    number = int(np.argmax([off for _, off in worst]))
    trace, parts = rollout.traces[number], worst[number][0]
    several = f" ({PurePath(trace.log).name})" if len(rollout.traces) > 1 else ""
    keys = [element("span", element("i", class_=f"line {name}"), text(words)) for name, words in _KEYS]
    plots = (_of_joint(arm, trace, parts, joint, several) for joint in range(1, arm.size + 1))
    return element("p", *keys, class_="keys") + element("div", side_by_side(*plots), class_="rollouts")


def _parts(trace: RolloutTraces) -> list[NDArray[np.int64]]:
    """The rows of each window."""
    gaps = np.flatnonzero(~np.isfinite(trace.time))
    return [part[np.isfinite(trace.time[part])] for part in np.split(np.arange(len(trace.time)), gaps)][:-1]


def _worst(trace: RolloutTraces) -> tuple[list[NDArray[np.int64]], float]:
    """The windows of a log that follow each other in which the arm as written is furthest off, and how far: in the
    spans of the joints, summed over these."""
    parts = _parts(trace)
    if not parts:
        return [], -1.0
    spans = np.maximum(np.nanmax(trace.measured, axis=0) - np.nanmin(trace.measured, axis=0), 1e-9)
    off = [float(np.sqrt(np.nanmean(np.square((trace.after[p] - trace.measured[p]) / spans)))) for p in parts]
    total = np.concatenate([[0.0], np.cumsum(off)])
    size = min(_WINDOWS, len(parts))
    first = int(np.argmax(total[size:] - total[:-size]))
    return parts[first : first + size], float(total[first + size] - total[first])


def _of_joint(arm: Arm, trace: RolloutTraces, parts: list[NDArray[np.int64]], joint: int, several: str) -> str:
    column, turns = joint - 1, arm.joints[joint - 1].revolute
    rows = [part[chosen_rows(len(part), _INSTANTS)] for part in parts]
    every = np.concatenate(rows)

    def shown(values: Array) -> Array:
        return np.degrees(values[:, column]) if turns else 1e3 * values[:, column]

    lines = {name: shown(getattr(trace, name)) for name, _ in _KEYS}
    # What runs away leaves the frame, and the rest is still to be seen.
    up = spanned(lines["measured"][every], 0.4, 1.0)
    plot = Plot(_WIDTH, _HEIGHT, spanned(trace.time[every], 0.0), up)
    drawn: list[str] = []
    for name in ("before", "measured", "after"):
        for part in rows:
            within = (lines[name][part] >= up[0]) & (lines[name][part] <= up[1])
            here = part[: len(part) if within.all() else int(np.argmin(within))]
            drawn.append(course(plot.x(trace.time[here]), plot.y(lines[name][here]), name))
    names = (f"time in s{several}", f"joint {joint} in {'degrees' if turns else 'mm'}")
    about = f"Joint {joint} against time: measured, and simulated before and after from the start of each window on"
    return element("figure", plot.drawn(about, names, *drawn))
