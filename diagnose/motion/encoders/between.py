"""What drives do between an encoder on the motor's side and one on the link's, by the load that they pass on.

The difference of the two follows from the load by the effects of drives (`DriveTraits.by_load`), which an arm file
holds. Beside them are fitted an offset in each log and a delay, which are the encoders', and what no entry holds:
friction behind the gear, which goes by the sign of the speed, and waves of eccentric encoders and gears. What is said
to be left is what the arm with its entries leaves, offset and delay apart.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations
from typing import Any

import numpy as np
from scipy.optimize import minimize_scalar

from linkwright.core.arm.chain.chain import Arm, EffectEntry
from linkwright.core.arm.effects.angles.encoder_eccentricity import ENCODER_ECCENTRICITY
from linkwright.core.arm.effects.effect import Effect
from linkwright.core.diagnose.motion.model.entries import with_entries
from linkwright.core.diagnose.motion.preparation import PreparedLog
from linkwright.core.diagnose.result import HALF
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array

from .load_rows import JointRows, Logs, Torques, late_shape, of_load
from .serial import Serial, residual, rms, serial

_NUDGE = 0.01
"""Of a load, by which the slope over it is taken."""
_STEP = 1e-4
"""s, by which the slope over a delay is taken."""
_EXACT = 1e-6
"""s, to which a delay is sought."""
_WIDTHS = 11
"""How many standard deviations of waves are tried, each half the one before."""
_LONGEST = 2.0
"""Times the longest delay on an effect's grid, up to which one is sought."""


@dataclass(frozen=True)
class Cause:
    """An effect at a joint: `sizes` by name (SI) and how far their 95 % intervals reach, `half`; what the arm with the
    other causes alone leaves `without` it on held-out motion (RMS, rad, m), how often chance makes any drive's effect
    as sure (`p_value`), and how much likelier held-out motion is with it, `evidence` (nats)."""

    effect: Effect
    sizes: Mapping[str, float]
    half: Mapping[str, float]
    without: float
    p_value: float
    evidence: float


@dataclass(frozen=True)
class Between:
    """What two encoders at a joint (from 1) show: `causes`, and the RMS (rad, m) of their difference that an arm leaves
    once an offset in each log and a delay, by which the link is read `late` (s), are taken out: `before` as given,
    `after` as written, and `held_out` with sizes of the causes by the other motion. No entry holds what goes round with
    the joint, `around`, and with the `direction` of its motion (RMS)."""

    joint: int
    causes: tuple[Cause, ...]
    before: float
    after: float
    held_out: float
    late: float
    around: float
    direction: float

    @property
    def entries(self) -> tuple[EffectEntry, ...]:
        """The causes as an arm file holds them."""
        return _entries(self.joint, self.causes)


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
    # Without an open shape nobody knows an effect's pattern in motion.
    effects = [each for each in of_load() if each.id not in without and all(shape.requires for shape in each.shapes)]
    made = Logs.of(arm, logs)
    joints = [index for index, joint in enumerate(arm.joints) if joint.driven and not joint.passive]
    tests = len(joints) * len(effects)
    return tuple(_at_joint(_Fits(JointRows(made, torques, index), rules, tests), effects) for index in joints)


@dataclass(frozen=True)
class _Fit:
    """Effects fitted at a joint, the drive `late` s behind its load (None: as the file has it). `columns` (R, K) with
    `sizes` (K,) are waves, unit patterns of the effects, what a second more of `late` changes where that is sought
    (these two are `of_arm`), and what belongs to no drive; `ridge` (K,) holds them to standard deviations `width` (K,).
    `nominal` (R,) is what the arm as given does (rad, m), `left` (R,) what all of this
    leaves."""

    effects: tuple[Effect, ...]
    late: float | None
    columns: Array
    width: Array
    ridge: Array
    sizes: Array
    of_arm: slice
    nominal: Array
    left: Array

    def place(self, effect: Effect) -> int:
        """The column of an effect."""
        return self.of_arm.start + self.effects.index(effect)


@dataclass(frozen=True)
class _Fits:
    """What is tried at a joint's rows; so many `tests` are made of all drives."""

    rows: JointRows
    rules: Rules
    tests: int

    def fitted(self, effects: tuple[Effect, ...]) -> _Fit:
        """Effects fitted, so late as leaves least where the rows show that."""
        lags = [shape for effect in effects if (shape := late_shape(effect)) is not None]
        as_said = self._at(effects, None)
        if not lags:
            return as_said

        def left(late: float) -> float:
            return float(np.sum(self._at(effects, late, as_said).left ** 2))

        most = _LONGEST * max(lags[0].grid)
        best: Any = minimize_scalar(left, bounds=(0.0, most), method="bounded", options={"xatol": _EXACT})
        fit = self._with_slope(self._at(effects, float(best.x)))
        shown = self._serial(fit).error[fit.of_arm.stop - 1] < self.rules.motion.shown * max(lags[0].typical)
        return fit if shown else as_said

    def _at(self, effects: tuple[Effect, ...], late: float | None, like: _Fit | None = None) -> _Fit:
        waves, nominal = self.rows.waves, self.rows.of_arm(late)
        units = [self._unit(effect, late) for effect in effects]
        columns = np.column_stack((waves, *units, self.rows.instrument, self.rows.direction))
        values = self.rows.measured - nominal
        width, ridge = self._widths(columns, values) if like is None else (like.width, like.ridge)
        sizes, of_arm = _solved(columns, values, ridge), slice(waves.shape[1], waves.shape[1] + len(effects))
        return _Fit(effects, late, columns, width, ridge, sizes, of_arm, nominal, values - columns @ sizes)

    def _with_slope(self, fit: _Fit) -> _Fit:
        assert fit.late is not None
        later = self._at(fit.effects, fit.late + _STEP, fit)
        change = later.nominal - fit.nominal + (later.columns - fit.columns)[:, fit.of_arm] @ fit.sizes[fit.of_arm]
        end = fit.of_arm.stop
        return replace(
            fit,
            columns=np.insert(fit.columns, end, change / _STEP, axis=1),
            width=np.insert(fit.width, end, 0.0),
            ridge=np.insert(fit.ridge, end, 0.0),
            sizes=np.insert(fit.sizes, end, 0.0),
            of_arm=slice(fit.of_arm.start, end + 1),
        )

    def _unit(self, effect: Effect, late: float | None, scale: float = 1.0) -> Array:
        """The pattern (R,) of a unit of an effect so late, under `scale` times the loads."""
        entry = EffectEntry(effect.id, (self.rows.joint + 1,), _values(effect, 1.0, late))
        return self.rows.of_entries([entry], late, scale)

    def _widths(self, columns: Array, values: Array) -> tuple[Array, Array]:
        """Standard deviations (K,) of the numbers that are known beforehand, and what holds the numbers to these,
        `ridge` (K,): waves are as large as the rows make likely, and at most as encoders are eccentric (D. J. C.
        MacKay, Neural Comput. 4 (1992) 415, doi:10.1162/neco.1992.4.3.415, but averaged over widths)."""
        count = self.rows.waves.shape[1]
        width, ridge = np.zeros(columns.shape[1]), np.zeros(columns.shape[1])
        if count:
            turned, size, _ = np.linalg.svd(residual(columns[:, count:], columns[:, :count]), full_matrices=False)
            along, left = turned.T @ values, residual(columns, values)
            errors = serial(np.hstack((turned, columns[:, count:])), left, self.rows.used).error[:count]
            noise = np.maximum(errors**2, 1e-300)  # of a joint that stands still nothing is left
            usual = max(abs(end) for parameter in ENCODER_ECCENTRICITY.sizes for end in parameter.typical)
            widths = usual * 0.5 ** np.arange(_WIDTHS)
            variance = noise + np.square(widths[:, None] * size)
            likely = -0.5 * np.sum(np.log(variance) + along**2 / variance, axis=1)
            weight = np.exp(likely - likely.max())
            width[:count] = np.sqrt(np.sum(weight * widths**2) / np.sum(weight))
            ridge[:count] = np.mean(noise) / width[:count] ** 2
        return width, ridge

    def _serial(self, fit: _Fit) -> Serial:
        return serial(fit.columns, fit.left, self.rows.used, fit.ridge, fit.width)

    def held_out(self, fit: _Fit) -> float:
        """RMS that the arm with the effects leaves, their sizes by the other folds."""
        values, left = self.rows.measured - fit.nominal, np.zeros(len(fit.nominal))
        for each in np.unique(self.rows.fold).tolist():
            out = self.rows.fold == each
            sizes = _solved(fit.columns[~out], values[~out], fit.ridge)
            left[out] = values[out] - fit.columns[out, fit.of_arm] @ sizes[fit.of_arm]
        return rms(residual(self.rows.instrument, left))

    def needed(self, fit: _Fit, effect: Effect, beside: _Fit) -> bool:
        """Whether an effect is one that a drive can have, and the set without it, `beside`, leaves more."""
        size, shape = float(fit.sizes[fit.place(effect)]), late_shape(effect)
        if rms(fit.left) > (1.0 - self.rules.motion.cut) * rms(beside.left):
            return False
        if self.held_out(fit) > (1.0 - self.rules.motion.gain) * self.held_out(beside):
            return False
        if shape is not None and (fit.late or 0.0) > (1.0 - _NUDGE) * _LONGEST * max(shape.grid):
            return False  # no drive lags so long
        # No drive gives less than nothing.
        return size >= 0.0 or (effect.sizes[0].lower < 0.0 and bool(self.rows.of_arm().any()))

    def chance(self, fit: _Fit, effect: Effect) -> float:
        """How often chance alone makes any effect of any drive as sure as this one."""
        place = fit.place(effect)
        once = self._serial(fit).chance(place, float(fit.sizes[place]), float(HALF * self._unsure(fit)[place]))
        return 1.0 - (1.0 - once) ** self.tests

    def _unsure(self, fit: _Fit) -> Array:
        """How far 95 % intervals of the sizes (K,) reach beside noise: patterns from filters, clocks and forms are
        known no better than two standard deviations of it, and loads by a share."""
        more = self.rows.of_arm(fit.late, 1.0 + _NUDGE) - fit.nominal
        for effect in fit.effects:
            place = fit.place(effect)
            more += fit.sizes[place] * (self._unit(effect, fit.late, 1.0 + _NUDGE) - fit.columns[:, place])
        whole = fit.nominal + fit.columns[:, fit.of_arm] @ fit.sizes[fit.of_arm]
        size = np.maximum(np.linalg.norm(fit.columns, axis=0), 1e-300)
        loads = _solved(fit.columns, more / _NUDGE, fit.ridge) * self._scale
        return np.asarray(np.hypot(HALF * self.rules.motion.filters * np.linalg.norm(whole) / size, loads))

    @cached_property
    def _scale(self) -> float:
        """By which share of itself the load may be off, as a 95 % interval: its part in what the arm leaves of the
        torque, and no less than all of that beside it, for friction and rotors may have taken the load's part."""
        load, left = self.rows.load[self.rows.moving, None], self.rows.left
        square = max(float(np.sum(load**2)), 1e-300)
        part = float(load[:, 0] @ left) / square
        seen = float(serial(load, left - load[:, 0] * part, self.rows.moving).half[0])
        return max(float(np.hypot(part, seen)), self.rows.unsure * float(np.sqrt(len(load) / square)))

    def cause(self, fit: _Fit, effect: Effect, beside: _Fit, p_value: float) -> Cause:
        """An effect of a set as a cause; `beside` is the set without it."""
        place, noise, size = fit.place(effect), self._serial(fit), float(fit.sizes[fit.place(effect)])
        values, half = _values(effect, size, fit.late), np.hypot(noise.half, self._unsure(fit))
        reach = dict(zip(values, (float(half[at]) for at in (place, fit.of_arm.stop - 1)), strict=False))
        left = self.held_out(beside)
        evidence = float(noise.freedom[place] * np.log(left / max(self.held_out(fit), 1e-300)))
        return Cause(effect, values, reach, left, p_value, evidence)


def _values(effect: Effect, size: float, late: float | None) -> dict[str, float]:
    """An effect's values for an arm file."""
    shape = late_shape(effect)
    return {effect.sizes[0].name: size, **({} if shape is None or late is None else {shape.name: late})}


def _solved(columns: Array, values: Array, ridge: Array) -> Array:
    table = np.vstack((columns, np.diag(np.sqrt(ridge))))
    return np.asarray(np.linalg.lstsq(table, np.append(values, np.zeros(len(ridge))), rcond=None)[0], dtype=float)


def _at_joint(fits: _Fits, effects: Sequence[Effect]) -> Between:
    """The effects of a joint: the set that foretells held-out motion best of those of which each effect is needed."""
    sets = [frozenset(each) for count in range(len(effects) + 1) for each in combinations(effects, count)]
    tried = {each: fits.fitted(tuple(effect for effect in effects if effect in each)) for each in sets}

    def p_value(names: frozenset[Effect], name: Effect) -> float:
        """How often chance makes an effect as sure as the surest of those that may stand in its place."""
        rest = names - {name}
        return min(fits.chance(tried[rest | {effect}], effect) for effect in effects if effect not in rest)

    def stands(names: frozenset[Effect]) -> bool:
        needed = all(fits.needed(tried[names], name, tried[names - {name}]) for name in names)
        return needed and all(p_value(names, name) < fits.rules.residual.level for name in names)

    best = min(filter(stands, sets), key=lambda names: fits.held_out(tried[names]))
    fit = tried[best]
    causes = tuple(fits.cause(fit, each, tried[best - {each}], p_value(best, each)) for each in fit.effects)
    filed = with_entries(fits.rows.made.arm, _entries(fits.rows.joint + 1, causes))
    written = replace(fits.rows, made=replace(fits.rows.made, arm=filed))
    instrument, left = written.instrument, written.measured - written.of_arm()
    return Between(
        fits.rows.joint + 1,
        causes,
        before=fits.held_out(tried[frozenset()]),
        after=rms(residual(instrument, left)),
        held_out=fits.held_out(fit),
        late=-float(np.linalg.lstsq(instrument, left, rcond=None)[0][-1]),
        around=rms(residual(instrument, written.waves @ fit.sizes[: fit.of_arm.start])),
        direction=rms(residual(instrument, written.direction @ fit.sizes[-1:])),
    )


def _entries(joint: int, causes: Sequence[Cause]) -> tuple[EffectEntry, ...]:
    return tuple(EffectEntry(cause.effect.id, (joint,), cause.sizes) for cause in causes)
