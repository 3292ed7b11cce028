"""What of an error lies across a path and along it: against first principles and against every pose looked at."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm, Calibrated, EffectEntry, Joint, Link, LoadCase
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.worst.workspace import Workspace
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.optimize.rounding.options import read_rounding
from linkwright.core.optimize.rounding.rounding import rounded
from linkwright.core.optimize.run import optimise
from linkwright.core.sections import Circle
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError
from linkwright.json.design import evaluation_json
from linkwright.markdown.described import markdown
from linkwright.results.evaluation import describe
from tests.optimize.builders import problem_of

STEEL = load_catalogue(user=False).find("steel-s355")
ROD = Link(0.4, section=Circle(0.04), material=STEEL)
BENDS = frozenset({"shear_deformation"})


def carriage(*, space: bool = False, **joint: object) -> Arm:
    """A rod along a rail: it sags across the rail, and the carriage stands 50 um too far along it."""
    slide = replace(Joint(type="prismatic", axis=(1.0, 0.0, 0.0), range=(0.0, 1.0)), **joint)
    off = (EffectEntry("encoder_offset", (1,), {"offset": 5e-5}),)
    gravity = (0.0, 0.0, -9.81) if space else (0.0, -9.81, 0.0)
    return Arm("carriage", (slide,), (ROD,), gravity=gravity, payload=LoadCase(2.0), leave_out=BENDS, effects=off)


def sag(arm: Arm) -> float:
    beam = beams_of(arm)[0]
    weight = 9.81 * float(beam.mass_per_length) * 0.4
    return (2.0 * 9.81 / 3.0 + weight / 8.0) * 0.4**3 / float(beam.flexural_rigidity_height)


@pytest.mark.parametrize("space", [False, True])
def test_a_sag_is_across_a_level_path_and_an_offset_along_it(space: bool) -> None:
    """A pin's disc across the rail adds its radius across the path and nothing along it."""
    arm = carriage(space=space, clearance=2e-5, backlash=3e-5)
    rail = Workspace("path", ((0.5, 0.0, 0.0), (1.2, 0.0, 0.0)), in_plane=not space)
    result = evaluate(arm, rail)
    assert result.seam is not None
    assert result.seam.across.error == pytest.approx(sag(arm) + 2e-5, rel=1e-6)
    assert result.seam.along.error == pytest.approx(5e-5 + 1.5e-5, rel=1e-6)
    assert result.seam.whole.error == pytest.approx(np.hypot(sag(arm) + 2e-5, 6.5e-5), rel=1e-6)
    content = evaluation_json(result)
    assert content["across_mm"] == pytest.approx(1e3 * result.seam.across.error)
    assert content["along_mm"] == pytest.approx(6.5e-2)
    assert content["whole_mm"] == content["max_error_mm"]
    counted = evaluate(arm, replace(rail, error="along"))
    assert counted.max_error == pytest.approx(6.5e-5, rel=1e-6)
    assert counted.by_effect["encoder_offset"] == pytest.approx(5e-5)
    assert counted.by_effect["link_bending"] == pytest.approx(0.0, abs=1e-12)
    assert counted.worst.certified is not space  # the disc's radius is counted whole where no plane holds it
    assert "only the error along it counts" in markdown(describe(counted))
    calibrated = evaluate(
        arm, replace(rail, error="along"), [replace(arm.payload, relative_to=Calibrated(LoadCase(1.0)))]
    )
    assert calibrated.max_error == pytest.approx(1.5e-5, rel=1e-6)


def planar_arm(play: str = "worst") -> Arm:
    one = Joint(range=(-3.0, 3.0), backlash=4e-4, clearance=2e-5, stiffness=3e4)
    links = (replace(ROD, length=0.5), replace(ROD, length=0.45))
    return Arm("two rods", (one, one), links, payload=LoadCase(2.0), leave_out=BENDS, play=play)  # type: ignore[arg-type]


CORNER = ((0.3, 0.5, 0.0), (0.6, 0.4, 0.0), (0.6, -0.3, 0.0))


def poses_at(tip: Array) -> list[list[float]]:
    """Both postures of the two rods with their tip at a point."""
    a, b, d = 0.5, 0.45, float(np.hypot(*tip))
    bent = np.arccos((d * d - a * a - b * b) / (2.0 * a * b))
    turn = np.arctan2(tip[1], tip[0])
    return [[turn - np.arctan2(b * np.sin(e), a + b * np.cos(e)), e] for e in (bent, -bent)]


def by_hand(arm: Arm, load: LoadCase, start: Array, end: Array, part: str) -> float:
    """The worst part of the error (m) at 400 points of a straight line, of play too, which lies worst."""
    unit = (end - start) / np.linalg.norm(end - start)
    axis = np.array([unit[0], unit[1], 0.0]) if part == "along" else np.array([-unit[1], unit[0], 0.0])
    q = np.array([pose for s in np.linspace(0.0, 1.0, 400) for pose in poses_at(start + s * (end - start))])
    arrays = error_model(arm, [load]).cases[0].arrays(q, beam_values(beams_of(arm)))
    off = np.abs(arrays.vector @ axis) + np.abs(arrays.intervals @ axis).sum(axis=1)
    return float(off.max()) + sum(joint.clearance for joint in arm.joints)


@pytest.mark.parametrize("part", ["across", pytest.param("along", marks=pytest.mark.slow)])
def test_round_a_corner_each_piece_counts_by_its_own_direction(part: str) -> None:
    arm, path = planar_arm(), Workspace("path", CORNER, error=part)  # type: ignore[arg-type]
    cases = (LoadCase(2.0), LoadCase(0.0, force=(30.0, 0.0, 0.0)))
    result = evaluate(arm, path, cases)
    ends = np.array(CORNER)[:, :2]
    expected = {
        (case, k): by_hand(arm, load, ends[k], ends[k + 1], part) for case, load in enumerate(cases) for k in range(2)
    }
    assert result.max_error == pytest.approx(max(expected.values()), rel=1e-5)
    worst = max(expected, key=lambda key: expected[key])
    assert result.worst.poses[0].load_case == worst[0]
    assert result.worst.certified
    assert result.seam is not None
    assert max(result.seam.across.error, result.seam.along.error) < result.seam.whole.error


def test_where_loads_seat_the_play_its_part_counts_too() -> None:
    arm = planar_arm("loaded")
    result = evaluate(arm, Workspace("path", CORNER[1:], error="across"))
    q = np.array([pose for y in np.linspace(0.4, -0.3, 400) for pose in poses_at(np.array([0.6, y]))])
    arrays = error_model(arm, [LoadCase(2.0)]).cases[0].arrays(q, beam_values(beams_of(arm)))
    seated = arrays.vector[:, 0] + (np.sign(arrays.interval_seating) * arrays.intervals[:, :, 0]).sum(axis=1)
    assert result.max_error == pytest.approx(np.abs(seated).max(), rel=1e-5)  # pins are pushed down, along the path


ARM = """
chain:
  - joint: {range: [-170 deg, 170 deg]}
    link: {length: 500 mm, section: {shape: circle, diameter: 60 mm}, material: steel-s355}
  - joint: {range: [-170 deg, 170 deg]}
    link: {length: 450 mm, section: {shape: circle, diameter: 60 mm}, material: steel-s355}
payload: {mass: 5 kg}
"""
PATH = "path: [[300 mm, 500 mm], [600 mm, 400 mm], [600 mm, -300 mm]]"
ROOM = "subject_to: {mass: '<= 14 kg', section_size: [20 mm, 120 mm]}\n"


@pytest.mark.slow
def test_the_design_that_is_best_across_a_seam_gives_more_along_it(tmp_path: Path) -> None:
    whole = optimise(problem_of(tmp_path, ARM, f"workspace: {{{PATH}}}\n{ROOM}"))
    problem = problem_of(tmp_path, ARM, f"workspace: {{{PATH}, error: across}}\n{ROOM}")
    across = optimise(problem)
    assert across.status == whole.status == "certified"
    assert whole.after.seam is not None
    assert across.after.seam is not None
    assert across.objective == across.after.seam.across.error
    assert across.objective < 0.997 * whole.after.seam.across.error
    assert across.after.seam.whole.error > whole.objective
    ends = np.array(CORNER)[:, :2]
    checked = [by_hand(across.arm, problem.load_cases[0], ends[k], ends[k + 1], "across") for k in range(2)]
    assert across.objective == pytest.approx(max(checked), rel=2e-4)
    made = rounded(problem, across, read_rounding("0.5 mm"))
    assert 1.0 <= made.objective / across.objective < 1.01


@pytest.mark.parametrize(
    ("space", "told"),
    [
        ("{box: [[0 m, 0 m], [1 m, 1 m]], error: across}", "needs a direction"),
        ("{path: [[500 mm, 0 mm]], error: along}", "needs a direction"),
        ("{joints: range, error: along}", "is for a path"),
        (f"{{{PATH}, error: sideways}}", "across"),
    ],
)
def test_a_part_without_a_direction_is_refused(tmp_path: Path, space: str, told: str) -> None:
    with pytest.raises(InputError, match=told):
        problem_of(tmp_path, ARM, f"workspace: {space}\n{ROOM}")
