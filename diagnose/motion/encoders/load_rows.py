"""The rows by which two encoders at a joint are compared: what drives pass on, and how far links stand from motors."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

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
from linkwright.core.sections.numeric import Array

_STEP = 1e-4
"""s, by which the slope over a delay is taken."""


@dataclass(frozen=True)
class Torques:
    """What is known of the torques that an arm explains, by log: what it leaves of them `left` (M, n), N*m, and where a
    joint moves so that this counts, `moving` (M, n). `block` (M,) numbers blocks of time over all logs, of which
    `folds` (B,) are held out together."""

    left: tuple[Array, ...]
    moving: tuple[NDArray[np.bool_], ...]
    block: tuple[NDArray[np.int64], ...]
    folds: NDArray[np.int64]


def of_load() -> list[Effect]:
    """The effects that show between two encoders."""
    return [effect for effect in EFFECTS.values() if effect.drive.by_load]


@dataclass(frozen=True)
class Piece:
    """Samples of a log: the `load` (P, n) N*m that pushes each link towards increasing coordinates, how far it is from
    its motor, `apart` (P, n), and which of the log's kept samples it holds, where."""

    motion: Motion
    load: Array
    apart: Array
    numbers: NDArray[np.int64]
    within: NDArray[np.int64]


def pieces_of(arm: Arm, log: PreparedLog) -> tuple[Piece, ...]:
    """A log in pieces, loads by an arm."""

    def made() -> Iterator[Piece]:
        for part, numbers, within in log.pieces():
            motion = replace(log.piece(part), arm=with_entries(arm, log.entries))
            apart = motion.of_links.q - motion.q
            yield Piece(motion, -torque_stages(motion).load, apart, numbers, within)

    return tuple(made())


OfPiece = Callable[[Piece], Array]


@dataclass(frozen=True)
class Logs:
    """Logs cut into pieces, and the arm whose loads they have."""

    arm: Arm
    pieces: tuple[tuple[Piece, ...], ...]
    logs: tuple[PreparedLog, ...]

    @cached_property
    def state(self) -> PoseState:
        """The arm at some pose: what drives do goes by their loads alone."""
        known = without_unknown(self.arm, of_unknown_mass(self.arm))
        return solve(known, self.logs[0].motion.of_links.q[0].tolist(), beams_of(known))

    @cached_property
    def own(self) -> tuple[EffectEntry, ...]:
        """What the arm has of such effects."""
        automatic = (each.id for each in of_load() if each.automatic and each.id not in self.arm.leave_out)
        return (
            *(EffectEntry(effect) for effect in automatic),
            *(entry for entry in self.arm.effects if EFFECTS[entry.effect].drive.by_load),
        )

    def filtered(self, of_piece: OfPiece) -> Array:
        """Values (P, k) of pieces at the kept samples of all logs (M, k), after the low-pass."""
        return np.concatenate([self._of_log(number, of_piece) for number in range(len(self.logs))])

    def _of_log(self, number: int, of_piece: OfPiece) -> Array:
        log, parts = self.logs[number], list[Array]()
        for piece in self.pieces[number]:
            parts.append(log.filtered(of_piece(piece))[piece.within])
        return np.concatenate(parts)

    def pattern(
        self, effect: Effect, joint: int, values: Mapping[str, float], scale: float = 1.0, longer: float = 0.0
    ) -> OfPiece:
        """What an effect with values moves a joint (from 0) by, (P, 1), under `scale` times the loads, so much `longer`
        (s) behind them than the values say."""
        late = late_shape(effect)
        settings = Settings((joint,), MappingProxyType(dict(values)))

        def of_piece(piece: Piece) -> Array:
            loads = scale * piece.load
            if late is not None:
                loads = loads.copy()
                behind = values.get(late.name, late.default) + longer
                loads[:, joint] = swing(piece.motion, np.zeros(len(loads)), behind, loads[:, joint])
            return seen_by_drives(self.state, effect, settings, loads)[:, joint : joint + 1]

        return of_piece


def late_shape(effect: Effect) -> Parameter | None:
    """The shape by which its angle lags its load, s."""
    return next((shape for shape in effect.torque_shapes if shape.kind == "time" and shape.role != "shape"), None)


@dataclass(frozen=True)
class JointRows:
    """A joint (from 0) of logs: M samples are kept of them, of which R count. The arm's own angles are taken to lag
    their loads `longer` (s) than its file says."""

    made: Logs
    torques: Torques
    joint: int
    longer: float = 0.0

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
        """The samples (M,) that count: away from where the low-pass begins and ends, where nothing pushes the arm, and
        the sign of the load is known, as far as it is."""
        use = np.ones(len(self.load), dtype=bool)
        clock = np.concatenate([log.motion.time[log.kept] for log in self.made.logs])
        which = np.repeat(np.arange(len(self.made.logs)), [len(log.kept) for log in self.made.logs])
        for number, log in enumerate(self.made.logs):
            ends = [log.motion.time[at] for part in log.stretches for at in (part.start, part.stop - 1)]
            spans = [*log.log.aside, *((end - 1.0 / log.cutoff, end + 1.0 / log.cutoff) for end in ends)]
            for begin, end in spans:
                use &= ~((which == number) & (clock >= begin) & (clock <= end))
        sure = use & (np.abs(self.load) > 2.0 * self.unsure)
        return sure if sure.sum() > 0.5 * use.sum() else use

    @cached_property
    def block(self) -> NDArray[np.int64]:
        """The block (R,) of each row."""
        return np.concatenate(self.torques.block)[self.used]

    @cached_property
    def expected(self) -> Array:
        """What the arm itself does between the two (R,), rad (m)."""
        return self.of_arm()

    def of_arm(self, *, scale: float = 1.0, longer: float = 0.0) -> Array:
        """The same under `scale` times the loads, its angles so much `longer` (s) behind them."""
        parts = (
            self.rows(
                self.made.pattern(EFFECTS[entry.effect], self.joint, entry.parameters, scale, self.longer + longer)
            )
            for entry in self.made.own
            if not entry.at or self.joint + 1 in entry.at
        )
        return sum(parts, np.zeros(len(self.block)))

    @cached_property
    def beside(self) -> Array:
        """What is no physics of the arm (R, L + 2 or 3): an offset in each log, a delay, friction behind the gear, and,
        where it gives, how much longer its angles lag their loads (s), of which its file may say nothing."""

        def by_speed(piece: Piece) -> Array:
            speed = piece.motion.velocity[:, self.joint]
            return np.column_stack((speed, direction(speed)))

        which = np.repeat(np.arange(len(self.made.logs)), [len(log.kept) for log in self.made.logs])
        offsets = (which[:, None] == np.arange(len(self.made.logs))).astype(float)
        columns = np.hstack((offsets, self.made.filtered(by_speed)))[self.used]
        return np.column_stack((columns, self.lags)) if self.lags.any() else columns

    @cached_property
    def lags(self) -> Array:
        """What a second changes (R,) by which the arm's own angles lag their loads longer."""
        return (self.of_arm(longer=_STEP) - self.expected) / _STEP

    @cached_property
    def waves(self) -> Array:
        """What goes round with the joint once or twice a turn (R, 4), as eccentric encoders and gears do."""

        def by_angle(piece: Piece) -> Array:
            turn = piece.motion.q[:, self.joint]
            return np.column_stack([wave(order * turn) for order in (1, 2) for wave in (np.sin, np.cos)])

        return self.made.filtered(by_angle)[self.used]

    @property
    def turns(self) -> bool:
        """Whether the joint turns."""
        return self.made.arm.joints[self.joint].revolute

    @cached_property
    def apart(self) -> Array:
        """By how much more than the arm says the two differ (R,), rad (m)."""
        return self.rows(lambda piece: piece.apart[:, self.joint : self.joint + 1]) - self.expected

    def rows(self, of_piece: OfPiece) -> Array:
        """One column of pieces at the rows (R,)."""
        return self.made.filtered(of_piece)[self.used, 0]

    def unit(self, effect: Effect, late: float, scale: float = 1.0) -> Array:
        """The pattern (R,) of a unit of an effect so late, under `scale` times the loads."""
        shape = late_shape(effect)
        values = {effect.sizes[0].name: 1.0, **({} if shape is None else {shape.name: late})}
        return self.rows(self.made.pattern(effect, self.joint, values, scale))
