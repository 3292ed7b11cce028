"""A kind that the generators lack: cells of seven neighbouring poses, links of unknown weight, frame and tool free.

Kinematics are the textbook's, so nothing of what is judged takes part.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import pandas as pd
import yaml

from benchmarks.real.textbook.chain import Array, Chain, from_arm_file, transform, turned
from benchmarks.real.textbook.tips import Calibration, Setup, places

AXES = ((0, 0, 1), (0, 1, 0), (0, -1, 0), (-1, 0, 0), (0, -1, 0), (-1, 0, 0))
OFFSETS = ((0, 0, 0), (160, 0, 0), (0, 0, 690), (0, 0, 190), (700, 0, 0), (0, 0, 0), (110, 0, 0))
RANGES = ((-170, 170), (-90, 150), (-85, 150), (-190, 190), (-130, 130), (-360, 360))
MASSES = (60.0, 40.0, 30.0, 12.0, 6.0, 4.0)
"""kg, that no file tells."""
CELLS, IN_A_CELL, STEP = 24, 7, np.deg2rad(1.0)
NOISE = 40e-6


@dataclass(frozen=True)
class Cell:
    """What is wrong: `drives` rad/(N*m) by joint, `base` rad/(N*m), `zeros` rad by joint, `shift` (joint, m) of an
    axis along the base's x at zero, `lens` m of a measuring space that is bent."""

    drives: Mapping[int, float]
    base: float = 0.0
    zeros: Mapping[int, float] = field(default_factory=dict[int, float])
    shift: tuple[int, float] = (0, 0.0)
    lens: float = 0.0


KINDS: Mapping[str, Cell] = MappingProxyType(
    {
        "cells-null": Cell({}),
        "cells-drive-2": Cell({2: 1 / 410e3}),
        "cells-drives-and-zero": Cell({2: 1 / 410e3, 3: 1 / 190e3}, zeros={5: 8e-4}),
        "cells-base-and-drive": Cell({3: 1 / 150e3}, base=1 / 700e3),
        "cells-lens": Cell({2: 1 / 410e3}, lens=0.6e-3),
    }
)


def arm_text() -> str:
    """The arm file."""
    chain = [
        {"joint": {"type": "revolute", "range": [f"{a} deg", f"{b} deg"]}, "link": {"rigid": True, "mass": "unknown"}}
        for a, b in RANGES
    ]
    form = {"axes": [list(axis) for axis in AXES], "offsets": [[f"{x} mm" for x in row] for row in OFFSETS]}
    said = {"name": "six axes, links of unknown weight", "gravity": ["0 m/s^2", "0 m/s^2", "-9.81 m/s^2"]}
    return yaml.safe_dump({**said, "chain": chain, "product_of_exponentials": form}, sort_keys=False)


def recording(kind: str, seed: int, folder: Path) -> pd.DataFrame:
    """Rows of a kind by a seed; `folder` is for the arm file."""
    wrong, rng = KINDS[kind], np.random.default_rng(seed)
    path = folder / "arm.yaml"
    path.write_text(arm_text(), encoding="utf-8")
    chain = from_arm_file(path)
    low, high = np.deg2rad([-60, -30, -30, -90, -70, -120]), np.deg2rad([60, 60, 50, 90, 70, 120])
    centres = rng.uniform(low, high, (CELLS, 6))
    steps = np.zeros((IN_A_CELL, 6))
    for k in range(3):
        steps[1 + 2 * k, k], steps[2 + 2 * k, k] = STEP, -STEP
    q = (centres[:, None] + steps[None]).reshape(-1, 6)
    tip = _true_tip(chain, wrong, q)
    if wrong.lens:
        away = (tip - tip.mean(axis=0)) / 0.6
        tip = tip + wrong.lens * np.column_stack([away[:, 1] ** 2, away[:, 0] * away[:, 2], away[:, 1] ** 3])
    frame = transform(turned(np.array([0.02, -0.03, 1.1])), (0.4, -0.2, 0.6))
    tip = tip @ frame[:3, :3].T + frame[:3, 3] + NOISE * rng.standard_normal(tip.shape)
    columns = {f"q{k}_deg": np.round(np.rad2deg(values), 5) for k, values in enumerate(q.T, start=1)}
    columns |= {f"{axis}_mm": np.round(1e3 * values, 4) for axis, values in zip("xyz", tip.T, strict=True)}
    return pd.DataFrame(columns)


def _true_tip(chain: Chain, wrong: Cell, q: Array) -> Array:
    """Where the tip is, in the base's directions: drives and base give under the weights, in two rounds."""
    stations = np.stack([np.eye(4)] * chain.size)
    joint, by = wrong.shift
    if joint:
        stations[joint - 1, 0, 3] = by
    weighed = Chain(
        chain.fixed, chain.axes, chain.slides, chain.gravity, np.array(MASSES), chain.centre, chain.inertia, True
    )
    sag = np.array([wrong.drives.get(k, 0.0) for k in range(1, chain.size + 1)] + [wrong.base])
    arm = Calibration(weighed, stations, sag, True)
    zeros = np.array([wrong.zeros.get(k, 0.0) for k in range(1, chain.size + 1)])
    return places(arm, Setup(np.eye(4), np.array([0.12, 0.05, 0.08])), q + zeros)


def truth_of(kind: str) -> dict[str, Any]:
    """What is known of it."""
    wrong = KINDS[kind]
    effects = [{"effect": "joint_compliance", "at": [joint], "large": True, "parameters": {}} for joint in wrong.drives]
    effects += [{"effect": "base_compliance", "at": [], "large": True, "parameters": {}}] if wrong.base else []
    effects += [
        {
            "effect": "encoder_offset",
            "at": [joint],
            "large": True,
            "parameters": {f"offset_{joint}": {"value": value, "unit": "rad"}},
        }
        for joint, value in wrong.zeros.items()
    ]
    sort = "unknown" if wrong.lens else "many" if effects else "null"
    unknown = {"class": "lens", "joints": [], "depends_on": ["position"]} if wrong.lens else None
    return {"kind": sort, "arm": "six axes", "effects": effects, "unknown": unknown}
