"""The least stiffness at the tip, in the workspace or at given poses.

A limit holds through cuts, each a pose with a direction u of the force: |C u| is at most the largest singular value
of the compliance C, whatever u, and equals it where u is its own direction. So every cut is valid for every design,
smooth, and exact where it was made.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import casadi as ca
import numpy as np

from linkwright.core.arm.errors.model import beam_values, beams_of
from linkwright.core.arm.limits.tip_stiffness import (
    TipCompliance,
    least_stiffness,
    stiffness_at,
    stiffnesses,
    tip_compliance,
    tips_of,
)
from linkwright.core.sections.numeric import Array

from .design import DesignExpressions, Designs
from .figure import Asked, Cut, Figure, Held, Limit, PoseFamily, ThroughPoses, Worst
from .strength import POSES

if TYPE_CHECKING:
    from linkwright.core.arm.chain.chain import Arm, LoadCase
    from linkwright.core.arm.evaluation import Evaluation
    from linkwright.core.arm.worst.search import WorstSearch


_LEAST = 1e-24
"""Keeps the logarithm of a compliance of nothing finite."""


@dataclass(frozen=True)
class PreparedStiffness:
    """The compliance, and the numbers of the problem's limits on it: each has a group of poses of its own."""

    compliance: TipCompliance
    limits: tuple[int, ...]


class Stiffness(PoseFamily):
    """The compliance under a force of some direction: a cut holds the direction beside the pose."""

    name: ClassVar[str] = "stiffness"
    limited: ClassVar[str] = "tip_stiffness"
    """The figure's name."""

    def compliance(self, problem: Asked) -> TipCompliance:
        """The compliance of the problem's arm."""
        return _compliance(problem.arm, problem.load_cases)

    def prepare(self, problem: Asked) -> PreparedStiffness:
        """The compliance, and the numbers of the limits on it."""
        numbers = tuple(k for k, limit in enumerate(problem.limits) if limit.name == self.limited)
        return PreparedStiffness(self.compliance(problem), numbers)

    def groups(self, problem: Asked) -> int:
        """One for each limit, as each may have poses of its own."""
        return sum(limit.name == self.limited for limit in problem.limits)

    def more(self, prepared: PreparedStiffness) -> int:
        """The direction of the force."""
        return prepared.compliance.size

    def load_case(self, cut: Cut) -> int:
        """Any: what the arm carries does not change what gives."""
        del cut
        return 0

    def rows(
        self, prepared: PreparedStiffness, group: int, pose: tuple[Any, Any], design: DesignExpressions, held: Held
    ) -> Iterator[tuple[int, Any]]:
        """The compliance over what is allowed, in its logarithm."""
        q, force = pose
        size, number = prepared.compliance.size, prepared.limits[group]
        columns = ca.reshape(prepared.compliance.function(q, design.beam_column), size, size)
        moved = ca.mtimes(columns, force) * held.limits[number].value
        yield number, 0.5 * ca.log(ca.dot(moved, moved) + _LEAST) - held.slack[number]

    def worst(
        self, prepared: PreparedStiffness, problem: Asked, search: WorstSearch, arm: Arm, p: Array
    ) -> list[Worst]:
        """The softest pose of the workspace, or each of the poses that a limit names."""
        del arm
        found: list[Worst] = []
        for group, number in enumerate(prepared.limits):
            poses = problem.limits[number].poses
            if poses is None:
                softest = least_stiffness(prepared.compliance, search.poses(p, POSES), p, search)
                own = [] if softest is None else [softest]
            else:
                own = stiffness_at(prepared.compliance, np.array(poses), p)
            cuts = [(each.value, Cut(each.q, group, each.direction)) for each in own]
            found += [Worst(self.limited, value, cut, number) for value, cut in cuts]
        return found

    def at_pose(self, prepared: PreparedStiffness, group: int, q: Array, designs: Designs) -> Mapping[str, Array]:
        """The stiffness of each design at its pose."""
        del group
        return {self.limited: stiffnesses(prepared.compliance.matrices(q, designs.p))}

    def exactly(self, prepared: PreparedStiffness, limit: Limit, designs: Designs) -> Array | None:
        """The least stiffness of each design at the poses that the limit names."""
        if limit.poses is None:
            return None
        places = [np.tile(np.array(q), (len(designs.p), 1)) for q in limit.poses]
        return np.min([stiffnesses(prepared.compliance.matrices(q, designs.p)) for q in places], axis=0)


def _compliance(arm: Arm, cases: Sequence[LoadCase]) -> TipCompliance:
    """The compliance at the tips that load cases name; where all is planar, in its plane."""
    planar = all(arm.on(load.tip).planar(load) for load in cases)
    return tip_compliance(arm, planar=planar, tips=tips_of(cases))


def _at_poses(evaluation: Evaluation, poses: Sequence[tuple[float, ...]]) -> float | None:
    p = beam_values(beams_of(evaluation.arm, evaluation.load_cases))
    found = least_stiffness(_compliance(evaluation.arm, evaluation.load_cases), poses, p)
    return None if found is None else found.value


TIP_STIFFNESS = Figure(
    name="tip_stiffness",
    synonyms=("stiffness", "compliance"),
    title="tip stiffness",
    kind="linear_stiffness",
    unit="N/mm",
    factor=1e-3,
    senses=(">=",),
    key="tip_stiffness_N_per_mm",
    follows=ThroughPoses(Stiffness()),
    of=lambda evaluation: None if evaluation.stiffness is None else evaluation.stiffness.value,
    more_is_better=True,
    note="least",
    where=lambda evaluation: None if evaluation.stiffness is None else evaluation.stiffness.q,
    at_poses=_at_poses,
)
