"""Whether joints and tips of a recording as a whole tell of the same motion: units, frame, tool, conventions.

What contradicts the arm as a whole is refused with what would mend it; a frame or tool that is a little off is said.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.arrays import nominal
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.placement import Placement, placed, turn_of
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError, format_quantity
from linkwright.core.units.reading import refusal, written

from .convention_search import Explained, explained_by_convention
from .units import UnitChange, unit_changes

Mask = NDArray[np.bool_]


def contradictions(
    recording: Recording, arm: Arm, place: Placement, reach: float, headers: Mapping[str, str], rules: Rules
) -> list[str]:
    """Sentences about the recording as a whole; `place` sets it against the arm as declared, `reach` is the arm's, m.

    Raises `InputError` where another unit, frame, tool or convention is needed, or nothing that is known would do.
    """
    if place.misfit > _much(place, reach, rules):
        _refuse_still_joint(recording, arm, place, reach, headers, rules)
        _refuse_units(recording, arm, place, reach, headers, rules)
    _refuse_conventions(recording, arm, place, reach, headers, rules)
    return _frame_sentences(recording, arm, place, reach, headers, rules)


def _much(place: Placement, reach: float, rules: Rules) -> float:
    """How far off the middle reading must be before the recording as a whole contradicts the arm, m."""
    return max(rules.mistakes.whole * _spread(place.modelled), rules.mistakes.gross * reach)


def _spread(points: Array) -> float:
    return float(np.median(np.linalg.norm(points - np.median(points, axis=0), axis=1)))


def _refuse_units(
    recording: Recording, arm: Arm, place: Placement, reach: float, headers: Mapping[str, str], rules: Rules
) -> None:
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
        good = share < rules.mistakes.whole and tried.misfit < rules.mistakes.better * place.misfit
        if recording.frame == "free" or recording.tool == "free":
            # What is free takes a point to anywhere: a unit that shrinks the data to one explains nothing.
            good &= tried.misfit < rules.mistakes.whole * _spread(recording.tip * change.tip)
        if good and (best is None or share < 0.999 * best[0]):
            best = (share, tried.misfit, change)
    if best is None:
        return
    _, misfit, change = best
    message = (
        f"{change.said()}: then the middle reading is {shown_length(misfit)} from the nominal tip, and not "
        f"{shown_length(place.misfit)}"
    )
    raise refusal(recording.file, "", message, {"columns": change.formulas()})


def _refuse_still_joint(
    recording: Recording, arm: Arm, place: Placement, reach: float, headers: Mapping[str, str], rules: Rules
) -> None:
    """Raise where a joint that never changes would have to move for the tip to be where it is."""
    for index in range(arm.size):
        if (
            np.ptp(recording.q[:, index]) > rules.residual.coarsest_count(arm.joints[index].revolute)
            or recording.frame == "free"
        ):
            continue
        left = distance_with_joint_free(recording, arm, place, np.ones(recording.size, dtype=bool), index)
        if np.median(left) < rules.mistakes.better * place.misfit and np.median(left) < _much(place, reach, rules):
            name = headers.get(f"q{index + 1}", f"q{index + 1}")
            message = "never changes, but the tip moves as if the joint did: its encoder stands still or was not logged"
            raise InputError(recording.file, name, message)


def _refuse_conventions(
    recording: Recording, arm: Arm, place: Placement, reach: float, headers: Mapping[str, str], rules: Rules
) -> None:
    """Raise where a joint that counts the other way, another zero, mirrored axes and the like make them agree."""
    if place.misfit < rules.mistakes.noticed * reach or recording.size < rules.search.least_observations:
        return
    gross = place.misfit > _much(place, reach, rules)
    frame, tool = recording.frame == "free", recording.tool == "free"

    def explained(*, frame: bool, tool: bool) -> Explained | None:
        q, tip = recording.q, recording.tip
        return explained_by_convention(
            arm, q, tip, headers, place.misfit, frame=frame, tool=tool, gross=gross, rules=rules
        )

    cause, further = explained(frame=frame, tool=tool), dict[str, str]()
    if not (frame and tool):
        both = placed(arm, recording.q, recording.tip, frame=True, tool=True)
        free = both.misfit
        turned = placed(arm, recording.q, recording.tip, frame=True, tool=tool).misfit
        if cause is None and gross and free >= rules.mistakes.better * place.misfit:
            cause, further = explained(frame=True, tool=True), {"frame": "free", "tool": "free"}
        elif cause is not None and turned <= rules.mistakes.simpler * cause.misfit:
            return  # a frame that was turned says as much, and is commoner
        elif cause is not None and free <= rules.mistakes.simpler * cause.misfit:
            # A tool says as much: what is commoner with both free beside the convention too, the smaller tool says.
            beside = placed(
                cause.slip.read(arm), *cause.slip.applied(recording.q, recording.tip), frame=True, tool=True
            )
            smaller = np.linalg.norm(beside.tool) < rules.mistakes.better * np.linalg.norm(both.tool)
            if beside.misfit > rules.mistakes.simpler * free or not smaller:
                return
    if cause is not None:
        message = (
            f"{cause.sentence()}, it seems: then the middle reading is {shown_length(cause.misfit)} from the nominal "
            f"tip, and not {shown_length(place.misfit)}"
        )
        columns = cause.slip.columns(arm, headers)
        remedy = {**({"columns": columns} if columns else {}), **further}
        raise refusal(recording.file, "", message, *([remedy] if remedy else []))


def _frame_sentences(
    recording: Recording, arm: Arm, place: Placement, reach: float, headers: Mapping[str, str], rules: Rules
) -> list[str]:
    """Say, or raise where the error is no small one, that another frame or tool makes joints and tip agree."""
    if place.misfit < rules.mistakes.gross * reach or recording.size < 2 * rules.residual.enough_freedom:
        return []
    known_frame, known_tool = recording.frame == "known", recording.tool == "known"
    tries: list[tuple[dict[str, str], Placement]] = []
    for frame, tool in ((True, False), (False, True), (True, True)):
        if (frame and not known_frame) or (tool and not known_tool):
            continue
        free = placed(
            arm,
            recording.q,
            recording.tip,
            frame=frame or not known_frame,
            tool=tool or not known_tool,
        )
        tries.append(({name: "free" for name, is_free in (("frame", frame), ("tool", tool)) if is_free}, free))
    good = [(remedy, free) for remedy, free in tries if free.misfit < rules.mistakes.better * place.misfit]
    if not good:
        if place.misfit > _much(place, reach, rules):
            text = f"the middle reading is {shown_length(place.misfit)} away from the nominal tip"
            ask = "do the arm file and the recording belong together?"
            still = [headers.get(f"q{k + 1}", f"q{k + 1}") for k in range(arm.size) if np.ptp(recording.q[:, k]) == 0.0]
            if still:
                ask += f" {', '.join(still)} never changes: was it logged?"
            text += f", and no other unit, frame, tool, zero, sign or order that was tried explains it: {ask}"
            # No small displacements explain what is twice as far off.
            if place.misfit > 2.0 * _much(place, reach, rules) or still:
                raise InputError(recording.file, "", text)
            return [f"{text[0].upper()}{text[1:]}"]
        return []
    least = min(free.misfit for _, free in good)
    remedy, free = next((remedy, free) for remedy, free in good if free.misfit <= rules.mistakes.simpler * least + 1e-6)
    shift, turn = float(np.linalg.norm(free.translation)), turn_of(free.rotation)
    parts: list[str] = []
    if "frame" in remedy:
        # The shift of the origin alone means little where the frame is turned: what the tips move by is what counts.
        parts.append(f"a frame turned by {math.degrees(turn):.3g} deg and shifted by {shown_length(shift)}")
    if "tool" in remedy:
        parts.append(f"a tool that reaches {shown_length(float(np.linalg.norm(free.tool)))} further")
    falls = f"from {shown_length(place.misfit)} to {shown_length(free.misfit)}"
    change = f"{' and '.join(parts)} would bring the middle reading {falls}"
    large = turn > rules.residual.turned or place.misfit > rules.mistakes.whole * reach
    if large:
        message = (
            "is measured in another frame than the arm's" if "frame" in remedy else "does not hold the arm file's tip"
        )
        raise refusal(recording.file, "", f"{message}: {change}", remedy)
    return [f"{change[0].upper()}{change[1:]}: where nobody knows better, write {written(remedy)} in recording.yaml."]


def distance_with_joint_free(recording: Recording, arm: Arm, place: Placement, rows: Mask, index: int) -> Array:
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


def shown_length(value: float) -> str:
    """A length (m) in words, three digits."""
    return format_quantity(value, "length", digits=3)
