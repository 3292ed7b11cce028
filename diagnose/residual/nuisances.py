"""What a recording swallows is its own: of several recordings each has a frame and a tool."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from linkwright.core.sections.numeric import Array

from .observed import Observed


def of_each(
    observed: Observed, columns: Array, names: tuple[str, ...], settings: Sequence[str]
) -> tuple[Array, tuple[str, ...]]:
    """Each recording's nuisances (N, C, b), as many columns again for each. `settings` are those (frame, tool) that
    leave the first of them free; the others always are."""
    recording = observed.recording
    parts: list[Array] = []
    names_here: list[str] = []
    for index, (label, item) in enumerate(zip(recording.names, recording.singles, strict=True)):
        left = {"frame": item.frame, "tool": item.tool}
        free = [k for k in range(len(names)) if k >= len(settings) or left[settings[k]] == "free"]
        inside = recording.which == index
        if inside.any():
            parts.append(np.where(inside[:, None, None], columns[:, :, free], 0.0))
            names_here += [f"{names[k]}, {label}" if label else names[k] for k in free]
    return np.concatenate(parts, axis=2), tuple(names_here)
