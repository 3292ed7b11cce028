"""Cases made again from their seeds, and recorded anew by the generator's own mechanics at other poses."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from benchmarks.blind.generator.cases import Case, kind_of, make_case
from benchmarks.blind.generator.designs import Design
from benchmarks.blind.generator.files import recording_table
from benchmarks.blind.generator.vectors import Array
from benchmarks.blind.staging import exact

REGIONS = ("inside", "outside", "payload")
_EXTENDED = 0.25
"""Joint ranges are extended by this share of their width at either end."""
_HEAVIER = 1.5
"""The unseen payload, over the heaviest recorded."""


class NotTheCaseError(ValueError):
    """A case made again is not the one whose recording is on file."""


def remade(truth: Mapping[str, Any], folder: Path | None = None) -> Case:
    """The case of a truth. Raises NotTheCaseError where `folder` holds another recording than the seed gives."""
    seed = tuple(int(part) for part in truth["seed"])
    case = make_case(str(truth["case"]), seed, *kind_of(seed[-1]))
    if folder is not None:
        written = (folder / "recording.csv").read_text(encoding="utf-8")
        if recording_table(case).to_csv(index=False, lineterminator="\n") != written:
            raise NotTheCaseError(f"{folder}: the seed {seed} gives another recording")
    return case


def rng_of(truth: Mapping[str, Any], purpose: int) -> np.random.Generator:
    """Random numbers of a case for one purpose, apart from those that made it."""
    return np.random.default_rng((*truth["seed"], 7000 + purpose))


@dataclass(frozen=True)
class Session:
    """A second recording of a case: `design` row by row, `region` of each row, `tip` (axes, m) free of noise, in m."""

    design: Design
    region: tuple[str, ...]
    tip: Array


def session(case: Case, rng: np.random.Generator, each: int = 24) -> Session:
    """New poses on a day like the first: inside the joint ranges, outside them, and under a payload never recorded.

    Conditions (sides, forces, speeds, the air) are those of the recording, payloads too but for the unseen one, which
    a recording without a payload's column cannot have.
    """
    design = case.design
    low, high = design.q.min(axis=1), design.q.max(axis=1)
    loads = sorted({float(x) for x in design.payload})
    blocks: list[tuple[float, tuple[str, ...]]] = [(load, ("inside", "outside")) for load in loads]
    if "payload_kg" in design.columns:
        blocks.append((round(_HEAVIER * max(loads), 2), ("payload",)))
    q: list[Array] = []
    payload: list[float] = []
    region: list[str] = []
    for load, names in blocks:
        rows = [(name, _pose(name, low, high, rng)) for name in names for _ in range(each)]
        for k in rng.permutation(len(rows)):
            region.append(rows[k][0])
            q.append(rows[k][1])
            payload.append(load)
    made = _visited(case, np.stack(q, axis=1), np.array(payload), rng)
    return Session(made, tuple(region), exact(case.arm, made, case.effects)[: case.readings.shape[0]])


def _pose(region: str, low: Array, high: Array, rng: np.random.Generator) -> Array:
    if region != "outside":
        return rng.uniform(low, high)
    wide = _EXTENDED * (high - low)
    while True:
        q = rng.uniform(low - wide, high + wide)
        if ((q < low) | (q > high)).any():
            return q


def _rounded(case: Case, q: Array) -> Array:
    units = np.array([1e3 if joint.prismatic else 180.0 / np.pi for joint in case.arm.joints])[:, None]
    return np.round(q * units, 3) / units


def _sides(design: Design, rows: int, rng: np.random.Generator) -> Array:
    """From the sides that the recording came from: one only, or any."""
    if (design.side == design.side[:, :1]).all():
        return np.repeat(design.side[:, :1], rows, axis=1)
    return rng.choice([-1.0, 1.0], (design.q.shape[0], rows))


def _visited(case: Case, q: Array, payload: Array, rng: np.random.Generator) -> Design:
    """Visits without repeats, spread over as long a day as the recording's."""
    design, rows = case.design, q.shape[1]
    forces = np.unique(design.force, axis=1)
    side = _sides(design, rows, rng)
    speed = np.zeros_like(q)
    if np.abs(design.speed).max() > 0.0:
        turning = np.array([not joint.prismatic for joint in case.arm.joints])
        speed[turning] = (rng.uniform(0.05, 0.8, q.shape) * side)[turning]
        speed = np.asarray(np.round(np.degrees(speed), 3) * np.pi / 180.0)
    gaps = rng.uniform(0.6, 1.4, rows)
    time = np.cumsum(gaps) - gaps[0]
    return replace(
        design,
        q=_rounded(case, q),
        side=side,
        speed=speed,
        payload=payload,
        force=forces[:, rng.integers(forces.shape[1], size=rows)],
        time=np.round(time * float(design.time[-1]) / time[-1], 1),
        fresh=np.ones(rows),
        repeats=False,
    )


def table_of(case: Case, made: Session) -> pd.DataFrame:
    """A session as a recording's columns, free of noise."""
    return recording_table(replace(case, design=made.design, readings=made.tip))
