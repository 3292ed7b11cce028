"""From cached parts and answers to the figures of the report; nothing is formatted here."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from benchmarks.blind.answers import (
    NAMES,
    Answer,
    Rate,
    Spread,
    Truth,
    all_classes_right,
    in_class,
    members,
    rate,
    spread,
)
from benchmarks.blind.proof.halves import Half, shown
from benchmarks.blind.proof.parts import FAILED
from benchmarks.blind.proof.remade import REGIONS

TOOL = "linkwright"
WAYS = ("designed", "random")
Results = Mapping[str, Mapping[str, Any]]


@dataclass(frozen=True)
class Prediction:
    """One way of predicting: for each region the spread of the RMS with fresh noise over the noise, and the same of
    the error alone."""

    way: str
    whole: tuple[Spread, ...]
    error: tuple[Spread, ...]


@dataclass(frozen=True)
class Poses:
    """Alias classes after further poses: how many came down to the one true name, shrank, stayed, lost the truth."""

    way: str
    resolved: Rate
    smaller: Rate
    stayed: Rate
    lost: Rate


@dataclass(frozen=True)
class Figures:
    """All that goes beyond a half's score. `failed` counts pieces of work without a result."""

    predictions: tuple[Prediction, ...]
    predicted: int
    direction: Rate
    poses: tuple[Poses, ...]
    promised: tuple[Poses, ...]  # where the answer says that its poses are enough for all pairs
    posed: tuple[int, int]  # cases with poses; those where the tool says that no pose would help
    confusion: tuple[tuple[str, tuple[tuple[str, int], ...]], ...]
    failed: int


def figures(half: Half, found: Mapping[str, Results]) -> Figures:
    """The figures of a half from the results of its parts (`prediction`, `next_poses`)."""
    truths = {t["case"]: t for t in half.truths}
    ratios, poses = _good(found["prediction"]), _good(found["next_poses"])
    sure = {case: pose for case, pose in poses.items() if _enough(half.said[case])}
    directed = [
        (result["direction"], ((half.said[case].diagnosis or {}).get("where") or {}).get("direction"))
        for case, result in ratios.items()
    ]
    return Figures(
        predictions=_predictions(half, truths, ratios),
        predicted=len(ratios),
        direction=rate(said == true for true, said in directed if said is not None),
        poses=tuple(_poses(way, truths, half.said, poses) for way in WAYS if poses),
        promised=tuple(_poses(way, truths, half.said, sure) for way in WAYS if sure),
        posed=(len(poses), sum(hopeless(t, half.said[t["case"]]) for t in half.truths)),
        confusion=confusion(half.truths, half.said),
        failed=sum(FAILED in result for part in found.values() for result in part.values()),
    )


def _good(results: Results) -> dict[str, Mapping[str, Any]]:
    return {case: result for case, result in results.items() if FAILED not in result}


def asks_for_poses(truth: Truth, answer: Answer) -> bool:
    """An alias class that holds the truth, with poses that should resolve it."""
    return _in_a_class(truth, answer) and bool((answer.diagnosis or {}).get("next_poses"))


def _enough(answer: Answer) -> bool:
    """Whether the answer says that its poses will tell every pair of names."""
    note = str((answer.diagnosis or {}).get("next_poses_note") or "")
    return "enough" in note and "No pose" not in note


def hopeless(truth: Truth, answer: Answer) -> bool:
    """An alias class that holds the truth, and no pose that would help."""
    return _in_a_class(truth, answer) and not (answer.diagnosis or {}).get("next_poses")


def _in_a_class(truth: Truth, answer: Answer) -> bool:
    seen = shown(truth, ("single", "pair"), 0.0)
    return seen and answer.verdict == "alias_class" and all_classes_right(answer, truth)


def _predictions(half: Half, truths: Mapping[str, Truth], results: Results) -> tuple[Prediction, ...]:
    right = {case for case in results if all_classes_right(half.said[case], truths[case])}
    ways = list(dict.fromkeys(way for result in results.values() for way in result["ratios"]))
    predictions: list[Prediction] = []
    for way in ways:
        predictions.append(_prediction(way, (r["ratios"][way] for r in results.values() if way in r["ratios"])))
        if way == TOOL:
            own = (r["ratios"][way] for case, r in results.items() if case in right and way in r["ratios"])
            predictions.append(_prediction(f"{TOOL}, rightly named", own))
    return tuple(predictions)


def _prediction(way: str, ratios: Iterable[Mapping[str, float | None]]) -> Prediction:
    rows = list(ratios)
    columns = [[row[region] for row in rows] for region in REGIONS]
    known = [[x for x in column if x is not None] for column in columns]
    return Prediction(
        way,
        tuple(spread((math.sqrt(1.0 + x * x) for x in column), 1.05) for column in known),
        tuple(spread(column) for column in known),
    )


def _poses(way: str, truths: Mapping[str, Truth], before: Mapping[str, Answer], results: Results) -> Poses:
    state = Counter[str]()
    for case, result in results.items():
        answer = _as_answer(case, result[way])
        state[_came(truths[case], before[case], answer)] += 1
    total = sum(state.values())

    def share(name: str) -> Rate:
        return rate(k < state[name] for k in range(total))

    return Poses(way, share("resolved"), share("smaller"), share("stayed"), share("lost"))


def _came(truth: Truth, before: Answer, after: Answer) -> str:
    """What became of an alias class: resolved (the true name alone), smaller, stayed, or lost (the truth is not in)."""
    if not all_classes_right(after, truth):
        return "lost"
    left, was = (sum(len(members(entry)) for entry in item.entries) for item in (after, before))
    if left == len(truth["effects"]):
        return "resolved"
    return "smaller" if left < was else "stayed"


def _as_answer(case: str, result: Mapping[str, Any]) -> Answer:
    return Answer(case, int(result["status"]), result["seconds"], result["diagnosis"])


def confusion(
    truths: Iterable[Truth], said: Mapping[str, Answer], least: float = 0.9
) -> tuple[tuple[str, tuple[tuple[str, int], ...]], ...]:
    """For each true effect what was said, singles and effects outside the library from this signal to noise on.

    An answer whose class holds the truth counts as the truth, any other as its largest name, or as the verdict.
    """
    table: dict[str, Counter[str]] = {}
    for truth in truths:
        if not shown(truth, ("single", "outside"), least):
            continue
        true, answer = truth["effects"][0], said[truth["case"]]
        label = answer.verdict
        if label in NAMES:
            held = any(in_class(entry, true) for entry in answer.entries)
            label = str(true["effect"]) if held else str(answer.entries[0]["effect"])
        table.setdefault(str(true["effect"]), Counter())[label] += 1
    return tuple((effect, tuple(count.most_common())) for effect, count in sorted(table.items()))
