"""The score of the second proof: from truths and answers to targets, tables, the three figures and a list of misses.

The three figures are those that arXiv:2606.23215 is quoted for, defined here for a recording: the bias of parameters
that are rightly named, F1 of localisation by joint, by time and by region (the covariates on which the
mismatch is said to depend), and the share of false ones among all discoveries.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from benchmarks.blind.answers import (
    ALARMS,
    NAMES,
    Answer,
    Rate,
    Spread,
    Table,
    Truth,
    by,
    counts,
    in_class,
    is_it,
    rate,
    spread,
)
from benchmarks.blind.parameters import TRANSLATED, UNITS, coverage
from benchmarks.multibody.cases import DOSES
from benchmarks.multibody.sizes import impossible

Row = tuple[Truth, Answer]
Caused = tuple[Truth, Answer, Mapping[str, Any]]
LOUD = 0.9
"""The signal to noise from which on a cause is to be named."""


@dataclass(frozen=True)
class Harmonic:
    """The harmonic mean of precision (hits of what is claimed) and recall (hits of what is true), over all cases."""

    hits: int
    claimed: int
    true: int

    @property
    def f1(self) -> float:
        """2 hits / (claimed + true)."""
        return 2 * self.hits / (self.claimed + self.true) if self.claimed + self.true else math.nan


@dataclass(frozen=True)
class Target:
    """A figure to be reached: what, how much, what came of it, whether that is it (None: nothing to judge)."""

    what: str
    wanted: str
    reached: Rate | Spread
    met: bool | None


@dataclass(frozen=True)
class Score:
    """All figures of what was run."""

    half: str
    seal: str
    seeds: tuple[int, ...]
    remounted: Rate
    cases: tuple[tuple[str, int], ...]
    failed: tuple[str, ...]
    targets: tuple[Target, ...]
    tables: tuple[tuple[str, Table], ...]
    bias: Spread
    bias_by_parameter: tuple[tuple[str, Spread], ...]
    localised: tuple[tuple[str, Harmonic], ...]
    false_discoveries: Rate
    verdicts: tuple[tuple[str, tuple[tuple[str, int], ...]], ...]
    impossible: tuple[str, ...]
    seconds: Spread
    misses: tuple[str, ...]


def score(truths: Sequence[Truth], answers: Mapping[str, Answer], half: str = "", seal: str = "") -> Score:
    """All figures, from truths and answers alone."""
    rows: list[Row] = [(truth, answers[truth["case"]]) for truth in truths]
    errors = _relative_errors(rows)
    return Score(
        half=half,
        seal=seal,
        seeds=tuple(sorted({int(t["seed"][0]) for t in truths})),
        remounted=rate(a.verdict != "failed" for t, a in rows if t["mounts"] > 1),
        cases=tuple(sorted(Counter(t["kind"] for t, _ in rows).items())),
        failed=tuple(t["case"] for t, a in rows if a.verdict == "failed" and t["kind"] != "mislabelled"),
        targets=_targets(rows),
        tables=(*_tables_of_names(rows), *_other_tables(rows)),
        bias=spread(size for sizes in errors.values() for size in sizes),
        bias_by_parameter=tuple((name, spread(sizes)) for name, sizes in sorted(errors.items())),
        localised=(("joint", _joints(rows)), ("time", _times(rows)), ("region", _regions(of_kind(rows, "unknown")))),
        false_discoveries=rate(_false_names(rows)),
        verdicts=counts((t["kind"], _verdict(t, a)) for t, a in rows),
        impossible=tuple(f"{t['case']}: {sentence}" for t, a in rows for sentence in _impossible(t, a)),
        seconds=spread(a.seconds for _, a in rows if a.seconds is not None),
        misses=tuple(line for t, a in rows if (line := _miss(t, a))),
    )


def of_kind(rows: Sequence[tuple[Truth, Answer]], *names: str) -> list[tuple[Truth, Answer]]:
    """The cases of some kinds, with their answers."""
    return [(t, a) for t, a in rows if t["kind"] in names]


def _loud(rows: Sequence[Row]) -> list[Caused]:
    """Large causes from `LOUD` on, each with its case and the answer."""
    large = ((t, a, e) for t, a in of_kind(rows, "many", "pair") for e in t["effects"] if e["large"])
    return [(t, a, e) for t, a, e in large if e["snr"] >= LOUD]


def _covered(rows: Sequence[Row]) -> list[tuple[str, bool]]:
    """Whether each interval of what is rightly named holds the truth, by effect and parameter."""
    return [
        (f"{e['effect']} {name}", inside)
        for t, a in rows
        for e, entry in _named(t, a)
        for name, inside in coverage(entry, e)
    ]


def _relative_errors(rows: Sequence[Row]) -> dict[str, list[float]]:
    """The relative errors of what is rightly named, by effect and parameter."""
    relative_errors: dict[str, list[float]] = {}
    for t, a in rows:
        for true, entry in _named(t, a):
            for name, error in _errors(entry, true):
                relative_errors.setdefault(name, []).append(error)
    return relative_errors


def _false_names(rows: Sequence[Row]) -> list[bool]:
    """Whether each name given is that of no cause."""
    return [not _true_one(t, entry) for t, a in rows if a.verdict in NAMES for entry in a.entries]


def _targets(rows: Sequence[Row]) -> tuple[Target, ...]:
    nulls, unknowns, mislabelled = of_kind(rows, "null"), of_kind(rows, "unknown"), of_kind(rows, "mislabelled")
    ratio = spread((_written(t, a) for t, a in of_kind(rows, "many", "pair", "power", "null")), 1.1)
    said = [(t, a) for t, a in rows if a.entries]
    return (
        at_most("false alarms on nulls", 0.01, rate(a.verdict in ALARMS for _, a in nulls)),
        at_least("large causes named, from 0.9 on", 0.95, rate(_right(a, e) for _, a, e in _loud(rows))),
        at_least(
            "of those the cause's own name comes first",
            0.90,
            rate(_first(a, e) for _, a, e in _loud(rows) if _right(a, e)),
        ),
        at_most("names that are of no cause", 0.04, rate(_false_names(rows))),
        at_least("unknown classes called unknown", 0.92, rate(a.verdict == "unknown" for _, a in unknowns)),
        at_most("unknown classes given a name", 0.03, rate(a.verdict in NAMES for _, a in unknowns)),
        at_most("answers with an impossible size", 0.0, rate(bool(_impossible(t, a)) for t, a in said)),
        Target(
            "written file's RMS over the oracle's",
            "median <= 1.1",
            ratio,
            None if not ratio.count else ratio.median <= 1.1,
        ),
        within("95 % intervals that hold the truth", 0.93, 0.97, rate(inside for _, inside in _covered(rows))),
        at_most("mislabelled columns given a cause's name", 0.0, rate(a.verdict in NAMES for _, a in mislabelled)),
    )


def _tables_of_names(rows: Sequence[Row]) -> tuple[tuple[str, Table], ...]:
    power, loud = of_kind(rows, "power"), _loud(rows)
    dosed = [(f"{d:g}", [(t, a) for t, a in power if t["dose"] == d]) for d in DOSES]
    return (
        (
            "one cause named, by dose",
            tuple((dose, rate(_right(a, t["effects"][0]) for t, a in at)) for dose, at in dosed),
        ),
        ("anything said, by dose", tuple((dose, rate(a.verdict in ALARMS for _, a in at)) for dose, at in dosed)),
        (
            "large causes named among small ones and in pairs, by kind",
            by((t["kind"], _right(a, e)) for t, a, e in loud),
        ),
        ("large causes named, by effect", by((e["effect"], _right(a, e)) for _, a, e in loud)),
        ("large causes named, by arm", by((t["arm"], _right(a, e)) for t, a, e in loud)),
        ("large causes named, by recording", by((_recording(t), _right(a, e)) for t, a, e in loud)),
        ("large causes named or listed as part of an unknown", by((t["kind"], _listed(a, e)) for t, a, e in loud)),
        (
            "large causes named, or said to be in a size of what is named",
            by((t["kind"], _right(a, e) or _in_a_size(a, e)) for t, a, e in loud),
        ),
    )


def _other_tables(rows: Sequence[Row]) -> tuple[tuple[str, Table], ...]:
    nulls, unknowns, mislabelled = of_kind(rows, "null"), of_kind(rows, "unknown"), of_kind(rows, "mislabelled")
    small = [(t, a, e) for t, a in of_kind(rows, "many") for e in t["effects"] if not e["large"]]
    wandering = [(t, a) for t, a in nulls if t["vice"] == "wander" and a.verdict in ALARMS]
    return (
        ("95 % intervals that hold the truth, by parameter", by(_covered(rows))),
        ("small causes named (0.1 to 0.5)", by((e["effect"], _right(a, e)) for _, a, e in small)),
        ("unknown classes called unknown", by((t["unknown"]["class"], a.verdict == "unknown") for t, a in unknowns)),
        ("unknown classes given a name", by((t["unknown"]["class"], a.verdict in NAMES) for t, a in unknowns)),
        ("false alarms on nulls, by vice", by((t["vice"], a.verdict in ALARMS) for t, a in nulls)),
        (
            "of these, said to be of time, where the tracker wanders",
            by((t["vice"], _of_time(a)) for t, a in wandering),
        ),
        ("false alarms on nulls, by arm", by((t["arm"], a.verdict in ALARMS) for t, a in nulls)),
        (
            "mislabelled columns refused or told",
            by((t["mislabelled"], _told(a)) for t, a in mislabelled),
        ),
    )


def at_most(what: str, most: float, reached: Rate) -> Target:
    """A share that is to be no greater."""
    return Target(what, f"<= {100 * most:g} %", reached, None if not reached.total else reached.share <= most)


def at_least(what: str, least: float, reached: Rate) -> Target:
    """A share that is to be no less."""
    return Target(what, f">= {100 * least:g} %", reached, None if not reached.total else reached.share >= least)


def within(what: str, least: float, most: float, reached: Rate) -> Target:
    """A share that is to lie between."""
    met = None if not reached.total else least <= reached.share <= most
    return Target(what, f"{100 * least:g} to {100 * most:g} %", reached, met)


def target_table(targets: Sequence[Target]) -> list[str]:
    """Each target beside what was reached, as lines of Markdown."""
    lines = ["| | target | reached |", "|---|---|---|"]
    for target in targets:
        reached = target.reached.shown(0) if isinstance(target.reached, Rate) else target.reached.shown()
        verdict = "**MISSED** " if target.met is False else ""
        lines.append(f"| {target.what} | {target.wanted} | {verdict}{reached} |")
    return lines


def _verdict(t: Truth, a: Answer) -> str:
    refused = t["kind"] == "mislabelled" and a.verdict == "failed" and a.status == 2
    return "refused" if refused else a.verdict


def _recording(t: Truth) -> str:
    return f"{t['design']}{', remounted' if t['mounts'] > 1 else ''}, frame {t['frame']}, tool {t['tool']}"


def _right(a: Answer, true: Mapping[str, Any]) -> bool:
    """Whether a cause is named, or declared an alternative to a name."""
    return a.verdict in NAMES and any(in_class(entry, true) for entry in a.entries)


def _first(a: Answer, true: Mapping[str, Any]) -> bool:
    """Whether a cause's own name heads a finding, and is no alternative to another."""
    return a.verdict in NAMES and any(is_it(entry["effect"], entry.get("at"), true) for entry in a.entries)


def _in_a_size(a: Answer, true: Mapping[str, Any]) -> bool:
    """Whether a size of what is named at its place is said to hold a part of a cause: nothing recorded parts them."""
    return a.verdict in NAMES and any(
        is_it(str(size.get("may_hold")), entry.get("at"), true)
        for entry in a.entries
        for size in (entry.get("parameters") or {}).values()
    )


def _listed(a: Answer, true: Mapping[str, Any]) -> bool:
    return any(in_class(entry, true) for entry in a.entries)


def _named(t: Truth, a: Answer) -> list[tuple[Mapping[str, Any], Mapping[str, Any]]]:
    """True causes that are named themselves, each with its entry."""
    if a.verdict not in NAMES:
        return []
    pairs = [(e, entry) for e in t["effects"] for entry in a.entries]
    return [(e, entry) for e, entry in pairs if is_it(entry["effect"], entry.get("at"), e)]


def _true_one(t: Truth, entry: Mapping[str, Any]) -> bool:
    return any(in_class(entry, e) for e in t["effects"])


def _written(t: Truth, a: Answer) -> float:
    value = (a.diagnosis or {}).get("written_arm_rms_mm")
    return math.nan if value is None else float(value) / t["oracle_rms_mm"]


def _impossible(t: Truth, a: Answer) -> list[str]:
    return [sentence for entry in a.entries for sentence in impossible(entry, t["file"])]


def _of_time(a: Answer) -> bool:
    """Whether all that is said is of time: the frame's drift, or an unknown that depends on time alone."""
    where = (a.diagnosis or {}).get("where") or {}
    if a.verdict in NAMES:
        return all(entry["effect"] == "frame_drift" for entry in a.entries)
    return list(where.get("depends_on") or []) == ["time"]


def _told(a: Answer) -> bool:
    """Refused with a line of its own, or neither named nor passed as sound."""
    return a.status == 2 or a.verdict not in {*NAMES, "none", "failed"}


def _errors(entry: Mapping[str, Any], true: Mapping[str, Any]) -> list[tuple[str, float]]:
    """Signed relative errors of stated values, by parameter; components that are a tenth and less of the largest of
    their effect are left out, since nothing is relative to them."""
    errors = []
    words = TRANSLATED.get(true["effect"], {})
    for name, stated in (entry.get("parameters") or {}).items():
        base = name.rstrip("0123456789").rstrip("_")
        for true_name, value in true["parameters"].items():
            own = true_name.rstrip("0123456789").rstrip("_")
            if own != base:
                continue
            one, two = UNITS.get(stated.get("unit") or ""), UNITS.get(words.get(own, (own, value["unit"], 1.0))[1])
            alike = [abs(v["value"]) for v in true["parameters"].values() if v["unit"] == value["unit"]]
            if one is None or two is None or one[0] != two[0] or stated.get("value") is None:
                continue
            if abs(value["value"]) <= 0.1 * max(alike) or not value["value"]:
                continue
            truth = value["value"] * two[1]
            errors.append((f"{true['effect']} {own}", float(stated["value"]) * one[1] / truth - 1.0))
    return errors


def _claimed_joints(a: Answer) -> set[int]:
    """The joints or links that an answer points at: those of its names, or of an unknown the one it says."""
    if a.verdict in NAMES:
        return {int(i) for entry in a.entries for i in entry.get("at") or [] if len(entry.get("at") or []) == 1}
    joint = ((a.diagnosis or {}).get("where") or {}).get("joint")
    return {int(joint)} if a.verdict == "unknown" and isinstance(joint, int) else set()


def _joints(rows: Sequence[Row]) -> Harmonic:
    """Joints of unknowns and of large causes from 0.9 on are to be found; any other cause's are no false ones."""
    hits = claimed = true = 0
    for t, a in rows:
        if t["kind"] == "mislabelled":
            continue
        wanted = {i for e in t["effects"] if e["large"] and e["snr"] >= LOUD for i in e["at"]}
        wanted |= set((t["unknown"] or {}).get("joints", []))
        small = {i for e in t["effects"] for i in e["at"]}
        said = _claimed_joints(a)
        hits, claimed, true = hits + len(said & wanted), claimed + len(said - (small - wanted)), true + len(wanted)
    return Harmonic(hits, claimed, true)


def _times(rows: Sequence[Row]) -> Harmonic:
    """A moment since which something is so: right within a tenth of the recording of a true beginning or end."""
    hits = claimed = true = 0
    for t, a in rows:
        since = ((a.diagnosis or {}).get("where") or {}).get("since_s")
        moments = [
            m for m in ((t["unknown"] or {}).get("since_s"), (t["unknown"] or {}).get("until_s")) if m is not None
        ]
        claimed += since is not None
        true += bool(moments)
        hits += since is not None and any(abs(float(since) - m) <= 0.1 * t["duration_s"] for m in moments)
    return Harmonic(hits, claimed, true)


def _regions(rows: Sequence[Row]) -> Harmonic:
    """What an unknown is said to depend on against what it does."""
    hits = claimed = true = 0
    for t, a in rows:
        wanted = set(t["unknown"]["depends_on"])
        where = (a.diagnosis or {}).get("where") or {}
        said = set(where.get("depends_on") or []) if a.verdict == "unknown" else set()
        hits, claimed, true = hits + len(said & wanted), claimed + len(said), true + len(wanted)
    return Harmonic(hits, claimed, true)


def _miss(t: Truth, a: Answer) -> str:
    """A line for a case that is not answered as it should be; empty where it is."""
    said = a.verdict + (": " + ", ".join(entry_text(e) for e in a.entries) if a.entries else "")
    about = f"{t['case']} ({t['kind']}, {t['arm']}, {_recording(t)}, {t['rows']} rows): "
    if a.verdict == "failed" and t["kind"] != "mislabelled":
        return f"{about}no answer"
    wrong = _wrong(t, a)
    return "" if wrong is None else f"{about}{wrong}; said {said}"


def _wrong(t: Truth, a: Answer) -> str | None:
    """What is true of a case that is not answered as it should be; None where it is."""
    if t["kind"] == "mislabelled":
        return t["mislabelled"] if a.verdict in NAMES else None
    if t["kind"] == "null":
        return t["vice"] if a.verdict in ALARMS else None
    if t["kind"] == "unknown":
        return None if a.verdict == "unknown" else t["unknown"]["class"]
    lost = any(e["large"] and e["snr"] >= LOUD and not _right(a, e) for e in t["effects"])
    false = a.verdict in NAMES and any(not _true_one(t, entry) for entry in a.entries)
    large = [f"{e['effect']} {e['at']} at {e['snr']:.1f}" for e in t["effects"] if e["large"]]
    return ", ".join(large) if lost or false else None


def entry_text(entry: Mapping[str, Any]) -> str:
    """A name with its place."""
    return f"{entry['effect']} {entry.get('at') or ''}".strip()
