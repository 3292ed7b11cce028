"""What of an arm's sums and errors no choice of sections changes."""

from __future__ import annotations

from linkwright.core.arm.chain.prices import fixed_price, price_by_length
from linkwright.core.arm.errors.model import ErrorModel
from linkwright.core.arm.evaluation import heaviest_carried
from linkwright.core.optimize.problem import Problem
from linkwright.core.units.quantities import InputError

from .design import DesignSpace


def carried_mass(problem: Problem) -> float:
    """The mass (kg) that counts in `total_mass` beside that of the links: joints, motors, what hangs on links, and the
    heaviest payload."""
    return heaviest_carried(problem.arm, problem.load_cases)


def drives_cost(problem: Problem) -> float:
    """What of the arm's cost (EUR) neither sections nor lengths decide: drives, rigid links, work by the part; raises
    `InputError` where the problem asks for a cost and one of these has no price."""
    total, lacking = fixed_price(problem.arm)
    if lacking and problem.needs("cost"):
        raise InputError(problem.file, "cost", f"{lacking}; `cost` in the arm file gives one")
    return 0.0 if lacking else total


def unchosen_cost(problem: Problem) -> float:
    """`drives_cost` with the work by the metre on links whose lengths stay as they are, EUR."""
    elastic = sum(link.length for link in problem.arm.links if link.section is not None)
    return drives_cost(problem) + price_by_length(problem.arm) * elastic


def anchored(space: DesignSpace) -> bool:
    """Whether poses must follow the design: the workspace is fixed in space and the lengths are free."""
    return space.free_lengths and space.problem.workspace.in_space


def fixed_error(model: ErrorModel) -> float:
    """The part of the worst error (m) that no design changes: in the plane the clearances add up, whatever the pose."""
    return float(model.cases[0].radii.sum()) if model.planar and model.arm.play == "worst" else 0.0
