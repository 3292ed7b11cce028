"""Bounds over the poses of a box or path for more joints than a certificate serves: nothing that counts is lost."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.arm.worst.loose_bound import loose_bound
from linkwright.core.arm.worst.search import WorstSearch
from linkwright.core.arm.worst.workspace import Workspace, pull
from tests.arm.builders import arm_of

METAL = "{elastic_modulus: 71 GPa, poisson_ratio: 0.33, density: 2700 kg/m^3}"
SECTION = "{shape: tube, diameter: 80 mm, thickness: 4 mm}"
BOX = Workspace("box", ((0.6, -0.2, 0.0), (1.0, 0.2, 0.0)), None, True)
PATH = Workspace("path", ((0.7, -0.2, 0.0), (0.9, 0.3, 0.0)), None, True)


def five(folder: Path, backlash: str = ""):
    lines = "".join(
        f"  - joint: {{type: revolute, range: [-60 deg, 60 deg], stiffness: 60 kN*m/rad, mass: 1 kg{backlash}}}\n"
        f"    link: {{length: 300 mm, section: {SECTION}, material: {METAL}}}\n"
        for _ in range(5)
    )
    return arm_of(f"chain:\n{lines}payload: {{mass: 3 kg}}\n", folder)


@pytest.mark.parametrize("workspace", [BOX, PATH], ids=["box", "path"])
def test_narrowing_keeps_every_pose_of_the_region(tmp_path: Path, workspace: Workspace) -> None:
    arm = five(tmp_path)
    search, p = WorstSearch(error_model(arm), workspace), beam_values(beams_of(arm))
    cells = search._cells(p)  # pyright: ignore[reportPrivateUsage]
    assert cells is not None
    generator = np.random.default_rng(4)
    poses = search.poses(p, 300)
    # Cells of all sizes around places beside those poses, each with its pose in it.
    half = 10.0 ** generator.uniform(-3.0, -0.2, poses.shape)
    centers = poses + half * generator.uniform(-1.0, 1.0, poses.shape)
    narrower, wide, possible = cells.narrowed(centers, half)
    assert possible.all()
    assert np.all(np.abs(poses - narrower) <= wide + 1e-9)
    assert np.all(wide <= half + 1e-12)
    assert float(np.quantile((wide / half).min(axis=1), 0.1)) < 0.9
    # And what is far from the region is dropped.
    away = search.tip(centers, p)[:, 0] < 0.3
    _, _, left = cells.narrowed(centers[away], np.full_like(centers[away], 1e-3))
    assert not left.any()


@pytest.mark.parametrize("workspace", [BOX, PATH], ids=["box", "path"])
def test_no_pose_of_the_region_is_worse_than_the_bound(tmp_path: Path, workspace: Workspace) -> None:
    arm = five(tmp_path, ", backlash: 1 arcmin")
    model, p = error_model(arm), beam_values(beams_of(arm))
    search = WorstSearch(model, workspace)
    reached = search.worst(p, certify=False).error

    def bound(workspace: Workspace, effort: int) -> float:
        own = WorstSearch(model, workspace)
        cells = own._cells(p)  # pyright: ignore[reportPrivateUsage]
        coordinates = own._coordinates  # pyright: ignore[reportPrivateUsage]
        case = model.cases[0]
        result = loose_bound(case, p, coordinates, reached, planar=True, gap=1e-4, effort=effort, cells=cells)
        assert result is not None
        return result

    confined = bound(workspace, 4_000_000)
    # Places all over the region, from starts all over the joints' ranges.
    generator = np.random.default_rng(8)
    starts = generator.uniform(search.lower, search.upper, (3000, 5))
    share = generator.random((3000, 2))
    one, other = np.array(workspace.points)
    span = share if workspace is BOX else share[:, :1]
    places = one + np.column_stack([np.broadcast_to(span, (3000, 2)), np.zeros(3000)]) * (other - one)
    used = np.array([1.0, 1.0, 0.0])
    q, miss = pull(lambda q: search.motion(q, p), starts, places, search.lower, search.upper, used)
    errors = search.errors(q[miss < 1e-9], p, 0).error
    assert len(errors) > 1000
    assert errors.max() <= confined
    assert reached <= confined
    assert confined <= bound(Workspace(), 4_000_000) * (1.0 + 1e-9)


def test_a_search_says_its_bound_and_that_it_is_no_certificate(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("linkwright.core.arm.worst.search.CONFINED", 4_000_000)
    arm = five(tmp_path)
    p = beam_values(beams_of(arm))
    result = WorstSearch(error_model(arm), BOX).worst(p)
    assert result.upper_bound is not None
    assert result.upper_bound > result.error
    assert not result.certified
    # A design's search wants a gap that this cannot reach, and does not wait for it.
    assert WorstSearch(error_model(arm), BOX, gap=3e-5).worst(p).upper_bound is None
