"""How far the links are from yielding and from buckling as columns: the same statics gives both."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar

import casadi as ca
import numpy as np

from linkwright.core.arm.evaluation import strength_over
from linkwright.core.arm.limits.strength import STATIONS, StrengthCase, strength_case
from linkwright.core.sections.numeric import Array

from .design import DesignExpressions, Designs
from .figure import Asked, Cut, Figure, Held, PoseFamily, ThroughPoses, Worst

if TYPE_CHECKING:
    from linkwright.core.arm.chain.chain import Arm
    from linkwright.core.arm.worst.search import WorstSearch


POSES = 2048
"""Poses from which the worst ones are climbed to."""


class Strength(PoseFamily):
    """Stress against yield strength, and compression against Euler's load."""

    name: ClassVar[str] = "strengths"

    def prepare(self, problem: Asked) -> tuple[StrengthCase, ...]:
        """The statics of each load case."""
        return tuple(strength_case(problem.arm, load) for load in problem.load_cases)

    def rows(
        self,
        prepared: tuple[StrengthCase, ...],
        group: int,
        pose: tuple[Any, Any],
        design: DesignExpressions,
        held: Held,
    ) -> Iterator[tuple[int, Any]]:
        """Each link's share of Euler's load, and its stress at each station in logarithms."""
        case = prepared[group]
        stress, compression, _ = case.function(pose[0], design.beam_column, design.strength_column)
        for number, limit in enumerate(held.limits):
            for entry, link in enumerate(case.links):
                if limit.name == BUCKLING.name:
                    yield number, compression[entry] * limit.value - ca.exp(held.slack[number])
                elif limit.name == SAFETY_FACTOR.name:
                    material = design.materials[link]
                    assert material is not None
                    for station in range(len(STATIONS)):
                        share = stress[len(STATIONS) * entry + station] * limit.value
                        share = share / material.yield_strength
                        yield number, ca.log(share) - held.slack[number]

    def worst(
        self, prepared: tuple[StrengthCase, ...], problem: Asked, search: WorstSearch, arm: Arm, p: Array
    ) -> list[Worst]:
        """Each link's greatest stress and greatest compression."""
        del prepared
        result = strength_over(arm, problem.load_cases, search.poses(p, POSES), p, search)
        found: list[Worst] = []
        for factor, place in zip(result.safety_factor, result.poses, strict=True):
            # A material without a yield strength has no factor; a limit on it asks for one before.
            found.append(Worst(SAFETY_FACTOR.name, np.inf if factor is None else factor, Cut(*place)))
        for factor, place in zip(result.buckling, result.buckling_poses, strict=True):
            found.append(Worst(BUCKLING.name, factor, Cut(*place)))
        return found

    def at_pose(
        self, prepared: tuple[StrengthCase, ...], group: int, q: Array, designs: Designs
    ) -> Mapping[str, Array]:
        """The least factors over the links."""
        strength = prepared[group]
        stress, compression, _ = strength.vectorised(q, designs.p, designs.sections)
        greatest = np.reshape(stress, (len(q), len(strength.links), len(STATIONS))).max(axis=2)
        yields = designs.yield_strengths[:, list(strength.links)]
        with np.errstate(divide="ignore"):
            pressed = np.maximum(compression.max(axis=1), 0.0)
            buckling = np.where(pressed > 0.0, 1.0 / np.maximum(pressed, 1e-300), np.inf)
        return {
            SAFETY_FACTOR.name: (yields / np.maximum(greatest, 1e-300)).min(axis=1),
            BUCKLING.name: buckling,
        }


_STRENGTH = Strength()

SAFETY_FACTOR = Figure(
    name="safety_factor",
    synonyms=("stress", "strength", "yield", "max_stress", "safety", "factor_of_safety", "fos"),
    title="safety factor",
    senses=(">=",),
    key="min_safety_factor",
    follows=ThroughPoses(_STRENGTH),
    of=lambda evaluation: evaluation.strength.least_safety_factor,
    more_is_better=True,
    note="least, against yield",
    needs=("yield_strength",),
)
BUCKLING = Figure(
    name="buckling",
    synonyms=("critical_load", "column_buckling", "euler"),
    title="buckling",
    senses=(">=",),
    key="min_buckling",
    follows=ThroughPoses(_STRENGTH),
    of=lambda evaluation: evaluation.strength.least_buckling,
    more_is_better=True,
    note="least, Euler's load over the compression",
    # Where nothing presses it is infinite, which no axis can show.
    traded=False,
)
