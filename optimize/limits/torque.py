"""What share of its actuator's rated torque a drive has to hold."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import casadi as ca
import numpy as np

from linkwright.core.arm.compiled.expressions import Expressions
from linkwright.core.arm.limits.drive_loads import drive_case, greatest_drive_loads, rated_torques
from linkwright.core.sections.numeric import Array

from .design import DesignExpressions, Designs
from .figure import Asked, Cut, Figure, Held, PoseFamily, ThroughPoses, Worst
from .strength import POSES

if TYPE_CHECKING:
    from linkwright.core.arm.chain.chain import Arm
    from linkwright.core.arm.worst.search import WorstSearch


@dataclass(frozen=True)
class _Drives:
    cases: tuple[Expressions, ...]
    rated: tuple[float | None, ...]


class Torques(PoseFamily):
    """The loads on the drives, to either side, against the rated torques of their actuators."""

    name: ClassVar[str] = "torques"

    def prepare(self, problem: Asked) -> _Drives:
        """The statics of each load case, and the rated torques."""
        return _Drives(tuple(drive_case(problem.arm, load) for load in problem.load_cases), rated_torques(problem.arm))

    def rows(
        self, prepared: _Drives, group: int, pose: tuple[Any, Any], design: DesignExpressions, held: Held
    ) -> Iterator[tuple[int, Any]]:
        """The load over what is allowed, either way."""
        loads = prepared.cases[group].function(pose[0], design.beam_column)
        for number, value, slack in held.on(TORQUE_USE.name):
            for joint, torque in enumerate(prepared.rated):
                if torque is not None:
                    use = loads[joint] / (torque * value)
                    yield number, use - ca.exp(slack)
                    yield number, -use - ca.exp(slack)

    def worst(self, prepared: _Drives, problem: Asked, search: WorstSearch, arm: Arm, p: Array) -> list[Worst]:
        """Each drive's greatest use."""
        del arm
        found = greatest_drive_loads(problem.arm, prepared.cases, search.poses(p, POSES), p, search)
        pairs = zip(found.use, found.poses, strict=True)
        return [Worst(TORQUE_USE.name, 0.0 if use is None else use, Cut(*at)) for use, at in pairs]

    def at_pose(self, prepared: _Drives, group: int, q: Array, designs: Designs) -> Mapping[str, Array]:
        """The greatest use over the drives; NaN where none has a rated torque."""
        if all(torque is None for torque in prepared.rated):
            return {TORQUE_USE.name: np.full(len(q), np.nan)}
        loads = np.abs(prepared.cases[group].vectorised(q, designs.p)[0])
        rated = np.array([math.inf if torque is None else torque for torque in prepared.rated])
        return {TORQUE_USE.name: (loads / rated).max(axis=1)}


def _assumed(problem: Asked) -> float | None:
    """Drives are not overloaded, whether or not anybody asks for it."""
    driven = any(joint.actuator is not None for joint in problem.arm.joints)
    return 1.0 if driven or problem.actuators is not None else None


TORQUE_USE = Figure(
    name="torque_use",
    synonyms=("torque", "drive_torque", "motor_torque", "joint_torque"),
    title="use of rated torque",
    senses=("<=",),
    key="torque_use",
    follows=ThroughPoses(Torques()),
    of=lambda evaluation: None if evaluation.drives is None else evaluation.drives.greatest_use,
    note="greatest, of any drive",
    # Actuators are chosen before a trade-off, never within one.
    traded=False,
    assumed=_assumed,
)
