"""Answers and truths side by side: reading them, and when a name is right."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import beta

from benchmarks.blind.generator.cases import DOSES
from benchmarks.blind.generator.concealed import GLOBAL, UNIFORM
from benchmarks.blind.seal import check_seal, digest, half_of

Truth = Mapping[str, Any]
NAMES = frozenset({"named", "alias_class"})
ALARMS = NAMES | {"unknown"}
REFUSALS = frozenset({"none", "insufficient_data"})


@dataclass(frozen=True)
class Rate:
    """A share with its 95 % Clopper-Pearson interval (Biometrika 26 (1934), doi:10.1093/biomet/26.4.404)."""

    count: int
    total: int
    low: float
    high: float

    @property
    def share(self) -> float:
        """count / total; not a number where there is nothing."""
        return self.count / self.total if self.total else math.nan

    def shown(self, digits: int = 1) -> str:
        """95.2 % (120/126; 89.9 to 98.2), the interval to so many digits; - where there is nothing."""
        if not self.total:
            return "-"
        low, high = (f"{100 * end:.{digits}f}" for end in (self.low, self.high))
        return f"{100 * self.share:.1f} % ({self.count}/{self.total}; {low} to {high})"


def rate(hits: Iterable[bool]) -> Rate:
    """The share of true ones."""
    values = [bool(hit) for hit in hits]
    k, n = sum(values), len(values)
    low = float(beta.ppf(0.025, k, n - k + 1)) if k > 0 else 0.0
    high = float(beta.ppf(0.975, k + 1, n - k)) if k < n else 1.0
    return Rate(k, n, low, high)


@dataclass(frozen=True)
class Spread:
    """Median and 95th percentile of a figure, how many there are, and the share within the target (NaN: no target)."""

    count: int
    median: float
    upper: float
    within: float

    def shown(self) -> str:
        """Median, 95th percentile, share within the target, count; - where there is nothing."""
        if not self.count:
            return "-"
        within = "" if math.isnan(self.within) else f", {100 * self.within:.0f} % within the target"
        return f"median {self.median:.3g}, 95th percentile {self.upper:.3g}{within} ({self.count})"


def spread(values: Iterable[float], target: float | None = None) -> Spread:
    """Quantiles of values that are numbers."""
    known = np.array([v for v in values if math.isfinite(v)], dtype=float)
    if known.size == 0:
        return Spread(0, math.nan, math.nan, math.nan)
    within = math.nan if target is None else float(np.mean(known <= target))
    return Spread(known.size, float(np.median(known)), float(np.quantile(known, 0.95)), within)


Table = tuple[tuple[str, Rate], ...]
Counts = tuple[tuple[str, tuple[tuple[str, int], ...]], ...]


def by(hits: Iterable[tuple[Any, bool]]) -> Table:
    """The share of true ones for each label, the labels in their order."""
    results = list(hits)
    return tuple(
        (str(label), rate(hit for key, hit in results if key == label)) for label in sorted({k for k, _ in results})
    )


def counts(items: Iterable[tuple[str, str]]) -> Counts:
    """How often each value comes beside each label, the most frequent first."""
    table: dict[str, Counter[str]] = {}
    for key, value in items:
        table.setdefault(key, Counter())[value] += 1
    return tuple((key, tuple(count.most_common())) for key, count in sorted(table.items()))


@dataclass(frozen=True)
class Answer:
    """What the tool said of a case."""

    case: str
    status: int
    seconds: float | None
    diagnosis: Mapping[str, Any] | None

    @property
    def verdict(self) -> str:
        """The verdict; `failed` where there is none."""
        return str(self.diagnosis["verdict"]) if self.diagnosis else "failed"

    @property
    def entries(self) -> list[Mapping[str, Any]]:
        """What is said to be missing."""
        return list(self.diagnosis.get("missing") or []) if self.diagnosis else []


def dose_of(snr: float) -> float:
    """The dose nearest to a projected signal to noise, on a logarithmic scale."""
    return min(DOSES, key=lambda dose: abs(math.log(max(snr, 1e-9) / dose)))


def is_it(effect: str, at: Any, true: Mapping[str, Any]) -> bool:
    """Whether a stated effect and place are the true one; where an effect is of the whole arm, its place is free."""
    if effect != true["effect"]:
        return False
    return effect in GLOBAL or effect in UNIFORM or sorted(at or []) == sorted(true["at"])


def members(entry: Mapping[str, Any]) -> list[tuple[str, Any]]:
    """An entry's class: its name and its alternatives."""
    return [(entry["effect"], entry.get("at")), *((e, at) for e, at in entry.get("alternatives") or [])]


def in_class(entry: Mapping[str, Any], true: Mapping[str, Any]) -> bool:
    """Whether the truth is named or among the alternatives."""
    return any(is_it(effect, at, true) for effect, at in members(entry))


def all_classes_right(answer: Answer, truth: Truth) -> bool:
    """As many names as truths, each truth in the class of another name."""
    entries, true = answer.entries, list(truth["effects"])
    if answer.verdict not in NAMES or len(entries) != len(true):
        return False
    if len(true) == 1:
        return in_class(entries[0], true[0])
    straight = all(in_class(e, t) for e, t in zip(entries, true, strict=True))
    crossed = len(true) == 2 and in_class(entries[0], true[1]) and in_class(entries[1], true[0])
    return straight or crossed


def load(root: Path, answers: Path, *, partial: bool = False) -> tuple[list[Truth], dict[str, Answer], str, str]:
    """Truths and answers; the seals are checked first. Raises FileNotFoundError where answers are wanting."""
    names = sorted(path.name for path in (root / "cases").iterdir())
    missing = [name for name in names if not (answers / f"{name}.json").exists()]
    half = half_of(root)
    if missing and not (partial and half == "disclosed"):
        raise FileNotFoundError(f"{answers}: {len(missing)} of {len(names)} cases have no answer, first {missing[0]}")
    given = {}
    for name in names:
        if name in missing:
            continue
        record = json.loads((answers / f"{name}.json").read_text(encoding="utf-8"))
        given[name] = Answer(name, record["status"], record["seconds"], record["diagnosis"])
    if half == "sealed":
        whole = "\n".join(digest((answers / f"{name}.json").read_bytes()) for name in names)
        (root / "scored.txt").write_text(digest(whole.encode()) + "\n", encoding="utf-8")
    seal = check_seal(root)
    truths = [json.loads((root / "truth" / f"{name}.json").read_text(encoding="utf-8")) for name in given]
    return truths, given, half, seal
