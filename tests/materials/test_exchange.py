"""FreeCAD cards and tables, in and out."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from linkwright.core.catalogues.freecad_cards import MECHANICAL, THERMAL, read_card, write_card
from linkwright.core.catalogues.materials import MATERIALS, write_table
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.materials.material import Constant, Material, Property
from linkwright.core.units.quantities import InputError

# In the manner of the cards of FreeCAD 1.0 (Steel-S235JR) and 0.21 (Invar-Generic), with values of their own.
NEW_CARD = """\
---
# File created by ConvertFCMat.py
General:
  UUID: "11111111-6518-458c-8ccf-846f69fd8a50"
  Author: "Somebody"
  Name: "Steel X 1"
Inherits:
  Steel:
    UUID: "22222222-3b6a-4f75-a055-40c0d0324596"
Models:
  Father:
    UUID: '33333333-b606-4778-8f13-3934d8668e67'
    Father: "Metal"
  MaterialStandard:
    UUID: '44444444-904a-4537-925f-64064c07d700'
    StandardCode: "EN 10025"
  LinearElastic:
    UUID: '7b561d1d-fb9b-44f6-9da9-56a4f74d7536'
    Density: "7800 kg/m^3"
    PoissonRatio: "0.3"
    ShearModulus: "81000 MPa"
    UltimateStrain: "26"
    UltimateTensileStrength: "360 MPa"
    YieldStrength: "235 MPa"
    YoungsModulus: "210000 MPa"
  Thermal:
    UUID: '9959d007-a970-4ea7-bae4-3eb1b8b883c7'
    ThermalExpansionCoefficient: "0.000011 m/m/K"
"""
OLD_CARD = """\
; Steel X
; information about the content of such cards can be found on the wiki

[General]
Name = Steel X 1
Father = Metal

[Mechanical]
Density = 7800 kg/m^3
PoissonRatio = 0.3
ShearModulus = 81 GPa
UltimateTensileStrength = 360 MPa
YieldStrength = 235 MPa
YoungsModulus = 210.0 GPa

[Thermal]
SpecificHeat = 515.0 J/kg/K
ThermalConductivity = 13.5 W/m/K
ThermalExpansionCoefficient = 11 µm/m/K
"""


@pytest.mark.parametrize("text", [NEW_CARD, OLD_CARD, "\ufeff" + NEW_CARD, OLD_CARD.replace("\n", "\r\n")])
def test_cards_of_both_formats_are_read(tmp_path, text):
    path, own = tmp_path / "X.FCMat", tmp_path / "own.yaml"
    path.write_bytes(text.encode("utf-8"))
    entry = read_card(path)
    assert entry.name == "steel-x-1"
    MATERIALS.add(own, [entry])
    result = load_catalogue([own], user=False).find("steel-x-1")
    assert result.need("elastic_modulus") == pytest.approx(210e9)
    assert result.need("shear_modulus") == pytest.approx(81e9)
    assert result.need("density") == 7800
    assert result.need("yield_strength") == 235e6
    assert result.need("tensile_strength") == 360e6
    assert result.need("thermal_expansion") == pytest.approx(11e-6)
    assert "FreeCAD material card X.FCMat" in result.references["freecad-card"]
    if "SpecificHeat" in text:
        assert (result.need("heat_capacity"), result.need("thermal_conductivity")) == (515, 13.5)
    else:
        assert "EN 10025" in result.references["freecad-card"]


def test_a_card_whose_constants_disagree_is_refused(tmp_path):
    (tmp_path / "X.FCMat").write_text(NEW_CARD.replace("81000", "90000"))
    with pytest.raises(InputError, match="does not fit"):
        MATERIALS.add(tmp_path / "own.yaml", [read_card(tmp_path / "X.FCMat")])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (NEW_CARD.replace("7800 kg/m^3", "7800"), "Density: needs a unit"),
        (OLD_CARD.replace("210.0 GPa", "much"), "YoungsModulus: 'much' is not a quantity"),
        ("name: arm\n", "is not a FreeCAD material card"),
        ("[General]\nName = x\n", "has no property"),
        ("[General\nName = x\n", "is not a FreeCAD material card"),
        ("", "is not a FreeCAD material card"),
    ],
)
def test_what_is_no_card_is_wrong_input(tmp_path, text, words):
    (tmp_path / "X.FCMat").write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=words):
        read_card(tmp_path / "X.FCMat")


POSITIVE = st.floats(1e-3, 1e3)


@given(
    st.fixed_dictionaries(
        {"elastic_modulus": POSITIVE.map(lambda x: x * 1e9), "density": POSITIVE},
        optional={
            "yield_strength": POSITIVE.map(lambda x: x * 1e6),
            "poisson_ratio": st.floats(0.01, 0.49),
            "thermal_expansion": POSITIVE.map(lambda x: x * 1e-6),
            "thermal_conductivity": POSITIVE,
            "heat_capacity": POSITIVE,
        },
    ),
    st.text(st.characters(codec="utf-8", exclude_categories=("Cc", "Cs", "Zl", "Zp")), max_size=12),
    st.sampled_from(["yaml", "ini"]),
)
def test_a_card_reads_back_as_it_was_written(tmp_path_factory, values, title, form):
    references = {"s": 'A source: with "quotes", [brackets] and # signs'}
    made = Material("m-1", {name: Property(Constant(value), source="s") for name, value in values.items()},
                    title=title, references=references)  # fmt: skip
    path = tmp_path_factory.mktemp("card") / "m.FCMat"
    path.write_text(write_card(made, form), encoding="utf-8")
    entry = read_card(path)
    path.with_suffix(".yaml").write_text(MATERIALS.text([entry]), encoding="utf-8")
    result = load_catalogue([path.with_suffix(".yaml")], user=False).find("m-1")
    for name, value in values.items():
        assert result.need(name) == pytest.approx(value, rel=1e-11)
    if "poisson_ratio" in values:
        assert result.need("shear_modulus") == pytest.approx(made.need("shear_modulus"), rel=1e-11)
    assert references["s"] in result.references["freecad-card"]


def test_every_isotropic_shipped_material_survives_a_card(tmp_path):
    pairs = {**MECHANICAL, **THERMAL}
    for material in load_catalogue(user=False):
        if not material.isotropic:
            with pytest.raises(InputError, match="is not isotropic"):
                write_card(material)
            continue
        path = tmp_path / f"{material.name}.FCMat"
        path.write_text(write_card(material), encoding="utf-8")
        path.with_suffix(".yaml").write_text(MATERIALS.text([read_card(path)]), encoding="utf-8")
        result = load_catalogue([path.with_suffix(".yaml")], user=False).find(material.name)
        for name in pairs.values():
            assert result.has(name) == material.has(name)
            if material.has(name):
                assert result.need(name) == pytest.approx(material.need(name), rel=1e-11)


def test_a_table_reads_back_as_it_was_written(tmp_path):
    catalogue = load_catalogue(user=False)
    path = tmp_path / "t.csv"
    path.write_text(write_table(catalogue), encoding="utf-8")
    entries = MATERIALS.read_table(path)
    assert [entry.name for entry in entries] == list(catalogue.names)
    own = tmp_path / "own.yaml"
    own.write_text(MATERIALS.text(entries), encoding="utf-8")
    copies = load_catalogue([own], user=False)
    for material in catalogue:
        assert copies.find(material.name).isotropic == material.isotropic
        for name in material.properties:
            assert copies.find(material.name).need(name) == pytest.approx(material.need(name), rel=1e-9)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "has no column 'name'"),
        ("name,densitty\nx,1\n", "unknown column 'densitty'; did you mean 'density'"),
        ("name,density\n", "has no rows"),
        ("name,density\n,1 kg/m^3\n", "line 2: has no name"),
        ("name,density\nx,1\n", "line 2: density: needs a unit"),
        ("name,density\nx,1 kg/m^3,2\n", "line 2: has not as many cells"),
        ("name,isotropic\nx,maybe\n", "needs yes or no"),
    ],
)
def test_a_wrong_table_is_told_with_its_line(tmp_path, text, words):
    (tmp_path / "t.csv").write_text(text)
    with pytest.raises(InputError, match=words):
        MATERIALS.read_table(tmp_path / "t.csv")
