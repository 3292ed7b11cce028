"""The least first bending frequency over the workspace."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, ClassVar

import casadi as ca
import numpy as np

from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.limits.modes import SegmentedArm, first_frequencies, first_modes, inertia_excess, segmented
from linkwright.core.arm.limits.slowest_pose import least_frequency
from linkwright.core.sections.numeric import Array

from .design import DesignExpressions
from .figure import Asked, Cut, Figure, Held, PoseFamily, ThroughPoses, Worst

if TYPE_CHECKING:
    from linkwright.core.arm.chain.chain import Arm
    from linkwright.core.arm.evaluation import Evaluation
    from linkwright.core.arm.worst.search import WorstSearch


class Modes(PoseFamily):
    """Rayleigh's quotient of trial shapes: a cut holds the payloads (kg) and the shape beside the pose."""

    name: ClassVar[str] = "modes"
    bounds_many: ClassVar[bool] = False
    # Inertia over stiffness goes with the frequency squared.
    slope: ClassVar[float] = 2.0

    def prepare(self, problem: Asked) -> tuple[Arm, SegmentedArm]:
        """The arm in segments."""
        return problem.arm, segmented(problem.arm)

    def groups(self, problem: Asked) -> int:
        """One: a cut says what is carried."""
        del problem
        return 1

    def more(self, prepared: tuple[Arm, SegmentedArm]) -> int:
        """The payload of each tip, and the shape."""
        return len(prepared[1].ways) + 3 * len(prepared[1].owner)

    def rows(
        self,
        prepared: tuple[Arm, SegmentedArm],
        group: int,
        pose: tuple[Any, Any],
        design: DesignExpressions,
        held: Held,
    ) -> Iterator[tuple[int, Any]]:
        """The shape's inertia over its stiffness at the frequency asked for."""
        del group
        arm, segments = prepared
        q, more = pose
        places, tips = [q[k] for k in range(arm.size)], len(segments.ways)
        payloads, shapes = [more[k] for k in range(tips)], [more[k] for k in range(tips, more.numel())]
        for number, value, slack in held.on(FIRST_FREQUENCY.name):
            excess = inertia_excess(arm, segments, places, design.beams, payloads, shapes, value)
            yield number, excess + 1.0 - ca.exp(2.0 * slack)

    def worst(
        self, prepared: tuple[Arm, SegmentedArm], problem: Asked, search: WorstSearch, arm: Arm, p: Array
    ) -> list[Worst]:
        """The slowest mode; none where nothing in the model gives."""
        del prepared
        beams = beams_of(arm, problem.load_cases)
        slowest = least_frequency(arm, search, beams, p, problem.load_cases)
        if slowest is None:
            return []
        payloads = arm.payloads(problem.load_cases[slowest.load_case])
        modes = first_modes(arm, beams, payloads, np.array([slowest.q]))
        cut = Cut(slowest.q, 0, (*payloads, *modes.shape[0].tolist()))
        return [Worst(FIRST_FREQUENCY.name, float(modes.frequency[0]), cut)]

    def at_cut(self, prepared: tuple[Arm, SegmentedArm], problem: Asked, arm: Arm, cut: Cut) -> float:
        """The first frequency (Hz) at the cut's pose with its payloads."""
        beams, payloads = beams_of(arm, problem.load_cases), cut.more[: len(prepared[1].ways)]
        return float(first_frequencies(arm, beams, payloads, np.array([cut.q]))[0])


def _pose(evaluation: Evaluation) -> tuple[float, ...] | None:
    return None if evaluation.frequency is None else evaluation.frequency.q


FIRST_FREQUENCY = Figure(
    name="first_frequency",
    synonyms=("frequency", "natural_frequency", "eigenfrequency", "resonance", "fundamental_frequency"),
    title="first frequency",
    kind="frequency",
    unit="Hz",
    senses=(">=",),
    key="first_frequency_Hz",
    follows=ThroughPoses(Modes()),
    of=lambda evaluation: None if evaluation.frequency is None else evaluation.frequency.value,
    more_is_better=True,
    note="least",
    where=_pose,
)
