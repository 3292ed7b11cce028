"""Arm files that the program writes, each read back as it is read anywhere and held to the figures promised of it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.arm.errors.unknown_mass import of_unknown_mass, unknown_taken_out
from linkwright.core.arm.evaluation import Evaluation, link_masses, material_cost
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.files.read_back import differences
from linkwright.core.arm.files.write import arm_to_yaml
from linkwright.core.arm.worst.parts import projections_at, worst_search
from linkwright.core.materials.catalogue import Catalogue
from linkwright.core.units.quantities import format_quantity
from linkwright.output.files import ReadBack


def arm_file(arm: Arm, catalogue: Catalogue, promised: Evaluation | None = None, *, text: str = "") -> ReadBack:
    """An arm's file, which has to say the same arm when it is read with the same `catalogue`, and one that has the
    figures `promised` of it. `text` is the file where it holds more than the arm, comments for one."""
    return ReadBack(text or arm_to_yaml(arm), partial(_unlike, arm, catalogue, promised))


def _unlike(arm: Arm, catalogue: Catalogue, promised: Evaluation | None, path: Path) -> Iterator[str]:
    back = read_arm(path, catalogue, tip=None if arm.every_tip else arm.tip)
    yield from differences(arm, back)
    if promised is not None:
        yield from missed(promised, back)


_WITHIN = 1e-6
"""How far a figure may be from what was promised, of it: what a file's twelve digits leave of it and more."""


def missed(promised: Evaluation, arm: Arm) -> Iterator[str]:
    """The figures of an evaluation that an arm does not have, in words: the masses and the price of its links, its
    reach, and its error at each of the worst poses, which is the worst error at the first of them."""
    cases = promised.load_cases
    taken = unknown_taken_out(arm, cases)
    beams = beams_of(taken, cases)
    p = beam_values(beams)
    model = error_model(taken, cases)
    search = worst_search(model, promised.workspace)
    figures: list[tuple[str, str, float | None, float | None]] = []
    masses = link_masses(beams)
    if promised.mass is not None:
        figures.append(("mass", "mass", promised.mass, None if of_unknown_mass(arm) else sum(masses)))
    figures.append(("cost", "cost", promised.cost, material_cost(taken, masses)))
    for number, pose in enumerate(promised.worst.poses, start=1):
        q = np.array([pose.q])
        case = pose.load_case
        if projections_at(model, promised.workspace, search.tip(q, p)) is not None:
            case = search.case_at(q, p, case)
        error = float(search.errors(q, p, case).error[0])
        figures.append((f"error at worst pose {number}", "length", pose.error, error))
    for name, kind, meant, read in figures:
        if meant is None and read is None:
            continue
        if meant is None or read is None or not math.isclose(meant, read, rel_tol=_WITHIN, abs_tol=1e-12):
            texts = ["not known" if item is None else format_quantity(item, kind, digits=6) for item in (meant, read)]
            yield f"{name} {texts[0]} was promised, {texts[1]} is had"
