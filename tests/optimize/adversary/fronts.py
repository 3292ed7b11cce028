"""Random trade-offs with mixed combinations, and what must hold of every front: its points are what `optimise` finds
under the limit that made them, and none is beaten by another."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from linkwright.core.arm.evaluation import evaluate
from linkwright.core.optimize.run import optimise
from linkwright.core.optimize.tradeoff.front import Tradeoff
from linkwright.core.optimize.tradeoff.question import Question, question
from linkwright.core.optimize.tradeoff.tradeoff import trade_off
from tests.optimize.builders import problem_of
from tests.optimize.random_problems import METALS

WITHIN = 2e-3
"""How far (relative) a point may lie from what `optimise` finds."""
FIGURES = ("mass", "max_error", "cost")
FAMILIES = (("tube", "rectangular_tube"), ("circle", "rectangle"), ("tube", "i_section"), ("circle", "tube"))


def random_front(folder: Path, seed: int) -> Question:
    """A trade-off of two of mass, cost and error for two links, each of two shapes and two metals of its own choice."""
    random = np.random.default_rng([33, seed])
    lengths = [round(float(x)) for x in random.uniform(250, 550, 2)]
    chain = ""
    for length, low, high in zip(lengths, random.uniform(20, 120, 2), random.uniform(20, 120, 2), strict=True):
        stiff, heavy = random.uniform(10, 90), random.uniform(0.5, 4)
        drive = f"stiffness: {stiff:.1f} kN*m/rad, mass: {heavy:.1f} kg, cost: 100 EUR"
        section = f"{{shape: circle, diameter: {random.uniform(35, 70):.0f} mm}}"
        chain += f"  - joint: {{range: [{-low:.0f} deg, {high:.0f} deg], {drive}}}\n"
        chain += f"    link: {{length: {length} mm, section: {section}, material: aluminium-6061-t6}}\n"
    arm = f"chain:\n{chain}payload: {{mass: {random.uniform(1, 8):.1f} kg}}\n"
    shapes = FAMILIES[int(random.integers(len(FAMILIES)))]
    metals = [METALS[0], str(random.choice(METALS[1:]))]
    text = f"choose: {{section: [{', '.join(shapes)}], material: [{', '.join(metals)}]}}\n"
    sizes = f"section_size: [{random.uniform(15, 30):.0f} mm, {random.uniform(70, 110):.0f} mm]"
    limits = [sizes, f"thickness: [{random.uniform(1, 3):.1f} mm, {random.uniform(6, 12):.1f} mm]"]
    x, y = (str(item) for item in random.choice(FIGURES, 2, replace=False))
    plain = problem_of(folder, arm, text + f"subject_to: {{{', '.join(limits)}}}\n")
    given = evaluate(plain.arm, plain.workspace, plain.load_cases)
    share = random.uniform(0.5, 2.0, 3)
    if random.random() < 0.7:
        limits.append(f"mass: '<= {share[0] * given.mass:.3f} kg'")
    if random.random() < 0.5:
        assert given.cost is not None
        limits.append(f"cost: '<= {200 + share[1] * (given.cost - 200):.2f} EUR'")
    if random.random() < 0.3:
        limits.append(f"max_error: '<= {2e3 * share[2] * given.max_error:.3f} mm'")
    return question(problem_of(folder, arm, text + f"subject_to: {{{', '.join(limits)}}}\n"), x, y)


@dataclass(frozen=True)
class Held:
    """A point of a front beside what `optimise` finds under its limit on x (SI)."""

    x: float
    y: float
    best: float

    @property
    def off(self) -> float:
        """How far the point lies above the best, relative."""
        return self.y / self.best - 1.0


def front_of(asked: Question, accuracy: float) -> Tradeoff:
    """The front, none of whose points is beaten in one figure and not worse in the other."""
    result = trade_off(asked, accuracy=accuracy)
    assert result.envelope.exhaustive
    assert result.envelope.complete
    points = [(point.x, point.y) for point in result.of(result.envelope)]
    assert not any(other != own and other[0] <= own[0] and other[1] <= own[1] for own in points for other in points)
    return result


def held(found: Tradeoff, every: int = 3) -> list[Held]:
    """Every third point between the ends, held against `optimise`."""
    asked = found.asked
    (x, y), given = (asked.x, asked.y), asked.given
    rest = tuple(limit for limit in given.limits if limit.name != x.name)
    compared: list[Held] = []
    for point in found.of(found.envelope)[1:-1:every]:
        limit = replace(x.limit(), value=point.x)
        best = optimise(replace(given, minimize=y.name, limits=(*rest, limit)))
        assert best.doubts == ()
        compared.append(Held(point.x, point.y, best.objective))
    return compared
