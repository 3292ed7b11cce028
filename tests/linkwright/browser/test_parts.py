"""Values of files in the parts that a person edits."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

import linkwright as lw
from linkwright.browser.server.parts import parts_of, section_like
from linkwright.core.arm.files.read import read_section
from linkwright.core.units.quantities import read_quantity
from linkwright.core.units.reading import Mapping


@pytest.mark.parametrize(
    "value",
    [
        "400 mm",
        "<= 6 kg",
        ["-30 deg", "100 deg"],
        ["0 m/s^2", "-9.81 m/s^2", "0 m/s^2"],
        3,
        [1, 2, 3],
        ">= 2",
        "1 arcmin",
    ],
)
def test_what_nobody_changed_is_what_it_was(value):
    assert parts_of(value).value() == value


@pytest.mark.parametrize("value", ["steel-s355", True, None, ["tube", "circle"], "[1", {}, "12 parsecs", [[1]], []])
def test_what_has_no_parts_stays_a_text(value):
    assert parts_of(value) is None


def test_a_number_that_is_typed_keeps_the_unit_or_brings_one():
    length = parts_of("400 mm")
    assert length.typed(0, "650").value() == "650 mm"
    assert length.typed(0, "0.65 m").value() == "0.65 m"
    assert length.typed(0, "a lot").value() == "a lot mm"  # the reader says what is wrong with it
    limit = parts_of("<= 6 kg")
    assert limit.typed(0, "7").value() == "<= 7 kg"
    assert limit.typed(0, ">= 7").value() == ">= 7 kg"
    assert parts_of(["0", "1 m"]).typed(0, "-1").value() == ["-1 m", "1 m"]


@given(st.floats(1e-6, 1e6), st.sampled_from(["mm", "m", "um"]))
def test_every_unit_that_is_offered_measures_the_same(number, unit):
    """And the number is not touched by what stands beside it."""
    parts = parts_of(f"{number} {unit}")
    assert read_quantity(parts.value(), "length", file="", key="") == read_quantity(
        f"{number} {unit}", "length", file="", key=""
    )
    for other in parts.units:
        assert read_quantity(f"1 {other}", "length", file="", key="") > 0.0


@pytest.mark.parametrize("shape", sorted(name for name in lw.shapes if name != "polygon"))
def test_another_shape_is_a_section_at_once(shape):
    """About as large as the one before it, of every shape whose dimensions are sizes and walls."""
    if any(item.kind == "points" and not item.optional for item in lw.shapes[shape].dimensions):
        pytest.skip("its corners are typed")
    made = section_like(shape, {"shape": "rectangular_tube", "width": "80 mm", "height": "120 mm", "thickness": "5 mm"})
    section = read_section(Mapping(made, file="x"))
    heights = [point[1] for point in section.outline()[0]]
    assert 0.08 - 1e-9 <= max(heights) - min(heights) <= 0.12 + 1e-9
    assert section_like("IPE 80", made) == "IPE 80"
