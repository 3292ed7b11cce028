"""Held-out readings are unseen, and the fits behind the figures are least squares."""

from pathlib import Path

import numpy as np
import pytest

from benchmarks.real import splits
from benchmarks.real.data import VARIABLE, NoDataError, data_folder
from benchmarks.real.model import Equations, Part, fitted, held_out, mean_rms_mm, moved, rms_mm
from benchmarks.real.pulls import with_pulls

pytestmark = pytest.mark.slow


def _parts(rows: int, *widths: int, seed: int = 0) -> list[Part]:
    rng = np.random.default_rng(seed)
    return [Part(f"part {k}", "", rng.normal(size=(rows, 3, w)), np.full(w, np.inf)) for k, w in enumerate(widths)]


def test_whole_groups_stay_together() -> None:
    groups = np.repeat(np.arange(40), 7)
    folds = splits.dealt(groups, 3)
    assert set(folds) == set(range(splits.FOLDS))
    assert all(len(set(folds[groups == group])) == 1 for group in range(40))


def test_blocks_are_stretches() -> None:
    folds = splits.blocks(103)
    assert np.all(np.diff(folds) >= 0)
    assert np.ptp(np.bincount(folds)) <= 1


def test_cells_hold_neighbouring_angles() -> None:
    q = np.radians([[1.0, 2.0], [14.0, 14.0], [16.0, 2.0], [-1.0, 2.0]])
    by_cell = [splits.angle_cells(q, (0, 1), 15.0, seed) for seed in range(30)]
    assert all(folds[0] == folds[1] for folds in by_cell)
    assert any(folds[0] != folds[2] for folds in by_cell)
    assert any(folds[0] != folds[3] for folds in by_cell)


def test_fit_is_least_squares() -> None:
    parts = _parts(60, 2, 3)
    residual = 1e-3 * np.random.default_rng(1).normal(size=(60, 3))
    design = np.concatenate([part.columns for part in parts], axis=2).reshape(180, 5)
    expected = residual.reshape(180) - design @ np.linalg.lstsq(design, residual.reshape(180), rcond=None)[0]
    left = residual - moved(parts, fitted(residual, parts))
    np.testing.assert_allclose(left.reshape(180), expected, atol=1e-12)


def test_held_out_readings_are_fitted_without_them() -> None:
    parts = _parts(50, 2, 2)
    residual = 1e-3 * np.random.default_rng(2).normal(size=(50, 3))
    folds = splits.rows(50, 0)
    left = held_out(residual, parts, folds)
    for fold in range(splits.FOLDS):
        seen = folds != fold
        expected = residual - moved(parts, fitted(residual, parts, seen))
        np.testing.assert_allclose(left[~seen], expected[~seen], atol=1e-12)
    assert mean_rms_mm(left, folds) > rms_mm(Equations(residual, parts).left())


def test_what_rows_do_not_tell_stays_usual() -> None:
    rows = 200
    rng = np.random.default_rng(3)
    columns = rng.normal(size=(rows, 3, 1))
    twins = np.concatenate([columns, columns * (1.0 + 1e-5 * rng.normal(size=columns.shape))], axis=2)
    part = Part("twins", "", twins, np.full(2, 1e-3))
    residual = 1e-3 * columns[:, :, 0] + 1e-4 * rng.normal(size=(rows, 3))
    sizes = fitted(residual, [part])[0]
    assert np.abs(sizes).max() < 2e-3
    assert sizes.sum() == pytest.approx(1e-3, rel=0.05)


def test_pulls_are_remembered_until_the_servo_is_sent_elsewhere(tmp_path: Path) -> None:
    source = tmp_path / "servo.csv"
    rows = ["2047,1748,2347", "2047,2142,2347", "2047,1748,2347", "2047,1748,1947", "2047,1748,2347", "2147,1748,2347"]
    source.write_text("\n".join(["target pos (5),pos (3),pos (4)", *rows]) + "\n", encoding="utf-8")
    (tmp_path / "out").mkdir()
    lines = with_pulls(source, tmp_path / "out").read_text(encoding="utf-8").split("\n")[1:-1]
    assert [line.split(",")[3:] for line in lines] == [
        ["0", "0"],
        ["-1", "1"],
        ["-1", "0"],
        ["1", "1"],
        ["1", "0"],
        ["0", "0"],
    ]


def test_missing_recordings_are_said(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv(VARIABLE, str(tmp_path / "nowhere"))
    with pytest.raises(NoDataError, match=r"docs/real-machines\.md"):
        data_folder()
