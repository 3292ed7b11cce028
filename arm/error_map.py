"""Where in its workspace an arm errs most: the worst error at each place of the tip."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwright.core.arm.chain.chain import LoadCase
from linkwright.core.arm.errors.model import ErrorModel, error_model
from linkwright.core.arm.figures.tip_stiffness import tips_of
from linkwright.core.arm.worst.search import WorstSearch
from linkwright.core.sections.numeric import Array

_MAPPED_POSES = 100_000


@dataclass(frozen=True)
class ErrorMap:
    """The worst error (m) met at each place of the tip: `worst` (rows along `vertical`, columns along `horizontal`).

    In the plane `horizontal` and `vertical` are the edges (m) of cells in x and y; in space they are the distance from
    the base's z axis, and z. NaN where no pose looked at puts the tip.
    """

    planar: bool
    horizontal: Array
    vertical: Array
    worst: Array


def error_map(search: WorstSearch, p: Array, *, poses: int | None = None, cells: int = 90) -> ErrorMap:
    """The worst error met at each place of the tip, over poses spread over the workspace."""
    model: ErrorModel = search.model
    wanted = poses or (_MAPPED_POSES if model.planar else _MAPPED_POSES // 3)
    seeds = [search.poses(p, search.scan, seed) for seed in range(1, 1 + max(1, wanted // search.scan))]
    q = np.vstack(seeds)
    errors = [search.errors(q, p, case).error for case in range(len(model.cases))]
    named = tips_of([case.load for case in model.cases])
    by_name = {name: error_model(model.arm.on(name), (LoadCase(),)).tip for name in named if name}
    if by_name:
        # Of several tips each has its places.
        tips = np.vstack([by_name[case.load.tip](q, p)[0] for case in model.cases])
        error = np.concatenate(errors)
    else:
        tips, error = search.tip(q, p), np.max(errors, axis=0)
    if model.planar:
        across, up = tips[:, 0], tips[:, 1]
    else:
        across, up = np.hypot(tips[:, 0], tips[:, 1]), tips[:, 2]
    span = max(np.ptp(across), np.ptp(up), 1e-9) / cells
    horizontal = np.arange(across.min(), across.max() + span, span)
    vertical = np.arange(up.min(), up.max() + span, span)
    worst = np.full((len(vertical), len(horizontal)), np.nan)
    column = np.clip(((across - horizontal[0]) / span).astype(int), 0, len(horizontal) - 1)
    row = np.clip(((up - vertical[0]) / span).astype(int), 0, len(vertical) - 1)
    order = np.argsort(error)
    worst[row[order], column[order]] = error[order]
    edges = (np.append(horizontal, horizontal[-1] + span), np.append(vertical, vertical[-1] + span))
    return ErrorMap(model.planar, edges[0], edges[1], worst)
