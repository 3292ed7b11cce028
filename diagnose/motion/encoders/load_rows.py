"""The rows by which two encoders at a joint are compared: what drives pass on, and how far links stand from motors."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm, EffectEntry
from linkwright.core.arm.chain.statics import PoseState, solve
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.effects.effect import Effect, Parameter, Settings
from linkwright.core.arm.effects.elastic.elastic_drive import swing
from linkwright.core.arm.effects.elastic.joint_compliance import drive_retardation
from linkwright.core.arm.effects.torques import direction
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.errors.recorded import seen_by_drives
from linkwright.core.arm.errors.unknown_mass import of_unknown_mass, without_unknown
from linkwright.core.arm.motion.dynamics import torque_stages
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.diagnose.motion.model.entries import with_entries
from linkwright.core.diagnose.motion.preparation import PreparedLog
from linkwright.core.sections.numeric import Array

from .serial import rms


@dataclass(frozen=True)
class Torques:
    """What is known of the torques that an arm explains, by log: what it leaves of them `left` (M, n), N*m, where a
    joint moves so that this counts, `moving` (M, n), and in which fold each sample is held out, `fold` (M,)."""

    left: tuple[Array, ...]
    moving: tuple[NDArray[np.bool_], ...]
    fold: tuple[NDArray[np.int64], ...]


def of_load() -> list[Effect]:
    """The effects that show between two encoders."""
    return [effect for effect in EFFECTS.values() if effect.drive.by_load]


def late_shape(effect: Effect) -> Parameter | None:
    """The shape by which its angle lags its load, s."""
    return next((shape for shape in effect.torque_shapes if shape.kind == "time" and shape.role != "shape"), None)


@dataclass(frozen=True)
class Piece:
    """Samples of a log: the `load` (P, n) N*m that pushes each link towards increasing coordinates, how far it is from
    its motor, `apart` (P, n), and where the log's kept samples are, `within`."""

    motion: Motion
    load: Array
    apart: Array
    within: NDArray[np.int64]


OfPiece = Callable[[Piece], Array]


@dataclass(frozen=True)
class Logs:
    """Logs cut into pieces, by loads of an arm, and the arm whose drives move."""

    arm: Arm
    logs: tuple[PreparedLog, ...]
    pieces: tuple[tuple[Piece, ...], ...]

    @staticmethod
    def of(arm: Arm, logs: Sequence[PreparedLog]) -> Logs:
        """Logs by an arm's loads."""

        def made(log: PreparedLog) -> Iterator[Piece]:
            for part, _, within in log.pieces():
                motion = replace(log.piece(part), arm=with_entries(arm, log.entries))
                yield Piece(motion, -torque_stages(motion).load, motion.of_links.q - motion.q, within)

        return Logs(arm, tuple(logs), tuple(tuple(made(log)) for log in logs))

    @cached_property
    def state(self) -> PoseState:
        """The arm at some pose: what drives do goes by their loads alone."""
        known = without_unknown(self.arm, of_unknown_mass(self.arm))
        return solve(known, self.logs[0].motion.of_links.q[0].tolist(), beams_of(known))

    @cached_property
    def entries(self) -> tuple[EffectEntry, ...]:
        """What the arm has of effects between two encoders."""
        automatic = (each.id for each in of_load() if each.automatic and each.id not in self.arm.leave_out)
        return (
            *(EffectEntry(effect) for effect in automatic),
            *(entry for entry in self.arm.effects if EFFECTS[entry.effect].drive.by_load),
        )

    def filtered(self, of_piece: OfPiece) -> Array:
        """Values (P, k) of pieces at the kept samples of all logs (M, k), after the low-pass."""
        return np.concatenate(
            [
                log.filtered(of_piece(piece))[piece.within]
                for log, pieces in zip(self.logs, self.pieces, strict=True)
                for piece in pieces
            ]
        )


@dataclass(frozen=True)
class JointRows:
    """A joint (from 0) of logs: M samples are kept of them, of which R count."""

    made: Logs
    torques: Torques
    joint: int

    @cached_property
    def load(self) -> Array:
        """The filtered load (M,), N*m."""
        return self.made.filtered(lambda piece: piece.load[:, [self.joint]])[:, 0]

    @cached_property
    def moving(self) -> NDArray[np.bool_]:
        """Where the joint moves, so that its torque counts (M,)."""
        return np.concatenate([each[:, self.joint] for each in self.torques.moving])

    @cached_property
    def left(self) -> Array:
        """What the arm leaves of its torque where the joint moves, N*m."""
        return np.concatenate([each[:, self.joint] for each in self.torques.left])[self.moving]

    @cached_property
    def unsure(self) -> float:
        """RMS of what the arm leaves of its torque, by which nobody knows the load, N*m."""
        return rms(self.left)

    @cached_property
    def log(self) -> NDArray[np.int64]:
        """The log of each sample (M,)."""
        return np.repeat(np.arange(len(self.made.logs)), [len(log.kept) for log in self.made.logs])

    @cached_property
    def used(self) -> NDArray[np.bool_]:
        """The samples (M,) that count: away from where the low-pass begins and ends, where nothing pushes the arm, and
        the sign of the load is known, as far as it is."""
        use = np.ones(len(self.load), dtype=bool)
        clock = np.concatenate([log.motion.time[log.kept] for log in self.made.logs])
        for number, log in enumerate(self.made.logs):
            ends = [log.motion.time[at] for part in log.stretches for at in (part.start, part.stop - 1)]
            spans = [*log.log.aside, *((end - 1.0 / log.cutoff, end + 1.0 / log.cutoff) for end in ends)]
            for begin, end in spans:
                use &= ~((self.log == number) & (clock >= begin) & (clock <= end))
        sure = use & (np.abs(self.load) > 2.0 * self.unsure)
        return sure if sure.sum() > 0.5 * use.sum() else use

    @cached_property
    def fold(self) -> NDArray[np.int64]:
        """The fold of each row (R,)."""
        return np.concatenate(self.torques.fold)[self.used]

    @cached_property
    def measured(self) -> Array:
        """How far the link is from its motor (R,), rad (m)."""
        return self._rows(lambda piece: piece.apart[:, [self.joint]])[:, 0]

    @cached_property
    def instrument(self) -> Array:
        """What belongs to the encoders (R, L + 1): an offset in each log, and a delay between the two."""
        offsets = (self.log[self.used, None] == np.arange(len(self.made.logs))).astype(float)
        return np.hstack((offsets, self._rows(lambda piece: piece.motion.velocity[:, [self.joint]])))

    @cached_property
    def direction(self) -> Array:
        """The sign of the speed (R, 1), by which friction behind the gear holds the link back."""
        return self._rows(lambda piece: direction(piece.motion.velocity[:, [self.joint]]))

    @cached_property
    def waves(self) -> Array:
        """What goes round with the joint once or twice a turn (R, 4), as eccentric encoders and gears do; (R, 0) of a
        slide."""

        def by_angle(piece: Piece) -> Array:
            turn = piece.motion.q[:, self.joint]
            return np.column_stack([wave(order * turn) for order in (1, 2) for wave in (np.sin, np.cos)])

        return self._rows(by_angle) if self.made.arm.joints[self.joint].revolute else np.zeros((len(self.fold), 0))

    def of_arm(self, late: float | None = None, scale: float = 1.0) -> Array:
        """What the arm's drive does between the two (R,), rad (m), as `of_entries`."""
        return self.of_entries([e for e in self.made.entries if not e.at or self.joint + 1 in e.at], late, scale)

    def of_entries(self, entries: Sequence[EffectEntry], late: float | None = None, scale: float = 1.0) -> Array:
        """What entries do between the two (R,) under `scale` times the loads. Where neither they nor the arm say how
        late the drive is behind its load, it is so `late` (s; None: as an effect takes it)."""
        said = drive_retardation(self.made.arm, self.joint)
        behind = late if said is None else said

        def of_piece(piece: Piece) -> Array:
            moved = np.zeros((len(piece.load), 1))
            for entry in entries:
                effect, loads = EFFECTS[entry.effect], scale * piece.load
                if (shape := late_shape(effect)) is not None:
                    lag = entry.parameters.get(shape.name, shape.default if behind is None else behind)
                    loads[:, self.joint] = swing(piece.motion, np.zeros(len(loads)), lag, loads[:, self.joint])
                settings = Settings((self.joint,), entry.parameters)
                moved += seen_by_drives(self.made.state, effect, settings, loads)[:, [self.joint]]
            return moved

        return self._rows(of_piece)[:, 0]

    def _rows(self, of_piece: OfPiece) -> Array:
        """Columns of pieces at the rows (R, k)."""
        return self.made.filtered(of_piece)[self.used]
