"""Results as plain mappings for JSON. Names carry their units; None where a figure cannot be known."""

from __future__ import annotations

import math
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import PurePath
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from arm.chain import Arm, Link, LoadCase
from arm.workspace import Workspace
from arm.writing import material_to_value, section_to_mapping
from materials.quantities import format_quantity
from sections.taper import Tapered

if TYPE_CHECKING:
    from arm.evaluation import Compliance, Evaluation
    from optimize.result import BindingLimit, OptimizationResult, Rounded

_LENGTH_DIGITS = 7
_UNITS = MappingProxyType(
    {
        "max_error": 1e3,
        "mass": 1.0,
        "total_mass": 1.0,
        "reach": 1e3,
        "cost": 1.0,
        "safety_factor": 1.0,
        "first_frequency": 1.0,
        "buckling": 1.0,
        "torque_use": 1.0,
    }
)
"""What one SI unit of a limited figure is in the unit that people read."""


def program_version() -> str:
    """The version of the installed distribution; `unknown` where the code runs uninstalled."""
    try:
        return version("linkwright")
    except PackageNotFoundError:
        return "unknown"


def coordinates(arm: Arm, q: Sequence[float]) -> dict[str, list[float | None]]:
    """A pose: `q_deg` for joints that turn, `q_mm` for those that slide; null where a joint is of the other kind."""
    turning = [joint.revolute for joint in arm.joints]
    shown: dict[str, list[float | None]] = {}
    if any(turning):
        shown["q_deg"] = [math.degrees(x) + 0.0 if turns else None for x, turns in zip(q, turning, strict=True)]
    if not all(turning):
        shown["q_mm"] = [None if turns else 1e3 * x + 0.0 for x, turns in zip(q, turning, strict=True)]
    return shown


def _mm(metres: float | None) -> float | None:
    return None if metres is None else 1e3 * metres


def _load_case(case: LoadCase) -> dict[str, Any]:
    return {"payload_kg": case.mass, "force_N": list(case.force), "moment_Nm": list(case.moment)}


def _workspace(arm: Arm, workspace: Workspace) -> dict[str, Any]:
    used = 2 if workspace.in_plane else 3
    points = [[1e3 * value for value in point[:used]] for point in workspace.points]
    ranges = workspace.ranges or tuple(joint.range for joint in arm.joints)
    lowest, highest = ([pair[end] for pair in ranges] for end in (0, 1))
    spans = {"lower": coordinates(arm, lowest), "upper": coordinates(arm, highest)}
    return {"kind": workspace.kind, "points_mm": points, "joints": spans}


def _compliance(arm: Arm, compliance: Compliance) -> dict[str, Any]:
    """mm/N and N/mm are what people say; 1 m/N is 1000 mm/N."""
    return {
        **coordinates(arm, compliance.q),
        "matrix_mm_per_N": [[1e3 * value for value in row] for row in compliance.matrix],
        "ellipse_semi_axes_mm_per_N": [1e3 * value for value in compliance.principal],
        "ellipse_directions": [list(direction) for direction in compliance.directions],
    }


def _dimensions(link: Link) -> dict[str, float | list[float]]:
    """The dimensions in mm; of a tapered link both ends."""
    if link.section is None:
        return {}
    found: dict[str, float | list[float]] = {}
    for name, x in link.section.given().items():
        if isinstance(x, float | int):
            found[name] = 1e3 * float(x)
        elif isinstance(link.section, Tapered):
            found[name] = [1e3 * float(each) for each in x]
    return found


def _rounded_section(link: Link) -> dict[str, Any] | None:
    """The section as an arm file writes it, its dimensions short."""
    if link.section is None:
        return None
    content: dict[str, Any] = section_to_mapping(link.section)
    for name, value in link.section.given().items():
        if isinstance(value, float | int):
            content[name] = format_quantity(float(value), "length", "mm", _LENGTH_DIGITS)
    return content


def links_json(arm: Arm, masses: Sequence[float]) -> list[dict[str, Any]]:
    """Each link's length, section and material as an arm file writes them, and their figures."""
    return [
        {
            "number": number,
            "length": format_quantity(link.length, "length", "mm", _LENGTH_DIGITS),
            "length_mm": 1e3 * link.length,
            "section": _rounded_section(link),
            "stock": link.section_name,
            "dimensions_mm": _dimensions(link),
            "material": material_to_value(link) if link.material is not None else None,
            "mass_kg": mass,
        }
        for number, (link, mass) in enumerate(zip(arm.links, masses, strict=True), start=1)
    ]


def _strength(evaluation: Evaluation) -> list[dict[str, Any]]:
    strength = evaluation.strength
    return [
        {
            "link": link + 1,
            "stress_MPa": strength.stress[index] / 1e6,
            "safety_factor": strength.safety_factor[index],
            "buckling": strength.buckling[index],
            "deflection_share_of_length": strength.deflection[index],
            "worst_stress_pose": {
                **coordinates(evaluation.arm, strength.poses[index][0]),
                "load_case": strength.poses[index][1] + 1,
            },
        }
        for index, link in enumerate(strength.links)
    ]


def _drives(evaluation: Evaluation) -> list[dict[str, Any]]:
    """What each drive holds at most; empty where no joint has an actuator."""
    if evaluation.drives is None:
        return []
    arm, drives = evaluation.arm, evaluation.drives
    return [
        {
            "joint": number,
            "actuator": None if joint.actuator is None else joint.actuator.name,
            "greatest_load": load,
            "unit": "N*m" if joint.revolute else "N",
            "rated_torque_Nm": None if joint.actuator is None else joint.actuator.rated_torque,
            "peak_torque_Nm": None if joint.actuator is None else joint.actuator.peak_torque,
            "torque_use": use,
            "worst_pose": {**coordinates(arm, q), "load_case": case + 1},
        }
        for number, (joint, load, use, (q, case)) in enumerate(
            zip(arm.joints, drives.greatest, drives.use, drives.poses, strict=True), start=1
        )
    ]


def evaluation_figures(evaluation: Evaluation) -> dict[str, Any]:
    """The figures of an evaluation, by the names of the contract and a few more."""
    arm, worst, frequency = evaluation.arm, evaluation.worst, evaluation.frequency
    return {
        "arm": arm.name,
        "max_error_mm": 1e3 * evaluation.max_error,
        "upper_bound_mm": _mm(worst.upper_bound),
        "certified": worst.certified,
        "worst_poses": [
            {
                **coordinates(arm, pose.q),
                "load_case": pose.load_case + 1,
                "error_mm": 1e3 * pose.error,
                "error_vector_mm": [1e3 * x for x in pose.vector],
            }
            for pose in worst.poses
        ],
        "by_effect_mm": {effect: 1e3 * value for effect, value in evaluation.by_effect.items()},
        "mass_kg": evaluation.mass,
        "total_mass_kg": evaluation.total_mass,
        "cost_EUR": evaluation.cost,
        "reach_mm": 1e3 * evaluation.reach,
        "min_safety_factor": evaluation.strength.least_safety_factor,
        "min_buckling": evaluation.strength.least_buckling,
        "first_frequency_Hz": None if frequency is None else frequency.value,
        "first_frequency_pose": None
        if frequency is None
        else {**coordinates(arm, frequency.q), "load_case": frequency.load_case + 1},
        "compliance": _compliance(arm, evaluation.compliance),
        "strength": _strength(evaluation),
        "drives": _drives(evaluation),
        "links": links_json(arm, evaluation.link_masses),
        "workspace": _workspace(arm, evaluation.workspace),
        "load_cases": [_load_case(case) for case in evaluation.load_cases],
        "warnings": list(evaluation.warnings),
        "unknown": dict(evaluation.unknown),
    }


def evaluation_json(evaluation: Evaluation) -> dict[str, Any]:
    """What `evaluate --json` writes."""
    return {"made_by": f"linkwright evaluate {program_version()}", **evaluation_figures(evaluation)}


def objective_unit(minimize: str) -> tuple[float, str]:
    """What one SI unit of the objective is in the unit that people read, and that unit: mm, kg or EUR."""
    if minimize == "max_error":
        return 1e3, "mm"
    return 1.0, "EUR" if minimize == "cost" else "kg"


def _binding(limit: BindingLimit) -> dict[str, Any]:
    return {
        "name": limit.name,
        "limit": limit.text,
        "value": limit.value,
        "limit_value": limit.limit,
        "unit": limit.unit,
        "price": limit.price,
        "price_unit": limit.price_unit,
    }


def optimization_json(result: OptimizationResult) -> dict[str, Any]:
    """What `optimize --json` writes: the new design's figures, those before, and how it was found."""
    factor, unit = objective_unit(result.minimize)
    errors = result.minimize == "max_error"
    return {
        "made_by": f"linkwright optimize {program_version()}",
        "problem": PurePath(result.problem_file).name,
        "status": result.status,
        "minimize": result.minimize,
        "subject_to": list(result.limits),
        "choose": list(result.choices),
        "objective": {"value": factor * result.objective, "unit": unit},
        "lower_bound": {"value": factor * result.lower_bound, "unit": unit},
        "lower_bound_mm": factor * result.lower_bound if errors else None,
        **evaluation_figures(result.after),
        "before": evaluation_figures(result.before),
        "binding": [_binding(limit) for limit in result.binding],
        "seconds": result.seconds,
        "iterations": len(result.iterations),
        "exchange_log": [
            {
                "number": each.number,
                "objective": factor * each.objective,
                "objective_unit": unit,
                "design_change": each.design_change,
                "poses": each.poses,
                "worst_violation": each.worst_violation,
                "certified": each.certified,
            }
            for each in result.iterations
        ],
        "candidates": [
            {
                "shapes": list(each.shapes),
                "materials": list(each.materials),
                "objective": None if each.objective is None else factor * each.objective,
                "outcome": each.outcome,
            }
            for each in result.candidates
        ],
        "exhaustive": result.exhaustive,
        "actuators": [
            {
                "actuators": list(each.actuators),
                "objective": None if each.objective is None else factor * each.objective,
                "outcome": each.outcome,
            }
            for each in result.drives
        ],
        "actuators_exhaustive": result.drives_exhaustive,
        "rounded": None if result.rounded is None else _rounded(result.rounded, factor, unit),
    }


def _rounded(rounded: Rounded, factor: float, unit: str) -> dict[str, Any]:
    """The design of sizes that can be had: its figures, and what rounding cost."""
    return {
        "to": rounded.to,
        "length_step_mm": None if rounded.length_step is None else 1e3 * rounded.length_step,
        "objective": {"value": factor * rounded.objective, "unit": unit},
        "objective_before": {"value": factor * rounded.before, "unit": unit},
        "cost_of_rounding": {
            "value": factor * (rounded.objective - rounded.before),
            "unit": unit,
            "relative": rounded.objective / rounded.before - 1.0,
        },
        "limits": [
            {
                "name": limit.name,
                "limit": limit.text,
                "before": _UNITS[limit.name] * limit.before,
                "value": _UNITS[limit.name] * limit.after,
                "limit_value": _UNITS[limit.name] * limit.value,
                "kept": True,
            }
            for limit in rounded.limits
        ],
        "designs_compared": rounded.compared,
        "designs_searched": rounded.searched,
        "exhaustive": rounded.exhaustive,
        "seconds": rounded.seconds,
        **evaluation_figures(rounded.evaluation),
    }
