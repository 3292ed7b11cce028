"""The vectorised functions give what CasADi gives."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from linkwright.core.arm.compiled.tape import UnsupportedOperation
from linkwright.core.arm.compiled.vectorise import vectorise

TRIG = [ca.sin, ca.cos]
SMOOTH_1 = [ca.exp, ca.tanh, ca.atan, ca.sinh, ca.cosh, ca.asinh, ca.erf, ca.expm1, ca.log1p]
SMOOTH_1 += [ca.log, ca.asin, ca.acos, ca.acosh, ca.atanh, ca.tan]
SMOOTH_2 = [ca.atan2, ca.hypot, lambda a, b: ca.fabs(a) ** b]
EXACT_1 = [lambda a: -a, lambda a: a * a, lambda a: a + a, ca.sqrt, lambda a: 1 / a]
EXACT_2 = [lambda a, b: a + b, lambda a, b: a - b, lambda a, b: a * b, lambda a, b: a / b]


def signed_like(a, b):
    """The sign of a NaN is nobody's promise: let it count as a minus."""
    return ca.copysign(a, ca.fmax(b, -1e300))


def lower(a, b):
    """The lower of two; which of two zeros it is, with what sign, is nobody's promise either."""
    return ca.fmin(a, b) + 1e-300


def higher(a, b):
    return ca.fmax(a, b) + 1e-300


# These jump or bend: only on operands that every way of computing rounds alike.
JUMPS_1 = [ca.floor, ca.ceil, ca.fabs, ca.sign, ca.logic_not]
JUMPS_2 = [
    lower,
    higher,
    ca.fmod,
    ca.remainder,
    signed_like,
    lambda a, b: ca.if_else(a, b, 0),
    ca.lt,
    ca.le,
    ca.eq,
]
JUMPS_2 += [ca.ne, ca.logic_and, ca.logic_or]
OPERATIONS = [
    *((f, 1, "trig") for f in TRIG * 3),
    *((f, 1, "smooth") for f in SMOOTH_1),
    *((f, 2, "smooth") for f in SMOOTH_2),
    *((f, 1, "exact") for f in EXACT_1 * 3),
    *((f, 2, "exact") for f in EXACT_2 * 5),
    *((f, 1, "jump") for f in JUMPS_1),
    *((f, 2, "jump") for f in JUMPS_2),
]
SPECIAL = [0.0, -0.0, 1.0, -1.0, 0.5, 2.0, -3.0, np.inf, -np.inf, np.nan, 1e-300, -1e300, np.pi / 2, 1e7]


def casadi_values(inputs, output, arrays):
    """CasADi's own interpreter, row by row."""
    function = ca.Function("f", inputs, [ca.densify(output)])
    return np.array([np.array(function(*row)).ravel() for row in zip(*arrays, strict=True)])


def grow(x, steps, constants):
    """Steps of a random program: (value, value with the errors of all steps, is it exact); and the errors.

    Every step that rounds differently here and there has an error of its own: relative, but for sine and
    cosine, which are promised to an absolute distance.
    """
    pool = [(x[j], x[j], True) for j in range(x.numel())]
    pool += [(ca.SX(value), ca.SX(value), True) for value in constants]
    errors = []
    for number, i, j in steps:
        operation, arity, kind = OPERATIONS[number % len(OPERATIONS)]
        operands = [pool[-1 - i % len(pool)], pool[-1 - j % len(pool)]][:arity]
        exact = all(operand[2] for operand in operands)
        if kind == "jump" and not exact:
            continue
        value = operation(*(operand[0] for operand in operands))
        error = ca.SX.sym(f"error{len(errors)}")
        noisy = operation(*(operand[1] for operand in operands))
        exact = exact and kind in ("exact", "jump")
        if not exact:
            errors.append(error)
            noisy = noisy + error if kind == "trig" else noisy * (1 + error)
        pool.append((value, noisy, exact))
    return pool[x.numel() + len(constants) :], errors


programs = st.lists(st.tuples(st.integers(0, 10**6), st.integers(0, 12), st.integers(0, 12)), min_size=1, max_size=25)


@settings(max_examples=150, deadline=None)
@given(programs, st.lists(st.floats(-4, 4), max_size=3), st.integers(0, 10**6))
def test_random_expressions_equal_casadi(steps, constants, seed):
    x = ca.SX.sym("x", 3)
    grown, errors = grow(x, steps, constants)
    if not grown:
        return
    value, noisy = ca.vertcat(*(g[0] for g in grown)), ca.vertcat(*(g[1] for g in grown))
    exact = np.array([g[2] for g in grown])
    rng = np.random.default_rng(seed)
    rows = rng.normal(size=(40, 3)) * 10.0 ** rng.integers(-2, 3, size=(40, 1))
    rows[25:] = np.where(rng.random((15, 3)) < 0.6, rng.choice(SPECIAL, (15, 3)), rows[25:])
    # Once equal terms are merged, CasADi itself takes y - y for 0, even where y is infinite.
    expected = casadi_values([x], ca.cse(value), [rows])
    (result,) = vectorise([x], [value])(rows)
    assert result.shape == expected.shape

    assert np.array_equal(result[:, exact], expected[:, exact], equal_nan=True)
    all_errors = ca.vertcat(*errors) if errors else ca.SX.sym("none")
    slope = ca.sum2(ca.fabs(ca.jacobian(noisy, all_errors)))
    bound = casadi_values([x, all_errors], slope, [rows, np.zeros((len(rows), all_errors.numel()))])
    with np.errstate(invalid="ignore", over="ignore"):
        allowed = 5e-15 * (bound + np.abs(expected)) + 1e-290
        off = np.abs(result - expected)
    # First-order bounds say little where they, or those of a term before, are huge: next to poles and edges of domains.
    # The sine of 1e41, say, is noise, and the quadrant of an angle made of it a jump that no slope announces.
    widest = np.maximum.accumulate(np.where(np.isfinite(bound), bound, np.inf), axis=1)
    clear = np.isfinite(allowed) & np.isfinite(expected) & (widest < 1e9)
    assert np.all(off[clear] <= allowed[clear])


def test_every_operation_equals_casadi_special_values_included():
    x = ca.SX.sym("x", 2)
    a, b = x[0], x[1]
    one = [f(a) for f in TRIG + SMOOTH_1 + EXACT_1 + JUMPS_1]
    two = [f(a, b) for f in [*EXACT_2, *JUMPS_2, ca.atan2, ca.hypot]]
    output = ca.vertcat(*one, *two, a**b, ca.if_else(a > b, a, b), a**2.5, 3.0, b)
    grid = np.array([(u, v) for u in [*SPECIAL, 0.3, -2.7] for v in [*SPECIAL, 1.9, -0.4]])
    expected = casadi_values([x], output, [grid])
    (result,) = vectorise([x], [output])(grid)
    np.testing.assert_allclose(result, expected, rtol=1e-14, atol=4e-16)


def test_sine_and_cosine_are_within_the_stated_distance():
    x = ca.SX.sym("x")
    f = vectorise([x], [ca.vertcat(ca.sin(x), ca.cos(x))])
    rng = np.random.default_rng(3)
    angles = np.concatenate(
        [np.linspace(-7, 7, 20_001), rng.uniform(-1e3, 1e3, 40_000), np.arange(-640, 640) * np.pi / 2]
    )
    (result,) = f(angles[:, None])
    limit = 4e-16
    assert np.max(np.abs(result[:, 0] - np.sin(angles))) <= limit
    assert np.max(np.abs(result[:, 1] - np.cos(angles))) <= limit


def test_constants_keep_their_sign_and_their_every_bit():
    x = ca.SX.sym("x")
    constants = [0.0, -0.0, 0.1, 1 / 3, np.pi, 5e-324, 1.7976931348623157e308, np.inf, -np.inf, -1e-7, 1e22]
    output = ca.vertcat(*(ca.copysign(x, c) for c in constants), *(ca.fmax(ca.fmin(x, 0), c) for c in constants))
    (result,) = vectorise([x], [output])([[2.0]])
    np.testing.assert_array_equal(result, casadi_values([x], output, [[[2.0]]]))


def test_rows_constants_and_layouts_broadcast():
    q, d = ca.SX.sym("q", 2), ca.SX.sym("d", 3)
    outputs = [ca.vertcat(q[0] * d[2] + ca.sin(d[0]), q[1]), d[1] * d[1] + 1, ca.SX(2, 1), d]
    f = vectorise([q, d], outputs)
    rng = np.random.default_rng(0)
    angles, design = rng.normal(size=(20_011, 2)), rng.normal(size=3)
    repeated = np.broadcast_to(design, (len(angles), 3))
    first = f(angles, repeated)
    assert [part.shape for part in first] == [(20_011, 2), (20_011, 1), (20_011, 2), (20_011, 3)]
    assert all(part.dtype == np.float64 for part in first)
    np.testing.assert_allclose(first[0][:, 0], angles[:, 0] * design[2] + np.sin(design[0]), rtol=1e-14)
    assert not np.any(first[2])
    for other in (
        f(angles, design),
        f(np.asfortranarray(angles), design),
        f(np.repeat(angles, 2, axis=0)[::2], list(design)),
        f(angles.astype(object), design),
    ):
        for a, b in zip(first, other, strict=True):
            np.testing.assert_allclose(a, b, rtol=1e-15)
    (a, *_), (b, *_) = f(angles[4], design), f(angles[4:5], design)
    assert a.shape == b.shape == (1, 2)
    assert [part.shape for part in f(np.empty((0, 2)), design)] == [(0, 2), (0, 1), (0, 2), (0, 3)]


def test_programs_without_inputs_or_outputs():
    x = ca.SX.sym("x", 2)
    assert vectorise([x], [])(np.ones((3, 2))) == ()
    (result,) = vectorise([], [ca.SX(4.0)])()
    assert result.tolist() == [[4.0]]


def test_shapes_that_do_not_fit_are_refused():
    q, d = ca.SX.sym("q", 2), ca.SX.sym("d")
    f = vectorise([q, d], [q * d])
    with pytest.raises(ValueError, match="1 arguments given, 2 needed"):
        f(np.ones((3, 2)))
    with pytest.raises(ValueError, match=r"argument 0 has shape \(3, 3\); \(N, 2\) or \(2,\)"):
        f(np.ones((3, 3)), 1.0)
    with pytest.raises(ValueError, match=r"argument 1 has shape \(3,\)"):
        f(np.ones((3, 2)), np.ones(3))
    with pytest.raises(ValueError, match=r"argument 1 has shape \(\)"):
        f(np.ones((3, 2)), 1.0)
    with pytest.raises(ValueError, match=r"number of rows: \[1, 3\]"):
        f(np.ones((3, 2)), np.ones((1, 1)))


def test_expressions_that_do_not_fit_are_refused():
    q, r = ca.SX.sym("q", 2), ca.SX.sym("stray")
    with pytest.raises(ValueError, match="no input: stray"):
        vectorise([q], [q[0] * r])
    with pytest.raises(ValueError, match="symbols only"):
        vectorise([2 * q], [q])
    with pytest.raises(ValueError, match="more than once"):
        vectorise([q, q[0]], [q])
    with pytest.raises(ValueError, match="column"):
        vectorise([q], [ca.SX(2, 2) + q[0]])
    with pytest.raises(UnsupportedOperation, match="erfinv"):
        vectorise([q], [ca.erfinv(q[0])])


def planar_error(q):
    """Two links under gravity: bending, slope and drive, enough terms to be worth vectorising."""
    first, second = q[0], q[0] + q[1]
    moment = 2 * ca.cos(first) + 0.7 * ca.cos(second)
    turn = 1e-3 * moment + 4e-4 * ca.cos(first)
    lever_x = ca.cos(first) + ca.cos(second)
    lever_y = ca.sin(first) + ca.sin(second)
    sag = 1e-3 * ca.cos(second)
    return ca.vertcat(-turn * lever_y + sag * ca.sin(second), turn * lever_x - sag * ca.cos(second))


def test_calls_from_many_threads_do_not_disturb_each_other():
    q, d = ca.SX.sym("q", 2), ca.SX.sym("d")
    f = vectorise([q, d], [planar_error(q) * d])
    rows = np.random.default_rng(1).uniform(-3, 3, (120_000, 2))
    (once,) = f(rows, [1.0])
    with ThreadPoolExecutor(8) as pool:
        results = list(pool.map(lambda k: f(rows, [float(k)])[0], range(16)))
    for k, result in enumerate(results):
        np.testing.assert_allclose(result, k * once, rtol=1e-14, atol=1e-18)
