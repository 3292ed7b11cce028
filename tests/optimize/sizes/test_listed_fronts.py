"""Fronts of designs from lists: against every combination evaluated; what is refused."""

from __future__ import annotations

import itertools
from dataclasses import replace
from pathlib import Path

import pytest

from linkwright.core.optimize.exchange.design import numeric_beams
from linkwright.core.optimize.exchange.exchange import context_of
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.sizes.options import link_lists
from linkwright.core.optimize.tradeoff.question import By, question
from linkwright.core.optimize.tradeoff.tradeoff import trade_off
from linkwright.core.units.quantities import InputError
from tests.optimize.builders import jointed, problem_of, ranged

SIZES = "sizes: {diameter: [40 mm, 52 mm], thickness: [2 mm, 3 mm]}"
TUBES = "choose: {section: [tube], material: [aluminium-6061-t6, steel-s355], %s}\n"
JOINTS = ranged("-60 45", "-20 80", more=", mass: 1 kg, stiffness: 500 kN*m/rad, backlash: 0.2 arcmin")


def _every(problem: Problem, *, alike: bool) -> list[tuple[float, float]]:
    """Mass (kg) and worst error (m) of every combination within 5 kg, or of those of one material."""
    context = context_of(replace(problem, sizes=None))
    results: list[tuple[float, float]] = []
    for pick in itertools.product(*[link_list.options for link_list in link_lists(problem)]):
        if alike and len({option.material for option in pick}) > 1:
            continue
        links = [
            replace(link, section=option.section, material=option.material)
            for link, option in zip(problem.arm.links, pick, strict=True)
        ]
        arm = problem.arm.with_links(tuple(links))
        mass = sum(
            link.length * link.section.properties(0.3).area * link.material.at(arm.temperature).density
            for link in arm.links
            if link.section is not None and link.material is not None
        )
        if mass <= 5.0:
            results.append((mass, context.search.worst(numeric_beams(arm, problem.load_cases), certify=False).error))
    return results


@pytest.mark.parametrize("by", [None, pytest.param("material", marks=pytest.mark.slow)])
def test_front_is_that_of_every_combination(tmp_path: Path, by: By | None) -> None:
    text = TUBES % SIZES + "subject_to: {mass: '<= 5 kg', wall_slenderness: off}\n"
    problem = problem_of(tmp_path, jointed((450, 400), JOINTS), text)
    asked = question(problem, "mass", "max_error", by=by)
    front = trade_off(asked, accuracy=1e-3)
    points = front.of(front.envelope)
    assert front.envelope.exhaustive
    assert front.envelope.complete
    best: list[tuple[float, float]] = []
    for mass, error in sorted(_every(problem, alike=by is not None)):
        if not best or error < best[-1][1]:
            best.append((mass, error))
    assert len(best) > 4
    # Each is on the exact front, and none that betters its neighbour by more than the accuracy is missing.
    for point in points:
        assert any((point.x, point.y) == pytest.approx(item, rel=2e-5) for item in best)
    for mass, error in best:
        assert min(point.y for point in points if point.x <= mass * (1.0 + 1e-9)) <= error * (1.0 + 1.1e-3)
    assert all(link.section is not None for point in points for link in point.arm.links)


@pytest.mark.parametrize(
    ("y", "more", "message"),
    [
        ("first_frequency", "", "goes with trade-offs between max_error, mass, total_mass, cost, not with first_freq"),
        ("max_error", ", link_length: [300 mm, 500 mm]", "goes with a trade-off where lengths stay"),
    ],
)
def test_what_is_not_traded_is_refused_in_one_line(tmp_path: Path, y: str, more: str, message: str) -> None:
    text = TUBES % SIZES + f"subject_to: {{mass: '<= 5 kg'{more}}}\n"
    problem = problem_of(tmp_path, jointed((450, 400), JOINTS), text)
    with pytest.raises(InputError, match=message) as told:
        question(problem, "mass", y)
    assert "\n" not in str(told.value)
