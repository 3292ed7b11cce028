"""Near ties with the figures that people compare."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from linkwright.core.arm.actuators import Actuator
from linkwright.core.arm.errors.model import beam_values, beams_of
from linkwright.core.arm.evaluation import link_masses, material_cost
from linkwright.core.arm.figures.frequency import least_frequency
from linkwright.core.optimize.balance.balance import settled
from linkwright.core.optimize.choice.actuators import with_actuators
from linkwright.core.optimize.choice.near_ties import Tie
from linkwright.core.optimize.exchange.exchange import Context, context_of

from .result import NearTie


def near_ties_of(context: Context, ties: Sequence[Tie]) -> tuple[NearTie, ...]:
    """The near ties, each with an error model of its drives."""
    arm = context.problem.arm
    contexts: dict[tuple[Actuator | None, ...], Context] = {tuple(joint.actuator for joint in arm.joints): context}
    results: list[NearTie] = []
    for tie in ties:
        drives = tuple(joint.actuator for joint in tie.arm.joints)
        if drives not in contexts:
            others = tuple(
                None if joint_drives == joint.actuator else joint_drives
                for joint_drives, joint in zip(drives, arm.joints, strict=True)
            )
            contexts[drives] = context_of(replace(context.problem, arm=with_actuators(arm, others)))
        results.append(_near_tie(contexts[drives], tie))
    return tuple(results)


def _near_tie(context: Context, tie: Tie) -> NearTie:
    """A near tie with the figures that people compare."""
    problem, arm = context.problem, tie.arm
    beams = beams_of(arm, problem.load_cases)
    p = beam_values(beams)
    slowest = least_frequency(arm, context.search, beams, p, problem.load_cases, plain=False)
    masses = link_masses(beams)
    return NearTie(
        tie.combination.shapes,
        tuple(None if material is None else material.name for material in tie.combination.materials),
        tuple(None if joint.actuator is None else joint.actuator.name for joint in arm.joints),
        tie.objective,
        context.search.worst(p, certify=False).error,
        sum(masses),
        material_cost(arm, masses),
        None if slowest is None else slowest.value,
        settled(arm),
    )
