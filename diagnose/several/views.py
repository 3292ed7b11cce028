"""What the instruments of several recordings see, as one: each has an anchor, points and planes of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from linkwright.core.diagnose.instruments.camera import joined_sights
from linkwright.core.diagnose.instruments.view import View


def view_of_several(views: Sequence[View | None], names: Sequence[str]) -> View | None:
    """The views of several recordings, in their order, as one; None where the tip's place was measured in all."""
    present = [view for view in views if view is not None]
    if len(present) < len(views) or not present:
        return None
    width = sum(view.beside.shape[2] for view in present)
    beside = np.zeros((sum(len(view.residual) for view in present), present[0].residual.shape[1], width))
    row, column = 0, 0
    for view in present:
        count, own = len(view.residual), view.beside.shape[2]
        beside[row : row + count, :, column : column + own] = view.beside
        row, column = row + count, column + own
    anchors = [np.zeros(3) if view.anchor is None else view.anchor for view in present]
    each = np.concatenate(
        [np.broadcast_to(a.reshape(-1, 3), view.at.shape) for a, view in zip(anchors, present, strict=True)]
    )
    return replace(
        present[0],
        residual=np.concatenate([view.residual for view in present]),
        shown=np.concatenate([view.shown for view in present]),
        beside=beside,
        names=tuple(f"{own}, {name}" for view, name in zip(present, names, strict=True) for own in view.names),
        anchor=None if all(view.anchor is None for view in present) else each,
        at=np.concatenate([view.at for view in present]),
        distances=np.concatenate([view.distances for view in present]),
        framed=np.concatenate([view.framed for view in present]),
        settled=np.concatenate([view.settled for view in present]),
        sight=joined_sights([view.sight for view in present]),
        rises=np.concatenate([view.rises for view in present]),
        up=next((view.up for view in present if view.up.any()), present[0].up),
    )
