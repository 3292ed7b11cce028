"""The catalogue: what is shipped against published figures, layers, and what a catalogue file must have."""

import re
from pathlib import Path

import numpy as np
import pytest
import yaml

from linkwright.core.materials.catalogue import load_catalogue, load_layer, shipped_layers
from linkwright.core.materials.material import MissingProperty, OutOfRange
from linkwright.core.units.quantities import InputError
from tests.test_house import CORE

CELSIUS = 273.15
SHIPPED = [material for layer in shipped_layers() for material in layer.materials.values()]
PAPER = [material for material in SHIPPED if material.family == "paper"]
ENGINEERING = [material for material in SHIPPED if material.family != "paper"]


def shipped():
    return load_catalogue(user=False)


@pytest.fixture(autouse=True)
def _no_own_catalogue(monkeypatch, tmp_path):
    monkeypatch.delenv("LINKWRIGHT_CATALOGUE", raising=False)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))


def test_the_contracts_examples_are_there():
    assert {"aluminium-6061-t6", "steel-s355"} <= set(shipped().names)
    assert len(ENGINEERING) >= 50
    assert len(PAPER) == 5


def test_a_name_stands_in_one_family_only():
    names = [material.name for material in SHIPPED]
    assert len(names) == len(set(names))


@pytest.mark.parametrize("material", SHIPPED, ids=lambda m: m.name)
def test_every_entry_covers_the_workshop_and_says_where_it_is_from(material):
    for celsius in (20, 35, 50):  # the paper's workshop is at up to 50 degC
        values = material.at(CELSIUS + celsius)
        assert values.need("elastic_modulus") > 0
        assert values.need("density") > 0
        assert values.beyond == ()
    for name, item in material.properties.items():
        assert len(material.references[item.source]) > 40, name
    assert material.title


@pytest.mark.parametrize("material", ENGINEERING, ids=lambda m: m.name)
def test_engineering_entries_have_what_bending_torsion_and_warming_need(material):
    values = material.at(CELSIUS + 50)
    soft = material.family in ("plastic", "rubber", "printed")
    if material.has("poisson_ratio") or not soft:
        shear_modulus = values.need("shear_modulus")
        if material.isotropic:
            expected = values.need("elastic_modulus") / (2 * (1 + values.need("poisson_ratio")))
            assert shear_modulus == pytest.approx(expected, rel=0.02)
    if soft:
        if material.family != "printed" or material.has("thermal_expansion"):
            assert 50e-6 < values.need("thermal_expansion") < 300e-6
        assert 900 < values.need("density") < 2200
    else:
        assert -1e-6 < values.need("thermal_expansion") < 30e-6
        assert 1000 < values.need("density") < 9000
    for name, low, high in (
        ("tensile_strength", 10e6, 2e9),
        ("fatigue_strength", 10e6, 1e9),
        ("thermal_conductivity", 1, 400),
        ("heat_capacity", 300, 2000),
        ("damping", 1e-5, 1e-2),
        ("cost", 0.3, 350),
    ):
        if material.has(name):
            assert low < values.need(name) < high, name


def test_the_families_asked_for_are_there():
    metals = {"steel", "stainless", "cast-iron", "aluminium", "light-metal", "copper", "invar"}
    assert {material.family for material in ENGINEERING} == metals | {"composite", "plastic", "rubber", "printed"}


# EN 1993-1-2:2005 Table 3.1: E(T)/E(20 degC) of carbon steel.
EUROCODE_3 = [(20, 1.0), (100, 1.0), (200, 0.9), (250, 0.85), (300, 0.8), (400, 0.7)]


@pytest.mark.parametrize(("celsius", "factor"), EUROCODE_3)
@pytest.mark.parametrize("name", ["steel-s235", "steel-s355"])
def test_structural_steel_softens_as_in_eurocode_3(name, celsius, factor):
    modulus = shipped().find(name).need("elastic_modulus", CELSIUS + celsius)
    assert modulus == pytest.approx(factor * 210e9, rel=1e-9)


# EN 10088-1 (also tabulated by the British Stainless Steel Association): modulus of 1.4301 in GPa.
EN_10088 = [(20, 200), (100, 194), (200, 186), (300, 179), (400, 172), (500, 165)]


@pytest.mark.parametrize(("celsius", "gigapascal"), EN_10088)
def test_stainless_steel_softens_as_in_en_10088(celsius, gigapascal):
    for name in ("stainless-304", "stainless-316l"):
        modulus = shipped().find(name).need("elastic_modulus", CELSIUS + celsius)
        assert modulus == pytest.approx(gigapascal * 1e9)


# EN 1999-1-2:2007 Table 2: modulus of aluminium alloys in GPa.
EUROCODE_9 = [(20, 70), (50, 69.3), (100, 67.9), (150, 65.1), (200, 60.2)]


@pytest.mark.parametrize(("celsius", "gigapascal"), EUROCODE_9)
def test_aluminium_softens_as_in_eurocode_9(celsius, gigapascal):
    for name in ("aluminium-6061-t6", "aluminium-6082-t6", "aluminium-5083-h111"):
        modulus = shipped().find(name).need("elastic_modulus", CELSIUS + celsius)
        assert modulus == pytest.approx(gigapascal * 1e9)


# MIL-HDBK-5J in SI by hand: ksi = 6.894757 MPa, lb/in^3 = 27679.905 kg/m^3.
@pytest.mark.parametrize(
    ("name", "elastic_modulus", "shear_modulus", "density"),
    [
        ("aluminium-7075-t6", 71.016e9, 26.890e9, 2795.67),
        ("magnesium-az31b", 44.816e9, 16.547e9, 1768.75),
        ("titanium-ti-6al-4v", 110.316e9, 42.747e9, 4428.78),
    ],
)
def test_customary_units_come_out_in_si(name, elastic_modulus, shear_modulus, density):
    values = shipped().find(name).at()
    assert values.elastic_modulus == pytest.approx(elastic_modulus, rel=1e-4)
    assert values.shear_modulus == pytest.approx(shear_modulus, rel=1e-4)
    assert values.density == pytest.approx(density, rel=1e-4)


def quasi_isotropic(e1, e2, shear, nu12, alpha1, alpha2):
    """Return E, G, nu and alpha of a laminate by summing its plies at 0, 45, 90 and -45 degrees."""
    nu21 = nu12 * e2 / e1
    factor = 1 - nu12 * nu21
    cross = nu12 * e2 / factor
    ply = np.array([[e1 / factor, cross, 0], [cross, e2 / factor, 0], [0, 0, shear]])
    laminate, thermal = np.zeros((3, 3)), np.zeros(3)
    for degrees in (0, 45, 90, -45):
        c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
        # strain transformation (engineering shear) from laminate to ply axes
        shear_row = [-2 * c * s, 2 * c * s, c * c - s * s]
        strain = np.array([[c * c, s * s, c * s], [s * s, c * c, -c * s], shear_row])
        laminate += strain.T @ ply @ strain / 4
        thermal += strain.T @ ply @ np.array([alpha1, alpha2, 0]) / 4
    compliance = np.linalg.inv(laminate)
    expansion = compliance @ thermal
    return 1 / compliance[0, 0], 1 / compliance[2, 2], -compliance[0, 1] / compliance[0, 0], expansion[0]


@pytest.mark.parametrize(
    ("name", "ply"),
    [
        ("cfrp-quasi-isotropic", (135e9, 10e9, 5e9, 0.30, -0.3e-6, 28e-6)),
        ("gfrp-quasi-isotropic", (40e9, 8e9, 4e9, 0.25, 6e-6, 35e-6)),
    ],
)
def test_quasi_isotropic_laminates_follow_from_their_plies(name, ply):
    values = shipped().find(name).at()
    got = (values.elastic_modulus, values.shear_modulus, values.poisson_ratio, values.thermal_expansion)
    assert got == pytest.approx(quasi_isotropic(*ply), rel=1e-3)


# Performance Composites, Mechanical Properties of Carbon Fibre Composite Materials, retyped from
# performance-composites.com/carbonfibre/mechanicalproperties_2.asp: E1, E2 and G12 in GPa, nu12, alpha1 in 1e-6/K.
PLIES = {
    "cfrp-fabric": (70, 70, 5, 0.10, 2.1),
    "gfrp-fabric": (25, 25, 4, 0.20, 11.6),
    "cfrp-unidirectional": (135, 10, 5, 0.30, -0.3),
    "cfrp-high-modulus-unidirectional": (175, 8, 5, 0.30, -0.3),
    "gfrp-unidirectional": (40, 8, 4, 0.25, 6.0),
    "aramid-unidirectional": (75, 6, 2, 0.34, 4.0),
}


@pytest.mark.parametrize("name", PLIES)
def test_plies_are_those_of_their_data_sheet(name):
    result = shipped().find(name)
    names = ("elastic_modulus", "transverse_modulus", "shear_modulus", "poisson_ratio", "thermal_expansion")
    units = (1e9, 1e9, 1e9, 1.0, 1e-6)
    assert [result.need(item) / unit for item, unit in zip(names, units, strict=True)] == pytest.approx(PLIES[name])


# Callister and Rethwisch, Fundamentals of Materials Science and Engineering, 3rd ed., Appendix B, retyped from its
# Tables B.1, B.2, B.4 and B.6: modulus in GPa, density in g/cm^3, tensile strength in MPa, expansion in 1e-6/K.
CALLISTER = {
    "steel-1020": (207, 7.85, None, 11.7),
    "steel-4340": (207, 7.85, None, 12.3),
    "stainless-405": (200, 7.80, None, 10.8),
    "stainless-440a": (200, 7.80, 725, 10.2),
    "stainless-17-7ph": (204, 7.65, 1450, 11.0),
    "aluminium-1100-h14": (69, 2.71, 124, 23.6),
    "aluminium-2024-t3": (72.4, 2.77, 485, 22.9),
    "aluminium-356-t6-cast": (72.4, None, 228, 21.5),
    "brass-c26000": (110, 8.53, None, 19.9),
    "brass-c36000": (97, 8.50, None, 20.5),
    "bronze-c93200": (100, None, 240, 18.0),
    "magnesium-az91d-cast": (45, None, 165, 26.0),
    "titanium-grade-1": (103, None, 240, 8.6),
    "titanium-ti-5al-2.5sn": (110, None, 790, 9.4),
    "invar-36": (141, None, 517, 1.6),
    "polycarbonate": (2.38, None, None, 122),
    "ptfe": (0.475, 2.17, 20.7, 171),
    "uhmwpe": (0.69, 0.94, None, 297),
    "rubber-nbr": (0.0034, None, None, 235),
}


@pytest.mark.parametrize("name", CALLISTER)
def test_what_callister_prints(name):
    modulus, density, tensile_strength, expansion = CALLISTER[name]
    material = shipped().find(name)
    assert material.need("elastic_modulus") == pytest.approx(modulus * 1e9)
    assert material.need("thermal_expansion") == pytest.approx(expansion * 1e-6)
    if density is not None:
        assert material.need("density") == pytest.approx(density * 1e3)
    if tensile_strength is not None:
        assert material.need("tensile_strength") == pytest.approx(tensile_strength * 1e6)


# USGS, Mineral Commodity Summaries 2026, retyped, 2021 to 2024, in USD/kg (cents per pound / 100 / 0.45359237 kg);
# the European Central Bank's annual averages in USD per EUR.
POUND = 0.45359237
EURO = (1.1827, 1.0530, 1.0813, 1.0824)
ALUMINIUM = [cents / 100 / POUND for cents in (138.5, 152.6, 125.9, 129.5)]
COPPER = [cents / 100 / POUND for cents in (422.5, 399.8, 384.8, 414.7)]
ZINC = [cents / 100 / POUND for cents in (136.3, 158.1, 120.1, 126.0)]
MAGNESIUM = [dollars / 1000 for dollars in (5011, 5206, 3240, 2850)]
TITANIUM = [11.10, 11.10, 12.30, 13.30]
CHROMIUM = [dollars / POUND for dollars in (1.50, 3.19, 2.55, 1.76)]
NICKEL = [dollars / 1000 for dollars in (18476, 25815, 21495, 16812)]
MOLYBDENUM = [35.62, 41.72, 54.32, 47.72]
IRON = [0.567] * 4


@pytest.mark.parametrize(
    ("names", "shares"),
    [
        ([m.name for m in SHIPPED if m.family == "aluminium"], [(1, ALUMINIUM)]),
        (["magnesium-az31b", "magnesium-az91d-cast"], [(1, MAGNESIUM)]),
        (["titanium-ti-6al-4v", "titanium-grade-1", "titanium-ti-5al-2.5sn"], [(1, TITANIUM)]),
        (["brass-c26000"], [(0.7, COPPER), (0.3, ZINC)]),
        (["brass-c36000"], [(0.615, COPPER), (0.385, ZINC)]),
        (["stainless-304"], [(0.18, CHROMIUM), (0.08, NICKEL), (0.74, IRON)]),
        (["stainless-316l"], [(0.17, CHROMIUM), (0.10, NICKEL), (0.02, MOLYBDENUM), (0.71, IRON)]),
        (["stainless-2205"], [(0.22, CHROMIUM), (0.05, NICKEL), (0.03, MOLYBDENUM), (0.70, IRON)]),
    ],
)
def test_costs_of_metals_follow_from_the_published_prices(names, shares):
    years = [sum(share * price[year] for share, price in shares) / EURO[year] for year in range(4)]
    for name in names:
        material = shipped().find(name)
        assert material.need("cost") == pytest.approx(years[3], rel=3e-3), name
        assert material.spread("cost") == pytest.approx((min(years), max(years)), rel=3e-3), name
        assert "2024" in material.properties["cost"].note


# MEPS, February 2017 (USD per tonne, ECB 1.0643 USD per EUR), and Callister's Appendix C, January 2007 (USD per kg,
# ECB 1.2999 USD per EUR).
@pytest.mark.parametrize(
    ("name", "low", "high", "rate"),
    [
        ("steel-s235", 0.411, 0.816, 1.0643),
        ("steel-s355", 0.411, 0.816, 1.0643),
        ("polypropylene", 1.05, 1.70, 1.2999),
        ("pvc", 1.10, 1.85, 1.2999),
        ("ptfe", 14.80, 16.90, 1.2999),
        ("cfrp-unidirectional", 49, 66, 1.2999),
        ("cfrp-high-modulus-unidirectional", 120, 725, 1.2999),
        ("gfrp-unidirectional", 24, 50, 1.2999),
        ("cfrp-quasi-isotropic", 49, 66, 1.2999),
        ("gfrp-quasi-isotropic", 24, 50, 1.2999),
    ],
)
def test_other_costs_are_as_published(name, low, high, rate):
    assert shipped().find(name).spread("cost") == pytest.approx((low / rate, high / rate), rel=0.02)


def test_every_cost_has_its_spread_and_says_when():
    for material in ENGINEERING:
        if material.has("cost"):
            cost = material.properties["cost"]
            assert cost.spread is not None, material.name
            assert re.search(r"\b(2007|2017|2024)\b", cost.note), material.name
    without = {material.name for material in ENGINEERING if not material.has("cost")}
    assert not {name for name in without if name.startswith(("aluminium", "magnesium", "titanium", "brass"))}


# The paper's Table VI, retyped: E in GPa, density in g/cm^3.
@pytest.mark.parametrize(
    ("name", "modulus", "density"),
    [
        ("paper-aluminium", (71, 71), (2.7, 2.7)),
        ("paper-carbon-steel", (196, 216), (7.85, 7.85)),
        ("paper-cast-iron", (155, 155), (7.2, 7.4)),
        ("paper-alloy-steel", (190, 220), (7.82, 7.82)),
        ("paper-rubber", (0.008, 0.008), (1.3, 1.3)),
    ],
)
def test_the_papers_materials_are_as_printed_and_nothing_more(name, modulus, density):
    material = shipped().find(name)
    assert material.spread("elastic_modulus") == pytest.approx([value * 1e9 for value in modulus])
    assert material.spread("density") == pytest.approx([value * 1e3 for value in density])
    assert material.need("elastic_modulus") == pytest.approx(sum(modulus) / 2 * 1e9)
    assert material.need("density") == pytest.approx(sum(density) / 2 * 1e3)
    assert set(material.properties) == {"elastic_modulus", "density"}


def test_ranges_of_the_shipped_entries_are_enforced():
    aluminium = shipped().find("aluminium-6061-t6")
    with pytest.raises(OutOfRange, match=r"aluminium-6061-t6: elastic_modulus: .* not at 250 degC"):
        aluminium.need("elastic_modulus", CELSIUS + 250)
    warm = aluminium.at(CELSIUS + 90)  # yield strength holds up to 80 degC only, the modulus further
    assert warm.need("elastic_modulus") == pytest.approx(68.18e9)
    assert warm.yield_strength is None
    with pytest.raises(OutOfRange, match="yield_strength: is known from 0 degC to 80 degC, not at 90 degC"):
        warm.need("yield_strength")
    with pytest.raises(OutOfRange, match="elastic_modulus"):
        aluminium.at(CELSIUS + 250)
    with pytest.raises(MissingProperty, match="steel-s460n: cost"):
        shipped().find("steel-s460n").need("cost")


def test_ferromagnetism_is_known_where_it_matters():
    magnetic = {material.name for material in SHIPPED if material.magnetic}
    steels = {name for name in shipped().names if name.startswith(("steel-", "cast-iron-"))}
    assert magnetic == {*steels, "stainless-2205", "invar-36"}
    assert shipped().find("stainless-304").magnetic is False
    assert shipped().find("paper-carbon-steel").magnetic is None


# --- files and layers ---

GOOD = """
format_version: 1
references: {data sheet: Some publisher's data sheet}
materials:
  my-alloy: {source: data sheet, elastic_modulus: 80 GPa, density: 3000 kg/m^3}
"""


def write(path: Path, text: str) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return path


def test_layers_hide_what_is_below_them(tmp_path, monkeypatch):
    own = GOOD.replace("my-alloy", "steel-s355")
    monkeypatch.setenv("LINKWRIGHT_CATALOGUE", str(write(tmp_path / "own.yaml", own)))
    third = write(tmp_path / "third.yaml", own.replace("80 GPa", "90 GPa"))
    assert shipped().find("steel-s355").need("elastic_modulus") == 210e9
    assert load_catalogue().find("steel-s355").need("elastic_modulus") == 80e9
    assert load_catalogue([third]).find("steel-s355").need("elastic_modulus") == 90e9
    assert load_catalogue([third]).where("steel-s355")[-1] == str(third)
    assert "aluminium-6061-t6" in load_catalogue([third])


def test_own_catalogue_is_read_from_the_environment_and_must_then_exist(tmp_path, monkeypatch):
    monkeypatch.setenv("LINKWRIGHT_CATALOGUE", str(tmp_path / "none.yaml"))
    with pytest.raises(InputError, match="no such file"):
        load_catalogue()
    write(tmp_path / "none.yaml", GOOD)
    assert load_catalogue().find("my-alloy").need("density") == 3000


def test_own_catalogue_in_the_configuration_folder_may_be_absent(tmp_path, monkeypatch):
    monkeypatch.setattr("linkwright.core.units.files.user_config_dir", lambda name: str(tmp_path / name))
    assert "my-alloy" not in load_catalogue()
    write(tmp_path / "linkwright" / "materials.yaml", GOOD)
    assert "my-alloy" in load_catalogue()
    assert "my-alloy" not in load_catalogue(user=False)


def test_an_unknown_name_gets_the_nearest_one():
    with pytest.raises(InputError, match=r"arm\.yaml: material: .*did you mean 'steel-s355'"):
        shipped().find("steel-s35", file="arm.yaml")
    with pytest.raises(InputError, match="did you mean 'steel-s355'"):
        shipped().find("Steel-S355")


def test_a_material_is_a_name_or_its_properties():
    catalogue = shipped()
    assert catalogue.read("steel-s355", file="a", key="m") is catalogue.find("steel-s355")
    assert catalogue.read({"elastic_modulus": "1 GPa"}, file="a", key="m").need("elastic_modulus") == 1e9
    for wrong in (3, None, "", ["steel-s355"], True):
        with pytest.raises(InputError, match="a: m: "):
            catalogue.read(wrong, file="a", key="m")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("format_version: 1", "format_version: 2"), "format_version: 2 is not known"),
        (("format_version: 1", "format_version: true"), "format_version"),
        (("format_version: 1\n", ""), "format_version: is missing"),
        (("elastic_modulus: 80 GPa, ", ""), "my-alloy.elastic_modulus: is missing"),
        ((", density: 3000 kg/m^3", ""), "my-alloy.density: is missing"),
        (("source: data sheet, ", ""), "has no source"),
        (("source: data sheet", "source: hearsay"), "'hearsay' is not among the file's references"),
        (("80 GPa", "80"), "needs a unit"),
        (("80 GPa", "80 kg"), "is a mass, not an elastic modulus"),
        (("density: 3", "densitty: 3"), "density: is missing"),
        (("density:", "colour: red, density:"), "unknown key 'colour'"),
        (("density:", "magnetic: 1, density:"), "true or false"),
        (("materials:", "material:"), "unknown key 'material'; did you mean 'materials'"),
    ],
)
def test_a_catalogue_file_is_checked_on_load(tmp_path, change, words):
    text = GOOD.replace(*change)
    assert text != GOOD
    with pytest.raises(InputError, match=words) as caught:
        load_layer(write(tmp_path / "c.yaml", text))
    assert str(caught.value).startswith(str(tmp_path / "c.yaml"))


def test_the_same_material_twice_in_a_file_is_refused(tmp_path):
    entry = "  my-alloy: {source: data sheet, elastic_modulus: 1 GPa, density: 1 kg/m^3}\n"
    with pytest.raises(InputError, match="'my-alloy' occurs twice"):
        load_layer(write(tmp_path / "c.yaml", GOOD + entry))


def test_shipped_files_cite_every_reference_and_have_no_idle_ones():
    paths = sorted((CORE / "materials" / "catalogue").glob("*.yaml"))
    assert paths
    for path in paths:
        content = yaml.safe_load(path.read_text(encoding="utf-8"))
        layer = load_layer(path)
        cited = {key for material in layer.materials.values() for key in material.references}
        assert cited == set(content["references"]), path.name
