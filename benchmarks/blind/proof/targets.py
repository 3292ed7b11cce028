"""The targets beside what was reached; a miss is a miss, with its cause where somebody wrote it down."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import yaml

from benchmarks.blind.answers import Rate, Spread
from benchmarks.blind.proof.figures import TOOL, Figures
from benchmarks.blind.proof.halves import Half

CAUSES = Path(__file__).with_name("causes.yaml")
_HELD_OUT = 1.05


@dataclass(frozen=True)
class Target:
    """What was to be reached: a share at least or at most (in the order of `wanted`), or a median at most."""

    key: str
    what: str
    wanted: str
    reached: Callable[[Half, Figures], Rate | Spread | float]
    low: float = -math.inf
    high: float = math.inf
    pooled: bool = False

    def met(self, both: Sequence[tuple[Half, Figures]], number: int) -> bool | None:
        """Whether the half of this number meets it (`pooled`: whether all together do); None where there is nothing to
        judge by."""
        chosen = both if self.pooled else [both[number]]
        value = sum(figure_of(self.reached(half, found)) for half, found in chosen)
        return None if math.isnan(value) else self.low <= value <= self.high


def figure_of(value: Rate | Spread | float) -> float:
    """The one figure that a target judges: a share, a median, or the number itself."""
    if isinstance(value, Rate):
        return value.share
    return value.median if isinstance(value, Spread) else value


def _at(table: str, dose: float) -> Callable[[Half, Figures], Rate]:
    def reached(half: Half, _: Figures) -> Rate:
        result: Mapping[str, Rate] = dict(getattr(half.score, table))
        return result.get(str(dose), Rate(0, 0, math.nan, math.nan))

    return reached


def _of(name: str) -> Callable[[Half, Figures], Rate | Spread]:
    return lambda half, _: getattr(half.score, name)


def _region(number: int) -> Callable[[Half, Figures], Spread]:
    def reached(_: Half, figures: Figures) -> Spread:
        own = [prediction for prediction in figures.predictions if prediction.way == TOOL]
        return own[0].whole[number] if own else Spread(0, math.nan, math.nan, math.nan)

    return reached


TARGETS = (
    Target(
        "nulls",
        "recordings of nothing, both halves together",
        ">= 600",
        lambda half, _: float(half.score.false_alarms.total),
        low=600.0,
        pooled=True,
    ),
    Target("false_alarms", "false alarms", "<= 1 %", _of("false_alarms"), high=0.01),
    Target("false_alarms_hostile", "false alarms, hostile", "<= 2 %", _of("false_alarms_hostile"), high=0.02),
    Target("class_at_half", "class named at signal to noise 0.5", ">= 90 %", _at("class_by_dose", 0.5), low=0.9),
    Target("class_at_one", "class named at 1", ">= 95 %", _at("class_by_dose", 1.0), low=0.95),
    Target("class_at_two", "class named at 2", ">= 99 %", _at("class_by_dose", 2.0), low=0.99),
    Target("pairs", "pairs exact, the weaker from 1 on", ">= 88 %", _of("pairs_by_weaker"), low=0.88),
    Target("unknown", "unknown physics called unknown, from 1 on", ">= 95 %", _of("unknown_recall"), low=0.95),
    Target("closure", "unknown physics given a name, from 1 on", "<= 3 %", _of("wrong_closure"), high=0.03),
    Target(
        "unknown_beyond",
        "unknown physics called unknown, 1 and more of it beyond any three of the library",
        ">= 95 %",
        _of("unknown_recall_beyond_library"),
        low=0.95,
    ),
    Target(
        "closure_beyond",
        "the same given a name",
        "<= 3 %",
        _of("wrong_closure_beyond_library"),
        high=0.03,
    ),
    Target("coverage", "95 % intervals that hold the truth", "93 to 97 %", _of("coverage"), low=0.93, high=0.97),
    Target("held_out", "held-out RMS over the true noise, by the tool", "<= 1.05", _of("held_out_over_true_noise"),
           high=_HELD_OUT),
    Target("inside", "RMS over the noise at new poses inside", "<= 1.05", _region(0), high=_HELD_OUT),
    Target("outside", "the same outside", "<= 1.05", _region(1), high=_HELD_OUT),
    Target("payload", "the same under an unseen payload", "<= 1.05", _region(2), high=_HELD_OUT),
    Target("refused", "the invisible refused", "100 %", _of("refused"), low=1.0),
    Target("aliases", "exact aliases declared", "100 %", _of("aliases_declared"), low=1.0),
)  # fmt: skip


@dataclass(frozen=True)
class Cause:
    """What is known of a miss: why, and what was reached before the method was improved (may be empty)."""

    why: str
    before: str


def causes(path: Path = CAUSES) -> Mapping[str, Cause]:
    """The written causes by target. Raises ValueError for a target that nobody knows."""
    content: dict[str, dict[str, Any]] = yaml.safe_load(path.read_text(encoding="utf-8")) or {}
    strange = sorted(set(content) - {target.key for target in TARGETS})
    if strange:
        raise ValueError(f"{path.name}: no such target: {', '.join(strange)}")
    return MappingProxyType(
        {key: Cause(str(item.get("why") or ""), str(item.get("before") or "")) for key, item in content.items()}
    )
