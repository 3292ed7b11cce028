"""What contradicts itself in a problem, whatever the design: each is one line that says the key and what would do."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, cast

from linkwright.core.arm.figures import PAYLOAD, Limit
from linkwright.core.arm.figures.motion.settling import SETTLING
from linkwright.core.sections import SHAPES
from linkwright.core.sections.taper import Tapered, size_ratio
from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import format_quantity
from linkwright.core.units.reading import Mapping

if TYPE_CHECKING:
    from linkwright.core.optimize.problem import Problem


def can_be_chosen(shape: str) -> bool:
    """Whether a shape has dimensions to optimise."""
    return bool(SHAPES[shape].variables)


def check_problem(mapping: Mapping, problem: Problem) -> None:
    """Raise `InputError` where what a problem asks contradicts itself."""
    if problem.uncertain is not None and problem.workspace.error != "whole":
        raise mapping.error("uncertain", f"counts the whole error, not that {problem.workspace.error} the path")
    body = mapping.mapping("subject_to") if mapping.has("subject_to") else mapping
    _check_limits(body, problem)
    _check_demands(body, problem)
    _check_errors(mapping, problem)
    _check_sleeves(body, problem)
    _check_reach(body, problem)
    _check_objective(mapping, body, problem)
    _check_choices(mapping, problem)
    if problem.sizes is not None:
        _check_listed(mapping, problem)
    else:
        _check_shapes(mapping, body, problem)


def _check_limits(body: Mapping, problem: Problem) -> None:
    for name, figure in problem.figures.items():
        lower = max((x.value for x in problem.limit(name) if x.relation in (">=", "==")), default=0.0)
        upper = min((x.value for x in problem.limit(name) if x.relation in ("<=", "==")), default=math.inf)
        if lower > upper * (1.0 + 1e-9):
            low, high = format_quantity(lower, figure.kind), format_quantity(upper, figure.kind)
            raise body.error(name, f"asks for at least {low} and at most {high}; loosen one of them")


def _check_demands(body: Mapping, problem: Problem) -> None:
    """Limits that ask different things of links: each is the only one on its figure, and says something of all."""
    for limit in (item for item in problem.limits if item.demands is not None):
        if problem.minimize == limit.name or len(problem.limit(limit.name)) > 1:
            where = "minimize or maximize" if problem.minimize == limit.name else "another limit on the same"
            raise body.error(limit.name, f"asks different things of links, and stands beside {where}; keep one")
        _check_materials(body, problem, limit)


def _check_materials(body: Mapping, problem: Problem, limit: Limit) -> None:
    assert limit.demands is not None
    named = [name for name, _ in limit.demands.materials]
    possible = dict.fromkeys(material.name for k in range(problem.arm.size) for material in problem.materials_of(k))
    for name in named:
        if name not in possible:
            raise body.error(f"{limit.name}.{name}", f"is no material that a link can be of{nearest(name, possible)}")
    lacking = [name for name in possible if named and name not in named]
    if lacking and "others" not in cast(dict[str, object], body.content[limit.name]):
        raise body.error(limit.name, f"says nothing of {', '.join(lacking)}; add others: ...")


def _check_errors(mapping: Mapping, problem: Problem) -> None:
    """Errors over poses that move with the lengths, as those of a place do, and errors of which a part counts."""
    of_cases = any(limit.figure.is_error and not limit.figure.traded for limit in problem.limits)
    if problem.workspace.error != "whole" and of_cases:
        message = f"holds for the whole error, and the workspace counts that {problem.workspace.error} the path"
        raise mapping.error("load_cases", f"subject_to {message}; leave one out")
    _check_uncertain(mapping, problem, of_cases=of_cases)
    if problem.must_reach and any(limit.name.startswith("max_error at point") for limit in problem.limits):
        message = "has a max_error of a point, which goes with links whose length stays"
        raise mapping.error("workspace.points", f"{message}; limit max_error for all of them in subject_to")
    _check_average(mapping, problem)


def _check_uncertain(mapping: Mapping, problem: Problem, *, of_cases: bool) -> None:
    """What may be uncertain counts in errors; a share of it in one error for all load cases."""
    if problem.uncertain is None:
        return
    if of_cases and not problem.uncertain.worst:
        message = "a share goes with one max_error for all load cases and points"
        raise mapping.error("robust", f"{message}; write robust: worst, or limit max_error in subject_to alone")
    if problem.minimize != "max_error" and not problem.limit("max_error") and not of_cases:
        message = "counts in max_error alone, which is neither minimised nor limited"
        raise mapping.error("uncertain", f"{message}; add subject_to: {{max_error: ...}}")


def _check_average(mapping: Mapping, problem: Problem) -> None:
    """An average is over poses that stay, of the whole error."""
    average = [limit.name for limit in problem.limits if limit.name == "average_error"]
    if not average and problem.minimize != "average_error":
        return
    key = "subject_to.average_error" if average else "minimize"
    if problem.must_reach:
        would_do = "list poses of the joints (workspace: {poses: [...]}), or keep the lengths"
        raise mapping.error(
            key, f"average_error is over poses that stay, and those of a place move with lengths; {would_do}"
        )
    if any(case.moving is not None for case in problem.load_cases):
        raise mapping.error(
            key, "average_error is over poses, and of a cycle the worst instants count; limit max_error"
        )
    if problem.workspace.error != "whole":
        raise mapping.error(key, f"average_error is of the whole error, not of that {problem.workspace.error} the path")


def _check_sleeves(body: Mapping, problem: Problem) -> None:
    if not any(link.runs_out for link in problem.arm.links):
        return
    if problem.free_lengths:
        message = "goes with links whose length stays; what runs out of a sleeve (bends_over) is as long as its slide"
        raise body.error("link_length", f"{message} goes: leave it out")
    if problem.free_tapers:
        raise body.error("taper", "goes without links that run out of a sleeve (bends_over), which are uniform")


def _check_objective(mapping: Mapping, body: Mapping, problem: Problem) -> None:
    """Whether there is something to design, and something that holds what is minimised."""
    driven = any(joint.actuator is not None or joint.greatest_static_load for joint in problem.arm.joints)
    if problem.limit("torque_use") and problem.actuators is None and not driven:
        would_do = "write joint: {rated_torque: 60 N*m} or {actuator: RV-20E}, or choose: {actuator: [...]}"
        raise body.error("torque_use", f"needs joints whose rated torque is known; {would_do}")
    if not any(link.elastic for link in problem.arm.links):
        raise mapping.error("arm", f"{problem.arm.name}: no link has a section, so there is nothing to design")
    figure = problem.objective
    if not figure.summed and figure is not PAYLOAD and problem.sizes is not None:
        message = f"goes with sections of free sizes; of listed ones {figure.name} can be limited"
        raise mapping.error("choose.sizes", message)
    limited = any(limit.figure.is_error or limit.name.startswith(SETTLING) for limit in problem.limits)
    if not figure.is_error and not figure.more_is_better and not limited:
        other = [limit for limit in problem.limits if limit.relation == ">=" and limit.name != "reach"]
        if not other:
            would_do = "give max_error (e.g. '<= 0.1 mm'), safety_factor or another limit that costs something"
            raise mapping.error("minimize", f"{problem.minimize} alone ends at the smallest sections; {would_do}")


def _check_choices(mapping: Mapping, problem: Problem) -> None:
    """Choices that do not go together."""
    if problem.stepped and (problem.sizes is not None or problem.free_tapers):
        other = "choose.sizes" if problem.sizes is not None else "taper"
        raise mapping.error("subject_to.thickness", f"steps go with sizes that are free, and without {other}")
    if (problem.balances or problem.motors) and problem.sizes is not None:
        would_do = "write what the arm has of them into its file, and leave them out here"
        raise mapping.error("choose", f"balancer, counterweight and motor go without sizes; {would_do}")
    twice = [motor.joint + 1 for motor in problem.motors if problem.actuators and problem.actuators[motor.joint]]
    if twice:
        would_do = "name its drive in the arm file, or leave out its motor"
        raise mapping.error("choose.motor", f"joint {twice[0]} chooses its actuator as well; {would_do}")
    if any(place.rods is not None for motor in problem.motors for place in motor.places):
        _check_rods(mapping, problem)


def _check_shapes(mapping: Mapping, body: Mapping, problem: Problem) -> None:
    """Sections that cannot be within the ranges of sizes, or whose dimensions cannot be optimised."""
    for link, ranges in enumerate(problem.ranges):
        for shape in problem.shapes_of(link):
            reason = SHAPES[shape].contradiction(*ranges.sizes)
            if reason is not None:
                raise body.error("thickness" if "wall" in reason or "thickness" in reason else "section_size", reason)
    if problem.shapes is not None:
        return
    for number, link in enumerate(problem.arm.links, start=1):
        if not isinstance(link.section, Tapered):
            continue
        if problem.ranges[number - 1].taper is None:
            would_do = "give subject_to: {taper: [0.4, 1]}, or name uniform shapes: choose: {section: [...]}"
            raise mapping.error("choose", f"link {number} is tapered, and no taper is to be chosen; {would_do}")
        if size_ratio(link.section) is None:
            would_do = "name shapes for the links: choose: {section: [...]}"
            message = f"link {number}'s ends are not alike, one larger than the other by the same in all dimensions"
            raise mapping.error("subject_to.taper", f"{message}; {would_do}")
    for shape in sorted({link.section.shape for link in problem.arm.links if link.section is not None}):
        if not can_be_chosen(shape):
            would_do = "name other shapes: choose: {section: [...]}"
            raise mapping.error("choose", f"the dimensions of a {shape} cannot be optimised; {would_do}")


def _check_rods(mapping: Mapping, problem: Problem) -> None:
    """Poses that a problem lists by their coordinates would be others with rods."""
    if problem.workspace.ranges is not None:
        would_do = "write joints: range; each place with rods has its own"
        key = f"workspace.{problem.workspace.kind}"
        raise mapping.error(key, f"lists coordinates of joints, which rods change; {would_do}")
    listed = next((limit.name for limit in problem.limits if limit.poses is not None), None)
    if listed is not None:
        would_do = "give the limit for the whole workspace"
        raise mapping.error(f"subject_to.{listed}", f"names poses by coordinates, which rods change; {would_do}")


def _check_listed(mapping: Mapping, problem: Problem) -> None:
    """What does not go with sections from a list."""
    if problem.free_lengths and problem.actuators is not None:
        would_do = "name the drives in the arm file, or leave link_length out"
        raise mapping.error("choose.sizes", f"goes with actuators where lengths stay; {would_do}")
    if problem.free_tapers:
        raise mapping.error("choose.sizes", "holds uniform sections; leave out subject_to.taper, or sizes")
    if problem.uncertain is not None:
        would_do = "leave out uncertain, and ask `evaluate --problem` of the answer"
        raise mapping.error("choose.sizes", f"is chosen for the arm as it is; {would_do}")


def _check_reach(body: Mapping, problem: Problem) -> None:
    if problem.arm.branches and problem.limit("reach"):
        would_do = "bound the lengths of the links (link_length), or leave it out"
        raise body.error("reach", f"is of one tip, and the arm has several; {would_do}")
    shortest, longest = (sum(item) for item in zip(*problem.length_spans, strict=True))
    for limit in problem.limit("reach"):
        required = format_quantity(limit.value, "length")
        if limit.relation in ("==", ">=") and limit.value > longest * (1.0 + 1e-9):
            longest_text = format_quantity(longest, "length", digits=6)
            raise body.error("reach", f"{required} is beyond the greatest sum of all link lengths, {longest_text}")
        if limit.relation in ("==", "<=") and limit.value < shortest * (1.0 - 1e-9):
            shortest_text = format_quantity(shortest, "length", digits=6)
            raise body.error("reach", f"{required} is below the least sum of all link lengths, {shortest_text}")
