"""Calibration of an arm by where its tip was: nonlinear least squares over the forward kinematics.

Fitted are, at each joint, how its axis stands (three small turns, the joint's zero among them) and where it is (three
shifts, lengths among them); the tool; and how far each drive and the base give way under gravity. Of links whose
weights nobody knows, each drive gives by first moments of its own. Steps are taken along those directions alone that
the readings tell to within a third of a usual size.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.real.textbook.chain import Array, Chain, transform, turned
from benchmarks.real.textbook.least import thin_svd

TURN, SHIFT, SAG = 3e-3, 3e-3, 3e-3
"""Usual sizes: rad, m, and rad of a drive under all that it carries."""
TOLD = 3.0
"""A direction counts where its usual size is so many times its standard error."""
_ROUNDS = 6
_SHARES = (1.0, 0.5, 0.25, 0.1)
"""Of a step, tried until one leaves less."""


@dataclass(frozen=True)
class Poses:
    """Readings of one setup: `q` (N, n) rad or m, `tip` (N, 3) m in the measuring frame, `payload` (N,) kg at the tip,
    `torque` (N, n) N*m measured at the joints where it counts in place of a model of gravity."""

    q: Array
    tip: Array
    payload: Array | None = None
    torque: Array | None = None


@dataclass(frozen=True)
class Setup:
    """Where one setup has the measuring frame (4, 4) and its target (3,) m beyond the last frame."""

    frame: Array
    tool: Array


@dataclass(frozen=True)
class Calibration:
    """What was fitted: `stations` (n, 4, 4) corrections behind each fixed transform (the first is the setup's), `sag`
    (m,) coefficients of the columns of `_sags`, `setups` those that it was fitted with, `rms` m what it leaves there.
    """

    chain: Chain
    stations: Array
    sag: Array
    gives: bool
    setups: tuple[Setup, ...] = field(default=())
    rms: float = float("nan")


def nominal(chain: Chain) -> Calibration:
    """The arm as its file says."""
    return Calibration(chain, np.stack([np.eye(4)] * chain.size), np.zeros(0), False)


@dataclass(frozen=True)
class _Frames:
    """Rotations (n + 1, N, 3, 3) and origins (n + 1, N, 3) of the stations, axes (n, N, 3) of the joints, tips (N, 3);
    all in the measuring frame."""

    rotations: Array
    origins: Array
    axes: Array
    tip: Array


def _frames(known: Calibration, setup: Setup, q: Array) -> _Frames:
    chain = known.chain
    rotation, origin = np.tile(setup.frame[:3, :3], (len(q), 1, 1)), np.tile(setup.frame[:3, 3], (len(q), 1))
    rotations, origins, axes = [], [], []
    for k in range(chain.size):
        step = chain.fixed[k] @ known.stations[k] if k else chain.fixed[k]
        origin = origin + rotation @ step[:3, 3]
        rotation = rotation @ step[:3, :3]
        rotations.append(rotation)
        origins.append(origin)
        axes.append(rotation @ chain.axes[k])
        if chain.slides[k]:
            origin = origin + axes[-1] * q[:, k : k + 1]
        else:
            rotation = rotation @ turned(q[:, k : k + 1] * chain.axes[k])
    step = chain.fixed[-1]
    origin, rotation = origin + rotation @ step[:3, 3], rotation @ step[:3, :3]
    return _Frames(
        np.stack([*rotations, rotation]),
        np.stack([*origins, origin]),
        np.stack(axes),
        origin + rotation @ setup.tool,
    )


def places(known: Calibration, setup: Setup, q: Array) -> Array:
    """Where the target is (N, 3) m in the measuring frame."""
    poses = Poses(q, np.zeros((len(q), 3)))
    return -_left(known, setup, poses, _frames(known, setup, q))


def _down(known: Calibration, setup: Setup) -> Array:
    """Gravity in the measuring frame."""
    return setup.frame[:3, :3] @ known.chain.gravity


def _sags(known: Calibration, setup: Setup, poses: Poses, frames: _Frames) -> list[Array]:
    """Turns (N, 3) rad at a usual size each, with the joint or base (origins (N, 3)) about which: the columns of what
    gives way, each scaled to one at its largest."""
    chain, down = known.chain, _down(known, setup)
    moments = _moments(chain, poses, frames, down)
    results: list[Array] = []
    for j in range(chain.size):
        if chain.slides[j]:
            continue
        if poses.torque is not None:
            loads = [-poses.torque[:, j]]
        elif chain.weighed:
            about = np.sum([np.cross(at - frames.origins[j], force) for at, force in moments[j:]], axis=0)
            loads = [np.sum(frames.axes[j] * about, axis=1)]
        else:
            loads = [
                np.sum(frames.axes[j] * np.cross(lever, down), axis=1)
                for k in range(j + 1, chain.size + 1)
                for lever in np.moveaxis(frames.rotations[k], 2, 0)
            ]
        results += [_turn(frames, frames.axes[j] * load[:, None], frames.origins[j]) for load in loads]
    results += _base(chain, frames, moments, down)
    return results


def _moments(chain: Chain, poses: Poses, frames: _Frames, down: Array) -> list[tuple[Array, Array]]:
    """Where each link's weight acts (N, 3) and the weight (N, 3); the payload's last."""
    results = [
        (
            frames.origins[k] + _behind(chain, frames, k) @ chain.centre[k],
            np.tile(chain.mass[k] * down, (len(poses.q), 1)),
        )
        for k in range(chain.size)
    ]
    if poses.payload is not None:
        results.append((frames.tip, poses.payload[:, None] * down))
    return results


def _behind(chain: Chain, frames: _Frames, k: int) -> Array:
    """Rotations (N, 3, 3) of the frame behind joint k."""
    onward = chain.fixed[k + 1][:3, :3]
    return frames.rotations[k + 1] @ onward.T


def _base(chain: Chain, frames: _Frames, moments: list[tuple[Array, Array]], down: Array) -> list[Array]:
    """The base gives way to the moment of all weights about its foot."""
    foot = frames.origins[0]
    if chain.weighed:
        whole: Array = np.sum([np.cross(at - foot, force) for at, force in moments], axis=0, dtype=float)
        return [_turn(frames, whole, foot)]
    levers = [lever for k in range(1, chain.size + 1) for lever in np.moveaxis(frames.rotations[k], 2, 0)]
    return [_turn(frames, np.cross(lever, down), foot) for lever in levers]


def _usual_sags(known: Calibration, several: Sequence[Poses], setups: Sequence[Setup]) -> Array:
    """Sizes at which each column of what gives way turns the tip as far as is usual. Of first moments all are alike; a
    drive that carries next to nothing counts as one that carries a hundredth of the most."""
    if not known.gives:
        return np.zeros(0)
    columns = [
        np.stack(_sags(known, setup, poses, _frames(known, setup, poses.q)), axis=2)
        for poses, setup in zip(several, setups, strict=True)
    ]
    size = np.sqrt(np.mean(np.concatenate(columns) ** 2, axis=(0, 1)))
    if not known.chain.weighed and all(poses.torque is None for poses in several):
        return np.full(len(size), SAG / float(np.linalg.norm(known.chain.gravity)))
    reach = max(float(np.linalg.norm(poses.tip - poses.tip.mean(axis=0), axis=1).max()) for poses in several)
    return SAG * reach / np.maximum(size, 1e-2 * size.max())


def _turn(frames: _Frames, turn: Array, about: Array) -> Array:
    """How the tip moves (N, 3) by a small turn (N, 3) about a point."""
    return np.cross(turn, frames.tip - about)


def _columns(known: Calibration, frames: _Frames) -> tuple[Array, Array]:
    """Columns of a setup's own sizes (N, 3, 9), and of the other joints' geometry (N, 3, 6 (n - 1))."""
    own, shared = [], []
    for k in range(known.chain.size):
        arms = frames.tip - frames.origins[k]
        axes = np.moveaxis(frames.rotations[k], 2, 0)
        columns = [*(np.cross(axis, arms) for axis in axes), *axes]
        (shared if k else own).extend(columns)
    own += list(np.moveaxis(frames.rotations[-1], 2, 0))
    return np.stack(own, axis=2), np.stack(shared, axis=2)


def _aligned(known: Calibration, poses: Poses) -> Setup:
    """The setup that the arm fits best as it is, by turns of least squares from a rigid alignment."""
    setup = Setup(np.eye(4), np.zeros(3))
    for _ in range(3):
        at = _frames(known, setup, poses.q)
        start = at.tip.mean(axis=0), poses.tip.mean(axis=0)
        u, _, vt = np.linalg.svd((at.tip - start[0]).T @ (poses.tip - start[1]))
        turn = vt.T @ np.diag([1.0, 1.0, np.sign(np.linalg.det(vt.T @ u.T))]) @ u.T
        setup = replace(setup, frame=transform(turn, start[1] - turn @ start[0]) @ setup.frame)
        at = _frames(known, setup, poses.q)
        tools = np.concatenate([at.rotations[-1], np.tile(np.eye(3), (len(poses.q), 1, 1))], axis=2).reshape(-1, 6)
        more = np.linalg.lstsq(tools, (poses.tip - at.tip).reshape(-1), rcond=1e-9)[0]
        setup = replace(setup, tool=setup.tool + more[:3])
    return setup


def _moved(setup: Setup, chain: Chain, size: Array) -> Setup:
    """A setup after a step of its nine sizes; the turns are about the first joint's frame."""
    first = chain.fixed[0]
    step = first @ transform(turned(size[:3]), size[3:6]) @ np.linalg.inv(first)
    return Setup(setup.frame @ step, setup.tool + size[6:9])


def _left(known: Calibration, setup: Setup, poses: Poses, frames: _Frames) -> Array:
    """Measured less modelled (N, 3) m."""
    rest = poses.tip - frames.tip
    if known.gives and len(known.sag):
        rest = rest - np.stack(_sags(known, setup, poses, frames), axis=2) @ known.sag
    return rest


def seated(known: Calibration, poses: Poses) -> tuple[Setup, Array]:
    """Frame and tool fitted to a recording with all else as it is, and what is left (N, 3) m."""
    setup = _aligned(known, poses)
    for _ in range(_ROUNDS):
        frames = _frames(known, setup, poses.q)
        own, _ = _columns(known, frames)
        step = _solved(own.reshape(-1, 9), _left(known, setup, poses, frames).reshape(-1))
        setup = _moved(setup, known.chain, step)
    return setup, _left(known, setup, poses, _frames(known, setup, poses.q))


def retargeted(known: Calibration, poses: Poses, seen: NDArray[np.bool_]) -> Array:
    """What is left (M, 3) m of the poses that are not `seen` (N,), with the frame that the calibration was fitted with
    and the target placed by those that are."""
    setup = known.setups[0]
    for _ in range(2):
        frames = _frames(known, setup, poses.q)
        rest = _left(known, setup, poses, frames)
        turns = frames.rotations[-1][seen]
        setup = replace(setup, tool=setup.tool + np.mean(np.einsum("nji,nj->ni", turns, rest[seen]), axis=0))
    return _left(known, setup, poses, _frames(known, setup, poses.q))[~seen]


def _solved(columns: Array, target: Array) -> Array:
    norm = np.linalg.norm(columns, axis=0)
    norm = np.where(norm > 0.0, norm, 1.0)
    return np.linalg.lstsq(columns / norm, target, rcond=1e-9)[0] / norm


def calibrated(chain: Chain, several: Sequence[Poses], *, gives: bool = True, geometry: bool = True) -> Calibration:
    """The calibration of an arm by one or more recordings, each with a frame and a tool of its own.

    Args:
        chain: The arm as its file says.
        several: The recordings.
        gives: Whether drives and base give way under gravity.
        geometry: Whether axes, zeros and lengths are fitted.

    Returns:
        The arm by least squares.
    """
    known = replace(nominal(chain), gives=gives)
    setups = [_aligned(known, poses) for poses in several]
    usual: Array | None = None
    for _ in range(_ROUNDS):
        blocks, targets = [], []
        for number, (poses, setup) in enumerate(zip(several, setups, strict=True)):
            frames = _frames(known, setup, poses.q)
            own, shared = _columns(known, frames)
            sags = _sags(known, setup, poses, frames) if gives else []
            if len(known.sag) == 0:
                known = replace(known, sag=np.zeros(len(sags)))
            wide = np.zeros((*own.shape[:2], 9 * len(several)))
            wide[:, :, 9 * number : 9 * number + 9] = own
            parts = [wide, shared[:, :, : shared.shape[2] if geometry else 0]]
            parts += [np.stack(sags, axis=2)] if sags else []
            blocks.append(np.concatenate(parts, axis=2))
            targets.append(_left(known, setup, poses, frames))
        design = np.concatenate([block.reshape(-1, block.shape[2]) for block in blocks])
        target = np.concatenate([item.reshape(-1) for item in targets])
        own_size, count = 9 * len(several), (6 * (chain.size - 1) if geometry else 0)
        if usual is None:
            usual = np.concatenate([np.tile([TURN] * 3 + [SHIFT] * 3, count // 6), _usual_sags(known, several, setups)])
        step, before = _told(design, target, own_size, usual), float(target @ target)
        for share in _SHARES:
            tried = _stepped(known, setups, share * step, count // 6)
            if _squares(*tried, several) < before:
                known, setups = tried
                break
        else:
            break
    rest = [
        _left(known, setup, poses, _frames(known, setup, poses.q)) for poses, setup in zip(several, setups, strict=True)
    ]
    return replace(known, setups=tuple(setups), rms=rms(np.concatenate(rest)))


def _stepped(known: Calibration, setups: Sequence[Setup], step: Array, joints: int) -> tuple[Calibration, list[Setup]]:
    """The arm and its setups after a step; `joints` of it are of geometry."""
    own = 9 * len(setups)
    moved = [_moved(setup, known.chain, step[9 * k : 9 * k + 9]) for k, setup in enumerate(setups)]
    stations = known.stations.copy()
    for k in range(joints):
        size = step[own + 6 * k : own + 6 * k + 6]
        stations[k + 1] = stations[k + 1] @ transform(turned(size[:3]), size[3:])
    return replace(known, stations=stations, sag=known.sag + step[own + 6 * joints :]), moved


def _squares(known: Calibration, setups: Sequence[Setup], several: Sequence[Poses]) -> float:
    """The sum of squares that is left, m^2."""
    return sum(
        float(np.sum(_left(known, setup, poses, _frames(known, setup, poses.q)) ** 2))
        for poses, setup in zip(several, setups, strict=True)
    )


def _told(design: Array, target: Array, own: int, usual: Array) -> Array:
    """Least squares: frame and tool as they come, the rest along what the readings tell beside these."""
    free, rest = design[:, :own], design[:, own:] * usual
    norm = np.linalg.norm(free, axis=0)
    basis, values, _ = thin_svd(free / np.where(norm > 0.0, norm, 1.0))
    basis = basis[:, values > 1e-9 * values[0]]
    beside = rest - basis @ (basis.T @ rest)
    aim = target - basis @ (basis.T @ target)
    left, sizes, right = thin_svd(beside)
    along = left.T @ aim
    scatter = np.sqrt(max(float(aim @ aim - along @ along), 1e-30) / max(len(aim) - own - len(sizes), 1))
    use = (sizes > TOLD * scatter) & (sizes > 1e-9 * sizes[0]) if len(sizes) else np.zeros(0, dtype=bool)
    more = right[use].T @ (along[use] / sizes[use])
    return np.concatenate([_solved(free, target - rest @ more), more * usual])


def rms(residual: Array) -> float:
    """The RMS length, m."""
    return float(np.sqrt(np.mean(np.sum(residual**2, axis=1))))
