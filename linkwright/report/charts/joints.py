"""Each joint at a glance: what is missing there, its torque before and after, and its friction over speed."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePath

import numpy as np
from numpy.typing import NDArray

from linkwright.core.diagnose.motion.result import MotionDiagnosis, MotionFinding, Traces
from linkwright.core.sections.numeric import Array
from linkwright.report.pictures.residual_map import chosen_rows
from linkwright.report.pictures.svg import Plot, course, dots, element, path, spanned, text
from linkwright.results.figures_in_words import effect_title, from_to
from linkwright.results.motion.words import dependence_words, finding_words, torque, torque_unit

_WIDTH, _HEIGHTS = 196.0, (78.0, 52.0, 78.0)
"""Of what is drawn: torque, what is left of it, friction."""
_WINDOW, _LEAST = 5.0, 60
"""Of each joint's torque so many seconds are drawn, or so many samples where these are further apart."""
_DOTS = 900
_BINS = 10
"""Of speeds, each way, in which the fitted friction is drawn."""
_MENTIONED, _MOST = 3, 8
"""Causes that a card names, and joints that have one: those of whose torque the model as given leaves most."""
_KEYS = (
    ("line measured", "measured"),
    ("line before", "model before"),
    ("line after", "model after"),
    ("dot", "friction as measured"),
    ("line law", "friction fitted"),
)


def joints_at_a_glance(diagnosis: MotionDiagnosis) -> str:
    """A card for each joint: its causes, the torque where the model as given is worst, and friction over speed."""
    worst = sorted(diagnosis.per_joint, key=lambda item: -np.nan_to_num(item.before))[:_MOST]
    cards = [_card(diagnosis, joint) for joint in sorted(item.joint for item in worst)]
    keys = [element("span", element("i", class_=class_), text(words)) for class_, words in _KEYS]
    return element("p", *keys, class_="keys") + element("div", *cards, class_="joints")


def _card(diagnosis: MotionDiagnosis, joint: int) -> str:
    unit, known = torque_unit(diagnosis.arm, joint), diagnosis.per_joint[joint - 1]
    heading = element("h3", text(f"Joint {joint}"))
    moves = [trace for trace in diagnosis.traces if trace.moves[:, joint - 1].any()]
    if not moves:
        return element("div", heading, element("p", text("It does not move."), class_="lead"), class_="card")
    change = from_to(torque(known.before, unit).text, torque(known.after, unit).text)
    said = element("p", element("strong", text(change)), text(f". {_causes(diagnosis, joint, unit)}"))
    drawn = _torque(moves, joint, unit) + _friction(diagnosis, moves, joint)
    return element("div", heading, said, drawn, class_="card")


def _causes(diagnosis: MotionDiagnosis, joint: int, unit: str) -> str:
    """What is missing at a joint, the largest first, and whether that is all."""
    here = sorted(
        (item for item in diagnosis.findings if item.rms_explained[joint - 1] > 0.0),
        key=lambda item: -item.rms_explained[joint - 1],
    )
    named = [f"{_words(item, joint)} {torque(item.rms_explained[joint - 1], unit, 2).text}" for item in here]
    more = [f"{len(named) - _MENTIONED} more"] if len(named) > _MENTIONED else []
    causes = ", ".join([*named[:_MENTIONED], *more])
    unknown = diagnosis.unknown is not None and joint in diagnosis.unknown.joints
    depends = dependence_words(diagnosis.per_joint[joint - 1].depends_on) if unknown else ""
    by = f" It depends on {depends}." if depends else ""
    rest = f" {'The rest' if causes else 'It'} is not explained.{by}" if unknown else ""
    return f"{causes[:1].upper()}{causes[1:]}.{rest}" if causes else rest.strip() or "Nothing is missing."


def _words(finding: MotionFinding, joint: int) -> str:
    """A finding at its joint, and whether it is the one name."""
    named = effect_title(finding.effect) if finding.at == (joint,) else finding_words(finding)
    others = len(finding.alternatives)
    return f"{named} (or {others} other name{'s' if others > 1 else ''})" if others else named


def _torque(traces: Sequence[Traces], joint: int, unit: str) -> str:
    """The torque of a joint over the seconds in which the model as given leaves most."""
    windows = [_worst(trace, joint) for trace in traces]
    worst = int(np.argmax([left for _, left in windows]))
    trace, rows = traces[worst], windows[worst][0]
    values = {name: getattr(trace, name)[rows, joint - 1] for name in ("measured", "before", "after")}
    left = {name: values["measured"] - values[name] for name in ("before", "after")}
    time = trace.time[rows]
    step = np.diff(time, prepend=time[0])
    parts = np.split(np.arange(len(time)), np.flatnonzero(step > 4.0 * np.median(step)))
    several = f" ({PurePath(trace.log).name})" if len(traces) > 1 else ""
    about = f"Torque of joint {joint} against time: measured, and by the model before and after"
    rest = f"What the model leaves of the torque of joint {joint} against time, before and after"
    drawn: list[str] = []
    for lines, height, words, names in (
        (values, _HEIGHTS[0], about, ("", unit)),
        (left, _HEIGHTS[1], rest, (f"time in s{several}", f"left, {unit}")),
    ):
        up = spanned(np.concatenate([np.zeros(1), *lines.values()]))
        bottom = 38.0 if names[0] else 20.0
        plot = Plot(_WIDTH, height, spanned(time, 0.0), up, bottom=bottom)
        courses = [
            course(plot.x(time[part]), plot.y(lines[name][part]), name)
            for name in ("before", "measured", "after")
            if name in lines
            for part in parts
        ]
        drawn.append(element("figure", plot.drawn(words, names, *courses)))
    return "".join(drawn)


def _worst(trace: Traces, joint: int) -> tuple[NDArray[np.int64], float]:
    """The rows of a window in which the model as given leaves most of a joint's torque, and the mean square of that."""
    column = joint - 1
    left = np.square(trace.measured[:, column] - trace.before[:, column]) * trace.moves[:, column]
    total = np.concatenate([[0.0], np.nan_to_num(left).cumsum()])
    spacing = float(np.median(np.diff(trace.time))) if len(left) > 1 else 1.0
    size = min(len(left), max(round(_WINDOW / spacing), _LEAST))
    sums = total[size:] - total[:-size]
    first = int(np.argmax(sums))
    return first + chosen_rows(size, _LEAST), float(sums[first]) / size


def _friction(diagnosis: MotionDiagnosis, traces: Sequence[Traces], joint: int) -> str:
    """Friction over speed: what is measured less all else that the corrected model has, and the law fitted to it; where
    the law goes by more than speed, the band holds nine tenths of it."""
    column, turns = joint - 1, diagnosis.arm.joints[joint - 1].revolute

    def pooled(name: str) -> Array:
        return np.concatenate([getattr(trace, name)[trace.moves[:, column], column] for trace in traces])

    speed, law = pooled("velocity"), pooled("friction")
    seen = pooled("measured") - pooled("after") + law
    known = np.isfinite(seen) & np.isfinite(speed)
    speed, law, seen = speed[known], law[known], seen[known]
    plot = Plot(_WIDTH, _HEIGHTS[2], spanned(np.append(speed, 0.0), 0.03), spanned(np.append(seen, 0.0)))
    rows = chosen_rows(len(seen), _DOTS // diagnosis.arm.size) if len(seen) else np.zeros(0, dtype=np.int64)
    bands: list[str] = []
    lines: list[str] = []
    for way in (speed < 0.0, speed > 0.0):
        order = np.flatnonzero(way)[np.argsort(speed[way])]
        parts = [part for part in np.array_split(order, _BINS) if len(part)]
        x = plot.x(np.array([speed[part].mean() for part in parts]))
        low, middle, high = (
            plot.y(np.array([np.quantile(law[part], level) for part in parts])) for level in (0.05, 0.5, 0.95)
        )
        bands += (
            [path([[*zip(x, low, strict=True), *zip(x[::-1], high[::-1], strict=True)]], "spread")] if parts else []
        )
        lines.append(course(x, middle, "law"))
    unit = torque_unit(diagnosis.arm, joint)
    names = (f"speed in {'rad/s' if turns else 'm/s'}", f"friction in {unit}")
    points = dots(plot.x(speed[rows]), plot.y(seen[rows]), "before")
    return element(
        "figure", plot.drawn(f"Friction of joint {joint} over speed, and the law fitted", names, *bands, points, *lines)
    )
