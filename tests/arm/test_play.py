"""How clearance and backlash count: worst, loaded, statistical; in the plane and in space."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from linkwright.core.arm.chain.chain import Arm, Joint, Link, LoadCase, Statistics
from linkwright.core.arm.errors.lost_motion import played
from linkwright.core.arm.errors.model import PoseArrays, beam_values, beams_of, error_model
from linkwright.core.arm.worst.search import WorstSearch
from linkwright.core.arm.worst.workspace import Workspace
from linkwright.core.sections.numeric import Array

UP = (0.0, 0.0, 1.0)


def pose_arrays(rng: np.random.Generator, poses: int, intervals: int, discs: int, *, planar: bool) -> PoseArrays:
    """Random error vectors and play; in the plane all z components vanish and discs lie in it."""
    flat = np.array([1.0, 1.0, 0.0]) if planar else np.ones(3)
    normals = rng.normal(size=(poses, discs, 3))
    normals = np.tile(UP, (poses, discs, 1)) if planar else normals / np.linalg.norm(normals, axis=2, keepdims=True)
    return PoseArrays(
        rng.normal(size=(poses, 3)) * flat,
        rng.normal(size=(poses, intervals, 3)) * flat,
        rng.normal(size=(poses, intervals)),
        normals,
        rng.normal(size=(poses, discs, 3)) * flat,
        np.ones(poses),
    )


def farthest_by_directions(arrays: PoseArrays, radii: Array, directions: Array) -> Array:
    """max over unit directions d of the support function: e.d + sum |I_j.d| + sum r_k |d - (n_k.d) n_k|."""
    along = arrays.vector @ directions.T
    along = along + np.abs(np.einsum("nki,di->nkd", arrays.intervals, directions)).sum(axis=1)
    cosine = np.einsum("nki,di->nkd", arrays.normals, directions)
    return (along + (radii[:, None] * np.sqrt(np.maximum(1.0 - cosine**2, 0.0))).sum(axis=1)).max(axis=1)


def plane_directions(count: int) -> Array:
    angle = np.linspace(0.0, 2.0 * math.pi, count, endpoint=False)
    return np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], axis=1)


@pytest.mark.parametrize("intervals", range(8))
@pytest.mark.parametrize("discs", [0, 1, 3])
def test_worst_in_the_plane_is_the_farthest_of_all_vertices_and_disc_directions(intervals: int, discs: int) -> None:
    """Enumeration (up to 4 intervals) and the zonotope's vertices (beyond) against brute force."""
    arrays = pose_arrays(np.random.default_rng([intervals, discs]), 40, intervals, discs, planar=True)
    radii = np.linspace(0.1, 0.4, discs)
    result = played(arrays, radii, "worst", planar=True)
    exact = np.zeros(40)
    for signs in itertools.product((-1.0, 1.0), repeat=intervals):
        point = arrays.vector + np.einsum("k,nki->ni", np.array(signs), arrays.intervals)
        exact = np.maximum(exact, np.linalg.norm(point, axis=1) + radii.sum())
    assert result.error == pytest.approx(exact, rel=1e-12)
    # 3600 directions miss the support by at most 1 - cos(pi/3600) < 4e-7 of it.
    assert result.error == pytest.approx(farthest_by_directions(arrays, radii, plane_directions(3600)), rel=1e-6)


def test_parallel_and_vanishing_intervals_are_no_trap_for_the_zonotope() -> None:
    base = np.array([[1.0, 2.0, 0.0], [-2.0, -4.0, 0.0], [0.0, 0.0, 0.0], [3.0, 6.0, 0.0], [0.5, -0.1, 0.0]])
    arrays = PoseArrays(
        np.array([[0.3, -0.2, 0.0]]),
        np.stack([base]),
        np.zeros((1, 5)),
        np.zeros((1, 0, 3)),
        np.zeros((1, 0, 3)),
        np.ones(1),
    )
    expected = max(
        float(np.linalg.norm(arrays.vector[0] + np.array(signs) @ base))
        for signs in itertools.product((-1.0, 1.0), repeat=5)
    )
    assert played(arrays, np.zeros(0), "worst", planar=True).error[0] == pytest.approx(expected, rel=1e-12)


@given(seed=st.integers(0, 10**6), intervals=st.integers(0, 6), discs=st.integers(0, 6))
@settings(max_examples=40, deadline=None)
def test_worst_in_space_is_not_below_brute_force_over_directions(seed: int, intervals: int, discs: int) -> None:
    """Nor above what the set can reach: the vector found is made of allowed signs and shifts."""
    rng = np.random.default_rng(seed)
    arrays = pose_arrays(rng, 10, intervals, discs, planar=False)
    radii = rng.uniform(0.05, 1.0, discs)
    directions = rng.normal(size=(4000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    result = played(arrays, radii, "worst", planar=False)
    assert np.all(result.error >= farthest_by_directions(arrays, radii, directions) - 1e-9)
    made = arrays.vector + np.einsum("nk,nki->ni", result.signs, arrays.intervals) + result.shifts.sum(axis=1)
    assert np.linalg.norm(made, axis=1) == pytest.approx(result.error, rel=1e-12)
    assert np.all(np.abs(result.signs) <= 1.0)
    assert np.all(np.linalg.norm(result.shifts, axis=2) <= radii * (1.0 + 1e-12))
    assert np.all(np.abs(np.einsum("nki,nki->nk", result.shifts, arrays.normals)) <= 1e-12)


def test_loaded_play_stands_where_its_load_pushes_it() -> None:
    arrays = pose_arrays(np.random.default_rng(4), 30, 3, 2, planar=False)
    radii = np.array([0.2, 0.3])
    result = played(arrays, radii, "loaded", planar=False)
    assert np.array_equal(result.signs, np.sign(arrays.interval_seating))
    for disc in range(2):
        normal, load = arrays.normals[:, disc], arrays.disc_seating[:, disc]
        across = load - np.einsum("ni,ni->n", normal, load)[:, None] * normal
        expected = radii[disc] * across / np.linalg.norm(across, axis=1, keepdims=True)
        assert result.shifts[:, disc] == pytest.approx(expected, abs=1e-12)
    assert np.all(result.error <= played(arrays, radii, "worst", planar=False).error + 1e-12)


def test_play_without_load_counts_as_worst() -> None:
    arrays = pose_arrays(np.random.default_rng(4), 30, 3, 2, planar=True)
    unloaded = (np.zeros((30, 3)), arrays.normals, np.zeros((30, 2, 3)), np.ones(30))
    free = PoseArrays(arrays.vector, arrays.intervals, *unloaded)
    radii = np.array([0.2, 0.3])
    loaded, worst = (played(free, radii, mode, planar=True).error for mode in ("loaded", "worst"))
    assert loaded == pytest.approx(worst, rel=1e-14)


def test_statistical_play_is_the_quantile_of_a_plain_monte_carlo() -> None:
    """Intervals uniform, discs uniform over their area; 20,000 draws put a 90 % quantile within about 1 %."""
    arrays = pose_arrays(np.random.default_rng(8), 3, 3, 2, planar=True)
    radii = np.array([0.8, 0.5])
    mode = Statistics(level=0.9, draws=20_000, seed=3)
    result = played(arrays, radii, "statistical", planar=True, statistics=mode)
    rng = np.random.default_rng(12345)
    signs = rng.uniform(-1.0, 1.0, (100_000, 3))
    square = rng.uniform(-1.0, 1.0, (400_000, 2))
    inside = square[(square**2).sum(axis=1) <= 1.0]
    for pose in range(3):
        points = arrays.vector[pose] + signs @ arrays.intervals[pose]
        for disc, radius in enumerate(radii):
            points[:, :2] += radius * inside[disc * 100_000 : (disc + 1) * 100_000]
        expected = float(np.quantile(np.linalg.norm(points, axis=1), 0.9))
        assert result.error[pose] == pytest.approx(expected, rel=0.015)


def test_statistical_play_repeats_itself_and_stays_below_worst() -> None:
    arrays = pose_arrays(np.random.default_rng(8), 50, 3, 2, planar=False)
    radii = np.array([0.8, 0.5])
    first, again, other = (
        played(arrays, radii, "statistical", planar=False, statistics=Statistics(seed=seed)).error for seed in (1, 1, 2)
    )
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)
    assert np.all(first <= played(arrays, radii, "worst", planar=False).error + 1e-12)
    every = Statistics(level=1.0, seed=1)
    assert np.all(played(arrays, radii, "statistical", planar=False, statistics=every).error >= first)


# ---- through an arm


def paper_arm(**others: object) -> Arm:
    """The paper's lengths and its backlash (a total of 1e-3 rad, so half of it to either side), weightless."""
    joint = Joint(range=(-2.0, 2.0), backlash=1e-3)
    links = tuple(Link(length, mass=0.0) for length in (0.4, 0.42, 0.42))
    return Arm(**{"name": "paper", "joints": (joint,) * 3, "links": links, **others})  # type: ignore[arg-type]


def worst_error(arm: Arm) -> float:
    search = WorstSearch(error_model(arm), Workspace())
    return search.worst(beam_values(beams_of(arm))).error


def test_relative_backlash_turns_all_that_follows() -> None:
    """b/2 ((l1 + l2 + l3) + (l2 + l3) + l3) with the arm stretched out."""
    assert worst_error(paper_arm()) == pytest.approx(0.5e-3 * (1.24 + 0.84 + 0.42), rel=1e-9)


def test_absolute_backlash_turns_its_own_link_only() -> None:
    """b/2 (l1 + l2 + l3): the paper's convention."""
    assert worst_error(paper_arm(angles="absolute")) == pytest.approx(0.5e-3 * 1.24, rel=1e-9)


def test_clearances_add_up_in_the_plane() -> None:
    arm = Arm("pins", (Joint(clearance=25e-6),) * 3, paper_arm().links)
    assert worst_error(arm) == pytest.approx(75e-6, rel=1e-12)


def test_gravity_seats_backlash_downwards() -> None:
    """Held out level under its load, each joint sags by half its backlash."""
    arm = paper_arm(play="loaded", payload=LoadCase(mass=2.0))
    case = error_model(arm).cases[0]
    result = played(case.arrays(np.zeros((1, 3)), beam_values(beams_of(arm))), case.radii, "loaded", planar=True)
    assert result.vector[0] == pytest.approx([0.0, -0.5e-3 * (1.24 + 0.84 + 0.42), 0.0], abs=1e-15)


def test_a_side_force_pushes_the_pins_its_way() -> None:
    arm = Arm("pins", (Joint(clearance=25e-6),) * 2, paper_arm().links[:2], payload=LoadCase(force=(30.0, 0.0, 0.0)),
              play="loaded")  # fmt: skip
    case = error_model(arm).cases[0]
    result = played(case.arrays(np.array([[0.3, 0.4]]), beam_values(beams_of(arm))), case.radii, "loaded", planar=True)
    assert result.vector[0] == pytest.approx([50e-6, 0.0, 0.0], abs=1e-15)


def test_a_slide_in_the_plane_has_play_along_and_across() -> None:
    """Its backlash moves the tip along the rail, its clearance across it."""
    rail = Joint("prismatic", axis=(1.0, 0.0, 0.0), range=(0.0, 0.5), backlash=0.2e-3, clearance=0.05e-3)
    arm = Arm("rail", (rail,), (Link(0.3, mass=0.0),))
    assert worst_error(arm) == pytest.approx(math.hypot(0.1e-3, 0.05e-3), rel=1e-12)
