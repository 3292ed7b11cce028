"""The catalogue: what is shipped against published figures, layers, and what a catalogue file must have."""

from pathlib import Path

import numpy as np
import pytest
import yaml

from materials.catalogue import load_catalogue, load_layer, shipped_layers
from materials.material import MissingProperty, OutOfRange
from materials.quantities import InputError

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
    assert len(ENGINEERING) >= 15
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
    shear_modulus = values.need("shear_modulus")
    if material.isotropic:
        expected = values.need("elastic_modulus") / (2 * (1 + values.need("poisson_ratio")))
        assert shear_modulus == pytest.approx(expected, rel=0.02)
    assert 0 < values.need("thermal_expansion") < 30e-6
    assert 1000 < values.need("density") < 8100


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
    with pytest.raises(MissingProperty, match="steel-s355: cost"):
        shipped().find("steel-s355").need("cost")


def test_ferromagnetism_is_known_where_it_matters():
    magnetic = {material.name for material in SHIPPED if material.magnetic}
    assert magnetic == {"steel-s235", "steel-s355", "steel-42crmo4", "cast-iron-gjl-250", "cast-iron-gjs-400"}
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
    monkeypatch.setattr("materials.catalogue.user_config_dir", lambda name: str(tmp_path / name))
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
    folder = Path(__file__).parents[2] / "materials" / "catalogue"
    for path in folder.glob("*.yaml"):
        content = yaml.safe_load(path.read_text(encoding="utf-8"))
        layer = load_layer(path)
        cited = {key for material in layer.materials.values() for key in material.references}
        assert cited == set(content["references"]), path.name
