"""What drives do between an encoder on the motor's side and one on the link's, by the load that they pass on.

The difference of the two follows from the load by the effects of drives (`DriveTraits.by_load`). What is no physics of
the arm is fitted beside them: an offset in each log, a delay between the two, and what friction behind the gear holds
back, which goes by the sign of the speed.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar
from scipy.stats import t as student

from linkwright.core.arm.chain.chain import Arm, EffectEntry
from linkwright.core.arm.chain.statics import PoseState, solve
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.effects.effect import Effect, Parameter, Settings
from linkwright.core.arm.effects.elastic.elastic_drive import swing
from linkwright.core.arm.effects.torques import direction
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.errors.recorded import seen_by_drives
from linkwright.core.arm.errors.unknown_mass import of_unknown_mass, without_unknown
from linkwright.core.arm.motion.dynamics import torque_stages
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.diagnose.motion.model.entries import with_entries
from linkwright.core.diagnose.motion.preparation import PreparedLog
from linkwright.core.diagnose.result import HALF
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array

_NUDGE = 0.01
"""Of a load and of a delay, by which slopes over them are taken."""
_EXACT = 1e-6
"""s, to which a delay is sought."""
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


@dataclass(frozen=True)
class Torques:
    """What is known of the torques that an arm explains, by log: what it leaves of them `left` (M, n), N*m, and where a
    joint moves so that this counts, `moving` (M, n). `block` (M,) numbers blocks of time over all logs, of which
    `folds` (B,) are held out together."""

    left: tuple[Array, ...]
    moving: tuple[NDArray[np.bool_], ...]
    block: tuple[NDArray[np.int64], ...]
    folds: NDArray[np.int64]


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
    effects = [each for each in _of_load() if each.id not in without and not _open_shapes(each)]
    made = _Logs(arm, tuple(_pieces(arm, log) for log in logs), tuple(logs))
    joints = [index for index, joint in enumerate(arm.joints) if joint.driven and not joint.passive]
    return tuple(_at_joint(_Joint(made, torques, index, rules), effects) for index in joints)


def _of_load() -> list[Effect]:
    return [effect for effect in EFFECTS.values() if effect.drive.by_load]


def _open_shapes(effect: Effect) -> list[Parameter]:
    """The shapes without which nobody knows its pattern in motion."""
    return [shape for shape in effect.shapes if not shape.requires]


@dataclass(frozen=True)
class _Piece:
    """Samples of a log: the `load` (P, n) N*m that pushes each link towards increasing coordinates, how far it is from
    its motor, `apart` (P, n), and which of the log's kept samples it holds, where."""

    motion: Motion
    load: Array
    apart: Array
    numbers: NDArray[np.int64]
    within: NDArray[np.int64]


def _pieces(arm: Arm, log: PreparedLog) -> tuple[_Piece, ...]:
    def made() -> Iterator[_Piece]:
        for part, numbers, within in log.pieces():
            motion = replace(log.piece(part), arm=with_entries(arm, log.entries))
            apart = motion.of_links.q - motion.q
            yield _Piece(motion, -torque_stages(motion).load, apart, numbers, within)

    return tuple(made())


_OfPiece = Callable[[_Piece], Array]


@dataclass(frozen=True)
class _Logs:
    arm: Arm
    pieces: tuple[tuple[_Piece, ...], ...]
    logs: tuple[PreparedLog, ...]

    @cached_property
    def state(self) -> PoseState:
        """The arm at some pose: what drives do goes by their loads alone."""
        known = without_unknown(self.arm, of_unknown_mass(self.arm))
        return solve(known, self.logs[0].motion.of_links.q[0].tolist(), beams_of(known))

    @cached_property
    def own(self) -> tuple[EffectEntry, ...]:
        """What the arm has of such effects."""
        automatic = (each.id for each in _of_load() if each.automatic and each.id not in self.arm.leave_out)
        return (
            *(EffectEntry(effect) for effect in automatic),
            *(entry for entry in self.arm.effects if EFFECTS[entry.effect].drive.by_load),
        )

    def filtered(self, of_piece: _OfPiece) -> Array:
        """Values (P, k) of pieces at the kept samples of all logs (M, k), after the low-pass."""
        return np.concatenate([self._of_log(number, of_piece) for number in range(len(self.logs))])

    def _of_log(self, number: int, of_piece: _OfPiece) -> Array:
        log, parts = self.logs[number], list[Array]()
        for piece in self.pieces[number]:
            parts.append(log.filtered(of_piece(piece))[piece.within])
        return np.concatenate(parts)

    def pattern(self, effect: Effect, joint: int, values: Mapping[str, float], scale: float = 1.0) -> _OfPiece:
        """What an effect with values moves a joint (from 0) by, (P, 1), under `scale` times the loads."""
        late = _late(effect)
        settings = Settings((joint,), MappingProxyType(dict(values)))

        def of_piece(piece: _Piece) -> Array:
            loads = scale * piece.load
            if late is not None:
                loads = loads.copy()
                behind = values.get(late.name, late.default or 0.0)
                loads[:, joint] = swing(piece.motion, np.zeros(len(loads)), behind, loads[:, joint])
            return seen_by_drives(self.state, effect, settings, loads)[:, joint : joint + 1]

        return of_piece


def _late(effect: Effect) -> Parameter | None:
    """The shape by which its angle lags its load, s."""
    return next((shape for shape in effect.torque_shapes if shape.kind == "time" and shape.role != "shape"), None)


@dataclass(frozen=True)
class _Set:
    """Effects fitted at a joint: their sizes `sizes` (E,) of unit patterns, then those of what is no physics; how late
    they are, s; the `columns` (R, E + m), and sums of squares `left` (B,) held out, `fitted` in all."""

    effects: tuple[Effect, ...]
    late: float
    columns: Array
    sizes: Array
    left: Array
    fitted: float


@dataclass(frozen=True)
class _Joint:
    """A joint (from 0), its rows, and what is tried there."""

    made: _Logs
    torques: Torques
    joint: int
    rules: Rules

    @cached_property
    def load(self) -> Array:
        """The filtered load (M,), N*m."""
        return self.made.filtered(lambda piece: piece.load[:, self.joint : self.joint + 1])[:, 0]

    @cached_property
    def moving(self) -> NDArray[np.bool_]:
        """Where the joint moves, so that its torque counts (M,)."""
        return np.concatenate([each[:, self.joint] for each in self.torques.moving])

    @cached_property
    def left(self) -> Array:
        """What the arm leaves of its torque (M,), N*m."""
        return np.concatenate([each[:, self.joint] for each in self.torques.left])

    @cached_property
    def unsure(self) -> float:
        """RMS of what the arm leaves of its torque, by which nobody knows the load, N*m."""
        return float(np.sqrt(np.mean(self.left[self.moving] ** 2))) if self.moving.any() else 0.0

    @cached_property
    def used(self) -> NDArray[np.bool_]:
        """The samples (M,) that count: nothing pushes the arm, and the sign of the load is known, as far as it is."""
        use = np.ones(len(self.load), dtype=bool)
        clock = np.concatenate([log.motion.time[log.kept] for log in self.made.logs])
        which = np.repeat(np.arange(len(self.made.logs)), [len(log.kept) for log in self.made.logs])
        for number, log in enumerate(self.made.logs):
            for begin, end in log.log.aside:
                use &= ~((which == number) & (clock >= begin) & (clock <= end))
        sure = use & (np.abs(self.load) > 2.0 * self.unsure)
        return sure if sure.sum() > 0.5 * use.sum() else use

    @cached_property
    def block(self) -> NDArray[np.int64]:
        """The block (R,) of each row."""
        return np.concatenate(self.torques.block)[self.used]

    @cached_property
    def expected(self) -> Array:
        """What the arm itself does between the two (R,)."""
        parts = (
            self.rows(self.made.pattern(EFFECTS[entry.effect], self.joint, entry.parameters))
            for entry in self.made.own
            if not entry.at or self.joint + 1 in entry.at
        )
        return sum(parts, np.zeros(len(self.block)))

    @cached_property
    def beside(self) -> Array:
        """What is no physics of the arm (R, L + 2): an offset in each log, a delay, and friction behind the gear."""

        def by_speed(piece: _Piece) -> Array:
            speed = piece.motion.velocity[:, self.joint]
            return np.column_stack((speed, direction(speed)))

        which = np.repeat(np.arange(len(self.made.logs)), [len(log.kept) for log in self.made.logs])
        offsets = (which[:, None] == np.arange(len(self.made.logs))).astype(float)
        return np.hstack((offsets, self.made.filtered(by_speed)))[self.used]

    @cached_property
    def apart(self) -> Array:
        """By how much more than the arm says the two differ (R,), rad (m)."""
        return self.rows(lambda piece: piece.apart[:, self.joint : self.joint + 1]) - self.expected

    def rows(self, of_piece: _OfPiece) -> Array:
        """One column of pieces at the rows (R,)."""
        return self.made.filtered(of_piece)[self.used, 0]

    def unit(self, effect: Effect, late: float, scale: float = 1.0) -> Array:
        """The pattern (R,) of a unit of an effect so late, under `scale` times the loads."""
        shape = _late(effect)
        values = {effect.sizes[0].name: 1.0, **({} if shape is None else {shape.name: late})}
        return self.rows(self.made.pattern(effect, self.joint, values, scale))

    def fitted(self, effects: tuple[Effect, ...]) -> _Set:
        """Effects fitted, as late as leaves least."""
        shapes = [shape for effect in effects if (shape := _late(effect)) is not None]

        def columns(late: float) -> Array:
            return np.column_stack((*(self.unit(effect, late) for effect in effects), self.beside))

        def left(late: float) -> float:
            return float(np.sum(_left(columns(late), self.apart) ** 2))

        late = 0.0
        if shapes:
            most = _LONGEST * max(shapes[0].grid)
            best: Any = minimize_scalar(left, bounds=(0.0, most), method="bounded", options={"xatol": _EXACT})
            late = float(best.x)
        at = columns(late)
        sizes = np.asarray(np.linalg.lstsq(at, self.apart, rcond=None)[0], dtype=float)
        return _Set(effects, late, at, sizes, self._held_out(at), float(np.sum((self.apart - at @ sizes) ** 2)))

    def _held_out(self, columns: Array) -> Array:
        """Sums of squares (B,) that fits to the other folds leave."""
        left, fold = np.zeros(len(self.torques.folds)), self.torques.folds[self.block]
        for each in np.unique(fold).tolist():
            out = fold == each
            sizes = np.linalg.lstsq(columns[~out], self.apart[~out], rcond=None)[0]
            missed = (self.apart[out] - columns[out] @ sizes) ** 2
            left += np.bincount(self.block[out], missed, minlength=len(left))
        return left

    def rms(self, squares: float) -> float:
        """The RMS of a sum of squares over all rows."""
        return float(np.sqrt(squares / max(len(self.block), 1)))

    def by_unsure_load(self, tried: _Set) -> float:
        """RMS (rad, m) by which the difference may be off where the load is by what is left of the torque."""
        more = np.zeros(len(self.block))
        for effect, size in zip(tried.effects, tried.sizes, strict=False):
            more += size * (self.unit(effect, tried.late, 1.0 + _NUDGE) - self.unit(effect, tried.late)) / _NUDGE
        load = self.load[self.used]
        return float(np.sqrt(np.mean(more**2) / np.mean(load**2))) * self.unsure if load.any() else 0.0

    def named(self, tried: _Set, beside: _Set) -> bool:
        """Whether the last effect of a set that holds those of another `beside` it has a name."""
        place = len(tried.effects) - 1
        size, effect = tried.sizes[place], tried.effects[place]
        if size < 0.0 and not (effect.sizes[0].lower < 0.0 and self.expected.any()):  # no drive gives less than nothing
            return False
        alone = tried.columns[:, place] - _fit(np.delete(tried.columns, place, 1), tried.columns[:, place])
        gain = 1.0 - self.rms(float(tried.left.sum())) / max(self.rms(float(beside.left.sum())), 1e-300)
        cut = 1.0 - self.rms(tried.fitted) / max(self.rms(beside.fitted), 1e-300)
        return (
            gain > self.rules.motion.gain
            and cut > self.rules.motion.cut
            and self.rms(float(np.sum((size * alone) ** 2))) > self.by_unsure_load(beside)
            and self._chance(tried, place) < self.rules.residual.level
        )

    def _chance(self, tried: _Set, place: int) -> float:
        spread = self.half(tried)[place] / self._quantile
        return float(2.0 * student.sf(abs(tried.sizes[place]) / max(spread, 1e-300), self._freedom))

    @property
    def _freedom(self) -> int:
        return max(len(np.unique(self.block)) - 1, 1)

    @property
    def _quantile(self) -> float:
        return float(student.ppf(0.975, self._freedom))

    def half(self, tried: _Set) -> Array:
        """How far 95 % intervals of the sizes, and last of the lateness, reach: by blocks of time or by the scatter of
        rows, the wider, and by how well the load's scale is known (`model.intervals`)."""
        slopes = sum(
            (
                size * (self.unit(effect, tried.late * (1.0 + _NUDGE)) - self.unit(effect, tried.late))
                for effect, size in zip(tried.effects, tried.sizes, strict=False)
            ),
            np.zeros(len(self.block)),
        ) / (_NUDGE * max(tried.late, 1e-9))
        count, columns = len(tried.effects), np.column_stack((tried.columns, slopes))
        unit = np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
        inverse = np.linalg.pinv((columns / unit).T @ (columns / unit))
        left = self.apart - tried.columns @ tried.sizes
        scores = np.zeros((int(self.block.max()) + 1, len(unit)))
        np.add.at(scores, self.block, columns / unit * left[:, None])
        by_blocks = np.sqrt(np.maximum(np.diagonal(inverse @ scores.T @ scores @ inverse), 0.0))
        by_rows = np.sqrt(np.maximum(np.diagonal(inverse), 0.0) * np.mean(left**2))
        spread = np.maximum(by_blocks, by_rows) / unit
        half = self._quantile * np.append(spread[:count], spread[-1])
        for place, effect in enumerate(tried.effects):
            column = tried.columns[:, place]
            more = (self.unit(effect, tried.late, 1.0 + _NUDGE) - column) / _NUDGE
            by_load = float(more @ column) / max(float(column @ column), 1e-300)
            # Patterns from filters, clocks and forms are known no better than this, two standard deviations of it.
            least = HALF * self.rules.motion.filters * tried.sizes[place]
            half[place] = np.hypot(np.hypot(half[place], least), by_load * tried.sizes[place] * self._scale)
        return half

    @cached_property
    def _scale(self) -> float:
        """By which share of itself the load may be off, as a 95 % interval: its part in what the arm leaves of the
        torque."""
        load = np.where(self.moving, self.load, 0.0)
        square = max(float(load @ load), 1e-300)
        part = np.bincount(np.concatenate(self.torques.block), load * self.left)
        return float(np.hypot(part.sum(), self._quantile * np.sqrt(np.sum(part**2)))) / square

    def cause(self, tried: _Set, place: int) -> Cause:
        """An effect of a set as a cause."""
        effect, half = tried.effects[place], self.half(tried)
        without = self.fitted(tuple(e for k, e in enumerate(tried.effects) if k != place))
        size, shape = effect.sizes[0].name, _late(effect)
        sizes, reach = {size: float(tried.sizes[place])}, {size: float(half[place])}
        if shape is not None and tried.late > half[-1]:  # else nothing shows how late it is
            sizes[shape.name], reach[shape.name] = tried.late, float(half[-1])
        blocks = len(np.unique(self.block))
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


def _at_joint(joint: _Joint, effects: Sequence[Effect]) -> Between:
    """The effects that held-out motion needs at a joint, found one after the other; the one that does least goes where
    another makes it needless."""
    bare = current = joint.fitted(())
    while True:
        rest = [effect for effect in effects if effect not in current.effects]
        tried = [joint.fitted((*current.effects, effect)) for effect in rest]
        better = [each for each in tried if joint.named(each, current)]
        if not better:
            break
        current = min(better, key=lambda each: float(each.left.sum()))
    for effect in current.effects[:-1]:
        others = tuple(each for each in current.effects if each is not effect)
        if not joint.named(joint.fitted((*others, effect)), joint.fitted(others)):
            current = joint.fitted(others)
    causes = tuple(joint.cause(current, place) for place in range(len(current.effects)))
    return Between(joint.joint + 1, causes, joint.rms(float(bare.left.sum())), joint.rms(float(current.left.sum())))
