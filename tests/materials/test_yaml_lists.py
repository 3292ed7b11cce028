"""Entries of lists in a YAML text: put, changed and taken away, with every other character left alone."""

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from linkwright.core.catalogues.yaml_edit import YamlText
from linkwright.core.units.quantities import InputError

TEXT = """\
# head
tables:   # two of them
  - family: A   # first
    rows:
      # before the first row
      - [a, 1.0, 2]   # a's note
      - [b,   3,   4]

      # before c
      - [c, 5, 6]
  - {family: B, rows: [[d, 7, 8], [e, 9, 10]]}
end: true
"""


def lines_gone_and_new(before: str, after: str) -> tuple[list[str], list[str]]:
    old, new = before.splitlines(), after.splitlines()
    return [line for line in old if line not in new], [line for line in new if line not in old]


def test_one_cell_changes_and_no_other_row():
    document = YamlText(TEXT, file="t")
    document.set(["tables", 1, "rows", 0, 0], "d 2")
    assert document.text == TEXT.replace("[d, 7", "[d 2, 7")
    document.set(["tables", 0, "rows", 1, 2], 40.5)
    assert document.text == TEXT.replace("[b,   3,   4]", "[b, 3, 40.5]").replace("[d, 7", "[d 2, 7")


def test_entries_come_at_the_end_in_the_list_s_own_style():
    document = YamlText(TEXT, file="t")
    document.append(["tables", 0, "rows"], ["x", 1, 2], ["y", 3, 4])
    document.append(["tables", 1, "rows"], ["z", 5, 6])
    gone, new = lines_gone_and_new(TEXT, document.text)
    assert gone == ["  - {family: B, rows: [[d, 7, 8], [e, 9, 10]]}"]
    assert new == [
        "      - [x, 1, 2]",
        "      - [y, 3, 4]",
        "  - {family: B, rows: [[d, 7, 8], [e, 9, 10], [z, 5, 6]]}",
    ]
    document.append(["tables"], {"family": "C", "rows": [["q", 1, 2]]})
    assert "  - family: C\n    rows:\n      - [q, 1, 2]\nend: true" in document.text


@pytest.mark.parametrize("text", ["tables: []\n", "tables: []", "tables: [] # none yet\n", "tables:\n  []\n"])
def test_an_empty_list_opens_into_lines(text):
    document = YamlText(text, file="t")
    document.append(["tables"], {"a": 1, "rows": [[1, 2]]}, {"a": 2})
    assert yaml.safe_load(document.text) == {"tables": [{"a": 1, "rows": [[1, 2]]}, {"a": 2}]}
    assert ("# none yet" in text) == ("# none yet" in document.text)


def test_an_entry_goes_and_its_neighbours_stay():
    document = YamlText(TEXT, file="t")
    document.remove(["tables", 0, "rows", 1])
    assert document.text == TEXT.replace("      - [b,   3,   4]\n", "")
    document.remove(["tables", 1, "rows", 1])
    document.remove(["tables", 1, "rows", 0])
    assert document.get(["tables", 1, "rows"]) == []
    document.remove(["tables", 1])
    assert document.text == TEXT.replace("      - [b,   3,   4]\n", "").replace(TEXT.splitlines()[-2] + "\n", "")
    document.remove(["tables", 0])
    assert yaml.safe_load(document.text) == {"tables": [], "end": True}


def test_what_is_not_there_is_one_line():
    document = YamlText(TEXT, file="t.yaml")
    for change in (
        lambda: document.set(["tables", 0, "rows", 9], 1),
        lambda: document.remove(["tables", 0, "rows", 9]),
        lambda: document.append(["end"], 1),
        lambda: document.set(["tables", "x"], 1),
    ):
        with pytest.raises(InputError) as caught:
            change()
        assert str(caught.value).startswith("t.yaml: ")
    assert document.text == TEXT


@given(st.lists(st.tuples(st.sampled_from(["append", "remove", "set"]), st.integers(0, 5)), max_size=8))
def test_any_edits_leave_what_yaml_says_of_them(steps):
    document, kept = YamlText(TEXT, file="t"), yaml.safe_load(TEXT)
    rows = kept["tables"][0]["rows"]
    for number, (step, index) in enumerate(steps):
        if step == "append":
            document.append(["tables", 0, "rows"], [f"n{number}", number])
            rows.append([f"n{number}", number])
        elif index < len(rows) and step == "remove":
            document.remove(["tables", 0, "rows", index])
            del rows[index]
        elif index < len(rows):
            document.set(["tables", 0, "rows", index], [number])
            rows[index] = [number]
    assert yaml.safe_load(document.text) == kept
    assert document.text.startswith("# head\ntables:   # two of them\n  - family: A   # first\n")
