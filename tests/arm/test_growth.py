"""An arm that works warm: thermal growth counts where its file says so, and is told with its size where it does not."""

from __future__ import annotations

from dataclasses import replace

import pytest

from linkwright.core.arm.chain.chain import Arm, EffectEntry, Joint, Link, LoadCase
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.materials.material import Constant, Material, Property
from linkwright.core.sections import Circle
from linkwright.json.design import evaluation_json
from linkwright.markdown.described import markdown
from linkwright.results.evaluation import describe

CATALOGUE = load_catalogue(user=False)
STEEL, ALUMINIUM = CATALOGUE.find("steel-s355"), CATALOGUE.find("aluminium-6061-t6")
BARE = Material("bare", {"elastic_modulus": Property(Constant(2e11)), "density": Property(Constant(7.8e3))})
WARM = 323.15
GROWS = (EffectEntry("thermal_expansion"),)


def bars(*materials: Material | None, temperature: float = WARM, **more: object) -> Arm:
    """Bars of 400 mm; None is a rigid link. Shear left out, for which `BARE` has no modulus."""
    joint = Joint(range=(-1.0, 1.0))
    links = tuple(
        Link(0.4, mass=1.0) if material is None else Link(0.4, section=Circle(0.05), material=material)
        for material in materials
    )
    left = frozenset({"shear_deformation"})
    arm = Arm("warm", (joint,) * len(links), links, temperature=temperature, payload=LoadCase(2.0), leave_out=left)
    return replace(arm, **more)


def growth_of(*materials: Material) -> float:
    """How much bars of 400 mm grow together from 20 degC on (m)."""
    return sum(0.4 * (WARM - 293.15) * material.at(WARM).need("thermal_expansion") for material in materials)


def test_without_gravity_the_error_left_out_is_alpha_l_times_the_warming_of_the_stretched_arm() -> None:
    result = evaluate(bars(STEEL, ALUMINIUM, gravity=(0.0, 0.0, 0.0)))
    assert result.max_error == pytest.approx(0.0, abs=1e-12)
    assert result.growth is not None
    assert result.growth.error == pytest.approx(growth_of(STEEL, ALUMINIUM), rel=1e-9)
    content = evaluation_json(result)["thermal_growth_left_out"]
    assert content == {
        "temperature_degC": pytest.approx(50.0),
        "since_degC": pytest.approx(20.0),
        "max_error_mm": pytest.approx(1e3 * growth_of(STEEL, ALUMINIUM)),
        "links_not_known": [],
    }


def test_the_warning_tells_what_counting_it_gives() -> None:
    """The figure of the warning is that of the same arm whose file counts it, which has no warning."""
    arm = bars(STEEL, ALUMINIUM)
    without, counted = evaluate(arm), evaluate(replace(arm, effects=GROWS))
    assert without.growth is not None
    assert without.growth.error == pytest.approx(counted.max_error, rel=1e-6)
    assert counted.max_error > without.max_error
    (warning,) = without.warnings
    worst, known = (f"{1e3 * item.max_error:.4g} mm" for item in (counted, without))
    assert f"with it the worst error is {worst}, not {known}" in warning
    assert "+30 K from 20 degC" in warning
    assert counted.growth is None
    assert counted.warnings == ()
    assert "Certified: no pose is worse than" in markdown(describe(without))
    assert "thermal expansion not counted" in markdown(describe(without))
    assert "thermal expansion not counted" not in markdown(describe(counted))


def test_nothing_is_left_out_at_20_degrees() -> None:
    result = evaluate(bars(STEEL, temperature=293.15))
    assert result.growth is None
    assert evaluation_json(result)["thermal_growth_left_out"] is None


def test_links_whose_growth_nobody_knows_are_named() -> None:
    some = evaluate(bars(STEEL, BARE, gravity=(0.0, 0.0, 0.0)))
    assert some.growth is not None
    assert some.growth.error == pytest.approx(growth_of(STEEL), rel=1e-9)
    assert some.growth.unknown == (1,)
    assert "without that of link 2, which is not known" in some.warnings[0]
    none = evaluate(bars(BARE, None))
    assert none.growth is not None
    assert none.growth.error is None
    assert "no link's material has a thermal_expansion" in none.warnings[0]
    assert evaluation_json(none)["thermal_growth_left_out"]["links_not_known"] == [1, 2]
