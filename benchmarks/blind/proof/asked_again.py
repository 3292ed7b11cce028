"""Recordings that are made here and asked about: with further poses, and by the tool's own formulas."""

from __future__ import annotations

import json
import math
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from benchmarks.blind.generator.cases import Case
from benchmarks.blind.generator.files import recording_settings, recording_table
from benchmarks.blind.generator.vectors import Array
from benchmarks.blind.proof.library import true_arm
from benchmarks.blind.proof.patterns import left
from benchmarks.blind.proof.remade import Visit, continued, remade, rng_of
from benchmarks.blind.run import ask
from benchmarks.blind.staging import exact

_KEPT = ("verdict", "missing", "where", "noise_floor_mm", "rms_after_held_out_mm")


def _answered(case: Case, folder: Path, seconds: float = 120.0) -> dict[str, Any]:
    """What the tool says of a case, with the arm file of `folder`: status, seconds, and the answer's main keys."""
    with tempfile.TemporaryDirectory() as place:
        own = Path(place) / "case"
        own.mkdir()
        (own / "arm.yaml").write_bytes((folder / "arm.yaml").read_bytes())
        recording_table(case).to_csv(own / "recording.csv", index=False, lineterminator="\n")
        settings = yaml.safe_dump(recording_settings(case), sort_keys=True)
        (own / "recording.yaml").write_text(settings, encoding="utf-8")
        answer = Path(place) / "answers" / "diagnosis" / "answer.json"
        answer.parent.mkdir(parents=True)
        status, taken, error = ask(str(own), str(answer), seconds)
        said: Any = json.loads(answer.read_text(encoding="utf-8")) if status == 0 else None
    kept = None if said is None else {key: said.get(key) for key in _KEPT}
    return {"status": status, "seconds": taken, "error": error, "diagnosis": kept}


def next_poses(truth: dict[str, Any], folder: str, said: dict[str, Any]) -> dict[str, Any]:
    """The answers after the poses that the tool asked for, and after as many random ones from the same menu.

    The menu is the tool's: joint ranges, no payload or the heaviest recorded, all joints from either side.
    """
    case = remade(truth, Path(folder))
    units = [1e-3 if joint.prismatic else math.pi / 180.0 for joint in case.arm.joints]
    wanted = [
        Visit(
            tuple(float(x) * unit for x, unit in zip(q, units, strict=True)),
            None if more["payload_kg"] is None else float(more["payload_kg"]),
            float(more["side"]),
        )
        for q, more in zip(said["next_poses"], said["next_poses_detail"], strict=True)
    ]
    rng = rng_of(truth, 2)
    loads = (0.0, float(case.design.payload.max()))
    low, high = case.ranges.low, case.ranges.high
    chance = [
        Visit(tuple(rng.uniform(low, high)), float(rng.choice(loads)), float(rng.choice([-1.0, 1.0]))) for _ in wanted
    ]
    return {
        "poses": len(wanted),
        "designed": _answered(continued(case, wanted, rng_of(truth, 3)), Path(folder)),
        "random": _answered(continued(case, chance, rng_of(truth, 3)), Path(folder)),
    }


def self_made(truth: dict[str, Any], folder: str) -> dict[str, Any]:
    """The answer to the same case as the tool's own formulas would have recorded it: same poses and conditions, the
    true parameters, white noise of the same RMS; and how far those formulas are from the generator, over the noise."""
    case = remade(truth, Path(folder))
    axes = case.readings.shape[0]
    clean = exact(case.arm, case.design, case.effects)[:axes]
    # repeats that agree to the last digit would be set aside as copies
    jitter = 1e-5 * rng_of(truth, 5).standard_normal(clean.shape)
    with tempfile.TemporaryDirectory() as place:
        recording, arm = Path(place) / "recording.csv", Path(place) / "true.yaml"
        recording_table(replace(case, readings=clean + jitter)).to_csv(recording, index=False, lineterminator="\n")
        true_arm(case, Path(folder), arm)
        apart: Array = left(arm, recording).T - jitter
    noise = case.tracker.sigma * rng_of(truth, 4).standard_normal(clean.shape)
    answer = _answered(replace(case, readings=clean - apart + noise), Path(folder))
    departure = float(np.sqrt(np.mean(np.sum(apart**2, axis=0)))) / (case.tracker.sigma * math.sqrt(axes))
    return answer | {"departure": departure}
