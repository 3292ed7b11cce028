"""The score of the proof of motion logs: from truths, answers and predictions to targets, tables and misses."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from benchmarks.blind.answers import ALARMS, NAMES, Answer, Spread, Table, by, counts, rate, spread
from benchmarks.blind.parameters import coverage
from benchmarks.motion.names import Truth, in_class, is_alike, is_it, members
from benchmarks.multibody.score import Target, at_least, at_most, entry_text, of_kind, target_table, within

Row = tuple[Truth, Answer]
Predictions = Mapping[str, Mapping[str, Any]]
AS_GOOD = 1.1
"""Times the RMS of the true causes, fitted, up to which the tool's corrected arm is as good."""


@dataclass(frozen=True)
class Score:
    """All figures of what was run."""

    half: str
    seal: str
    seeds: tuple[int, ...]
    cases: tuple[tuple[str, int], ...]
    failed: tuple[str, ...]
    targets: tuple[Target, ...]
    tables: tuple[tuple[str, Table], ...]
    predicted: tuple[tuple[str, Spread], ...]
    verdicts: tuple[tuple[str, tuple[tuple[str, int], ...]], ...]
    seconds: Spread
    misses: tuple[str, ...]


def score(
    truths: Sequence[Truth], answers: Mapping[str, Answer], predicted: Predictions, half: str = "", seal: str = ""
) -> Score:
    """All figures, from truths, answers and predictions alone."""
    rows: list[Row] = [(truth, answers[truth["case"]]) for truth in truths]
    return Score(
        half=half,
        seal=seal,
        seeds=tuple(sorted({int(t["seed"][0]) for t in truths})),
        cases=tuple(sorted(Counter(t["kind"] for t in truths).items())),
        failed=tuple(f"{t['case']}: status {a.status}" for t, a in rows if a.verdict == "failed"),
        targets=_targets(rows),
        tables=tuple((title, table) for title, table in _tables(rows) if table),
        predicted=_predicted(rows, predicted),
        verdicts=counts((t["kind"], a.verdict) for t, a in rows),
        seconds=spread(a.seconds for _, a in rows if a.seconds is not None),
        misses=tuple(line for t, a in rows if (line := _miss(t, a))),
    )


def _large(rows: Sequence[Row], *kinds: str) -> list[tuple[Truth, Answer, Mapping[str, Any]]]:
    return [(t, a, e) for t, a in of_kind(rows, *(kinds or ("one", "two", "bare"))) for e in t["effects"] if e["large"]]


def _named(a: Answer) -> list[Mapping[str, Any]]:
    """The names that an answer stands by."""
    return a.entries if a.verdict in NAMES else []


def _right(t: Truth, a: Answer, e: Mapping[str, Any]) -> bool:
    return any(in_class(entry, e, t) for entry in _named(a))


def _first(t: Truth, a: Answer, e: Mapping[str, Any]) -> bool:
    return any(is_it(members(entry)[0], e, t) for entry in _named(a))


def _listed(t: Truth, a: Answer, e: Mapping[str, Any]) -> bool:
    return any(in_class(entry, e, t) for entry in a.entries)


def _true_name(t: Truth, entry: Mapping[str, Any]) -> bool:
    return any(in_class(entry, e, t) for e in t["effects"])


def _false(t: Truth, entry: Mapping[str, Any]) -> bool:
    return not _true_name(t, entry) and not is_alike(entry, t)


def _exact(t: Truth, a: Answer) -> bool:
    """All large causes named and nothing false."""
    all_named = all(_right(t, a, e) for e in t["effects"] if e["large"])
    return all_named and not any(_false(t, entry) for entry in _named(a))


def _covered(rows: Sequence[Row]) -> list[tuple[str, bool]]:
    """Whether each interval of what is rightly named holds the truth, by effect and parameter."""
    return [
        (f"{e['effect']} {name}", inside)
        for t, a in rows
        for e in t["effects"]
        for entry in _named(a)
        if entry["effect"] == e["effect"] and is_it(members(entry)[0], e, t)
        for name, inside in coverage(entry, e)
    ]


def _targets(rows: Sequence[Row]) -> tuple[Target, ...]:
    nulls, unknowns = of_kind(rows, "null"), of_kind(rows, "unknown")
    given = [_false(t, entry) for t, a in rows if t["kind"] != "unknown" for entry in _named(a)]
    return (
        at_most("false alarms on nulls", 0.01, rate(a.verdict in ALARMS for _, a in nulls)),
        at_least("large causes named (name or alternatives)", 0.95, rate(_right(t, a, e) for t, a, e in _large(rows))),
        at_least("unknown classes called unknown", 0.90, rate(a.verdict == "unknown" for _, a in unknowns)),
        within("95 % intervals that hold the truth", 0.93, 0.97, rate(inside for _, inside in _covered(rows))),
        at_most("names that are of no cause, nor of what is hardly told from one", 0.05, rate(given)),
        at_least(
            "all large causes named, nothing false", 24 / 33, rate(_exact(t, a) for t, a in of_kind(rows, "one", "two"))
        ),
    )


def _tables(rows: Sequence[Row]) -> tuple[tuple[str, Table], ...]:
    large, nulls, unknowns = _large(rows), of_kind(rows, "null"), of_kind(rows, "unknown")
    small = [(t, a, e) for t, a in of_kind(rows, "one", "two") for e in t["effects"] if not e["large"]]
    given = [(t, a, entry) for t, a in rows for entry in _named(a)]
    pointed = [(t, a) for t, a in unknowns if a.verdict == "unknown" and t["unknown"]["joints"]]
    return (
        ("large causes named, by kind", by((t["kind"], _right(t, a, e)) for t, a, e in large)),
        ("large causes whose own name comes first", by((t["kind"], _first(t, a, e)) for t, a, e in large)),
        ("large causes named, or listed beside an unknown", by((t["kind"], _listed(t, a, e)) for t, a, e in large)),
        ("large causes named, by effect", by((e["effect"], _right(t, a, e)) for t, a, e in large)),
        ("large causes named, by arm", by((t["arm"], _right(t, a, e)) for t, a, e in large)),
        ("small causes named", by((e["effect"], _right(t, a, e)) for t, a, e in small)),
        ("names of no cause, by kind", by((t["kind"], not _true_name(t, entry)) for t, _, entry in given)),
        (
            "names of no cause nor of its like, by name",
            by((entry["effect"], _false(t, entry)) for t, _, entry in given),
        ),
        ("unknown classes called unknown", by((t["unknown"]["class"], a.verdict == "unknown") for t, a in unknowns)),
        ("unknown classes given a name", by((t["unknown"]["class"], a.verdict in NAMES) for t, a in unknowns)),
        ("of unknowns, the right joint", by((t["unknown"]["class"], _points(t, a)) for t, a in pointed)),
        ("95 % intervals that hold the truth", by(_covered(rows))),
        ("false alarms on nulls, by logger", by((_logger(t), a.verdict in ALARMS) for t, a in nulls)),
    )


def _logger(t: Truth) -> str:
    logger = t["logger"]
    return (
        f"speeds {logger['speeds']}" + ", filtered" * (logger["cutoff"] > 0.0) + ", jitter" * (logger["jitter"] > 0.1)
    )


def _points(t: Truth, a: Answer) -> bool:
    """Whether an unknown is said to be at its joint."""
    diagnosis = a.diagnosis or {}
    joints = set((diagnosis.get("unknown") or {}).get("joints") or []) | {(diagnosis.get("where") or {}).get("joint")}
    return bool(joints & set(t["unknown"]["joints"]))


def _predicted(rows: Sequence[Row], predicted: Predictions) -> tuple[tuple[str, Spread], ...]:
    """The RMS of the tool's corrected arms on test logs over that of the true causes fitted by least squares."""
    ratios: dict[str, list[float]] = {}
    for t, _ in rows:
        joints = (predicted.get(t["case"]) or {}).get("per_joint") or []
        if t["kind"] == "unknown" or len(joints) != t["joints"]:
            continue
        pairs = zip(joints, t["oracle_rms"], t["torque_rms"], strict=True)
        own, best = 0.0, 0.0
        for joint, oracle, whole in pairs:
            own += (float(joint["rms"] or math.nan) / whole) ** 2
            best += (oracle / whole) ** 2
        ratios.setdefault(t["kind"], []).append(math.sqrt(own / best))
    return tuple((kind, spread(values, AS_GOOD)) for kind, values in sorted(ratios.items()))


def _miss(t: Truth, a: Answer) -> str:
    """A line for a case that is not answered as it should be; empty where it is."""
    wrong = _wrong(t, a)
    if not wrong:
        return ""
    text = ", ".join([a.verdict, *map(entry_text, a.entries)])
    return f"{t['case']} ({t['kind']}, {t['arm']}, {t['logger']['rate']:g} Hz): {wrong}; said {text}"


def _wrong(t: Truth, a: Answer) -> str:
    if a.verdict == "failed":
        return "no answer"
    if t["kind"] == "null":
        return "nothing is missing" if a.verdict in ALARMS else ""
    if t["kind"] == "unknown":
        return "" if a.verdict == "unknown" else f"{t['unknown']['class']} {t['unknown']['joints']}"
    lost = [e for e in t["effects"] if e["large"] and not _right(t, a, e)]
    false = [entry for entry in _named(a) if _false(t, entry)]
    parts = [f"lost {e['effect']} {e['at']} at {e['share']:.2f}" for e in lost]
    parts += [f"false {entry_text(entry)}" for entry in false]
    small = [f"{e['effect']} {e['at']} at {e['share']:.3f}" for e in t["effects"] if not e["large"]]
    return ", ".join(parts) + (f" beside {', '.join(small)}" if parts and small else "")


def shown(score: Score) -> str:
    """The score as Markdown; nothing is computed here."""
    kinds = ", ".join(f"{name} {number}" for name, number in score.cases)
    lines = [
        f"{sum(n for _, n in score.cases)} cases of the {'proof' if score.half == 'sealed' else 'development'} half, "
    ]
    lines[0] += f"seed {' and '.join(map(str, score.seeds))} ({kinds}); {len(score.failed)} without an answer; "
    lines[0] += f"{score.seconds.shown()} seconds a case."
    lines += ["", *target_table(score.targets)]
    lines += ["", "| test log: RMS of the corrected arm over that of the true causes, fitted | |", "|---|---|"]
    lines += [f"| {kind} | {ratio.shown()} |" for kind, ratio in score.predicted]
    for title, table in score.tables:
        lines += ["", f"| {title} | |", "|---|---|", *(f"| {label} | {item.shown(0)} |" for label, item in table)]
    tallies = (f"{kind}: " + ", ".join(f"{v} {n}" for v, n in tally) for kind, tally in score.verdicts)
    lines += ["", "Verdicts by kind: " + "; ".join(tallies) + "."]
    for title, each in (("Without an answer", score.failed), ("Misses", score.misses)):
        lines += ["", f"{title}:", "", *(f"- {line}" for line in each)] if each else []
    return "\n".join(lines) + "\n"
