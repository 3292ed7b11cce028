"""Text in tables that spreadsheets open: nothing in it is computed there, and all of it reads back."""

import csv
import io
import zipfile

import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.fuzz.kinds import RELATIONS, TYPES
from linkwright.core.catalogues.csv_table import read_rows, table_text
from linkwright.core.units.quantities import InputError
from linkwright.core.units.workbook import defused, fused, workbook_text

# From OWASP's page on the attack.
ATTACKS = [
    "=cmd|' /C calc'!A0",
    "+1+1",
    "-2+3+cmd|' /C calc'!A0",
    "@SUM(1+1)",
    "\t=1+1",
    '=HYPERLINK("http://x")',
    " =1",
]


@pytest.mark.parametrize("text", ATTACKS)
def test_what_would_be_computed_is_text(text):
    assert defused(text) == f"'{text}"
    assert fused(defused(text)) == text


@pytest.mark.parametrize(
    "cell", ["-40 degC", "-1.5e-3", "+3", "-2 um/(m*K)", "steel", "a=b", "", -2.5, None, "'quoted'"]
)
def test_figures_and_plain_text_stay(cell):
    assert defused(cell) is cell


@given(st.text(alphabet="'=+-@ \t1a|.", max_size=8))
def test_what_is_defused_reads_back(text):
    assert fused(defused(text)) == text


def test_tables_are_defused_on_writing_and_read_back(tmp_path):
    """As `materials export` and `import` do."""
    path = tmp_path / "table.csv"
    row = {"name": "=1+1", "source": "@SUM(A1)", "density": "2700 kg/m^3"}
    path.write_text(table_text(list(row), [row]))
    cells = next(csv.DictReader(io.StringIO(path.read_text())))
    assert cells == {"name": "'=1+1", "source": "'@SUM(A1)", "density": "2700 kg/m^3"}
    assert read_rows(path, list(row), ["name"], lambda found, _: found) == (row,)


def test_a_workbook_with_a_broken_part_is_refused_without_a_warning(tmp_path, recwarn):
    """The library grumbles of a sheet that its list does not give an address of; people get one line."""
    path = tmp_path / "r.xlsx"
    main = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
    with zipfile.ZipFile(path, "w") as made:
        made.writestr("[Content_Types].xml", TYPES)
        made.writestr(
            "xl/workbook.xml", f'<workbook xmlns="{main}"><sheets><sheet name="a" sheetId="1"/></sheets></workbook>'
        )
        made.writestr("xl/_rels/workbook.xml.rels", RELATIONS)
        made.writestr("xl/worksheets/sheet1.xml", f'<worksheet xmlns="{main}"><sheetData/></worksheet>')
    with pytest.raises(InputError) as caught:
        workbook_text(path)
    assert "\n" not in str(caught.value)
    assert list(recwarn) == []
