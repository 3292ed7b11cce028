"""Links that keep clear of regions and of each other: against points all over them, and sizes by hand."""

from __future__ import annotations

import itertools
import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from linkwright.command_line import outcome
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.run import optimise
from linkwright.core.sections.numeric import Array
from linkwright.core.sections.taper import Tapered
from linkwright.core.units.quantities import InputError, NoAnswer
from tests.costs import slow_but
from tests.optimize.builders import jointed, problem_of, ranged, taken_for_many

ARM = jointed((400, 300), ranged("20 70", "-100 -60", more=", mass: 2 kg"))
"""Its elbow stands up and its forearm hangs from it, over a table."""
SIZES = "section_size: [10 mm, 200 mm], thickness: [2 mm, 8 mm]"
TABLE, POST = "{below: {y: -170 mm}}", "{box: [[640 mm, -300 mm], [900 mm, 60 mm]]}"
LENGTHS = (0.4, 0.3)


def axes_of(q: Array, lengths: tuple[float, float] = LENGTHS, count: int = 201) -> list[tuple[Array, Array]]:
    """Points (N, M, 2) along the axes of both links at poses (N, 2), but the first tenth of the first, and across which
    way (N, 2) each is thick."""
    share = np.linspace(0.0, 1.0, count)
    one, both = q[:, 0], q[:, 0] + q[:, 1]
    first, second = (np.stack([np.cos(a), np.sin(a)], axis=1) for a in (one, both))
    elbow = lengths[0] * first
    along = elbow[:, None] * np.maximum(share, 0.1)[None, :, None]
    beyond = elbow[:, None] + lengths[1] * second[:, None] * share[None, :, None]
    return [(points, np.stack([-d[:, 1], d[:, 0]], axis=1)) for points, d in ((along, first), (beyond, second))]


def grid(arm: Arm, each: int = 101) -> Array:
    return np.array(list(itertools.product(*(np.linspace(*joint.range, each) for joint in arm.joints))))


def room(q: Array, region: str, radius: tuple[float, float]) -> float:
    """The least gap (m) over poses, of discs across links of these radii: by the points of their axes."""
    least = math.inf
    for (points, across), r in zip(axes_of(q), radius, strict=True):
        reach = r * np.abs(across)[:, None]
        if region == TABLE:
            gaps = points[..., 1] - reach[..., 1] + 0.17
        else:
            low, high = np.array([0.64, -0.3]), np.array([0.9, 0.06])
            gaps = np.maximum(low - points - reach, points - high - reach).max(axis=2)
        least = min(least, float(gaps.min()))
    return least


def asked(folder: Path, text: str, regions: str, arm: str = ARM) -> Problem:
    return problem_of(folder, arm, f"{text}avoid: [{regions}]\n")


@pytest.mark.parametrize("region", [TABLE, POST], ids=["table", "post"])
def test_rods_are_as_thick_as_a_region_leaves_room(region: str, tmp_path: Path) -> None:
    """Thicker rods err less: they grow until the assumed millimetre is left."""
    text = f"subject_to: {{{SIZES}}}\nchoose: {{section: [circle], same: [size]}}\n"
    problem = asked(tmp_path, "minimize: max_error\n" + text, region)
    result = optimise(problem)
    section = result.arm.links[0].section
    assert section is not None
    radius = 0.5 * float(section.properties(0.3).height)
    q = grid(problem.arm)
    assert room(q, region, (radius, radius)) == pytest.approx(1e-3, abs=1e-4)
    assert result.doubts == ()
    (binding,) = (item for item in result.binding if item.name == "separation")
    assert binding.price
    again = evaluate(result.arm, problem.workspace, problem.load_cases)
    assert problem.figures["separation"].value(again) == pytest.approx(1e-3, abs=1e-6)


@pytest.mark.parametrize("many", slow_but([False, True], False))
def test_the_best_of_all_combinations_keeps_clear(many: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A list of tubes for each link: the best of those that the grid says are clear by 5 mm."""
    text = (
        "minimize: max_error\nsubject_to: {separation: '>= 5 mm', mass: '<= 4 kg'}\n"
        "choose: {section: [tube], sizes: {diameter: [40 mm, 60 mm, 80 mm, 120 mm], thickness: [3 mm]}}\n"
    )
    problem = asked(tmp_path, text, f"{TABLE}, {POST}")
    if many:
        taken_for_many(monkeypatch)
    result = optimise(problem)
    q, best = grid(problem.arm, 31), math.inf
    free = optimise(problem_of(tmp_path, ARM, text.replace("separation: '>= 5 mm', ", "")))
    assert problem.sizes is not None
    for picks in itertools.product(*problem.sizes):
        radii = tuple(0.5 * float(pick.section.properties(0.3).height) for pick in picks)
        if min(room(q, region, radii) for region in (TABLE, POST)) < 5e-3:
            continue
        links = [replace(link, section=pick.section) for link, pick in zip(problem.arm.links, picks, strict=True)]
        whole = evaluate(problem.arm.with_links(tuple(links)))
        best = min(best, whole.max_error if whole.mass is not None and whole.mass <= 4.0 else math.inf)
    assert result.objective == pytest.approx(best, rel=1e-4)
    assert free.objective < result.objective * (1.0 - 1e-3)


def test_links_that_widen_are_as_thick_as_their_far_end(tmp_path: Path) -> None:
    text = (
        "minimize: max_error\nsubject_to: {taper: [1.5, 2], section_size: [10 mm, 200 mm]}\n"
        "choose: {section: [circle]}\n"
    )
    problem = asked(tmp_path, text, TABLE)
    result = optimise(problem)
    assert result.doubts == ()
    tapers = [link.section for link in result.arm.links]
    assert all(isinstance(taper, Tapered) for taper in tapers)
    one, other = (0.5 * float(taper.far.properties(0.3).height) for taper in tapers if isinstance(taper, Tapered))
    assert room(grid(problem.arm), TABLE, (one, other)) == pytest.approx(1e-3, abs=1e-4)


def test_free_lengths_end_before_a_wall(tmp_path: Path) -> None:
    """Stretched out, the tip stops 5 mm before a wall: a disc across the link reaches nowhere along it."""
    text = (
        "maximize: reach\nworkspace: {poses: [[0 deg, 0 deg], [30 deg, -30 deg]]}\n"
        "subject_to: {separation: '>= 5 mm', max_error: '<= 3 mm', link_length: [200 mm, 600 mm], "
        f"{SIZES}}}\nchoose: {{section: [circle]}}\n"
    )
    arm = jointed((400, 300), ranged("-90 90", "-90 90"))
    result = optimise(asked(tmp_path, text, "{above: {x: 750 mm}}", arm))
    assert sum(result.arm.lengths) == pytest.approx(0.745, abs=1e-5)


def test_links_keep_clear_of_one_another(tmp_path: Path) -> None:
    """Folded back by 120 degrees twice, the third rod points back at the first, and their radii share what is left."""
    arm = jointed((400, 200, 150), ranged("-1 1", "119 121", "119 121", more=", mass: 2 kg"))
    text = f"minimize: max_error\nsubject_to: {{{SIZES}}}\nchoose: {{section: [circle], same: [size]}}\n"
    problem = asked(tmp_path, text, "{links: true}", arm)
    result = optimise(problem)
    section = result.arm.links[0].section
    assert section is not None
    least = math.inf
    share = np.linspace(0.0, 1.0, 201)
    for a, b, c in itertools.product([0.0], *[np.radians(np.linspace(119, 121, 9))] * 2):
        turns = np.cumsum([a, b, c])
        along = np.stack([np.cos(turns), np.sin(turns)], axis=1) * np.array([0.4, 0.2, 0.15])[:, None]
        first = along[0] * np.maximum(share, 0.1)[:, None]
        third = along[0] + along[1] + along[2] * share[:, None]
        least = min(least, float(np.linalg.norm(first[:, None] - third[None], axis=2).min()))
    assert float(section.properties(0.3).height) == pytest.approx(least - 1e-3, abs=1e-4)


def test_where_an_axis_itself_runs_through_no_design_keeps_clear(tmp_path: Path) -> None:
    text = f"minimize: max_error\nsubject_to: {{{SIZES}}}\nchoose: {{section: [circle]}}\n"
    with pytest.raises(NoAnswer, match="separation >= 1 mm is out of reach: links without thickness reach at most -"):
        optimise(asked(tmp_path, text, "{box: [[200 mm, 100 mm], [400 mm, 400 mm]]}"))
    with pytest.raises(InputError, match="avoid"):
        optimise(problem_of(tmp_path, ARM, f"minimize: max_error\nsubject_to: {{separation: '>= 5 mm', {SIZES}}}\n"))


def test_it_is_printed_and_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = f"minimize: max_error\nsubject_to: {{{SIZES}}}\nchoose: {{section: [circle], same: [size]}}\n"
    asked(tmp_path, text, f"{TABLE}, {{links: true}}")
    file, target, other = tmp_path / "problem.yaml", tmp_path / "result.json", tmp_path / "again.json"
    assert outcome(["optimize", str(file), "--json", str(target), "--out", str(tmp_path / "out")]) == 0
    assert "separation" in capsys.readouterr().out
    content = json.loads(target.read_text(encoding="utf-8"))
    assert outcome(["evaluate", str(tmp_path / "out" / "arm.yaml"), "--problem", str(file), "--json", str(other)]) == 0
    again = json.loads(other.read_text(encoding="utf-8"))
    assert again["separation_mm"] == pytest.approx(1.0, abs=1e-3) == content["separation_mm"]
    assert len(again["separation_pose"]["q_deg"]) == 2
