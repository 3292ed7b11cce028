"""What a kind of instrument is shown of a recording to say what cannot be right in it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from linkwright.core.sections.numeric import Array

if TYPE_CHECKING:
    from linkwright.core.diagnose.recording import Recording
    from linkwright.core.diagnose.rules.rules import Rules

    from .kind import Marked
    from .view import View

SCALES = ((1e3, "1000 times larger"), (1e-3, "1000 times smaller"), (1e-6, "a million times smaller"))
"""What a wrong unit in a header makes of numbers."""


@dataclass(frozen=True)
class Look:
    """A recording with the undeformed arm's `tips` (N, 3), m, and last link's `axes` (N, 3, 3), in columns. `view` sets
    it, or a changed one, against these; `off` (N, W) is how far readings are from that, None before there is a view:
    with few readings there never is. `numbers` (N, W) marks those of the kind that is asked (there are some); `framed`:
    some of whatever kind are measured in a frame that may stand anywhere."""

    recording: Recording
    tips: Array
    axes: Array
    flat: bool
    view: Callable[[Recording], View]
    off: Array | None
    rules: Rules
    numbers: Marked
    framed: bool
