"""What the instruments of several recordings see, as one: each has an anchor, points and planes of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from linkwright.core.diagnose.instruments.camera import joined_sights
from linkwright.core.diagnose.instruments.view import View, Within


def view_of_several(views: Sequence[View | None], names: Sequence[str]) -> View | None:
    """The views of several recordings, in their order, as one; None where the tip's place was measured in all."""
    present = [view for view in views if view is not None]
    if len(present) < len(views) or not present:
        return None
    width = sum(view.beside.shape[2] for view in present)
    beside = np.zeros((sum(len(view.residual) for view in present), present[0].residual.shape[1], width))
    row, column = 0, 0
    for view in present:
        count, inner = len(view.residual), view.beside.shape[2]
        beside[row : row + count, :, column : column + inner] = view.beside
        row, column = row + count, column + inner
    firsts = np.cumsum([0, *(len(view.residual) for view in present)]).tolist()
    changes = [
        Within(change, first, len(beside))
        for view, first in zip(present, firsts, strict=False)
        for change in view.changes
    ]
    return replace(
        present[0],
        residual=np.concatenate([view.residual for view in present]),
        shown=np.concatenate([view.shown for view in present]),
        beside=beside,
        names=tuple(f"{inner}, {name}" for view, name in zip(present, names, strict=True) for inner in view.names),
        at=np.concatenate([view.at for view in present]),
        framed=np.concatenate([view.framed for view in present]),
        settled=np.concatenate([view.settled for view in present]),
        sight=joined_sights([view.sight for view in present]),
        turning=np.concatenate([view.turning for view in present]),
        changes=tuple(changes),
    )
