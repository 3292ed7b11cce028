"""Excel workbooks: what a sheet holds is what the same table as text holds; hostile ones are one line."""

import datetime
import io
import zipfile
from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from openpyxl import Workbook

from linkwright.core.arm.files.read import read_arm
from linkwright.core.catalogues.csv_table import read_cells
from linkwright.core.catalogues.materials import MATERIALS
from linkwright.core.diagnose.reading.read import read_recording
from linkwright.core.units.quantities import InputError
from linkwright.core.units.workbook import workbook_text

EXAMPLE = Path(__file__).parents[1] / "examples/hidden-backlash"


def saved(path: Path, *rows: list[object], sheets: tuple[str, ...] = ("Sheet",)) -> Path:
    book = Workbook()
    book.active.title = sheets[0]
    for name in sheets[1:]:
        book.create_sheet(name)
    for name in sheets:
        for row in rows:
            book[name].append(row)
    book.save(path)
    return path


def test_a_recording_in_a_workbook_is_the_one_in_text(tmp_path: Path):
    lines = (EXAMPLE / "recording.csv").read_text(encoding="utf-8").splitlines()
    rows = [line.split(",") for line in lines]
    path = saved(tmp_path / "recording.xlsx", rows[0], *([float(cell) for cell in row] for row in rows[1:]))
    settings = EXAMPLE / "recording.yaml"
    arm = read_arm(EXAMPLE / "arm.yaml")
    text, book = (read_recording(item, arm, settings) for item in (EXAMPLE / "recording.csv", path))
    assert (book.q == text.q).all()
    assert (book.tip == text.tip).all()
    assert book.rejected == text.rejected


def test_cells_as_text(tmp_path: Path):
    row = [1 / 3, -7, True, None, datetime.datetime(2026, 5, 16, 8, 30), " a,\n b "]
    path = saved(tmp_path / "a.xlsx", ["a", "b", "c", "d", "e", "f"], [], row)
    expected = f'a,b,c,d,e,f\n\n{1 / 3!r},-7,1,,2026-05-16T08:30:00,"a, b"\n'
    assert workbook_text(path) == expected
    assert workbook_text(path, decimal=",").splitlines()[2].startswith('"0,333')


def test_a_blank_row_keeps_its_line(tmp_path: Path):
    """So that lines are those of the sheet; a list may begin below one."""
    path = saved(tmp_path / "a.xlsx", [], ["a", "b"], [], [1, 2], [])
    assert workbook_text(path) == "\na,b\n\n1,2\n"
    assert read_cells(path).headings == ("a", "b")


def test_which_sheet(tmp_path: Path):
    path = saved(tmp_path / "a.xlsx", ["a", 1], sheets=("May", "June"))
    assert workbook_text(path, "June") == "a,1\n"
    with pytest.raises(InputError, match=r"has 2 sheets \('May', 'June'\); write `sheet: May` or `sheet: June` in"):
        workbook_text(path)
    with pytest.raises(InputError, match=r"there is no sheet .*Jun.*June"):
        workbook_text(path, "Jun")


def test_the_sheet_with_numbers_counts_beside_one_of_words(tmp_path: Path):
    """A cover sheet needs no setting; commas in text make all numbers of the sheet be written with commas."""
    book = Workbook()
    book.active.title = "Cover"
    book.active.append(["Robot 12", "measured by us"])
    book.create_sheet("Data").append(["a", "b"])
    book["Data"].append(["1,25", 2.5])
    book.save(tmp_path / "a.xlsx")
    assert workbook_text(tmp_path / "a.xlsx") == 'a,b\n"1,25","2,5"\n'


def test_a_catalogue_of_several_sheets_asks_for_no_setting(tmp_path: Path):
    path = saved(tmp_path / "m.xlsx", ["name"], ["our-alloy"], sheets=("May", "June"))
    with pytest.raises(InputError, match=r"has 2 sheets \('May', 'June'\); leave only the one to be read$"):
        MATERIALS.read_table(path)


def test_materials_from_a_workbook(tmp_path: Path):
    path = saved(tmp_path / "m.xlsx", ["name", "title", "density"], ["our-alloy", "Ours", "2800 kg/m^3"])
    (entry,) = MATERIALS.read_table(path)
    assert (entry.name, entry.content["density"]) == ("our-alloy", "2800 kg/m^3")


def packed(path: Path, members: dict[str, bytes]) -> Path:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    path.write_bytes(stream.getvalue())
    return path


def spoilt(path: Path, *changes: tuple[bytes, bytes]) -> Path:
    """A sound workbook with something replaced in its sheet."""
    member = "xl/worksheets/sheet1.xml"
    with zipfile.ZipFile(saved(path, ["q1_deg"], [1.0])) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    for change in changes:
        assert change[0] in members[member]
        members[member] = members[member].replace(*change)
    return packed(path, members)


def test_hostile_workbooks_are_one_line(tmp_path: Path):
    text = tmp_path / "text.xlsx"
    text.write_text("q1_deg,x_mm\n1,2\n", encoding="utf-8")
    bomb = packed(tmp_path / "bomb.xlsx", {"xl/workbook.xml": bytes(600 * 1024 * 1024)})
    with pytest.raises(InputError, match="unpacks to more than 512 MB"):
        workbook_text(bomb)
    laughs = (
        b"<worksheet",
        b'<!DOCTYPE l [<!ENTITY a "'
        + b"ha" * 50
        + b'">'
        + b"".join(b'<!ENTITY %c "%s">' % (98 + k, (b"&%c;" % (97 + k)) * 50) for k in range(8))
        + b"]><worksheet",
    )
    for number, path in enumerate(
        [
            text,
            packed(tmp_path / "empty.xlsx", {"a.txt": b""}),
            packed(tmp_path / "part.xlsx", {"[Content_Types].xml": b"<x/>", "xl/workbook.xml": b"<x"}),
            spoilt(tmp_path / "cell.xlsx", (b'r="A1"', b'r="!!"')),
            spoilt(tmp_path / "shared.xlsx", (b't="n"', b't="s"')),
            spoilt(tmp_path / "cut.xlsx", (b"</sheetData>", b"")),
            spoilt(tmp_path / "laughs.xlsx", laughs, (b"q1_deg", b"&i;")),
            spoilt(tmp_path / "number.xlsx", (b"<v>1</v>", b"<v>1e</v>")),
            saved(tmp_path / "blank.xlsx"),
        ]
    ):
        with pytest.raises(InputError, match=r"Excel workbook|no filled cell") as error:
            print(number, workbook_text(path))
        assert "\n" not in str(error.value), number
    far = spoilt(tmp_path / "far.xlsx", (b'r="A2"', b'r="XFD1048576"'))
    assert workbook_text(far).startswith("q1_deg,")


@given(st.lists(st.tuples(st.floats(0.0, 0.999), st.integers(0, 255)), min_size=1, max_size=6))
def test_a_damaged_archive_is_read_or_refused(
    tmp_path_factory: pytest.TempPathFactory, damage: list[tuple[float, int]]
):
    """Wherever its bytes are exchanged: in what is packed (a deflate stream), in the directory, in a head."""
    path = saved(tmp_path_factory.mktemp("book") / "a.xlsx", ["q1_deg", "x_mm"], *([k, f"text {k}"] for k in range(40)))
    content = bytearray(path.read_bytes())
    for place, byte in damage:
        content[int(place * len(content))] = byte
    path.write_bytes(content)
    with suppress(InputError):
        workbook_text(path)


def test_a_damaged_deflate_stream_is_one_line(tmp_path: Path):
    """What zlib says of it is no traceback."""
    path = saved(tmp_path / "a.xlsx", *([k, f"text {k}"] for k in range(400)))
    content = bytearray(path.read_bytes())
    with zipfile.ZipFile(path) as book:
        sheet = next(item for item in book.infolist() if item.filename.endswith("sheet1.xml"))
    begins = sheet.header_offset + 30 + len(sheet.filename)
    content[begins : begins + 40] = bytes([255] * 40)
    path.write_bytes(content)
    with pytest.raises(InputError, match="is no Excel workbook that can be read"):
        workbook_text(path)
