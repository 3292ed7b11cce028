"""What a diagnosis of a recording of known truth says, whether that is right, and what moves between two of them."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.blind.answers import NAMES, REFUSALS, Answer, all_classes_right, in_class
from linkwright.core.arm.files.read import read_arm
from linkwright.core.diagnose.diagnosis import diagnose
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.reading.read import read_recording
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.units.quantities import InputError
from linkwright.json.diagnosis import diagnosis_json

REFUSED = "refused"
"""The verdict where the recording was not read at all."""


@dataclass(frozen=True)
class Told:
    """A diagnosis in short: verdict, names (effect and places), sizes with their 95 % interval (SI), and whether the
    answer is right by the truth."""

    verdict: str
    names: tuple[str, ...]
    sizes: Mapping[str, tuple[float, float, float]]
    right: bool


def tell(case: Path, truth: Mapping[str, Any], rules: Rules) -> Told:
    """Diagnose the recording of a case by some rules."""
    arm = read_arm(case / "arm.yaml")
    try:
        recording = read_recording(case / "recording.csv", arm, rules=rules)
    except InputError:
        return Told(REFUSED, (), {}, False)
    found = diagnose(arm, recording, Options(rules=rules))
    answer = Answer(case.name, 0, None, diagnosis_json(found))
    names = tuple(sorted(f"{each.effect} {list(each.at)}" for each in found.findings))
    sizes = {
        f"{finding.effect} {list(finding.at)} {each.name}": (each.value, *each.interval)
        for finding in found.findings
        for each in finding.parameters
    }
    return Told(found.verdict, names, sizes, is_right(truth, answer))


def is_right(truth: Mapping[str, Any], answer: Answer) -> bool:
    """Whether an answer is the one that the proof counts as right for a truth of its kind."""
    kind, true = truth["kind"], list(truth["effects"])
    if kind in ("null", "hostile_null") or not truth["visible"]:
        return answer.verdict in REFUSALS
    if kind == "outside":
        return answer.verdict == "unknown"
    if kind == "pair":
        return all_classes_right(answer, truth)
    return answer.verdict in NAMES and any(in_class(entry, true[0]) for entry in answer.entries)


def moves(before: Told, after: Told) -> list[str]:
    """What differs, in words: the verdict, the names, sizes that leave their interval."""
    found: list[str] = []
    if before.verdict != after.verdict:
        found.append(f"verdict {before.verdict} -> {after.verdict}")
    if before.names != after.names:
        lost, new = set(before.names) - set(after.names), set(after.names) - set(before.names)
        found.append(
            "names " + ", ".join([*(f"-{each}" for each in sorted(lost)), *(f"+{each}" for each in sorted(new))])
        )
    for name, (value, low, high) in before.sizes.items():
        other = after.sizes.get(name)
        if other is not None and not low <= other[0] <= high:
            found.append(f"{name} {value:.4g} -> {other[0]:.4g}, outside {low:.4g} to {high:.4g}")
    return found


def harm(before: Told, after: Told) -> bool:
    """Whether a right answer has become wrong."""
    return before.right and not after.right


def as_text(told: Told, asked: set[str]) -> str:
    """To be kept in a file."""
    content = {"verdict": told.verdict, "names": told.names, "sizes": told.sizes, "right": told.right}
    return json.dumps({**content, "asked": sorted(asked)}) + "\n"


def from_text(text: str) -> tuple[Told, set[str]]:
    """What `as_text` wrote."""
    held = json.loads(text)
    sizes = {name: (float(each[0]), float(each[1]), float(each[2])) for name, each in held["sizes"].items()}
    return Told(held["verdict"], tuple(held["names"]), sizes, bool(held["right"])), set(held["asked"])
