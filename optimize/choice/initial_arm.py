"""The given arm as one of the candidates, so that no optimum is worse than it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from linkwright.core.optimize.exchange.design import arm_of, as_given, design_space, numeric_beams
from linkwright.core.optimize.problem import Problem
from linkwright.core.sections.numeric import Array

from .agreement import agreements
from .picks import Combination, options

_ALIKE = 1e-9


@dataclass(frozen=True)
class Given:
    """The arm as given: its combination of shapes and materials, and the optimiser's numbers for it."""

    combination: Combination
    x: Array


def given_design(problem: Problem) -> Given | None:
    """The arm as given as a design; None where the problem would not allow it, or cannot say it in its variables."""
    shapes, materials = options(problem)
    combination = Combination(
        tuple(None if link.section is None else link.section.shape for link in problem.arm.links),
        tuple(None if link.section is None else link.material for link in problem.arm.links),
    )
    if any(shape not in allowed for shape, allowed in zip(combination.shapes, shapes, strict=True)):
        return None
    if any(material not in allowed for material, allowed in zip(combination.materials, materials, strict=True)):
        return None
    if not combination.agrees(agreements(problem)):
        return None
    space = design_space(problem, combination.shapes)
    x = as_given(space)
    if x is None or not np.all(np.isfinite(x)):
        return None
    arm = arm_of(space, x, combination.materials)
    if not problem.free_tapers and space.problem.arm is not problem.arm:
        return None  # a taper is no candidate
    was, now = (numeric_beams(arm_there, problem.load_cases) for arm_there in (problem.arm, arm))
    same = np.abs(now - was) <= _ALIKE * np.maximum(np.abs(was), np.abs(now))
    return Given(combination, x) if bool(np.all(same)) and math.isfinite(float(np.abs(now).sum())) else None
