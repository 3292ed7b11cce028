"""Tables and sentences at any width: every word stands there whole."""

import io

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rich.console import Console

from linkwright.screen.console import console, table

NAMES = st.lists(st.from_regex(r"[a-z0-9/^.-]{1,14}", fullmatch=True), max_size=4).map(" ".join)


def shown(made, width):
    out = io.StringIO()
    Console(file=out, width=width, markup=False, emoji=False, highlight=False).print(made)
    return out.getvalue()


@settings(max_examples=40)
@given(
    rows=st.lists(st.tuples(NAMES, NAMES, NAMES, NAMES), min_size=1, max_size=5),
    width=st.integers(24, 110),
    headings=st.tuples(NAMES, NAMES, NAMES, NAMES),
)
def test_no_word_is_broken_and_none_is_lost(rows, width, headings):
    made = table(*headings, numbers=(1, 3))
    for row in rows:
        made.add_row(*row)
    drawn = shown(made, width)
    assert max(map(len, drawn.splitlines())) <= width
    words = drawn.replace("─", " ").replace(":", " ").split()
    for word in " ".join(" ".join(row) for row in rows).split():
        assert word in words


def test_a_figure_keeps_its_unit_while_words_can_be_wrapped():
    """And where two columns of words are too narrow for that, the unit goes below before a word is broken."""
    made = table("what", "size", numbers=(1,))
    made.add_row("the strain of links along their axes", "0.00001976 mm")
    lines = shown(made, 30).splitlines()
    assert any(line.rstrip().endswith("0.00001976 mm") for line in lines)
    assert "what" in lines[0]
    assert "0.00001976 mm" not in shown(made, 18)
    assert "0.00001976" in shown(made, 18)


def test_rows_too_wide_stand_one_below_the_other():
    made = table("material", "density", "", numbers=(1,), title="Materials")
    made.add_row("cfrp-high-modulus-unidirectional", "1600 kg/m^3", "█████")
    made.add_row("2", "", "")
    told = [line.rstrip() for line in shown(made, 36).splitlines()]
    assert told == ["Materials", "cfrp-high-modulus-unidirectional", "  density: 1600 kg/m^3", "  █████", "material 2"]


SENTENCE = "  certified: no pose is worse than 0.193931 mm to first order; see /a/name/without/any/blank/that/is/long"


def said(capsys, text):
    console().print(text, soft_wrap=True)
    return capsys.readouterr().out.splitlines()


def test_sentences_are_broken_at_words_where_a_width_is_asked_for(monkeypatch, capsys):
    """And what follows stands as far in; a name too long for any line stays whole."""
    monkeypatch.setenv("COLUMNS", "30")
    lines = said(capsys, SENTENCE)
    assert len(lines) > 3
    assert [line for line in lines if len(line) > 30] == ["  /a/name/without/any/blank/that/is/long"]
    assert all(line[:2] == "  " and line[2] != " " for line in lines)
    assert " ".join(lines).split() == SENTENCE.split()
    assert said(capsys, "short\nlines") == ["short", "lines"]
    made = table("what", "size", numbers=(1,))
    made.add_row("the strain of links along their axes", "0.00001976 mm")
    console().print(made)
    assert max(map(len, capsys.readouterr().out.splitlines())) <= 30


@pytest.mark.parametrize("columns", [None, "", "0", "-3", "wide", "²", "9" * 50])
def test_elsewhere_a_sentence_is_one_line_that_can_be_searched_for(monkeypatch, capsys, columns):
    if columns is not None:
        monkeypatch.setenv("COLUMNS", columns)
    assert said(capsys, 5 * SENTENCE) == [5 * SENTENCE]


def test_a_terminal_has_its_own_width(monkeypatch, capsys):
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    monkeypatch.setattr("os.get_terminal_size", lambda *_: (44, 20))
    assert max(len(line) for line in said(capsys, SENTENCE.partition("; see")[0])) <= 44
