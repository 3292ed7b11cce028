"""Forces at the tip that no entry of the library describes, through the arm's flexibility: steady, wandering with
time, springs, pulls towards a point, fields over the workspace."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType

import numpy as np
from scipy.optimize import minimize

from linkwright.core.arm.effects.elastic.cantilever import elastic_twists, under_other_loads
from linkwright.core.arm.errors.recorded import turned_levels
from linkwright.core.arm.errors.tip import carried_to_tip, rotation_at_tip
from linkwright.core.diagnose.residual.observed import Observed
from linkwright.core.diagnose.residual.visits import blocks_of
from linkwright.core.diagnose.search.subsets import products
from linkwright.core.sections.numeric import Array

from .basis import interactions, run_of, scaled_position, tip_of
from .form import CONSTANT_FORCE, FORCE_FIELD, FORCE_IN_TIME, PULL, SPRING
from .library import Candidate
from .pool import Pool

_GRID: Mapping[int, int] = MappingProxyType({2: 6, 3: 4})
"""Points along an axis from which pulls begin, by the number of axes."""
_CORES = (0.02, 3.0)
"""The narrowest and the widest core (m) of a pull that is moved off that grid."""
_STARTS, _STEPS = 2, 150
"""Points of the grid from which a pull is moved to where it fits best, and steps of that."""


def _give(observed: Observed) -> Array:
    """What one newton at the tip along each axis moves in every column, (N, C, D): the arm's compliance at each
    reading, by which any other force moves it in proportion."""
    zero, one = np.zeros(observed.rows), np.ones(observed.rows)
    columns = np.zeros((*observed.residual.shape, observed.space))
    for axis in range(observed.space):
        force = [zero, zero, zero]
        force[axis] = one
        loaded = under_other_loads(observed.state, tip_force=(force[0], force[1], force[2]), weightless=True)
        twists = tuple(elastic_twists(loaded))
        moved = carried_to_tip(loaded, twists)
        levels = observed.asked.levels
        turned = None if levels is None else turned_levels(loaded, twists, levels)
        if observed.asked.turn:
            turn = np.stack([part + zero for part in rotation_at_tip(loaded, twists)], axis=1)
            turned = turn if observed.reads_turns else turned
            if observed.has_turns:
                columns[:, observed.turn_columns, axis] = observed.turns(turn)
        seen = observed.of_tip(np.stack([part + zero for part in moved], axis=1), turned)
        columns[:, : observed.components, axis] = seen
    return columns


def forces(observed: Observed) -> Iterator[tuple[Candidate, Array]]:
    """The forms that are forces, with their columns (N, C, d) for one newton each (a spring: for one N/m)."""
    width, rules = observed.space, observed.rules.patterns
    tip = tip_of(observed)[:, :width]
    steady = _give(observed)
    if not steady.any():
        return
    yield CONSTANT_FORCE.of(), steady
    for waves in _wanderings(observed):
        yield FORCE_IN_TIME.of(shapes={"half_waves": len(waves) - 1.0}), interactions(waves, steady)
    yield SPRING.of(), np.concatenate([steady, -_moved_by(steady, tip)], axis=2)
    for point, power in itertools.product(_points_around(tip), PULL.shapes["power"]):
        shapes = {**_named(point), "core": PULL.shapes["core"][0], "power": power}
        yield PULL.of(shapes=shapes), _moved_by(steady, pull(tip, shapes))
    place = scaled_position(observed)
    field = interactions(place.T, steady)
    yield FORCE_FIELD.of(shapes={"order": 1.0}), np.concatenate([steady, field], axis=2)
    if width == 2 and observed.rows > rules.rows_for_curves:
        squares = np.stack([place[:, i] * place[:, j] for i in range(2) for j in range(i, 2)])
        curved = np.concatenate([steady, field, interactions(squares, steady)], axis=2)
        yield FORCE_FIELD.of(shapes={"order": 2.0}), curved


def weight_at_tip(observed: Observed) -> Array:
    """What a kilogram more at the tip moves in every column, (N, C, 1), through what bends."""
    weight = np.array(observed.arm.gravity[: observed.space])
    return _moved_by(_give(observed), np.broadcast_to(weight, (observed.rows, observed.space)))


def _moved_by(give: Array, force: Array) -> Array:
    """What a force (N, D), N, moves in every column (N, C, 1), by the arm's compliance (see `_give`)."""
    return np.einsum("nca,na->nc", give, force)[:, :, None]


def _wanderings(observed: Observed) -> Iterator[Array]:
    """Half waves over the recording, from none (a constant) up to as many as its visits can tell, (1 + K, N); none
    where no time was recorded."""
    clock = observed.recording.time
    if clock is None or np.ptp(clock) <= 0.0:
        return
    for count in map(int, FORCE_IN_TIME.shapes["half_waves"]):
        if count * observed.rules.patterns.visits_for_each <= len(blocks_of(observed.block)):
            yield np.cos(np.pi * np.arange(count + 1)[:, None] * run_of(clock))


def _named(point: Sequence[float]) -> dict[str, float]:
    return {f"at_{axis}": float(value) for axis, value in zip("xyz", point, strict=False)}


def pull(tip: Array, shapes: Mapping[str, float]) -> Array:
    """A pull towards a point on tips (N, D), N: r/(r^2 + core^2)^(power/2)."""
    away = tip - np.array([shapes[f"at_{axis}"] for axis in "xyz"[: tip.shape[1]]])
    return -away * ((np.sum(away**2, axis=1) + shapes["core"] ** 2) ** (-0.5 * shapes["power"]))[:, None]


def _points_around(tip: Array) -> list[tuple[float, ...]]:
    """A coarse grid of points in and around the recorded part of the workspace (tips (N, D)), m."""
    spans: list[list[float]] = []
    for low, high in zip(tip.min(axis=0).tolist(), tip.max(axis=0).tolist(), strict=True):
        margin = 0.15 * (high - low)
        spans.append(np.linspace(low - margin, high + margin, _GRID[tip.shape[1]]).tolist())
    return list(itertools.product(*spans))


def fitted_pull(observed: Observed, pool: Pool, vector: Array, known: Sequence[int]) -> tuple[Candidate, Array] | None:
    """The pull that explains most of what the `known` groups leave of the whitened residual (n,), moved off the grid to
    where it does; with its columns (N, C, 1), None where the arm does not bend."""
    gained = products(pool, vector).beside(pool.columns(known)).gains()
    pulls = [k for k, group in enumerate(pool.groups) if group.candidate.effect == PULL.name]
    if not pulls:
        return None
    taken = np.concatenate([pool.nuisance, np.linalg.qr(pool.basis[:, pool.columns(list(known))])[0]], axis=1)
    left = vector - taken @ (taken.T @ vector)
    names = tuple(_named([0.0] * observed.space))
    give, tip = _give(observed), tip_of(observed)[:, : observed.space]

    def shapes(at: Array) -> dict[str, float]:
        return {
            **dict(zip(names, at.tolist(), strict=False)),
            "core": math.exp(at[-1]),
            "power": PULL.shapes["power"][-1],
        }

    def missed(at: Array) -> float:
        white = observed.whitened(_moved_by(give, pull(tip, shapes(at)))[:, :, 0])
        white = white - taken @ (taken.T @ white)
        size = float(white @ white)
        return -(float(white @ left) ** 2) / size if size > 0.0 else 0.0

    span = np.ptp(tip, axis=0)
    cores = (math.log(_CORES[0]), math.log(_CORES[1]))
    bounds = [*zip(tip.min(axis=0) - span, tip.max(axis=0) + span, strict=True), cores]
    best: tuple[float, dict[str, float]] | None = None
    for number in sorted(pulls, key=lambda k: -float(gained[k]))[:_STARTS]:
        start = pool.groups[number].candidate.shapes
        at = np.array([*(start[name] for name in names), math.log(start["core"])])
        # Half a step of the grid to begin with, whatever the coordinates are.
        simplex = at + np.vstack([np.zeros(len(at)), np.diag([*(0.5 * span / _GRID[observed.space]), 0.7])])
        options = {"maxiter": _STEPS, "xatol": 1e-3, "fatol": 1e-3 * float(left @ left), "initial_simplex": simplex}
        minimum = minimize(missed, at, method="Nelder-Mead", bounds=bounds, options=options)
        if best is None or float(minimum.fun) < best[0]:
            best = float(minimum.fun), shapes(minimum.x)
    if best is None:
        return None
    return PULL.of(shapes=MappingProxyType(best[1])), _moved_by(give, pull(tip, best[1]))
