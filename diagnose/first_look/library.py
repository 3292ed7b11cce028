"""The list of what people get wrong of a recording, of a tip and of torques alike, those first that are made most."""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.files.origin import of_the_other_convention
from linkwright.core.sections.numeric import Array

from .transformation import Transformation, as_read
from .units import unit_changes

_QUARTER = math.pi / 2.0
_SIGNS = 7
"""Joints that may count the other way together, at most."""
_SIDES = tuple((k, sign) for k in (2, 1, 0) for sign in (-1.0, 1.0))


@dataclass(frozen=True)
class Library:
    """Transformations of what was recorded of an arm.

    Args:
        arm: The arm.
        headers: The header of each column by name (`q1`: `q1_deg`).
        width: Components of the tip; 0 of a motion log.
        base: `tau` or `current` of a motion log; empty where torques are not judged.
        frame: Whether the tip's frame is free; its handedness alone then shows.
    """

    arm: Arm
    headers: Mapping[str, str]
    width: int = 0
    base: str = ""
    frame: bool = False

    @property
    def none(self) -> Transformation:
        """Nothing wrong."""
        return as_read(self.arm.size, self.width or 3)

    def _made(self, said: str, acts_on: Iterable[str], **changed: Any) -> Transformation:
        """What is wrong, what it changes, and how."""
        return replace(self.none, said=(said,), acts_on=frozenset(acts_on), **changed)

    def name(self, base: str, k: int) -> str:
        """The header of a joint's (from 0) column; empty in a motion log that lacks it."""
        return self.headers.get(f"{base}{k + 1}", "" if self.base else f"{base}{k + 1}")

    def of_tips(self) -> list[Transformation]:
        """Every single one that tips may show, but for units."""
        return [*self._dh(), *self._signs((1,)), *self._zeros(), *self._coupled(), *self._swapped(), *self._axes(),
                *self._signs(range(2, min(self.arm.size, _SIGNS) + 1))]  # fmt: skip

    def of_torques(self, *, units: bool, gravity: bool) -> list[Transformation]:
        """Every single one that torques may show, those of units and gravity where asked."""
        everywhere = tuple(range(self.arm.size))
        plain = [coordinate for coordinate, _, _ in self.turns]
        all_signs = self.turned(everywhere) if self.arm.size > 1 else ()
        more = [*(self._degrees() if units else ()), *(self._gravity() if gravity else ())]
        return [*plain, *all_signs, *self._zeros(), *self._swapped(), *self._coupled(), *self._reversed(), *more]

    @functools.cached_property
    def turns(self) -> tuple[tuple[Transformation, Transformation, Transformation], ...]:
        """What counts the other way at each joint: its coordinate, its torque, or both."""
        return tuple(self.turned((k,)) for k in range(self.arm.size))

    def units(self) -> Iterator[Transformation]:
        """Columns that are in another unit than their headers say."""
        for change in unit_changes(self.arm, self.width, self.headers):
            acts = [f"{of}{k}" for of in ("q", "tip") for k in np.flatnonzero(getattr(change, of) != 1.0).tolist()]
            yield self._made(change.said(), acts, matrix=np.diag(change.q), tip=np.diag(change.tip))

    def turned(self, joints: Sequence[int]) -> tuple[Transformation, Transformation, Transformation]:
        """Joints that count the other way, their torques, and both; all of them are said as what they are."""
        flip = np.diag([-1.0 if k in joints else 1.0 for k in range(self.arm.size)])
        whole = len(joints) > 1
        what = "all joints count" if whole else f"{self.name('q', joints[0])} counts"
        force = "all torques count" if whole else f"{self.name(self.base, joints[0])} counts"

        def made(said: str, *kinds: str) -> Transformation:
            acts = [f"{kind}{k}" for k in joints for kind in (("q", "tau") if whole else kinds)]
            turned = {{"q": "matrix", "tau": "torques"}[kind]: flip for kind in kinds}
            return self._made(said, acts, **turned)

        way = "the other way"
        return (
            made(f"{what} {way}", "q"),
            made(f"{force} {way}", "tau"),
            made(f"{what} {way}, {'their torques' if whole else 'its torque'} too", "q", "tau"),
        )

    def zero(self, k: int, angle: float, *, fitted: bool = False) -> Transformation:
        """A joint k (from 0) whose zero stands `angle` (rad) away."""
        offset = np.zeros(self.arm.size)
        offset[k] = angle
        sentence = f"{self.name('q', k)} counts from another zero, {math.degrees(angle):.4g} deg away"
        size = _sized(functools.partial(self.zero, k, fitted=True), angle) if fitted else {}
        return self._made(sentence, [f"zero{k}" if self.width else f"q{k}"], offset=offset, **size)

    def ratio(self, k: int, by: float) -> Transformation:
        """A joint that goes `by` times what its column says."""
        matrix = np.eye(self.arm.size)
        matrix[k, k] = float(f"{by:.5g}")
        goes = "turns" if self.arm.joints[k].revolute else "moves"
        said = f"joint {k + 1} {goes} {by:.4g} times what {self.name('q', k)} says (steps per unit, or a gear's ratio)"
        return self._made(said, [f"q{k}"], matrix=matrix, **_sized(functools.partial(self.ratio, k), by))

    def coupled(self, k: int, other: int, by: float) -> Transformation:
        """A joint that turns by a part of another one's coordinate as well."""
        matrix = np.eye(self.arm.size)
        matrix[k, other] = float(f"{by:.5g}")
        said = f"joint {k + 1} turns by {by:.4g} of {self.name('q', other)} as well as by {self.name('q', k)}"
        return self._made(said, [f"q{k}"], matrix=matrix, **_sized(functools.partial(self.coupled, k, other), by))

    def droop(self, k: int, by: float) -> Transformation:
        """A joint that gives way by so much (rad/(N*m); m/N) under its load."""
        droop = np.zeros(self.arm.size)
        droop[k] = by
        stiffness = f"{1.0 / by:.4g}" if by else "inf"
        turns = self.arm.joints[k].revolute
        per, stiff = ("rad/(N*m)", "N*m/rad") if turns else ("m/N", "N/m")
        said = (
            f"joint {k + 1} gives way by {by:.3g} {per} under its load, as a loop or drive of {stiffness} {stiff}; "
            f"{self.name('q', k)} was then commanded, so log the position read back"
        )
        written = (f"`stiffness: {stiffness} {stiff}` at joint {k + 1} in the arm file",)
        sized = _sized(functools.partial(self.droop, k), by)
        return self._made(said, [f"q{k}"], droop=droop, written=written, **sized)

    def _dh(self) -> Iterator[Transformation]:
        if of_the_other_convention(self.arm) is None:
            return
        first = self.arm.joints[0].dh
        meant = "standard" if first is not None and first.modified else "modified"
        said = f"the arm file's dh are meant with `convention: {meant}` in each"
        yield self._made(said, ["arm"], other_dh=True)

    def _signs(self, sizes: Sequence[int] | range) -> Iterator[Transformation]:
        for size in sizes:
            for joints in itertools.combinations(range(self.arm.size), size):
                signs = np.ones(self.arm.size)
                signs[list(joints)] = -1.0
                said = (
                    f"{', '.join(self.name('q', k) for k in joints)} {'count' if size > 1 else 'counts'} the other way"
                )
                yield self._made(said, [f"q{k}" for k in joints], matrix=np.diag(signs))

    def _zeros(self) -> Iterator[Transformation]:
        for k, joint in enumerate(self.arm.joints):
            if joint.revolute and self.name("q", k):
                for angle in (_QUARTER, -_QUARTER, 2.0 * _QUARTER):
                    yield self.zero(k, angle)

    def _coupled(self) -> Iterator[Transformation]:
        turns = [k for k, joint in enumerate(self.arm.joints) if joint.revolute and self.name("q", k)]
        for k in turns:
            for other, sign in itertools.product((k - 1, k + 1), (1.0, -1.0)):
                if other not in turns or (self.base and (other > k or sign > 0.0)):
                    continue  # torques: angles against the base alone
                matrix = np.eye(self.arm.size)
                matrix[k, other] = sign
                plain, also = self.name("q", k), self.name("q", other)
                said = f"{plain} holds {also} as well" if sign < 0.0 else f"{plain} is less {also}"
                yield self._made(said, [f"q{k}", *(["coupled"] if self.base else [])], matrix=matrix)

    def _swapped(self) -> Iterator[Transformation]:
        """Two joints that changed places, with their torques or without, and torques alone."""
        one = np.eye(self.arm.size)
        for first, second in itertools.combinations(range(self.arm.size), 2):
            if self.arm.joints[first].revolute != self.arm.joints[second].revolute:
                continue
            swap = one.copy()
            swap[[first, second]] = swap[[second, first]]
            kinds = ((("q", "v", self.base), swap, swap), (("q", "v"), swap, one), ((self.base,), one, swap))
            for bases, matrix, torques in kinds if self.base else ((("q",), swap, one),):
                pairs = [(self.name(base, first), self.name(base, second)) for base in bases]
                pairs = [(a, b) for a, b in pairs if a and b]
                if not pairs or not all(pairs[0]):
                    continue  # neither of them was logged
                acts = [f"{kind}{k}" for k in (first, second) for kind in ("q", "tau")[: 1 + bool(self.base)]]
                also = ", their torques too" if matrix is torques else ""
                said = f"{' and '.join(pairs[0])} have changed places{also}"
                yield self._made(said, acts, matrix=matrix, torques=torques)

    def _reversed(self) -> Iterator[Transformation]:
        if self.arm.size < 3:  # two have changed places
            return
        reverse = np.eye(self.arm.size)[::-1]
        acts = [f"{kind}{k}" for k in range(self.arm.size) for kind in ("q", "tau")]
        yield self._made("the joints stand in the opposite order", acts, matrix=reverse, torques=reverse)

    def _degrees(self) -> Iterator[Transformation]:
        turning = [k for k, joint in enumerate(self.arm.joints) if joint.revolute]
        for factor, unit in ((math.radians(1.0), "deg"), (math.degrees(1.0), "rad")) if turning else ():
            scale = np.eye(self.arm.size)
            scale[turning, turning] = factor
            said = f"{', '.join(self.name('q', k) for k in turning)} seem to be in {unit}"
            yield self._made(said, [f"q{k}" for k in range(self.arm.size)], matrix=scale)

    def _gravity(self) -> Iterator[Transformation]:
        size = math.hypot(*self.arm.gravity)
        for axis, sign in _SIDES if size else ():
            side = (sign * float(axis == 0), sign * float(axis == 1), sign * float(axis == 2))
            if math.dist(side, [item / size for item in self.arm.gravity]) > 0.5:
                vector = ", ".join(f"{size * item:.4g} m/s^2" if item else "0 m/s^2" for item in side)
                said = f"gravity acts along {'-' if sign < 0.0 else ''}{'xyz'[axis]} of the base frame (write "
                said += f"`gravity: [{vector}]` in the arm file)"
                yield self._made(said, ["gravity"], gravity=side)

    def _axes(self) -> Iterator[Transformation]:
        """Axes of the tip that changed places or point the other way. Where the frame is free only handedness matters;
        where it is known a frame that was turned is another matter (`frame: free`), so mirrors alone count here too."""
        names = [self.headers.get(axis, axis) for axis in "xyz"[: self.width]]
        straight = tuple(range(self.width))
        for order in itertools.permutations(straight):
            for signs in itertools.product((1.0, -1.0), repeat=self.width):
                axes = np.zeros((self.width, self.width))
                axes[straight, order] = signs
                if _turns(axes) or (self.frame and (order != straight or not _last_axis_alone(signs))):
                    continue
                yield self._made(
                    f"{', '.join(names)} are left-handed (mirrored)", [f"tip{k}" for k in straight], tip=axes
                )


def _sized(make: Callable[[float], Transformation], size: float) -> dict[str, Any]:
    """What a transformation of one number has beside others."""
    return {"numbers": 1, "resized": make, "size": size}


def _turns(axes: Array) -> bool:
    return float(np.linalg.det(axes)) > 0.0


def _last_axis_alone(signs: Sequence[float]) -> bool:
    return sum(sign < 0.0 for sign in signs) == 1 and signs[-1] < 0.0
