"""LeRobot's parquet files: names of the numbers in `observation.state` and `action`, episodes on one clock.

Layout: github.com/huggingface/lerobot, docs of LeRobotDataset (v2, v3): data/chunk-000/*.parquet beside meta/info.json.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import cast

import numpy as np

from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import load_json

_EPISODE, _CLOCK = "episode_index", "timestamp"
_PAUSE = 10.0
"""Seconds between two episodes on the common clock: nobody knows how long it was, and no filter may reach across."""


def feature_names(path: Path) -> dict[str, tuple[str, ...]]:
    """Names of the numbers in each feature of a data set, by feature, from its meta/info.json; none where there is no
    such file."""
    about = path.parent.parent.parent / "meta" / "info.json"
    if not os.path.isfile(about):
        return {}
    content = load_json(about)
    features = cast(dict[str, object], content).get("features") if isinstance(content, dict) else None
    names_of: dict[str, tuple[str, ...]] = {}
    for feature, body in (cast(dict[str, object], features) if isinstance(features, dict) else {}).items():
        names = cast(dict[str, object], body).get("names") if isinstance(body, dict) else None
        if isinstance(names, dict):  # {"motors": [...]}, as of version 2
            names = next(iter(cast(dict[str, object], names).values()), None)
        if isinstance(names, list):
            names_of[feature] = tuple(str(name) for name in cast(list[object], names))
    return names_of


def expanded(
    name: str, cells: list[object], names: Mapping[str, tuple[str, ...]], path: str
) -> dict[str, Array] | None:
    """A column of lists as one column for each place, `observation.state/shoulder_pan` or `observation.state[0]`; None
    where the cells are no lists of numbers. Raises `InputError` where they are not of one length."""
    lists = [cell for cell in cells if isinstance(cell, list | tuple | np.ndarray)]
    if not lists or len(lists) < len(cells):
        return {}
    try:
        numbers = np.array(lists, dtype=float)
    except (TypeError, ValueError):
        numbers = np.zeros(0)
    if numbers.ndim != 2:
        raise InputError(path, name, "holds lists that are not all of one length, or not of numbers")
    width = int(np.size(numbers, 1))
    parts = names.get(name, ())
    called = [f"{name}/{part}" for part in parts] if len(parts) == width else [f"{name}[{k}]" for k in range(width)]
    return {item: numbers[:, k] for k, item in enumerate(called)}


def on_one_clock(columns: dict[str, tuple[str, ...] | Array]) -> list[str]:
    """Put the episodes of a data set, whose clocks start at 0 each, one after another; sentences that say so."""
    episode, clock = columns.get(_EPISODE), columns.get(_CLOCK)
    if not isinstance(episode, np.ndarray) or not isinstance(clock, np.ndarray) or not np.isfinite(clock).all():
        return []
    starts = np.flatnonzero(np.diff(episode) != 0.0) + 1
    if not len(starts):
        return []
    shift = np.zeros(len(clock))
    for start in starts.tolist():
        shift[start:] += clock[start - 1] - clock[start] + _PAUSE
    columns[_CLOCK] = clock + shift
    sentence = f"{len(starts) + 1} episodes stand one after another, {_PAUSE:g} s apart"
    return [f"{sentence}. `rows: episode_index == 0` takes one."]
