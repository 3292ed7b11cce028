"""Forces at the tip that no entry of the library describes: a pull is found wherever it is, a wandering one by time."""

import re

import numpy as np
import pytest

from linkwright.core.diagnose.fitting.prepare import prepare
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.patterns.forces import fitted_pull
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.costs import slow_but
from tests.diagnose.arm_of_drives import arm_of_drives, given_way, read, turned_by, visited
from tests.diagnose.core_cases import group_of
from tests.diagnose.recorded import planar_arm, planar_tip

ARM = arm_of_drives()


def drawn(tip, point, strength, core):
    """F = -k r / (r^2 + core^2)^1.5 at each tip, (N, 2), N."""
    away = tip - point
    return -strength * away / (np.sum(away**2, axis=1, keepdims=True) + core**2) ** 1.5


def between(tip, cell):
    """A place as far as can be from the points of the search's coarse grid: the middle of one of its cells."""
    low, high = tip.min(axis=0), tip.max(axis=0)
    margin = 0.15 * (high - low)
    return low - margin + (np.array(cell) + 0.5) * (high - low + 2.0 * margin) / 5.0


def beside_a_magnet(seed, cell, *, core=0.2, strength=2.0):
    """A recording of 100 poses, each read twice, and where the magnet is."""
    rng = np.random.default_rng(seed)
    q = visited(rng, 100, 2)
    place = between(planar_tip(q), cell)
    return read(q, given_way(q, drawn(planar_tip(q), place, strength, core)), rng), place


def ready(recording, arm=ARM):
    return prepare(observe(arm, recording), Options())


def place_of(candidate):
    return np.array([candidate.shapes["at_x"], candidate.shapes["at_y"]])


@pytest.mark.parametrize(
    ("seed", "cell"),
    [
        pytest.param(1, (3, 2), marks=pytest.mark.slow),
        pytest.param(2, (2, 3), marks=pytest.mark.slow),
        (3, (3, 3)),
        pytest.param(4, (3, 1), marks=pytest.mark.slow),
        pytest.param(5, (4, 2), marks=pytest.mark.slow),
    ],
)
def test_a_magnet_between_the_points_of_the_grid_is_unknown_and_has_a_place(seed, cell):
    """A grid of 0.4 m would otherwise make it some errors of the joints, or put it 0.2 m away."""
    recording, place = beside_a_magnet(seed, cell)
    result = diagnose(ARM, recording)
    assert result.verdict == "unknown"
    assert "pull towards a point" in result.unknown.shape
    assert "position" in result.unknown.depends_on
    told = re.search(r"it is near \((-?\d+\.\d+), (-?\d+\.\d+)\) m", result.unknown.shape)
    assert told is not None
    assert np.linalg.norm([float(group) for group in told.groups()] - place) < 0.03
    assert result.rms_after < 1.2 * result.noise_floor


@pytest.mark.parametrize("core", [0.05, 0.1, 0.2])
def test_a_pull_is_found_with_its_core_and_strength(core):
    """By least squares of the columns that come with it; the sharper the core, the better the place is known."""
    recording, place = beside_a_magnet(3, (3, 3), core=core)
    prepared = ready(recording)
    candidate, columns = fitted_pull(prepared.observed, prepared.pool, prepared.vector, ())
    assert np.linalg.norm(place_of(candidate) - place) < 0.05 * core
    assert candidate.shapes["core"] == pytest.approx(core, rel=0.1)
    column, residual = columns[:, :, 0], prepared.observed.residual
    assert np.sum(column * residual) / np.sum(column**2) == pytest.approx(2.0, rel=0.1)


def test_a_pull_is_found_beside_what_is_known():
    """An encoder that is off as well, by 0.15 mrad and more than the magnet moves: taken as known it is in no one's
    way, and left aside it draws the place to where it is not."""
    rng = np.random.default_rng(6)
    q = visited(rng, 100, 2)
    place = between(planar_tip(q), (3, 3))
    moved = given_way(q, drawn(planar_tip(q), place, 1.0, 0.2))
    off = turned_by(q, (0.0, 1.5e-4, 0.0))
    assert np.linalg.norm(off) > np.linalg.norm(moved)
    prepared = ready(read(q, moved + off, rng))
    known = (group_of(prepared, "encoder_offset", (1,)),)
    beside, _ = fitted_pull(prepared.observed, prepared.pool, prepared.vector, known)
    assert np.linalg.norm(place_of(beside) - place) < 0.03
    alone, _ = fitted_pull(prepared.observed, prepared.pool, prepared.vector, ())
    assert np.linalg.norm(place_of(alone) - place) > 0.06


def test_the_columns_of_a_pull_are_those_of_the_textbook():
    """J diag(C) J^T F of a unit pull, wherever and however wide it was found."""
    recording, _ = beside_a_magnet(1, (3, 2))
    prepared = ready(recording)
    candidate, columns = fitted_pull(prepared.observed, prepared.pool, prepared.vector, ())
    assert candidate.outside
    q = prepared.observed.recording.q
    expected = given_way(q, drawn(planar_tip(q), place_of(candidate), 1.0, candidate.shapes["core"]))
    assert columns[:, :, 0] == pytest.approx(expected, rel=1e-9, abs=1e-9 * np.abs(expected).max())


def test_a_stiff_arm_is_pulled_nowhere():
    recording, _ = beside_a_magnet(1, (3, 2))
    prepared = ready(recording, planar_arm())
    assert fitted_pull(prepared.observed, prepared.pool, prepared.vector, ()) is None


@pytest.mark.slow
@pytest.mark.parametrize("seed", slow_but(range(3), 1))
def test_a_force_that_wanders_with_time(seed):
    """A hose that is dragged along: 3 N that keep nine tenths of themselves from visit to visit, at random poses."""
    rng = np.random.default_rng(seed)
    q = visited(rng, 100, 2)
    force = rng.standard_normal((100, 2))
    for visit in range(1, 100):
        force[visit] = 0.9 * force[visit - 1] + np.sqrt(1.0 - 0.9**2) * force[visit]
    result = diagnose(ARM, read(q, given_way(q, 3.0 * np.repeat(force, 2, axis=0)), rng))
    assert result.verdict == "unknown"
    assert "time" in result.unknown.depends_on
    assert "force at the tip that wanders" in result.unknown.shape
    assert result.unknown.forms[0].name == "force_in_time"
    assert result.unknown.forms[0].share_held_out > 0.4
    assert not result.findings
