"""Torque constants that nobody says, by what the arm weighs: currents and voltages as torques, one factor at each
joint.

A load that some logs have at the tip is fitted beside the constants, for the arm's weights would else stand for it.
Constants by weights are known no better than these: all constants larger by a factor are all masses larger by it, that
of a load among them (M. Gautier & S. Briot, Global identification of joint drive gains and dynamic parameters of
robots, ASME J. Dyn. Sys. Meas. Control 136 (2014) 051025, doi:10.1115/1.4027506).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import block_diag

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects.loads.payload import PAYLOAD
from linkwright.core.arm.effects.torques import direction
from linkwright.core.arm.motion.rigid import inverse_dynamics, regressor
from linkwright.core.diagnose.result import HALF, FittedParameter
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError

from .events.changed import SURE
from .log import TORQUE, MotionLog
from .preparation import PreparedLog
from .result import MotionFinding

_OF_DRIVE, _OF_LOAD = 4, 10
"""What a drive has beside the arm's weights (a constant, dry and viscous friction, a rotor), and what a load has."""


def weighed(arm: Arm, prepared: Sequence[PreparedLog], *, rules: Rules) -> list[MotionLog]:
    """The logs with currents or voltages of unknown torque constants as torques, by the constants that the arm's
    weights make.

    Drives by whose signals the weights tell nothing count as not logged: their friction alone tells no constant.

    Args:
        arm: The arm, its masses known.
        prepared: All logs; those with torques stay as they are.
        rules: From what on a weight tells a constant.

    Raises:
        InputError: The weights tell the constant of no joint.
    """
    free = [item for item in prepared if item.log.torque_constants_free]
    if not free:
        return [item.log for item in prepared]
    constants, weights = _constants(arm, free, rules)
    constants[weights < rules.residual.torque_seen * weights.max()] = math.nan
    if not np.isfinite(constants).any():
        message = (
            "is missing, and the arm's weights tell none: write `torque_constants: [14.9, ...]` "
            f"(N m/{free[0].log.drive.unit}, one a joint)"
        )
        raise InputError(free[0].log.settings or free[0].log.file, "torque_constants", f"{message} in recording.yaml")
    return [
        replace(item.log, torque=item.log.torque * constants, weighed=tuple(constants.tolist()))
        if item.log.torque_constants_free
        else item.log
        for item in prepared
    ]


def _constants(arm: Arm, free: Sequence[PreparedLog], rules: Rules) -> tuple[Array, Array]:
    """N*m/A (N*m/V) by joint (n,), by what weights make beyond friction, a drive's inertia and a constant (nan: not
    told), and how much (N*m RMS) that is (n,).

    As few logs as may be have a load of their own: beside those of the others it would lower what is left (RMS) by less
    than half.
    """
    drives = [_drive(free, joint, rules) for joint in range(arm.size)]
    known = [drive for drive in drives if drive is not None]
    loads = [np.zeros((len(free), _OF_LOAD))]
    while (more := _with_one_more(known, loads[-1], rules)) is not None:
        loads.append(more)
    left = [_left(known, each) for each in loads]
    few = next(number for number, each in enumerate(left) if HALF**2 * each <= min(left[number:]))
    constants, weights = np.array(
        [(math.nan, 0.0) if drive is None else drive.constant(loads[few], rules) for drive in drives]
    ).T
    return constants, weights


@dataclass(frozen=True)
class _Drive:
    """A drive's signal `current` (M,), weights `arm` (M,) that it bears by the arm file, and by each parameter of each
    log's load, `load` (M, logs, 10), all beside what a drive has of its own, and compressed: sums of products are those
    of `rows` samples. Signals are known to `sigma`."""

    current: Array
    arm: Array
    load: Array
    rows: int
    sigma: float

    def weights(self, loads: Array) -> Array:
        """The weights (M,) with loads (logs, 10)."""
        return np.asarray(self.arm + np.tensordot(self.load, loads))

    def missed(self, loads: Array) -> Array:
        """What a multiple of the weights leaves of the signal (M,), in standard deviations of a sample."""
        weights = self.weights(loads)
        return (self.current - weights * (weights @ self.current) / max(float(weights @ weights), 1e-300)) / self.sigma

    def constant(self, loads: Array, rules: Rules) -> tuple[float, float]:
        """N*m/A (N*m/V; nan: not told), and N*m RMS of the weights."""
        m, y = self.weights(loads), self.current
        size = math.sqrt(float(m @ m) * float(y @ y))
        enough = size > 0.0 and float(y @ m) > rules.fitting.same_way * size
        return float(m @ m) / float(y @ m) if enough else math.nan, math.sqrt(float(m @ m) / self.rows)


def _drive(free: Sequence[PreparedLog], joint: int, rules: Rules) -> _Drive | None:
    """A joint's drive in all logs; None where these hold too little of it."""
    parts = [_rows(item, joint) for item in free]
    rows = sum(len(part) for part in parts)
    if rows <= _OF_DRIVE:
        return None
    # Rows of one log hold no other's load: each log is compressed by itself, then all together.
    table: list[Array] = []
    for number, part in enumerate(parts):
        made = np.asarray(np.linalg.qr(part, mode="r"))
        wide = np.zeros((len(made), _OF_DRIVE + 1 + _OF_LOAD * len(free) + 1))
        wide[:, : _OF_DRIVE + 1], wide[:, -1] = made[:, : _OF_DRIVE + 1], made[:, -1]
        wide[:, _OF_DRIVE + 1 + _OF_LOAD * number :][:, :_OF_LOAD] = made[:, _OF_DRIVE + 1 : -1]
        table.append(wide)
    beside = np.asarray(np.linalg.qr(np.concatenate(table), mode="r"))[_OF_DRIVE:, _OF_DRIVE:]
    current, bodies = beside[:, -1], beside[:, :-1]
    left = current - bodies @ np.linalg.lstsq(bodies, current, rcond=None)[0]
    least = rules.motion.filters * float(np.linalg.norm(current))
    sigma = max(float(np.linalg.norm(left)), least) / math.sqrt(rows)
    load = bodies[:, 1:].reshape(-1, len(free), _OF_LOAD)
    return _Drive(current, bodies[:, 0], load, rows, sigma) if sigma > 0.0 else None


def _left(drives: Sequence[_Drive], loads: Array) -> float:
    """The sum of squares that multiples of the weights with loads (logs, 10) leave of the signals."""
    return sum(float(np.sum(drive.missed(loads) ** 2)) for drive in drives)


def _with_one_more(drives: Sequence[_Drive], loads: Array, rules: Rules) -> Array | None:
    """The loads (logs, 10) with one more, which leaves least; None where no log is left that may have one."""
    had = loads.any(axis=1)
    without = [number for number in np.flatnonzero(~had).tolist() if _tells(drives, number, rules)]
    tried = ((number, _with_loads(drives, loads, [number])) for number in without)
    heavier = [(_left(drives, more), number) for number, more in tried if more[number, 0] > 0.0]
    if not heavier:
        return None
    return _with_loads(drives, loads, [*np.flatnonzero(had).tolist(), min(heavier)[1]])


def _tells(drives: Sequence[_Drive], number: int, rules: Rules) -> bool:
    """Whether the arm's weights are none that a load in a log (its number) may have: constants would else be any."""
    weights, load = (np.concatenate(items) for items in zip(*((d.arm, d.load[:, number]) for d in drives), strict=True))
    beyond = weights - load @ np.linalg.lstsq(load, weights, rcond=None)[0]
    return float(np.linalg.norm(beyond)) > rules.residual.torque_seen * float(np.linalg.norm(weights))


def _with_loads(drives: Sequence[_Drive], loads: Array, numbers: Sequence[int]) -> Array:
    """The loads (logs, 10) with those in some logs (their numbers) that leave least.

    By torques, constants and loads are linear. Noise of the signals makes such constants too small, so that from there
    the signals themselves are fitted.
    """
    from scipy.optimize import least_squares  # here, for logs with torques need none of it

    known = loads.copy()
    known[numbers] = 0.0

    def of(some: Array) -> Array:
        made = known.copy()
        made[numbers] = some.reshape(-1, _OF_LOAD)
        return made

    def missed(some: Array) -> Array:
        return np.concatenate([drive.missed(of(some)) for drive in drives])

    signals = np.asarray(block_diag(*(drive.current[:, None] for drive in drives)), dtype=float)
    weights = np.concatenate([drive.weights(known) for drive in drives])
    bodies = np.concatenate([drive.load[:, numbers].reshape(len(drive.load), -1) for drive in drives])
    begun = np.linalg.lstsq(np.hstack((signals, -bodies)), weights, rcond=None)[0][len(drives) :]
    return of(np.asarray(least_squares(missed, begun, method="lm", x_scale="jac").x))


def _rows(log: PreparedLog, joint: int) -> Array:
    """What a drive has of its own (M, 4), torque by the arm's weights, by each parameter of a load (M, 10), and current
    or voltage, filtered, where the joint moves (M, 16)."""
    use = log.moving[:, joint]
    parts = [np.zeros((0, _OF_DRIVE + 1 + _OF_LOAD + 1))]
    for part, numbers, within in log.pieces():
        motion = log.piece(part)
        moves, v, a = motion.of_links, motion.velocity[:, joint], motion.acceleration[:, joint]
        of_links = regressor(motion.arm, moves.q, moves.velocity, moves.acceleration)[:, joint, -_OF_LOAD:]
        columns = [np.ones(len(v)), direction(v), v, a]
        columns += [inverse_dynamics(motion)[:, joint], *of_links.T, log.measured[part, joint]]
        parts.append(log.filtered(np.stack(columns, axis=1))[within][use[numbers]])
    return np.concatenate(parts)


def as_the_constants(finding: MotionFinding, logs: Sequence[MotionLog], rules: Rules) -> MotionFinding:
    """A finding with intervals of a load that hold what a factor of all masses, and of constants by weights with them,
    would change."""
    if finding.effect != PAYLOAD.id or not any(log.weighed for log in logs):
        return finding
    # What one log has of its own was told beside masses and constants that are both nearly right. Of a factor of the
    # masses, which these are as likely to hold, half of the square is in its interval already.
    share = SURE * rules.motion.scaled * (math.sqrt(HALF) if finding.recording else 1.0)

    def wider(item: FittedParameter) -> FittedParameter:
        low, high = (math.hypot(end - item.value, share * item.value) for end in item.interval)
        return replace(item, interval=(item.value - low, item.value + high))

    return replace(finding, parameters=tuple(map(wider, finding.parameters)))


def load_words(named: Sequence[MotionFinding], logs: Sequence[MotionLog]) -> list[str]:
    """What a load that was named is known by, and which log would tell more."""
    loads = [item for item in named if item.effect == PAYLOAD.id]
    if not loads:
        return []
    words: list[str] = []
    if any(log.weighed for log in logs):
        words.append(
            "These logs cannot tell the load from the gain of all drives, which rests on the masses of the arm file. "
            "The load's interval holds both. "
            "`torque_constants` in recording.yaml tells them apart."
        )
    elif any(log.drive is not TORQUE for log in logs):
        words.append("The load is as exact as the torque constants: a share of all of these is a share of it.")
    open_ = [item for item in loads if item.alternatives or all(size.parameter != "mass" for size in item.parameters)]
    if open_ and not any(item.recording for item in loads):
        words.append("What of it is the load and what the arm's own mass a log of the same arm without it would tell.")
    return words
