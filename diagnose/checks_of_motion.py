"""Whether joints and tip tell of the same motion: units, frame, stuck encoders and trackers, jumps.

Only what is far beyond any physics of an arm counts here: more than ten times what the middle reading is off by, and
more than half a per cent of the reach.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from arm.chain import Arm
from materials.quantities import InputError, format_quantity

from .placement import Placement, nominal, placed, turn_of
from .recording import Recording, RejectedRow
from .row_lists import rows_text
from .unit_slips import IN_A_ROW, UnitChange, unit_changes, widest

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

_FEWEST = 5
_WHOLE, _LEAST_WHOLE = 0.1, 0.01
"""Shares of the tips' spread and of the reach beyond which the middle reading contradicts the arm."""
_BETTER = 0.2
_FAR, _GROSS, _STILL = 10.0, 5e-3, 1e-3
_SHORT, _MOST_JUMPS = 3, 0.2
_MANY_STILL = 0.2


def motion_checked(recording: Recording, arm: Arm, headers: Mapping[str, str]) -> Recording:
    """The recording less rows in which joints and tip contradict each other grossly. Raises `InputError`."""
    if recording.size < _FEWEST:
        return recording
    reach = sum(arm.lengths) + sum(math.dist(joint.origin_translation, (0, 0, 0)) for joint in arm.joints)
    reach += sum(joint.range[1] - joint.range[0] for joint in arm.joints if not joint.revolute)
    if reach <= 0.0:
        return recording
    place = _placed(recording, arm)
    warnings: list[str] = []
    if place.misfit > _much(place, reach):
        _refuse_units(recording, arm, place, reach, headers)
        _refuse_still_joint(recording, arm, place, reach, headers)
    warnings += _frame_sentences(recording, arm, place, reach)
    limit = max(_FAR * place.misfit, _GROSS * reach)
    gross = place.distance > limit
    rejected: dict[int, str] = {}
    for reasons in (
        _frozen_tip(recording, arm, reach),
        _stuck(recording, arm, place, gross, limit, headers),
        _slipped(recording, arm, place, gross, limit, reach, headers),
    ):
        for index, reason in reasons.items():
            rejected.setdefault(index, reason)
    left = gross.copy()
    left[list(rejected)] = False
    jumps, said = _jumps(recording, place, left)
    rejected |= jumps
    recording = replace(recording, warnings=(*recording.warnings, *warnings, *said))
    return recording.without([RejectedRow(int(recording.row[k]), reason) for k, reason in sorted(rejected.items())])


def _placed(recording: Recording, arm: Arm) -> Placement:
    return placed(arm, recording.q, recording.tip, frame=recording.frame == "free", tool=recording.tool == "free")


def _much(place: Placement, reach: float) -> float:
    """How far off the middle reading must be before the recording as a whole contradicts the arm, m."""
    return max(_WHOLE * _spread(place.modelled), _LEAST_WHOLE * reach)


def _spread(points: Array) -> float:
    return float(np.median(np.linalg.norm(points - np.median(points, axis=0), axis=1)))


def _length(value: float) -> str:
    return format_quantity(value, "length", digits=3)


def _refuse_units(recording: Recording, arm: Arm, place: Placement, reach: float, headers: Mapping[str, str]) -> None:
    """Raise where another unit of a column makes joints and tip agree."""
    best: tuple[float, float, UnitChange] | None = None
    for change in unit_changes(arm, recording.tip.shape[1], headers):
        tried = placed(
            arm,
            recording.q * change.q,
            recording.tip * change.tip,
            frame=recording.frame == "free",
            tool=recording.tool == "free",
        )
        # Relative to the motion: in units that are small enough, everything is close to everything.
        share = tried.misfit / max(_spread(tried.modelled), 1e-3 * reach)
        good = share < _WHOLE and tried.misfit < _BETTER * place.misfit
        if good and (best is None or share < 0.999 * best[0]):
            best = (share, tried.misfit, change)
    if best is None:
        return
    _, misfit, change = best
    message = (
        f"{change.said()}: then the middle reading is {_length(misfit)} from the nominal tip, and not "
        f"{_length(place.misfit)}; write {change.right_headers()} in the header"
    )
    raise InputError(recording.file, "", message)


def _refuse_still_joint(
    recording: Recording, arm: Arm, place: Placement, reach: float, headers: Mapping[str, str]
) -> None:
    """Raise where a joint that never changes would have to move for the tip to be where it is."""
    for index in range(arm.size):
        if np.ptp(recording.q[:, index]) != 0.0 or recording.frame == "free":
            continue
        left = _distance_with_joint_free(recording, arm, place, np.ones(recording.size, dtype=bool), index)
        if np.median(left) < _BETTER * place.misfit and np.median(left) < _much(place, reach):
            name = headers.get(f"q{index + 1}", f"q{index + 1}")
            message = "never changes, but the tip moves as if the joint did: its encoder stands still or was not logged"
            raise InputError(recording.file, name, message)


def _frame_sentences(recording: Recording, arm: Arm, place: Placement, reach: float) -> list[str]:
    """Say, or raise where the error is no small one, that another frame or tool makes joints and tip agree."""
    if place.misfit < _LEAST_WHOLE * reach or recording.size < 2 * _FEWEST:
        return []
    known_frame, known_tool = recording.frame == "known", recording.tool == "known"
    tries: list[tuple[str, Placement]] = []
    for frame, tool in ((True, False), (False, True), (True, True)):
        if (frame and not known_frame) or (tool and not known_tool):
            continue
        free = placed(arm, recording.q, recording.tip, frame=frame or not known_frame, tool=tool or not known_tool)
        words = [word for word, is_free in (("frame: free", frame), ("tool: free", tool)) if is_free]
        tries.append((" and ".join(words), free))
    good = [(words, free) for words, free in tries if free.misfit < _BETTER * place.misfit]
    if not good:
        if place.misfit > _much(place, reach):
            text = f"The middle reading is {_length(place.misfit)} away from the nominal tip"
            return [f"{text}, and no other unit, frame or tool explains it: do the arm file and the recording belong?"]
        return []
    least = min(free.misfit for _, free in good)
    words, free = next((words, free) for words, free in good if free.misfit <= 2.0 * least + 1e-6)
    shift, turn = float(np.linalg.norm(free.translation)), turn_of(free.rotation)
    parts: list[str] = []
    if "frame" in words:
        # The shift of the origin alone means little where the frame is turned: what the tips move by is what counts.
        parts.append(f"a frame turned by {math.degrees(turn):.3g} deg and shifted by {_length(shift)}")
    if "tool" in words:
        parts.append(f"a tool that reaches {_length(float(np.linalg.norm(free.tool)))} further")
    falls = f"from {_length(place.misfit)} to {_length(free.misfit)}"
    change = f"{' and '.join(parts)} would bring the middle reading {falls}"
    large = turn > 0.1 or place.misfit > _WHOLE * reach
    if large:
        message = f"is measured in another frame than the arm's: {change}; write `{words}` in recording.yaml"
        if "frame" not in words:
            message = f"does not hold the arm file's tip: {change}; write `{words}` in recording.yaml"
        raise InputError(recording.file, "", message)
    return [f"{change[0].upper()}{change[1:]}: where nobody knows better, write `{words}` in recording.yaml."]


def _frozen_tip(recording: Recording, arm: Arm, reach: float) -> dict[int, str]:
    """Rows that hold the same tip as the row before, to the last digit, although the joints moved."""
    tips, _ = nominal(arm, recording.q, recording.tip.shape[1])
    still = (np.diff(recording.tip, axis=0) == 0.0).all(axis=1)
    found: dict[int, str] = {}
    if still.mean() > _MANY_STILL:
        return found  # an instrument that is this coarse repeats itself anyway
    source = 0
    for index in range(1, recording.size):
        if not still[index - 1]:
            source = index
        elif float(np.linalg.norm(tips[index] - tips[source])) > _STILL * reach:
            found[index] = f"the tip is that of row {recording.row[source]} to the last digit although the joints moved"
    return found


def _stuck(
    recording: Recording, arm: Arm, place: Placement, gross: Mask, limit: float, headers: Mapping[str, str]
) -> dict[int, str]:
    """Rows in which a joint's reading stands still while the tip moves as if the joint did."""
    found: dict[int, str] = {}
    for index in range(arm.size if gross.any() else 0):
        name = headers.get(f"q{index + 1}", f"q{index + 1}")
        for rows in _runs_of_one_value(recording.q[:, index]):
            bad = rows[gross[rows]]
            if len(bad) < 2 or not _moves(recording, bad, index, limit):
                continue
            mask = np.zeros(recording.size, dtype=bool)
            mask[bad] = True
            left = _distance_with_joint_free(recording, arm, place, mask, index)
            if np.mean(left < np.maximum(_BETTER * place.distance[bad], 2.0 * place.misfit)) < 0.8:
                continue
            first, last = recording.row[bad[0]], recording.row[bad[-1]]
            reason = f"{name} stands still while the tip moves (rows {first} to {last})"
            for row in bad.tolist():
                found.setdefault(row, reason)
    return found


def _runs_of_one_value(values: Array) -> list[NDArray[np.int64]]:
    ends = np.flatnonzero(np.diff(values) != 0.0) + 1
    return [run for run in np.split(np.arange(len(values)), ends) if len(run) > 1]


def _moves(recording: Recording, rows: NDArray[np.int64], index: int, limit: float) -> bool:
    """Whether the arm moves within rows: the tip or another joint."""
    others = np.delete(recording.q[rows], index, axis=1)
    elsewhere = bool(others.size) and bool((np.ptp(others, axis=0) > 1e-3).any())
    return elsewhere or bool((np.ptp(recording.tip[rows], axis=0) > limit).any())


def _distance_with_joint_free(recording: Recording, arm: Arm, place: Placement, rows: Mask, index: int) -> Array:
    """How far the measured tips of some rows are from what the arm can reach by moving one joint alone, m."""
    q = recording.q[rows]
    goal = (place.modelled + place.residual)[rows]
    joint = arm.joints[index]
    low, high = (-math.pi, math.pi) if joint.revolute else joint.range
    step = (high - low) / 180.0
    best = np.full(len(q), np.inf)
    at = q[:, index].copy()
    width = recording.tip.shape[1]

    def distance(values: Array) -> Array:
        moved = q.copy()
        moved[:, index] = values
        tips, axes = nominal(arm, moved, width)
        return np.linalg.norm(tips + axes @ place.tool - goal, axis=1)

    center = q[:, index] if joint.revolute else np.zeros(len(q))
    for offset in np.arange(low, high + 0.5 * step, step):
        tried = distance(center + offset)
        at = np.where(tried < best, center + offset, at)
        best = np.minimum(best, tried)
    for _ in range(12):  # each pass halves the step: 2 deg down to 0.5 mdeg
        step /= 2.0
        for side in (-step, step):
            tried = distance(at + side)
            at = np.where(tried < best, at + side, at)
            best = np.minimum(best, tried)
    return best


def _slipped(
    recording: Recording,
    arm: Arm,
    place: Placement,
    gross: Mask,
    limit: float,
    reach: float,
    headers: Mapping[str, str],
) -> dict[int, str]:
    """Rows that fit as soon as a column is read in another unit."""
    found: dict[int, str] = {}
    bad = np.flatnonzero(gross)
    if not len(bad):
        return found
    near = max(0.5 * limit, 3.0 * place.misfit)
    closest = np.minimum(near, 0.1 * place.distance[bad])
    for change in unit_changes(arm, recording.tip.shape[1], headers):
        if not all(factor in IN_A_ROW for factor in change.factors):
            continue
        # Small numbers fit much: a column is only made smaller where it is too large for any arm.
        smaller_q, smaller_tip = change.q < 1.0, change.tip < 1.0
        beyond = np.where(smaller_q, np.abs(recording.q[bad]) > widest(arm), True).all(axis=1)
        beyond &= np.where(smaller_tip, np.abs(recording.tip[bad]) > 2.0 * reach, True).all(axis=1)
        tips, axes = nominal(arm, recording.q[bad] * change.q, recording.tip.shape[1])
        measured = (recording.tip[bad] * change.tip) @ place.rotation.T + place.translation
        apart = np.linalg.norm(measured - tips - axes @ place.tool, axis=1)
        fits = beyond & (apart < closest)
        closest = np.where(fits, apart, closest)
        for index in bad[fits].tolist():
            found[index] = change.said()
    return found


def _jumps(recording: Recording, place: Placement, gross: Mask) -> tuple[dict[int, str], list[str]]:
    """Short, solitary contradictions are jumps and set aside; what lasts or comes back in repeats is only said."""
    found: dict[int, str] = {}
    bad = np.flatnonzero(gross)
    if not len(bad):
        return found, []
    lasting: list[int] = []
    for run in np.split(bad, np.flatnonzero(np.diff(bad) > 1) + 1):
        agree = len(run) > 1 and bool((np.ptp(place.residual[run], axis=0) < 0.1 * place.distance[run].min()).all())
        if len(run) > _SHORT or agree:
            lasting += run.tolist()
            continue
        for index in run.tolist():
            far = _length(float(place.distance[index]))
            found[index] = f"jumps: the tip is {far} from the nominal one, the middle reading {_length(place.misfit)}"
    if len(found) > _MOST_JUMPS * recording.size:
        lasting, found = sorted([*lasting, *found]), {}
    if not lasting:
        return found, []
    rows = rows_text(recording.row[lasting])
    farthest = _length(float(place.distance[lasting].max()))
    return found, [f"In {rows} the tip is up to {farthest} away from the nominal one; these rows are kept."]
