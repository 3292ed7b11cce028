"""What the drives' torques, read beside the tip, will tell: how many times as much as in the model links and payload
weigh on each, and its friction; by the same least squares as a diagnosis of them (`diagnose.residual.torque`)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.observe import undeformed
from linkwright.core.diagnose.residual.torque import DriveDesign, drive_designs
from linkwright.core.sections.numeric import Array

from .plan_request import Asked


@dataclass(frozen=True)
class TorquePromise:
    """What the torque of a drive (joint from 1) will tell, each with its standard error: how many times as much as in
    the model `links` and `payload` weigh on it (shares), the `friction` (N*m, of slides N); None: nothing. `together`
    says that the payload is in `links`: it cannot be told by itself."""

    joint: int
    links: float | None
    payload: float | None
    friction: float | None
    together: bool


def promised_by_torques(arm: Arm, recording: Recording, asked: Asked) -> tuple[TorquePromise, ...]:
    """What the torques of a planned recording will tell of each drive; none where none are read."""
    if not asked.torque_noise:
        return ()
    visit = (recording.row - 1) // asked.repeats
    torques: list[TorquePromise] = []
    for joint, design in enumerate(_designs(arm, recording, visit, asked)):
        scatter = asked.torque_noise[joint] / math.sqrt(asked.repeats)
        if not _tells(design, scatter, asked):
            continue
        errors = design.errors(scatter, asked.rules.residual)
        links, payload, friction = (errors.get(name) for name in ("links", "payload", "side"))
        torques.append(TorquePromise(joint + 1, links, payload, friction, design.together))
    return tuple(torques)


def torque_rows(arm: Arm, tried: Recording, asked: Asked) -> tuple[Array, Array]:
    """What the torques of each visit tried show, over their scatter: of what is fitted along (V, n, b), payload and
    friction too, and of the links' factors (V, n, a), for which visits are chosen: what tells links from payload and
    friction tells these from links."""
    visit = np.arange(tried.size)
    beside: list[Array] = []
    wanted: list[Array] = []

    def of_drive(joint: int, columns: Array) -> Array:
        rows = np.zeros((tried.size, arm.size, columns.shape[1]))
        rows[:, joint] = columns / asked.torque_noise[joint]
        return rows

    for joint, design in enumerate(_designs(arm, tried, visit, asked)):
        if not _tells(design, asked.torque_noise[joint], asked):
            continue
        moments, share = _without_repetition(design, asked)
        if share is None:
            continue
        # The sum that is asked becomes a separate coefficient: its column, and what stands across it beside.
        wanted.append(of_drive(joint, (moments @ share / float(share @ share))[:, None]))
        across = np.linalg.svd(share[None])[2][1:].T
        beside.append(
            of_drive(joint, np.column_stack([np.ones(tried.size), *design.of_drive.values(), moments @ across]))
        )
    empty = np.zeros((tried.size, arm.size, 0))
    return np.concatenate([empty, *beside], axis=2), np.concatenate([empty, *wanted], axis=2)


def _without_repetition(design: DriveDesign, request: Asked) -> tuple[Array, Array | None]:
    """The first moments as columns (V, r) of which none says what others do, and by what of their coefficients (r,) one
    has how many times as much as in the model the links weigh."""
    moved = design.each - design.each.mean(axis=0)
    left, size, axes = np.linalg.svd(moved, full_matrices=False)
    independent = size > 1e-6 * max(float(size.max(initial=0.0)), 1e-300)
    share = design.share(request.rules.residual)
    return left[:, independent] * size[independent], None if share is None else axes[independent] @ share


def _designs(arm: Arm, recording: Recording, visit: NDArray[np.int64], request: Asked) -> Sequence[DriveDesign]:
    """What each drive's torque is fitted by at visits (N,)."""
    state = undeformed(arm, recording, request.rules.residual)
    return drive_designs(arm, recording, state, visit, request.rules.residual)


def _tells(design: DriveDesign, scatter: float, request: Asked) -> bool:
    """Whether a diagnosis makes anything of a drive's torque: the load spreads beside what it scatters by, and there
    are more visits than what is fitted."""
    rules, columns = request.rules.residual, design.columns
    freedom = len(columns) - int(np.linalg.matrix_rank(columns, rtol=1e-6))
    return design.spread > rules.torque_least * math.hypot(design.spread, scatter) and freedom >= rules.enough_freedom
