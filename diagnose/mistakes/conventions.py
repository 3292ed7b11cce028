"""Mistakes of convention, one by one, and what to write against them: joints that count the other way, from another
zero or together with a neighbour, columns that changed places, a mirrored frame, the arm's rows of dh in the other
convention."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.files.denavit_hartenberg import of_the_other_convention
from linkwright.core.diagnose.reading.columns import formulas
from linkwright.core.sections.numeric import Array

_QUARTER = math.pi / 2.0
_SIGNS = 7
"""Joints that may count the other way together, at most."""


@dataclass(frozen=True)
class Slip:
    """A mistake: joints are meant as `matrix` q + `offset`, the tip as `axes` @ tip, `late` rows later. `said` tells
    what is wrong, `parts` numbers the single mistakes that it is made of. `other_dh`: the arm's rows of dh are meant in
    the other convention."""

    matrix: Array
    offset: Array
    axes: Array
    late: int
    said: tuple[str, ...]
    acts_on: frozenset[str]
    parts: frozenset[int] = frozenset()
    other_dh: bool = False

    def beside(self, other: Slip) -> Slip:
        """Both mistakes."""
        return Slip(
            self.matrix + other.matrix - np.eye(len(self.offset)),  # each acts on rows of its own
            self.offset + other.offset,
            other.axes @ self.axes,
            self.late + other.late,
            (*self.said, *other.said),
            self.acts_on | other.acts_on,
            other_dh=self.other_dh or other.other_dh,
        )

    def applied(self, q: Array, tip: Array) -> tuple[Array, Array]:
        """Joints and tips as they were meant, rows without a fellow left out."""
        late = self.late
        joints = q[: len(q) - late] if late > 0 else q[-late:]
        tips = tip[late:] if late > 0 else tip[: len(tip) + late]
        return joints @ self.matrix.T + self.offset, tips @ self.axes.T

    def read(self, arm: Arm) -> Arm:
        """The arm as it was meant."""
        return of_the_other_convention(arm) or arm if self.other_dh else arm

    def columns(self, arm: Arm, headers: Mapping[str, str]) -> dict[str, str]:
        """The formulas that mend it, by header."""
        joints = [headers.get(f"q{k + 1}", "") for k in range(arm.size)]
        tip = [headers.get(axis, "") for axis in "xyz"[: len(self.axes)]]
        return formulas(joints, arm, self.matrix, self.offset) | formulas(tip, arm, self.axes)


def no_slip(size: int, width: int) -> Slip:
    """Nothing wrong, for `size` joints and `width` components of the tip."""
    return Slip(np.eye(size), np.zeros(size), np.eye(width), 0, (), frozenset())


def single_slips(arm: Arm, width: int, headers: Mapping[str, str], *, frame: bool) -> Iterator[Slip]:
    """Every single mistake, those that are made most first."""
    none = no_slip(arm.size, width)
    names = [headers.get(f"q{k + 1}", f"q{k + 1}") for k in range(arm.size)]
    turns = [k for k, joint in enumerate(arm.joints) if joint.revolute]
    if of_the_other_convention(arm) is not None:
        modified = arm.joints[0].dh is not None and arm.joints[0].dh.modified
        said = f"the arm file's dh are meant with `convention: {'standard' if modified else 'modified'}` in each"
        yield replace(none, said=(said,), acts_on=frozenset({"arm"}), other_dh=True)
    for k in range(arm.size):
        yield _signs(none, (k,), names)
    for k, angle in itertools.product(turns, (_QUARTER, -_QUARTER, 2.0 * _QUARTER)):
        yield zero_slip(none, k, angle, names[k])
    for k in turns:
        for other, sign in itertools.product((k - 1, k + 1), (1.0, -1.0)):
            if other in turns:
                yield _coupled(none, k, other, sign, names)
    for one, other in itertools.combinations(range(arm.size), 2):
        if arm.joints[one].revolute == arm.joints[other].revolute:
            matrix = np.eye(arm.size)
            matrix[[one, other]] = matrix[[other, one]]
            sentence = f"{names[one]} and {names[other]} have changed places"
            yield replace(none, matrix=matrix, said=(sentence,), acts_on=frozenset({f"q{one}", f"q{other}"}))
    yield from _axes(none, width, headers, frame=frame)
    for index in range(2, min(arm.size, _SIGNS) + 1):
        for joints in itertools.combinations(range(arm.size), index):
            yield _signs(none, joints, names)


def _signs(none: Slip, joints: tuple[int, ...], names: list[str]) -> Slip:
    signs = np.ones(len(none.offset))
    signs[list(joints)] = -1.0
    which = [names[k] for k in joints]
    verb = "count" if len(which) > 1 else "counts"
    text = f"{', '.join(which)} {verb} the other way"
    return replace(none, matrix=np.diag(signs), said=(text,), acts_on=frozenset(f"q{k}" for k in joints))


def zero_slip(none: Slip, k: int, angle: float, name: str) -> Slip:
    """A joint k (from 0) whose zero stands `angle` (rad) away; `name` is its column's header."""
    offset = none.offset.copy()
    offset[k] = angle
    sentence = f"{name} counts from another zero, {math.degrees(angle):.4g} deg away"
    return replace(none, offset=offset, said=(sentence,), acts_on=frozenset({f"zero{k}"}))


def _coupled(none: Slip, k: int, other: int, sign: float, names: list[str]) -> Slip:
    matrix = none.matrix.copy()
    matrix[k, other] = sign
    within = f"holds {names[other]} as well" if sign < 0.0 else f"is less {names[other]}"
    return replace(none, matrix=matrix, said=(f"{names[k]} {within}",), acts_on=frozenset({f"q{k}"}))


def _axes(none: Slip, width: int, headers: Mapping[str, str], *, frame: bool) -> Iterator[Slip]:
    """Axes that changed places or point the other way. Where the frame is free only handedness matters; where it is
    known a frame that was turned is another matter (`frame: free`), so mirrors alone count here too."""
    names = [headers.get(axis, axis) for axis in "xyz"[:width]]
    for order in itertools.permutations(range(width)):
        for signs in itertools.product((1.0, -1.0), repeat=width):
            axes = np.zeros((width, width))
            for row, (column, sign) in enumerate(zip(order, signs, strict=True)):
                axes[row, column] = sign
            if np.linalg.det(axes) > 0.0 or (frame and order != tuple(range(width))):
                continue
            if frame and (sum(sign < 0.0 for sign in signs) > 1 or signs[-1] > 0.0):
                continue
            sentence = f"{', '.join(names)} are left-handed (mirrored)"
            yield replace(none, axes=axes, said=(sentence,), acts_on=frozenset({"tip"}))
