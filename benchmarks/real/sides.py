"""What the order of the rows says and no formula can: from which side each joint came, which way a lever was pulled."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

_MOVED = 1e-4
"""rad: servos come back to a place within less."""
_MIDDLE, _HOME = 2047, "target pos (5)"


def with_sides(path: Path, folder: Path) -> Path:
    """A copy of a recording whose rows stand in the order of their taking, with `dir1`, `dir2`, ...: the sign of each
    joint's last move, 0 before its first."""
    table = pd.read_csv(path)
    for number in range(1, 1 + sum(f"q{k}_rad" in table for k in range(1, 10))):
        move = np.diff(table[f"q{number}_rad"].to_numpy(), prepend=table[f"q{number}_rad"].iloc[0])
        side = pd.Series(np.where(np.abs(move) > _MOVED, np.sign(move), np.nan)).ffill().fillna(0.0)
        table[f"dir{number}"] = side.astype(int)
    copy = folder / path.name
    table.to_csv(copy, index=False)
    return copy


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
