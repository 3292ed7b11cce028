"""Materials and shapes of which no design is feasible, and the limits that each breaks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from linkwright.core.materials.material import Material

from .choice.combinations import Choice, Combination
from .exchange.design import design_space, material_row, starting_points
from .exchange.exchange import Context, Exchange
from .exchange.program import Ask
from .result import Candidate, Dropped

_GIVES = 1e-6
"""A limit that has to give way by less than this (in its logarithm) is kept."""


def dropped_of(context: Context, choice: Choice) -> tuple[Dropped, ...]:
    """What dropped out of a choice, and by which limits; nothing of what the poses of the best design do not tell."""
    problem = context.problem
    materials = [link.material for link in problem.arm.links if link.material is not None]
    known = {material.name: material for material in (*materials, *(problem.materials or ()))}
    dropped: list[Dropped] = []
    chosen: dict[Literal["material", "section"], Sequence[str]] = {
        "material": [material.name for material in problem.materials or ()],
        "section": problem.shapes or (),
    }
    for kind, names in chosen.items():
        for name in names:
            tried = [candidate for candidate in choice.candidates if name in _of(candidate, kind)]
            if not tried or any(item.outcome != "infeasible" for item in tried):
                continue
            # Of one that has it everywhere, where there is one.
            purest = max(tried, key=lambda item, name=name, kind=kind: _of(item, kind).count(name))
            limits = _broken(context, choice, purest, known)
            if limits:
                dropped.append(Dropped(kind, name, limits))
    return tuple(dropped)


def _of(candidate: Candidate, kind: str) -> tuple[str | None, ...]:
    return candidate.materials if kind == "material" else candidate.shapes


def _broken(context: Context, choice: Choice, candidate: Candidate, known: dict[str, Material]) -> tuple[str, ...]:
    """The limits that give way in the least relaxation of all of them."""
    problem = context.problem
    materials = tuple(None if name is None else known[name] for name in candidate.materials)
    pick = Combination(candidate.shapes, materials)
    space = design_space(problem, pick.shapes)
    row = material_row(pick.materials, problem)
    program = Exchange(context, space).program(choice.exchanged.pool, spare=False)
    for start in starting_points(space, row, 1):
        solution = program.solve(start, row, choice.exchanged.pool, Ask(problem.limits, relax=True))
        if solution.solved:
            gives = zip(problem.limits, solution.slacks, strict=True)
            return tuple(limit.text for limit, slack in gives if abs(slack) > _GIVES)
    return ()
