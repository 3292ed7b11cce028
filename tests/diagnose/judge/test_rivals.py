"""Which rival a file holds: the best on held-out parts, the smaller of equals, none worse than the arm as given."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linkwright.core.diagnose.judge.rivals import Rival, chosen
from linkwright.core.diagnose.rules.rules import RULES

PARTS, ROWS = 8, 50.0


def rival(name, parameters, *mean_squares, scatter=0.0, seed=0):
    """A rival whose branches leave these mean squares, parts scattering by a share."""
    random = np.random.default_rng(seed)
    losses = ROWS * np.array(mean_squares) * (1.0 + scatter * random.standard_normal((PARTS, len(mean_squares))))
    rms = float(np.sqrt(np.mean(mean_squares)))
    return Rival(name, parameters, rms, rms, losses, np.full(losses.shape, ROWS))


def test_the_best_on_held_out_parts_is_written():
    result = chosen([rival("nominal", 0, 4.0), rival("named", 3, 1.0), rival("textbook", 20, 0.5)], rules=RULES)
    assert result.written == "textbook"
    assert "predicts held-out readings best" in result.why
    assert result.of("named").parameters == 3


def test_of_rivals_within_a_standard_error_the_smaller_is_written():
    named, textbook = rival("named", 3, 1.0, scatter=0.3), rival("textbook", 20, 0.97, scatter=0.3, seed=1)
    assert chosen([rival("nominal", 0, 4.0), named, textbook], rules=RULES).written == "named"
    sure = replace(textbook, losses=0.97 * named.losses)  # smaller by as much everywhere: no chance
    assert chosen([rival("nominal", 0, 4.0), named, sure], rules=RULES).written == "textbook"


def test_what_is_worse_than_given_in_one_branch_is_not_written():
    table = [rival("nominal", 0, 4.0, 0.1), rival("named", 3, 1.0, 0.1), rival("textbook", 20, 0.1, 0.5)]
    result = chosen(table, rules=RULES)
    assert result.written == "named"
    assert "worse than it was given" in result.why


def test_a_branch_that_is_a_little_worse_than_given_does_not_stand_in_the_way():
    little = [rival("nominal", 0, 4.0, 1.0), rival("named", 3, 3.9, 1.0), rival("ridge", 9, 1.0, 1.04**2)]
    much = [*little[:2], rival("ridge", 9, 1.0, 1.06**2)]
    assert chosen(little, rules=RULES).written == "ridge"
    assert chosen(much, rules=RULES).written == "named"


def test_branches_count_alike_whatever_their_size():
    """A small joint's loss is not drowned by a large one's scatter."""
    table = [rival("nominal", 0, 100.0, 0.04), rival("named", 3, 50.0, 0.01), rival("textbook", 20, 49.9, 0.0001)]
    assert chosen(table, rules=RULES).written == "textbook"


def test_nothing_is_written_where_all_rivals_are_worse():
    result = chosen([rival("nominal", 0, 1.0), rival("named", 3, 1.2), rival("textbook", 20, 2.0)], rules=RULES)
    assert result.written == "nominal"


def test_rivals_of_other_parts_are_refused():
    with pytest.raises(ValueError, match="arm as given"):
        chosen([rival("named", 3, 1.0)], rules=RULES)
    with pytest.raises(ValueError, match="different parts"):
        chosen([rival("nominal", 0, 1.0), rival("named", 3, 1.0, 1.0)], rules=RULES)


@given(
    st.lists(st.floats(0.01, 100.0), min_size=6, max_size=6),
    st.lists(st.floats(1e-6, 1e6), min_size=2, max_size=2),
    st.integers(0, 5),
)
def test_units_and_the_order_of_parts_do_not_matter(sizes, units, seed):
    table = [
        rival(name, number, *sizes[2 * k : 2 * k + 2], scatter=0.2, seed=seed + k)
        for k, (name, number) in enumerate((("nominal", 0), ("named", 3), ("textbook", 20)))
    ]
    order = np.random.default_rng(seed).permutation(PARTS)
    other = [replace(item, losses=(item.losses * units)[order], rows=item.rows[order]) for item in table]
    assert chosen(table, rules=RULES).written == chosen(other, rules=RULES).written


@given(st.lists(st.floats(0.01, 100.0), min_size=3, max_size=3), st.integers(0, 20))
def test_what_is_written_leaves_no_more_than_the_arm_as_given(sizes, seed):
    table = [
        rival(name, number, sizes[number], scatter=0.5, seed=seed + number)
        for number, name in enumerate(("nominal", "named", "textbook"))
    ]
    result = chosen(table, rules=RULES)
    assert result.of(result.written).losses.sum() <= table[0].losses.sum()
