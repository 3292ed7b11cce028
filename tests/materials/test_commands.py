"""`linkwright materials` from the outside: what it prints, what it writes, and how it ends."""

import csv
import json
import re

import pytest

from linkwright.core.materials.catalogue import load_catalogue, load_layer
from linkwright.core.materials.plausible import doubts_of
from linkwright.core.units.quantities import InputError
from tests.outcomes import of_catalogue, ok, wrong

COMMANDS = ("list", "show", "compare", "add", "edit", "remove", "check", "import", "export")


@pytest.fixture
def materials(tmp_path, tmp_path_factory, monkeypatch, capsys):
    """Run `linkwright materials` in a folder of its own with a catalogue of its own."""
    return of_catalogue("materials", tmp_path, tmp_path_factory, monkeypatch, capsys)


@pytest.mark.parametrize("command", COMMANDS)
def test_each_command_has_an_example(materials, command):
    assert f"Example: linkwright materials {command}" in " ".join(ok(materials(command, "--help")).split())


def test_list_filters_sorts_and_chooses_columns(materials, tmp_path):
    arguments = ("--family", "aluminium", "--family", "steel", "--where", "density < 3 g/cm^3", "--sort=-yield")
    out = ok(materials("list", *arguments, "--columns", "density,tensile", "--json", "l.json"))
    names = [line.split()[0] for line in out.splitlines()[2:] if line.strip() and not line.startswith("?")]
    assert names[:2] == ["aluminium-7075-t6", "aluminium-2024-t3"]
    assert names[-1] == "aluminium-5083-h111"
    assert "tensile" in out
    assert "expansion" not in out
    assert [m["name"] for m in json.loads((tmp_path / "l.json").read_text())["materials"]] == names
    cheap = ok(materials("list", "--where", "cost <= 1 EUR/kg", "--where", "E > 100 GPa", "--sort", "cost"))
    assert "steel-s355" in cheap
    assert "stainless-304" not in cheap
    assert "no material" in ok(materials("list", "--where", "density > 30 g/cm^3"))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("list", "--where", "density"), "is no condition"),
        (("list", "--where", "density < 3"), "needs a unit"),
        (("list", "--where", "densty < 3 kg/m^3"), "did you mean 'density'"),
        (("list", "--sort", "price"), "there is no property 'price'"),
        (("list", "--columns", "E,colour"), "there is no property 'colour'"),
        (("list", "--family", "alumnium"), "did you mean 'aluminium'"),
        (("list", "--catalogue", "none.yaml"), "no such file"),
        (("show", "steel-s356"), "did you mean"),
        (("show", "brass-c26000", "--plot", "p.html"), "no property of brass-c26000 is given over temperature"),
        (("compare", "steel-s355"), "two materials"),
        (("add", "x", "density"), "is not KEY=VALUE"),
        (("add", "x", "density=1 kg/m^3"), "elastic_modulus: is missing"),
        (("add", "x", "density=1 kg/m^3", "elastic_modulus=1 GPa"), "has no source"),
        (("edit", "steel-s355"), "$EDITOR: is not set"),
        (("edit", "steel-s355", "density"), "VALUE: is missing"),
        (("edit", "steel-s355", "density", "1"), "needs a unit"),
        (("edit", "steel-s999", "density", "1 kg/m^3"), "there is no such material"),
        (("remove", "steel-s355"), "shipped with the program"),
        (("check", "none.yaml"), "no such file"),
        (("import", "none.csv"), "no such file"),
        (("import", "arm.stl"), "is of no known kind"),
        (("export", "steel-s355", "--out", "x.pdf"), "is of no known kind"),
        (("export", "steel-s355", "steel-s235", "--out", "x.FCMat"), "holds one material"),
        (("export", "cfrp-fabric", "--out", "x.FCMat"), "is not isotropic"),
    ],
)
def test_wrong_input_is_one_line_and_status_2(materials, tmp_path, arguments, words):
    before = sorted(path.name for path in tmp_path.iterdir())
    wrong(materials(*arguments), words)
    after = sorted(path.name for path in tmp_path.iterdir() if path.name != "configuration")
    assert [name for name in before if name != "configuration"] == after
    assert not (tmp_path / "configuration" / "linkwright" / "materials.yaml").exists()


def test_show_has_sources_and_the_modulus_over_temperature(materials, tmp_path):
    out = " ".join(ok(materials("show", "steel-s355", "--plot", "s.html")).split())
    assert "EN 10025-2:2019" in out
    assert "400 degC ████" in out
    assert "147 GPa" in out
    page = (tmp_path / "s.html").read_text(encoding="utf-8")
    assert "steel-s355" in page
    assert "cdn.plot.ly/plotly" not in page.split("</script>")[-1]


def test_compare_shows_what_any_has(materials):
    out = ok(materials("compare", "steel-s355", "cfrp-unidirectional"))
    assert "135 GPa" in out
    assert "–" in out


def test_a_life_of_a_material(materials, tmp_path):
    own = tmp_path / "configuration" / "linkwright" / "materials.yaml"
    ok(materials("add", "alloy", "elastic_modulus=80 GPa", "density=3000 kg/m^3", "title=a, b", "--source", "Sheet 12"))
    assert load_layer(own).materials["alloy"].title == "a, b"
    own.write_text(own.read_text().replace("  alloy:\n", "  # mine\n  alloy:   # keep me\n"))
    ok(materials("edit", "alloy", "cost", "{value: 3 EUR/kg, spread: [2 EUR/kg, 4 EUR/kg]}", "--source", "Offer 7"))
    ok(materials("edit", "alloy", "cost", "3.5 EUR/kg"))
    ok(materials("edit", "alloy", "poisson_ratio", "0.3"))
    ok(materials("edit", "alloy", "poisson_ratio", "--unset"))
    ok(materials("edit", "steel-s355", "yield_strength", "345 MPa", "--source", "Certificate"))
    assert "3.5 EUR/kg" in ok(materials("show", "alloy"))
    assert "345 MPa" in ok(materials("compare", "steel-s355", "alloy"))
    (tmp_path / "arm.yaml").write_text("chain:\n  - link: {material: alloy}\n")
    (tmp_path / "other.yaml").write_text("chain:\n  - link: {material: steel-s355}\n")
    assert "  # mine\n  alloy:   # keep me\n" in own.read_text()
    status, out, err = materials("remove", "steel-s355", "--used-in", "arm.yaml", "--used-in", "other.yaml")
    assert (status, err) == (0, "WARNING: other.yaml uses steel-s355\n")
    assert "the shipped one shows again" in out
    assert list(load_layer(own).materials) == ["alloy"]
    assert "materials, all sound" in ok(materials("check"))


def test_a_catalogue_of_ones_choice(materials):
    ok(materials("add", "x", "elastic_modulus=1 GPa", "density=1 g/cm^3", "--source", "s", "--catalogue", "c.yaml"))
    assert "1 GPa" in ok(materials("show", "x", "--catalogue", "c.yaml"))
    wrong(materials("show", "x"), "there is no material 'x'")
    assert ok(materials("check", "c.yaml")) == "c.yaml: 1 material, all sound\n"


def test_the_editor_gets_the_file_and_only_sound_text_lands(materials, tmp_path, monkeypatch):
    own = tmp_path / "configuration" / "linkwright" / "materials.yaml"
    ok(materials("add", "alloy", "elastic_modulus=80 GPa", "density=3000 kg/m^3", "--source", "s"))
    monkeypatch.setenv("EDITOR", "sed -i s/3000/3100/")
    ok(materials("edit", "alloy"))
    assert load_layer(own).materials["alloy"].need("density") == 3100
    monkeypatch.setenv("EDITOR", "sed -i 's/3100 kg/3100 m/'")
    wrong(materials("edit", "alloy"), "nothing was changed, your text is in")
    monkeypatch.setenv("EDITOR", "false")
    wrong(materials("edit", "alloy"), "ended with status 1")
    monkeypatch.setenv("EDITOR", "no-such-editor-here")
    wrong(materials("edit", "alloy"), "cannot be run")
    monkeypatch.setenv("EDITOR", "true")
    assert "nothing was changed" in ok(materials("edit", "alloy"))
    assert load_layer(own).materials["alloy"].need("density") == 3100


@pytest.mark.parametrize("name", ["t.csv", "t.yaml", "t.FCMat", "old.FCMat"])
def test_what_is_exported_can_be_imported(materials, name):
    more = ["--freecad-0.21"] if name.startswith("old") else []
    ok(materials("export", "titanium-ti-6al-4v", "--out", name, *more))
    ok(materials("import", name, "--name", "mine"))
    mine = load_catalogue().find("mine")
    original = load_catalogue(user=False).find("titanium-ti-6al-4v")
    for key in ("elastic_modulus", "density", "yield_strength", "tensile_strength", "thermal_expansion"):
        assert mine.need(key) == pytest.approx(original.need(key), rel=1e-9)
    wrong(materials("import", name, "--name", "mine"), "is there already")
    ok(materials("import", name, "--name", "mine", "--replace"))


def test_the_whole_catalogue_goes_into_a_table(materials, tmp_path):
    ok(materials("export", "--out", "all.csv"))
    with (tmp_path / "all.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [row["name"] for row in rows] == list(load_catalogue(user=False).names)


def test_whether_it_is_magnetic_is_asked_listed_and_compared(materials):
    out = ok(materials("list", "--where", "magnetic = no", "--columns", "magnetic,service_temperature"))
    assert "stainless-304" in out
    assert "steel-s355" not in out
    assert "paper-carbon-steel" not in out
    told = ok(materials("compare", "steel-s355", "stainless-304", "paper-carbon-steel"))
    assert next(line.split()[1:] for line in told.splitlines() if "magnetic" in line) == ["yes", "no", "–"]
    wrong(materials("list", "--where", "magnetic > no"), "magnetic is yes or no")
    wrong(materials("list", "--where", "strength > 1 MPa"), "there is no property 'strength'")


def test_several_keys_are_one_edit(materials, tmp_path):
    before = ("add", "alloy", "elastic_modulus=80 GPa", "density=3 g/cm3", "--source", "Data sheet 12")
    own = tmp_path / "own.yaml"
    ok(materials(*before, "--catalogue", own))
    both = ("edit", "alloy", "cost=3 EUR/kg", "yield_strength=200 N/mm2", "--catalogue", own)
    assert "set alloy.cost, alloy.yield_strength" in ok(materials(*both))
    alloy = load_layer(own).materials["alloy"]
    assert (alloy.need("cost"), alloy.need("yield_strength"), alloy.need("density")) == (3.0, 2e8, 3000.0)
    wrong(materials("edit", "alloy", "cost=4 EUR/kg", "density=-1 kg/m^3", "--catalogue", own), "density")
    assert load_layer(own).materials["alloy"].need("cost") == 3.0


@pytest.mark.parametrize(
    ("values", "doubted"),
    [
        (("elastic_modulus=80000 GPa", "density=3000 kg/m^3"), "elastic_modulus 80000 GPa"),
        (("elastic_modulus=80 GPa", "density=3 kg/m^3"), "density 3 kg/m^3"),
        (("elastic_modulus=800 GPa", "density=300 kg/m^3"), "E / density of 2667 MN*m/kg"),
        (("elastic_modulus=1143 GPa", "density=3515 kg/m^3"), ""),
        (("elastic_modulus=2070 GPa", "density=7850 kg/m^3"), "elastic_modulus 2070 GPa"),
        (("elastic_modulus=700 GPa", "density=7850 kg/m^3"), "E / density of 89.17 MN*m/kg"),
        (("elastic_modulus=700 GPa", "density=15630 kg/m^3"), ""),
        (("elastic_modulus=7.1 GPa", "density=2700 kg/m^3", "family=aluminium"), "E / density of 2.63 MN*m/kg"),
    ],
)
def test_what_is_hardly_believable_is_taken_and_questioned(materials, tmp_path, values, doubted):
    """Diamond is the stiffest there is, and stiffest for its weight; of dense solids tungsten carbide is."""
    own = ("--catalogue", tmp_path / "own.yaml")
    for asked in (("add", "odd", *values, "--source", "s", *own), ("check", *own)):
        status, out, err = materials(*asked)
        assert status == 0
        assert out
        assert (f"WARNING: odd: {doubted} is hardly believable" in err) if doubted else err == ""


def test_nothing_shipped_is_doubted():
    assert [doubt for material in load_catalogue(user=False) for doubt in doubts_of(material)] == []


def test_a_price_of_what_no_catalogue_has_is_an_error(tmp_path):
    path = tmp_path / "own.yaml"
    path.write_text(
        "format_version: 1\nprices: {no-such: {value: 1 EUR/kg, date: 2026, source: x}}\n", encoding="utf-8"
    )
    with pytest.raises(InputError, match=r"prices\.no-such: there is no such material"):
        load_catalogue([path], user=False)


def test_what_could_not_be_found_in_its_source_is_marked(materials, tmp_path):
    """In list, show and JSON; a figure of one's own in its place takes the mark away."""
    out = ok(materials("list", "--columns", "density,E", "--json", "l.json"))
    rows = {row["name"]: row["properties"] for row in json.loads((tmp_path / "l.json").read_text())["materials"]}
    line = next(line for line in out.splitlines() if line.startswith("aluminium-7075-t6 "))
    assert line.count("?") == 2
    assert "MIL-HDBK-5J" in rows["aluminium-7075-t6"]["density"]["unconfirmed"]
    assert rows["aluminium-7075-t6"]["yield_strength"]["unconfirmed"] is None
    assert "could not be found in its source" in out
    assert "?" not in ok(materials("list", "--family", "composite"))
    compared = ok(materials("compare", "aluminium-7075-t6", "aluminium-2024-t3"))
    assert next(line for line in compared.splitlines() if line.startswith("density")).count("?") == 1
    assert "could not be found in its source" in compared
    ok(materials("edit", "aluminium-7075-t6", "density", "2800 kg/m^3", "--source", "weighed"))
    own = tmp_path / "configuration" / "linkwright" / "materials.yaml"
    edited = load_layer(own).materials["aluminium-7075-t6"].properties
    assert (edited["density"].unconfirmed, bool(edited["elastic_modulus"].unconfirmed)) == ("", True)
    assert edited["yield_strength"].found_in.startswith("batz-burgel.com")
    ok(materials("edit", "aluminium-7075-t6", "yield_strength", "450 MPa"))
    assert load_layer(own).materials["aluminium-7075-t6"].properties["yield_strength"].found_in == ""
    assert "not confirmed" in " ".join(ok(materials("show", "aluminium-7075-t6")).split())
    wrong(materials("edit", "aluminium-7075-t6", "unconfirmed", "{no_such: x}"), "unknown key 'no_such'")


def test_every_shipped_figure_was_found_or_is_marked():
    """One or the other, whether it is magnetic included; nothing is unmarked."""
    for material in load_catalogue(user=False):
        marks = {name: (item.found_in, item.unconfirmed) for name, item in material.properties.items()}
        if material.magnetic is not None:
            marks["magnetic"] = (material.magnetic_found_in, material.magnetic_unconfirmed)
        unclear = {name for name, (found, missing) in marks.items() if bool(found) == bool(missing)}
        assert unclear == set(), material.name
        if material.isotropic and "shear_modulus" not in material.properties and material.has("shear_modulus"):
            follows = [material.unconfirmed(name) for name in ("elastic_modulus", "poisson_ratio")]
            assert bool(material.unconfirmed("shear_modulus")) == any(follows)


@pytest.mark.parametrize("kind", ["yaml", "csv"])
def test_marks_go_with_what_is_exported_and_imported(materials, tmp_path, kind):
    ok(materials("export", "aluminium-6061-t6", "--out", f"own.{kind}"))
    text = (tmp_path / f"own.{kind}").read_text(encoding="utf-8")
    (tmp_path / f"own.{kind}").write_text(text.replace("aluminium-6061-t6", "mine"), encoding="utf-8")
    ok(materials("import", f"own.{kind}"))
    catalogue = load_catalogue([tmp_path / "configuration" / "linkwright" / "materials.yaml"], user=False)
    mine, shipped = (catalogue.find(name).properties for name in ("mine", "aluminium-6061-t6"))
    assert {name: item.unconfirmed for name, item in mine.items()} == {
        name: item.unconfirmed for name, item in shipped.items()
    }
    if kind == "yaml":
        assert {name: item.found_in for name, item in mine.items()} == {
            name: item.found_in for name, item in shipped.items()
        }


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("found_in: {nobody: there}\n", "found_in.nobody: is none of the file's references"),
        ("", "found_in.density: was found and is not confirmed; only one can be"),
    ],
)
def test_marks_that_contradict_are_refused(tmp_path, text, words):
    (tmp_path / "own.yaml").write_text(
        "format_version: 1\nreferences: {s: a sheet}\n" + text + "materials:\n  mine:\n    source: s\n"
        "    elastic_modulus: 70 GPa\n    density: 2700 kg/m^3\n"
        "    found_in: {density: page 3}\n    unconfirmed: {density: looked for}\n",
        encoding="utf-8",
    )
    with pytest.raises(InputError, match=re.escape(words)):
        load_layer(tmp_path / "own.yaml")


def test_keys_go_by_the_names_of_the_list(materials, tmp_path):
    """`E` and `yield` are its headings; a key by both its names is a mistake."""
    ok(materials("add", "my-alloy", "E=80 GPa", "density=3 g/cm3", "yield=200 MPa", "--source", "sheet 12"))
    ok(materials("edit", "my-alloy", "E.spread", "[78 GPa, 82 GPa]"))
    made = load_layer(tmp_path / "configuration" / "linkwright" / "materials.yaml").materials["my-alloy"]
    assert made.need("elastic_modulus") == pytest.approx(80e9)
    assert made.need("yield_strength") == pytest.approx(200e6)
    wrong(materials("edit", "my-alloy", "E=81 GPa", "elastic_modulus=82 GPa"), "E: is given by both its names")
    ok(materials("edit", "my-alloy", "yield", "--unset"))
    made = load_layer(tmp_path / "configuration" / "linkwright" / "materials.yaml").materials["my-alloy"]
    assert not made.has("yield_strength")
