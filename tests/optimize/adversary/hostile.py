"""Random planar problems, written as people write them, and what must hold of every answer by hand (`planar.py`)."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.result import OptimizationResult
from linkwright.core.optimize.run import optimise
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import NoAnswer
from tests.optimize.adversary.planar import Planar, Stuff
from tests.optimize.builders import problem_of

GAP = 2e-4
"""What an answer may be off by, relative: the exchange's tolerance and the certificates' gaps."""
METALS = ("aluminium-6061-t6", "steel-s355", "titanium-ti-6al-4v", "magnesium-az31b")
OWN = "{elastic_modulus: 45 GPa, poisson_ratio: 0.3, density: 1600 kg/m^3, thermal_expansion: 2e-5 1/K}"
FINE = {2: 121, 3: 25}
"""Places along each side of a box, and poses along each joint's range, by the number of links."""
TURNS = 49
LENGTHS_TRIED = 13
"""Values of each free length where it was said that none reach the box."""


@dataclass(frozen=True)
class Hostile:
    """A random problem: the arm by hand, its loads (kg, N, N), the box if any (m), bounds on lengths if free (m)."""

    problem: Problem
    given: Planar
    loads: tuple[tuple[float, float, float], ...]
    box: Array | None
    lengths: tuple[float, float] | None


def by_hand(arm: Arm, *, growth: bool) -> Planar:
    """An arm of rods and tubes, with its materials' figures as the catalogue has them."""
    diameters: list[float] = []
    walls: list[float] = []
    stuffs: list[Stuff] = []
    for link in arm.links:
        assert link.section is not None
        assert link.material is not None
        sizes, values = link.section.given(), link.material.at(arm.temperature)
        diameters.append(float(sizes["diameter"]))
        walls.append(float(sizes.get("thickness", 0.5 * diameters[-1])))
        figures = (values.need("elastic_modulus"), values.need("density"), values.thermal_expansion or 0.0)
        stuffs.append(Stuff(*figures))
    return Planar(
        lengths=tuple(arm.lengths),
        diameters=tuple(diameters),
        walls=tuple(walls),
        stuffs=tuple(stuffs),
        joints=tuple(joint.mass for joint in arm.joints),
        stiffnesses=tuple(joint.stiffness or math.inf for joint in arm.joints),
        backlash=tuple(joint.backlash for joint in arm.joints),
        ranges=tuple(joint.range for joint in arm.joints),
        warmer=arm.temperature - 293.15 if growth else 0.0,
    )


def hostile(folder: Path, seed: int, links: int, *, box: bool, free: bool) -> Hostile:
    """A problem of so many links, over a box or the joint ranges, with free or fixed lengths."""
    random = np.random.default_rng([seed, links, box, free])
    lengths = [round(float(x)) for x in random.uniform(220, 520, links)]
    ranges = [(-int(a), int(b)) for a, b in random.uniform(60, 160, (links, 2))]
    if random.random() < 0.5:
        ranges[1] = (int(random.integers(10, 40)), 150)
    growth = bool(random.random() < 0.5)
    metals = [str(item) for item in random.choice(METALS, links)]
    own = random.random() < 0.4
    backlash = random.random() < 0.4
    loads = [(round(float(random.uniform(0, 5)), 2), *_force(random)) for _ in range(int(random.integers(1, 3)))]
    chain = ""
    for k, (length, metal, (low, high)) in enumerate(zip(lengths, metals, ranges, strict=True)):
        drive = f"stiffness: {random.uniform(10, 90):.1f} kN*m/rad, mass: {random.uniform(0, 3):.1f} kg"
        play = f"backlash: {1 if backlash else 0} arcmin"
        section = f"{{shape: circle, diameter: {random.uniform(35, 80):.1f} mm}}"
        chain += f"  - joint: {{type: revolute, range: [{low} deg, {high} deg], {drive}, {play}}}\n"
        chain += (
            f"    link: {{length: {length} mm, section: {section}, material: {OWN if own and k == 0 else metal}}}\n"
        )
    arm = f"chain:\n{chain}leave_out: [shear_deformation]\ntemperature: {int(random.integers(0, 61))} degC\n"
    arm += "effects: [{effect: thermal_expansion}]\n" if growth else ""
    cases = ", ".join(f"{{payload: {{mass: {m} kg}}, force: [{x} N, {y} N, 0 N]}}" for m, x, y in loads)
    text = f"load_cases: [{cases}]\n"
    corners = _box(random, sum(lengths)) if box else None
    if corners is not None:
        (x, y), (z, w) = corners.tolist()
        text += f"workspace: {{box: [[{x:.0f} mm, {y:.0f} mm], [{z:.0f} mm, {w:.0f} mm]]}}\n"
    chosen = random.choice(METALS, 2, replace=False)
    text += f"choose: {{section: [{random.choice(['circle', 'tube', 'circle, tube'])}]"
    text += f", material: [{', '.join(chosen)}], same: [section, material]}}\n" if random.random() < 0.6 else "}\n"
    bounds = (0.6 * min(lengths), 1.5 * max(lengths)) if free else None
    limits = ["section_size: [10 mm, 140 mm], thickness: [1.5 mm, 8 mm]"]
    limits += [] if bounds is None else [f"link_length: [{bounds[0]:.0f} mm, {bounds[1]:.0f} mm]"]
    plain = problem_of(folder, arm, text + f"subject_to: {{{', '.join(limits)}}}\n")
    mass = by_hand(plain.arm, growth=growth).mass * random.uniform(0.7, 1.5)
    problem = problem_of(folder, arm, text + f"subject_to: {{mass: '<= {mass:.3f} kg', {', '.join(limits)}}}\n")
    span = None if bounds is None else (round(bounds[0]) * 1e-3, round(bounds[1]) * 1e-3)
    corners = None if corners is None else np.round(corners) * 1e-3
    return Hostile(problem, by_hand(problem.arm, growth=growth), tuple(loads), corners, span)


def _force(random: np.random.Generator) -> tuple[int, int]:
    """On the tip, N: none, against the weight, or any."""
    kind = int(random.integers(3))
    return (0, 0) if kind == 0 else (0, int(random.uniform(10, 80))) if kind == 1 else _any(random)


def _any(random: np.random.Generator) -> tuple[int, int]:
    x, y = random.uniform(-60, 60, 2)
    return int(x), int(y)


def _box(random: np.random.Generator, total: float) -> Array:
    """Corners (2, 2), mm, some of it often out of reach of the arm as given."""
    low = np.array([random.uniform(0.35, 0.65), random.uniform(-0.4, 0.1)]) * total
    return np.stack([low, low + random.uniform(0.1, 0.3, 2) * total])


def places_in(box: Array, each: int) -> Array:
    """Places (N, 2) all over a box, its edges among them."""
    sides = [np.linspace(box[0, axis], box[1, axis], each) for axis in (0, 1)]
    return np.stack(np.meshgrid(*sides, indexing="ij"), axis=-1).reshape(-1, 2)


def poses(case: Hostile, arm: Planar) -> tuple[Array, float]:
    """Poses of an arm all over the workspace, and what share of a box has none."""
    each = FINE[len(arm.lengths)]
    if case.box is None:
        return arm.grid(each), 0.0
    q, reached = arm.poses_of(places_in(case.box, each), TURNS)
    return q, 1.0 - float(reached.mean())


def held(case: Hostile) -> str:
    """Hold an answer against all that must be true by hand; what came of it, in a word."""
    arm, problem = case.given, case.problem
    (limit,) = problem.limit("mass")
    q, unreached = poses(case, arm)
    names = {link.material.name for link in problem.arm.links if link.material is not None}
    own = problem.materials is None or (len(names) == 1 and names <= {material.name for material in problem.materials})
    keeps = own and "circle" in (problem.shapes or ()) and arm.mass <= limit.value and unreached == 0.0
    try:
        result = optimise(problem)
    except NoAnswer as why:
        assert not keeps
        return _refused(case, str(why), unreached)
    return _answered(case, result, keeps=keeps, known=arm.worst(q, case.loads))


def _answered(case: Hostile, result: OptimizationResult, *, keeps: bool, known: float) -> str:
    assert result.doubts == ()
    found = by_hand(result.arm, growth=case.given.warmer != 0.0)
    q, unreached = poses(case, found)
    worst = found.worst(q, case.loads)
    assert worst <= result.objective * (1.0 + GAP) + 1e-9
    told = result.after.worst
    if told.upper_bound is not None:
        assert worst <= told.upper_bound * (1.0 + 1e-8) + 1e-12
    at = np.array([told.poses[0].q])
    assert found.worst(at, case.loads) >= told.error * (1.0 - 1e-6)
    (limit,) = case.problem.limit("mass")
    assert found.mass <= limit.value * (1.0 + 1e-5)
    reported = 0.0 if result.after.unreached is None else result.after.unreached.share
    if case.lengths is None:
        if case.box is not None:  # few turns of a third joint miss places at the rim
            places = places_in(case.box, FINE[len(found.lengths)])
            unreached = 1.0 - float(found.poses_of(places, 16 * TURNS)[1].mean())
        assert abs(reported - unreached) < 0.02
        assert (result.status == "certified") <= (unreached < 0.005)
    elif case.box is not None:
        assert (reported, _missed(case, found)) == (0.0, 0.0)
    if keeps:
        assert result.objective <= known * (1.0 + GAP) + 1e-9
    return result.status


def _missed(case: Hostile, arm: Planar) -> float:
    """What share of a box of which a hair is taken off all around has no pose; three links, whose last joint is tried
    at some angles alone, are given a little more."""
    assert case.box is not None
    less = 1e-4 if len(arm.lengths) == 2 else 2e-3
    inside = case.box + less * np.array([[1.0, 1.0], [-1.0, -1.0]])
    return 1.0 - float(arm.poses_of(places_in(inside, FINE[len(arm.lengths)]), 8 * TURNS)[1].mean())


def _refused(case: Hostile, why: str, unreached: float) -> str:
    """A box that is said to be out of reach is: for the arm as given, or for all lengths of a grid."""
    if "reach" not in why:
        return "infeasible"
    assert case.box is not None
    if case.lengths is None:
        assert unreached == 1.0
        return "out of reach"
    assert unreached > 0.0
    for lengths in itertools.product(
        np.linspace(*case.lengths, LENGTHS_TRIED).tolist(), repeat=len(case.given.lengths)
    ):
        corners = replace(case.given, lengths=lengths).poses_of(places_in(case.box, 9), TURNS)[1]
        assert not corners.all(), lengths
    return "no lengths reach"
