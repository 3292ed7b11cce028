"""What differs between motion logs that are diagnosed together: each log's entries, and what they are told as."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array

from .events.changed import sized
from .findings import finding_of_group
from .model.candidates import Candidates
from .model.entries import entries_of, with_entries
from .model.products import products
from .model.rows import LogRows, joint_rows, log_rows
from .model.steps import Difference, Step, differences
from .result import Alternative, MotionFinding


@dataclass(frozen=True)
class Differing:
    """Logs about arms of their own: `rows` with the entries that hold in each log alone, `differences` what those are,
    and `beyond` (n,) N*m, the RMS of what else may differ (empty: one log)."""

    rows: tuple[LogRows, ...]
    differences: tuple[Difference, ...] = ()
    beyond: tuple[float, ...] = ()

    @property
    def steps(self) -> tuple[Step, ...]:
        """What steps between the logs."""
        return tuple(item.step for item in self.differences)

    def sizes(self, number: int, width: int) -> Array:
        """The sizes (width,) of the model's columns that a log (its number) has of its own."""
        sizes = np.zeros(width)
        for step in self.steps:
            if step.parts[number]:
                sizes[step.group.columns] += step.group.values(step.numbers)
        return sizes


def differing(arm: Arm, pool: Candidates, rows: Sequence[LogRows], *, rules: Rules) -> Differing:
    """Each log's rows, about an arm that has what differs in that log."""
    if len(rows) < 2:
        return Differing(tuple(rows))
    known, made = tuple[Difference, ...](), list(rows)
    while True:
        blocks = products(joint_rows(made), pool.width, near=False)
        lacking, beyond = differences(pool, blocks, known, rules=rules)
        before = [item.step.numbers for item in known] + [np.zeros(1)] * (len(lacking) - len(known))
        more = [
            replace(item, step=replace(item.step, numbers=had + item.step.numbers))
            for item, had in zip(lacking, before, strict=True)
        ]
        made = [_about(arm, pool, row, number, more, rules) for number, row in enumerate(rows)]
        if len(more) == len(known):
            return Differing(tuple(made), tuple(more), tuple(beyond.tolist()))
        known = tuple(more)


def _about(
    arm: Arm, pool: Candidates, row: LogRows, number: int, differences: Sequence[Difference], rules: Rules
) -> LogRows:
    """A log's rows about the arm with what the log (its number) alone has."""
    steps = [item.step for item in differences if item.step.parts[number]]
    entries = tuple(entry for step in steps for entry in entries_of(step.group, step.numbers))
    motion = replace(row.prepared.motion, arm=with_entries(arm, entries))
    return log_rows(replace(row.prepared, motion=motion, entries=entries), pool, rules=rules) if entries else row


def differing_findings(item: Differing, pool: Candidates, *, rules: Rules) -> tuple[MotionFinding, ...]:
    """What differs as findings, each with the logs in which alone it acts.

    The p-value is Markov's: by chance a motion is e^g times likelier, the choice paid for, at most once in e^g times
    (G. Shafer et al., Statist. Sci. 26 (2011) 84-101, doi:10.1214/10-STS347).
    """
    made: list[MotionFinding] = []
    for difference in item.differences:
        step = difference.step
        there = [row for row, present in zip(item.rows, step.parts.tolist(), strict=True) if present]
        made.append(
            finding_of_group(
                step.group,
                step.numbers,
                products(joint_rows(there), pool.width, near=False),
                sized(step, there[0], rules=rules),
                tuple(Alternative(((other.effect.id, other.at),), worse) for other, worse in difference.alternatives),
                difference.left,
                step.gain,
                math.exp(-difference.paid),
                " and ".join(Path(row.prepared.log.file).name for row in there),
            )
        )
    return tuple(made)


def squares_of(rows: Sequence[LogRows], width: int) -> Array:
    """Sums of squares (B, n) of the torque that the model as given leaves, by block."""
    return products(joint_rows(rows), width, near=False).left(np.zeros(width))
