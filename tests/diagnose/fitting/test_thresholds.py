"""From which load on the load seats a backlash: a shape whose pattern changes in steps."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linkwright.core.diagnose.fitting.thresholds import least_of, no_worse_than
from linkwright.core.diagnose.patterns.library import Candidate
from linkwright.core.diagnose.reading.read import read_recording
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.steps.diagnosis import diagnose
from linkwright.core.sections.numeric import Array
from tests.diagnose.arm_of_drives import COMPLIANCE, SIGMA, arm_of_drives
from tests.diagnose.recorded import LENGTHS, sagging_tip, table, written

TOTAL = 0.6e-3


def loaded(visits: int, seed: int) -> tuple[Array, Array, Array, Array]:
    """Angles, sides and payload of so many visits and as many from the other side, and the load on joint 3."""
    rng = np.random.default_rng(seed)
    stood = np.repeat(rng.uniform(-1.2, 1.2, (visits, 3)), 2, axis=0)
    sides = np.tile([[-1.0], [1.0]], (visits, 3))
    payload = np.repeat(rng.choice([2.0, 5.0], visits), 2)
    return stood, sides, payload, 9.81 * payload * LENGTHS[2] * np.cos(stood.sum(axis=1))


@pytest.mark.parametrize(
    ("seed", "share"),
    [
        (1, 0.3),
        pytest.param(2, 0.45, marks=pytest.mark.slow),
        pytest.param(3, 0.6, marks=pytest.mark.slow),
        pytest.param(4, 0.8, marks=pytest.mark.slow),
    ],
)
def test_each_reading_stands_on_the_side_of_the_threshold_that_it_stood_on(
    tmp_path: Path, seed: int, share: float
) -> None:
    stood, sides, payload, load = loaded(30, seed)
    held_below = share * float(np.max(np.abs(load)))
    seated = np.where(np.abs(load) < held_below, -sides[:, 2], -np.sign(load))
    moved = np.outer(0.5 * TOTAL * seated, [0.0, 0.0, 1.0])
    tip = sagging_tip(stood + moved, 1.0 / np.array(COMPLIANCE), payload)
    tip += SIGMA * np.random.default_rng(seed + 100).standard_normal(tip.shape)
    columns = table(stood, tip, payload_kg=payload, **{f"dir{k + 1}": sides[:, k] for k in range(3)})
    (tmp_path / "recording.yaml").write_text(f"sigma: {1e6 * SIGMA:g} um\n", encoding="utf-8")
    arm = replace(arm_of_drives(), gravity=(0.0, -9.81, 0.0))
    recording = read_recording(written(tmp_path / "recording.csv", columns), arm, tmp_path / "recording.yaml")
    result = diagnose(arm, recording)
    assert [(finding.effect, finding.at) for finding in result.findings] == [("backlash", (3,))]
    fitted = {parameter.parameter: parameter for parameter in result.findings[0].parameters}
    assert fitted["total"].value == pytest.approx(TOTAL, rel=0.05)
    threshold = fitted["held_below"].value
    np.testing.assert_array_equal(np.abs(load) < threshold, np.abs(load) < held_below)
    assert fitted["held_below"].interval[0] <= held_below <= fitted["held_below"].interval[1]


@given(st.lists(st.floats(0.0, 10.0), min_size=1, max_size=24))
def test_few_steps_are_all_looked_at(heights: list[float]) -> None:
    looked: list[float] = []

    def left(step: float) -> float:
        looked.append(step)
        return heights[int(step)]

    at, least = least_of(left, np.arange(len(heights), dtype=float))
    assert least == min(heights) == heights[int(at)]
    assert sorted(looked) == list(range(len(heights)))


@given(st.integers(25, 5000), st.floats(0.0, 1.0))
def test_of_many_the_least_of_a_valley_is_found_with_few_looks(count: int, where: float) -> None:
    least = round(where * (count - 1))
    looked: list[float] = []

    def left(step: float) -> float:
        looked.append(step)
        return abs(step - least)

    assert least_of(left, np.arange(count, dtype=float)) == (least, 0.0)
    assert len(looked) <= 100


def test_an_interval_reaches_from_the_lowest_step_that_fits_as_well_to_the_highest() -> None:
    """What steps between them leave does not matter; its ends are loads that were borne, or none."""
    stood, sides, payload, load = loaded(40, 6)
    borne = np.unique(np.round(np.abs(load), 12))
    tip = sagging_tip(stood, 1.0 / np.array(COMPLIANCE), payload)
    arm = replace(arm_of_drives(), gravity=(0.0, -9.81, 0.0))
    recording = Recording("r.csv", stood, tip, np.arange(1, len(stood) + 1), sides=sides, payload_mass=payload)
    observed = observe(arm, recording)
    seats = Candidate("backlash", (2,), ("total",), MappingProxyType({"held_below": 1.0}))
    loads = np.unique(np.abs(observed.state.joints[2].drive_load))
    assert loads == pytest.approx(borne, rel=0.02)  # an arm that sags bears its loads elsewhere
    fits = {8, 20, 21, 27}  # steps numbered by the load that ends them

    def left(logarithm: float) -> float:
        return 1.0 if int(np.searchsorted(loads, np.exp(logarithm))) in fits else 2.0

    at = float(np.sqrt(loads[19] * loads[20]))
    low, high = no_worse_than(1.5, left, observed, seats, at)
    assert (low, high) == (pytest.approx(loads[7]), pytest.approx(loads[27]))
    fits |= set(range(len(loads) + 1))
    assert no_worse_than(1.5, left, observed, seats, at) == (0.0, float("inf"))
