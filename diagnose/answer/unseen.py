"""What an instrument that sees a part of the tip's place cannot show, whatever the arm does."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from linkwright.core.arm.chain.arrays import motion_directions
from linkwright.core.diagnose.fitting.fit import beyond_nuisances
from linkwright.core.diagnose.fitting.prepare import Prepared
from linkwright.core.diagnose.instruments.placement import UNDETERMINED
from linkwright.core.diagnose.instruments.view import rigid_motions
from linkwright.core.diagnose.residual.observed import rms_length
from linkwright.core.sections.numeric import Array
from linkwright.core.units.lists import listed


def unseen(prepared: Prepared) -> tuple[str, ...]:
    """Sentences on what was not measured: joints whose motion does not show, and ways to move the arm as a whole that
    do not show or are taken up by what the recording leaves free. None where the whole place was measured."""
    observed = prepared.observed
    if observed.view is None:
        return ()
    sentences = list[str]()
    if observed.asked.levels is not None:
        sentences.append("A tilt counts as what the level rises by in a metre: 1 mm is 1 mrad.")
    directions = motion_directions(observed.arm, observed.recording.q)
    # A level sees turns: those of a joint are of the size of its motion.
    size = [1.0 if observed.asked.levels is not None else rms_length(item) for item in np.moveaxis(directions, 1, 0)]
    blind = [
        str(index + 1)
        for index in range(observed.arm.size)
        if rms_length(observed.drive_moved(index)[:, : observed.components]) <= UNDETERMINED * size[index]
    ]
    if blind:
        joints = f"joint{'s' if len(blind) > 1 else ''} {listed(blind)}"
        sentences.append(f"The instrument does not see {joints} move: nothing that goes wrong there shows.")
    return (*sentences, *_of_the_whole(prepared, observed.view.at, flat=observed.space == 2))


def _of_the_whole(prepared: Prepared, at: Array, *, flat: bool) -> Iterator[str]:
    """Which motions of the arm as a whole do not show, of tips `at` (N, 3), m."""
    reach, least = max(rms_length(at), 1e-9), UNDETERMINED * np.sqrt(len(at))
    motions = rigid_motions(at) / np.array([1.0, 1.0, 1.0, reach, reach, reach])
    ways = (0, 1, 5) if flat else tuple(range(6))
    turns = np.zeros((len(at), 3, 6))
    turns[:, :, 3:] = np.eye(3)
    shown = np.stack([_left(prepared, motions[:, :, way], turns[:, :, way] / reach) for way in ways], axis=1)
    lost = len(ways) - int(np.sum(np.linalg.svd(shown, compute_uv=False) > least))
    if not lost:
        return
    single = [way for k, way in enumerate(ways) if np.linalg.norm(shown[:, k]) <= least]
    kinds = (("shifted along", [w for w in single if w < 3]), ("turned about", [w for w in single if w >= 3]))
    which = " or ".join(
        f"{what} {listed(['xyz'[w % 3] for w in some], 'or')}" for what, some in kinds if some and lost >= len(single)
    )
    if which:
        which = f": whether it is {which}" if lost == len(single) else f" (whether it is {which}, for one)"
    yield f"It does not show {lost} of the {len(ways)} ways in which the arm as a whole may stand otherwise{which}."


def _left(prepared: Prepared, moved: Array, turned: Array) -> Array:
    """What shows of displacements of the tip and turns of the arm (N, 3) beyond what the nuisances take up, as one
    column."""
    observed = prepared.observed
    columns = np.zeros(observed.residual.shape)
    columns[:, : observed.components] = observed.of_tip(moved, turned)
    if observed.sight is not None and observed.has_turns:
        columns[:, observed.turn_columns] = observed.turns(turned)
    return beyond_nuisances(prepared, columns).reshape(-1)
