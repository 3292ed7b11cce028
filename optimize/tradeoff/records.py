"""What the journal of a trade-off holds of each point solved."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from linkwright.core.optimize.choice.combinations import Combination
from linkwright.core.optimize.exchange.binding_poses import pool_of
from linkwright.core.optimize.problem import Problem

from .journal import Record
from .point import Design


def design_record(design: Design) -> dict[str, Any]:
    """A design as JSON holds it."""
    pick = design.combination
    return {
        "shapes": list(pick.shapes),
        "materials": [None if material is None else material.name for material in pick.materials],
        "numbers": list(design.numbers),
        "pool": asdict(design.pool),
        "badness": design.badness,
        "elasticity": design.elasticity,
        "converged": design.converged,
        "unsolved": design.unsolved,
    }


def design_of(record: Record, problem: Problem) -> Design:
    """The design that a record holds; the problem names the materials."""
    materials = [link.material for link in problem.arm.links]
    known = {material.name: material for material in (*materials, *(problem.materials or ())) if material is not None}
    return Design(
        combination=Combination(
            tuple(record["shapes"]), tuple(None if name is None else known[name] for name in record["materials"])
        ),
        numbers=tuple(record["numbers"]),
        pool=pool_of(record["pool"]),
        badness=record["badness"],
        elasticity=record["elasticity"],
        converged=record["converged"],
        unsolved=record["unsolved"],
    )
