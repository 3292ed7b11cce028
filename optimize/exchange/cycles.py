"""Designs for cycles of motion: which of a cycle's instants are load cases, and the search that adds to them.

The instants at which an arm errs most, or a link bears most, stand for the cycle. The best design for them is looked at
over the whole cycle; where it is worse at another instant, that is added, as an exchange adds poses.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.motion.cycle import Cycle, cycles_of, read_cycle, worst_samples
from linkwright.core.arm.motion.moving import refuse_what_no_chain_is
from linkwright.core.arm.worst.workspace import Workspace
from linkwright.core.units.reading import Mapping

if TYPE_CHECKING:
    from linkwright.core.optimize.problem import Problem
    from linkwright.core.optimize.result import OptimizationResult


def moving_cases(body: Mapping, arm: Arm, load: LoadCase) -> list[LoadCase]:
    """The load cases of a cycle that an entry of `load_cases` names: the instants that count for an arm."""
    if body.has("subject_to"):
        raise body.error("subject_to", "goes with a load at rest; a motion has the problem's limits")
    refuse_what_no_chain_is(arm)
    cycle = read_cycle(Path(str(body.file)).parent / body.text("motion"), arm, load)
    return [cycle.sample(k) for k in worst_samples(arm, cycle)]


def space_of_cycles(cases: Sequence[LoadCase]) -> Workspace:
    """The poses of cycles, where nothing acts at rest: those of the instants that are load cases."""
    poses = tuple(tuple(float(value) for value in case.moving.q) for case in cases if case.moving is not None)
    spans = tuple((min(column), max(column)) for column in zip(*poses, strict=True))
    return Workspace("poses", ranges=spans, poses=poses)


def check_cycles(mapping: Mapping, problem: Problem) -> None:
    """Refuse what no cycle goes with."""
    if not cycles_of(problem.load_cases):
        return
    if mapping.has("relative_to"):
        raise mapping.error("relative_to", "goes with loads at rest; leave it out beside a motion")
    if problem.free_lengths:
        raise mapping.error("subject_to.link_length", "goes with loads at rest; a motion needs links of given lengths")
    if problem.minimize == "payload":
        raise mapping.error("maximize", "payload goes with loads at rest; a motion says what it carries")


def over_whole_cycles(
    problem: Problem, optimised: Callable[[Problem], OptimizationResult], tell: Callable[[str], None]
) -> OptimizationResult:
    """The best design over all instants of a problem's cycles: none at which it is worst is left out, but where it was
    interrupted."""
    result = optimised(problem)
    while not result.interrupted and (missed := _missed(problem, result)):
        tell(f"{len(missed)} more instants of the motion count for this design")
        cases = (*problem.load_cases, *missed)
        whole = problem.workspace.kind == "poses" and all(case.moving is not None for case in problem.load_cases)
        problem = replace(problem, load_cases=cases, workspace=space_of_cycles(cases) if whole else problem.workspace)
        result = optimised(problem)
    return result


def _missed(problem: Problem, result: OptimizationResult) -> list[LoadCase]:
    """The instants that are no load case of a problem, at which a design is worst."""
    missed: list[LoadCase] = []
    for cycle in cycles_of(problem.load_cases):
        known = {case.moving.time for case in problem.load_cases if case.moving and case.moving.source is cycle}
        missed += [case for case in _worst_of(result.arm, cycle) if case.moving and case.moving.time not in known]
    return missed


def _worst_of(arm: Arm, cycle: Cycle) -> list[LoadCase]:
    return [cycle.sample(k) for k in worst_samples(arm, cycle)]
