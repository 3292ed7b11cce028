"""What an arm as given can do: its worst position error and why, its mass, strength, frequency and compliance."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from types import MappingProxyType

import numpy as np

from linkwright.core.arm.assumptions import notes_of
from linkwright.core.arm.chain.beam import Beam
from linkwright.core.arm.chain.chain import Arm, Calibrated, LoadCase
from linkwright.core.arm.chain.prices import fixed_price, price_by_length, price_by_mass
from linkwright.core.arm.chain.vectors import is_zero
from linkwright.core.arm.errors.first_order import BeyondFirstOrder, beyond_first_order
from linkwright.core.arm.errors.lost_motion import played
from linkwright.core.arm.errors.model import ErrorModel, beam_values, beams_of, error_model
from linkwright.core.arm.errors.parts import part_of
from linkwright.core.arm.errors.rigid_links import rigid, values_of_rigid
from linkwright.core.arm.errors.structure import Identity
from linkwright.core.arm.errors.tip import active_effects
from linkwright.core.arm.errors.unknown_mass import gives_unknown, of_unknown_mass, unknown_taken_out
from linkwright.core.arm.limits.drive_loads import DriveLoads, drive_case, greatest_drive_loads
from linkwright.core.arm.limits.joint_loads import JointLoad, joint_loads
from linkwright.core.arm.limits.local_buckling import LocalBuckling, buckling_walls, loads_case, local_buckling
from linkwright.core.arm.limits.sideways import least_sideways
from linkwright.core.arm.limits.slowest_pose import Frequency, frequency_of_drives, least_frequency
from linkwright.core.arm.limits.strength import (
    LARGEST_DEFLECTION,
    StrengthResult,
    strength_case,
    strength_values,
    worst_strength,
)
from linkwright.core.arm.limits.tip_stiffness import TipStiffness, least_stiffness, tip_compliance, tips_of
from linkwright.core.arm.limits.walls import WallsResult, walls_of
from linkwright.core.arm.limits.weakest_poses import weakest_poses
from linkwright.core.arm.worst.coverage import Unreached, unreached
from linkwright.core.arm.worst.growth import GrowthLeftOut, growth_left_out
from linkwright.core.arm.worst.parts import SeamErrors, projections_at, seam_errors, worst_search
from linkwright.core.arm.worst.search import DEFAULT_GAP, WorstCase, WorstPose, WorstSearch
from linkwright.core.arm.worst.workspace import Workspace
from linkwright.core.materials.material import MissingProperty
from linkwright.core.materials.plausible import doubts_of
from linkwright.core.sections.numeric import Array

from .effects import EFFECTS

_CACHED = 8
"""Evaluations that are cached."""
_STRENGTH_POSES = 4096
_EXACT_POSES = 128
_MAPPED_POSES = 100_000


@dataclass(frozen=True)
class Compliance:
    """The tip's compliance at a pose: displacement per force in the base frame.

    `matrix` (d, d) in m/N, d = 2 in the plane; `principal` its singular values (the semi-axes, in m, of the ellipse
    that the tip describes when a force of 1 N turns through all directions), largest first, and `directions` (d rows)
    the unit vectors along those semi-axes.
    """

    q: tuple[float, ...]
    matrix: tuple[tuple[float, ...], ...]
    principal: tuple[float, ...]
    directions: tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class ErrorMap:
    """The worst error (m) met at each place of the tip: `worst` (rows along `vertical`, columns along `horizontal`).

    In the plane `horizontal` and `vertical` are the edges (m) of cells in x and y; in space they are the distance from
    the base's z axis, and z. NaN where no pose looked at puts the tip.
    """

    planar: bool
    horizontal: Array
    vertical: Array
    worst: Array


@dataclass(frozen=True)
class Evaluation:
    """All that `evaluate` tells of an arm, in SI.

    `by_effect` is what each effect alone adds at the worst pose, `beyond` how far first order is off there. `mass` is
    that of the links (those of unknown mass have None), `total_mass` adds joints and the heaviest payload. Figures that
    cannot be known from the arm's data are None, and `unknown` says why.
    """

    arm: Arm
    workspace: Workspace
    load_cases: tuple[LoadCase, ...]
    worst: WorstCase
    beyond: BeyondFirstOrder
    by_effect: Mapping[str, float]
    link_masses: tuple[float | None, ...]
    mass: float | None
    total_mass: float | None
    cost: float | None
    reach: float
    strength: StrengthResult
    walls: WallsResult
    local_buckling: LocalBuckling
    frequency: Frequency | None
    stiffness: TipStiffness | None
    compliance: Compliance
    warnings: tuple[str, ...]
    unknown: Mapping[str, str]
    drives: DriveLoads | None = None
    """What the drives hold, where some joint has an actuator."""
    unreached: Unreached | None = None
    """What of a box or path the arm does not reach; no figure counts there."""
    growth: GrowthLeftOut | None = None
    """The thermal growth that the model leaves out, where the arm works at another temperature than 20 degC."""
    sideways: TipStiffness | None = None
    """The least stiffness of a planar arm's tip out of its plane; None in space, or where nothing gives."""
    seam: SeamErrors | None = None
    """On a path: the worst error, what of it is across the path and what along it."""
    frequency_of_drives: Frequency | None = None
    """The least first frequency that the drives would have on rigid links; None where no drive gives."""
    notes: tuple[str, ...] = ()
    """What is taken for granted because the files say nothing of it (`arm.assumptions`)."""
    rigid_links_error: float | None = None
    """The worst error (m) were the links rigid and weightless: what is not the links'; None where none gives."""

    @property
    def relative_to(self) -> Calibrated | None:
        """The calibrated state that errors count from; None where the whole error counts."""
        return self.load_cases[0].relative_to

    @property
    def joint_loads(self) -> tuple[JointLoad, ...] | None:
        """What each joint carries at the worst pose in its load case; None where a mass is not known."""
        top = self.worst.poses[0]
        return None if of_unknown_mass(self.arm) else joint_loads(self.arm, self.load_cases[top.load_case], top.q)

    @property
    def max_error(self) -> float:
        """The worst position error over the workspace and all load cases, m, to first order; relative to the calibrated
        state where there is one, and only the part of it that the workspace counts."""
        return self.worst.error

    @property
    def upper_bound(self) -> float | None:
        """The bound to first order (certified where `worst.certified`), and the most by which samples of poses were
        longer beyond it (no certificate covers that), m. None where either is not known."""
        if self.worst.upper_bound is None or self.beyond.longer is None:
            return None
        return self.worst.upper_bound + self.beyond.longer


def evaluate(
    arm: Arm,
    workspace: Workspace | None = None,
    load_cases: Sequence[LoadCase] = (),
    *,
    pose: Sequence[float] | None = None,
    gap: float = DEFAULT_GAP,
) -> Evaluation:
    """Evaluate an arm over a workspace (its joint ranges by default) and load cases (its own payload by default).

    `pose` (rad, m) is where the compliance is asked for; the worst pose by default. Raises `PropertyNeeded`,
    `MissingProperty`, `OutOfRange` or `Unreachable` where the question cannot be put.
    """
    cases = tuple(load_cases) or arm.cases
    at = None if pose is None else tuple(float(value) for value in pose)
    return _of_question(Identity(arm, workspace or Workspace(), cases, at, gap))


@lru_cache(maxsize=_CACHED)
def _of_question(question: Identity) -> Evaluation:
    return _evaluated(*question.values)


@dataclass(frozen=True)
class _Design:
    """An arm of known masses under its load cases, with what all its figures take: a design p (see `beam_values`), the
    search of its workspace, and poses (N, n) spread over that."""

    arm: Arm
    cases: tuple[LoadCase, ...]
    model: ErrorModel
    beams: tuple[Beam, ...]
    p: Array
    search: WorstSearch
    worst: WorstCase
    poses: Array


def _design(arm: Arm, space: Workspace, cases: tuple[LoadCase, ...], gap: float) -> _Design:
    beams = beams_of(arm, cases)
    p = beam_values(beams)
    model = error_model(arm, cases)
    search = worst_search(model, space, gap=gap)
    worst = search.of_loads(search.worst(p))
    poses = np.vstack([search.poses(p, _STRENGTH_POSES), [entry.q for entry in worst.poses]])
    return _Design(arm, cases, model, beams, p, search, worst, poses)


def _evaluated(
    given: Arm, space: Workspace, cases: tuple[LoadCase, ...], pose: tuple[float, ...] | None, gap: float
) -> Evaluation:
    unweighed = of_unknown_mass(given)
    of = _design(unknown_taken_out(given, cases), space, cases, gap)
    arm, beams, p, search, worst, poses = of.arm, of.beams, of.p, of.search, of.worst, of.poses
    unknown = _lacking_masses(unweighed, given)
    masses = link_masses(beams)
    cost = _cost(arm, masses, unknown)
    strength, walls, buckling = _strength(of, unknown)
    sideways = _sideways(of, unknown)
    frequency = None if unweighed else least_frequency(arm, search, beams, p, cases)
    if frequency is None and not unweighed:
        unknown["first_frequency"] = "nothing in the model gives, so there is no bending frequency"
    drives = None if unweighed else _drives(of)
    growth = growth_left_out(arm, cases, space, p, gap=gap)
    missed = unreached(space, lambda q: search.motion(q, p), search.lower, search.upper)
    top, tips = worst.poses[0], tips_of(cases)
    spread_poses = np.vstack([search.poses(p, _EXACT_POSES), [entry.q for entry in worst.poses]])
    counted = projections_at(of.model, space, search.tip(np.vstack([[top.q], spread_poses]), p))
    beyond = beyond_first_order(arm, cases, (top.q, top.load_case), spread_poses, counted)
    give = tip_compliance(arm, planar=of.model.planar, tips=tips)
    own = give if len(tips) == 1 else tip_compliance(arm, planar=of.model.planar, tips=(cases[top.load_case].tip,))
    where = np.array(top.q if pose is None else pose)
    return Evaluation(
        arm=given,
        workspace=space,
        load_cases=cases,
        worst=worst,
        beyond=beyond,
        by_effect=MappingProxyType(
            effects_at(arm, cases[top.load_case], p, top, None if counted is None else counted[0])
        ),
        link_masses=tuple(None if index in unweighed else mass for index, mass in enumerate(masses)),
        mass=None if unweighed else sum(masses),
        total_mass=None if unweighed else sum(masses) + heaviest_carried(arm, cases),
        cost=cost,
        reach=max(sum(arm.lengths[index] for index in arm.on(tip).to_tip) for tip in tips),
        strength=strength,
        walls=walls,
        local_buckling=buckling,
        frequency=frequency,
        stiffness=None if gives_unknown(given) else least_stiffness(give, poses, p, search),
        compliance=_compliance(where, own.matrices(where[None], p)[0]),
        warnings=(
            *([] if missed is None else [missed.text(space.kind)]),
            *([] if growth is None else [growth.words(worst.error)]),
            *idle_effects(arm),
            *nothing_errs(arm),
            *doubtful_materials(arm),
            *shapeless(beyond),
            *warnings_of(strength),
            *buckling_walls(buckling),
            *overloaded(arm, drives),
        ),
        unknown=MappingProxyType(unknown),
        drives=drives,
        unreached=missed,
        growth=growth,
        sideways=sideways,
        seam=seam_errors(of.model, space, p, worst),
        frequency_of_drives=None if frequency is None else frequency_of_drives(arm, search, beams, p, cases),
        notes=notes_of(given, cases),
        rigid_links_error=_rigid_links_error(of),
    )


def _strength(of: _Design, unknown: dict[str, str]) -> tuple[StrengthResult, WallsResult, LocalBuckling]:
    """Strength, walls and how near those are to buckling; why one is not known goes to `unknown`."""
    strength = strength_over(of.arm, of.cases, of.poses, of.p, of.search)
    walls = walls_of(of.arm)
    loads = [loads_case(of.arm, case) for case in of.cases]
    buckling = local_buckling(of.arm, loads, of.beams, of.poses, of.p, of.search)
    if strength.least_safety_factor is None:
        unknown["min_safety_factor"] = "a link's material has no yield strength, or no link has a section"
    if walls.unknown is not None:
        unknown["wall_slenderness"] = walls.unknown
    if buckling.unknown is not None:
        unknown["local_buckling"] = buckling.unknown
    return strength, walls, buckling


def _sideways(of: _Design, unknown: dict[str, str]) -> TipStiffness | None:
    """A planar arm's least stiffness out of its plane; why it is not known goes to `unknown`."""
    try:
        return least_sideways(of.arm, of.cases, of.poses, of.search) if of.model.planar else None
    except MissingProperty as error:
        unknown["sideways_stiffness"] = str(error)
        return None


def _drives(of: _Design) -> DriveLoads | None:
    """What the drives hold; None where no joint has an actuator."""
    if all(joint.actuator is None for joint in of.arm.joints):
        return None
    return greatest_drive_loads(of.arm, [drive_case(of.arm, case) for case in of.cases], of.poses, of.p, of.search)


def _rigid_links_error(of: _Design) -> float | None:
    """The worst error (m) were the links rigid and weightless; None where none gives."""
    if not any(link.elastic for link in of.arm.links):
        return None
    ideal = [_ideal(beam) if link.elastic else beam for beam, link in zip(of.beams, of.arm.links, strict=True)]
    return of.search.worst(values_of_rigid(ideal), certify=False).error


def _ideal(beam: Beam) -> Beam:
    """A link that neither gives nor weighs, with what hangs on it."""
    return replace(rigid(beam), lumped_mass=beam.lumped_mass, lumped_at=beam.lumped_at, first_moment=beam.first_moment)


def _lacking_masses(unweighed: Sequence[int], arm: Arm) -> dict[str, str]:
    """What cannot be known for want of masses, or of compliances that show only as products with them, and why."""
    found: dict[str, str] = {}
    if unweighed:
        numbers = ", ".join(str(index + 1) for index in unweighed)
        why = f"nobody knows the mass of link{'s' if len(unweighed) > 1 else ''} {numbers}"
        found = dict.fromkeys(("mass", "total_mass", "first_frequency", "drive_loads"), why)
    products = gives_unknown(arm)
    if products:
        why = f"of {', '.join(products)} nothing is known but the product with an unknown weight"
        found |= dict.fromkeys(("tip_stiffness", "compliance"), why)
    return found


def doubtful_materials(arm: Arm) -> tuple[str, ...]:
    """What is hardly believable of the materials' figures, once for each material."""
    made_of = dict.fromkeys(link.material for link in arm.links if link.material is not None)
    return tuple(doubt for material in made_of for doubt in doubts_of(material))


def heaviest_carried(arm: Arm, cases: Sequence[LoadCase]) -> float:
    """The masses beside the links' (kg): joints, motors, what hangs on links, and payloads, where those of a load case
    are the heaviest."""
    return max(arm.on(case.tip).carried_mass + case.mass for case in cases)


def link_masses(beams: Sequence[Beam]) -> tuple[float, ...]:
    """The links' masses, kg."""
    return tuple(float(beam.mass) for beam in beams)


def material_cost(arm: Arm, masses: Sequence[float]) -> float | None:
    """What links, joints and drives cost together (EUR); None where a price is not known."""
    return _cost(arm, masses, {})


def _cost(arm: Arm, masses: Sequence[float], unknown: dict[str, str]) -> float | None:
    total = 0.0
    for index, (link, mass) in enumerate(zip(arm.links, masses, strict=True)):
        if link.material is None:
            continue
        if not link.material.has("cost"):
            unknown["cost"] = f"the material of link {index + 1} has no cost"
            return None
        total += mass * price_by_mass(arm, link.material) + price_by_length(arm) * link.length
    fixed, lacking = fixed_price(arm)
    if lacking:
        unknown["cost"] = lacking
        return None
    return total + fixed


def effects_at(
    arm: Arm, load: LoadCase, p: Array, pose: WorstPose, projection: Array | None = None
) -> dict[str, float]:
    """What each effect of the model alone adds at a pose (m); play as the arm's mode counts it. `projection` (3, 3)
    leaves the part of the error that counts, all of it by default."""
    q = np.array([pose.q])
    found: dict[str, float] = {}
    for active in active_effects(arm):
        name = active.effect.id
        if name in found:
            continue
        model = error_model(arm, (load,), only=name)
        model = model if projection is None else part_of(model, [projection])
        case = model.cases[0]
        if is_zero(case.error.vector) and not case.error.intervals and not case.error.discs:
            continue  # the arm has no data for it
        alone = played(case.arrays(q, p), case.radii, arm.play, planar=model.planar, statistics=arm.statistics)
        found[name] = float(alone.error[0])
    return {name: found[name] for name in EFFECTS if name in found}


def strength_over(
    arm: Arm, cases: Sequence[LoadCase], poses: Array, p: Array, search: WorstSearch | None = None
) -> StrengthResult:
    """The worst strength of the links over poses (N, n) and load cases; with `search` over its whole workspace,
    the poses being where climbs to greater stress and compression start."""
    # The moduli do not depend on Poisson's ratio, so a material without one will do.
    sections = [None if link.section is None else link.section.properties(0.3) for link in arm.links]
    yields = [
        link.material.need("yield_strength", arm.temperature)
        if link.elastic and link.material is not None and link.material.has("yield_strength")
        else None
        for link in arm.links
    ]
    found = [strength_case(arm, case) for case in cases]
    values = strength_values(sections)
    if search is not None:
        poses = np.vstack([poses, weakest_poses(search, found, poses, p, values)])
    return worst_strength(found, poses, p, values, yields)


def compliance_at(arm: Arm, beams: Sequence[Beam], q: Sequence[float], *, planar: bool) -> Compliance:
    """The tip's compliance at a pose, by unit forces through the arm's own model (its deterministic part)."""
    place = np.array([tuple(float(value) for value in q)])
    matrix = tip_compliance(arm, planar=planar).matrices(place, beam_values(beams))[0]
    return _compliance(place[0], matrix)


def _compliance(q: Array, matrix: Array) -> Compliance:
    left, values, _ = np.linalg.svd(matrix)
    return Compliance(
        tuple(q.tolist()),
        tuple(tuple(row) for row in matrix.tolist()),
        tuple(values.tolist()),
        tuple(tuple(column) for column in left.T.tolist()),
    )


def idle_effects(arm: Arm) -> list[str]:
    """One line for each of the arm's `effects` that says nothing of a design, for want of what only a recording
    holds."""
    lines: list[str] = []
    for entry in arm.effects:
        requires = EFFECTS[entry.effect].requires  # but for warming: a design has its arm's temperature
        told = {"loaded_for": "time under load", "last_moves": "the reading before"}
        missing = [told.get(name, name) for name in requires if name != "warming"]
        if missing:
            needs = " and ".join(missing)
            lines.append(f"{entry.effect} adds nothing here: it needs what only a recording holds ({needs})")
    return lines


def nothing_errs(arm: Arm) -> list[str]:
    """One line where the arm's file holds nothing that moves the tip: an error of zero then says nothing."""
    gives = any(joint.stiffness is not None or joint.zones or joint.backlash or joint.clearance for joint in arm.joints)
    gives = gives or any(joint.tilting_stiffness is not None for joint in arm.joints)
    if gives or arm.effects or any(link.elastic for link in arm.links):
        return []
    return [
        "nothing in this arm file makes the tip err: it has no play, no drive that gives, no link that bends; joints' "
        "stiffness, backlash and clearance and links' section and material would"
    ]


def shapeless(beyond: BeyondFirstOrder) -> list[str]:
    """One line where the arm finds no shape under its loads."""
    if beyond.largest is not None:
        return []
    where = "at the worst pose" if beyond.at_worst is None else "at some poses"
    return [f"under its loads the arm finds no shape {where}: the error printed, to first order, means nothing there"]


def warnings_of(strength: StrengthResult) -> list[str]:
    """One line for each link that yields, buckles, or bends beyond a tenth of its length."""
    lines: list[str] = []
    for index, link in enumerate(strength.links):
        factor, buckling = strength.safety_factor[index], strength.buckling[index]
        name = f"link {link + 1}"
        if strength.deflection[index] > LARGEST_DEFLECTION:
            share = strength.deflection[index]
            lines.append(
                f"{name} bends by {share:.3g} of its length: beyond a tenth, linear theory (and so the error printed) "
                "means nothing"
            )
        if factor is not None and factor < 1.0:
            lines.append(f"{name} yields: {strength.stress[index] / 1e6:.4g} MPa, safety factor {factor:.3g}")
        if math.isfinite(buckling) and buckling < 1.0:
            lines.append(f"{name} buckles: the compression is {1.0 / buckling:.3g} times Euler's load")
    return lines


def overloaded(arm: Arm, drives: DriveLoads | None) -> list[str]:
    """One line for each joint whose drive has to hold more than its actuator's rated torque."""
    lines: list[str] = []
    for index, joint in enumerate(arm.joints):
        if drives is not None and joint.actuator is not None and drives.greatest[index] > joint.actuator.rated_torque:
            held, rated = drives.greatest[index], joint.actuator.rated_torque
            lines.append(
                f"joint {index + 1} holds up to {held:.4g} N*m, more than the rated {rated:.4g} N*m of "
                f"{joint.actuator.name}"
            )
    return lines


def error_map(search: WorstSearch, p: Array, *, poses: int | None = None, cells: int = 90) -> ErrorMap:
    """The worst error met at each place of the tip, from a scan of spread poses of the workspace and its worst
    poses."""
    model: ErrorModel = search.model
    wanted = poses or (_MAPPED_POSES if model.planar else _MAPPED_POSES // 3)
    seeds = [search.poses(p, search.scan, seed) for seed in range(1, 1 + max(1, wanted // search.scan))]
    q = np.vstack(seeds)
    errors = [search.errors(q, p, case).error for case in range(len(model.cases))]
    named = tips_of([case.load for case in model.cases])
    own = {name: error_model(model.arm.on(name), (LoadCase(),)).tip for name in named if name}
    if own:
        # Of several tips each has its own places.
        tips = np.vstack([own[case.load.tip](q, p)[0] for case in model.cases])
        error, q = np.concatenate(errors), np.tile(q, (len(errors), 1))
    else:
        tips, error = search.tip(q, p), np.max(errors, axis=0)
    if model.planar:
        across, up = tips[:, 0], tips[:, 1]
    else:
        across, up = np.hypot(tips[:, 0], tips[:, 1]), tips[:, 2]
    span = max(np.ptp(across), np.ptp(up), 1e-9) / cells
    horizontal = np.arange(across.min(), across.max() + span, span)
    vertical = np.arange(up.min(), up.max() + span, span)
    worst = np.full((len(vertical), len(horizontal)), np.nan)
    column = np.clip(((across - horizontal[0]) / span).astype(int), 0, len(horizontal) - 1)
    row = np.clip(((up - vertical[0]) / span).astype(int), 0, len(vertical) - 1)
    order = np.argsort(error)
    worst[row[order], column[order]] = error[order]
    edges = (np.append(horizontal, horizontal[-1] + span), np.append(vertical, vertical[-1] + span))
    return ErrorMap(model.planar, edges[0], edges[1], worst)
