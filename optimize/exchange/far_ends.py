"""The far end of a link whose taper is chosen: its dimensions keep the bounds that those at the joint keep."""

from __future__ import annotations

from typing import Any

import casadi as ca

from linkwright.core.optimize.ranges import Ranges
from linkwright.core.sections import Section
from linkwright.core.sections.section import Constraint


def far_constraints(near: Section, log_taper: Any, ranges: Ranges) -> list[Constraint]:
    """The bounds on a far end that those at the joint do not hold already, for floats or symbols.

    The lower ones where the far end can be smaller, the upper ones where it can be larger. What makes a section
    possible is on ratios of its dimensions, and so holds all along.
    """
    if ranges.taper is None:
        return []
    outer, walls = ranges.sizes
    smaller, larger = ranges.taper[0] < 1.0, ranges.taper[1] > 1.0
    constraints: list[Constraint] = []
    for variable in near.variables:
        if variable.kind == "area":
            continue  # bounded through the dimensions that it follows from
        low, high = outer if variable.kind == "outer" else walls
        size = ca.log(getattr(near, variable.name)) + log_taper
        if smaller:
            value = ca.log(low) - size
            constraints.append(Constraint(f"least_{variable.name}", f"{variable.name} at least, at the far end", value))
        if larger:
            value = size - ca.log(high)
            constraints.append(Constraint(f"most_{variable.name}", f"{variable.name} at most, at the far end", value))
    far = near.scaled(ca.exp(log_taper))
    for constraint in far.bound_constraints(outer, walls):
        lower, upper = ">=" in constraint.text, "<=" in constraint.text
        if (smaller and not upper) or (larger and not lower):
            constraints.append(Constraint(constraint.name, f"{constraint.text}, at the far end", constraint.value))
    return constraints
