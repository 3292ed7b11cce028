"""Materials as functions of temperature: laws, ranges, and what is missing."""

import math
import pickle

import pytest
from hypothesis import given
from hypothesis import strategies as st

from linkwright.core.materials.catalogue_entry import read_inline
from linkwright.core.materials.material import (
    Constant,
    Material,
    MissingProperty,
    OutOfRange,
    Polynomial,
    Property,
    Table,
)
from linkwright.core.units.quantities import InputError


def inline(**content):
    return read_inline(content, file="arm.yaml", key="chain[1].link.material")


def test_inline_material_of_the_contract():
    material = inline(elastic_modulus="71 GPa", poisson_ratio=0.33, density="2700 kg/m^3")
    values = material.at()
    assert values.elastic_modulus == 71e9
    assert values.density == 2700
    assert values.shear_modulus == pytest.approx(71e9 / 2.66)
    assert values.temperature == 293.15
    assert material.at(1000.0).elastic_modulus == 71e9  # no range given: no range enforced


def test_what_is_missing_is_an_error_only_when_asked():
    material = inline(elastic_modulus="71 GPa", density="2700 kg/m^3")
    assert material.at().yield_strength is None
    assert material.at().shear_modulus is None
    assert not material.has("shear_modulus")
    for ask in (material.need, material.at().need):
        with pytest.raises(MissingProperty, match=r"is needed .* edit NAME yield_strength=VALUE") as caught:
            ask("yield_strength")
        assert caught.value.property_name == "yield_strength"
        assert caught.value.material in str(caught.value)
        assert isinstance(caught.value, InputError)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ({}, "no properties"),
        ({"elastic_modulus": 71}, "needs a unit"),
        ({"elastic_modulus": "-71 GPa"}, "above zero"),
        ({"density": "0 kg/m^3"}, "above zero"),
        ({"poisson_ratio": 0.5}, "between -1 and 0.5"),
        ({"poisson_ratio": -1}, "between -1 and 0.5"),
        ({"cost": "-1 EUR/kg"}, "negative"),
        ({"elastic_modulus": "71 GPa", "poisson_ratio": 0.33, "shear_modulus": "40 GPa"}, "does not fit"),
        ({"elastic_modulu": "71 GPa"}, "did you mean 'elastic_modulus'"),
        ({"elastic_modulus": {"value": "71 GPa", "table": []}}, "not several"),
        ({"elastic_modulus": {"spread": ["1 GPa", "2 GPa"]}}, "needs one of"),
        ({"elastic_modulus": {"value": "71 GPa", "spread": ["72 GPa", "73 GPa"]}}, "outside its spread"),
        ({"elastic_modulus": {"value": "71 GPa", "range": ["30 degC", "60 degC"]}}, "reference temperature"),
        ({"elastic_modulus": {"value": "71 GPa", "range": ["60 degC", "0 degC"]}}, "reversed"),
        ({"elastic_modulus": {"table": [["20 degC", "70 GPa"]]}}, "two rows"),
        ({"elastic_modulus": {"table": [["20 degC", "70 GPa"], ["20 degC", "69 GPa"]]}}, "must rise"),
        ({"elastic_modulus": {"table": [["20 degC", "70 GPa"], "69 GPa"]}}, "needs [temperature, value]"),
        ({"elastic_modulus": {"polynomial": {"origin": "20 degC", "coefficients": ["70 GPa"]}}}, "range"),
        ({"magnetic": "yes"}, "true or false"),
    ],
)
def test_refuses_implausible_materials(content, words):
    with pytest.raises(InputError) as caught:
        inline(**content)
    assert str(caught.value).startswith("arm.yaml: chain[1].link.material")
    assert words in str(caught.value)


def test_a_polynomial_that_turns_negative_inside_its_range_is_refused():
    falling = {"origin": "20 degC", "coefficients": ["70 GPa", "-1 GPa"]}
    fine = inline(elastic_modulus={"polynomial": falling, "range": ["0 degC", "50 degC"]})
    assert fine.need("elastic_modulus", 273.15 + 30) == pytest.approx(60e9)
    with pytest.raises(InputError, match="above zero"):
        inline(elastic_modulus={"polynomial": falling, "range": ["0 degC", "100 degC"]})


def test_an_orthotropic_material_may_have_any_shear_modulus():
    material = inline(elastic_modulus="70 GPa", poisson_ratio=0.1, shear_modulus="5 GPa", isotropic=False)
    assert material.at().shear_modulus == 5e9
    without = inline(elastic_modulus="70 GPa", poisson_ratio=0.1, isotropic=False)
    with pytest.raises(MissingProperty):  # E/(2(1+nu)) would be 31.8 GPa, six times too stiff
        without.need("shear_modulus")


def test_range_is_enforced_and_named():
    table = Table((293.15, 373.15), (70e9, 68e9))
    material = Material("alloy", {"elastic_modulus": Property(table, (273.15, 373.15))})
    assert material.need("elastic_modulus", 273.15) == 70e9
    assert material.need("elastic_modulus", 333.15) == pytest.approx(69e9)
    assert material.need("elastic_modulus", 373.15) == 68e9
    with pytest.raises(OutOfRange) as caught:
        material.need("elastic_modulus", 473.15)
    for word in ("alloy", "elastic_modulus", "200 degC", "0 degC", "100 degC"):
        assert word in str(caught.value)
    assert caught.value.asked == 473.15
    with pytest.raises(OutOfRange):
        material.at(272.0)
    again = pickle.loads(pickle.dumps(caught.value))
    assert str(again) == str(caught.value)


def test_spread_and_its_ends():
    modulus = {"value": "206 GPa", "spread": ["196 GPa", "216 GPa"]}
    steel = inline(elastic_modulus=modulus, density="7850 kg/m^3")
    assert steel.spread("elastic_modulus") == (196e9, 216e9)
    assert steel.spread("density") == (7850, 7850)
    assert steel.at_bound("low", elastic_modulus=True).need("elastic_modulus") == 196e9
    assert steel.at_bound("high", elastic_modulus=True).need("elastic_modulus") == 216e9
    assert steel.at_bound("high", density=True).need("elastic_modulus") == 206e9


def test_a_material_is_frozen_hashable_and_crosses_processes():
    material = inline(elastic_modulus="71 GPa", density="2700 kg/m^3")
    assert pickle.loads(pickle.dumps(material)) == material
    assert len({material, material}) == 1
    with pytest.raises(TypeError):
        material.properties["density"] = Property(Constant(1.0))  # pyright: ignore[reportIndexIssue]


temperatures = st.lists(st.floats(200, 800), min_size=2, max_size=8, unique=True).map(sorted)


@given(temperatures, st.data())
def test_a_table_stays_between_its_neighbours_and_hits_its_points(points, data):
    values = data.draw(st.lists(st.floats(1e9, 3e11), min_size=len(points), max_size=len(points)))
    table = Table(tuple(points), tuple(values))
    for point, value in zip(points, values, strict=True):
        assert table.value(point) == pytest.approx(value, rel=1e-12)
    asked = data.draw(st.floats(points[0], points[-1]))
    upper = next(i for i, point in enumerate(points) if point >= asked)
    near = values[max(upper - 1, 0)], values[upper]
    assert min(near) * (1 - 1e-12) <= table.value(asked) <= max(near) * (1 + 1e-12)


@given(st.lists(st.floats(-100, 100), min_size=1, max_size=5), st.floats(200, 400))
def test_a_polynomial_is_the_sum_of_its_powers(coefficients, temperature):
    expected = math.fsum(c * (temperature - 293.15) ** n for n, c in enumerate(coefficients))
    law = Polynomial(tuple(coefficients), 293.15)
    assert law.value(temperature) == pytest.approx(expected, rel=1e-9, abs=1e-6)
