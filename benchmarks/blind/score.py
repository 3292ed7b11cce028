"""The score: one function from truths and answers to a frozen result."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.blind.answers import (
    ALARMS,
    NAMES,
    REFUSALS,
    Answer,
    Rate,
    Spread,
    Truth,
    all_classes_right,
    dose_of,
    in_class,
    is_it,
    rate,
    spread,
)
from benchmarks.blind.generator.cases import DOSES
from benchmarks.blind.parameters import coverage

Table = tuple[tuple[str, Rate], ...]


@dataclass(frozen=True)
class Score:
    """All figures of a half. Tables are (label, rate) pairs in a fixed order."""

    half: str
    seal: str
    cases: tuple[tuple[str, int], ...]
    verdicts: tuple[tuple[str, tuple[tuple[str, int], ...]], ...]
    failed: Rate
    false_alarms: Rate
    false_alarms_plain: Rate
    false_alarms_hostile: Rate
    false_alarms_by_hostility: Table
    false_alarms_by_arm: Table
    false_alarms_by_design: Table
    class_by_dose: Table
    exact_by_dose: Table
    detected_by_dose: Table
    named_within_true_aliases_by_dose: Table
    wrong_name_by_dose: Table
    class_by_effect: Table
    class_by_arm: Table
    class_by_design: Table
    alternatives_a_name: float
    pairs_by_dose: Table
    pairs_by_weaker: Rate
    unknown_recall: Rate
    wrong_closure: Rate
    unknown_recall_beyond_library: Rate
    wrong_closure_beyond_library: Rate
    unknown_by_effect: Table
    refused: Rate
    aliases_declared: Rate
    coverage: Rate
    coverage_by_parameter: Table
    joint_right: Rate
    joint_within_one: Rate
    since_found: Rate
    since_error_s: Spread
    held_out_over_floor: Spread
    held_out_over_true_noise: Spread
    floor_over_true_noise: Spread
    seconds: Spread
    confusion: tuple[tuple[str, tuple[tuple[str, int], ...]], ...]


def score(truths: list[Truth], answers: Mapping[str, Answer], half: str = "", seal: str = "") -> Score:
    """All figures, from truths and answers alone."""
    pairs = [(truth, answers[truth["case"]]) for truth in truths]

    def kind(*names: str) -> list[tuple[Truth, Answer]]:
        return [(t, a) for t, a in pairs if t["kind"] in names]

    nulls, plain, hostile = kind("null", "hostile_null"), kind("null"), kind("hostile_null")
    # what stays below half of the least dose is no test of naming
    singles = [(t, a) for t, a in kind("single") if t["visible"] and t["projected_snr"] > DOSES[0] / 2]
    doubles, outside, invisible = kind("pair"), kind("outside"), kind("invisible")
    strong = [(t, a) for t, a in singles if t["projected_snr"] >= 0.9]

    def alarm(_: Truth, a: Answer) -> bool:
        return a.verdict in ALARMS

    def right(t: Truth, a: Answer) -> bool:
        return a.verdict in NAMES and any(in_class(e, t["effects"][0]) for e in a.entries)

    def exact(t: Truth, a: Answer) -> bool:
        one = a.entries if a.verdict in NAMES else []
        return len(one) == 1 and is_it(one[0]["effect"], one[0].get("at"), t["effects"][0])

    def near(t: Truth, a: Answer) -> bool:
        true = t["effects"][0]
        group = [{"effect": e, "at": at} for e, at in [*t["aliases"], *t["aliases_given_geometry"]]]
        return a.verdict in NAMES and any(
            is_it(e["effect"], e.get("at"), other) for e in a.entries for other in [true, *group]
        )

    def unknown(_: Truth, a: Answer) -> bool:
        return a.verdict == "unknown"

    def closed(_: Truth, a: Answer) -> bool:
        return a.verdict in NAMES

    def by(
        rows: list[tuple[Truth, Answer]], key: Callable[[Truth], Any], hit: Callable[[Truth, Answer], bool]
    ) -> Table:
        labels = sorted({key(t) for t, _ in rows})
        return tuple((str(label), rate(hit(t, a) for t, a in rows if key(t) == label)) for label in labels)

    def dose(t: Truth) -> float:
        return dose_of(t["projected_snr"])

    def at_least_one(key: str) -> list[tuple[Truth, Answer]]:
        return [(t, a) for t, a in outside if (t[key] or 0.0) >= 0.99]

    recalled, beyond = at_least_one("projected_snr"), at_least_one("snr_beyond_library")
    named = [(t, a) for t, a in [*singles, *doubles] if all_classes_right(a, t)]
    covered = _covered([*singles, *doubles])
    located = [(t, _joint(a)) for t, a in [*strong, *recalled] if _locates(t, a)]
    slips = [(t, a) for t, a in recalled if t["since_s"] is not None]
    sizes = [len(e.get("alternatives") or []) for _, a in singles if a.verdict in NAMES for e in a.entries]
    hostilities = sorted({h for t, _ in hostile for h in t["hostility"]})
    hidden = [(t, a) for t, a in invisible if not t["visible"]]
    shared = [(t, a) for t, a in invisible if t["visible"]]
    return Score(
        half=half,
        seal=seal,
        cases=tuple(sorted(Counter(t["kind"] for t, _ in pairs).items())),
        verdicts=_counts((t["kind"], a.verdict) for t, a in pairs),
        failed=rate(a.verdict == "failed" for _, a in pairs),
        false_alarms=rate(alarm(t, a) for t, a in nulls),
        false_alarms_plain=rate(alarm(t, a) for t, a in plain),
        false_alarms_hostile=rate(alarm(t, a) for t, a in hostile),
        false_alarms_by_hostility=tuple(
            (h, rate(alarm(t, a) for t, a in hostile if h in t["hostility"])) for h in hostilities
        ),
        false_alarms_by_arm=by(nulls, lambda t: t["arm"], alarm),
        false_alarms_by_design=by(nulls, lambda t: t["design"], alarm),
        class_by_dose=by(singles, dose, right),
        exact_by_dose=by(singles, dose, exact),
        detected_by_dose=by(singles, dose, alarm),
        named_within_true_aliases_by_dose=by(singles, dose, near),
        wrong_name_by_dose=by(singles, dose, lambda t, a: closed(t, a) and not (right(t, a) or near(t, a))),
        class_by_effect=by(strong, lambda t: t["effects"][0]["effect"], right),
        class_by_arm=by(strong, lambda t: t["arm"], right),
        class_by_design=by(strong, lambda t: t["design"], right),
        alternatives_a_name=float(np.mean(sizes)) if sizes else math.nan,
        pairs_by_dose=by(doubles, lambda t: dose_of(min(t["effect_snr"])), lambda t, a: all_classes_right(a, t)),
        pairs_by_weaker=rate(all_classes_right(a, t) for t, a in doubles if min(t["effect_snr"]) >= 0.9),
        unknown_recall=rate(unknown(t, a) for t, a in recalled),
        wrong_closure=rate(closed(t, a) for t, a in recalled),
        unknown_recall_beyond_library=rate(unknown(t, a) for t, a in beyond),
        wrong_closure_beyond_library=rate(closed(t, a) for t, a in beyond),
        unknown_by_effect=by(recalled, lambda t: t["effects"][0]["effect"], unknown),
        refused=rate(a.verdict in REFUSALS for _, a in hidden),
        aliases_declared=rate(
            a.verdict in REFUSALS or (right(t, a) and any(e.get("alternatives") for e in a.entries)) for t, a in shared
        ),
        coverage=rate(inside for _, inside in covered),
        coverage_by_parameter=tuple(
            (name, rate(inside for key, inside in covered if key == name)) for name in sorted({k for k, _ in covered})
        ),
        joint_right=rate(joint in t["effects"][0]["at"] for t, joint in located),
        joint_within_one=rate(min(abs(joint - i) for i in t["effects"][0]["at"]) <= 1 for t, joint in located),
        since_found=rate(math.isfinite(_since(a)) for _, a in slips),
        since_error_s=spread(abs(_since(a) - t["since_s"]) for t, a in slips),
        held_out_over_floor=spread((_ratio(a, "noise_floor_mm") for _, a in named), 1.05),
        held_out_over_true_noise=spread((_of(a, "rms_after_held_out_mm") / t["noise_rms_mm"] for t, a in named), 1.05),
        floor_over_true_noise=spread(_of(a, "noise_floor_mm") / t["noise_rms_mm"] for t, a in [*plain, *singles]),
        seconds=spread(a.seconds for _, a in pairs if a.seconds is not None),
        confusion=_counts((t["effects"][0]["effect"], _said(a)) for t, a in [*strong, *recalled]),
    )


def _counts(items: Iterable[tuple[str, str]]) -> tuple[tuple[str, tuple[tuple[str, int], ...]], ...]:
    table: dict[str, Counter[str]] = {}
    for key, value in items:
        table.setdefault(key, Counter())[value] += 1
    return tuple((key, tuple(count.most_common())) for key, count in sorted(table.items()))


def _covered(rows: list[tuple[Truth, Answer]]) -> list[tuple[str, bool]]:
    """Intervals of effects that are rightly named, by parameter."""
    return [
        found
        for t, a in rows
        if a.verdict in NAMES
        for true in t["effects"]
        for entry in a.entries
        if is_it(entry["effect"], entry.get("at"), true)
        for found in coverage(entry, true)
    ]


def _where(a: Answer, key: str) -> Any:
    return ((a.diagnosis or {}).get("where") or {}).get(key)


def _joint(a: Answer) -> int:
    joint = _where(a, "joint")
    return joint if isinstance(joint, int) else 0


def _locates(t: Truth, a: Answer) -> bool:
    return a.verdict in ALARMS and _joint(a) > 0 and len(t["effects"][0]["at"]) == 1


def _since(a: Answer) -> float:
    since = _where(a, "since_s")
    return math.nan if since is None else float(since)


def _of(a: Answer, key: str) -> float:
    value = (a.diagnosis or {}).get(key)
    return math.nan if value is None else float(value)


def _ratio(a: Answer, floor: str) -> float:
    below = _of(a, floor)
    return _of(a, "rms_after_held_out_mm") / below if below else math.nan


def _said(a: Answer) -> str:
    return "+".join(sorted(e["effect"] for e in a.entries)) if a.verdict in NAMES else a.verdict
