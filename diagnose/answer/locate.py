"""Where the mismatch sits, before anything is named: which joint, which direction, what it depends on."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from linkwright.core.diagnose.fitting.prepare import Prepared
from linkwright.core.diagnose.patterns.basis import interactions, tip_axes, tip_of
from linkwright.core.diagnose.patterns.pool import orthonormal
from linkwright.core.diagnose.residual.observed import Observed
from linkwright.core.diagnose.residual.visits import stays
from linkwright.core.diagnose.result import Dependence
from linkwright.core.diagnose.rules.residual_rules import ResidualRules
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.diagnose.search.calibrate import p_value
from linkwright.core.sections.numeric import Array

_DRAWS = 299


def joint_shares(prepared: Prepared) -> tuple[float, ...]:
    """The share of the mismatch's sum of squares that motion of each joint alone could describe, its size a smooth
    function of its coordinate, its load, the side, temperature and time."""
    total = float(prepared.vector @ prepared.vector)
    shares: list[float] = []
    for index in range(prepared.observed.arm.size):
        basis = orthonormal(prepared.pool.projected(prepared.observed.whitened(_motion(prepared.observed, index))))
        along = basis.T @ prepared.vector
        # What as many columns of noise would describe is taken off.
        chance = basis.shape[1] / max(len(prepared.vector), 1)
        share = float(along @ along) / max(total, 1e-300)
        shares.append(max(0.0, (share - chance) / max(1.0 - chance, 1e-9)))
    return tuple(shares)


def _motion(observed: Observed, index: int) -> Array:
    """Motions of one joint (N, C, d)."""
    joint = observed.state.joints[index]
    q, load = observed.recording.q[:, index], np.broadcast_to(np.asarray(joint.drive_load, float), (observed.rows,))
    functions = [np.ones(observed.rows), np.sin(q), np.cos(q)]
    further = (load, observed.recording.temperature, observed.recording.time)
    functions += [(v - v.mean()) / np.ptp(v) for v in further if v is not None and np.ptp(v) > 0.0]
    if observed.recording.sides is not None:
        functions.append(observed.recording.sides[:, index])
    return interactions(functions, observed.drive_moved(index)[:, :, None])


def dependences(prepared: Prepared, joint: int, rng: np.random.Generator) -> tuple[Dependence, ...]:
    """Which covariates the mismatch depends on: for each, smooth functions of it along every axis and as a motion of
    `joint` (from 0) are tried, and the largest share over all covariates calibrates p by permutation of stays at a
    pose, and of the visits within each. A shift of all readings alike depends on nothing and is taken off first."""
    observed = prepared.observed
    alike = interactions([np.ones(observed.rows)], tip_axes(observed))
    shift = orthonormal(prepared.pool.projected(observed.whitened(alike)), 1e-6)

    def beyond(vectors: Array) -> Array:
        left = prepared.pool.projected(vectors)
        return left - shift @ (shift.T @ left)

    bases: list[tuple[str, Array]] = []
    for name, values in _covariates(observed):
        columns = _smooth(observed, values, joint)
        basis = orthonormal(beyond(observed.whitened(columns)), 1e-6)
        if basis.shape[1]:
            bases.append((name, basis))
    if not bases:
        return ()
    vector = beyond(prepared.vector)
    total = float(vector @ vector)
    shares = _shares(bases, vector[:, None])[:, 0]
    width = observed.residual.shape[1]
    table = vector.reshape(-1, width)
    draws: list[Array] = []
    stay = stays(observed)
    for _ in range(_DRAWS):
        moved = beyond(_mixed(table, stay, prepared.visits, rng).reshape(-1))
        draws.append(_shares(bases, moved[:, None])[:, 0])
    drawn = np.array(draws)
    spread = drawn.std(axis=0) + 1e-12
    largest = ((drawn - drawn.mean(axis=0)) / spread).max(axis=1)
    scores = (shares - drawn.mean(axis=0)) / spread
    results = [
        Dependence(name, p_value(float(score), largest), max(0.0, float(share - middle)))
        for (name, _), score, share, middle in zip(bases, scores, shares, drawn.mean(axis=0), strict=True)
    ]
    return tuple(sorted(results, key=lambda result: -result.share)) if total > 0.0 else ()


def _mixed(table: Array, stay: NDArray[np.int64], visits: NDArray[np.int64], rng: np.random.Generator) -> Array:
    """Readings (N, C) with whole stays (N,) in random order, each under a random sign, and the visits (N,) within each
    in random order: what one pose does under two payloads, one after the other, happened once."""
    flips = rng.choice((-1.0, 1.0), int(stay[-1]) + 1)
    rows = np.lexsort((rng.permutation(int(visits[-1]) + 1)[visits], rng.permutation(len(flips))[stay]))
    return table[rows] * flips[stay[rows], None]


def depends_on(dependences: Sequence[Dependence], *, rules: ResidualRules = RULES.residual) -> tuple[str, ...]:
    """The covariates beyond doubt, strongest first."""
    return tuple(item.on for item in dependences if item.p_value <= rules.level and item.share > 0.0)


def _shares(bases: Sequence[tuple[str, Array]], vectors: Array) -> Array:
    total = np.sum(vectors * vectors, axis=0)
    unit = np.where(total > 0.0, total, 1.0)
    return np.stack([np.sum((basis.T @ vectors) ** 2, axis=0) / unit for _, basis in bases])


def _covariates(observed: Observed) -> list[tuple[str, Array]]:
    recording = observed.recording
    place = tip_of(observed)[:, : observed.space]
    results: list[tuple[str, Array]] = [("position", place)]
    for index in range(observed.arm.size):
        results.append((f"q{index + 1}", recording.q[:, index : index + 1]))
        if recording.sides is not None:
            results.append((f"dir{index + 1}", recording.sides[:, index : index + 1]))
    plain = (
        ("payload_kg", recording.payload_mass),
        ("temperature_degC", recording.temperature),
        ("time", recording.time),
    )
    results += [(name, values[:, None]) for name, values in plain if values is not None]
    return [(name, values) for name, values in results if np.ptp(values, axis=0).max() > 0.0]


def _smooth(observed: Observed, values: Array, joint: int) -> Array:
    """Smooth functions of a covariate (N, k) along every axis and as motion of a joint, (N, C, d)."""
    spread = np.ptp(values, axis=0)
    scaled = (values - values.mean(axis=0)) / np.where(spread > 0.0, spread, 1.0)
    functions = [scaled[:, i] for i in range(scaled.shape[1])]
    if len(np.unique(np.round(scaled, 6), axis=0)) > 3:
        functions += [scaled[:, i] * scaled[:, j] for i in range(scaled.shape[1]) for j in range(i, scaled.shape[1])]
        functions += [scaled[:, i] ** 3 for i in range(scaled.shape[1])]
    # What is constant belongs to no covariate: not even the constant part of a square.
    functions = [f - f.mean() for f in functions]
    patterns = (tip_axes(observed), observed.drive_moved(joint)[:, :, None])
    return np.concatenate([interactions(functions, pattern) for pattern in patterns], axis=2)


def direction(observed: Observed, moved: Array) -> str | None:
    """The direction in which most of a displacement (N, D) lies, about the base: radial, tangential or vertical;
    None where not all directions were measured."""
    total = float(np.sum(moved**2))
    if total <= 0.0 or observed.view is not None:
        return None
    tip = tip_of(observed)
    flat = observed.components == 2
    outward = tip[:, :2] if flat else _level(tip, observed)
    outward = outward / np.maximum(np.linalg.norm(outward, axis=1, keepdims=True), 1e-9)
    shares = {"radial": float(np.sum(np.sum(moved * outward, axis=1) ** 2)) / total}
    if flat:
        shares["tangential"] = 1.0 - shares["radial"]
    else:
        up = _up(observed)
        shares["vertical"] = float(np.sum((moved @ up) ** 2)) / total
        shares["tangential"] = max(0.0, 1.0 - shares["radial"] - shares["vertical"])
    best = max(shares, key=lambda name: shares[name])
    return best if shares[best] > observed.rules.answer.one_direction else "mixed"


def _up(observed: Observed) -> Array:
    gravity = np.array(observed.arm.gravity, dtype=float)
    size = np.linalg.norm(gravity)
    return -gravity / size if size > 0.0 else np.array([0.0, 0.0, 1.0])


def _level(tip: Array, observed: Observed) -> Array:
    up = _up(observed)
    return tip - (tip @ up)[:, None] * up
