"""Edits of a catalogue: what lands is sound, what is not does not, and sources stay true."""

from dataclasses import replace

import pytest

from linkwright.core.catalogues.keyed import Entry
from linkwright.core.catalogues.materials import MATERIALS, find_entry
from linkwright.core.materials.catalogue import load_catalogue, load_layer, shipped_layers
from linkwright.core.units.quantities import InputError

ALLOY = Entry("alloy", {"elastic_modulus": "80 GPa", "density": "3000 kg/m^3", "source": "s"}, {"s": "A data sheet"})


@pytest.fixture
def own(tmp_path):
    return tmp_path / "deep" / "materials.yaml"


def material(path, name):
    return load_layer(path).materials[name]


def test_a_file_is_made_with_its_folder_and_holds_what_was_added(own):
    MATERIALS.add(own, [ALLOY])
    assert material(own, "alloy").need("density") == 3000
    assert material(own, "alloy").references == {"s": "A data sheet"}
    with pytest.raises(InputError, match="is there already"):
        MATERIALS.add(own, [ALLOY])
    MATERIALS.add(own, [Entry("alloy", {**ALLOY.content, "density": "3100 kg/m^3"}, ALLOY.references)], replace=True)
    assert material(own, "alloy").need("density") == 3100


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("density", 3000, "needs a unit"),
        ("density", "3000 kg", "is a mass"),
        ("density", "-1 kg/m^3", "above zero"),
        ("poisson_ratio", 0.6, "between -1 and 0.5"),
        ("shear_modulus", "20 GPa", "does not fit"),
        ("densitty", "1 kg/m^3", "unknown key 'densitty'"),
        ("cost", {"value": "1 EUR/kg", "source": "hearsay"}, "not among the file's references"),
        ("cost", "1 USD/kg", "EUR only"),
        ("tensile_strength", "50 MPa", "below the yield strength"),
        ("density.value.more", "1 kg/m^3", "holds no keys"),
    ],
)
def test_an_edit_that_is_not_sound_does_not_land(own, key, value, words):
    MATERIALS.add(
        own, [Entry("alloy", {**ALLOY.content, "poisson_ratio": 0.3, "yield_strength": "90 MPa"}, ALLOY.references)]
    )
    before = own.read_bytes()
    with pytest.raises(InputError, match=words) as caught:
        MATERIALS.set_keys(own, "alloy", {key: value})
    assert str(caught.value).startswith(str(own))
    assert own.read_bytes() == before


def test_changing_a_shipped_material_copies_it_with_its_sources(own):
    MATERIALS.set_keys(own, "steel-s355", {"yield_strength": "345 MPa"}, source="Certificate of heat 12")
    copy, shipped = material(own, "steel-s355"), load_catalogue(user=False).find("steel-s355")
    assert copy.need("yield_strength") == 345e6
    assert copy.references[copy.properties["yield_strength"].source] == "Certificate of heat 12"
    assert copy.properties["yield_strength"].note == ""  # it spoke of the old figure
    assert copy.properties["yield_strength"].valid == shipped.properties["yield_strength"].valid
    assert copy.family == "steel"
    for name in ("elastic_modulus", "density"):
        assert copy.properties[name].law == shipped.properties[name].law
        source = copy.references[copy.properties[name].source]
        assert source.split() == shipped.references[shipped.properties[name].source].split()


def test_every_shipped_material_can_be_copied_whole(own):
    names = load_catalogue(user=False).names
    MATERIALS.add(own, [entry for name in names if (entry := MATERIALS.shipped(name)) is not None])
    MATERIALS.set_keys(own, names[0], {"title": "mine"})
    assert sorted(load_layer(own).materials) == list(names)
    layers = {name: item for layer in shipped_layers() for name, item in layer.materials.items()}
    for name, copy in load_layer(own).materials.items():
        assert copy.family == layers[name].family
        assert {key: item.law for key, item in copy.properties.items()} == {
            key: item.law for key, item in layers[name].properties.items()
        }


def test_values_go_where_they_belong(own):
    MATERIALS.add(own, [ALLOY])
    MATERIALS.set_keys(own, "alloy", {"cost": {"value": "3 EUR/kg", "source": "s", "note": "n"}})
    MATERIALS.set_keys(own, "alloy", {"cost": "4 EUR/kg"})
    cost = material(own, "alloy").properties["cost"]
    assert (cost.law.value(293.15), cost.note) == (4, "n")
    MATERIALS.set_keys(own, "alloy", {"density.spread": ["2900 kg/m^3", "3100 kg/m^3"]})
    assert material(own, "alloy").spread("density") == (2900, 3100)
    MATERIALS.set_keys(own, "steel-s355", {"elastic_modulus": "205 GPa"})
    assert material(own, "steel-s355").need("elastic_modulus", 400.0) == 205e9
    MATERIALS.remove_key(own, "alloy", "cost")
    assert not material(own, "alloy").has("cost")


def test_removing(own):
    MATERIALS.add(own, [replace(ALLOY, name="other")])
    with pytest.raises(InputError, match="did you mean 'other'"):
        MATERIALS.remove(own, "othr")
    with pytest.raises(InputError, match="shipped with the program"):
        MATERIALS.remove(own, "steel-s355")
    with pytest.raises(InputError, match="cannot be a material's name"):
        MATERIALS.add(own, [replace(ALLOY, name=" x")])
    MATERIALS.remove(own, "other")
    assert not load_layer(own).materials


def test_several_come_all_or_none(own):
    with pytest.raises(InputError, match="comes twice"):
        MATERIALS.add(own, [ALLOY, ALLOY])
    with pytest.raises(InputError, match="density: is missing"):
        MATERIALS.add(own, [ALLOY, Entry("bad", {"elastic_modulus": "1 GPa", "source": "s"}, ALLOY.references)])
    assert not own.exists()


def test_the_same_source_key_for_another_text_gets_a_new_name(own):
    MATERIALS.add(own, [ALLOY])
    MATERIALS.add(own, [Entry("second", ALLOY.content, {"s": "Another data sheet"})])
    assert list(material(own, "alloy").references.values()) == ["A data sheet"]
    assert list(material(own, "second").references.values()) == ["Another data sheet"]


def test_an_editors_text_lands_only_if_sound_and_nobody_was_faster(own):
    MATERIALS.add(own, [ALLOY])
    before, text = MATERIALS.draft(own, "alloy")
    with pytest.raises(InputError, match="needs a unit"):
        MATERIALS.land(own, before, text.replace("3000 kg/m^3", "3000"))
    MATERIALS.set_keys(own, "alloy", {"title": "faster"})
    with pytest.raises(InputError, match="by somebody else"):
        MATERIALS.land(own, before, text.replace("3000", "3200"))
    before, text = MATERIALS.draft(own, "steel-s355")
    assert before is not None
    assert "steel-s355" not in before
    MATERIALS.land(own, before, text)
    assert "steel-s355" in load_layer(own).materials


def test_who_uses_a_material(tmp_path):
    (tmp_path / "arm.yaml").write_text("chain:\n  - link: {material: alloy}\n")
    (tmp_path / "problem.yaml").write_text("choose: {material: [steel-s355, alloy]}\nname: alloy\n")
    (tmp_path / "other.yaml").write_text("name: alloy\nchain:\n  - link: {material: alloy-2}\n")
    assert [MATERIALS.uses(tmp_path / f"{name}.yaml", "alloy", "material") for name in ("arm", "problem", "other")] == [
        True,
        True,
        False,
    ]


@pytest.mark.slow
def test_entries_travel_between_files_as_they_are_written(tmp_path):
    catalogue = load_catalogue(user=False)
    names = [name for name in catalogue.names if not name.startswith("paper")]
    out = tmp_path / "out.yaml"
    out.write_text(MATERIALS.text([find_entry(catalogue, name) for name in names]), encoding="utf-8")
    copies = load_layer(out).materials
    assert sorted(copies) == names
    for entry in MATERIALS.entries(out):
        copy, original = copies[entry.name], catalogue.find(entry.name)
        for key, item in original.properties.items():
            twin = copy.properties[key]
            assert (twin.law, twin.valid, twin.spread, twin.note) == (item.law, item.valid, item.spread, item.note)
            assert copy.references[twin.source] == original.references[item.source]
