"""What a joint's drive has to hold: the greatest torque over a workspace, against its rated one.

The loads are static: payload, process force and weights. What a motion takes is `arm.figures.motion.cycle`'s.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from linkwright.core.arm.chain.chain import Arm, Joint, LoadCase
from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import Scalar
from linkwright.core.arm.compiled.vectorise import Expressions
from linkwright.core.sections.numeric import Array

from .design import DesignValues
from .figure import Asked, Figure, ThroughPoses
from .statics import OfStatics, greatest, statics_case

if TYPE_CHECKING:
    from linkwright.core.arm.worst.search import WorstSearch


@dataclass(frozen=True)
class DriveLoads:
    """The greatest load on each joint's drive (N*m; N for a slide) over a workspace and load cases, where it is, and
    what share of its rated torque that is (None where nobody knows it)."""

    greatest: tuple[float, ...]
    poses: tuple[tuple[tuple[float, ...], int], ...]
    use: tuple[float | None, ...]

    @property
    def greatest_use(self) -> float | None:
        """The greatest share of a rated torque; None where none is known."""
        return max((use for use in self.use if use is not None), default=None)


def rated_torques(arm: Arm) -> tuple[float | None, ...]:
    """What each joint's drive can hold at rest, N*m (N for a slide); None where it is unknown."""
    return tuple(joint.greatest_static_load for joint in arm.joints)


def drive_case(arm: Arm, load: LoadCase) -> Expressions:
    """The loads on an arm's drives under a load case (N*m; N for a slide), one a joint, for symbols (q, p)."""
    return statics_case(arm, load, _loads)


def _loads(state: PoseState) -> list[Scalar]:
    return [joint.drive_load for joint in state.joints]


def greatest_drive_loads(
    arm: Arm, cases: Sequence[Expressions], poses: Array, p: Array, search: WorstSearch | None = None
) -> DriveLoads:
    """The greatest drive loads over poses q (N, n) and load cases for a design p; with `search` over its workspace,
    the poses being where climbs start."""
    extremes = greatest([lambda q, case=case: np.abs(case.vectorised(q, p)[0]) for case in cases], poses, p, search)
    return DriveLoads(
        tuple(extreme.value for extreme in extremes),
        tuple((extreme.q, extreme.load_case) for extreme in extremes),
        tuple(
            None if r is None else extreme.value / r for extreme, r in zip(extremes, rated_torques(arm), strict=True)
        ),
    )


def _uses(state: PoseState) -> list[Scalar]:
    """The share of its rated torque that each drive holds."""
    joints = zip(state.joints, rated_torques(state.arm), strict=True)
    return [joint.drive_load / torque for joint, torque in joints if torque is not None]


def _at_rest(loads: Sequence[LoadCase]) -> list[LoadCase]:
    """The load cases with one at rest, the first, in place of those of a motion, whose torques are `cycle`'s."""
    still = next((load for load in loads if load.moving is None), replace(loads[0], moving=None))
    return [still if load.moving is not None else load for load in loads]


class Torques(OfStatics[DriveLoads]):
    """The loads on the drives, to either side, against their rated torques."""

    def cases(self, arm: Arm, loads: Sequence[LoadCase]) -> tuple[Expressions, ...]:
        """The loads under each load case, at rest."""
        return super().cases(arm, _at_rest(loads))

    def evaluate(self, design: DesignValues) -> DriveLoads | None:
        """Each drive's greatest load; None where no drive is known, or nothing is held at rest."""
        if all(load.moving is not None for load in design.load_cases):
            return None
        if not any(joint.actuator is not None or joint.greatest_static_load for joint in design.arm.joints):
            return None
        cases = [drive_case(design.arm, load) for load in _at_rest(design.load_cases)]
        return greatest_drive_loads(design.arm, cases, design.poses, design.p, design.search)

    def values(self, result: DriveLoads) -> Mapping[str, float | None]:
        """The greatest use of any drive."""
        return {TORQUE_USE.name: result.greatest_use}

    def warnings(self, arm: Arm, result: DriveLoads) -> list[str]:
        """One line for each joint whose drive has to hold more than it can."""
        lines: list[str] = []
        for number, (joint, held) in enumerate(zip(arm.joints, result.greatest, strict=True), start=1):
            rated, peak = joint.rating
            load = f"{held:.4g} {_unit(joint)}"
            if peak is not None and held > peak:
                drive = "its drive" if joint.actuator is None else joint.actuator.name
                gives = f"{drive} gives {peak:.4g} {_unit(joint)} at most"
                lines.append(f"joint {number} needs up to {load}; {gives}, so it cannot hold the arm there")
            elif rated is not None and held > rated:
                of = "" if joint.actuator is None else f" of {joint.actuator.name}"
                lines.append(f"joint {number} holds up to {load}, more than the rated {rated:.4g} {_unit(joint)}{of}")
        return lines


def _unit(joint: Joint) -> str:
    return "N*m" if joint.revolute else "N"


def _assumed(problem: Asked) -> float | None:
    """Drives are not overloaded, whether or not anybody asks for it."""
    if all(load.moving is not None for load in problem.load_cases):
        return None
    driven = any(joint.actuator is not None or joint.greatest_static_load for joint in problem.arm.joints)
    return 1.0 if driven or problem.actuators is not None else None


TORQUES = Torques("torque_use", _uses, either_way=True, called="drive_loads")
"""The loads on the drives."""

TORQUE_USE = Figure(
    name="torque_use",
    synonyms=("torque", "drive_torque", "motor_torque", "joint_torque"),
    title="use of rated torque",
    senses=("<=",),
    key="torque_use",
    follows=ThroughPoses(TORQUES),
    note="greatest, of any drive",
    # Actuators are chosen before a trade-off, never within one.
    traded=False,
    assumed=_assumed,
)
