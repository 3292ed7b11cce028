"""Whether joints and tip tell of the same motion, row by row: stuck encoders and trackers, slips of units, jumps.

Only what is far beyond any physics of an arm counts here: more than ten times what the middle reading is off by, and
more than half a per cent of the reach.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.arrays import nominal
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.instruments.placement import Placement, placed
from linkwright.core.diagnose.reading.foreign.headers import Headers
from linkwright.core.diagnose.recording import Recording, RejectedRow
from linkwright.core.diagnose.rules.rules import RULES, Rules
from linkwright.core.sections.numeric import Array
from linkwright.core.units.lists import rows_text

from .recording import Tips, contradictions, shown_length
from .units import IN_A_ROW, unit_changes, widest

Mask = NDArray[np.bool_]


def motion_checked(recording: Recording, arm: Arm, headers: Headers, *, rules: Rules = RULES) -> Recording:
    """The recording less rows in which joints and tip contradict each other grossly. Raises `InputError`."""
    if recording.slots is not None:
        return recording  # whatever was measured in part is looked at by `instruments.checks`
    if recording.size < rules.residual.enough_freedom or not np.ptp(recording.q, axis=0).any():
        return recording  # where no joint moves there is no motion to tell of
    reach = sum(arm.lengths) + sum(math.dist(joint.origin_translation, (0, 0, 0)) for joint in arm.joints)
    reach += sum(joint.range[1] - joint.range[0] for joint in arm.joints if not joint.revolute)
    if reach <= 0.0:
        return recording
    frame, tool = recording.frame == "free", recording.tool == "free"
    place = placed(arm, recording.q, recording.tip, frame=frame, tool=tool)
    rows = _Rows(Tips(recording, arm, place, reach, headers, rules))
    warnings = contradictions(rows.seen)
    rejected = {**rows.slipped(), **rows.stuck(), **rows.frozen_tip()}
    left = rows.gross.copy()
    left[list(rejected)] = False
    jumps, said = _jumps(recording, place, left, rules)
    rejected |= jumps
    recording = replace(recording, warnings=(*recording.warnings, *warnings, *said))
    return recording.without([RejectedRow(int(recording.row[k]), reason) for k, reason in sorted(rejected.items())])


class _Rows:
    """Rows that contradict the arm grossly, further off than `limit` (m), by what is wrong with them."""

    def __init__(self, seen: Tips) -> None:
        self.seen, self.recording, self.place = seen, seen.recording, seen.place
        self.rules = seen.rules.mistakes
        self.limit = max(self.rules.far * self.place.misfit, self.rules.gross * seen.reach)
        self.gross: Mask = self.place.distance > self.limit

    def frozen_tip(self) -> dict[int, str]:
        """Rows that hold the same tip as the row before, to the last digit, although the joints moved."""
        recording = self.recording
        tips, _ = nominal(self.seen.arm, recording.q, recording.tip.shape[1])
        still = (np.diff(recording.tip, axis=0) == 0.0).all(axis=1)
        reasons: dict[int, str] = {}
        if still.mean() > self.rules.few_rows:
            return reasons  # an instrument that is this coarse repeats itself anyway
        source = 0
        for index in range(1, recording.size):
            if not still[index - 1]:
                source = index
            elif float(np.linalg.norm(tips[index] - tips[source])) > self.rules.still * self.seen.reach:
                same = f"the tip is that of row {recording.row[source]} to the last digit"
                reasons[index] = f"{same} although the joints moved"
        return reasons

    def stuck(self) -> dict[int, str]:
        """Rows in which a joint's reading stands still while the tip moves as if the joint did."""
        recording, reasons = self.recording, dict[int, str]()
        for index in range(self.seen.arm.size if self.gross.any() else 0):
            for rows in _runs_of_one_value(recording.q[:, index]):
                bad = rows[self.gross[rows]]
                if len(bad) < 2 or not _moves(recording, bad, index, self.limit) or not self._explained(bad, index):
                    continue
                first, last = recording.row[bad[0]], recording.row[bad[-1]]
                reason = f"{self.seen.header(index)} stands still while the tip moves (rows {first} to {last})"
                # Between them, poses happen to lie near where it stuck.
                for row in rows[(rows >= bad[0]) & (rows <= bad[-1])].tolist():
                    reasons.setdefault(row, reason)
        return reasons

    def _explained(self, bad: NDArray[np.int64], joint: int) -> bool:
        """Whether most of some rows fit where one joint (from 0) may stand anywhere."""
        mask = np.zeros(self.recording.size, dtype=bool)
        mask[bad] = True
        left = self.seen.off_with_joint_free(joint, mask)
        near = np.maximum(self.rules.better * self.place.distance[bad], 2.0 * self.place.misfit)
        return bool(np.mean(left < near) >= self.rules.stuck)

    def slipped(self) -> dict[int, str]:
        """Rows that fit as soon as a column is read in another unit."""
        recording, place, arm = self.recording, self.place, self.seen.arm
        reasons: dict[int, str] = {}
        bad = np.flatnonzero(self.gross)
        if not len(bad):
            return reasons
        q, tip, width = recording.q[bad], recording.tip[bad], recording.tip.shape[1]
        closest = np.minimum(max(0.5 * self.limit, 3.0 * place.misfit), self.rules.better * place.distance[bad])
        for change in unit_changes(arm, width, self.seen.headers):
            if not all(factor in IN_A_ROW for factor in change.factors):
                continue
            # Small numbers fit much: a column is only made smaller where it is too large for any arm.
            beyond = np.where(change.q < 1.0, np.abs(q) > widest(arm), True).all(axis=1)
            beyond &= np.where(change.tip < 1.0, np.abs(tip) > 2.0 * self.seen.reach, True).all(axis=1)
            tips, axes = nominal(arm, q * change.q, width)
            measured = (tip * change.tip) @ place.rotation.T + place.translation
            apart = np.linalg.norm(measured - tips - axes @ place.tool, axis=1)
            fits = beyond & (apart < closest)
            closest = np.where(fits, apart, closest)
            reasons |= dict.fromkeys(bad[fits].tolist(), change.said())
        return reasons


def _runs_of_one_value(values: Array) -> list[NDArray[np.int64]]:
    ends = np.flatnonzero(np.diff(values) != 0.0) + 1
    return [run for run in np.split(np.arange(len(values)), ends) if len(run) > 1]


def _moves(recording: Recording, rows: NDArray[np.int64], index: int, limit: float) -> bool:
    """Whether the arm moves within rows: the tip or another joint."""
    others = np.delete(recording.q[rows], index, axis=1)
    elsewhere = bool(others.size) and bool((np.ptp(others, axis=0) > 1e-3).any())
    return elsewhere or bool((np.ptp(recording.tip[rows], axis=0) > limit).any())


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
