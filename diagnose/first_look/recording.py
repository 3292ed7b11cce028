"""Whether joints and tips of a recording as a whole tell of the same motion: units, frame, tool, conventions, and one
number of a joint.

What contradicts the arm as a whole is refused with what would mend it; a frame or tool that is a little off is said.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

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

from .library import Library
from .search import Judged, likeliest
from .tips import TipEvidence
from .transformation import Transformation

Mask = NDArray[np.bool_]
_LATE = 5
"""Rows by which tips may stand beside their joints, at most."""


def contradictions(
    recording: Recording, arm: Arm, place: Placement, reach: float, headers: Mapping[str, str], rules: Rules
) -> list[str]:
    """Sentences about the recording as a whole; `place` sets it against the arm as declared, `reach` is the arm's, m.

    Raises `InputError` where another unit, frame, tool or convention is needed, or nothing that is known would do.
    """
    gross = place.misfit > _much(place, reach, rules)
    if gross:
        _refuse_still_joint(recording, arm, place, reach, headers, rules)
    _refuse_transformed(recording, arm, place, reach, headers, rules, gross=gross)
    return _frame_sentences(recording, arm, place, reach, headers, rules)


def _much(place: Placement, reach: float, rules: Rules) -> float:
    """How far off the middle reading must be before the recording as a whole contradicts the arm, m."""
    return max(rules.mistakes.whole * _spread(place.modelled), rules.mistakes.gross * reach)


def _spread(points: Array) -> float:
    return float(np.median(np.linalg.norm(points - np.median(points, axis=0), axis=1)))


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


def _refuse_transformed(
    recording: Recording,
    arm: Arm,
    place: Placement,
    reach: float,
    headers: Mapping[str, str],
    rules: Rules,
    *,
    gross: bool,
) -> None:
    """Raise where another unit, a joint that counts the other way or goes by another ratio, mirrored axes and the like
    make joints and tip agree."""
    if place.misfit < rules.mistakes.noticed * reach:
        return
    frame, tool = recording.frame == "free", recording.tool == "free"
    limit = rules.mistakes.better * place.misfit

    def explained(*, frame: bool, tool: bool) -> Judged | None:
        library = Library(arm, headers, recording.tip.shape[1], frame=frame)
        look = TipEvidence(library, recording.q, recording.tip, frame, tool, reach, limit, gross, rules)
        # Readings taken on the move lag by a row or two as well; what they are off by is small beside the motion.
        return _explained(look, place.misfit)

    cause, further = explained(frame=frame, tool=tool), dict[str, str]()
    if not (frame and tool):
        both = placed(arm, recording.q, recording.tip, frame=True, tool=True)
        free = both.misfit
        turned = placed(arm, recording.q, recording.tip, frame=True, tool=tool).misfit
        if cause is None and gross and free >= rules.mistakes.better * place.misfit:
            cause, further = explained(frame=True, tool=True), {"frame": "free", "tool": "free"}
        elif cause is not None and turned <= rules.mistakes.simpler * cause.left:
            return  # a frame that was turned says as much, and is commoner
        elif cause is not None and free <= rules.mistakes.simpler * cause.left:
            # A tool says as much: what is commoner with both free beside the convention too, the smaller tool says.
            beside = placed(
                cause.transformation.read(arm),
                *cause.transformation.applied(recording.q, recording.tip),
                frame=True,
                tool=True,
            )
            smaller = np.linalg.norm(beside.tool) < rules.mistakes.better * np.linalg.norm(both.tool)
            if beside.misfit > rules.mistakes.simpler * free or not smaller:
                return
    if cause is not None:
        whole = cause.transformation
        said = whole.sentence()
        change = f"{shown_length(cause.left)} from the nominal tip, and not {shown_length(place.misfit)}"
        message = f"{said}{'' if 'seem' in said else ', it seems'}: then the middle reading is {change}"
        columns = whole.columns(arm, headers)
        remedy = {**({"columns": columns} if columns else {}), **further}
        raise refusal(recording.file, "", message, *([remedy] if remedy else []))


def _explained(look: TipEvidence, misfit: float) -> Judged | None:
    """The likeliest transformation that explains why the middle reading is off by `misfit`, None where none does."""
    if look.gross and (late := _other_rows(look)) is not None:
        return late
    # Frame, tool and a wrong convention together fit a few points by chance.
    poses = len(np.unique(np.round(look.q, 3), axis=0))
    few = poses < look.rules.search.least_observations
    if few and (look.frame or look.tool or poses < look.rules.residual.enough_freedom):
        return None
    singles = [] if few else look.library.of_tips()
    units = [] if few else list(look.library.units())
    # A frame that is free takes up much; beside another mistake, nobody gets a single column's unit wrong.
    kinds = [each for each in units if len(each.acts_on) in (look.tip.shape[1], look.arm.size)]
    again = [*singles, *([] if look.frame else kinds)] if look.gross else []
    tried = likeliest(look, look.given(misfit), [*singles, *(units if look.gross else [])], again)
    explained = next((each for each in tried if each.explains), None)
    if explained is None and look.frame and look.gross and (unit := _unit_by_size(look, kinds)) is not None:
        # It hides what another unit of the tips gains beside another mistake, but not how far they spread.
        further = _explained(replace(look, tip=look.tip @ unit.tip.T), misfit)
        return further and replace(further, transformation=further.transformation.beside(unit))
    return explained


def _unit_by_size(look: TipEvidence, units: Sequence[Transformation]) -> Transformation | None:
    """The unit of all tips under which they spread as the arm's do; None where they do as they are."""
    went = _spread(nominal(look.arm, look.q, look.tip.shape[1])[0]) / _spread(look.tip)
    tips = [each for each in units if len(each.acts_on) == look.tip.shape[1] and np.ptp(np.diag(each.tip)) == 0.0]
    off = [abs(math.log(went / each.tip[0, 0])) for each in (*tips, look.library.none)]
    return (*tips, None)[int(np.argmin(off))]


def _other_rows(look: TipEvidence) -> Judged | None:
    """Tips that stand some rows beside their joints, or in the opposite or any other order."""

    def judged(look: TipEvidence, late: int, said: str) -> Judged | None:
        shifted = replace(look.library.none, late=late, said=(said,))
        left = look.confirmed(shifted)
        return Judged((shifted,), shifted, 0.0, left, explains=True) if left < limit else None

    limit = min(look.limit, look.rules.mistakes.whole * _spread(look.tip))
    for rows in range(1, min(_LATE, len(look.q) // 4) + 1):
        for late in (rows, -rows):
            text = f"{rows} row{'s' if rows > 1 else ''} {'later' if late > 0 else 'earlier'}"
            if each := judged(look, late, f"the tips stand {text} than the joints that they belong to"):
                return each
    if each := judged(replace(look, tip=look.tip[::-1]), 0, "the tips stand in the opposite order"):
        return each
    if look.frame or look.tool:
        return None
    from scipy.spatial import KDTree

    tips, _ = nominal(look.arm, look.q, look.tip.shape[1])
    left = float(np.median(KDTree(tips).query(look.tip)[0]))
    # By chance the nearest of N tips is about N^(-1/D) of their spread away.
    by_chance = float(np.linalg.norm(tips.std(axis=0))) * len(tips) ** (-1.0 / tips.shape[1])
    if left < min(limit, look.rules.mistakes.better * by_chance):
        said = ("the tips stand in another order than the joints",)
        return Judged((), replace(look.library.none, said=said), 0.0, left, explains=True)
    return None


def _frame_sentences(
    recording: Recording, arm: Arm, place: Placement, reach: float, headers: Mapping[str, str], rules: Rules
) -> list[str]:
    """Say, or raise where the error is no small one, that another frame or tool makes joints and tip agree."""
    if place.misfit < rules.mistakes.gross * reach or recording.size < 2 * rules.residual.enough_freedom:
        return []
    tries = _other_placements(recording, arm)
    limit = min(rules.mistakes.better * place.misfit, _left_by_geometry(recording, arm, place))
    good = [(remedy, free) for remedy, free in tries if free.misfit < limit]
    if not good:
        return _unexplained(recording, arm, place, reach, headers, rules)
    least = min(free.misfit for _, free in good)
    remedy, free = next((remedy, free) for remedy, free in good if free.misfit <= rules.mistakes.simpler * least + 1e-6)
    turn = turn_of(free.rotation)
    falls = f"from {shown_length(place.misfit)} to {shown_length(free.misfit)}"
    change = f"{_moved(remedy, free, turn)} would bring the middle reading {falls}"
    large = turn > rules.residual.turned or place.misfit > rules.mistakes.whole * reach
    if large:
        message = (
            "is measured in another frame than the arm's" if "frame" in remedy else "does not hold the arm file's tip"
        )
        raise refusal(recording.file, "", f"{message}: {change}", remedy)
    return [f"{change[0].upper()}{change[1:]}: where nobody knows better, write {written(remedy)} in recording.yaml."]


def _left_by_geometry(recording: Recording, arm: Arm, place: Placement) -> float:
    """What the middle reading is off by (m) where joints count from zeros and links have lengths of their own."""
    step, width = 1e-6, recording.tip.shape[1]
    tips, axes = nominal(arm, recording.q, width)
    moved = [nominal(arm, recording.q + step * each, width) for each in np.eye(arm.size)]
    for k, link in enumerate(arm.links):
        links = (*arm.links[:k], replace(link, length=link.length + step), *arm.links[k + 1 :])
        moved.append(nominal(replace(arm, links=links), recording.q, width))
    slopes = np.stack([(t + a @ place.tool - tips - axes @ place.tool).ravel() / step for t, a in moved], axis=1)
    goal = place.residual.ravel()
    left = goal - slopes @ np.linalg.lstsq(slopes, goal, rcond=None)[0]
    return float(np.median(np.linalg.norm(left.reshape(-1, width), axis=1)))


def _other_placements(recording: Recording, arm: Arm) -> list[tuple[dict[str, str], Placement]]:
    """The recording with its frame, its tool or both free where they are known, and the settings that say so."""
    known_frame, known_tool = recording.frame == "known", recording.tool == "known"
    tries: list[tuple[dict[str, str], Placement]] = []
    for frame, tool in ((True, False), (False, True), (True, True)):
        if (frame and not known_frame) or (tool and not known_tool):
            continue
        free = placed(arm, recording.q, recording.tip, frame=frame or not known_frame, tool=tool or not known_tool)
        tries.append(({name: "free" for name, is_free in (("frame", frame), ("tool", tool)) if is_free}, free))
    return tries


def _unexplained(
    recording: Recording, arm: Arm, place: Placement, reach: float, headers: Mapping[str, str], rules: Rules
) -> list[str]:
    """Say, or raise where the error is twice as much, that nothing makes joints and tip agree."""
    much = _much(place, reach, rules)
    if place.misfit <= much:
        return []
    text = f"the middle reading is {shown_length(place.misfit)} away from the nominal tip"
    ask = "do the arm file and the recording belong together?"
    still = [headers.get(f"q{k + 1}", f"q{k + 1}") for k in range(arm.size) if np.ptp(recording.q[:, k]) == 0.0]
    if still:
        ask += f" {', '.join(still)} never changes: was it logged?"
    text += f", and no other unit, frame, tool, zero, sign or order that was tried explains it: {ask}"
    # No small displacements explain what is twice as far off.
    if place.misfit > 2.0 * much or still:
        raise InputError(recording.file, "", text)
    return [f"{text[0].upper()}{text[1:]}"]


def _moved(remedy: Mapping[str, str], free: Placement, turn: float) -> str:
    """By how much frame and tool are moved."""
    parts: list[str] = []
    if "frame" in remedy:
        # The shift of the origin alone means little where the frame is turned: what the tips move by is what counts.
        shift = shown_length(float(np.linalg.norm(free.translation)))
        parts.append(f"a frame turned by {math.degrees(turn):.3g} deg and shifted by {shift}")
    if "tool" in remedy:
        parts.append(f"a tool that reaches {shown_length(float(np.linalg.norm(free.tool)))} further")
    return " and ".join(parts)


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
