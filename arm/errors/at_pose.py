"""The tip's error at a pose that somebody asks for: displacement and rotation, and what each effect has of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from linkwright.core.arm.chain.arrays import columns
from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.chain.statics import PoseState, solve
from linkwright.core.sections.numeric import Array

from .calibrated import error_since_calibrated
from .first_order import beyond_first_order
from .lost_motion import PlayedError, played
from .model import beam_values, beams_of, error_model
from .tip import ActiveEffect, Counted, TipError, active_effects, tip_error
from .unknown_mass import unknown_taken_out

Triple = tuple[float, float, float]


@dataclass(frozen=True)
class EffectPart:
    """What an effect has of the error at a pose: `vector` (m) and `rotation` (rad) add up to the whole over all
    effects, and so does `share`, the part of the error's length that lies along it (None where there is no error)."""

    effect: str
    vector: Triple
    rotation: Triple
    share: float | None


@dataclass(frozen=True)
class PoseError:
    """The tip's error at a pose q (rad, m) under a load case (from 0), in the base frame, to first order.

    `vector` (m) and its length `error`, with the play where the arm's mode puts it; `rotation` (rad), a rotation vector
    with the play in the same places, and its size `orientation`. `beyond` is how far finite motions and loads on the
    deformed shape move the tip further (m); None where the arm finds no shape there. `outside` numbers the joints
    (from 1) that stand beyond their range.
    """

    q: tuple[float, ...]
    load_case: int
    error: float
    vector: Triple
    orientation: float
    rotation: Triple
    by_effect: tuple[EffectPart, ...]
    beyond: float | None
    outside: tuple[int, ...]


def errors_at(given: Arm, load_cases: Sequence[LoadCase], poses: Array) -> tuple[PoseError, ...]:
    """The error at each of the poses (N, n; rad, m) under each load case (the arm's own by default), pose after pose.

    Raises `PropertyNeeded`, `MissingProperty` or `OutOfRange` where the arm lacks a figure.
    """
    cases = tuple(load_cases) or given.cases
    arm = unknown_taken_out(given, cases)
    by_case = [_under(arm, cases, number, poses) for number in range(len(cases))]
    return tuple(error for errors in zip(*by_case, strict=True) for error in errors)


def _under(arm: Arm, cases: tuple[LoadCase, ...], number: int, q: Array) -> list[PoseError]:
    """The errors at poses (N, n) under one of the load cases."""
    beams, load = beams_of(arm, cases), cases[number]
    model = error_model(arm, (load,))
    case = model.cases[0]
    arrays = case.arrays(q, beam_values(beams))
    result = played(arrays, case.radii, arm.play, planar=model.planar, statistics=arm.statistics)
    state, effects = solve(arm, [q[:, joint] for joint in range(arm.size)], beams, load), active_effects(arm)
    moving = [active for active in effects if active.effect.moves_tip]
    names = dict.fromkeys(active.effect.id for active in moving)
    shifts = _by_effect(state, moving, "position", result)
    turns = _by_effect(state, moving, "orientation", result)
    rotation = np.sum(list(turns.values()), axis=0) if turns else np.zeros((len(q), 3))
    errors: list[PoseError] = []
    for row, pose in enumerate(q):
        length = float(result.error[row])
        parts = [
            EffectPart(
                name,
                _triple(shifts[name][row]),
                _triple(turns[name][row]),
                float(shifts[name][row] @ result.vector[row]) / length**2 if length > 0.0 else None,
            )
            for name in names
            if np.any(shifts[name][row]) or np.any(turns[name][row])
        ]
        errors.append(
            PoseError(
                q=tuple(pose.tolist()),
                load_case=number,
                error=length,
                vector=_triple(result.vector[row]),
                orientation=float(np.linalg.norm(rotation[row])),
                rotation=_triple(rotation[row]),
                by_effect=tuple(parts),
                beyond=beyond_first_order(arm, (load,), (pose, 0), pose[None]).at_worst,
                outside=_outside(arm, pose),
            )
        )
    return errors


def _by_effect(
    state: PoseState, effects: Sequence[ActiveEffect], counted: Counted, placed: PlayedError
) -> dict[str, Array]:
    """What each effect moves (or turns) the tip by, (N, 3), with the play in its places."""
    rows = len(placed.error)
    whole = _error(state, effects, counted)
    assert placed.signs.shape[1] == len(whole.intervals)
    parts: dict[str, Array] = {}
    for name in dict.fromkeys(active.effect.id for active in effects):
        alone = _error(state, [active for active in effects if active.effect.id == name], counted)
        parts[name] = columns(alone.vector, rows)
    for k, interval in enumerate(whole.intervals):
        parts[interval.effect] = parts[interval.effect] + placed.signs[:, [k]] * columns(interval.vector, rows)
    for k, disc in enumerate(whole.discs):
        parts[disc.effect] = parts[disc.effect] + placed.shifts[:, k]
    return parts


def _error(state: PoseState, effects: Sequence[ActiveEffect], counted: Counted) -> TipError:
    if state.load.relative_to is None:
        return tip_error(state, effects, counted)
    return error_since_calibrated(state, effects, state.arm.play, counted)


def _outside(arm: Arm, pose: Array) -> tuple[int, ...]:
    """The joints (from 1) beyond their range."""
    return tuple(
        number
        for number, (joint, value) in enumerate(zip(arm.joints, pose.tolist(), strict=True), start=1)
        if not joint.range[0] - 1e-9 <= value <= joint.range[1] + 1e-9
    )


def _triple(row: Array) -> Triple:
    x, y, z = (float(value) + 0.0 for value in row)
    return x, y, z
