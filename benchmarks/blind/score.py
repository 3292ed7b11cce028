"""The score: one function from truths and answers to a frozen result."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping
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
    Table,
    Truth,
    all_classes_right,
    by,
    counts,
    dose_of,
    in_class,
    is_it,
    rate,
    spread,
)
from benchmarks.blind.generator.cases import DOSES
from benchmarks.blind.parameters import coverage

Rows = list[tuple[Truth, Answer]]
Hit = Callable[[Truth, Answer], bool]


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
    rows = [(truth, answers[truth["case"]]) for truth in truths]
    parts = (_verdicts(rows), _alarms(rows), _named(rows), _unnamed(rows), _where_and_how_large(rows), _predicted(rows))
    figures: dict[str, Any] = {name: value for part in parts for name, value in part.items()}
    return Score(half=half, seal=seal, **figures)


def _kind(rows: Rows, *names: str) -> Rows:
    return [(t, a) for t, a in rows if t["kind"] in names]


def _singles(rows: Rows) -> Rows:
    """Single effects; what stays below half of the least dose is no test of naming."""
    return [(t, a) for t, a in _kind(rows, "single") if t["visible"] and t["projected_snr"] > DOSES[0] / 2]


def _strong(rows: Rows) -> Rows:
    return [(t, a) for t, a in _singles(rows) if t["projected_snr"] >= 0.9]


def _outside(rows: Rows, snr: str = "projected_snr") -> Rows:
    """Effects outside the library, of a signal to noise from about 1 on."""
    return [(t, a) for t, a in _kind(rows, "outside") if (t[snr] or 0.0) >= 0.99]


def _alarm(_: Truth, a: Answer) -> bool:
    return a.verdict in ALARMS


def _unknown(_: Truth, a: Answer) -> bool:
    return a.verdict == "unknown"


def _closed(_: Truth, a: Answer) -> bool:
    return a.verdict in NAMES


def _right(t: Truth, a: Answer) -> bool:
    return a.verdict in NAMES and any(in_class(e, t["effects"][0]) for e in a.entries)


def _exact(t: Truth, a: Answer) -> bool:
    one = a.entries if a.verdict in NAMES else []
    return len(one) == 1 and is_it(one[0]["effect"], one[0].get("at"), t["effects"][0])


def _near(t: Truth, a: Answer) -> bool:
    group = [{"effect": e, "at": at} for e, at in [*t["aliases"], *t["aliases_given_geometry"]]]
    true = [t["effects"][0], *group]
    return a.verdict in NAMES and any(is_it(e["effect"], e.get("at"), other) for e in a.entries for other in true)


def _wrong(t: Truth, a: Answer) -> bool:
    return _closed(t, a) and not (_right(t, a) or _near(t, a))


def _pair(t: Truth, a: Answer) -> bool:
    return all_classes_right(a, t)


def _first(t: Truth) -> str:
    return t["effects"][0]["effect"]


def _rate(rows: Rows, hit: Hit) -> Rate:
    return rate(hit(t, a) for t, a in rows)


def _by(rows: Rows, key: Callable[[Truth], Any], hit: Hit) -> Table:
    return by((key(t), hit(t, a)) for t, a in rows)


def _verdicts(rows: Rows) -> dict[str, Any]:
    return {
        "cases": tuple(sorted(Counter(t["kind"] for t, _ in rows).items())),
        "verdicts": counts((t["kind"], a.verdict) for t, a in rows),
        "failed": rate(a.verdict == "failed" for _, a in rows),
        "seconds": spread(a.seconds for _, a in rows if a.seconds is not None),
    }


def _alarms(rows: Rows) -> dict[str, Any]:
    nulls, hostile = _kind(rows, "null", "hostile_null"), _kind(rows, "hostile_null")
    return {
        "false_alarms": _rate(nulls, _alarm),
        "false_alarms_plain": _rate(_kind(rows, "null"), _alarm),
        "false_alarms_hostile": _rate(hostile, _alarm),
        "false_alarms_by_hostility": by((vice, _alarm(t, a)) for t, a in hostile for vice in t["hostility"]),
        "false_alarms_by_arm": _by(nulls, lambda t: t["arm"], _alarm),
        "false_alarms_by_design": _by(nulls, lambda t: t["design"], _alarm),
    }


def _named(rows: Rows) -> dict[str, Any]:
    singles, strong, doubles = _singles(rows), _strong(rows), _kind(rows, "pair")

    def dose(t: Truth) -> float:
        return dose_of(t["projected_snr"])

    sizes = [len(e.get("alternatives") or []) for _, a in singles if a.verdict in NAMES for e in a.entries]
    weaker = [(t, a) for t, a in doubles if min(t["effect_snr"]) >= 0.9]
    return {
        "class_by_dose": _by(singles, dose, _right),
        "exact_by_dose": _by(singles, dose, _exact),
        "detected_by_dose": _by(singles, dose, _alarm),
        "named_within_true_aliases_by_dose": _by(singles, dose, _near),
        "wrong_name_by_dose": _by(singles, dose, _wrong),
        "class_by_effect": _by(strong, _first, _right),
        "class_by_arm": _by(strong, lambda t: t["arm"], _right),
        "class_by_design": _by(strong, lambda t: t["design"], _right),
        "alternatives_a_name": float(np.mean(sizes)) if sizes else math.nan,
        "pairs_by_dose": _by(doubles, lambda t: dose_of(min(t["effect_snr"])), _pair),
        "pairs_by_weaker": _rate(weaker, _pair),
    }


def _unnamed(rows: Rows) -> dict[str, Any]:
    """What has no name in the library, or none that this recording shows."""
    recalled, beyond, invisible = _outside(rows), _outside(rows, "snr_beyond_library"), _kind(rows, "invisible")
    shared = [(t, a) for t, a in invisible if t["visible"]]
    return {
        "unknown_recall": _rate(recalled, _unknown),
        "wrong_closure": _rate(recalled, _closed),
        "unknown_recall_beyond_library": _rate(beyond, _unknown),
        "wrong_closure_beyond_library": _rate(beyond, _closed),
        "unknown_by_effect": _by(recalled, _first, _unknown),
        "refused": rate(a.verdict in REFUSALS for t, a in invisible if not t["visible"]),
        "aliases_declared": rate(
            a.verdict in REFUSALS or (_right(t, a) and any(e.get("alternatives") for e in a.entries)) for t, a in shared
        ),
        "confusion": counts((_first(t), _said(a)) for t, a in [*_strong(rows), *recalled]),
    }


def _where_and_how_large(rows: Rows) -> dict[str, Any]:
    covered = _covered([*_singles(rows), *_kind(rows, "pair")])
    recalled = _outside(rows)
    located = [(t, _joint(a)) for t, a in [*_strong(rows), *recalled] if _locates(t, a)]
    slips = [(t, a) for t, a in recalled if t["since_s"] is not None]
    return {
        "coverage": rate(inside for _, inside in covered),
        "coverage_by_parameter": by(covered),
        "joint_right": rate(joint in t["effects"][0]["at"] for t, joint in located),
        "joint_within_one": rate(min(abs(joint - i) for i in t["effects"][0]["at"]) <= 1 for t, joint in located),
        "since_found": rate(math.isfinite(_since(a)) for _, a in slips),
        "since_error_s": spread(abs(_since(a) - t["since_s"]) for t, a in slips),
    }


def _predicted(rows: Rows) -> dict[str, Any]:
    singles = _singles(rows)
    named = [(t, a) for t, a in [*singles, *_kind(rows, "pair")] if all_classes_right(a, t)]
    quiet = [*_kind(rows, "null"), *singles]
    return {
        "held_out_over_floor": spread((_ratio(a, "noise_floor_mm") for _, a in named), 1.05),
        "held_out_over_true_noise": spread(
            (_of(a, "rms_after_held_out_mm") / t["noise_rms_mm"] for t, a in named), 1.05
        ),
        "floor_over_true_noise": spread(_of(a, "noise_floor_mm") / t["noise_rms_mm"] for t, a in quiet),
    }


def _covered(rows: Rows) -> list[tuple[str, bool]]:
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
