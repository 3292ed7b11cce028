"""The figures of each log of several."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from linkwright.core.sections.numeric import Array

from .judged import Judged
from .model.identify import Identified
from .result import OfLog


def of_log(identified: Identified, judge: Judged, given: Array, number: int) -> OfLog:
    """The figures of a log (its number), of which the arm as given leaves the squares `given` (B, n)."""
    log, entries = identified.rows[number].prepared.log, identified.rows[number].prepared.entries
    here = identified.products.log == number
    rows = max(int(judge.counts[here].sum()), 1)

    def size(left: Array) -> float:
        return float(np.sqrt(left[here].sum() / rows))

    return OfLog(
        Path(log.file).name,
        log.file,
        log.unit,
        log.date,
        log.size,
        size(given),
        size(judge.written.left),
        size(judge.written.held_out),
        tuple(item.row for item in log.rejected),
        entries,
        size(judge.written.beside[0]) if entries else None,
    )
