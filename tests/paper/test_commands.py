"""`linkwright tables` and `linkwright figures` as people and scripts meet them."""

import csv
import json
import math
import re
from pathlib import Path

import pytest

import linkwright as lw
from linkwright.cli import run
from linkwright.markdown.described import markdown
from linkwright.paper.extended import request
from linkwright.paper.output.pages import BEGIN, END, describe, into
from linkwright.paper.tables import proofs, verdicts

pytestmark = pytest.mark.slow

TABLES = ("clearance", "backlash", "backlash_direction", "material", "shape")
MINE = """format_version: 1
references: {sheet: a data sheet}
materials: {mine: {source: sheet, elastic_modulus: 142 GPa, density: 4000 kg/m^3, poisson_ratio: 0.33}}
"""
DOCS = Path(__file__).resolve().parents[2] / "docs" / "paper.md"


@pytest.fixture(scope="module")
def extended(book):
    """The tables that the paper lacks."""
    return request(book.paper, (), (), None).tables(lambda *_: None)


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """One run of `tables` with everything written."""
    folder = tmp_path_factory.mktemp("tables")
    files = [
        "--json",
        folder / "t.json",
        "--csv",
        folder / "csv",
        "--markdown",
        folder / "t.md",
        "--out",
        folder / "out",
    ]
    arguments = ["tables", *files]
    assert run([str(argument) for argument in arguments]) == 0
    return folder


def test_json_keeps_the_contract(written, book):
    """Five lists of rows, each with label, paper, reproduced, corrected_mm and note."""
    content = json.loads((written / "t.json").read_text(encoding="utf-8"))
    for key in TABLES:
        rows = content[key]
        assert [row["label"] for row in rows] == [row.label for row in book.table(key).rows]
        for row, printed in zip(rows, book.table(key).rows, strict=True):
            assert row["paper"] == [float(text) for text in printed.printed]
            assert len(row["paper"]) == len(row["reproduced"]) == len(row["corrected_mm"]) == len(row["agrees"])
            assert row["agrees"] == [a == b for a, b in zip(row["paper"], row["reproduced"], strict=True)]
            assert row["note"]
    assert content["clearance"][7]["corrected_mm"] == pytest.approx([0.075, 0.25229], abs=1e-5)
    assert content["figures_reproduced"] == {"met": 52, "printed": 61}
    assert content["fitted_to_the_paper_mm"] == pytest.approx({"weight": 0.034684, "tool": 0.00349})
    assert [item["judgement"] for item in content["verdicts"]][2] == "does not hold"
    assert content["reach"][3]["seam"]["first_unreachable_mm"] == pytest.approx([400, 300])


def test_json_holds_tables_that_the_paper_lacks(written):
    """Sag goes with density over modulus; at equal mass a round bar's also with its density (d^2 goes with 1/density).
    A bar of solid round section with the best diameters cannot be beaten by what the paper prints, nor beat a tube."""
    shapes, materials = json.loads((written / "t.json").read_text(encoding="utf-8"))["extended"]
    errors = {row["label"]: row["error_mm"] for row in shapes["rows"]}
    assert [row["error_mm"] for row in shapes["rows"]] == sorted(errors.values())
    assert errors["i_section"] < errors["tube"] < errors["circle"] < 0.178
    assert all(row["mass_kg"] <= 26.2952 for row in shapes["rows"])
    of = {row["label"]: row for row in materials["rows"]}
    aluminium, steel = of["aluminium-6061-t6"], of["steel-s355"]
    ratio = steel["equal_mass_mm"] / steel["equal_size_mm"]
    assert ratio == pytest.approx(7850 / 2700, rel=0.01)
    assert aluminium["diameter_mm"] == pytest.approx(100.0, rel=1e-6)


def test_extended_tables_stand_in_every_format(written):
    """CSV, Markdown and the page, as JSON has them."""
    shapes, materials = json.loads((written / "t.json").read_text(encoding="utf-8"))["extended"]
    for table in (shapes, materials):
        with (written / "csv" / f"{table['key']}.csv").open(encoding="utf-8", newline="") as file:
            assert [row["label"] for row in csv.DictReader(file)] == [row["label"] for row in table["rows"]]
        for name in ("t.md", "out/report.html"):
            assert table["title"] in (written / name).read_text(encoding="utf-8")
    circle = next(row for row in shapes["rows"] if row["label"] == "circle")
    assert circle["equal_size_mm"] == pytest.approx(circle["equal_mass_mm"], rel=1e-9)
    assert circle["equal_size_mm"] == pytest.approx(0.17729, abs=1e-5)
    assert circle["error_mm"] < circle["within_mm"] < circle["equal_size_mm"]


def test_rows_of_ones_own(tmp_path):
    """A tube by its sizes sags by q L^4 / (8 E I), whose mass and I follow its size; a stock size and a material of a
    file stand beside it."""
    (tmp_path / "mine.yaml").write_text(MINE, encoding="utf-8")
    tube = lw.shapes.Tube(diameter="80 mm", thickness="3 mm")
    made = lw.paper_tables(sections=[tube, "ipe80"], catalogue=tmp_path / "mine.yaml")
    shapes = made["shapes_at_their_best"].set_index("label")
    row = shapes.loc["tube: diameter 80, thickness 3 mm"]
    area, second = math.pi * (0.04**2 - 0.037**2), math.pi / 4 * (0.04**4 - 0.037**4)
    bent = 1e3 * 2700 * 9.81 * area * 1.24**4 / (8 * 71e9 * second)
    sheared = 1e3 * 2700 * 9.81 * 1.24**2 / (2 * 0.5 * 71e9 / 2.66)  # half of a thin tube's area shears, of any size
    assert row["equal_size_mm"] == pytest.approx(bent + sheared, rel=0.002)
    assert row["equal_size_kg"] == pytest.approx(2700 * 1.24 * area, rel=1e-6)
    assert row["equal_mass_mm"] == pytest.approx(bent * row["equal_size_kg"] / 26.2951 + sheared, rel=0.01)
    assert row["error_mm"] == shapes.loc["tube", "error_mm"]
    assert shapes.loc["IPE 80", "error_mm"] == shapes.loc["i_section", "error_mm"]
    mine = made["materials_compared"].set_index("label").loc["mine"]
    assert mine["equal_size_mm"] == pytest.approx(0.1764 * (4000 / 2700) / (142 / 71), rel=0.01)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (["--section", "tubbe"], "--section: there is no shape or stock size 'tubbe'; did you mean 'tube'?"),
        (["--section", "tubbe: diameter=3 mm"], "--section: there is no shape 'tubbe'; did you mean 'tube'?"),
        (["--section", "tube: diamter=80 mm"], "a tube has no dimension 'diamter'; did you mean 'diameter'?"),
        (["--section", "tube: diameter=80"], "needs a unit"),
        (["--material", "steel-s35"], "there is no material 'steel-s35'; did you mean 'steel-s355'?"),
    ],
)
def test_wrong_rows_are_refused_before_any_work(given, said, capsys):
    """In one line."""
    assert run(["tables", *given]) == 2
    captured = capsys.readouterr()
    assert (captured.out, len(captured.err.strip().splitlines())) == ("", 1)
    assert said in captured.err


def test_csv_has_a_line_per_row(written, book):
    """Printed figures as printed."""
    for key in TABLES:
        with (written / "csv" / f"{key}.csv").open(encoding="utf-8", newline="") as file:
            header, *rows = csv.reader(file)
        assert [row[0] for row in rows] == [row.label for row in book.table(key).rows]
        columns = [index for index, name in enumerate(header) if name.startswith("paper_")]
        assert [tuple(row[k] for k in columns) for row in rows] == [row.printed for row in book.table(key).rows]


def test_markdown_holds_every_printed_figure(written, book):
    """And marks those that are not met."""
    text = (written / "t.md").read_text(encoding="utf-8")
    for table in book.tables:
        assert f"Table {table.number}" in text
        for row in table.rows:
            assert all(figure in text for figure in row.printed)
    assert text.count("≠") == 9 + 1  # each of them, and the sentence that explains the sign


def test_markdown_replaces_only_what_is_between_the_marks():
    """The rest of a page stays."""
    page = f"before\n{BEGIN}\nold \\1 text\n{END}\nafter\n"
    assert into(page, "new \\g<0>\n") == f"before\n{BEGIN}\nnew \\g<0>\n{END}\nafter\n"
    assert into("a page without marks", "new\n") == "new\n"


def test_the_docs_page_holds_what_the_command_prints(book, extended):
    """`linkwright tables --markdown docs/paper.md` renews it."""
    page = DOCS.read_text(encoding="utf-8")
    assert into(page, markdown(describe(book, verdicts(book), proofs(book), extended), 2)) == page


def test_the_command_on_the_docs_page_leaves_it_as_it_is(tmp_path, monkeypatch):
    """As typed there."""
    (typed,) = re.findall(r"^linkwright (tables .*)$", DOCS.read_text(encoding="utf-8"), re.MULTILINE)
    (tmp_path / "docs").mkdir()
    renewed = tmp_path / "docs" / "paper.md"
    renewed.write_text(DOCS.read_text(encoding="utf-8").replace("52 of the 61", "some of the 61"), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    assert run(typed.split()) == 0
    assert renewed.read_bytes() == DOCS.read_bytes()


def test_tables_on_a_narrow_screen(written, capsys):  # noqa: ARG001 - only after the first run
    """Everything is there without a terminal, within 100 columns."""
    assert run(["tables"]) == 0
    out = capsys.readouterr().out
    for words in ("Table III", "Table VII", "≠ 0.0119", "52 of the 61", "does not hold", "(400, 300) mm"):
        assert words in out
    assert max(len(line) for line in out.splitlines()) <= 100


def test_figures_are_written_and_written_again(tmp_path, capsys):
    """A second run replaces its own files."""
    for _ in range(2):
        assert run(["figures", "--out", str(tmp_path / "f")]) == 0
    names = {path.name for path in (tmp_path / "f").iterdir()}
    assert names == {"report.html", "result.json", *(f"figure-{number}.csv" for number in "56789")}
    assert "Figure 9" in capsys.readouterr().out
    content = json.loads((tmp_path / "f" / "result.json").read_text(encoding="utf-8"))
    assert [item["number"] for item in content["figures"]] == list("56789")


def test_figures_are_drawn_for_print(tmp_path):
    """Each as SVG and as a PDF of one page, with its fonts inside."""
    assert run(["figures", "--format", "svg,pdf", "--out", str(tmp_path)]) == 0
    for number in "56789":
        assert "<svg " in (tmp_path / f"figure-{number}.svg").read_text(encoding="utf-8")
        printed = (tmp_path / f"figure-{number}.pdf").read_bytes()
        assert printed.startswith(b"%PDF")
        assert len(re.findall(rb"/Type\s*/Page\b", printed)) == 1
        assert b"/FontFile" in printed


@pytest.mark.parametrize(
    "arguments",
    [
        ("tables", "--json", "."),
        ("tables", "--json", "no/where.json"),
        ("tables", "--csv", "file"),
        ("tables", "--markdown", "same", "--json", "same"),
        ("tables", "--colour"),
        ("tables", "extra"),
        ("figures", "--out", "file"),
        ("figures", "--out", "file/below"),
        ("figures", "--json", "."),
        ("figures", "--out", "others"),
        ("figures", "--format", "svg"),
        ("figures", "--format", "png", "--out", "new"),
    ],
)
def test_wrong_use_is_one_line_and_status_2(arguments, tmp_path, monkeypatch, capsys):
    """Found before anything is computed, nothing written."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("kept", encoding="utf-8")
    (tmp_path / "others").mkdir()
    (tmp_path / "others" / "report.html").write_text("somebody's", encoding="utf-8")
    assert run(list(arguments)) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert len(captured.err.strip().splitlines()) == 1
    assert (tmp_path / "file").read_text(encoding="utf-8") == "kept"
    assert [path.name for path in (tmp_path / "others").iterdir()] == ["report.html"]


@pytest.mark.parametrize("command", ["tables", "figures"])
def test_help_shows_an_example(command, capsys):
    """A line that could be typed as it stands."""
    assert run([command, "--help"]) == 0
    assert f"Example: linkwright {command}" in " ".join(capsys.readouterr().out.split())
