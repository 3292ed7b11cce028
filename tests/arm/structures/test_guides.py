"""Slides on beams held at both ends: against handbook figures, and finite elements of their own."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects.structures.guide_bending import give, sag
from linkwright.core.arm.errors.at_pose import errors_at
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.files.write import arm_to_yaml
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError

METAL = "{name: metal, elastic_modulus: 70 GPa, poisson_ratio: 0.3, density: 2700 kg/m^3}"
HEAD = "payload: {mass: 0.9 kg}\n"


def box(height: float = 20.0, more: str = "", length: float = 600.0) -> str:
    section = f"{{shape: rectangular_tube, width: 20 mm, height: {height} mm, thickness: 1.5 mm}}"
    return f"{{length: {length} mm, section: {section}, material: {METAL}{more}}}"


def arm_of(folder: Path, beam: str, *, turns: bool = False, link: str = "length: 0 mm", rest: str = HEAD) -> Arm:
    joint = f"{{{'' if turns else 'type: prismatic, range: [0 mm, 600 mm], '}beam: {beam}}}"
    text = f"chain:\n  - joint: {joint}\n    link: {{{link}, rigid: true, mass: 0 kg}}\n{rest}"
    (folder / "arm.yaml").write_text(text, encoding="utf-8")
    return read_arm(folder / "arm.yaml")


def sunk(arm: Arm, at: float) -> float:
    """How far the tip sinks (m) at a coordinate (m)."""
    return -errors_at(arm, (arm.payload,), np.array([[at]]))[0].vector[1]


@pytest.mark.parametrize(
    ("height", "supports", "by_head", "by_weight"),
    [
        (20.0, "simple", 0.0891e-3, 0.0111e-3),
        (40.0, "simple", 0.0153e-3, 0.0029e-3),
        (20.0, "clamped", 0.0891e-3 * 48 / 192, 0.0111e-3 / 5),
    ],
)
def test_a_head_at_midspan_sinks_as_in_the_handbook(
    height: float, supports: str, by_head: float, by_weight: float, tmp_path: Path
) -> None:
    """P L^3/48 EI (192 with clamped ends) and 5 w L^4/384 EI (1/384); shear, some per cent, comes on top."""
    arm = arm_of(tmp_path, box(height, f", supports: {supports}"))
    bent = by_head + by_weight
    assert bent * 0.999 < sunk(arm, 0.3) < bent * (1.07 if supports == "simple" and height == 20.0 else 1.3)
    head = sunk(arm, 0.3) - sunk(arm_of(tmp_path, box(height, f", supports: {supports}"), rest=""), 0.3)
    two = arm_of(tmp_path, box(height, f", supports: {supports}, rails: 2"))
    assert sunk(two, 0.3) == pytest.approx(sunk(arm, 0.3) - 0.5 * head, rel=1e-9)


def stiffness(length: float, flexural: float, shear: float) -> Array:
    """A Timoshenko beam element's (deflection and rotation at both ends; J. S. Przemieniecki, 1968, 5.6)."""
    phi = 12.0 * flexural / (shear * length**2)
    k = flexural / (length**3 * (1.0 + phi))
    six, four, two = 6.0 * length, (4.0 + phi) * length**2, (2.0 - phi) * length**2
    return k * np.array(
        [[12.0, six, -12.0, six], [six, four, -six, two], [-12.0, -six, 12.0, -six], [six, two, -six, four]]
    )


@pytest.mark.parametrize("clamped", [True, False])
@pytest.mark.parametrize("a", [0.0, 0.11, 0.4, 0.75, 0.9])
def test_carriages_move_as_finite_elements_do(a: float, clamped: bool) -> None:
    """Two exact elements, loads at their common node; the weight by fixed-end forces."""
    length, flexural, shear = 0.9, 450.0, 2.2e5
    if a in (0.0, length):
        deflection, slope, _ = give(a, length - a, flexural, shear, clamped=clamped)
        assert deflection == 0.0
        assert slope == 0.0
        return
    whole, weight = np.zeros((6, 6)), np.zeros(6)
    for first, part in ((0, a), (2, length - a)):
        rows = slice(first, first + 4)
        whole[rows, rows] += stiffness(part, flexural, shear)
        weight[rows] += np.array([part / 2.0, part**2 / 12.0, part / 2.0, -(part**2) / 12.0])
    free = [2, 3] if clamped else [1, 2, 3, 5]
    inner = np.ix_(free, free)
    place = [free.index(2), free.index(3)]
    matrix = np.linalg.inv(whole[inner])
    expected = matrix[np.ix_(place, place)]
    deflection, slope, turn = give(a, length - a, flexural, shear, clamped=clamped)
    assert np.allclose([[deflection, slope], [slope, turn]], expected, rtol=1e-9)
    assert np.allclose(sag(a, length - a, flexural, shear, clamped=clamped), (matrix @ weight[free])[place], rtol=1e-9)


def test_the_worst_place_of_a_carriage_is_certified_or_searched(tmp_path: Path) -> None:
    """An outreach turns with the beam's slope, so that the worst place is off the middle."""
    arm = arm_of(tmp_path, box(), link="length: 250 mm")
    whole = evaluate(arm)
    assert not any("makes the tip err" in line for line in whole.warnings)
    places = np.linspace(0.0, 0.6, 121)
    errors = [error.error for error in errors_at(arm, (arm.payload,), places[:, None])]
    near = int(np.argmax(errors))
    places = np.linspace(places[near - 1], places[near + 1], 41)
    errors = [*errors, *(error.error for error in errors_at(arm, (arm.payload,), places[:, None]))]
    assert whole.max_error == pytest.approx(max(errors), rel=1e-5)
    assert abs(places[int(np.argmax(errors[121:]))] - 0.3) > 0.02
    if whole.worst.certified:
        assert whole.upper_bound is not None
        assert whole.upper_bound >= max(errors) * (1.0 - 1e-9)


def test_an_outreach_across_the_slide_twists_the_beam(tmp_path: Path) -> None:
    """0.9 kg 200 mm aside of the rail: T a b/(GJ L) times the arm, and the sinking of the beam itself."""
    arm = arm_of(tmp_path, box(), link="length: 200 mm, direction: [0, 0, 1]")
    torsion = 0.9 * 9.81 * 0.2 * 0.3 * 0.3 / 0.6
    section = arm.joints[0].guide.section.properties(0.3)  # type: ignore[union-attr]
    turn = torsion / (70e9 / 2.6 * float(section.torsion_constant))
    straight = arm_of(tmp_path, box())
    assert sunk(arm, 0.3) - sunk(straight, 0.3) == pytest.approx(turn * 0.2, rel=1e-9)


def test_a_beam_is_written_and_weighed(tmp_path: Path) -> None:
    arm = arm_of(tmp_path, box(40.0, ", supports: clamped, rails: 2, begins_at: -50 mm", 720.0))
    (tmp_path / "again.yaml").write_text(arm_to_yaml(arm), encoding="utf-8")
    assert read_arm(tmp_path / "again.yaml") == arm
    area = 20e-3 * 40e-3 - 17e-3 * 37e-3
    assert evaluate(arm).totals.carried == pytest.approx(0.9 + 2 * 0.72 * 2700.0 * area, rel=1e-9)


@pytest.mark.parametrize(
    ("beam", "why"),
    [
        (box(length=500.0), "beam.length.*does not hold the slide's range"),
        (box(more=", rails: 3"), "beam.rails.*1 or 2"),
        (box(more=", supports: hinged"), "beam.supports"),
        (box(more=", height_direction: [1, 0, 0]"), "beam.height_direction.*runs along"),
        (
            box().replace(
                "rectangular_tube, width: 20 mm, height: 20.0 mm, thickness: 1.5 mm",
                "channel, width: 20 mm, height: 40 mm, flange_thickness: 2 mm, web_thickness: 2 mm",
            ),
            "beam.section.*two axes of symmetry",
        ),
    ],
)
def test_beams_that_cannot_be_are_refused(beam: str, why: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=why):
        arm_of(tmp_path, beam)


def test_only_the_first_joint_slides_on_a_beam(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"joint.beam.*of a slide that runs along it"):
        arm_of(tmp_path, box(), turns=True)
    text = "chain:\n  - joint: {}\n    link: {length: 100 mm, rigid: true, mass: 0 kg}\n"
    text += f"  - joint: {{type: prismatic, range: [0 mm, 600 mm], beam: {box()}}}\n"
    (tmp_path / "second.yaml").write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=r"joint.beam.*an arm's first slide"):
        read_arm(tmp_path / "second.yaml")
