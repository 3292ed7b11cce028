"""Held-out rows: a fold's readings take no part in the fit that they are judged by."""

import numpy as np
import pytest

from linkwright.core.diagnose.fitting.held_out import (
    HeldOut,
    folds_of_rivals,
    parts_of_workspace,
    residual_held_out,
    rms_held_out,
    splits,
)
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.residual.visits import poses
from tests.diagnose.core_cases import group_of, noise_of, prepared_null, with_residual
from tests.diagnose.recorded import planar_arm, planar_tip


@pytest.fixture(scope="module")
def null():
    return prepared_null()


def columns_of(prepared):
    return [prepared.columns[group_of(prepared, "encoder_offset", (k,))] for k in range(3)]


@pytest.mark.parametrize("name", ["pose blocks", "random rows", "time blocks", "payloads"])
def test_a_fold_does_not_see_itself(null, name):
    """Whatever the readings of a fold are, what is predicted for them stays the same; for others it does not."""
    folds = splits(null.observed, 1)[name]
    rng = np.random.default_rng(1)
    width = null.observed.components
    residual = null.observed.residual
    predicted = residual[:, :width] - residual_held_out(null.observed, columns_of(null), folds)
    for fold in np.unique(folds):
        out = folds == fold
        changed = residual.copy()
        changed[out] += 1e-3 * rng.standard_normal(changed[out].shape)
        other = with_residual(null, changed)
        again = changed[:, :width] - residual_held_out(other.observed, columns_of(null), folds)
        assert again[out] == pytest.approx(predicted[out], abs=1e-15)
        assert np.abs(again[~out] - predicted[~out]).max() > 1e-6


def test_held_out_by_hand(null):
    """Least squares of the other folds' rows, each column divided by its scale."""
    folds = splits(null.observed, 1)["pose blocks"]
    design = np.concatenate(columns_of(null), axis=2)
    scale = null.observed.scale
    by_hand = null.observed.tip_residual().copy()
    for fold in range(folds.max() + 1):
        kept = folds != fold
        matrix = (design / scale[:, None])[kept].reshape(-1, 3)
        target = (null.observed.residual / scale)[kept].reshape(-1)
        values = np.linalg.inv(matrix.T @ matrix) @ matrix.T @ target
        by_hand[~kept] -= (design @ values)[~kept][:, :2]
    assert residual_held_out(null.observed, columns_of(null), folds) == pytest.approx(by_hand, rel=1e-6, abs=1e-12)


def test_without_columns_nothing_is_fitted(null):
    folds = splits(null.observed, 1)["random rows"]
    assert (residual_held_out(null.observed, [], folds) == null.observed.tip_residual()).all()


def test_folds_keep_together_what_belongs_together(null):
    """All readings of a pose are in one fold of `pose blocks`, of a payload in one of `payloads`."""
    result = splits(null.observed, 1)
    pose = poses(null.observed)
    assert pose.max() + 1 == 12
    for number in range(12):
        assert len(np.unique(result["pose blocks"][pose == number])) == 1
    assert len(np.unique(result["pose blocks"])) == 5
    assert (result["payloads"] == (null.observed.recording.payload_mass > 1.0)).all()
    assert (np.diff(result["time blocks"]) >= 0).all()
    for name in ("random rows", "time blocks"):
        assert np.bincount(result[name]).tolist() == pytest.approx([len(pose) / 5] * 5, abs=1)


def test_held_out_rms_of_noise_is_a_little_above_it(null):
    """k coefficients on n observations raise it by about (1 + k/n)."""
    rng = np.random.default_rng(2)
    folds = splits(null.observed, 1)["random rows"]
    ratio = []
    for _ in range(40):
        trial = with_residual(null, noise_of(null, rng))
        own = np.sqrt(np.mean(np.sum(trial.observed.tip_residual() ** 2, axis=1)))
        ratio.append(rms_held_out(trial.observed, columns_of(null), folds) / own)
    assert 1.0 < np.mean(ratio) < 1.05


def test_better_by_is_the_difference_over_its_scatter_between_groups(null):
    """A true part lowers what is held out by many standard errors, one that is not there by next to none."""
    true, other = columns_of(null)[:2]
    residual = true[:, :, 0] * 1e-4 + noise_of(null, np.random.default_rng(5))
    observed = with_residual(null, residual).observed
    held, pose = HeldOut(observed, [true, other], splits(observed, 1)["pose blocks"]), poses(observed)
    errors = [np.sum(held.residual(parts) ** 2, axis=1) for parts in ([0], [])]
    each = np.array([np.sum((errors[1] - errors[0])[pose == k]) for k in np.unique(pose)])
    assert held.better_by([0], [], pose) == pytest.approx(each.sum() / (each.std(ddof=1) * np.sqrt(len(each))))
    assert held.better_by([0], [], pose) > 3.0
    assert held.better_by([0, 1], [0], pose) < 1.0
    assert held.better_by([0], [0], pose) == 0.0


def test_what_is_held_out_is_made_of_parts_of_the_workspace(null):
    part, fold = parts_of_workspace(null.observed), splits(null.observed, 1)["pose blocks"]
    assert len(np.unique(part)) > len(np.unique(fold))
    assert all(len(np.unique(fold[part == k])) == 1 for k in np.unique(part))
    assert all(len(np.unique(part[poses(null.observed) == k])) == 1 for k in np.unique(poses(null.observed)))


def test_rivals_are_judged_between_poses_where_these_are_few(null):
    """Whole poses are left out, and none of the parts of the workspace with several; of many poses, whole parts are."""
    folds = splits(null.observed, 1)
    part, fold, pose = parts_of_workspace(null.observed), folds_of_rivals(null.observed, folds), poses(null.observed)
    assert all(len(np.unique(fold[pose == k])) == 1 for k in np.unique(pose))
    several = [k for k in np.unique(part) if len(np.unique(pose[part == k])) > 1]
    assert several
    assert all(len(np.unique(fold[part == k])) > 1 for k in several)
    along = np.linspace(0.2, 1.2, 300)[:, None] * np.array([1.0, -0.5, 0.3])
    line = observe(planar_arm(), Recording("a line", along, planar_tip(along), np.arange(1, 301)))
    folds = splits(line, 1)
    assert (folds_of_rivals(line, folds) == folds["pose blocks"]).all()


def test_of_few_poses_each_is_left_out_by_itself():
    """Gathered into five parts, three of seven poses that lie close together went at once, and what was left of a plan
    told a compliance no more."""
    rng = np.random.default_rng(6)
    visited = np.concatenate([rng.uniform(0.3, 0.32, (3, 3)), rng.uniform(0.6, 1.5, (4, 3)) * [[1], [-1], [1], [-1]]])
    q = np.repeat(visited, 3, axis=0)
    observed = observe(planar_arm(), Recording("seven poses", q, planar_tip(q), np.arange(1, len(q) + 1)))
    folds = splits(observed, 1)["pose blocks"]
    assert np.bincount(folds).tolist() == [3] * 7
    assert (folds == poses(observed)).all()


def test_what_one_fold_alone_tells_of_the_readings_is_its_own(null):
    """A point that only one fold touches lies wherever that fold's readings have it: held out, they come out as the
    fit of that fold alone leaves them, wherever it lies; a cause that one fold alone shows is foretold by nothing."""
    folds = splits(null.observed, 1)["pose blocks"]
    rows, parts, width = *null.observed.residual.shape, null.observed.components
    place = np.zeros((rows, parts, width))
    place[folds == 2, :width] = np.eye(width)
    shift = np.tensordot(place, np.array([3e-3, -2e-3]), 1)
    moved = with_residual(null, null.observed.residual + shift).observed
    cause = columns_of(null)
    known, asked = ([place, *cause], {"nuisances": 1})
    held = residual_held_out(null.observed, known, folds, **asked)
    assert residual_held_out(moved, known, folds, **asked) == pytest.approx(held, abs=1e-12)
    plain = residual_held_out(null.observed, cause, folds)
    out = folds == 2
    assert held[~out] == pytest.approx(residual_held_out(null.observed, known, folds)[~out], abs=1e-15)
    others = np.concatenate(cause, axis=2)[~out] / null.observed.scale[:, None]
    target = null.observed.residual[~out] / null.observed.scale
    values = np.linalg.lstsq(others.reshape(-1, 3), target.reshape(-1), rcond=None)[0]
    missed = (null.observed.residual - np.concatenate(cause, axis=2) @ values)[out, :width]
    assert held[out] == pytest.approx(missed - missed.mean(axis=0), abs=1e-12)
    assert np.linalg.norm(residual_held_out(moved, known, folds)[out] - plain[out], axis=1).min() > 1e-3
    drawn = (null.observed.residual + shift)[..., None]
    by_draws = HeldOut(null.observed, known, folds, **asked).rms_of(drawn)
    assert by_draws == pytest.approx([np.sqrt(np.mean(np.sum(held**2, axis=1)))], rel=1e-9)
