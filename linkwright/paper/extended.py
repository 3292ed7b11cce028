"""The tables that the paper lacks: each shape at its best proportions, and materials at equal size and at equal mass.

Both for the arm of the paper's Table II without play: rigid drives, no tool, every joint free to turn full circle.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.optimize.limits import limit_on
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.run import optimise
from linkwright.core.sections import build

from .corrected import PaperArm, search_of, worst_error
from .printed import Paper

SHAPES = ("circle", "ellipse", "rectangle", "triangle", "i_section", "tube", "rectangular_tube")
"""The paper's five shapes, and the two tubes that arms are made of."""
MATERIALS = ("aluminium-6061-t6", "magnesium-az31b", "titanium-ti-6al-4v", "steel-s355", "cfrp-quasi-isotropic")
"""Of the catalogue, beside what the paper compares."""
SIZES, WALLS = (0.02, 0.14), (0.002, 0.01)
"""Bounds of outer dimensions and of walls, m."""

Rows = list[dict[str, Any]]


@dataclass(frozen=True)
class Extended:
    """One of these tables: a row for each shape or material, units of its columns by suffix."""

    key: str
    title: str
    rows: Rows
    note: str

    def to_json(self) -> dict[str, Any]:
        """The table as JSON holds it."""
        return {"key": self.key, "title": self.title, "rows": self.rows, "note": self.note}


def extended(paper: Paper, tell: Callable[[str, float], None]) -> tuple[Extended, ...]:
    """Both tables; `tell` hears of each step, with the share done."""
    arms = PaperArm(paper)
    tell("materials at equal size and equal mass", 0.1)
    compared = materials(arms)
    return shapes(arms, tell), compared


def shapes(arms: PaperArm, tell: Callable[[str, float], None], names: Sequence[str] = SHAPES) -> Extended:
    """The least worst error of each shape, a section of its own for each link, within the mass of the paper's links."""
    given = arms.arm()
    rows: Rows = []
    for number, name in enumerate(names):
        tell(f"the best proportions of the shape {name.replace('_', ' ')}", 0.2 + 0.8 * number / len(names))
        problem = Problem(
            file="the paper's arm",
            arm=given,
            minimize="max_error",
            workspace=search_of(given)[0].workspace,
            load_cases=(given.payload,),
            limits=(limit_on("mass", "<=", _mass(given)),),
            link_length=None,
            section_size=SIZES,
            thickness=WALLS,
            shapes=(name,),
            materials=None,
            same=frozenset(),
        )
        best = optimise(problem).after
        rows.append({"label": name, "error_mm": 1e3 * best.worst.error, "mass_kg": best.mass})
    rows.sort(key=lambda row: row["error_mm"])
    note = (
        "The least worst error of links of one shape, each of its own size (outer dimensions 20 to 140 mm, walls 2 to "
        "10 mm), that weigh no more than the paper's together. Without a tool a link carries links alone: its sag "
        "depends on how far from the middle its material lies, so that the best weigh far less than they may."
    )
    return Extended("shapes_at_their_best", "Shapes at their best proportions", rows, note)


def materials(arms: PaperArm, names: Sequence[str] = MATERIALS) -> Extended:
    """The worst error of the paper's bars, and of round bars of their mass, of each material at 20 degC."""
    catalogue = load_catalogue(user=False)
    mass, diameter = _mass(arms.arm()), arms.paper.parameters.diameter
    rows: Rows = []
    for name in names:
        alike = arms.arm(made_of=catalogue.find(name))
        other = diameter * math.sqrt(mass / _mass(alike))
        light = arms.arm(made_of=catalogue.find(name), section=build("circle", {"diameter": other}))
        rows.append(
            {
                "label": name,
                "equal_size_mm": 1e3 * worst_error(alike),
                "equal_mass_mm": 1e3 * worst_error(light),
                "diameter_at_equal_mass_mm": 1e3 * other,
            }
        )
    rows.sort(key=lambda row: row["equal_mass_mm"])
    note = (
        "Round bars of one diameter, and of that at which the links weigh what the paper's do. The sag of a bar "
        "goes with density over modulus, which common metals share, and with the inverse square of its diameter."
    )
    return Extended("materials_compared", "Materials at equal size and at equal mass", rows, note)


def _mass(arm: Arm) -> float:
    return sum(float(beam.mass_per_length * beam.length) for beam in beams_of(arm))
