"""What an arm as given can do: its worst position error and why, its mass, strength, frequency and compliance."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from types import MappingProxyType
from typing import Any

import numpy as np

from linkwright.core.arm.assumptions import notes_of
from linkwright.core.arm.chain.beam import Beam
from linkwright.core.arm.chain.chain import Arm, Calibrated, LoadCase
from linkwright.core.arm.chain.prices import fixed_price, price_by_length, price_by_mass
from linkwright.core.arm.chain.vectors import is_zero
from linkwright.core.arm.errors.first_order import BeyondFirstOrder, beyond_first_order
from linkwright.core.arm.errors.lost_motion import played
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model, rigid, values_of_rigid
from linkwright.core.arm.errors.parts import part_of
from linkwright.core.arm.errors.structure import Identity
from linkwright.core.arm.errors.tip import active_effects
from linkwright.core.arm.errors.unknown_mass import gives_unknown, of_unknown_mass, unknown_taken_out
from linkwright.core.arm.figures import FIGURES, DesignValues, FigureResult, OfLinks, PoseFamily, Totals, families_of
from linkwright.core.arm.figures.frequency import MODES, Frequency, frequency_of_drives
from linkwright.core.arm.figures.local_buckling import WALLS, LocalBuckling
from linkwright.core.arm.figures.motion.cycle import CYCLES
from linkwright.core.arm.figures.strength import STRENGTHS, StrengthResult
from linkwright.core.arm.figures.tip_stiffness import ACROSS, STIFFNESS, TipStiffness, tip_compliance, tips_of
from linkwright.core.arm.figures.torque import TORQUES, DriveLoads
from linkwright.core.arm.limits.joint_loads import JointLoad, joint_loads
from linkwright.core.arm.motion.dynamics import OfDrive
from linkwright.core.arm.worst.coverage import Unreached, unreached
from linkwright.core.arm.worst.growth import GrowthLeftOut, growth_left_out
from linkwright.core.arm.worst.parts import SeamErrors, projections_at, seam_errors, worst_search
from linkwright.core.arm.worst.search import DEFAULT_GAP, WorstCase, WorstPose
from linkwright.core.arm.worst.workspace import Workspace
from linkwright.core.materials.material import MissingProperty
from linkwright.core.materials.plausible import doubts_of
from linkwright.core.sections.numeric import Array

from .effects import EFFECTS

_CACHED = 8
"""Evaluations that are cached."""
_STRENGTH_POSES = 4096
_EXACT_POSES = 128


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
class Evaluation:
    """All that `evaluate` tells of an arm, in SI.

    `by_effect` is what each effect alone adds at the worst pose, `beyond` how far first order is off there. `mass` is
    that of the links (those of unknown mass have None). Figures that cannot be known from the arm's data are None, and
    `unknown` says why.
    """

    arm: Arm
    workspace: Workspace
    load_cases: tuple[LoadCase, ...]
    worst: WorstCase
    beyond: BeyondFirstOrder
    by_effect: Mapping[str, float]
    link_masses: tuple[float | None, ...]
    mass: float | None
    cost: float | None
    reach: float
    by_family: Mapping[str, Any]
    """What each family of figures through poses (see `figures.PoseFamily`) found, by its name."""
    compliance: Compliance
    warnings: tuple[str, ...]
    unknown: Mapping[str, str]
    unreached: Unreached | None = None
    """What of a box or path the arm does not reach; no figure counts there."""
    growth: GrowthLeftOut | None = None
    """The thermal growth that the model leaves out, where the arm works at another temperature than 20 degC."""
    seam: SeamErrors | None = None
    """On a path: the worst error, what of it is across the path and what along it."""
    frequency_of_drives: Frequency | None = None
    """The least first frequency that the drives would have on rigid links; None where no drive gives."""
    notes: tuple[str, ...] = ()
    """What is taken for granted because the files say nothing of it (`arm.assumptions`)."""
    rigid_links_error: float | None = None
    """The worst error (m) were the links rigid and weightless: what is not the links'; None where none gives."""

    def of(self, family: PoseFamily[FigureResult]) -> FigureResult | None:
        """What a family of figures finds; None where nothing has them, or they are not known. A family of a problem's
        own is looked at when it is asked for."""
        if family.name in self.by_family or family in families_of(FIGURES):
            return self.by_family.get(family.name)
        return family.evaluate(_design_of(self.arm, self.workspace, self.load_cases))

    @property
    def totals(self) -> Totals:
        """The sums over the links, and what is carried beside them; NaN where one is not known."""
        mass, cost = (math.nan if value is None else value for value in (self.mass, self.cost))
        payload = max(case.mass for case in self.load_cases)
        return Totals(mass, cost, self.reach, heaviest_carried(self.arm, self.load_cases), payload)

    @property
    def total_mass(self) -> float | None:
        """The mass of links, joints and the heaviest payload, kg; None where a mass is not known."""
        return None if self.mass is None else self.mass + self.totals.carried

    @property
    def strength(self) -> StrengthResult:
        """Stress, buckling and deflection of each link."""
        return self.by_family[STRENGTHS.name]

    @property
    def local_buckling(self) -> LocalBuckling:
        """How near each link's walls are to buckling."""
        return self.by_family[WALLS.name]

    @property
    def in_motion(self) -> tuple[OfDrive, ...] | None:
        """The most that the cycles of motion among the load cases ask of each drive; None where there are none."""
        loads = self.of(CYCLES)
        return None if loads is None else loads.by_joint

    @property
    def frequency(self) -> Frequency | None:
        """The least first bending frequency; None where nothing gives."""
        return self.of(MODES)

    @property
    def stiffness(self) -> TipStiffness | None:
        """The least stiffness at the tip; None where nothing gives."""
        return self.of(STIFFNESS)

    @property
    def sideways(self) -> TipStiffness | None:
        """That of a planar arm out of its plane; None in space, or where nothing gives."""
        return self.of(ACROSS)

    @property
    def drives(self) -> DriveLoads | None:
        """What the drives hold; None where no joint has an actuator."""
        return self.of(TORQUES)

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
    """Evaluate an arm over a workspace (its joint ranges by default) and load cases (its payload by default).

    `pose` (rad, m) is where the compliance is asked for; the worst pose by default. Raises `PropertyNeeded`,
    `MissingProperty`, `OutOfRange` or `Unreachable` where the question cannot be put.
    """
    cases = tuple(load_cases) or arm.cases
    at = None if pose is None else tuple(float(value) for value in pose)
    return _of_question(Identity(arm, workspace or Workspace(), cases, at, gap), families_of(FIGURES))


def _design_of(given: Arm, space: Workspace, cases: tuple[LoadCase, ...]) -> DesignValues:
    arm = unknown_taken_out(given, cases)
    search = worst_search(error_model(arm, cases), space)
    return DesignValues(arm, cases, search, beam_values(beams_of(arm, cases)), _STRENGTH_POSES)


@lru_cache(maxsize=_CACHED)
def _of_question(question: Identity, families: tuple[PoseFamily[Any], ...]) -> Evaluation:
    return _evaluated(families, *question.values)


def _evaluated(
    families: Sequence[PoseFamily[Any]],
    given: Arm,
    space: Workspace,
    cases: tuple[LoadCase, ...],
    pose: tuple[float, ...] | None,
    gap: float,
) -> Evaluation:
    unweighed = of_unknown_mass(given)
    arm = unknown_taken_out(given, cases)
    beams, model = beams_of(arm, cases), error_model(arm, cases)
    p, search = beam_values(beams), worst_search(model, space, gap=gap)
    worst = search.of_loads(search.worst(p))
    known = tuple(entry.q for entry in worst.poses)
    design = DesignValues(arm, cases, search, p, _STRENGTH_POSES, known)
    lacking = _lacking(unweighed, given)
    unknown: dict[str, str] = dict.fromkeys(("mass", "total_mass"), lacking["masses"]) if unweighed else {}
    masses = link_masses(beams)
    cost = _cost(arm, masses, unknown)
    results = _results_by_family(families, design, lacking, unknown)
    unknown |= _unknown_of_links(given, lacking)
    growth = growth_left_out(arm, cases, space, p, gap=gap)
    missed = unreached(space, lambda q: search.motion(q, p), search.lower, search.upper)
    top, tips = worst.poses[0], tips_of(cases)
    spread_poses = np.vstack([search.poses(p, _EXACT_POSES), known])
    counted = projections_at(model, space, search.tip(np.vstack([[top.q], spread_poses]), p))
    beyond = beyond_first_order(arm, cases, (top.q, top.load_case), spread_poses, counted)
    give = tip_compliance(arm, planar=model.planar, tips=tips if len(tips) == 1 else (cases[top.load_case].tip,))
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
        cost=cost,
        reach=max(sum(arm.lengths[index] for index in arm.on(tip).to_tip) for tip in tips),
        by_family=MappingProxyType(results),
        compliance=_compliance(where, give.matrices(where[None], p)[0]),
        warnings=(
            *([] if missed is None else [missed.text(space.kind)]),
            *([] if growth is None else [growth.words(worst.error)]),
            *idle_effects(arm),
            *warn_if_no_error_source(arm),
            *doubtful_materials(arm),
            *shapeless(beyond),
            *(
                line
                for family in families
                if family.name in results
                for line in family.warnings(arm, results[family.name])
            ),
        ),
        unknown=MappingProxyType(unknown),
        unreached=missed,
        growth=growth,
        seam=seam_errors(model, space, p, worst),
        frequency_of_drives=frequency_of_drives(arm, search, beams, p, cases) if MODES.name in results else None,
        notes=notes_of(given, cases),
        rigid_links_error=_rigid_links_error(design),
    )


def _results_by_family(
    families: Sequence[PoseFamily[Any]], design: DesignValues, lacking: Mapping[str, str], unknown: dict[str, str]
) -> dict[str, Any]:
    """What each family of figures finds of a design, by its name; why one is not known goes to `unknown`."""
    results: dict[str, Any] = {}
    for family in families:
        why = next((lacking[need] for need in sorted(family.needs) if need in lacking), None)
        value = None
        if why is None:
            try:
                value = family.evaluate(design)
            except MissingProperty as error:
                why = str(error)
        if why is None:
            unknown |= family.unknown(value)
        elif family.called:
            unknown[family.called] = why
        if value is not None:
            results[family.name] = value
    return results


def _unknown_of_links(arm: Arm, lacking: Mapping[str, str]) -> dict[str, str]:
    """Why figures that follow from the links alone are not known, by name."""
    reasons = {
        figure.name: why
        for figure in FIGURES.values()
        if isinstance(figure.follows, OfLinks) and (why := figure.follows.why_unknown(arm))
    }
    return reasons | ({"compliance": lacking["compliances"]} if "compliances" in lacking else {})


def _rigid_links_error(design: DesignValues) -> float | None:
    """The worst error (m) were the links rigid and weightless; None where none gives."""
    links = design.arm.links
    if not any(link.elastic for link in links):
        return None
    ideal = [_ideal(beam) if link.elastic else beam for beam, link in zip(design.beams, links, strict=True)]
    return design.search.worst(values_of_rigid(ideal), certify=False).error


def _ideal(beam: Beam) -> Beam:
    """A link that neither gives nor weighs, with what hangs on it."""
    return replace(rigid(beam), lumped_mass=beam.lumped_mass, lumped_at=beam.lumped_at, first_moment=beam.first_moment)


def _lacking(unweighed: Sequence[int], arm: Arm) -> dict[str, str]:
    """Why `masses` are not known, or `compliances`, which may show only as products with them."""
    reasons: dict[str, str] = {}
    if unweighed:
        numbers = ", ".join(str(index + 1) for index in unweighed)
        reasons["masses"] = f"nobody knows the mass of link{'s' if len(unweighed) > 1 else ''} {numbers}"
    products = gives_unknown(arm)
    if products:
        reasons["compliances"] = f"of {', '.join(products)} nothing is known but the product with an unknown weight"
    return reasons


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
    errors: dict[str, float] = {}
    for active in active_effects(arm):
        name = active.effect.id
        if name in errors or not active.effect.moves_tip:
            continue
        model = error_model(arm, (load,), only=name)
        model = model if projection is None else part_of(model, [projection])
        case = model.cases[0]
        if is_zero(case.error.vector) and not case.error.intervals and not case.error.discs:
            continue  # the arm has no data for it
        alone = played(case.arrays(q, p), case.radii, arm.play, planar=model.planar, statistics=arm.statistics)
        errors[name] = float(alone.error[0])
    return {name: errors[name] for name in EFFECTS if name in errors}


def compliance_at(arm: Arm, beams: Sequence[Beam], q: Sequence[float], *, planar: bool) -> Compliance:
    """The tip's compliance at a pose, by unit forces through the arm's model (its deterministic part)."""
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
        conditions = {"loaded_for": "time under load", "last_moves": "the reading before"}
        missing = [conditions.get(name, name) for name in requires if name != "warming"]
        if missing:
            needs = " and ".join(missing)
            lines.append(f"{entry.effect} adds nothing here: it needs what only a recording holds ({needs})")
    return lines


def warn_if_no_error_source(arm: Arm) -> list[str]:
    """One line where the arm's file holds nothing that moves the tip: an error of zero then says nothing."""
    gives = any(joint.stiffness is not None or joint.zones or joint.backlash or joint.clearance for joint in arm.joints)
    gives = gives or any(joint.tilting_stiffness is not None or joint.guide is not None for joint in arm.joints)
    gives = gives or any(link.flange is not None or link.compliance is not None for link in arm.links)
    if gives or arm.effects or any(link.elastic for link in arm.links):
        return []
    return [
        "nothing in this arm file makes the tip err: no play, no drive that gives, no link that bends. Write joints' "
        "stiffness, backlash or clearance, or links' section and material"
    ]


def shapeless(beyond: BeyondFirstOrder) -> list[str]:
    """One line where the arm finds no shape under its loads."""
    if beyond.largest is not None:
        return []
    where = "at the worst pose" if beyond.at_worst is None else "at some poses"
    return [f"under its loads the arm finds no shape {where}: the error printed, to first order, means nothing there"]
