"""The constraints of the finite problem, family by family, as CasADi rows with the parameters they need."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, TypeVar

import casadi as ca

from arm.drive_load import DriveCase, rated_torques
from arm.kinematics import place
from arm.model import ErrorModel
from arm.modes import inertia_excess, segmented
from arm.strength import STATIONS, StrengthCase

from .design import DesignExpressions, DesignSpace, material_values
from .pool import ErrorCut, StrengthCut
from .problem import Limit

Cut = TypeVar("Cut", ErrorCut, StrengthCut)

MM = 1e3
_FLOOR_MM2 = 1e-14
"""Added to squared errors (mm^2) so that an error of zero has a logarithm."""

OWN_ROWS = ("max_error", "mass", "total_mass", "reach", "cost")
"""Limits that hold through a row of their own; the others hold through the poses of the pool."""


@dataclass
class Rows:
    """Constraint rows (each <= 0, or == 0) with the symbols that they bring along, in order."""

    rows: list[Any] = field(default_factory=list)
    parameters: list[Any] = field(default_factory=list)
    unknowns: list[Any] = field(default_factory=list)
    equalities: list[Any] = field(default_factory=list)
    sides: list[Any] = field(default_factory=list)
    labels: list[str] = field(default_factory=list)


def symbol(name: str, size: int = 1) -> Any:
    """A column of CasADi symbols."""
    return ca.SX.sym(name, size)  # pyright: ignore[reportCallIssue]


def error_rows(model: ErrorModel, design: DesignExpressions, y: Any, slots: Sequence[int], *, anchored: bool) -> Rows:
    """log |e|^2 <= 2 y (in mm) at as many poses of each load case as `slots` says."""
    out = Rows()
    size = model.arm.size
    for number, case in enumerate(model.cases):
        for slot in range(slots[number]):
            q = symbol(f"q{number}_{slot}", size)
            signs = symbol(f"s{number}_{slot}", len(case.error.intervals))
            shift = symbol(f"d{number}_{slot}", 3)
            out.parameters += [q, signs, shift]
            at = q
            if anchored:
                at = symbol(f"at{number}_{slot}", size)
                tip = symbol(f"tip{number}_{slot}", 3)
                null = symbol(f"null{number}_{slot}", size * size)
                out.unknowns.append(at)
                side = symbol(f"side{number}_{slot}")
                out.parameters += [tip, null, side]
                held, same_side = _anchored(model, design, at, q, tip, null, side)
                out.equalities += held
                out.sides.append(same_side)
            outputs = case.function(at, design.beam_column)
            vector = MM * (outputs[0] + shift)
            for play in range(len(case.error.intervals)):
                vector = vector + MM * signs[play] * outputs[1][3 * play : 3 * play + 3]
            out.rows.append(ca.log(ca.dot(vector, vector) + _FLOOR_MM2) - 2.0 * y)
    return out


def _anchored(
    model: ErrorModel, design: DesignExpressions, at: Any, q: Any, tip: Any, null: Any, side: Any
) -> tuple[list[Any], Any]:
    """The pose moves with the lengths so that its tip stays where it is, not along its null space, and not over to the
    other side of a singular pose: the equalities, and what must not be above zero."""
    arm = model.arm
    reached = place(arm, [at[k] for k in range(arm.size)], [beam.length for beam in design.beams]).tip()
    axes = 2 if model.planar else 3
    rows = [ca.SX(reached[axis]) - tip[axis] for axis in range(axes)]
    jacobian = ca.jacobian(ca.vertcat(*rows), at)
    matrix = ca.reshape(null, arm.size, arm.size)
    free = max(arm.size - axes, 0)
    rows += [ca.dot(matrix[:, k], at - q) for k in range(free)]
    square = ca.vertcat(jacobian, matrix[:, :free].T)
    return rows, -side * ca.det(square) if arm.size >= axes else ca.SX(0.0)


def filled(cuts: Sequence[Cut], slots: Sequence[int]) -> list[Cut]:
    """The cut in each slot, load case after load case; spare slots repeat the case's last."""
    found: list[Cut] = []
    for case, count in enumerate(slots):
        own = [cut for cut in cuts if cut.load_case == case]
        found += [own[min(slot, len(own) - 1)] for slot in range(count)]
    return found


def error_parameters(model: ErrorModel, cuts: Sequence[ErrorCut], *, anchored: bool) -> tuple[list[float], list[float]]:
    """The values of the error rows' parameters for the cuts in their slots, and starting values of their unknowns."""
    values: list[float] = []
    unknowns: list[float] = []
    size = model.arm.size
    for cut in cuts:
        values += [*cut.q, *cut.signs, *cut.shift]
        if anchored:
            assert cut.anchor is not None
            flat = [value for row in cut.anchor.null for value in row]
            values += [*cut.anchor.tip, *flat, *([0.0] * (size * size - len(flat))), cut.anchor.side]
            unknowns += list(cut.q)
    return values, unknowns


def strength_rows(
    limits: Sequence[Limit],
    cases: Sequence[StrengthCase],
    design: DesignExpressions,
    materials: Any,
    slack: Any,
    slots: Sequence[int],
) -> Rows:
    """Stress against yield strength and compression against Euler's load at as many poses of each load case as `slots`
    says."""
    out = Rows()
    size = len(design.beams)
    for number, case in enumerate(cases):
        for slot in range(slots[number]):
            q = symbol(f"strength{number}_{slot}", size)
            out.parameters.append(q)
            stress, compression, _ = case.function(q, design.beam_column, design.strength_column)
            for index, limit in enumerate(limits):
                for entry, link in enumerate(case.links):
                    if limit.name == "buckling":
                        out.rows.append(compression[entry] * limit.value - ca.exp(slack[index]))
                        out.labels.append(limit.name)
                    elif limit.name == "safety_factor":
                        strength = material_values(materials, link).yield_strength
                        for station in range(len(STATIONS)):
                            share = stress[len(STATIONS) * entry + station] * limit.value / strength
                            out.rows.append(ca.log(share) - slack[index])
                            out.labels.append(limit.name)
    return out


def torque_rows(
    space: DesignSpace,
    limits: Sequence[Limit],
    cases: Sequence[DriveCase],
    design: DesignExpressions,
    slack: Any,
    slots: Sequence[int],
) -> Rows:
    """The loads on the drives, to either side, against the rated torques of their actuators."""
    out = Rows()
    rated = rated_torques(space.problem.arm)
    for number, case in enumerate(cases):
        for slot in range(slots[number]):
            q = symbol(f"torque{number}_{slot}", len(design.beams))
            out.parameters.append(q)
            loads = case.function(q, design.beam_column)
            for index, limit in enumerate(limits):
                for joint, torque in enumerate(rated):
                    if limit.name == "torque_use" and torque is not None:
                        use = loads[joint] / (torque * limit.value)
                        out.rows += [use - ca.exp(slack[index]), -use - ca.exp(slack[index])]
                        out.labels += [limit.name] * 2
    return out


def mode_rows(space: DesignSpace, limits: Sequence[Limit], design: DesignExpressions, slack: Any, slots: int) -> Rows:
    """The first frequency, by Rayleigh's quotient of `slots` trial shapes."""
    out = Rows()
    arm = space.problem.arm
    segments = segmented(arm)
    for slot in range(slots):
        q = symbol(f"mode{slot}", arm.size)
        payload = symbol(f"carried{slot}")
        shape = symbol(f"shape{slot}", 3 * len(segments.owner))
        out.parameters += [q, payload, shape]
        for index, limit in enumerate(limits):
            if limit.name == "first_frequency":
                places, shapes = [q[k] for k in range(arm.size)], [shape[k] for k in range(shape.numel())]
                excess = inertia_excess(arm, segments, places, design.beams, payload, shapes, limit.value)
                # Inertia over stiffness goes with the frequency squared.
                out.rows.append(excess + 1.0 - ca.exp(2.0 * slack[index]))
                out.labels.append(limit.name)
    return out


def limit_rows(
    limits: Sequence[Limit], design: DesignExpressions, error: Any, carried: float, slack: Any
) -> tuple[Rows, list[bool]]:
    """The limits on figures of the design itself, as logarithms of ratios; and which of the rows are equalities."""
    figures = {
        "max_error": error,
        "mass": design.mass,
        "total_mass": design.mass + carried,
        "reach": design.reach,
        "cost": design.cost,
    }
    out = Rows()
    equal: list[bool] = []
    for index, limit in enumerate(limits):
        if limit.name in OWN_ROWS:
            ratio = ca.log(ca.SX(figures[limit.name]) / limit.value)
            if limit.relation == "==":
                # Two one-sided rows would have no interior; an equality takes a slack of either sign.
                out.rows.append(ratio - slack[index])
            else:
                out.rows.append((-ratio if limit.relation == ">=" else ratio) - slack[index])
            equal.append(limit.relation == "==")
            out.labels.append(limit.name)
    return out, equal


def shape_rows(space: DesignSpace, design: DesignExpressions) -> Rows:
    """What makes each section possible, and bounds on dimensions that are no variables."""
    out = Rows()
    problem = space.problem
    for link, section in enumerate(design.sections):
        if section is None:
            continue
        for constraint in (*section.constraints(), *section.bound_constraints(problem.section_size, problem.thickness)):
            value = ca.SX(constraint.value)
            if not value.is_constant():
                out.rows.append(value)
                out.labels.append(f"link {link + 1}: {constraint.text}")
    return out
