"""Results as plain mappings for JSON. Names carry their units; None where a figure cannot be known."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from linkwright.core.arm.chain.chain import Arm, Link, LoadCase
from linkwright.core.arm.figures import FIGURES, Figure, Limit
from linkwright.core.arm.files.write import material_to_value, section_to_mapping
from linkwright.core.arm.placed.heights import heights
from linkwright.core.arm.worst.workspace import Workspace
from linkwright.core.optimize.infeasible.answer import Infeasibility
from linkwright.core.optimize.worse import softened_links, worse_figures
from linkwright.core.sections.taper import Tapered
from linkwright.core.units.quantities import format_quantity
from linkwright.core.units.temperature import ZERO_CELSIUS
from linkwright.json.fields import fields, fields_if, in_mm

if TYPE_CHECKING:
    from linkwright.core.arm.errors.at_pose import PoseError
    from linkwright.core.arm.evaluation import Compliance, Evaluation
    from linkwright.core.arm.motion.dynamics import OfDrive
    from linkwright.core.optimize.result import KeptLimit, NotRounded, OptimizationResult, Rounded
    from linkwright.core.optimize.robust.result import Robust, RobustFigure


_LENGTH_DIGITS = 7


def coordinates(arm: Arm, q: Sequence[float]) -> dict[str, list[float | None]]:
    """A pose: `q_deg` for joints that turn, `q_mm` for those that slide; null where a joint is of the other kind."""
    return _by_kind(arm, arm.whole_pose(q))


def _by_kind(arm: Arm, q: Sequence[float]) -> dict[str, list[float | None]]:
    turning = [joint.revolute for joint in arm.joints]
    shown: dict[str, list[float | None]] = {}
    if any(turning):
        shown["q_deg"] = [math.degrees(x) + 0.0 if turns else None for x, turns in zip(q, turning, strict=True)]
    if not all(turning):
        shown["q_mm"] = [None if turns else 1e3 * x + 0.0 for x, turns in zip(q, turning, strict=True)]
    return shown


def _workspace(arm: Arm, workspace: Workspace) -> dict[str, Any]:
    used = 2 if workspace.in_plane else 3
    points = in_mm([point[:used] for point in workspace.points])
    ranges = workspace.ranges or tuple(joint.range for joint in arm.joints)
    lowest, highest = ([pair[end] for pair in ranges] for end in (0, 1))
    spans = {"lower": _by_kind(arm, lowest), "upper": _by_kind(arm, highest)}
    return {
        "kind": "points" if workspace.apart else workspace.kind,
        "points_mm": points,
        "joints": spans,
        "error": workspace.error,
    }


def _compliance(arm: Arm, compliance: Compliance) -> dict[str, Any]:
    """mm/N and N/mm are what people say; 1 m/N is 1000 mm/N."""
    return {
        **coordinates(arm, compliance.q),
        "matrix_mm_per_N": in_mm(compliance.matrix),
        "ellipse_semi_axes_mm_per_N": in_mm(compliance.principal),
        "ellipse_directions": compliance.directions,
    }


def _dimensions(link: Link) -> dict[str, float | list[float]]:
    """The dimensions in mm; of a tapered link both ends."""
    if link.section is None:
        return {}
    dimensions: dict[str, float | list[float]] = {}
    for name, x in link.section.given().items():
        if isinstance(x, float | int):
            dimensions[name] = 1e3 * float(x)
        elif isinstance(link.section, Tapered):
            dimensions[name] = [1e3 * float(item) for item in x]
    return dimensions


def _rounded_section(link: Link) -> dict[str, Any] | None:
    """The section as an arm file writes it, its dimensions short."""
    if link.section is None:
        return None
    content: dict[str, Any] = section_to_mapping(link.section)
    for name, value in link.section.given().items():
        if isinstance(value, float | int):
            content[name] = format_quantity(float(value), "length", "mm", _LENGTH_DIGITS)
    return content


def links_json(arm: Arm, masses: Sequence[float | None]) -> list[dict[str, Any]]:
    """Each link's length, section and material as an arm file writes them, and their figures; `height_direction` is in
    the base frame with all joints at zero."""
    return [
        {
            "number": number,
            "length": format_quantity(link.length, "length", "mm", _LENGTH_DIGITS),
            "length_mm": 1e3 * link.length,
            "section": _rounded_section(link),
            "stock": link.section_name,
            "dimensions_mm": _dimensions(link),
            "height_points": None if points is None else points.words,
            "height_direction": None if points is None else points.direction,
            "material": material_to_value(link.material) if link.material is not None else None,
            "mass_kg": mass,
        }
        for number, (link, mass, points) in enumerate(zip(arm.links, masses, heights(arm), strict=True), start=1)
    ]


def _pose(arm: Arm, q: Sequence[float], case: int) -> dict[str, Any]:
    return {**coordinates(arm, q), "load_case": case + 1}


def _strength(evaluation: Evaluation) -> list[dict[str, Any]]:
    strength = evaluation.strength
    walls = {link.link: link for link in evaluation.local_buckling.links}
    return [
        {
            "link": link + 1,
            "stress_MPa": strength.stress[index] / 1e6,
            "safety_factor": strength.safety_factor[index],
            "buckling": strength.buckling[index],
            **fields(walls[link], "local_buckling=factor", "wall"),
            "deflection_share_of_length": strength.deflection[index],
            "worst_stress_pose": _pose(evaluation.arm, *strength.poses[index]),
        }
        for index, link in enumerate(strength.links)
    ]


def _drives(evaluation: Evaluation) -> list[dict[str, Any]]:
    """What each drive holds at most; empty where no drive is known."""
    arm, drives = evaluation.arm, evaluation.drives
    if drives is None:
        return []
    result: list[dict[str, Any]] = []
    for index, joint in enumerate(arm.joints):
        rated, peak = joint.rating
        figure = "torque_Nm" if joint.revolute else "force_N"
        result.append(
            {
                "joint": index + 1,
                "actuator": None if joint.actuator is None else joint.actuator.name,
                "greatest_load": drives.greatest[index],
                "unit": "N*m" if joint.revolute else "N",
                f"rated_{figure}": rated,
                f"peak_{figure}": peak,
                "torque_use": drives.use[index],
                "worst_pose": _pose(arm, *drives.poses[index]),
            }
        )
    return result


def _joint_loads(evaluation: Evaluation) -> list[dict[str, Any]] | None:
    """What each joint carries at the worst pose; null where a mass is not known."""
    loads = evaluation.joint_loads
    if loads is None:
        return None
    return [
        {
            "joint": number,
            **fields(load, "axis", "force_N", "moment_Nm", "radial_N"),
            "axial_N": abs(load.along),
            **fields(load, "tilting_Nm", "drive_holds=drive"),
            "drive_unit": "N*m" if load.revolute else "N",
        }
        for number, load in enumerate(loads, start=1)
    ]


def evaluation_figures(evaluation: Evaluation, figures: Mapping[str, Figure] = FIGURES) -> dict[str, Any]:
    """The figures of an evaluation, by the names of the contract and a few more."""
    arm, frequency = evaluation.arm, evaluation.frequency
    poses = {figure.name: figure.pose(evaluation) for figure in figures.values() if figure.where is not None}
    beyond = ("beyond_first_order_mm=beyond.at_worst", "beyond_first_order_largest_mm=beyond.largest")
    bounds = ("upper_bound_mm", "upper_bound_first_order_mm=worst.upper_bound", *beyond, "certified=worst.certified")
    drives = evaluation.frequency_of_drives
    return {
        "arm": arm.name,
        **fields(evaluation, *bounds, "max_error_of_rigid_links_mm=rigid_links_error"),
        "worst_poses": [
            {**_pose(arm, pose.q, pose.load_case), **fields(pose, "error_mm", "error_vector_mm=vector")}
            for pose in evaluation.worst.poses
        ],
        "by_effect_mm": {effect: 1e3 * value for effect, value in evaluation.by_effect.items()},
        **{figure.key: figure.shown(figure.value(evaluation)) for figure in figures.values()},
        **{f"{name}_pose": None if at is None else coordinates(arm, at) for name, at in poses.items()},
        "first_frequency_pose": None if frequency is None else _pose(arm, frequency.q, frequency.load_case),
        "first_frequency_of_drives_Hz": None if drives is None else drives.value,
        "compliance": None if "compliance" in evaluation.unknown else _compliance(arm, evaluation.compliance),
        "strength": _strength(evaluation),
        "drives": _drives(evaluation),
        "motion": _in_motion(arm, evaluation.in_motion),
        "joint_loads": _joint_loads(evaluation),
        "links": links_json(arm, evaluation.link_masses),
        "workspace": _workspace(arm, evaluation.workspace),
        "load_cases": [_load(case) for case in evaluation.load_cases],
        "relative_to": _relative_to(evaluation),
        **fields(evaluation, "warnings", "notes", "unknown"),
        **_seam(evaluation),
        "thermal_growth_left_out": _growth(evaluation),
        "unreached_share": 0.0 if evaluation.unreached is None else evaluation.unreached.share,
    }


def _seam(evaluation: Evaluation) -> dict[str, Any]:
    """The worst error on a path, across it and along it, whatever of it counts; null elsewhere."""
    parts = ("across", "along", "whole")
    content = fields_if(evaluation.seam, *(f"{name}_mm={name}.error" for name in parts))
    return content or {f"{name}_mm": None for name in parts}


def _load(case: LoadCase) -> dict[str, Any]:
    tip = {"tip": case.tip} if case.tip else {}
    moving = {} if case.moving is None else {"motion_time_s": case.moving.time}
    base = {"base_acceleration_m_per_s2": list(case.acceleration)} if any(case.acceleration) else {}
    return {**tip, **fields(case, "payload_kg=mass", "force_N", "moment_Nm"), **base, **moving}


def _relative_to(evaluation: Evaluation) -> dict[str, Any] | None:
    """The calibrated state that errors count from: `payload` is null where it is each load case's own."""
    state = evaluation.relative_to
    if state is None:
        return None
    temperature = evaluation.arm.temperature if state.temperature is None else state.temperature
    return {
        "payload": None if state.payload is None else _load(state.payload),
        "temperature_degC": temperature - ZERO_CELSIUS,
    }


def _growth(evaluation: Evaluation) -> dict[str, Any] | None:
    """The thermal growth that the model leaves out: what the worst error would be with it."""
    growth = evaluation.growth
    if growth is None:
        return None
    content = fields(growth, "temperature_degC", "since_degC", "max_error_mm=error")
    return {**content, "links_not_known": [link + 1 for link in growth.unknown]}


def evaluation_json(
    evaluation: Evaluation,
    robust: RobustFigure | None = None,
    motion: Sequence[OfDrive] | None = None,
    at: Sequence[PoseError] = (),
    known: Mapping[str, Figure] = FIGURES,
) -> dict[str, Any]:
    """What `evaluate --json` writes."""
    return {
        **evaluation_figures(evaluation, known),
        "poses": [_pose_error(evaluation.arm, error) for error in at],
        "robust": None if robust is None else _robust_figure(robust),
        "motion": _in_motion(evaluation.arm, motion),
    }


def _pose_error(arm: Arm, error: PoseError) -> dict[str, Any]:
    """The tip's error at a pose that was asked for, and what each effect has of it."""
    return {
        **_pose(arm, error.q, error.load_case),
        **fields(error, "error_mm", "error_vector_mm=vector"),
        "orientation_error_mrad": 1e3 * error.orientation,
        "rotation_mrad": [1e3 * x for x in error.rotation],
        **fields(error, "beyond_first_order_mm=beyond", "outside"),
        "by_effect": [
            {
                **fields(part, "effect", "error_vector_mm=vector", "share"),
                "rotation_mrad": [1e3 * x for x in part.rotation],
            }
            for part in error.by_effect
        ],
    }


def _in_motion(arm: Arm, motion: Sequence[OfDrive] | None) -> list[dict[str, Any]] | None:
    """What a motion asks of each drive; torque and speed of a slide are a force and m/s, which the units say. None
    where nothing moves."""
    if motion is None:
        return None
    names = ("greatest_torque=torque", "rms_torque", "greatest_speed=speed", "greatest_power_W=power")
    return [
        {
            "joint": number,
            **fields(item, *names, "energy_J=energy", "braked_J=braked"),
            **dict(zip(("peak_use", "rated_use"), item.uses(joint), strict=True)),
            "torque_unit": "N*m" if joint.revolute else "N",
            "speed_unit": "rad/s" if joint.revolute else "m/s",
        }
        for number, (joint, item) in enumerate(zip(arm.joints, motion, strict=True), start=1)
    ]


def objective_unit(minimize: str, figures: Mapping[str, Figure] = FIGURES) -> tuple[float, str]:
    """What one SI unit of the objective is in the unit that people read, and that unit: mm, kg or EUR."""
    return figures[minimize].factor, figures[minimize].unit


_GOALS = (("minimize", False), ("maximize", True))


def optimization_json(result: OptimizationResult) -> dict[str, Any]:
    """What `optimize --json` writes: the new design's figures, those before, and how it was found."""
    factor, unit = objective_unit(result.minimize, result.figures)

    def of(item: Any, *keys: str) -> dict[str, Any]:
        """With the objective of what was tried."""
        return {**fields(item, *keys), "objective": None if item.objective is None else factor * item.objective}

    names = ("shapes", "materials")
    ties = [
        {
            **of(tie, *names, "actuators", "mass_kg", "cost_EUR"),
            **fields(tie, "max_error_mm", "first_frequency_Hz"),
        }
        for tie in result.near_ties
    ]
    binding = ("name", "limit=text", "value", "limit_value=limit", "unit", "price", "price_unit", "assumed")
    rounds = ("number", "design_change", "poses", "worst_violation", "certified")
    answer = ("status", "interrupted", "optimum", "doubts", "subject_to=limits", "choose=choices", "start")
    return {
        "problem": PurePath(result.problem_file).name,
        **fields(result, *answer),
        **{key: result.minimize if more == result.minimised.more_is_better else None for key, more in _GOALS},
        "objective": _objective(result, result.objective),
        "lower_bound": _objective(result, result.lower_bound),
        "lower_bound_mm": factor * result.lower_bound if result.minimize == "max_error" else None,
        **fields(result, "lower_bound_of=bound_of", "lower_bound_gap", "basis"),
        **evaluation_figures(result.after, result.figures),
        "before": evaluation_figures(result.before, result.figures),
        **_worse(result, result.after),
        "binding": [fields(item, *binding) for item in result.binding],
        "iterations": len(result.iterations),
        "exchange_log": [{**of(iteration, *rounds), "objective_unit": unit} for iteration in result.iterations],
        "candidates": [of(candidate, *names, "outcome") for candidate in result.candidates],
        "dropped": [fields(item, "kind", "name", "limits", "why") for item in result.dropped],
        "near_ties": ties,
        "near_ties_not_solved": result.near_ties_left,
        "actuators": [of(drive, "actuators", "outcome") for drive in result.drives],
        "motor_places": [of(place, "places", "outcome") for place in result.motor_places],
        "base_mm": None if result.base is None else [1e3 * value for value in result.base],
        "balance": [
            fields(item, "words", "at", "field", "bound", "before_SI=before", "value_SI=value")
            for item in result.balance
        ],
        **fields(result, "exhaustive", "combinations", "combinations_gap=gap"),
        "combinations_unsolved": [fields(item, *names) for item in result.unsolved],
        **fields(result, "actuators_exhaustive=drives_exhaustive", "seconds"),
        "robust": None if result.robust is None else _robust(result, result.robust),
        "rounded": None if result.rounded is None else _rounded(result, result.rounded),
        "not_rounded": None if result.not_rounded is None else _not_rounded(result, result.not_rounded),
    }


def _objective(result: OptimizationResult, value: float) -> dict[str, Any]:
    factor, unit = objective_unit(result.minimize, result.figures)
    return {"value": factor * value, "unit": unit}


def _robust_figure(figure: RobustFigure) -> dict[str, Any]:
    """One arm's robust figure; `upper_mm` is null for the worst, and where the samples are too few for it."""
    return {
        **fields(figure, "share", "max_error_mm=value", "nominal_mm", "upper_mm", "looked_at"),
        "singles_mm": {name: 1e3 * error for name, error in figure.singles.items()},
        "rests_on": "sampled",
        "scenario": asdict(figure.scenario),
        "uncertain": {name: list(widths) for name, widths in figure.widths.items()},
    }


def _robust(result: OptimizationResult, robust: Robust) -> dict[str, Any]:
    """A robust optimum beside the nominal one."""
    return {
        **_robust_figure(robust.design),
        "nominal_optimum": _robust_figure(robust.nominal_design),
        "costs": _objective(result, robust.costs),
        **fields(robust, "loses_mm", "claimed_mm", "rounds", "samples", "kept_nominal", "doubts"),
        "scenarios": [asdict(scenario) for scenario in robust.scenarios],
    }


def _worse(result: OptimizationResult, evaluation: Evaluation) -> dict[str, Any]:
    """What a design does worse than the arm as given, in the units that people read, and which links bend sideways."""
    worse = [
        {
            "name": figure.figure.name,
            "before": figure.figure.shown(figure.before),
            "after": figure.figure.shown(figure.after),
            "unit": figure.figure.unit,
        }
        for figure in worse_figures(result.figures, result.before, evaluation)
    ]
    softer = softened_links(result.before, evaluation)
    return {"worse": worse, "softer_sideways": [{"link": k + 1, "share_of_before": kept} for k, kept in softer]}


def _rounded(result: OptimizationResult, rounded: Rounded) -> dict[str, Any]:
    """The design of sizes that can be had: its figures, and what rounding cost."""
    compared = ("designs_compared=compared", "designs_searched=searched", "exhaustive", "interrupted", "seconds")
    compared += ("not_rounded=kept",)
    cost = _objective(result, rounded.objective - rounded.before)
    return {
        **fields(rounded, "to", "length_step_mm", *compared),
        "objective": _objective(result, rounded.objective),
        "objective_before": _objective(result, rounded.before),
        "cost_of_rounding": {**cost, "relative": rounded.objective / rounded.before - 1.0},
        "limits": _limits(rounded.limits),
        **evaluation_figures(rounded.evaluation, result.figures),
        **_worse(result, rounded.evaluation),
    }


def _not_rounded(result: OptimizationResult, missing: NotRounded) -> dict[str, Any]:
    """Why there is no design of sizes that can be had, and the one that breaks the limits least."""
    nearest = None
    if missing.nearest is not None:
        nearest = {
            **fields(missing, "exceeds_a_limit_by=excess", "proven"),
            "limits": _limits(missing.limits),
            **evaluation_figures(missing.nearest, result.figures),
        }
    return {**fields(missing, "to", "length_step_mm", "reason", "seconds"), "nearest": nearest}


def _limits(limits: Sequence[KeptLimit]) -> list[dict[str, Any]]:
    return [
        {
            **fields(limit, "name", "limit=text"),
            "before": limit.figure.factor * limit.before,
            "value": limit.figure.factor * limit.after,
            "limit_value": limit.figure.factor * limit.value,
            "kept": limit.exceeded == 0.0,
            "exceeded_by": limit.exceeded,
        }
        for limit in limits
    ]


def infeasible_json(result: Infeasibility, problem: object = "") -> dict[str, Any]:
    """What `--json` writes where no design keeps all limits, in the units that people read."""

    def needed(needed_limit: Any, **more: object) -> dict[str, Any]:
        shown = needed_limit.limit.figure.shown(needed_limit.needed)
        return {**_asked(needed_limit.limit), "needed": shown, **more, "rests_on": result.rests_on}

    content = {
        "because": result.text,
        "out_of_reach": [
            {**_asked(item.limit), "best": item.limit.figure.shown(item.best), "because": item.because}
            for item in result.out_of_reach
        ],
        "limits": [needed(limit, outcome=limit.outcome) for limit in result.limits],
        "joint_change": [needed(item) for item in result.joint],
        **fields(result, "joint_sum", "combinations", "unsolved", "rests_on", "kept"),
    }
    return {"problem": PurePath(str(problem)).name, "status": result.verdict, "infeasible": content}


def _asked(limit: Limit) -> dict[str, Any]:
    content = {"asked": limit.figure.shown(limit.value)}
    return {
        **fields(limit, "name", "limit=text", "relation"),
        **content,
        **fields(limit, "unit=figure.unit", "assumed"),
    }
