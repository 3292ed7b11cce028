"""What no design can reach, whatever its shapes, materials and sizes: bounds that take no search for designs.

Each rests on an arm that no design can be better than: links as light as the lightest section and as stiff as the
stiffest (or weightless and rigid), with the stiffest, lightest and closest drives that may be chosen. By Rayleigh's
principle no frequency is above that of an arm that is stiffer and lighter; compliances and, where no two terms cancel
(`optimize.choice.products`), errors add up term by term. No link keeps farther away than a line in its place.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from types import MappingProxyType

import numpy as np

from linkwright.core.arm.chain.beam import Beam
from linkwright.core.arm.chain.chain import Arm, Joint
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model, values_of_rigid
from linkwright.core.arm.errors.model import rigid as rigid_beam
from linkwright.core.arm.evaluation import link_masses
from linkwright.core.arm.figures import KEPT_WITHIN, Limit, ThroughPoses, WorstError, excess
from linkwright.core.arm.figures.design import DesignValues
from linkwright.core.arm.worst.parts import worst_search
from linkwright.core.arm.worst.search import WorstSearch
from linkwright.core.arm.worst.workspace import Unreachable
from linkwright.core.materials.material import Material
from linkwright.core.optimize.balance.balance import with_least_counterweights
from linkwright.core.optimize.choice.driven import with_actuator
from linkwright.core.optimize.choice.picks import options
from linkwright.core.optimize.choice.pose_products import one_signed
from linkwright.core.optimize.exchange.design import with_chosen_links
from linkwright.core.optimize.exchange.program import cut_of
from linkwright.core.optimize.exchange.totals import carried_mass, drives_cost, fixed_error
from linkwright.core.optimize.problem import Problem
from linkwright.core.sections import SHAPES
from linkwright.core.sections.numeric import Array

from .answer import OutOfReach

_LEAST, _GREATEST = 1e-12, 1e3
"""Areas (m^2) below and above those of any section: shapes start from the nearest that they can have."""
_POSES = 512
_SURE = 1e-6
"""A bound counts from this far (relative) beyond the limit."""


@dataclass(frozen=True)
class _Extremes:
    """What the options of a link have: the least mass (kg/m), the greatest rigidities, and the span of the thermal
    expansion (1/K, none counts as zero)."""

    lightest: float
    axial: float
    height: float
    width: float
    torsion: float
    expansion: tuple[float, float]

    @property
    def least_expansion(self) -> float:
        """The expansion that is nearest to none."""
        low, high = self.expansion
        return max(low, min(high, 0.0))


def out_of_reach(problem: Problem) -> tuple[OutOfReach, ...]:
    """The limits that no design of any combination keeps, by bounds that are found at once; few where lengths are
    free, for they say little then."""
    problem = with_chosen_links(problem)
    if problem.free_lengths:
        return ()
    return tuple(_through_poses(problem, _extremes(problem)))


def least_objective(problem: Problem) -> float:
    """The total mass (kg) or cost (EUR) that no links on an arm's drives go below, where that is minimised; minus
    infinity of another objective."""
    if problem.minimize == "cost":
        return drives_cost(problem)
    if problem.minimize != "total_mass":
        return -math.inf
    free = problem.free_lengths or problem.free_tapers or problem.sizes is not None
    least = {} if free else _extremes(with_chosen_links(problem))
    links = [
        (least[index].lightest * link.length if index in least else 0.0) if link.elastic else mass
        for index, (link, mass) in enumerate(zip(problem.arm.links, link_masses(beams_of(problem.arm)), strict=True))
    ]
    return sum(links) + carried_mass(replace(problem, arm=with_least_counterweights(problem.arm, problem.balances)))


def _beyond(bound: OutOfReach) -> bool:
    return excess(bound.limit, bound.best) > max(_SURE, KEPT_WITHIN)


# ---- what the links are at best


def _extremes(problem: Problem) -> dict[int, _Extremes]:
    shapes, materials = options(problem)
    extremes: dict[int, _Extremes] = {}
    for link, (link_shapes, link_materials) in enumerate(zip(shapes, materials, strict=True)):
        pairs = [(shape, material) for shape in link_shapes if shape for material in link_materials if material]
        if pairs:
            extremes[link] = _link_extremes(problem, link, pairs)
    return extremes


def _link_extremes(problem: Problem, link: int, pairs: Sequence[tuple[str, Material]]) -> _Extremes:
    ranges = problem.ranges[link].sizes
    lightest: list[float] = []
    rows: list[tuple[float, ...]] = []
    for shape, item in pairs:
        least, most = (SHAPES[shape].start(area, *ranges).properties(0.3) for area in (_LEAST, _GREATEST))
        material = item.at(problem.arm.temperature)
        density, modulus = material.need("density"), material.need("elastic_modulus")
        # Nothing else is known of a shear modulus that is not: the largest that an isotropic material can have.
        shear = 0.5 * modulus if material.shear_modulus is None else material.shear_modulus
        stiff = (float(most.area), float(most.second_moment_y), float(most.second_moment_z))
        lightest.append(density * float(least.area))
        rows.append((*(modulus * x for x in stiff), shear * float(most.torsion_constant)))
    grows = [stuff.at(problem.arm.temperature).thermal_expansion or 0.0 for _, stuff in pairs]
    axial, height, width, torsion = np.array(rows).max(axis=0).tolist()
    return _Extremes(min(lightest), axial, height, width, torsion, (min(grows), max(grows)))


def _ideal(problem: Problem) -> Arm:
    """The arm with drives that have the best of every actuator that may be chosen, in the stiffest of its zones, and
    with the lightest counterweights, as near to their joints as they may be."""
    arm = with_least_counterweights(problem.arm, problem.balances)
    lists = problem.actuators or ((),) * arm.size
    joints = [
        _best_of(joint, [with_actuator(joint, item) for item in joint_actuators] or [joint])
        for joint, joint_actuators in zip(arm.joints, lists, strict=True)
    ]
    return replace(arm, joints=tuple(joints))


def _best_of(joint: Joint, driven: Sequence[Joint]) -> Joint:
    """A joint with the best that it has, figure by figure, with any of its drives."""
    stiff = [max((item for _, item in one.zones), default=one.stiffness) for one in driven]
    return replace(
        joint,
        stiffness=_stiffest(stiff),
        zones=(),
        backlash=min(one.backlash for one in driven),
        mass=min(one.mass for one in driven),
        tilting_stiffness=_stiffest([one.tilting_stiffness for one in driven]),
    )


def _stiffest(values: Sequence[float | None]) -> float | None:
    """The greatest stiffness; None, which is rigid, where one is."""
    known = [value for value in values if value is not None]
    return max(known) if len(known) == len(values) else None


# ---- figures at poses


@dataclass(frozen=True)
class _Ideal(DesignValues):
    """An arm that no design can be better than, with beams of its own."""

    given: tuple[Beam, ...] = ()

    @cached_property
    def beams(self) -> tuple[Beam, ...]:
        """The links as beams."""
        return self.given


def _through_poses(problem: Problem, extremes: dict[int, _Extremes]) -> list[OutOfReach]:
    if not any(_bounded(limit) for limit in problem.limits):
        return []
    problem = replace(problem, arm=_ideal(problem))
    arm, cases = problem.arm, problem.load_cases
    search = worst_search(error_model(arm, cases), problem.workspace)
    beams = beams_of(arm, cases)
    ideals: dict[str, _Ideal] = {}
    for words, rigid in _IDEALS.items():
        given = _beams(arm, beams, extremes, rigid=rigid)
        ideals[words] = _Ideal(arm, cases, search, values_of_rigid(given), _POSES, given=given)
    thin: dict[str, _Ideal] = {}
    if any(map(_is_of_thickness, problem.limits)):
        thin["links without thickness"] = _without_thickness(next(iter(ideals.values())))
    unreachable: list[OutOfReach] = []
    try:
        for number, limit in enumerate(problem.limits):
            for words, ideal in (thin if _is_of_thickness(limit) else ideals).items():
                best = _best(problem, number, ideal, extremes) if _bounded(limit) else None
                verb = "err by" if isinstance(limit.figure.follows, WorstError) else "reach"
                bound = None if best is None else OutOfReach(limit, best, f"{words} {verb}")
                if bound is not None and _beyond(bound):
                    unreachable.append(bound)
                    break
    except Unreachable:
        pass  # the search for designs tells of that
    return unreachable


_IDEALS = MappingProxyType(
    {
        "rigid, weightless links on these joints": True,
        "the stiffest and lightest links that may be chosen": False,
    }
)
"""Links that no design can be better than, in words, and whether they are rigid."""


def _bounded(limit: Limit) -> bool:
    follows = limit.figure.follows
    if isinstance(follows, ThroughPoses):
        return follows.family.stiffer_is_better or _is_of_thickness(limit)
    return isinstance(follows, WorstError)


def _without_thickness(ideal: _Ideal) -> _Ideal:
    """The arm with links that are lines."""
    links = (replace(link, section=None, material=None, mass=0.0) for link in ideal.arm.links)
    return replace(ideal, arm=ideal.arm.with_links(tuple(links)))


def _is_of_thickness(limit: Limit) -> bool:
    follows = limit.figure.follows
    return isinstance(follows, ThroughPoses) and follows.family.thinner_is_better


def _beams(arm: Arm, beams: Sequence[Beam], extremes: dict[int, _Extremes], *, rigid: bool) -> tuple[Beam, ...]:
    """The links' beams; what shears counts as rigid, and what twists where warping is held, for no section bounds
    that."""
    changed: list[Beam] = []
    for link, beam in enumerate(beams):
        extreme = extremes.get(link)
        if extreme is None:
            changed.append(beam)
        elif rigid:
            changed.append(rigid_beam(replace(beam, thermal_expansion=_expansion(beam, extreme))))
        else:
            changed.append(
                Beam(
                    length=beam.length,
                    mass_per_length=extreme.lightest,
                    axial_rigidity=extreme.axial,
                    flexural_rigidity_height=extreme.height,
                    flexural_rigidity_width=extreme.width,
                    torsional_rigidity=None if arm.links[link].asymmetry.warps else extreme.torsion,
                    thermal_expansion=_expansion(beam, extreme),
                )
            )
    return tuple(changed)


def _expansion(beam: Beam, extreme: _Extremes) -> float | None:
    """The least that a link may expand by, where its expansion counts at all."""
    return None if beam.thermal_expansion is None else extreme.least_expansion


def _best(problem: Problem, number: int, ideal: _Ideal, extremes: dict[int, _Extremes]) -> float | None:
    """The best (SI) that the figure of a limit (its number) could be; None where nothing tells."""
    follows = problem.limits[number].figure.follows
    if not isinstance(follows, ThroughPoses):
        return _least_error(problem, ideal.search, ideal.p, extremes)
    worst = follows.family.worst(follows.family.prepare(problem), problem, ideal)
    figure = problem.limits[number].figure
    values = [item.value for item in worst if item.name == figure.name and item.limit in (None, number)]
    return figure.worst(values) if values else None


def _least_error(problem: Problem, search: WorstSearch, p: Array, extremes: dict[int, _Extremes]) -> float | None:
    """The error (m) that every design has at some pose at least: no two terms may cancel there, whichever way what the
    links are made of grows."""
    if problem.arm.play != "worst" or problem.workspace.error != "whole" or problem.balances:
        return None
    if any(case.relative_to is not None for case in problem.load_cases):
        return None  # what is subtracted grows with what gives
    model = search.model
    fixed = fixed_error(model)
    beams = beams_of(problem.arm, problem.load_cases)
    ends = [beam_values(_growing(beams, extremes, end)) for end in (0, 1)]
    for pose in search.worst(p, certify=False).poses:
        if all(one_signed(model, (cut_of(model, pose),), end, growth=True) for end in ends):
            return pose.error
    return fixed if fixed > 0.0 else None


def _growing(beams: Sequence[Beam], extremes: dict[int, _Extremes], end: int) -> list[Beam]:
    """The arm's beams with the least (`end` 0) or the greatest expansion that may be chosen."""
    return [
        beam
        if beam.thermal_expansion is None or link not in extremes
        else replace(beam, thermal_expansion=extremes[link].expansion[end])
        for link, beam in enumerate(beams)
    ]
