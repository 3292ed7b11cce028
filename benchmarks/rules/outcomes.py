"""What came of perturbing the rules: a report in full, and the short of it for the page."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Mapping
from dataclasses import asdict, dataclass

from benchmarks.rules.judge import Told, harm, moves


@dataclass(frozen=True)
class Outcome:
    """Of one rule: diagnoses made, what moved (a line each), and how many right answers became wrong."""

    diagnoses: int = 0
    moved: tuple[str, ...] = ()
    turned_wrong: int = 0

    def and_one(self, what: str, before: Told, after: Told) -> Outcome:
        """With one more diagnosis; `what` says which."""
        found, turned = moves(before, after), harm(before, after)
        mended = " (mended)" if after.right and not before.right else ""
        said = " **turned wrong**" if turned else mended
        lines = (*self.moved, f"- {what}: {'; '.join(found)}{said}") if found else self.moved
        return Outcome(self.diagnoses + 1, lines, self.turned_wrong + turned)


@dataclass(frozen=True)
class Run:
    """What was asked: seed and number of the recordings, how many of them for a rule at most, the rules, and how many
    of the rules any of the recordings consults."""

    seed: int
    cases: int
    recordings: int
    rules: int
    consulted: int


@dataclass(frozen=True)
class Found:
    """The short of a run: how many rules of each stage were tried, diagnoses, and the rules that moved something with
    how often (moved, turned wrong)."""

    run: Run
    tried: Mapping[str, int]
    diagnoses: int
    moved: Mapping[str, tuple[int, int]]


def report(outcomes: Mapping[str, Outcome]) -> str:
    """What moved, rule by rule; those that turned a right answer wrong first."""
    out = ["# What moves when a rule does", ""]
    for path, each in sorted(outcomes.items(), key=lambda item: (-item[1].turned_wrong, -len(item[1].moved), item[0])):
        state = f"{each.diagnoses} diagnoses, {len(each.moved)} moved, {each.turned_wrong} turned wrong"
        out += [f"## {path}", "", state if each.diagnoses else "tried on none of these recordings", "", *each.moved, ""]
    diagnoses = sum(each.diagnoses for each in outcomes.values())
    moved, turned = sum(len(each.moved) for each in outcomes.values()), sum(e.turned_wrong for e in outcomes.values())
    out.append(f"In all: {diagnoses} diagnoses, {moved} moved, {turned} turned wrong.")
    return "\n".join(out) + "\n"


def as_json(run: Run, outcomes: Mapping[str, Outcome]) -> str:
    """The short of a run, to be kept."""
    stages = Counter(path.partition(".")[0] for path, each in outcomes.items() if each.diagnoses)
    content = {
        "run": asdict(run),
        "tried": dict(stages),
        "diagnoses": sum(each.diagnoses for each in outcomes.values()),
        "moved": {path: [len(o.moved), o.turned_wrong] for path, o in sorted(outcomes.items()) if o.moved},
    }
    return json.dumps(content, indent=1) + "\n"


def from_json(text: str) -> Found:
    """What `as_json` wrote."""
    held = json.loads(text)
    moved = {path: (int(each[0]), int(each[1])) for path, each in held["moved"].items()}
    return Found(
        Run(**held["run"]), {stage: int(each) for stage, each in held["tried"].items()}, int(held["diagnoses"]), moved
    )
