"""Lengths of links whose sections are settled: the least of the finite problem, a smooth program of few variables."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from linkwright.core.arm.figures import Limit
from linkwright.core.optimize.choice.at_once.cells import COLUMNS, LENGTH
from linkwright.core.optimize.choice.at_once.pose_rows import PoseRow
from linkwright.core.optimize.problem import Problem
from linkwright.core.sections.numeric import Array

_HALVED = 200


def fitted(problem: Problem, lengths: Sequence[float]) -> tuple[float, ...]:
    """The lengths (m) of all links, those of elastic ones scaled alike and cut to the problem's range, so that the
    reach is within its limits."""
    least, most = np.array(problem.length_spans).T
    free = np.array([link.section is not None for link in problem.arm.links])
    values = np.array(lengths, dtype=float)

    def scaled(factor: float) -> Array:
        return np.where(free, np.clip(factor * values, least, most), values)

    now = scaled(1.0)
    low, high = _reach(problem)
    total = float(now.sum())
    if low <= total <= high:
        return tuple(now.tolist())
    wanted = low if total < low else high
    ends = [float((least / values)[free].min()), float((most / values)[free].max())]
    for _ in range(_HALVED):
        middle = 0.5 * (ends[0] + ends[1])
        ends[0 if scaled(middle).sum() < wanted else 1] = middle
    fitted_lengths = scaled(ends[1])
    # What rounding leaves is taken from a link that has room for it.
    rest = wanted - float(fitted_lengths.sum())
    room = np.where(free & (fitted_lengths + rest >= least) & (fitted_lengths + rest <= most), fitted_lengths, 0.0)
    fitted_lengths[int(room.argmax())] += rest
    return tuple(fitted_lengths.tolist())


def _reach(problem: Problem) -> tuple[float, float]:
    """The least and the greatest reach (m) that the limits allow."""
    low, high = 0.0, np.inf
    for limit in problem.limit("reach"):
        low = max(low, limit.value) if limit.relation in ("==", ">=") else low
        high = min(high, limit.value) if limit.relation in ("==", "<=") else high
    return low, high


def moved(problem: Problem, lengths: Sequence[float], links: Sequence[int], step: float) -> Iterator[tuple[float, ...]]:
    """Lengths (m) beside others, as near as the problem allows: one link longer or shorter by a share, or two of them,
    one at the expense of the other."""
    values = np.array(lengths)
    steps = step * np.diag(values)
    pairs = [steps[one] - steps[other] * values[one] / values[other] for one, other in itertools.combinations(links, 2)]
    for change in (*(steps[one] for one in links), *pairs):
        for trial in (values + change, values - change):
            yield fitted(problem, trial)


_WIDTH = len(COLUMNS)
_KEPT = 1e-6
"""Limits may be broken by so much (relative) at the end: what is offered is judged by itself."""
_MOST_STEPS = 100


@dataclass(frozen=True)
class Lengths:
    """Lengths (m) of the elastic links, and the objective there, relative to what the rows are."""

    lengths: tuple[float, ...]
    value: float


class LengthProgram:
    """The finite problem over rows, in the logarithms of lengths; sections differ from call to call."""

    def __init__(self, rows: Sequence[PoseRow], limits: Sequence[Limit], links: Sequence[int], spans: Array) -> None:
        """`links` are the elastic ones, `spans` (n, 2) the logarithms of their bounds (m), `limits` those that the
        rows' numbers stand for."""
        self._links, self._spans = tuple(links), spans
        places = [_WIDTH * link + LENGTH for link in links]
        powers = np.vstack([np.zeros((1, len(places))), *[row.powers[:, places] for row in rows]])
        self._monomials, index = np.unique(powers, axis=0, return_inverse=True)
        inverse = index.ravel()
        self._constant = int(inverse[0])
        ends = np.cumsum([1, *[len(row.powers) for row in rows]])
        self._rows = [(row, inverse[a:b]) for row, a, b in zip(rows, ends, ends[1:], strict=False)]
        equal = [limit.relation == "==" for limit in limits]
        # A limit that must be met exactly stands in two rows.
        pairs = [row.limit if row.limit is not None and equal[row.limit] else None for row in rows]
        last = {limit: number for number, limit in enumerate(pairs) if limit is not None}
        self._equal = [number for number, limit in enumerate(pairs) if limit is not None and last[limit] == number]
        self._above = [number for number, limit in enumerate(pairs) if limit is None]
        self._objective = np.array([row.objective for row in rows])

    def solve(self, columns: Array, start: Sequence[float]) -> Lengths | None:
        """The least for sections (columns of all links, (n K)), from lengths (m); None where no lengths near keep the
        limits."""
        table = np.zeros((len(self._rows), 3, len(self._monomials)))
        shifts = np.array([row.shift for row, _ in self._rows])
        scalar = np.array([row.coefficients.shape[1] == 1 for row, _ in self._rows])
        for number, (row, inverse) in enumerate(self._rows):
            terms = np.exp(row.powers @ columns)[:, None] * row.coefficients
            width = terms.shape[1]
            for k in range(width):
                table[number, k] = np.bincount(inverse, terms[:, k], minlength=len(self._monomials))
            table[number, :width, self._constant] += row.constant + row.linear.T @ columns
        return self._minimised(_Values(table, shifts, scalar, self._monomials), start)

    def _minimised(self, values: _Values, start: Sequence[float]) -> Lengths | None:
        x = np.log(np.array(start))
        first = values.at(x)[0]
        t = float(first[self._objective].max())
        count = len(x)
        above: NDArray[np.intp] = np.array(self._above, dtype=np.intp)
        weights = self._objective[above].astype(float)

        def held(z: Array) -> Array:
            return weights * z[-1] - values.at(z[:-1])[0][above]

        def slopes(z: Array) -> Array:
            return np.hstack([-values.at(z[:-1])[1][above], weights[:, None]])

        exact: NDArray[np.intp] = np.array(self._equal, dtype=np.intp)

        def met(z: Array) -> Array:
            return values.at(z[:-1])[0][exact]

        def along(z: Array) -> Array:
            return np.hstack([values.at(z[:-1])[1][exact], np.zeros((len(exact), 1))])

        def least(z: Array) -> tuple[float, Array]:
            return float(z[-1]), np.append(np.zeros(count), 1.0)

        constraints: list[dict[str, Any]] = [{"type": "ineq", "fun": held, "jac": slopes}]
        if len(exact):
            constraints.append({"type": "eq", "fun": met, "jac": along})
        result: Any = minimize(
            least,
            np.append(x, t),
            jac=True,
            bounds=[*self._spans.tolist(), (None, None)],
            constraints=constraints,
            method="SLSQP",
            options={"maxiter": _MOST_STEPS, "ftol": 1e-9},
        )
        end = np.clip(result.x[:-1], *self._spans.T)
        last = values.at(end)[0]
        broken = np.concatenate([last[above][weights == 0.0], np.abs(last[self._equal])])
        if not np.isfinite(last).all() or broken.max(initial=0.0) > _KEPT:
            return None
        return Lengths(tuple(np.exp(end).tolist()), float(last[self._objective].max()))


@dataclass(frozen=True)
class _Values:
    """Rows whose vectors are sums of powers of lengths: a table (R, 3, U) of coefficients, shifts (R), and which rows
    are numbers."""

    table: Array
    shifts: Array
    scalar: NDArray[np.bool_]
    monomials: Array

    def at(self, x: Array) -> tuple[Array, Array]:
        """The rows' values (R) and gradients (R, n) at logarithms of lengths."""
        powers = np.exp(self.monomials @ x)
        vectors = self.table @ powers
        slopes = self.table @ (powers[:, None] * self.monomials)
        length = np.where(self.scalar, vectors[:, 0], np.sqrt(np.einsum("rd,rd->r", vectors, vectors)))
        along = np.einsum("rd,rdn->rn", vectors, slopes) / np.where(length == 0.0, 1.0, length)[:, None]
        return self.shifts + length, np.where(self.scalar[:, None], slopes[:, 0], along)


class SettledRow:
    """A row that is asked for at one set of lengths after another; what they share is prepared."""

    def __init__(self, row: PoseRow) -> None:
        self.row = row
        self._places = np.arange(LENGTH, row.powers.shape[1], _WIDTH)
        plain = row.powers.copy()
        plain[:, self._places] = 0.0
        self._powers, index = np.unique(plain, axis=0, return_inverse=True)
        self._inverse = index.ravel()
        self._lengths = row.powers[:, self._places]

    def at(self, logarithms: Array) -> PoseRow:
        """The row at logarithms of the lengths of all links (n)."""
        terms = np.exp(self._lengths @ logarithms)[:, None] * self.row.coefficients
        size = len(self._powers)
        columns = [np.bincount(self._inverse, terms[:, k], minlength=size) for k in range(terms.shape[1])]
        return replace(self.row, coefficients=np.stack(columns, axis=1), powers=self._powers)
