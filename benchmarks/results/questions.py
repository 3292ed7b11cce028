"""The largest payload against every combination singly: by bisection over a grid of poses, by the error model alone."""

from __future__ import annotations

import itertools
import tempfile
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.optimize.problem import Problem, read_problem
from linkwright.core.optimize.run import optimise

from .row import Row, at_most

_JOINT = "  - joint: {{type: revolute, range: [{} deg, {} deg], stiffness: 60 kN*m/rad, mass: 1 kg}}\n"
_LINK = "    link: {{length: {} mm, section: {{shape: tube, diameter: 50 mm, thickness: 3 mm}}, material: {}}}\n"
_METAL = "aluminium-6061-t6"
_ARM = (
    f"chain:\n{_JOINT.format(-60, 60)}{_LINK.format(400, _METAL)}"
    f"{_JOINT.format(-120, 120)}{_LINK.format(300, _METAL)}payload: {{mass: 2 kg}}\n"
)
_SIZES = "section: [tube], sizes: {diameter: [40 mm, 60 mm, 80 mm], thickness: [3 mm]}"
_MASS, _ERROR = 2.6, 0.6e-3
_PAYLOAD = f"maximize: payload\nsubject_to: {{max_error: '<= 0.6 mm', mass: '<= {_MASS} kg'}}\nchoose: {{{_SIZES}}}\n"
_EACH, _HALVINGS = 61, 30


def questions(*, quick: bool) -> list[Row]:
    """By how much the best of all combinations, looked at one by one, carries more."""
    del quick
    return [_payload()]


def _payload() -> Row:
    problem = _problem(_PAYLOAD)
    began = time.process_time()
    result = optimise(problem)
    seconds = time.process_time() - began
    arms = list(_arms(problem))
    best = max(_carried(arm) for arm in arms)
    note = f"{result.objective:.4g} kg in {seconds:.1f} s; {len(arms)} combinations keep the mass, {_EACH}^2 poses each"
    return at_most("maximize: payload: the best of all", 100.0 * (best / result.objective - 1.0), "% more", 0.1, note)


def _problem(text: str) -> Problem:
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "arm.yaml").write_text(_ARM, encoding="utf-8")
        (Path(folder) / "problem.yaml").write_text(f"arm: arm.yaml\n{text}", encoding="utf-8")
        return read_problem(Path(folder) / "problem.yaml")


def _arms(problem: Problem) -> Iterator[Arm]:
    """Every arm of the sections listed that keeps the mass."""
    assert problem.sizes is not None
    for picks in itertools.product(*problem.sizes):
        links = (replace(link, section=item.section) for link, item in zip(problem.arm.links, picks, strict=True))
        arm = problem.arm.with_links(tuple(links))
        if sum(float(beam.mass) for beam in beams_of(arm)) <= _MASS:
            yield arm


def _carried(arm: Arm) -> float:
    """The largest payload (kg) within the error."""
    axes = [np.linspace(*joint.range, _EACH) for joint in arm.joints]
    q = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, arm.size)

    def error(mass: float) -> float:
        cases = (LoadCase(mass=mass),)
        case, p = error_model(arm, cases).cases[0], beam_values(beams_of(arm, cases))
        return float(np.linalg.norm(case.arrays(q, p).vector, axis=1).max())

    low, high = 0.0, 100.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if error(middle) <= _ERROR else (low, middle)
    return low
