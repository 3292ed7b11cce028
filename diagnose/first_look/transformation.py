"""What a recording may be meant as: one transformation of joints, tips and torques, and how several go together."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from linkwright.core.arm.chain.chain import Arm, FloatVector
from linkwright.core.arm.files.origin import of_the_other_convention
from linkwright.core.diagnose.reading.columns import formulas
from linkwright.core.sections.numeric import Array

_MOVING, _PUSHING = ("q", "v"), ("tau", "current", "voltage")


@dataclass(frozen=True, eq=False)
class Transformation:
    """A way in which a recording is meant otherwise than it is read.

    Args:
        matrix: (n, n) coordinates are meant as `matrix` q + `offset`, SI.
        offset: (n,) rad or m.
        tip: (D, D) tips are meant as `tip` @ tip.
        torques: (n, n) torques alike.
        droop: (n,) rad/(N*m) by which a joint gives way under the torque that holds the arm; q is what was commanded.
        late: Rows by which tips stand later than the joints that they belong to.
        gravity: Its direction in the base frame; None: as the arm has it.
        other_dh: Whether the arm's rows of dh are meant in the other convention.
        said: What is wrong, a part each.
        acts_on: What it changes; no two that change the same are tried together.
        numbers: How many of its parts have a size that was fitted.
        resized: The same of another size, where it is one part that has one,
        size: and its own.
        written: What mends it in the arm file, where formulas of columns do not.
    """

    matrix: Array
    offset: Array
    tip: Array
    torques: Array
    droop: Array
    late: int = 0
    gravity: FloatVector | None = None
    other_dh: bool = False
    said: tuple[str, ...] = ()
    acts_on: frozenset[str] = frozenset()
    numbers: int = 0
    written: tuple[str, ...] = ()
    resized: Callable[[float], Transformation] | None = None
    size: float = 0.0

    @property
    def common(self) -> bool:
        """Whether it is a sign or a zero of one joint, which people get wrong at several joints at once."""
        return len(self.acts_on) == 1 and self.gravity is None

    def beside(self, other: Transformation) -> Transformation:
        """Both, which act on different things."""
        one = np.eye(len(self.offset))
        return Transformation(
            self.matrix + other.matrix - one,  # each acts on rows of its own
            self.offset + other.offset,
            other.tip @ self.tip,
            other.torques @ self.torques,
            self.droop + other.droop,
            self.late + other.late,
            self.gravity or other.gravity,
            self.other_dh or other.other_dh,
            (*self.said, *other.said),
            self.acts_on | other.acts_on,
            self.numbers + other.numbers,
            (*self.written, *other.written),
        )  # of several there is no one size

    def applied(self, q: Array, tip: Array) -> tuple[Array, Array]:
        """Joints and tips as they are meant, but for droop; rows without a fellow left out."""
        late = self.late
        joints = q[: len(q) - late] if late > 0 else q[-late:]
        tips = tip[late:] if late > 0 else tip[: len(tip) + late]
        return joints @ self.matrix.T + self.offset, tips @ self.tip.T

    def read(self, arm: Arm) -> Arm:
        """The arm as it is meant."""
        return of_the_other_convention(arm) or arm if self.other_dh else arm

    def columns(self, arm: Arm, headers: Mapping[str, str]) -> dict[str, str]:
        """The formulas that mend it, by header; `headers` has those of what was recorded."""
        made: dict[str, str] = {}
        for base in (*_MOVING, *_PUSHING):
            names = [headers.get(f"{base}{k + 1}", "") for k in range(arm.size)]
            matrix = self.matrix if base in _MOVING else self.torques
            made |= formulas(names, arm, matrix, self.offset if base == "q" else None)
        return made | formulas([headers.get(axis, "") for axis in "xyz"[: len(self.tip)]], arm, self.tip)

    def sentence(self) -> str:
        """What seems to be wrong: `q3_deg counts the other way`."""
        return " and ".join((*self.said, *(f"write {text}" for text in self.written)))


def as_read(size: int, width: int = 3) -> Transformation:
    """Nothing wrong, for `size` joints and `width` components of the tip."""
    return Transformation(np.eye(size), np.zeros(size), np.eye(width), np.eye(size), np.zeros(size))


def composed(parts: Sequence[Transformation], none: Transformation) -> Transformation:
    """All of several, which act on different things."""
    return functools.reduce(Transformation.beside, parts, none)


def apart(parts: Sequence[Transformation]) -> bool:
    """Whether transformations act on different things."""
    return sum(len(part.acts_on) for part in parts) == len(frozenset().union(*(part.acts_on for part in parts)))
