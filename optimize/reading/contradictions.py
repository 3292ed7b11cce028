"""What contradicts itself in a problem, whatever the design: each is one line that says the key and what would do."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from linkwright.core.arm.chain.chain import askew
from linkwright.core.sections import SHAPES
from linkwright.core.sections.taper import Tapered, size_ratio
from linkwright.core.units.quantities import format_quantity
from linkwright.core.units.reading import Mapping

if TYPE_CHECKING:
    from linkwright.core.optimize.problem import Problem


def can_be_chosen(shape: str) -> bool:
    """Whether a shape has dimensions to optimise and bends in the plane of its load, as the optimiser takes it to."""
    kind = SHAPES[shape]
    return bool(kind.variables) and not askew(kind.start(1e-3, (0.02, 0.2), (0.002, 0.02)))


def check_problem(mapping: Mapping, problem: Problem) -> None:
    """Raise `InputError` where what a problem asks contradicts itself."""
    if problem.uncertain is not None and problem.workspace.error != "whole":
        raise mapping.error("uncertain", f"counts the whole error, not that {problem.workspace.error} the path")
    body = mapping.mapping("subject_to") if mapping.has("subject_to") else mapping
    _check_limits(body, problem)
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


def _check_sleeves(body: Mapping, problem: Problem) -> None:
    if not any(link.runs_out for link in problem.arm.links):
        return
    if problem.link_length is not None:
        message = "goes with links whose length stays; what runs out of a sleeve (bends_over) is as long as its slide"
        raise body.error("link_length", f"{message} goes: leave it out")
    if problem.taper is not None:
        raise body.error("taper", "goes without links that run out of a sleeve (bends_over), which are uniform")


def _check_objective(mapping: Mapping, body: Mapping, problem: Problem) -> None:
    """Whether there is something to design, and something that holds what is minimised."""
    driven = any(joint.actuator is not None for joint in problem.arm.joints)
    if problem.limit("torque_use") and problem.actuators is None and not driven:
        would_do = "name them in the arm file (joint: {actuator: RV-20E}), or choose: {actuator: [...]}"
        raise body.error("torque_use", f"needs joints with actuators, whose rated torque is known; {would_do}")
    if not any(link.elastic for link in problem.arm.links):
        raise mapping.error("arm", f"{problem.arm.name}: no link has a section, so there is nothing to design")
    if problem.minimize != "max_error" and not problem.limit("max_error"):
        other = [limit for limit in problem.limits if limit.relation == ">=" and limit.name != "reach"]
        if not other:
            would_do = "give max_error (e.g. '<= 0.1 mm'), safety_factor or another limit that costs something"
            raise mapping.error("minimize", f"{problem.minimize} alone ends at the smallest sections; {would_do}")


def _check_choices(mapping: Mapping, problem: Problem) -> None:
    """Choices that do not go together."""
    if (problem.balances or problem.motors) and problem.sizes is not None:
        would_do = "write what the arm has of them into its file, and leave them out here"
        raise mapping.error("choose", f"balancer, counterweight and motor go without sizes; {would_do}")
    twice = [each.joint + 1 for each in problem.motors if problem.actuators and problem.actuators[each.joint]]
    if twice:
        would_do = "name its drive in the arm file, or leave out its motor"
        raise mapping.error("choose.motor", f"joint {twice[0]} chooses its actuator as well; {would_do}")
    if any(place.rods is not None for each in problem.motors for place in each.places):
        _check_rods(mapping, problem)


def _check_shapes(mapping: Mapping, body: Mapping, problem: Problem) -> None:
    """Sections that cannot be within the ranges of sizes, or whose dimensions cannot be optimised."""
    own = [link.section.shape for link in problem.arm.links if link.section is not None]
    for shape in problem.shapes or own:
        reason = SHAPES[shape].contradiction(problem.section_size, problem.thickness)
        if reason is not None:
            raise body.error("thickness" if "wall" in reason or "thickness" in reason else "section_size", reason)
    if problem.shapes is not None:
        return
    for number, link in enumerate(problem.arm.links, start=1):
        if not isinstance(link.section, Tapered):
            continue
        if problem.taper is None:
            would_do = "give subject_to: {taper: [0.4, 1]}, or name uniform shapes: choose: {section: [...]}"
            raise mapping.error("choose", f"link {number} is tapered, and no taper is to be chosen; {would_do}")
        if size_ratio(link.section) is None:
            would_do = "name shapes for the links: choose: {section: [...]}"
            message = f"link {number}'s ends are not alike, one larger than the other by the same in all dimensions"
            raise mapping.error("subject_to.taper", f"{message}; {would_do}")
    for shape in sorted(set(own)):
        if not can_be_chosen(shape):
            would_do = "name other shapes: choose: {section: [...]}"
            raise mapping.error("choose", f"the dimensions of a {shape} cannot be optimised; {would_do}")


def _check_rods(mapping: Mapping, problem: Problem) -> None:
    """Poses that a problem lists by their coordinates would be others with rods."""
    if problem.workspace.ranges is not None:
        would_do = "write joints: range; each place with rods has its own"
        raise mapping.error("workspace.joints", f"lists ranges of coordinates, which rods change; {would_do}")
    listed = next((limit.name for limit in problem.limits if limit.poses is not None), None)
    if listed is not None:
        would_do = "give the limit for the whole workspace"
        raise mapping.error(f"subject_to.{listed}", f"names poses by coordinates, which rods change; {would_do}")


def _check_listed(mapping: Mapping, problem: Problem) -> None:
    """What does not go with sections from a list."""
    if problem.link_length is not None and problem.actuators is not None:
        would_do = "name the drives in the arm file, or leave link_length out"
        raise mapping.error("choose.sizes", f"goes with actuators where lengths stay; {would_do}")
    if problem.taper is not None:
        raise mapping.error("choose.sizes", "holds uniform sections; leave out subject_to.taper, or sizes")
    if problem.uncertain is not None:
        would_do = "leave out uncertain, and ask `evaluate --problem` of the answer"
        raise mapping.error("choose.sizes", f"is chosen for the arm as it is; {would_do}")


def _check_reach(body: Mapping, problem: Problem) -> None:
    if problem.arm.branches and problem.limit("reach"):
        would_do = "bound the lengths of the links (link_length), or leave it out"
        raise body.error("reach", f"is of one tip, and the arm has several; {would_do}")
    lengths: Sequence[tuple[float, float]] = [
        problem.link_length if problem.link_length is not None and link.elastic else (link.length, link.length)
        for link in problem.arm.links
    ]
    shortest, longest = sum(low for low, _ in lengths), sum(high for _, high in lengths)
    for limit in problem.limit("reach"):
        asked = format_quantity(limit.value, "length")
        if limit.relation in ("==", ">=") and limit.value > longest * (1.0 + 1e-9):
            most = format_quantity(longest, "length", digits=6)
            raise body.error("reach", f"{asked} is beyond the longest the links can be together, {most}")
        if limit.relation in ("==", "<=") and limit.value < shortest * (1.0 - 1e-9):
            least = format_quantity(shortest, "length", digits=6)
            raise body.error("reach", f"{asked} is below the shortest the links can be together, {least}")
