"""Tables at any width: every word of every cell stands there whole."""

import io

from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console

from linkwright.screen.console import table

NAMES = st.lists(st.from_regex(r"[a-z0-9/^.-]{1,14}", fullmatch=True), max_size=4).map(" ".join)


def shown(made, width):
    out = io.StringIO()
    Console(file=out, width=width, markup=False, emoji=False, highlight=False).print(made)
    return out.getvalue()


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
