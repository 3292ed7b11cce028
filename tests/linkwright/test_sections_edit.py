"""`linkwright sections` from the outside: what it prints, what it writes, and how it ends."""

import csv
import json
import math

import numpy as np
import pytest

from linkwright.core.sections import load_stock
from linkwright.core.sections.stock.tables import read_file
from tests.costs import slow_but
from tests.outcomes import of_catalogue, ok, wrong

COMMANDS = ("list", "show", "compare", "add", "edit", "remove", "check", "import", "export")
TUBE = ("add", "TUBE 60x4", "shape=tube", "diameter=60 mm", "thickness=4 mm", "--source", "Offer 12")


@pytest.fixture
def own(tmp_path):
    return tmp_path / "configuration" / "linkwright" / "sections.yaml"


@pytest.fixture
def sections(tmp_path, tmp_path_factory, monkeypatch, capsys):
    """Run `linkwright sections` in a folder of its own with stock tables of its own."""
    return of_catalogue("sections", tmp_path, tmp_path_factory, monkeypatch, capsys)


def rows_of(out):
    """The first column of a printed table (two blanks end it)."""
    return [line.split("  ")[0].strip() for line in out.splitlines()[2:] if "  " in line]


@pytest.mark.parametrize("command", COMMANDS)
def test_each_command_has_an_example(sections, command):
    assert f"Example: linkwright sections {command}" in " ".join(ok(sections(command, "--help")).split())


def test_list_filters_sorts_and_chooses_columns(sections, tmp_path):
    arguments = ("--family", "IPE", "--family", "shs", "--where", "I_y > 100 cm^4", "--where", "area <= 20 cm^2")
    out = ok(sections("list", *arguments, "--sort=-I_y", "--columns", "height,W_y", "--json", "l.json"))
    names = rows_of(out)
    assert names[0] == "SHS 150x3"
    assert {name.split()[0] for name in names} == {"IPE", "SHS"}
    assert "height mm" in out
    assert "W_y cm³" in out
    assert "A cm²" not in out
    listed = json.loads((tmp_path / "l.json").read_text())["stock"]
    assert [size["name"] for size in listed] == names
    moments = [size["second_moment_y_cm4"] for size in listed]
    assert moments == sorted(moments, reverse=True)
    assert all(size["second_moment_y_cm4"] > 100 and size["area_cm2"] <= 20 for size in listed)
    round_ones = rows_of(ok(sections("list", "--where", "diameter < 25 mm")))
    assert round_ones
    assert all(name.startswith(("ALU", "CHS")) for name in round_ones)
    assert "no stock size" in ok(sections("list", "--where", "area > 9 m^2"))


def test_compare_shows_what_any_has(sections):
    out = ok(sections("compare", "IPE 80", "CHS 60.3x4"))
    assert "root radius" in out
    assert "diameter" in out
    assert "–" in out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("list", "--where", "area"), "is no condition"),
        (("list", "--where", "area < 3"), "needs a unit"),
        (("list", "--where", "arae < 3 cm^2"), "did you mean 'area'"),
        (("list", "--sort", "price"), "has no 'price'"),
        (("list", "--columns", "A,colour"), "has no 'colour'"),
        (("list", "--family", "IPX"), "there is no family"),
        (("list", "--catalogue", "none.yaml"), "none.yaml"),
        (("compare", "IPE 80"), "two sizes"),
        (("compare", "IPE 80", "IPE 81"), "did you mean"),
        (("add", "x", "diameter=1 mm", "--source", "s"), "shape: is missing"),
        (("add", "x", "shape=tub", "--source", "s"), "did you mean 'tube'"),
        (("add", "x", "shape=tube", "diameter=60", "thickness=4 mm", "--source", "s"), "needs a unit"),
        (("add", "x", "shape=tube", "diameter=60 mm", "wall=4 mm", "--source", "s"), "is nothing that a tube has"),
        (("add", "x", "shape=tube", "diameter=60 mm", "--source", "s"), "needs its thickness"),
        (("add", "x", "shape=tube", "diameter=60 mm", "thickness=31 mm", "--source", "s"), "x:"),
        (("add", "x", "shape=circle", "diameter=60 mm"), "--source: is missing"),
        (("add", "x", "shape=circle", "diameter", "--source", "s"), "is not KEY=VALUE"),
        (("edit", "IPE 80"), "$EDITOR: is not set"),
        (("edit", "IPE 80", "height"), "VALUE: is missing"),
        (("edit", "IPE 80", "height", "90 mm"), "its dimensions give"),
        (("edit", "IPE 80", "shape", "tube"), "cannot be changed"),
        (("edit", "IPE 81", "height", "90 mm"), "there is no such size"),
        (("remove", "IPE 80"), "shipped with the program"),
        (("check", "none.yaml"), "no such file"),
        (("import", "none.csv"), "no such file"),
        (("import", "arm.stl"), "is of no known kind"),
        (("export", "--out", "x.pdf"), "is of no known kind"),
        (("export", "IPE 81"), "did you mean"),
    ],
)
def test_wrong_input_is_one_line_and_status_2(sections, tmp_path, own, arguments, words):
    wrong(sections(*arguments), words)
    assert [path.name for path in tmp_path.iterdir() if path.name != "configuration"] == []
    assert not own.exists()


def test_a_life_of_a_size(sections, tmp_path, own):
    ok(sections(*TUBE))
    result = load_stock().find("tube60x4")
    assert (result.family, result.source) == ("TUBE", "Offer 12")
    assert float(result.section.properties(0.3).area) == pytest.approx(math.pi / 4 * (0.06**2 - 0.052**2))
    ok(sections("add", "TUBE 70x4", *TUBE[2:3], "diameter=70 mm", *TUBE[4:]))
    own.write_text(own.read_text().replace("      - [TUBE 70x4", "      # the large one\n      - [TUBE 70x4"))
    ok(sections("edit", "TUBE 60x4", "thickness", "5 mm"))
    text = own.read_text()
    assert "- [TUBE 60x4, 60, 5]\n      # the large one\n      - [TUBE 70x4, 70, 4]\n" in text
    ok(sections("edit", "TUBE 60x4", "area", "8.64 cm^2"))
    wrong(sections("edit", "TUBE 60x4", "thickness", "4 mm"), "area_cm2 is 8.64, its dimensions give 7.037")
    ok(sections("edit", "TUBE 60x4", "thickness=4 mm", "area=7.04 cm^2"))
    ok(sections("edit", "TUBE 60x4", "--unset", "area"))
    assert not load_stock().find("TUBE 60x4").printed
    (tmp_path / "arm.yaml").write_text("chain:\n  - link: {section: tube60x4}\n")
    (tmp_path / "other.yaml").write_text("chain:\n  - link: {section: TUBE 70x4}\n")
    used_in = ("--used-in", "arm.yaml", "--used-in", "other.yaml")
    status, _, err = sections("remove", "TUBE 70x4", *used_in)
    assert (status, err) == (0, "WARNING: other.yaml uses TUBE 70x4\n")
    assert "70" not in own.read_text()
    assert f"{own}: 1 size, all sound" in ok(sections("check"))


def test_changing_a_shipped_size_copies_it(sections, own):
    ok(sections("edit", "ipe80", "family", "OURS"))
    copy, shipped = load_stock().find("IPE 80"), load_stock(user=False).find("IPE 80")
    assert copy.family == "OURS"
    assert copy.file == str(own)
    assert (copy.dimensions, copy.printed, copy.source) == (shipped.dimensions, shipped.printed, shipped.source)
    assert "shows again" in ok(sections("remove", "IPE 80"))
    assert load_stock().find("IPE 80") == shipped


def test_the_editor_gets_the_file_and_only_sound_text_lands(sections, own, monkeypatch):
    ok(sections(*TUBE))
    monkeypatch.setenv("EDITOR", "sed -i 's/60, 4/60, 4.5/'")
    ok(sections("edit", "TUBE 60x4"))
    assert load_stock().find("TUBE 60x4").dimensions["thickness"] == 0.0045
    before = own.read_text()
    monkeypatch.setenv("EDITOR", "sed -i 's/7.64, 80.1/7.64, 90.1/'")
    wrong(sections("edit", "IPE 80"), "second_moment_y_cm4 is 90.1")
    assert own.read_text() == before


def test_a_file_of_ones_choice(sections):
    ok(sections(*TUBE, "--catalogue", "c.yaml"))
    assert "TUBE 60x4" in ok(sections("show", "TUBE 60x4", "--catalogue", "c.yaml"))
    wrong(sections("show", "TUBE 60x4"), "there is no stock size")
    assert ok(sections("check", "c.yaml")) == "c.yaml: 1 size, all sound\n"


def test_one_size_can_be_imported_under_another_name(sections, own):
    ok(sections("export", "IPE 80", "--out", "one.csv"))
    ok(sections("import", "one.csv", "--name", "OURS 80"))
    (copy,) = read_file(own)
    assert copy.name == "OURS 80"
    ok(sections("export", "IPE 80", "IPE 100", "--out", "two.csv"))
    wrong(sections("import", "two.csv", "--name", "OURS 90"), "has 2 sizes; --name is for one")


FAMILIES = (
    ("IPE", "HEA", "ALU BAR", "ALU TUBE"), ("RHS",), ("CHS",), ("HFSHS",), ("HFRHS",), ("SHS",),
    ("HEB", "HEM", "ALU RT", "ALU FLAT", "HFS"),
)  # fmt: skip


def test_families_are_all_that_are_shipped():
    """Those that are exported and imported below."""
    assert {name for item in FAMILIES for name in item} == {size.family for size in load_stock(user=False)}


@pytest.mark.parametrize("families", slow_but(FAMILIES, FAMILIES[0]), ids=", ".join)
@pytest.mark.parametrize("name", ["some.yaml", "some.csv"])
def test_what_is_exported_can_be_imported(sections, own, name, families):
    ok(sections("export", *(word for family in families for word in ("--family", family)), "--out", name))
    ok(sections("import", name))
    shipped = {size.name: size for size in load_stock(user=False) if size.family in families}
    copies = {size.name: size for size in read_file(own)}
    assert len(shipped) > 20
    assert set(copies) == set(shipped)
    for key, copy in copies.items():
        assert copy.dimensions == shipped[key].dimensions
        assert copy.printed == shipped[key].printed
        assert copy.source == shipped[key].source
    wrong(sections("import", name), "is there already")
    ok(sections("import", name, "--replace"))


def test_wrong_rows_of_a_table_are_all_named_and_the_others_land(sections, tmp_path, own):
    ok(sections("export", "--family", "CHS", "--out", "chs.csv"))
    with (tmp_path / "chs.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    rows[3]["area_cm2"] = rows[4]["area_cm2"]
    rows[9]["thickness_mm"], rows[11]["diameter_mm"] = "3 mm", rows[11]["thickness_mm"]
    with (tmp_path / "chs.csv").open("w", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)
    status, out, err = sections("import", "chs.csv")
    assert (status, err.count("chs.csv")) == (2, 4)
    for words in (f"{rows[3]['name']}: area_cm2", "line 11: thickness_mm: needs a number", f"{rows[11]['name']}: "):
        assert words in err
    assert f"3 of {len(rows)} sizes were not taken" in err
    assert f"added {len(rows) - 3} sizes" in out
    landed = {size.name for size in read_file(own)}
    assert landed == {row["name"] for row in rows} - {rows[at]["name"] for at in (3, 9, 11)}


def test_a_table_without_a_right_row_brings_nothing(sections, tmp_path, own):
    (tmp_path / "one.csv").write_text(
        "name,family,shape,source,diameter_mm,thickness_mm,area_cm2\nC 1,C,tube,x,60.3,3.2,5.47\n", encoding="utf-8"
    )
    wrong(sections("import", "one.csv"), "C 1: area_cm2 is 5.47")
    assert not own.exists()


WIDE = """AISC_Manual_Label,Type,W,A,d,bf,tf,tw,kdes,Ix,Iy,Sx
W8X31,W,31,9.13,8.00,8.00,0.435,0.285,0.829,110,37.1,27.5
W40X655,W,655,193,43.6,16.9,3.54,1.97,4.72,56500,2870,2590
W44X335,W,335,98.5,44.0,15.9,1.77,1.03,2.56,31100,1200,1410
"""  # AISC Shapes Database v15.0


def rolled(d, bf, tf, tw, kdes):
    """A, Ix and Iy of a rolled I from AISC's figures, the fillets summed in strips."""
    r, web = kdes - tf, d - 2 * tf
    x = (np.arange(2000) + 0.5) / 2000 * r
    y = r - np.sqrt(
        r**2 - (r - x) ** 2
    )  # a fillet's height at x from the web, as well as its width at x from the flange
    strips = y * r / 2000
    area = 2 * bf * tf + web * tw + 4 * strips.sum()
    along = 2 * (bf * tf**3 / 12 + bf * tf * (0.5 * (d - tf)) ** 2) + tw * web**3 / 12
    return (
        area,
        along + 4 * (strips * (0.5 * web - x) ** 2).sum(),
        tf * bf**3 / 6 + web * tw**3 / 12 + 4 * (strips * (0.5 * tw + x) ** 2).sum(),
    )


@pytest.mark.usefixtures("own")
def test_a_table_in_inches_is_read_as_it_is_printed(sections, tmp_path):
    """A and I are those of the sizes as printed, and the printed ones within what all were rounded by."""
    (tmp_path / "wide.csv").write_text(WIDE, encoding="utf-8")
    assert "added W8X31, W40X655, W44X335" in ok(sections("import", "wide.csv"))
    for row in csv.DictReader(WIDE.splitlines()):
        size = load_stock().find(row["AISC_Manual_Label"])
        sizes = {key: float(row[key]) for key in ("d", "bf", "tf", "tw", "kdes")}
        assert size.dimensions["root_radius"] == pytest.approx(0.0254 * (sizes["kdes"] - sizes["tf"]))
        properties = size.section.properties(0.3)
        results = [getattr(properties, name) for name in ("area", "second_moment_y", "second_moment_z")]
        expected = np.array(rolled(**sizes))
        assert np.array(results) / 0.0254 ** np.array([2, 4, 4]) == pytest.approx(expected, rel=1e-4)
        printed = np.array([float(row[key]) for key in ("A", "Ix", "Iy")])
        allowed = [0.5 * 10.0 ** (math.floor(math.log10(value)) - 2) for value in printed]
        for key, value in sizes.items():
            half = 0.5 * 10.0 ** -len(row[key].partition(".")[2])
            allowed += abs(np.array(rolled(**{**sizes, key: value + half})) - expected)
        assert np.all(abs(printed - expected) <= allowed)
    assert "9.13 in²" in ok(sections("show", "W8X31"))
    ok(sections("edit", "W8X31", "second_moment_y=110 in^4", "area=9.12 in^2"))
    assert load_stock().find("W8X31").printed["area_in2"] == 9.12
    wrong(sections("edit", "W8X31", "area", "9.2 in^2"), "area_in2 is 9.2")
    ok(sections("export", "W40X655", "--out", "wide.yaml"))
    assert read_file(tmp_path / "wide.yaml")[0].cells["height_in"] == 43.6


def test_rows_in_inches_that_do_not_fit_or_are_of_another_kind_are_named(sections, tmp_path):
    """The area of W18X192 in AISC's database is by more off than its sizes are rounded; a C shape's flanges slope."""
    text = WIDE + "W18X192,W,192,56.2,20.4,11.5,1.75,0.960,2.15,3870,440,380\n"
    (tmp_path / "wide.csv").write_text(text + "C15X50,C,50,14.7,15.0,3.72,0.650,0.716,1.44,404,11.0,53.8\n")
    status, out, err = sections("import", "wide.csv")
    assert (status, "W44X335" in out) == (2, True)
    assert "W18X192: area_in2 is 56.2, its dimensions give 56.61" in err
    assert "line 6: shape: there is no shape 'C'" in err
