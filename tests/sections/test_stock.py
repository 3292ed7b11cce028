"""Standard sizes: names, layers, and the check of every row."""

from __future__ import annotations

import warnings
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from linkwright.core.catalogues.stock_csv import read_table, write_table
from linkwright.core.catalogues.stock_editor import STOCK, row_of
from linkwright.core.sections import load_stock
from linkwright.core.sections.stock.tables import last_unit, plain_name, read_text, shipped_sizes
from linkwright.core.units.quantities import InputError

TABLE = """
format_version: 1
tables:
  - family: CHS
    shape: tube
    source: "EN 10210-2:2006"
    columns: [name, diameter_mm, thickness_mm, area_cm2, second_moment_y_cm4]
    rows:
      - [CHS 60.3x3.2, 60.3, 3.2, 5.74, 23.5]
"""


def shipped() -> list[tuple[str, dict]]:
    folder = files("linkwright.core.sections").joinpath("stock")
    return [
        (item.name, yaml.safe_load(item.read_text(encoding="utf-8")))
        for item in folder.iterdir()
        if item.name.endswith(".yaml")
    ]


def test_there_are_many_and_each_says_its_source() -> None:
    stock = load_stock(user=False)
    assert len(stock) >= 1100
    assert all(size.source.startswith(("EN ", "Aluminum Association", "Misumi")) for size in stock)
    assert {"IPE", "HEA", "HEB", "CHS", "SHS", "RHS", "HFSHS", "HFRHS", "ALU TUBE", "ALU BAR"} <= set(stock.families)
    assert sum(bool(size.printed) for size in stock) >= 900


def test_each_says_where_it_was_found_or_that_it_was_not() -> None:
    stock = load_stock(user=False)
    assert all(bool(size.found_in) != bool(size.unconfirmed) for size in stock)
    assert {size.family for size in stock if size.unconfirmed} == {"ALU BAR", "ALU FLAT", "ALU TUBE", "HFS"}


def test_the_fast_reading_of_the_shipped_tables_finds_what_the_careful_one_does() -> None:
    folder = files("linkwright.core.sections").joinpath("stock")
    names = sorted(item.name for item in folder.iterdir() if item.name.endswith(".yaml"))
    careful = [read_text(folder.joinpath(name).read_text(encoding="utf-8"), f"stock/{name}") for name in names]
    assert [size for sizes in careful for size in sizes] == list(shipped_sizes())


@pytest.mark.parametrize(
    ("name", "radii", "area", "second_moment"),
    [  # EN 10219-2 and EN 10210-2, tables B.2 and B.3: the same tube, its corners cold formed and hot finished
        ("SHS 100x100x5", (10.0, None), 18.4, 271),
        ("HFSHS 100x100x5", (7.5, 5.0), 18.7, 279),
        ("SHS 100x8", (20.0, None), 27.2, 366),
        ("HFSHS 100x8", (12.0, 8.0), 28.8, 400),
        ("RHS 120x80x6", (12.0, None), 21.6, 406),
        ("HFRHS 120x80x6.3", (9.45, 6.3), 23.2, 440),
    ],
)
def test_corners_are_those_of_their_standard(
    name: str, radii: tuple[float, float | None], area: float, second_moment: float
) -> None:
    size = load_stock(user=False).find(name)
    inner = size.dimensions.get("inner_corner_radius")
    assert (1e3 * size.dimensions["corner_radius"], inner and 1e3 * inner) == pytest.approx(radii)
    assert size.printed["area_cm2"] == area
    assert size.printed["second_moment_y_cm4"] == second_moment


@pytest.mark.parametrize(
    ("given", "found"),
    [
        ("    unconfirmed: nobody has it\n", "nobody has it"),
        ("    unconfirmed: {CHS 60.3x3.2: in no list}\n", "in no list"),
        ("    found_in: a list\n", ""),
    ],
)
def test_what_nobody_could_find_is_marked(given: str, found: str) -> None:
    (size,) = read_text(TABLE.replace("    columns", given + "    columns"), "own.yaml")
    assert size.unconfirmed == found
    assert size.found_in == ("a list" if "found_in" in given else "")


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ("    unconfirmed: {CHS 1: in no list}\n", "'CHS 1' is not in the table"),
        ("    unconfirmed: [1]\n", "unconfirmed is text"),
        ("    found_in: 3\n", "found_in is text"),
        ("    note: x\n", "and nothing else"),
    ],
)
def test_a_wrong_mark_is_refused(given: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        read_text(TABLE.replace("    columns", given + "    columns"), "own.yaml")


@pytest.mark.parametrize(
    ("given", "found"),
    [
        ("IPE 80", "IPE 80"),
        ("ipe80", "IPE 80"),
        (" Ipe  80 ", "IPE 80"),
        ("CHS 60.3 x 3.2", "CHS 60.3x3.2"),
        ("chs 60,3×3,20", "CHS 60.3x3.2"),
        ("SHS 50x3", "SHS 50x3"),
        ("SHS 50x50x3.0", "SHS 50x3"),
        ("rhs100x50x4", "RHS 100x50x4"),
        ("HE 200 B", "HEB 200"),
        ("aluminium tube 50x3", "ALU TUBE 50x3"),
    ],
)
def test_names_are_read_whatever_their_case_and_spaces(given: str, found: str) -> None:
    assert load_stock(user=False).find(given).name == found


@pytest.mark.parametrize(
    ("name", "hint"), [("IPE 85", "IPE 80"), ("CHS 60.3x3.3", "CHS 60.3x3"), ("nonsense", "IPE, RHS")]
)
def test_an_unknown_name_is_answered_with_the_nearest(name: str, hint: str) -> None:
    with pytest.raises(InputError, match=hint) as caught:
        load_stock().find(name)
    assert "\n" not in str(caught.value)


def test_names_of_shipped_sizes_stay_apart() -> None:
    names = [row[0] for _, content in shipped() for table in content["tables"] for row in table["rows"]]
    assert len({plain_name(name) for name in names}) == len(names) == len(load_stock(user=False))


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (("5.74", "5.47"), "area_cm2 is 5.47, its dimensions give 5.74"),
        (("23.5", "23.7"), "second_moment_y_cm4 is 23.7"),
        (("60.3, 3.2", "60.3, 3.6"), "CHS 60.3x3.2: area_cm2"),
        (("shape: tube", "shape: tub"), "did you mean 'tube'"),
        (("diameter_mm", "diametre_mm"), "did you mean 'diameter_mm'"),
        (("60.3, 3.2", "60.3, 60"), "CHS 60.3x3.2: thickness: two walls"),
        (("60.3, 3.2", "60.3, -3.2"), "thickness_mm must be a positive number"),
        (("60.3, 3.2", "60.3, 3.2 mm"), "thickness_mm must be a positive number"),
        (("format_version: 1", "format_version: 2"), "format_version 2"),
        (("5.74, 23.5]", "5.74]"), "5 entries"),
        (("tables:", "tables: ["), "is not YAML"),
    ],
)
def test_a_wrong_row_is_refused_with_one_line(wrong: tuple[str, str], words: str) -> None:
    assert len(read_text(TABLE, "own.yaml")) == 1
    with pytest.raises(InputError) as caught:
        read_text(TABLE.replace(*wrong), "own.yaml")
    assert words in str(caught.value)
    assert "own.yaml" in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("flange", ["1e-3", "1e-30", "1e-200"])
def test_sizes_that_no_formula_stands_are_refused_with_one_line(flange: str) -> None:
    """A flange thinner than an atom takes the fits of fillets and of shear beyond all floats."""
    shape = TABLE.replace("shape: tube", "shape: i_section").replace("family: CHS", "family: HEA")
    columns = "[name, height_mm, width_mm, web_thickness_mm, flange_thickness_mm, root_radius_mm, area_cm2]"
    head = shape.split("    columns:")[0]
    row = f"      - [HEA 300, 290, 300, 8.5, {flange}, 27, 112.5]\n"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(InputError, match="HEA 300: area_cm2 is"):
            read_text(f"{head}    columns: {columns}\n    rows:\n{row}", "own.yaml")


@pytest.mark.parametrize(
    ("shape", "columns", "row", "words"),
    [
        (
            "rectangular_tube",
            "height_mm, width_mm, thickness_mm, corner_radius_mm, area_cm2",
            "10, 30, 5, 10, 6.36",
            "two flange thicknesses must stay below",
        ),
        (
            "i_section",
            "height_mm, width_mm, flange_thickness_mm, web_thickness_mm, root_radius_mm, area_cm2",
            "10.4, 46, 5.2, 3.8, 5, 7.64",
            "both flange thicknesses must stay below",
        ),
        (
            "i_section",
            "height_mm, width_mm, flange_thickness_mm, web_thickness_mm, root_radius_mm, area_cm2",
            "80, 3.8, 5.2, 3.8, 5, 7.64",
            "the web thickness must stay below",
        ),
    ],
)
def test_rounded_corners_without_room_are_refused_with_one_line(shape: str, columns: str, row: str, words: str) -> None:
    """Where walls meet in the middle there is nothing that a radius could be held against."""
    table = f'format_version: 1\ntables:\n  - family: X\n    shape: {shape}\n    source: "EN 10219-2:2006"\n'
    table += f"    columns: [name, {columns}]\n    rows:\n      - [X 1, {row}]\n"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(InputError, match=words) as caught:
            read_text(table, "own.yaml")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(("name", "content"), shipped(), ids=lambda value: value if isinstance(value, str) else "")
def test_columns_that_slipped_by_a_row_are_noticed(name: str, content: dict) -> None:
    for table in content["tables"]:
        for column in ("area_cm2", "second_moment_y_cm4"):
            if column not in table["columns"]:
                continue
            at = table["columns"].index(column)
            slipped = [row[at] for row in table["rows"]]
            slipped = slipped[1:] + slipped[:1]
            pairs = zip(table["rows"], slipped, strict=True)
            rows = [[*row[:at], other, *row[at + 1 :]] for row, other in pairs]
            text = yaml.safe_dump({"format_version": 1, "tables": [{**table, "rows": rows}]})
            with pytest.raises(InputError, match=column):
                read_text(text, name)


@given(st.floats(0.01, 1e6), st.integers(3, 5))
def test_what_is_rounded_to_some_digits_is_within_a_unit_of_them(value: float, digits: int) -> None:
    printed = float(f"{value:.{digits}g}")
    assert abs(printed - value) <= 0.5001 * last_unit(printed)
    assert last_unit(printed) <= 0.0101 * printed


def test_digits_of_printed_figures() -> None:
    assert last_unit(7.64) == pytest.approx(0.01)
    assert last_unit(27.0) == pytest.approx(0.1)
    assert last_unit(0.7) == pytest.approx(0.001)
    assert last_unit(450) == pytest.approx(1.0)
    assert last_unit(10450) == pytest.approx(10.0)


def test_own_tables_lie_over_the_shipped_ones(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    own = tmp_path / "own.yaml"
    own.write_text(TABLE.replace("CHS 60.3x3.2, 60.3, 3.2, 5.74, 23.5", "ipe 80, 60.3, 3.2, 5.74, 23.5"))
    monkeypatch.setenv("LINKWRIGHT_SECTIONS", str(own))
    assert load_stock().find("IPE 80").shape == "tube"
    assert load_stock(user=False).find("IPE 80").shape == "i_section"
    assert len(load_stock()) == len(load_stock(user=False))
    monkeypatch.setenv("LINKWRIGHT_SECTIONS", str(tmp_path / "none.yaml"))
    with pytest.raises(InputError, match=r"none\.yaml"):
        load_stock()
    assert load_stock([own], user=False).find("ipe80").file == str(own)


def test_sizes_cannot_be_changed() -> None:
    size = load_stock(user=False).find("IPE 80")
    with pytest.raises(TypeError):
        size.dimensions["height"] = 1.0  # type: ignore[index]


def test_marks_go_with_a_size_that_is_copied_exported_renamed_or_removed(tmp_path: Path) -> None:
    """Each in its own words; a new source takes them away."""
    own, tube = tmp_path / "own.yaml", "CHS 60.3x3.2"
    shipped = {plain_name(size.name): size for size in shipped_sizes()}
    bar = next(size.name for size in shipped.values() if size.unconfirmed)
    other = next(size.name for size in shipped.values() if size.unconfirmed and size.name != bar)
    rows = [row_of(shipped[plain_name(name)]) for name in (bar, other, tube)]
    assert [row.name for row in rows if row.found_in] == [tube]
    STOCK.add(own, rows)
    (tmp_path / "sizes.csv").write_text(write_table(rows), encoding="utf-8")
    for read in ([row_of(size) for size in load_stock([own], user=False) if size.file == str(own)], list(rows)):
        assert {row.name: (row.found_in, row.unconfirmed) for row in read} == {
            row.name: (row.found_in, row.unconfirmed) for row in rows
        }
    assert [(row.found_in, row.unconfirmed) for row in read_table(tmp_path / "sizes.csv")] == [
        (row.found_in, row.unconfirmed) for row in rows
    ]
    STOCK.change_cells(own, other, {}, source="measured")
    kept = {size.name: size.unconfirmed for size in load_stock([own], user=False) if size.file == str(own)}
    assert (bool(kept[bar]), kept[other]) == (True, "")


def test_a_mark_by_name_goes_with_its_size(tmp_path: Path) -> None:
    own = tmp_path / "own.yaml"
    marked = TABLE.replace("    columns", "    unconfirmed: {CHS 60.3x3.2: in no list}\n    columns")
    own.write_text(marked, encoding="utf-8")
    assert [(size.name, size.unconfirmed) for size in STOCK.check(own.read_text(encoding="utf-8"), own)] == [
        ("CHS 60.3x3.2", "in no list")
    ]
    STOCK.add(own, [replace(row_of(load_stock([own], user=False).find("CHS 60.3x3.2")), name="MINE 2", unconfirmed="")])
    STOCK.remove(own, "CHS 60.3x3.2")
    assert [size.unconfirmed for size in STOCK.check(own.read_text(encoding="utf-8"), own)] == [""]
