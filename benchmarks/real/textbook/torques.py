"""Identification of an arm by its drive torques: base inertial parameters, friction, offset and rotors.

Per joint Coulomb and viscous friction, an offset and the rotor's inertia stand beside the rigid regressor. Torques and
columns go through the same low-pass without phase; rows are weighted by what the first fit leaves at each joint. What
the motion does not tell keeps the values of the file.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.signal import butter, sosfiltfilt

from benchmarks.real.textbook.chain import Array, Chain, skew
from benchmarks.real.textbook.least import thin_svd

RATE = 100.0
"""Hz, of the even clock."""
SMOOTH_SIGN, SLOW, SETTLED = 0.01, 0.03, 0.1
"""rad/s of a smoothed sign; rad/s below which, and s around a reversal in which, friction has no sign."""
_OWN = 4
_KEPT = 1e-10
"""Of the largest singular value: what is smaller is no parameter of any motion of this arm."""
_TOLD = 1.0
"""A direction counts where its usual size exceeds so many standard errors."""
_CORRELATED = 5.0
"""How many times wider intervals are than with independent noise: the rest of a filtered log is slow."""


@dataclass(frozen=True)
class Log:
    """`time` (N,) s, `q` (N, n) rad or m, `torque` (N, n) N*m or N."""

    time: Array
    q: Array
    torque: Array


@dataclass(frozen=True)
class Identification:
    """The arm with what was fitted: `body` (n, 10) mass, first moments, inertia (xx xy xz yy yz zz) about each frame's
    origin; `drive` (n, 4) Coulomb, viscous, offset, rotor; `left` (n,) N*m RMS of the rows that it was fitted to."""

    chain: Chain
    body: Array
    drive: Array
    left: Array

    def torque(self, q: Array, velocity: Array, acceleration: Array) -> Array:
        """Torques (N, n) of a motion."""
        rigid = regressor(self.chain, q, velocity, acceleration)
        own = _own(velocity, acceleration)
        return np.einsum("njk,k->nj", rigid, self.body.reshape(-1)) + np.einsum("njk,jk->nj", own, self.drive)


def bodies(chain: Chain) -> Array:
    """(n, 10) of the file's links."""
    first = chain.mass[:, None] * chain.centre
    upper = np.triu_indices(3)
    return np.column_stack([chain.mass, first, np.stack([tensor[upper] for tensor in chain.inertia])])


def nominal(chain: Chain) -> Identification:
    """The arm as its file says, without friction."""
    return Identification(chain, bodies(chain), np.zeros((chain.size, _OWN)), np.full(chain.size, np.nan))


def regressor(chain: Chain, q: Array, velocity: Array, acceleration: Array) -> Array:
    """(N, n, 10 n) torques per unit of each link's inertial parameters (Atkeson, An and Hollerbach 1986).

    Newton and Euler from the base out, all vectors in the base's directions; each link's wrench about its frame's
    origin then acts at every joint before it.
    """
    count, size = q.shape
    rotation, origin = np.tile(np.eye(3), (count, 1, 1)), np.zeros((count, 3))
    spin, turning = np.zeros((count, 3)), np.zeros((count, 3))
    pull: Array = np.tile(-chain.gravity, (count, 1))
    axes: list[Array] = []
    origins: list[Array] = []
    result = np.zeros((count, size, 10 * size))
    for k in range(size):
        step = rotation @ chain.fixed[k][:3, 3]
        pull = np.asarray(pull + np.cross(turning, step) + np.cross(spin, np.cross(spin, step)), dtype=float)
        origin, rotation = origin + step, rotation @ chain.fixed[k][:3, :3]
        axis = rotation @ chain.axes[k]
        rate, more = velocity[:, k : k + 1], acceleration[:, k : k + 1]
        if chain.slides[k]:
            out = axis * q[:, k : k + 1]
            pull = np.asarray(pull + np.cross(turning, out) + np.cross(spin, np.cross(spin, out)), dtype=float)
            pull = np.asarray(pull + 2.0 * np.cross(spin, axis * rate) + axis * more, dtype=float)
            origin = origin + out
        else:
            turning = turning + axis * more + np.cross(spin, axis * rate)
            spin = spin + axis * rate
            rotation = rotation @ _about(chain.axes[k], q[:, k])
        axes.append(axis)
        origins.append(origin)
        force, moment = _wrench(rotation, pull, spin, turning)
        for j in range(k + 1):
            if chain.slides[j]:
                result[:, j, 10 * k : 10 * k + 10] = np.einsum("ni,nik->nk", axes[j], force)
            else:
                lever = np.cross(axes[j], origin - origins[j])
                result[:, j, 10 * k : 10 * k + 10] = np.einsum("ni,nik->nk", axes[j], moment) + np.einsum(
                    "ni,nik->nk", lever, force
                )
    return result


def _about(axis: Array, angle: Array) -> Array:
    cross = skew(axis)
    return np.eye(3) + np.sin(angle)[:, None, None] * cross + (1.0 - np.cos(angle))[:, None, None] * (cross @ cross)


def _wrench(rotation: Array, pull: Array, spin: Array, turning: Array) -> tuple[Array, Array]:
    """Force and moment (N, 3, 10) about a link's origin per unit of its parameters."""
    fast = skew(turning) + skew(spin) @ skew(spin)
    force, moment = np.zeros((len(pull), 3, 10)), np.zeros((len(pull), 3, 10))
    force[:, :, 0] = pull
    force[:, :, 1:4] = fast @ rotation
    moment[:, :, 1:4] = -skew(pull) @ rotation
    whirl, turn = np.einsum("nji,nj->ni", rotation, spin), np.einsum("nji,nj->ni", rotation, turning)
    local = _tensor_columns(turn) + skew(whirl) @ _tensor_columns(whirl)
    moment[:, :, 4:] = rotation @ local
    return force, moment


def _tensor_columns(vector: Array) -> Array:
    """(N, 3, 6): a tensor's six numbers times these give the tensor times the vector (N, 3)."""
    x, y, z = vector.T
    result = np.zeros((len(vector), 3, 6))
    result[:, 0, 0], result[:, 0, 1], result[:, 0, 2] = x, y, z
    result[:, 1, 1], result[:, 1, 3], result[:, 1, 4] = x, y, z
    result[:, 2, 2], result[:, 2, 4], result[:, 2, 5] = x, y, z
    return result


def _own(velocity: Array, acceleration: Array) -> Array:
    """(N, n, 4) columns of each drive."""
    return np.stack([np.tanh(velocity / SMOOTH_SIGN), velocity, np.ones_like(velocity), acceleration], axis=2)


@dataclass(frozen=True)
class _Rows:
    """Filtered: `columns` (M, n, 10 n) of the bodies, `own` (M, n, 4) of the drives, `torque` and `counts` (M, n)."""

    columns: Array
    own: Array
    torque: Array
    counts: NDArray[np.bool_]


def low_passed(values: Array, cutoff: float, rate: float = RATE) -> Array:
    """A Butterworth low-pass of the fourth order forwards and backwards."""
    if cutoff >= 0.45 * rate:
        return values
    return np.asarray(sosfiltfilt(butter(2, cutoff, fs=rate, output="sos"), values, axis=0), dtype=float)


def _rows(chain: Chain, log: Log, cutoff: float, every: int) -> _Rows:
    time = np.arange(log.time[0], log.time[-1], 1.0 / RATE)
    rate = 1.0 / float(np.median(np.diff(log.time)))
    # What the even clock cannot hold is taken off before samples are dropped.
    before = [low_passed(item, 0.4 * RATE, rate) if rate > 1.2 * RATE else item for item in (log.q, log.torque)]
    q, torque = (np.column_stack([np.interp(time, log.time, column) for column in item.T]) for item in before)
    smooth = CubicSpline(time, low_passed(q, 2.0 * cutoff))
    velocity, acceleration = smooth(time, 1), smooth(time, 2)
    counts = np.abs(velocity) > SLOW
    reach = round((SETTLED + 0.25 / cutoff) * RATE)
    for j in range(chain.size):
        for turn in np.flatnonzero(np.diff(np.signbit(velocity[:, j]))):
            counts[max(turn - reach, 0) : turn + reach + 1, j] = False
    edge = round(RATE / 8.0)
    counts[:edge] = counts[-edge:] = False
    columns = low_passed(regressor(chain, smooth(time), velocity, acceleration).reshape(len(time), -1), cutoff)
    own = low_passed(_own(velocity, acceleration), cutoff)
    kept = slice(None, None, every)
    return _Rows(
        columns.reshape(len(time), chain.size, -1)[kept], own[kept], low_passed(torque, cutoff)[kept], counts[kept]
    )


def identified(
    chain: Chain, logs: Sequence[Log], cutoff: float = 8.0, *, base: bool = True, more: bool = True
) -> Identification:
    """An arm by its motion logs.

    Args:
        chain: The arm as its file says.
        logs: What is fitted.
        cutoff: Hz, of the low-pass on both sides.
        base: Whether bodies are fitted, else the file's hold.
        more: Whether offset and rotor are fitted beside friction.

    Returns:
        The arm by least squares.
    """
    every = max(1, round(RATE / (6.0 * cutoff)))
    parts = [_rows(chain, log, cutoff, every) for log in logs]
    n, start = chain.size, bodies(chain).reshape(-1)
    width = 10 * n if base else 0
    design, target, joint = [], [], []
    for part in parts:
        for j in range(n):
            use = part.counts[:, j]
            own = np.zeros((int(use.sum()), _OWN * n))
            own[:, _OWN * j : _OWN * j + (_OWN if more else 2)] = part.own[use, j][:, : _OWN if more else 2]
            rigid = part.columns[use, j]
            design.append(np.concatenate([rigid[:, :width], own], axis=1))
            target.append(part.torque[use, j] - rigid @ start)
            joint.append(np.full(int(use.sum()), j))
    matrix, aim, of = np.concatenate(design), np.concatenate(target), np.concatenate(joint)
    usual = np.concatenate([_usual(chain)[:width], np.full(_OWN * n, np.inf)])
    weight, size, rest = np.ones(n), np.zeros(matrix.shape[1]), aim
    for _ in range(3):
        size = _least(matrix * weight[of, None], aim * weight[of], usual)
        rest = aim - matrix @ size
        weight = np.array([1.0 / max(_rms(rest[of == j]), 1e-9) if (of == j).any() else 0.0 for j in range(n)])
    body = start + (size[:width] if base else 0.0)
    drive = size[width:].reshape(n, _OWN)
    left = np.array([_rms(rest[of == j]) for j in range(n)])
    return Identification(chain, body.reshape(n, 10), drive, left)


def _usual(chain: Chain) -> Array:
    """Sizes by which a link may well differ from its file: half of an even share of the mass, at a third of the arm's
    longest link."""
    mass = 0.5 * max(float(chain.mass.mean()), 0.1)
    reach = 0.3 * max(float(np.linalg.norm(chain.fixed[1:, :3, 3], axis=1).max()), 0.1)
    return np.tile([mass, *[mass * reach] * 3, *[mass * reach**2] * 6], chain.size)


def _least(matrix: Array, aim: Array, usual: Array) -> Array:
    """Least squares along the directions that are told: drives first, as they come, the bodies beside them."""
    known = np.isinf(usual)
    norm = np.linalg.norm(matrix, axis=0)
    scale = np.where(known, 1.0 / np.where(norm > 0.0, norm, 1.0), np.where(known, 1.0, usual))
    scaled = matrix * scale
    if known.all():
        return np.asarray(np.linalg.lstsq(scaled, aim, rcond=_KEPT)[0] * scale, dtype=float)
    left, sizes, right = thin_svd(scaled[:, known])
    basis = left[:, sizes > 1e-6 * sizes[0]]
    beside = scaled[:, ~known] - basis @ (basis.T @ scaled[:, ~known])
    rest = aim - basis @ (basis.T @ aim)
    u, values, vt = thin_svd(beside)
    along = u.T @ rest
    real = values > 1e-7 * values[0]
    scatter = np.sqrt(max(float(rest @ rest - along[real] @ along[real]), 1e-30) / len(aim))
    told = real & (values > _TOLD * _CORRELATED * scatter)
    size = np.zeros(len(usual))
    size[~known] = vt[told].T @ (along[told] / values[told])
    tellable = np.where(sizes > 1e-6 * sizes[0], sizes, np.inf)
    size[known] = right.T @ ((left.T @ (aim - scaled[:, ~known] @ size[~known])) / tellable)
    return size * scale


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2))) if len(values) else float("nan")
