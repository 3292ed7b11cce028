"""Formulas on columns: against Python's own arithmetic, and refused where they are anything else."""

from __future__ import annotations

import contextlib
import math

import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from linkwright.core.diagnose.reading.formula import read_condition, read_formula
from linkwright.core.units.quantities import InputError

NAMES = ("Joint 1 [rad]", "Joint 1", "pos (2)", "x", "x_mm", "a-b", "1e3", "Δq", "temp (°C)")
VALUES = {name: 0.7 + 0.31 * k for k, name in enumerate(NAMES)}


def value(text: str) -> float:
    formula = read_formula(text, NAMES, file="f", key="k")
    return float(formula.value(lambda name: np.array([VALUES[name]]), 1)[0])


@st.composite
def arithmetic(draw: st.DrawFn, depth: int = 4) -> tuple[str, str]:
    """A formula as written, and the same for Python: columns there are numbers."""
    kinds = ["number", "column", "minus", "plus", "group", *["operation"] * 4] if depth else ["number"]
    kind = draw(st.sampled_from(kinds))
    if kind == "number":
        number = draw(st.sampled_from(["2", "0.5", "3.", ".25", "1e-1", "12.75", "1E2"]))
        return number, f"float({number!r})"
    if kind == "column":
        name = draw(st.sampled_from(NAMES))
        quoted = name == "1e3" or draw(st.booleans())
        return (f"`{name}`" if quoted else name), repr(VALUES[name])
    if kind in ("minus", "plus"):
        ours, theirs = draw(arithmetic(depth=depth - 1))
        sign = "-" if kind == "minus" else "+"
        return f"{sign} {ours}", f"{sign} {theirs}"
    if kind == "group":
        ours, theirs = draw(arithmetic(depth=depth - 1))
        return f"( {ours} )", f"( {theirs} )"
    left, right = draw(arithmetic(depth=depth - 1)), draw(arithmetic(depth=depth - 1))
    operator = draw(st.sampled_from(["+", "-", "*", "/", "**"]))
    gap = draw(st.sampled_from(["", " "])) if not left[0][-1].isalnum() and left[0][-1] not in ".)" else " "
    return f"{left[0]}{gap}{operator} {right[0]}", f"{left[1]} {operator} {right[1]}"


@given(arithmetic())
@example(("- 2 ** 2", "- 2.0 ** 2.0"))
@example(("2 ** - 1 ** 2", "2.0 ** - 1.0 ** 2.0"))
@example(("2 ** 3 ** 2", "2.0 ** 3.0 ** 2.0"))
@example(("8 / 4 / 2 - 3 - 1", "8.0 / 4.0 / 2.0 - 3.0 - 1.0"))
def test_formulas_mean_what_they_mean_in_python(pair: tuple[str, str]) -> None:
    ours, theirs = pair
    try:
        expected = eval(theirs, {"__builtins__": {}, "float": float})
    except (ZeroDivisionError, OverflowError):
        expected = math.nan
    assume(isinstance(expected, float) and math.isfinite(expected) and abs(expected) < 1e250)
    assert value(ours) == pytest.approx(expected, rel=1e-9, abs=1e-300)


def test_the_longest_name_is_meant() -> None:
    assert value("Joint 1 [rad]*57.29578") == pytest.approx(VALUES["Joint 1 [rad]"] * 57.29578)
    assert value("Joint 1 * 2") == pytest.approx(2.0 * VALUES["Joint 1"])
    assert value("x_mm") == VALUES["x_mm"]
    assert value("pos (2)*(2)") == pytest.approx(2.0 * VALUES["pos (2)"])
    assert value("a-b") == VALUES["a-b"]
    assert value("1e3") == 1000.0
    assert value("`1e3`") == VALUES["1e3"]


@pytest.mark.parametrize(
    ("text", "position", "said"),
    [
        ("x *", 4, "ends where"),
        ("x ^ 2", 3, "**"),
        ("sin(x)", 1, "no column 'sin'"),
        ("__import__('os').system('ls')", 1, "__import__"),
        ("x.__class__", 2, "not expected"),
        ("(x", 3, "closing parenthesis"),
        ("x)", 2, "not expected"),
        ("2 y", 3, "not expected"),
        ("x_m", 1, "did you mean 'x_mm'"),
        ("`x_m`", 2, "no column"),
        ("", 1, "ends where"),
        ("x; x", 2, "not expected"),
        ("1e999", 6, "too large"),
        ("x if x else x", 3, "not expected"),
        ("[x for x in x]", 1, "stands where"),
    ],
)
def test_anything_else_is_refused_with_its_position(text: str, position: int, said: str) -> None:
    with pytest.raises(InputError) as refused:
        value(text)
    assert f"position {position}:" in str(refused.value)
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


@given(st.text(max_size=60))
def test_no_text_does_worse_than_an_input_error(text: str) -> None:
    with contextlib.suppress(InputError):
        assert isinstance(value(text), float)


@pytest.mark.parametrize("text", ["(" * 5000 + "x", "-" * 900 + "x", "2**" * 300 + "2"])
def test_depth_has_an_end(text: str) -> None:
    with pytest.raises(InputError):
        value(text)


@pytest.mark.parametrize("text", ["9**9**9", "1e300**9", "9**(9**9)*x"])
def test_a_power_too_large_is_infinite_and_not_computed_to_the_last_digit(text: str) -> None:
    assert value(text) == math.inf


@pytest.mark.parametrize(
    "text", ["(" * 60 + "x" + ")" * 60, "x" + " + x" * 240, "(" * 30 + "1**" * 20 + "2" + ")" * 30]
)
def test_what_is_no_deeper_than_that_is_computed(text: str) -> None:
    assert math.isfinite(value(text))


@pytest.mark.parametrize(
    ("text", "expected"),
    [("x < 2", [True, False, False]), ("x+1 >= 3", [False, True, False]), ("x != 1", [False, True, False])],
)
def test_comparisons_choose_rows_and_never_a_blank_cell(text: str, expected: list[bool]) -> None:
    condition = read_condition(text, ["x"], file="f", key="rows")
    result = condition.holds(lambda _: np.array([1.0, 2.0, math.nan]), 3)
    assert result.tolist() == expected
