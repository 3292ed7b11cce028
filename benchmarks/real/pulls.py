"""What the rows before say and no formula can: which way a lever was pulled last."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

_MIDDLE, _HOME = 2047, "target pos (5)"


def with_pulls(path: Path, folder: Path) -> Path:
    """A copy of the servo's telemetry with `pulled`: the way (+1, -1) that its lever was last pulled since the servo
    was last sent somewhere, 0 before; and `taut` (1, 0), whether a puller's own lever is past its middle."""
    table = pd.read_csv(path)
    up, down = table["pos (4)"] < _MIDDLE, table["pos (3)"] > _MIDDLE
    way = pd.Series(np.where(up, 1.0, np.where(down, -1.0, np.nan)))
    sent = (table[_HOME] != table[_HOME].shift()).cumsum()
    table["pulled"] = way.groupby(sent).ffill().fillna(0.0).astype(int)
    table["taut"] = (up | down).astype(int)
    copy = folder / "pulled.csv"
    table.to_csv(copy, index=False)
    return copy
