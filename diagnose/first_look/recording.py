"""Whether joints and tips of a recording as a whole tell of the same motion: units, frame, tool, conventions, and one
number of a joint.

What contradicts the arm as a whole is refused with what would mend it; a frame or tool that is a little off is said.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.arrays import nominal
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.instruments.placement import Placement, placed, turn_of
from linkwright.core.diagnose.reading.foreign.headers import Headers
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError, format_quantity
from linkwright.core.units.reading import refusal, written

from .library import Library
from .search import Judged, likeliest
from .tips import TipEvidence
from .transformation import Transformation

_LATE = 5
"""Rows by which tips may stand beside their joints, at most."""


@dataclass(frozen=True)
class Tips:
    """A recording of the tip set against the arm as declared (`place`). `reach` is the arm's, m; `headers` are those of
    the columns by name (`q1`: `q1_deg`)."""

    recording: Recording
    arm: Arm
    place: Placement
    reach: float
    headers: Headers
    rules: Rules

    @property
    def much(self) -> float:
        """How far off the middle reading must be before the recording as a whole contradicts the arm, m."""
        mistakes = self.rules.mistakes
        return max(mistakes.whole * _spread(self.place.modelled), mistakes.gross * self.reach)

    def header(self, joint: int) -> str:
        """What the file calls a joint's (from 0) coordinate."""
        return self.headers.get(f"q{joint + 1}", f"q{joint + 1}")

    def placed(self, *, frame: bool, tool: bool) -> Placement:
        """The same with frame and tool as free as asked."""
        return placed(self.arm, self.recording.q, self.recording.tip, frame=frame, tool=tool)

    def off_with_joint_free(self, joint: int, rows: NDArray[np.bool_] | None = None) -> Array:
        """How far the measured tips (of some rows) are from what the arm can reach by moving one joint alone, m."""
        return _off_with_joint_free(self, joint, np.ones(self.recording.size, dtype=bool) if rows is None else rows)


def contradictions(seen: Tips) -> list[str]:
    """Sentences about the recording as a whole.

    Raises `InputError` where another unit, frame, tool or convention is needed, or nothing that is known would do.
    """
    gross = seen.place.misfit > seen.much
    if gross:
        _refuse_still_joint(seen)
    _refuse_transformed(seen, gross=gross)
    return _frame_sentences(seen)


def _spread(points: Array) -> float:
    return float(np.median(np.linalg.norm(points - np.median(points, axis=0), axis=1)))


def _refuse_still_joint(seen: Tips) -> None:
    """Raise where a joint that never changes would have to move for the tip to be where it is."""
    recording, joints, rules = seen.recording, seen.arm.joints, seen.rules
    for index in range(seen.arm.size if recording.frame != "free" else 0):
        if np.ptp(recording.q[:, index]) > rules.residual.coarsest_count(joints[index].revolute):
            continue
        left = float(np.median(seen.off_with_joint_free(index)))
        if left < rules.mistakes.better * seen.place.misfit and left < seen.much:
            message = "never changes, but the tip moves as if the joint did: its encoder stands still or was not logged"
            raise InputError(recording.file, seen.header(index), message)


def _refuse_transformed(seen: Tips, *, gross: bool) -> None:
    """Raise where another unit, a joint that counts the other way or goes by another ratio, mirrored axes and the like
    make joints and tip agree."""
    recording, misfit, rules = seen.recording, seen.place.misfit, seen.rules.mistakes
    if misfit < rules.noticed * seen.reach:
        return
    frame, tool = recording.frame == "free", recording.tool == "free"

    def explained(*, frame: bool, tool: bool) -> Judged | None:
        library, limit = Library(seen.arm, seen.headers, recording.tip.shape[1], frame=frame), rules.better * misfit
        look = TipEvidence(library, recording.q, recording.tip, frame, tool, seen.reach, limit, gross, seen.rules)
        # Readings taken on the move lag by a row or two as well; what they are off by is small beside the motion.
        return _explained(look, misfit)

    cause, further = explained(frame=frame, tool=tool), dict[str, str]()
    if not (frame and tool):
        both = seen.placed(frame=True, tool=True)
        if cause is None and gross and both.misfit >= rules.better * misfit:
            cause, further = explained(frame=True, tool=True), {"frame": "free", "tool": "free"}
        elif cause is not None and _as_well(seen, cause, both, tool=tool):
            return
    if cause is not None:
        whole = cause.transformation
        said = whole.sentence()
        change = f"{shown_length(cause.left)} from the nominal tip, and not {shown_length(misfit)}"
        message = f"{said}{'' if 'seem' in said else ', it seems'}: then the middle reading is {change}"
        columns = whole.columns(seen.arm, seen.headers)
        remedy = {**({"columns": columns} if columns else {}), **further}
        raise seen.headers.refusal(recording.file, "", message, *([remedy] if remedy else []))


def _as_well(seen: Tips, cause: Judged, both: Placement, *, tool: bool) -> bool:
    """Whether a frame that was turned says as much as a cause, and is commoner, or a tool does (`both` are free): with
    both free beside the cause too, the smaller tool is the commoner."""
    rules, whole = seen.rules.mistakes, cause.transformation
    if seen.placed(frame=True, tool=tool).misfit <= rules.simpler * cause.left:
        return True
    if both.misfit > rules.simpler * cause.left:
        return False
    meant = whole.applied(seen.recording.q, seen.recording.tip)
    beside = placed(whole.read(seen.arm), *meant, frame=True, tool=True)
    smaller = np.linalg.norm(beside.tool) < rules.better * np.linalg.norm(both.tool)
    return bool(beside.misfit > rules.simpler * both.misfit or not smaller)


def _explained(look: TipEvidence, misfit: float) -> Judged | None:
    """The likeliest transformation that explains why the middle reading is off by `misfit`, None where none does."""
    if look.gross and (late := _other_rows(look)) is not None:
        return late
    if (shown := _shown(look)) is None:
        return None
    singles, units = shown
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


def _shown(look: TipEvidence) -> tuple[list[Transformation], list[Transformation]] | None:
    """Single transformations and units of which the poses tell; none but numbers of joints where they are few, and None
    where frame, tool and a wrong convention together fit them by chance."""
    poses = len(np.unique(np.round(look.q, 3), axis=0))
    if poses >= look.rules.search.least_observations:
        return look.library.of_tips(), list(look.library.units())
    by_chance = look.frame or look.tool or poses < look.rules.residual.enough_freedom
    return None if by_chance else ([], [])


def _unit_by_size(look: TipEvidence, units: Sequence[Transformation]) -> Transformation | None:
    """The unit of all tips under which they spread as the arm's do; None where they do as they are."""
    went = _spread(nominal(look.arm, look.q, look.tip.shape[1])[0]) / _spread(look.tip)
    # A unit of the joints leaves the tips as they are, also where there are as many joints as coordinates.
    tips = [each for each in units if each.tip[0, 0] != 1.0 and np.ptp(np.diag(each.tip)) == 0.0]
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


def _frame_sentences(seen: Tips) -> list[str]:
    """Say, or raise where the error is no small one, that another frame or tool makes joints and tip agree."""
    recording, place, rules = seen.recording, seen.place, seen.rules
    if place.misfit < rules.mistakes.gross * seen.reach or recording.size < 2 * rules.residual.enough_freedom:
        return []
    limit = min(rules.mistakes.better * place.misfit, _left_by_geometry(seen))
    good = [(remedy, free) for remedy, free in _other_placements(seen) if free.misfit < limit]
    if not good:
        return _unexplained(seen)
    least = min(free.misfit for _, free in good)
    remedy, free = next((remedy, free) for remedy, free in good if free.misfit <= rules.mistakes.simpler * least + 1e-6)
    turn = turn_of(free.rotation)
    falls = f"from {shown_length(place.misfit)} to {shown_length(free.misfit)}"
    change = f"{_moved(remedy, free, turn)} would bring the middle reading {falls}"
    if turn > rules.residual.turned or place.misfit > rules.mistakes.whole * seen.reach:
        wrong = (
            "is measured in another frame than the arm's" if "frame" in remedy else "does not hold the arm file's tip"
        )
        raise refusal(recording.file, "", f"{wrong}: {change}", remedy)
    return [f"{change[0].upper()}{change[1:]}: where nobody knows better, write {written(remedy)} in recording.yaml."]


def _left_by_geometry(seen: Tips) -> float:
    """What the middle reading is off by (m) where joints count from zeros and links have lengths of their own."""
    arm, q, place, step = seen.arm, seen.recording.q, seen.place, 1e-6
    width = seen.recording.tip.shape[1]
    tips, axes = nominal(arm, q, width)
    moved = [nominal(arm, q + step * each, width) for each in np.eye(arm.size)]
    for k, link in enumerate(arm.links):
        links = (*arm.links[:k], replace(link, length=link.length + step), *arm.links[k + 1 :])
        moved.append(nominal(replace(arm, links=links), q, width))
    slopes = np.stack([(t + a @ place.tool - tips - axes @ place.tool).ravel() / step for t, a in moved], axis=1)
    goal = place.residual.ravel()
    left = goal - slopes @ np.linalg.lstsq(slopes, goal, rcond=None)[0]
    return float(np.median(np.linalg.norm(left.reshape(-1, width), axis=1)))


def _other_placements(seen: Tips) -> list[tuple[dict[str, str], Placement]]:
    """The recording with its frame, its tool or both free where they are known, and the settings that say so."""
    known = {"frame": seen.recording.frame == "known", "tool": seen.recording.tool == "known"}
    tries: list[tuple[dict[str, str], Placement]] = []
    for names in (("frame",), ("tool",), ("frame", "tool")):
        if all(known[name] for name in names):
            free = {name: name in names or not is_known for name, is_known in known.items()}
            tries.append((dict.fromkeys(names, "free"), seen.placed(frame=free["frame"], tool=free["tool"])))
    return tries


def _unexplained(seen: Tips) -> list[str]:
    """Say, or raise where the error is twice as much, that nothing makes joints and tip agree."""
    recording, misfit = seen.recording, seen.place.misfit
    if misfit <= seen.much:
        return []
    text = f"the middle reading is {shown_length(misfit)} away from the nominal tip"
    ask = "do the arm file and the recording belong together?"
    still = [seen.header(k) for k in range(seen.arm.size) if np.ptp(recording.q[:, k]) == 0.0]
    if still:
        ask += f" {', '.join(still)} never changes: was it logged?"
    text += f", and no other unit, frame, tool, zero, sign or order that was tried explains it: {ask}"
    # No small displacements explain what is twice as far off.
    if misfit > 2.0 * seen.much or still:
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


def _off_with_joint_free(seen: Tips, index: int, rows: NDArray[np.bool_]) -> Array:
    arm, place, q = seen.arm, seen.place, seen.recording.q[rows]
    goal = (place.modelled + place.residual)[rows]
    joint = arm.joints[index]
    low, high = (-math.pi, math.pi) if joint.revolute else joint.range
    step = (high - low) / 180.0
    best = np.full(len(q), np.inf)
    at = q[:, index].copy()
    width = goal.shape[1]

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
