"""What drives do between an encoder on the motor's side and one on the link's, by the load that they pass on.

The difference of the two follows from the load by the effects of drives (`DriveTraits.by_load`). What is no physics of
the arm is fitted beside them: an offset in each log, a delay between the two, and what friction behind the gear holds
back, which goes by the sign of the speed.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.stats import t as student

from linkwright.core.arm.chain.chain import Arm, EffectEntry
from linkwright.core.arm.effects.effect import Effect, Parameter
from linkwright.core.diagnose.motion.preparation import PreparedLog
from linkwright.core.diagnose.result import HALF
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array

from .load_rows import JointRows, Logs, Torques, late_shape, of_load, pieces_of

_NUDGE = 0.01
"""Of a load and of a delay, by which slopes over them are taken."""
_EXACT = 1e-6
"""s, to which a delay is sought."""
_ROUNDS = 2
"""Times that a pattern is taken about how late it is."""
_LONGEST = 2.0
"""Times the longest delay on an effect's grid, up to which one is sought."""


@dataclass(frozen=True)
class Cause:
    """An effect at a joint: `sizes` by name (SI) and how far their 95 % intervals reach, `half`; the RMS (rad, m) of
    the difference of both encoders that held-out motion leaves `without` it, how often chance makes its size as large
    (`p_value`), and how much likelier held-out motion is with it, `evidence` (nats)."""

    effect: Effect
    sizes: Mapping[str, float]
    half: Mapping[str, float]
    without: float
    p_value: float
    evidence: float


@dataclass(frozen=True)
class Between:
    """What two encoders at a joint (from 1) show: `causes`, and the RMS (rad, m) of their difference, offset and delay
    apart, that the arm leaves `before` and, on motion held out, with the causes `after`."""

    joint: int
    causes: tuple[Cause, ...]
    before: float
    after: float

    @property
    def entries(self) -> tuple[EffectEntry, ...]:
        """The causes as an arm file holds them."""
        return tuple(EffectEntry(cause.effect.id, (self.joint,), cause.sizes) for cause in self.causes)


def between_encoders(
    arm: Arm, logs: Sequence[PreparedLog], torques: Torques, without: Collection[str], *, rules: Rules
) -> tuple[Between, ...]:
    """What the drives do between the encoders of logs that have two at each joint.

    Args:
        arm: The arm, its torques being explained.
        logs: The logs.
        torques: How well they are.
        without: Effects (ids) that are not sought.
        rules: What has a name.
    """
    effects = [each for each in of_load() if each.id not in without and not _open_shapes(each)]
    made = Logs(arm, tuple(pieces_of(arm, log) for log in logs), tuple(logs))
    joints = [index for index, joint in enumerate(arm.joints) if joint.driven and not joint.passive]
    return tuple(_at_joint(_Fits(JointRows(made, torques, index), rules), effects) for index in joints)


def _open_shapes(effect: Effect) -> list[Parameter]:
    """The shapes without which nobody knows its pattern in motion."""
    return [shape for shape in effect.shapes if not shape.requires]


@dataclass(frozen=True)
class _Set:
    """Effects fitted at a joint: their sizes `sizes` (E,) of unit patterns, then those of what is no physics; how late
    they are, s; `waves` says whether what goes round with the joint is among these. Beside them stand the `columns`
    (R, E + m), and sums of squares `left` (B,) held out and `fitted` in all."""

    effects: tuple[Effect, ...]
    waves: bool
    late: float
    columns: Array
    sizes: Array
    left: Array
    fitted: float


@dataclass(frozen=True)
class _Fits:
    """What is tried at a joint's rows."""

    rows: JointRows
    rules: Rules

    def fitted(self, effects: tuple[Effect, ...], *, waves: bool = False) -> _Set:
        """Effects fitted, as late as leaves least."""
        beside = np.hstack((self.rows.beside, self.rows.waves)) if waves else self.rows.beside
        shapes = [shape for effect in effects if (shape := late_shape(effect)) is not None]

        def columns(late: float) -> Array:
            return np.column_stack((*(self.rows.unit(effect, late) for effect in effects), beside))

        def left(late: float) -> float:
            return float(np.sum(_left(columns(late), self.rows.apart) ** 2))

        late = shapes[0].default + self.rows.longer if shapes else 0.0
        if shapes and not self.rows.lags.any():  # of a drive that the file has, the whole lags, not what is added
            most = _LONGEST * max(shapes[0].grid)
            best: Any = minimize_scalar(left, bounds=(0.0, most), method="bounded", options={"xatol": _EXACT})
            late = float(best.x)
        at = columns(late)
        sizes = np.asarray(np.linalg.lstsq(at, self.rows.apart, rcond=None)[0], dtype=float)
        return _Set(
            effects, waves, late, at, sizes, self._held_out(at), float(np.sum((self.rows.apart - at @ sizes) ** 2))
        )

    def as_late(self, tried: _Set) -> tuple[_Fits, _Set]:
        """The same about how late the whole drive is by a set, where the arm's file has it give."""
        if not self.rows.lags.any():
            return self, tried
        slope = float(tried.sizes[len(tried.effects) + self.rows.beside.shape[1] - 1])
        added = tried.columns[:, : len(tried.effects)] @ tried.sizes[: len(tried.effects)]
        whole = self.rows.expected + added
        longer = slope * float(self.rows.expected @ whole) / max(float(whole @ whole), 1e-300)
        fits = replace(self, rows=replace(self.rows, longer=self.rows.longer + longer))
        return fits, fits.fitted(tried.effects, waves=tried.waves)

    def _held_out(self, columns: Array) -> Array:
        """Sums of squares (B,) that fits to the other folds leave."""
        left, fold = np.zeros(len(self.rows.torques.folds)), self.rows.torques.folds[self.rows.block]
        for each in np.unique(fold).tolist():
            out = fold == each
            sizes = np.linalg.lstsq(columns[~out], self.rows.apart[~out], rcond=None)[0]
            missed = (self.rows.apart[out] - columns[out] @ sizes) ** 2
            left += np.bincount(self.rows.block[out], missed, minlength=len(left))
        return left

    def rms(self, squares: float) -> float:
        """The RMS of a sum of squares over all rows."""
        return float(np.sqrt(squares / max(len(self.rows.block), 1)))

    def by_unsure_load(self, tried: _Set) -> float:
        """RMS (rad, m) by which the difference may be off where the load is by what is left of the torque."""
        more = (self.rows.of_arm(scale=1.0 + _NUDGE) - self.rows.expected) / _NUDGE
        for effect, size in zip(tried.effects, tried.sizes, strict=False):
            more += (
                size * (self.rows.unit(effect, tried.late, 1.0 + _NUDGE) - self.rows.unit(effect, tried.late)) / _NUDGE
            )
        load = self.rows.load[self.rows.used]
        return float(np.sqrt(np.mean(more**2) / np.mean(load**2))) * self.rows.unsure if load.any() else 0.0

    def named(self, tried: _Set, beside: _Set) -> bool:
        """Whether motion held out needs what a set has more than another `beside` it: its last effect, which then has a
        name, or waves."""
        # What is left of two encoders is no white noise: it must fall on motion held out by as much as on the rest.
        squares = ((float(tried.left.sum()), float(beside.left.sum())), (tried.fitted, beside.fitted))
        if any(self.rms(one) > (1.0 - self.rules.motion.cut) * self.rms(other) for one, other in squares):
            return False
        if len(tried.effects) == len(beside.effects):
            return True
        place = len(tried.effects) - 1
        size, effect = tried.sizes[place], tried.effects[place]
        shape = late_shape(effect)
        if shape is not None and tried.late > (1.0 - _NUDGE) * _LONGEST * max(shape.grid):
            return False  # no drive lags so long
        if size < 0.0 and not (
            effect.sizes[0].lower < 0.0 and self.rows.expected.any()
        ):  # no drive gives less than nothing
            return False
        alone = tried.columns[:, place] - _fit(np.delete(tried.columns, place, 1), tried.columns[:, place])
        return (
            self.rms(float(np.sum((size * alone) ** 2))) > self.by_unsure_load(beside)
            and self._chance(tried, place) < self.rules.residual.level
        )

    def _chance(self, tried: _Set, place: int) -> float:
        spread = self.half(tried)[place] / self._quantile
        return float(2.0 * student.sf(abs(tried.sizes[place]) / max(spread, 1e-300), self._freedom))

    @property
    def _freedom(self) -> int:
        return max(len(np.unique(self.rows.block)) - 1, 1)

    @property
    def _quantile(self) -> float:
        return float(student.ppf(0.975, self._freedom))

    def half(self, tried: _Set) -> Array:
        """How far 95 % intervals of the sizes, and last of the lateness, reach: by blocks of time or by the scatter of
        rows, the wider, and by how well the load's scale is known (`model.intervals`)."""
        slopes = sum(
            (
                size * (self.rows.unit(effect, tried.late * (1.0 + _NUDGE)) - self.rows.unit(effect, tried.late))
                for effect, size in zip(tried.effects, tried.sizes, strict=False)
            ),
            np.zeros(len(self.rows.block)),
        ) / (_NUDGE * max(tried.late, 1e-9))
        count, columns = len(tried.effects), np.column_stack((tried.columns, slopes))
        unit = np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
        inverse = np.linalg.pinv((columns / unit).T @ (columns / unit))
        left = self.rows.apart - tried.columns @ tried.sizes
        scores = np.zeros((int(self.rows.block.max()) + 1, len(unit)))
        np.add.at(scores, self.rows.block, columns / unit * left[:, None])
        by_blocks = np.sqrt(np.maximum(np.diagonal(inverse @ scores.T @ scores @ inverse), 0.0))
        by_rows = np.sqrt(np.maximum(np.diagonal(inverse), 0.0) * np.mean(left**2))
        spread = np.maximum(by_blocks, by_rows) / unit
        half = self._quantile * np.append(spread[:count], spread[-1])
        moved = tried.columns[:, :count] @ tried.sizes[:count]
        # Patterns from filters, clocks and forms are known no better than this, two standard deviations of it.
        least = HALF * self.rules.motion.filters
        half[-1] = np.hypot(half[-1], least * float(np.linalg.norm(moved)) / max(float(np.linalg.norm(slopes)), 1e-300))
        for place, effect in enumerate(tried.effects):
            column = tried.columns[:, place]
            more = (self.rows.unit(effect, tried.late, 1.0 + _NUDGE) - column) / _NUDGE
            by_load = float(more @ column) / max(float(column @ column), 1e-300)
            own = least * tried.sizes[place]
            half[place] = np.hypot(np.hypot(half[place], own), by_load * tried.sizes[place] * self._scale)
        return half

    @cached_property
    def _scale(self) -> float:
        """By which share of itself the load may be off, as a 95 % interval: its part in what the arm leaves of the
        torque, and no less than all of that beside it, for friction and rotors may have taken the load's part."""
        load = np.where(self.rows.moving, self.rows.load, 0.0)
        square = max(float(load @ load), 1e-300)
        part = np.bincount(np.concatenate(self.rows.torques.block), load * self.rows.left)
        seen = float(np.hypot(part.sum(), self._quantile * np.sqrt(np.sum(part**2)))) / square
        return max(seen, self.rows.unsure * float(np.sqrt(self.rows.moving.sum() / square)))

    def cause(self, tried: _Set, place: int) -> Cause:
        """An effect of a set as a cause."""
        effect, half = tried.effects[place], self.half(tried)
        without = self.fitted(tuple(e for k, e in enumerate(tried.effects) if k != place), waves=tried.waves)
        size, shape = effect.sizes[0].name, late_shape(effect)
        sizes, reach = {size: float(tried.sizes[place])}, {size: float(half[place])}
        if shape is not None and tried.late > half[-1] and not self.rows.lags.any():  # else nothing shows it
            sizes[shape.name], reach[shape.name] = tried.late, float(half[-1])
        blocks = len(np.unique(self.rows.block))
        gain = float(without.left.sum()) / max(float(tried.left.sum()), 1e-300)
        return Cause(
            effect,
            sizes,
            reach,
            self.rms(float(without.left.sum())),
            self._chance(tried, place),
            0.5 * blocks * float(np.log(gain)),
        )


def _fit(columns: Array, values: Array) -> Array:
    return np.asarray(columns @ np.linalg.lstsq(columns, values, rcond=None)[0])


def _left(columns: Array, values: Array) -> Array:
    return values - _fit(columns, values)


def _at_joint(joint: _Fits, effects: Sequence[Effect]) -> Between:
    """The effects that held-out motion needs at a joint, found one after the other; the one that does least goes where
    another makes it needless."""
    bare = current = joint.fitted(())
    while True:
        rest = [effect for effect in effects if effect not in current.effects]
        tried = [joint.fitted((*current.effects, effect), waves=current.waves) for effect in rest]
        tried += [joint.fitted(current.effects, waves=True)] if joint.rows.turns and not current.waves else []
        better = [each for each in tried if joint.named(each, current)]
        if not better:
            break
        current = min(better, key=lambda each: float(each.left.sum()))
    for effect in current.effects if len(current.effects) + current.waves > 1 else ():
        others = tuple(each for each in current.effects if each is not effect)
        without = joint.fitted(others, waves=current.waves)
        if not joint.named(joint.fitted((*others, effect), waves=current.waves), without):
            current = without
    for _ in range(_ROUNDS):
        joint, current = joint.as_late(current)
    # Waves are nothing of the arm that loads show, but they must not stand for what is.
    causes = tuple(joint.cause(current, place) for place in range(len(current.effects)))
    return Between(
        joint.rows.joint + 1, causes, joint.rms(float(bare.left.sum())), joint.rms(float(current.left.sum()))
    )
