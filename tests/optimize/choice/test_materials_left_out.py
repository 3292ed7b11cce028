"""Materials that lack a figure which the problem needs leave the choice: the answer is that of the others alone."""

from __future__ import annotations

from pathlib import Path

import pytest

from linkwright.core.optimize.run import optimise
from linkwright.core.units.quantities import InputError
from tests.optimize.builders import PAPER_ARM, problem_of

CHOOSE = "choose: {{section: [circle], same: [section, material, size], material: [{}]}}\n"
LIMITS = "subject_to: {mass: '<= 20 kg', safety_factor: '>= 2'}\nworkspace: {poses: [[0 deg, 0 deg, 0 deg]]}\n"
LISTED = "choose: {{section: [tube], sizes: stock, same: [section, material, size], material: [{}]}}\n"
LACKS = "cfrp-quasi-isotropic"


def test_the_answer_is_that_without_it(tmp_path: Path) -> None:
    """It is said at once, stands in the result with the limit that needs it, and changes nothing."""
    told: list[str] = []
    both = problem_of(tmp_path, PAPER_ARM, LIMITS + CHOOSE.format(f"aluminium-6061-t6, {LACKS}"))
    found = optimise(both, notify=told.append)
    alone = optimise(problem_of(tmp_path, PAPER_ARM, LIMITS + CHOOSE.format("aluminium-6061-t6")))
    assert found.objective == pytest.approx(alone.objective, rel=1e-9)
    (dropped,) = found.dropped
    assert (dropped.kind, dropped.name, dropped.limits) == ("material", LACKS, ())
    adds = f"`linkwright materials edit {LACKS}` adds it"
    assert dropped.why == f"its yield strength is not known, and safety_factor >= 2 needs it; {adds}"
    assert [line for line in told if LACKS in line] == [f"{LACKS} is not looked at: {dropped.why}"]
    assert alone.dropped == ()


def test_without_the_limit_it_is_looked_at(tmp_path: Path) -> None:
    """Only what is asked for needs a figure: no strength, no yield strength."""
    problem = problem_of(tmp_path, PAPER_ARM, LIMITS.replace(", safety_factor: '>= 2'", "") + CHOOSE.format(LACKS))
    assert [material.name for material in problem.materials or ()] == [LACKS]
    assert problem.left_out == ()


def test_a_link_of_its_own_list_needs_one_left(tmp_path: Path) -> None:
    text = f"choose: {{material: {{1: [{LACKS}], others: [aluminium-6061-t6]}}}}\n"
    with pytest.raises(InputError, match=r"choose\.material.*leaves a link without a material.*yield strength"):
        problem_of(tmp_path, PAPER_ARM, LIMITS + text)


def test_a_material_that_no_listed_size_comes_in_is_said(tmp_path: Path) -> None:
    """No stock tube is of titanium: the answer is that of the others, and says so."""
    found = optimise(problem_of(tmp_path, PAPER_ARM, LIMITS + LISTED.format("aluminium-6061-t6, titanium-ti-6al-4v")))
    (dropped,) = found.dropped
    assert dropped.name == "titanium-ti-6al-4v"
    assert dropped.why == "no stock size of tube listed comes in it"


def test_a_print_that_twists_needs_a_poisson_ratio_and_petg_has_one(tmp_path: Path) -> None:
    """In space the links twist. No sheet of ASA has a Poisson's ratio; of PETG there is that of PET."""
    arm = "gravity: [0 m/s^2, 0 m/s^2, -9.81 m/s^2]\n" + PAPER_ARM
    limits = LIMITS.replace(", safety_factor: '>= 2'", "")
    problem = problem_of(tmp_path, arm, limits + CHOOSE.format("petg-printed, asa-filament"))
    assert problem.materials is not None
    (petg,), (item,) = problem.materials, problem.left_out
    assert (petg.name, item.material) == ("petg-printed", "asa-filament")
    assert item.why.startswith("its shear modulus (or Poisson's ratio, from which that follows) is not known")
    assert petg.need("shear_modulus") == pytest.approx(petg.need("elastic_modulus") / (2.0 * 1.36))
