"""A size that was fitted alone has room in its interval for what its effect has besides."""

from __future__ import annotations

import numpy as np
import pytest

from linkwright.core.diagnose.fitting.fit import fit
from linkwright.core.diagnose.fitting.prepare import Prepared
from linkwright.core.diagnose.fitting.refit import refit
from linkwright.core.diagnose.fitting.room.active_bounds import at_active_bounds
from linkwright.core.diagnose.result import FittedParameter
from tests.diagnose.core_cases import group_of, noise_of, prepared_null, with_residual
from tests.diagnose.fitting.test_fit import within

WINDUP, PER_LOAD = 6e-6, 4e-7
"""rad, and rad/(N*m): under the loads of these recordings each winds the drive up by about as much."""
TRIALS = 60


@pytest.fixture(scope="module")
def null() -> Prepared:
    """Noise alone, every pose from both sides."""
    return prepared_null(poses=24, sides="both")


def variant(prepared: Prepared, sizes: tuple[str, ...]) -> int:
    for number, group in enumerate(prepared.pool.groups):
        candidate = group.candidate
        if (candidate.effect, candidate.at, candidate.sizes) == ("friction_windup", (1,), sizes):
            return number
    raise AssertionError(f"no wind-up of {sizes}")


def fitted(
    null: Prepared, rng: np.random.Generator, sizes: tuple[str, ...], *true: float
) -> tuple[FittedParameter, float]:
    """The first size of a wind-up fitted by these sizes to one of both, and its standard error by noise alone."""
    both = variant(null, ("windup", "windup_per_load"))
    prepared = with_residual(null, null.columns[both] @ np.array(true) + noise_of(null, rng))
    member = variant(null, sizes)
    result = fit(prepared, [member])
    return refit(prepared, [member], (), result).parameters[0][0], float(result.errors[0][0])


def test_the_true_size_is_in_the_interval_though_the_other_was_left_out(null: Prepared) -> None:
    """Friction has both a constant and a share of the load: fitted by the one, least squares is sure of their sum."""
    rng = np.random.default_rng(41)
    plain, wide = 0, 0
    for _ in range(TRIALS):
        parameter, error = fitted(null, rng, ("windup",), WINDUP, PER_LOAD)
        plain += abs(parameter.value - WINDUP) < 1.96 * error
        wide += parameter.interval[0] <= WINDUP <= parameter.interval[1]
        assert parameter.interval[0] >= min(0.0, parameter.value - 2.1 * error)
    assert plain < 0.6 * TRIALS
    assert wide >= 0.93 * TRIALS


def test_a_size_held_at_nought_has_room_in_the_other(null: Prepared) -> None:
    """Both are sought, and where the constant would come out negative it is held at nought: it may be more."""
    rng, held, wide = np.random.default_rng(44), 0, 0
    for _ in range(TRIALS):
        parameter, _ = fitted(null, rng, ("windup", "windup_per_load"), 0.1 * WINDUP, PER_LOAD)
        if parameter.parameter == "windup_per_load":
            held += 1
            wide += parameter.interval[0] <= PER_LOAD <= parameter.interval[1]
    assert held > 10
    assert wide >= 0.9 * held


def test_the_true_size_is_in_the_interval_where_the_other_is_nought(null: Prepared) -> None:
    rng = np.random.default_rng(42)
    covered = [fitted(null, rng, ("windup",), WINDUP, 0.0)[0].interval for _ in range(TRIALS)]
    assert within(sum(low <= WINDUP <= high for low, high in covered), trials=TRIALS) or all(
        low <= WINDUP <= high for low, high in covered
    )


def test_sizes_that_were_fitted_together_stay_as_they_were(null: Prepared) -> None:
    both = variant(null, ("windup", "windup_per_load"))
    moved = null.columns[both] @ np.array([20.0 * WINDUP, 20.0 * PER_LOAD])
    prepared = with_residual(null, moved + noise_of(null, np.random.default_rng(43)))
    result = refit(prepared, [both], (), fit(prepared, [both]))
    assert at_active_bounds(prepared, result.terms, 0, prepared.vector, 1.0) == {}
    offset = group_of(null, "encoder_offset", (1,))
    other = refit(prepared, [offset], (), fit(prepared, [offset]))
    assert at_active_bounds(prepared, other.terms, 0, prepared.vector, 1.0) == {}
