"""Recordings with further poses, asked about anew."""

from __future__ import annotations

import json
import math
import tempfile
from pathlib import Path
from typing import Any

import yaml

from benchmarks.blind.generator.cases import Case
from benchmarks.blind.generator.files import recording_settings, recording_table
from benchmarks.blind.proof.remade import Visit, continued, remade, rng_of
from benchmarks.blind.run import ask

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
