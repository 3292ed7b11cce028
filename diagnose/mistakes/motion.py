"""Whether joints and tip tell of the same motion, row by row: stuck encoders and trackers, slips of units, jumps.

Only what is far beyond any physics of an arm counts here: more than ten times what the middle reading is off by, and
more than half a per cent of the reach.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.arrays import nominal
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.first_look.recording import contradictions, distance_with_joint_free, shown_length
from linkwright.core.diagnose.first_look.units import IN_A_ROW, unit_changes, widest
from linkwright.core.diagnose.recording import Recording, RejectedRow
from linkwright.core.diagnose.residual.placement import Placement, placed
from linkwright.core.diagnose.rules.rules import RULES, Rules
from linkwright.core.sections.numeric import Array
from linkwright.core.units.lists import rows_text

Mask = NDArray[np.bool_]


def motion_checked(recording: Recording, arm: Arm, headers: Mapping[str, str], *, rules: Rules = RULES) -> Recording:
    """The recording less rows in which joints and tip contradict each other grossly. Raises `InputError`."""
    if recording.slots is not None:
        return recording  # whatever was measured in part is looked at by `instruments.checks`
    if recording.size < rules.residual.enough_freedom or not np.ptp(recording.q, axis=0).any():
        return recording  # where no joint moves there is no motion to tell of
    reach = sum(arm.lengths) + sum(math.dist(joint.origin_translation, (0, 0, 0)) for joint in arm.joints)
    reach += sum(joint.range[1] - joint.range[0] for joint in arm.joints if not joint.revolute)
    if reach <= 0.0:
        return recording
    place = _placed(recording, arm)
    warnings = contradictions(recording, arm, place, reach, headers, rules)
    limit = max(rules.mistakes.far * place.misfit, rules.mistakes.gross * reach)
    gross = place.distance > limit
    rejected: dict[int, str] = {}
    for reasons in (
        _frozen_tip(recording, arm, reach, rules),
        _stuck(recording, arm, place, gross, limit, headers, rules),
        _slipped(recording, arm, place, gross, limit, reach, headers, rules),
    ):
        for index, reason in reasons.items():
            rejected.setdefault(index, reason)
    left = gross.copy()
    left[list(rejected)] = False
    jumps, said = _jumps(recording, place, left, rules)
    rejected |= jumps
    recording = replace(recording, warnings=(*recording.warnings, *warnings, *said))
    return recording.without([RejectedRow(int(recording.row[k]), reason) for k, reason in sorted(rejected.items())])


def _placed(recording: Recording, arm: Arm) -> Placement:
    free, tool = recording.frame == "free", recording.tool == "free"
    return placed(arm, recording.q, recording.tip, frame=free, tool=tool)


def _frozen_tip(recording: Recording, arm: Arm, reach: float, rules: Rules) -> dict[int, str]:
    """Rows that hold the same tip as the row before, to the last digit, although the joints moved."""
    tips, _ = nominal(arm, recording.q, recording.tip.shape[1])
    still = (np.diff(recording.tip, axis=0) == 0.0).all(axis=1)
    reasons: dict[int, str] = {}
    if still.mean() > rules.mistakes.few_rows:
        return reasons  # an instrument that is this coarse repeats itself anyway
    source = 0
    for index in range(1, recording.size):
        if not still[index - 1]:
            source = index
        elif float(np.linalg.norm(tips[index] - tips[source])) > rules.mistakes.still * reach:
            reasons[index] = (
                f"the tip is that of row {recording.row[source]} to the last digit although the joints moved"
            )
    return reasons


def _stuck(
    recording: Recording,
    arm: Arm,
    place: Placement,
    gross: Mask,
    limit: float,
    headers: Mapping[str, str],
    rules: Rules,
) -> dict[int, str]:
    """Rows in which a joint's reading stands still while the tip moves as if the joint did."""
    reasons: dict[int, str] = {}
    for index in range(arm.size if gross.any() else 0):
        name = headers.get(f"q{index + 1}", f"q{index + 1}")
        for rows in _runs_of_one_value(recording.q[:, index]):
            bad = rows[gross[rows]]
            if len(bad) < 2 or not _moves(recording, bad, index, limit):
                continue
            mask = np.zeros(recording.size, dtype=bool)
            mask[bad] = True
            left = distance_with_joint_free(recording, arm, place, mask, index)
            if (
                np.mean(left < np.maximum(rules.mistakes.better * place.distance[bad], 2.0 * place.misfit))
                < rules.mistakes.stuck
            ):
                continue
            first, last = recording.row[bad[0]], recording.row[bad[-1]]
            reason = f"{name} stands still while the tip moves (rows {first} to {last})"
            # Between them, poses happen to lie near where it stuck.
            for row in rows[(rows >= bad[0]) & (rows <= bad[-1])].tolist():
                reasons.setdefault(row, reason)
    return reasons


def _runs_of_one_value(values: Array) -> list[NDArray[np.int64]]:
    ends = np.flatnonzero(np.diff(values) != 0.0) + 1
    return [run for run in np.split(np.arange(len(values)), ends) if len(run) > 1]


def _moves(recording: Recording, rows: NDArray[np.int64], index: int, limit: float) -> bool:
    """Whether the arm moves within rows: the tip or another joint."""
    others = np.delete(recording.q[rows], index, axis=1)
    elsewhere = bool(others.size) and bool((np.ptp(others, axis=0) > 1e-3).any())
    return elsewhere or bool((np.ptp(recording.tip[rows], axis=0) > limit).any())


def _slipped(
    recording: Recording,
    arm: Arm,
    place: Placement,
    gross: Mask,
    limit: float,
    reach: float,
    headers: Mapping[str, str],
    rules: Rules,
) -> dict[int, str]:
    """Rows that fit as soon as a column is read in another unit."""
    reasons: dict[int, str] = {}
    bad = np.flatnonzero(gross)
    if not len(bad):
        return reasons
    near = max(0.5 * limit, 3.0 * place.misfit)
    closest = np.minimum(near, rules.mistakes.better * place.distance[bad])
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
            reasons[index] = change.said()
    return reasons


def _jumps(recording: Recording, place: Placement, gross: Mask, rules: Rules) -> tuple[dict[int, str], list[str]]:
    """Short, solitary contradictions are jumps and set aside; what lasts or comes back in repeats is only said."""
    reasons: dict[int, str] = {}
    bad = np.flatnonzero(gross)
    if not len(bad):
        return reasons, []
    lasting: list[int] = []
    for run in np.split(bad, np.flatnonzero(np.diff(bad) > 1) + 1):
        agree = len(run) > 1 and bool(
            (np.ptp(place.residual[run], axis=0) < rules.mistakes.agree * place.distance[run].min()).all()
        )
        if len(run) > rules.mistakes.short_run or agree:
            lasting += run.tolist()
            continue
        for index in run.tolist():
            far, middle = shown_length(float(place.distance[index])), shown_length(place.misfit)
            reasons[index] = f"jumps: the tip is {far} from the nominal one, the middle reading {middle}"
    if len(reasons) > rules.mistakes.few_rows * recording.size:
        lasting, reasons = sorted([*lasting, *reasons]), {}
    if not lasting:
        return reasons, []
    rows = rows_text(recording.row[lasting])
    farthest = shown_length(float(place.distance[lasting].max()))
    return reasons, [f"In {rows} the tip is up to {farthest} away from the nominal one. These rows are kept."]
