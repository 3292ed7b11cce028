"""A material described in place is written as it was described, whatever link or choice it comes from."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import linkwright as lw
from linkwright.core.materials.catalogue_entry import read_inline
from linkwright.core.materials.material import property_kinds
from linkwright.core.units.quantities import InputError
from tests.costs import slow_but

PLY = {"elastic_modulus": "135 GPa", "transverse_modulus": "9 GPa", "shear_modulus": "5 GPa", "poisson_ratio": 0.3,
       "density": "1550 kg/m^3", "isotropic": False}  # fmt: skip
ALLOY = {"elastic_modulus": 7.1e10, "poisson_ratio": 0.33, "density": {"value": 2700.0, "spread": [2650.0, 2750.0]},
         "yield_strength": {"table": [[253.15, 2e8], ["100 degC", 1.5e8]]}, "cost": 3.0,
         "thermal_expansion": {"polynomial": {"origin": 293.15, "coefficients": [2.3e-5, 1e-8]},
                               "range": [273.15, 373.15]}}  # fmt: skip
LAMINATE = {"laminate": {"ply": PLY, "angles": [0, "45 deg", -0.785398163397448, 0], "thicknesses": [1e-3] * 4}}
TUBE = {"shape": "tube", "diameter": "70 mm", "thickness": "4 mm"}
IN_PLACE = {"of figures": ALLOY, "a laminate": LAMINATE, "called something": {**ALLOY, "name": "my alloy"}}


def arm_with(*materials: object) -> lw.Arm:
    joint = lw.Joint(range=["-90 deg", "90 deg"], stiffness="60 kN*m/rad")
    chain = [(joint, lw.Link(length="400 mm", section=TUBE, material=material)) for material in materials]
    return lw.Arm(chain=chain, payload={"mass": "5 kg"})


def alike(one: Any, other: Any) -> bool:
    """Of the same values at 0, 20 and 50 degC."""
    names = [name for name in property_kinds() if one.has(name) or other.has(name)]
    return all(
        one.need(name, kelvin) == pytest.approx(other.need(name, kelvin), rel=1e-11)
        for name in names
        for kelvin in (273.15, 293.15, 323.15)
    )


@pytest.mark.parametrize("kind", IN_PLACE)
def test_numbers_of_a_program_are_written_with_their_units_however_deep(kind: str, tmp_path: Path) -> None:
    arm = arm_with("steel-s355", IN_PLACE[kind])
    arm.save(tmp_path / "arm.yaml")
    back = lw.read_arm(tmp_path / "arm.yaml").model.links[1].material
    assert back is not None
    assert alike(back, arm.model.links[1].material)


def test_the_same_description_on_another_link_is_written_there_too() -> None:
    """Chosen for link 2, the material of link 1 is the same, and is written by its keys, not by where it stood."""
    keys = {**ALLOY, "name": "my alloy"}
    problem = lw.Problem(
        arm=arm_with(keys, "steel-s355"),
        subject_to={"mass": "<= 8 kg", "section_size": ["20 mm", "90 mm"], "thickness": ["2 mm", "10 mm"]},
        choose={"section": ["tube"], "material": [keys]},
    )
    written = lw.optimize(problem).arm.to_yaml()
    assert written.count("name: my alloy") == 2
    assert "material: my alloy" not in written


@pytest.mark.parametrize("kind", slow_but(IN_PLACE, "of figures"))
def test_a_material_chosen_in_place_can_be_read_back(kind: str, tmp_path: Path) -> None:
    problem = lw.Problem(
        arm=arm_with("steel-s355", "steel-s355"),
        subject_to={"mass": "<= 8 kg", "section_size": ["20 mm", "90 mm"], "thickness": ["2 mm", "10 mm"]},
        choose={"section": ["tube"], "material": [IN_PLACE[kind]]},
    )
    best = lw.optimize(problem)
    best.save(tmp_path / "result")
    back = lw.evaluate(tmp_path / "result" / "arm.yaml")
    assert back.max_error_mm == pytest.approx(best.after.max_error_mm, rel=1e-8)
    assert back.mass_kg == pytest.approx(best.after.mass_kg, rel=1e-9)


def test_two_materials_of_one_name_in_a_choice_are_refused() -> None:
    """One of them would stand for both."""
    other = {**ALLOY, "density": 2600.0, "name": "mine"}
    with pytest.raises(InputError, match=r"choose\.material: calls two materials mine"):
        lw.Problem(
            arm=arm_with("steel-s355"),
            subject_to={"mass": "<= 8 kg"},
            choose={"section": ["tube"], "material": [{**ALLOY, "name": "mine"}, other]},
        )


def test_what_a_file_says_is_kept_as_it_says_it() -> None:
    keys = {"elastic_modulus": "71 GPa", "density": {"value": "2.7 g/cm^3", "note": "as bought"}}
    assert read_inline(keys, file="arm.yaml", key="material").in_place == keys
