"""What the joint fit says of fixed transforms that the arm file leaves free, with intervals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.vectors import to_roll_pitch_yaw
from linkwright.core.diagnose.patterns.library import columns_of
from linkwright.core.diagnose.patterns.pool import VISIBLE, orthonormal
from linkwright.core.diagnose.residual.free_origins import TURNS, Freedom, known, moved, of_observed, turned_whole
from linkwright.core.diagnose.result import FittedOrigin, FittedParameter
from linkwright.core.sections.numeric import Array

from .fit import solved, t_quantile
from .prepare import Prepared
from .refit import Refit
from .room.unnamed import Unnamed

_TOLD = 1e-9
"""Directions whose columns are less than this of the largest are not told at all."""
NEAR = 1e-6


def identified_origins(
    prepared: Prepared,
    fitted: Refit,
    outside: Sequence[int],
    arm: Arm,
    unnamed: Unnamed | None,
    search: Prepared,
) -> tuple[Arm, tuple[FittedOrigin, ...]]:
    """An arm with its fixed transforms where the joint fit puts them, known from now on, and what is said of each.

    What the readings do not tell is not bounded, and stays as near as it can to where it was found at first; `search`
    knows what of the library was looked for."""
    observed = prepared.observed
    ways = of_observed(observed)
    if not ways:
        return known(arm), ()
    every = beside_names(prepared, fitted, outside, unnamed)
    # The transforms stand last among the nuisances.
    columns = slice(len(every.sizes) - len(ways), len(every.sizes))
    covariance, determined = every.covariance[columns, columns], every.determined[columns]
    placed = moved(arm, ways, every.sizes[columns])
    origins = tuple(
        _fitted_origin(placed, index, ways, covariance, determined, every.errors)
        for index in sorted({way.joint for way in ways})
    )
    return known(placed), tuple(
        replace(origin, swallowed=_swallowed(search, ways, origin.joint - 1)) for origin in origins
    )


@dataclass(frozen=True)
class Beside:
    """The `sizes` of nuisances (b,), the `covariance` of these (b, b), which of them the readings tell (b,), and half
    a 95 % interval in standard errors."""

    sizes: Array
    covariance: Array
    determined: NDArray[np.bool_]
    errors: float


def beside_names(prepared: Prepared, fitted: Refit, outside: Sequence[int], unnamed: Unnamed | None) -> Beside:
    """What the joint fit says of the nuisances, with room for what is not named where that is given."""
    observed = prepared.observed
    parts = [prepared.beside, *(t.columns if t.through is None else t.columns + t.through for t in fitted.terms)]
    parts += [prepared.columns[m] for m in outside]
    columns = slice(0, prepared.beside.shape[2])
    design = observed.whitened(np.concatenate(parts, axis=2))
    target = observed.residual - sum((term.moved for term in fitted.terms), np.zeros(1))
    white = observed.whitened(target)
    by = solved(design, white)
    size = np.linalg.norm(design, axis=0)
    size = np.where(size > 0.0, size, 1.0)
    u, singular, vt = np.linalg.svd(design / size, full_matrices=False)
    good = singular > _TOLD * singular[0]
    determined = (np.diag(vt[good].T @ vt[good]) > 1.0 - NEAR)[columns]
    inverse = (vt[good].T / singular[good] ** 2) @ vt[good] / size / size[:, None]
    left = white - design @ by
    # The arm file as it is comes without a fit.
    known = bool(fitted.freedom)
    rss, freedom = (fitted.rss, fitted.freedom) if known else (left @ left, len(left) - int(good.sum()))
    covariance = inverse * (rss / max(freedom, 1))
    if unnamed is not None:
        operator = (vt[good].T / singular[good]) @ u[:, good].T / size[:, None]
        covariance = inverse * unnamed.variance + unnamed.beside(operator)
    return Beside(by[columns], covariance[columns, columns], determined, t_quantile(max(freedom, 1)))


def _fitted_origin(
    arm: Arm, index: int, ways: Sequence[Freedom], covariance: Array, determined: NDArray[np.bool_], factor: float
) -> FittedOrigin:
    joint = arm.joints[index]
    roll, pitch, yaw = to_roll_pitch_yaw(joint.origin_rotation)
    values = dict(zip(("x", "y", "z", *TURNS), (*joint.origin_translation, roll, pitch, yaw), strict=True))
    indices = [k for k, way in enumerate(ways) if way.joint == index]
    slopes = angles_by_turns(pitch, yaw) if turned_whole(joint) else np.eye(3)
    parameters: list[FittedParameter] = []
    turned = [k for k in indices if ways[k].turns]
    for k in indices:
        way = ways[k]
        if way.turns and turned_whole(joint):
            slope = slopes[TURNS.index(way.part), [TURNS.index(ways[other].part) for other in turned]]
            sure = all(determined[other] or abs(s) < NEAR for other, s in zip(turned, slope.tolist(), strict=True))
            error = float(np.sqrt(max(slope @ covariance[np.ix_(turned, turned)] @ slope, 0.0)))
        else:
            sure, error = bool(determined[k]), float(np.sqrt(max(covariance[k, k], 0.0)))
        reach = factor * error if sure else np.inf
        value = values[way.part]
        parameters.append(
            FittedParameter(
                f"{way.part}_{index + 1}",
                way.part,
                (index + 1,),
                "angle" if way.turns else "length",
                value,
                (value - reach, value + reach),
            )
        )
    return FittedOrigin(index + 1, joint.origin_translation, (roll, pitch, yaw), tuple(parameters))


def angles_by_turns(pitch: float, yaw: float) -> Array:
    """How fixed-axis roll, pitch and yaw grow with small turns about the axes of the frame before (3, 3)."""
    z = np.array([0.0, 0.0, 1.0])
    y = Rotation.from_euler("z", yaw).apply([0.0, 1.0, 0.0])
    x = Rotation.from_euler("yz", [pitch, yaw]).apply([1.0, 0.0, 0.0])
    return np.linalg.pinv(np.column_stack([x, y, z]))


def _swallowed(prepared: Prepared, ways: Sequence[Freedom], index: int) -> tuple[tuple[str, tuple[int, ...]], ...]:
    """What of the library cannot be distinguished from one transform: it shows beside the other nuisances, and not
    beside this one."""
    observed, pool = prepared.observed, prepared.pool
    shown = {group.candidate.family for group in pool.groups}
    first = prepared.beside.shape[2] - len(ways)
    others = [k for k in range(prepared.beside.shape[2]) if k < first or ways[k - first].joint != index]
    beside = orthonormal(observed.whitened(prepared.beside[:, :, others]))
    swallowed: dict[tuple[str, tuple[int, ...]], None] = {}
    for candidate in pool.invisible:
        columns = None if candidate.outside or candidate.family in shown else columns_of(observed, candidate)
        if columns is None:
            continue
        white = observed.whitened(columns)
        left = white - beside @ (beside.T @ white)
        if np.linalg.norm(left) > VISIBLE * np.linalg.norm(white):
            swallowed[candidate.effect, candidate.numbers] = None
    return tuple(swallowed)
