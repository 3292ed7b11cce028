"""Sections from lists with lengths to choose: every combination over a grid of lengths, limits, places in space."""

from __future__ import annotations

import itertools
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.figures import broken
from linkwright.core.optimize.exchange.design import numeric_beams
from linkwright.core.optimize.exchange.exchange import context_of
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.run import optimise
from linkwright.core.optimize.sizes.free import search
from linkwright.core.optimize.sizes.free.program import fitted
from linkwright.core.optimize.sizes.options import link_lists
from linkwright.core.optimize.sizes.search import CLOSE
from linkwright.core.units.quantities import InputError
from tests.optimize.builders import jointed, problem_of, ranged

TUBES = "choose: {section: [tube], material: [aluminium-6061-t6, steel-s355], "
TUBES += "sizes: {diameter: [%s], thickness: 3 mm}}\n"


def _arms(problem: Problem, lengths: list[tuple[float, ...]]) -> list[Arm]:
    """Every combination of listed sections at each of the lengths."""
    arms: list[Arm] = []
    for pick, own in itertools.product(
        itertools.product(*[link_list.options for link_list in link_lists(problem)]), lengths
    ):
        links = [
            replace(link, section=option.section, material=option.material, length=length)
            for link, option, length in zip(problem.arm.links, pick, own, strict=True)
        ]
        arms.append(problem.arm.with_links(tuple(links)))
    return arms


@pytest.mark.slow
@pytest.mark.parametrize("minimize", ["max_error", "mass"])
def test_no_combination_at_any_length_is_better(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, minimize: str) -> None:
    """Tubes of two materials for two links whose lengths add up to 850 mm: against a grid of 2.5 mm, and of 0.1 mm
    about the best of that."""
    monkeypatch.setattr(search, "WANTED", 1e-3)
    joints = ranged("-60 45", "-20 80", more=", mass: 1 kg, stiffness: 500 kN*m/rad, backlash: 0.2 arcmin")
    limit = "mass: '<= 4.5 kg'" if minimize == "max_error" else "max_error: '<= 0.7 mm'"
    text = TUBES % "52 mm, 61 mm, 70 mm" + f"minimize: {minimize}\nsubject_to: {{{limit}, reach: == 850 mm, "
    text += "link_length: [250 mm, 600 mm]}\n"
    problem = problem_of(tmp_path, jointed((400, 400), joints), text)
    result = optimise(problem)
    context = context_of(replace(problem, sizes=None))
    poses = np.array([pose.q for pose in evaluate(problem.arm, problem.workspace, problem.load_cases).worst.poses])

    def least(lengths: list[tuple[float, ...]], known: float) -> tuple[float, Arm | None]:
        best: tuple[float, Arm | None] = known, None
        for arm in _arms(problem, lengths):
            p = numeric_beams(arm, problem.load_cases)
            mass = sum(
                link.length * link.section.properties(0.3).area * link.material.at(arm.temperature).density
                for link in arm.links
                if link.section is not None and link.material is not None
            )
            there = float(context.search.errors(poses, np.tile(p, (len(poses), 1)), 0).error.max())
            if (mass > 4.5 or there >= best[0]) if minimize == "max_error" else (there > 0.7e-3 or mass >= best[0]):
                continue
            error = context.search.worst(p, certify=False).error
            if minimize == "max_error" and error < best[0]:
                best = error, arm
            elif minimize == "mass" and error <= 0.7e-3:
                best = mass, arm
        return best

    coarse, arm = least([(x, 0.85 - x) for x in np.arange(0.25, 0.6001, 0.0025).tolist()], np.inf)
    assert arm is not None
    about = np.arange(-0.0024, 0.0025, 0.0001) + arm.links[0].length
    best = least([(x, 0.85 - x) for x in about[(about >= 0.25) & (about <= 0.6)].tolist()], coarse)[0]
    # Where the last parts are split decides between the two, and rounding decides that.
    assert result.basis in ("bounded", "certified")
    assert result.gap is not None
    assert result.gap <= 1e-3
    assert (result.basis == "certified") == (result.gap <= 2.0 * CLOSE)
    assert result.lower_bound <= best * (1.0 + 1e-9)
    assert result.lower_bound <= result.objective <= best * (1.0 + 2e-4)
    assert result.objective >= best * (1.0 - 5e-4)
    assert sum(link.length for link in result.arm.links) == pytest.approx(0.85, rel=1e-9)
    assert not result.doubts


@pytest.mark.slow
def test_limits_that_are_no_sums_are_kept(tmp_path: Path) -> None:
    """Strength and frequency bound nothing where lengths are free; the design keeps them, and is as good as any of a
    coarse grid that does."""
    joints = ranged("-60 45", "-20 80", more=", mass: 1 kg, stiffness: 500 kN*m/rad")
    arm = jointed((400, 400), joints, rest="payload: {mass: 12 kg}\n")
    text = TUBES.replace("aluminium-6061-t6, ", "") % "30 mm, 38 mm, 46 mm" + "minimize: mass\n"
    text += "subject_to: {safety_factor: '>= 4', first_frequency: '>= 11 Hz', reach: '>= 800 mm', "
    text += "link_length: [300 mm, 500 mm]}\n"
    problem = problem_of(tmp_path, arm, text)
    result = optimise(problem)
    assert not broken(problem.limits, result.after)
    every = [
        evaluate(item, problem.workspace, problem.load_cases)
        for item in _arms(problem, [(x, 0.8 - x) for x in (0.3, 0.4, 0.5)])
    ]
    assert 0 < sum(not broken(problem.limits, item) for item in every) < len(every)
    best = min(item.mass for item in every if not broken(problem.limits, item))
    assert result.objective <= best * (1.0 + 1e-6)
    assert result.lower_bound <= result.objective


@pytest.mark.slow
def test_places_in_space_are_looked_for_without_a_bound(tmp_path: Path) -> None:
    joints = ranged("-120 120", "-150 150", more=", mass: 1 kg, stiffness: 500 kN*m/rad")
    text = TUBES % "40 mm, 50 mm" + "workspace: {path: [[500 mm, 100 mm], [600 mm, 0 mm]]}\n"
    text += "subject_to: {mass: '<= 4 kg', link_length: [250 mm, 600 mm]}\n"
    problem = problem_of(tmp_path, jointed((400, 400), joints), text)
    result = optimise(problem)
    assert (result.basis, result.gap) == ("local", None)
    assert result.after.mass <= 4.0
    context = context_of(replace(problem, sizes=None))
    errors: list[float] = []
    for arm in _arms(problem, [(0.4, 0.4), (0.35, 0.35), (0.33, 0.37)]):
        worst = context.search.worst(numeric_beams(arm, problem.load_cases), certify=False)
        errors.append(worst.error)
    assert result.objective < min(errors)


def test_lengths_are_fitted_to_the_reach(tmp_path: Path) -> None:
    text = "subject_to: {mass: '<= 9 kg', reach: == 1 m, link_length: [200 mm, 450 mm]}\n"
    problem = problem_of(tmp_path, jointed((400, 420, 500), ranged("-90 90", "-90 90", "-90 90")), text)
    result = fitted(problem, problem.arm.lengths)
    assert sum(result) == pytest.approx(1.0, abs=1e-12)
    assert result[0] / result[1] == pytest.approx(400 / 420, rel=1e-9)


def test_drives_and_lengths_together_are_refused_in_one_line(tmp_path: Path) -> None:
    text = TUBES.replace("sizes", "actuator: [RV-20E], sizes") % "40 mm"
    text += "subject_to: {mass: '<= 9 kg', link_length: [200 mm, 450 mm]}\n"
    with pytest.raises(InputError, match="goes with actuators where lengths stay") as told:
        problem_of(tmp_path, jointed((400, 420), ranged("-90 90", "-90 90", more="")), text)
    assert "\n" not in str(told.value)
