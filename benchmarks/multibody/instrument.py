"""What a tracker makes of true tips: its own frame at every mounting, noise, a wander; columns under wrong names."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from benchmarks.blind.generator.measurement import Tracker, noise
from benchmarks.blind.generator.vectors import Array


@dataclass(frozen=True)
class Mount:
    """Where the tracker stands: a point p of the base frame is read as turn @ p + shift."""

    turn: Array  # (3, 3)
    shift: Array  # (3,) m


def draw_mount(planar: bool, rng: np.random.Generator) -> Mount:
    """A tracker's own frame, turned by up to 0.6 rad and off by up to half a metre; in the plane within it."""
    vector = rng.uniform(-0.35, 0.35, 3) * (np.array([0.0, 0.0, 1.0]) if planar else 1.0)
    shift = rng.uniform(-0.5, 0.5, 3) * (np.array([1.0, 1.0, 0.0]) if planar else 1.0)
    angle = float(np.linalg.norm(vector))
    x, y, z = vector / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turn = np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * cross @ cross
    return Mount(turn, shift)


STILL = Mount(np.eye(3), np.zeros(3))


def errors(
    tracker: Tracker, planar: bool, visits: int, repeats: int, rng: np.random.Generator
) -> tuple[Array, NDArray[np.bool_]]:
    """Errors (3, rows) in m, a wander going on from row to row, and which rows are sound: no outliers."""
    rows = visits * repeats
    made, gross = noise(tracker, 2 if planar else 3, rows, rng)
    sound = np.ones(rows, dtype=bool)
    sound[gross] = False
    return (np.vstack([made, np.zeros((1, rows))]) if planar else made), sound


def oracle_rms(true: Array, measured: Array, mounts: Array, *, frame_free: bool, tool_turns: Array | None) -> float:
    """RMS length (m) that is left where every cause is known: of each mounting the frame is fitted if it is free, and
    where the target sits if `tool_turns` (3, 3, rows), the tool's axes, are given. Measured in the base's frame, small
    turns. (3, rows)."""
    left = measured - true
    if not frame_free:
        return math.sqrt(float(np.sum(left**2)) / left.shape[1])
    columns = []
    zero = np.zeros(left.shape[1])
    for number in range(int(mounts.max()) + 1):
        there = (mounts == number).astype(float)
        columns += [np.outer(axis, there) for axis in np.eye(3)]
        turned = (
            np.stack([zero, -true[2], true[1]]),
            np.stack([true[2], zero, -true[0]]),
            np.stack([-true[1], true[0], zero]),
        )
        columns += [t * there for t in turned]
    if tool_turns is not None:
        columns += [tool_turns[:, k] for k in range(3)]
    matrix = np.stack([column.ravel() for column in columns], axis=1)
    rest = left.ravel() - matrix @ np.linalg.lstsq(matrix, left.ravel(), rcond=1e-9)[0]
    return math.sqrt(float(rest @ rest) / left.shape[1])


# Columns under wrong names. Each is nothing that an arm does: a name for a cause is wrong.


def _flipped(table: pd.DataFrame, joint: int) -> pd.DataFrame:
    return table.assign(**{f"q{joint}_deg": -table[f"q{joint}_deg"]})


def _other_zero(table: pd.DataFrame, joint: int) -> pd.DataFrame:
    return table.assign(**{f"q{joint}_deg": table[f"q{joint}_deg"] - 90.0})


def _swapped(table: pd.DataFrame, joint: int) -> pd.DataFrame:
    one, two = f"q{max(joint - 1, 1)}_deg", f"q{max(joint - 1, 1) + 1}_deg"
    return table.rename(columns={one: two, two: one})


def _radians(table: pd.DataFrame, joint: int) -> pd.DataFrame:
    angles = [name for name in table.columns if name.startswith("q")]
    return table.assign(**{name: np.round(np.radians(table[name]), 6) for name in angles})


def _rows_behind(table: pd.DataFrame, joint: int) -> pd.DataFrame:
    angles = [name for name in table.columns if name.startswith("q")]
    return table.assign(**{name: np.roll(table[name].to_numpy(), 1) for name in angles})


def _axes_swapped(table: pd.DataFrame, joint: int) -> pd.DataFrame:
    return table.rename(columns={"x_mm": "y_mm", "y_mm": "x_mm"})


def _sides_swapped(table: pd.DataFrame, joint: int) -> pd.DataFrame:
    one = max(joint - 1, 1)
    return table.rename(columns={f"dir{one}": f"dir{one + 1}", f"dir{one + 1}": f"dir{one}"})


def _grams(table: pd.DataFrame, joint: int) -> pd.DataFrame:
    return table.assign(payload_kg=table["payload_kg"] * 1000.0)


MISLABELLED: Mapping[str, Callable[[pd.DataFrame, int], pd.DataFrame]] = MappingProxyType(
    {
        "a joint counts the other way": _flipped,
        "a joint counts from another zero": _other_zero,
        "two joints' columns changed places": _swapped,
        "radians under degrees": _radians,
        "angles of the row before": _rows_behind,
        "x and y changed places": _axes_swapped,
        "two joints' sides changed places": _sides_swapped,
        "grams under kilograms": _grams,
    }
)
