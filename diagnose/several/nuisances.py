"""What a recording swallows is its own: of several recordings each has a frame and a tool."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from linkwright.core.diagnose.residual.observed import Observed
from linkwright.core.diagnose.several.recordings import Several
from linkwright.core.sections.numeric import Array


def of_each(
    observed: Observed, columns: Array, names: tuple[str, ...], settings: Sequence[str]
) -> tuple[Array, tuple[str, ...]]:
    """Nuisances (N, C, b) of one recording as they are; of several, each recording's own: as many columns again for
    each. `settings` are those (frame, tool) that leave the first of them free; the others always are."""
    recording = observed.recording
    if not isinstance(recording, Several):
        return columns, names
    parts: list[Array] = []
    names_here: list[str] = []
    for index, (label, item) in enumerate(zip(recording.names, recording.each, strict=True)):
        left = {"frame": item.frame, "tool": item.tool}
        free = [k for k in range(len(names)) if k >= len(settings) or left[settings[k]] == "free"]
        inside = recording.which == index
        if inside.any():
            parts.append(np.where(inside[:, None, None], columns[:, :, free], 0.0))
            names_here += [f"{names[k]}, {label}" for k in free]
    return np.concatenate(parts, axis=2), tuple(names_here)
