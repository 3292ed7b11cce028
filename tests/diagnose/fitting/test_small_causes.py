"""Causes too small to be named: seen through their covariance, what is left of them is noise; other physics stays."""

import numpy as np
import pytest

from linkwright.core.diagnose.answer.guard.lack_of_fit import refuted_by, refutes
from linkwright.core.diagnose.fitting.fit import fit, remaining
from linkwright.core.diagnose.fitting.held_out import HeldOut, hardest, splits
from linkwright.core.diagnose.fitting.room.small_causes import _directions, noise_of_visits, small_causes, with_room
from linkwright.core.diagnose.fitting.room.unnamed import others_of
from linkwright.core.diagnose.patterns.pool import orthonormal
from linkwright.core.diagnose.rules.rules import RULES
from tests.diagnose.core_cases import group_of, noise_of, prepared_null, with_residual


@pytest.fixture(scope="module")
def null():
    """Noise alone, read twice at each of 80 visits of an arm in the plane."""
    return prepared_null(poses=40, sides="one", payloads=(0.0, 5.0))


def holding(null, rng, count, each, member=None):
    """The same arm's recording of noise and so many small causes, each moving the tip by `each` times the noise's RMS,
    beside a large one of a group."""
    vector = null.pool.projected(null.observed.whitened(noise_of(null, rng)))
    library = [k for k, g in enumerate(null.pool.groups) if not g.candidate.outside]
    families = {null.pool.groups[k].candidate.family: k for k in rng.permutation(library).tolist()}
    if member is not None:
        families.pop(null.pool.groups[member].candidate.family)
        vector = vector + 5.0 * np.sqrt(len(vector)) * null.pool.basis[:, null.pool.groups[member].start]
    for k in rng.choice(list(families.values()), count, replace=False).tolist():
        group = null.pool.groups[k]
        way = rng.normal(size=group.rank)
        amount = np.sqrt(len(vector)) * each / np.linalg.norm(way)
        vector = vector + null.pool.basis[:, group.start : group.stop] @ way * amount
    return with_residual(null, vector.reshape(null.observed.residual.shape) * null.observed.scale)


def covariance(prepared, members, size, *, beside):
    """The dense covariance of noise of unit variance and of every other family, moving `size` times the noise's RMS."""
    at, weight, _ = others_of(prepared, members, ())
    patterns = prepared.pool.basis[:, at] * weight
    names = orthonormal(prepared.pool.basis[:, prepared.pool.columns(members)]) if beside else None
    patterns = patterns if names is None else patterns - names @ (names.T @ patterns)
    return np.eye(len(patterns)) + len(patterns) * size**2 * patterns @ patterns.T


def test_with_room_sums_of_squares_are_those_of_generalised_least_squares(null):
    """Against the dense covariance, inverted as a whole."""
    member = group_of(null, "joint_compliance", (1,))
    prepared = holding(null, np.random.default_rng(1), 0, 0.0)
    roomy = with_room(prepared, [member], least=0.1)
    inverse = np.linalg.inv(covariance(prepared, (), 0.1, beside=False))
    trial = [member, group_of(null, "payload")]
    columns, vector = prepared.pool.basis[:, prepared.pool.columns(trial)], prepared.vector
    result = np.linalg.solve(columns.T @ inverse @ columns, columns.T @ inverse @ vector)
    left = vector - columns @ result
    assert fit(roomy, trial).rss == pytest.approx(float(left @ inverse @ left), rel=1e-9)
    assert fit(roomy, trial).rss < fit(prepared, trial).rss


def test_no_room_is_made_where_nothing_speaks_for_it(null):
    prepared = holding(null, np.random.default_rng(2), 0, 0.0)
    assert with_room(prepared, [group_of(null, "joint_compliance", (1,))]) is prepared


def test_what_is_left_is_seen_through_the_covariance_of_small_causes(null):
    """The whitened remainder less `beyond_noise` is its product with the covariance's inverse root, less `likeliest`
    its product with the inverse: both by the dense matrix."""
    member = group_of(null, "joint_compliance", (1,))
    prepared = holding(null, np.random.default_rng(3), 12, 0.4, member)
    causes = small_causes(prepared, [member], (), noise_of_visits(prepared))
    largest = float(np.max(causes.variance))
    names = orthonormal(prepared.pool.basis[:, prepared.pool.columns([member])])
    left = prepared.vector - names @ (names.T @ prepared.vector)
    whole = covariance(prepared, [member], 1.0, beside=True) - np.eye(len(left))
    values, vectors = np.linalg.eigh(whole * largest / np.linalg.eigvalsh(whole)[-1])
    for taken, power in ((causes.beyond_noise, 0.5), (causes.likeliest, 1.0)):
        white = prepared.pool.projected(prepared.observed.whitened(taken))
        white -= names @ (names.T @ white)
        dense = vectors @ ((vectors.T @ left) / (1.0 + np.maximum(values, 0.0)) ** power)
        np.testing.assert_allclose(left - white, dense, atol=2e-3 * np.linalg.norm(left) / np.sqrt(len(left)))


def refuted(prepared, members, small=None):
    """Whether readings of one pose refute the fit of some groups, or those held out do, by the rules of the answer."""
    observed, fitted = prepared.observed, fit(prepared, members)
    parts = [prepared.beside, *(prepared.columns[m] for m in members)]
    tethers = [None] * len(parts)
    if small is not None:
        parts, tethers = [*parts, small.columns], [*tethers, np.ones(small.columns.shape[2])]
    held_out = HeldOut(observed, parts, hardest(splits(observed, 0)), tethers, nuisances=1)
    width = observed.components
    parameters = prepared.pool.nuisance.shape[1] + sum(prepared.pool.groups[m].rank for m in members)
    result = refuted_by(
        observed,
        remaining(prepared, fitted)[:, :width],
        held_out,
        parameters,
        seed=0,
        rules=RULES,
        small=small,
    )
    return refutes(result, RULES)


@pytest.mark.slow
def test_a_right_name_beside_small_causes_is_refuted_alone_and_not_with_room_for_them(null):
    """Ten causes of a third of the noise each beside one of five times: one in three is refuted alone."""
    member = group_of(null, "joint_compliance", (1,))
    rng, alone, roomy = np.random.default_rng(4), 0, 0
    for _ in range(40):
        prepared = holding(null, rng, 10, 0.33, member)
        causes = small_causes(prepared, [member], (), noise_of_visits(prepared))
        alone += refuted(prepared, [member])
        roomy += refuted(prepared, [member], causes)
    assert alone >= 6
    assert roomy <= 3


@pytest.mark.parametrize(("size", "least"), [(1.2, 0.4), (2.0, 1.0)])
def test_what_no_entry_of_the_library_does_stays_beyond_noise(null, size, least):
    """So many times the noise of one joint off in a part of its travel, at whatever place of it, beside a right name.
    Of 1.2 times, as much as small causes make together, much is still told; of more than these make, all."""
    member = group_of(null, "joint_compliance", (1,))
    forms = [k for k, g in enumerate(null.pool.groups) if g.candidate.effect == "joint_in_part_of_travel"]
    rng, told, trials = np.random.default_rng(5), 0, 20
    names = orthonormal(null.pool.basis[:, null.pool.columns([member])])
    for _ in range(trials):
        prepared = holding(null, rng, 0, 0.0, member)
        group = null.pool.groups[int(rng.choice(forms))]
        added = null.pool.basis[:, group.start : group.stop] @ rng.normal(size=group.rank)
        added -= names @ (names.T @ added)
        added *= size * np.sqrt(len(added)) / np.linalg.norm(added)
        moved = added.reshape(null.observed.residual.shape) * null.observed.scale
        prepared = with_residual(prepared, prepared.observed.residual + moved)
        causes = small_causes(prepared, [member], (), noise_of_visits(prepared))
        told += refuted(prepared, [member], causes)
    assert told >= least * trials


@pytest.mark.parametrize("turned", [False, True])
def test_directions_are_those_of_the_singular_values(turned):
    """By products of the shorter side, of observations or of patterns, two of which are one here."""
    rng = np.random.default_rng(6)
    tall = rng.standard_normal((60, 12))
    tall[:, 5] = 2.0 * tall[:, 3]
    patterns = tall.T if turned else tall
    u, s, vt = _directions(patterns)
    assert len(s) == 11
    np.testing.assert_allclose(u.T @ u, np.eye(11), atol=1e-9)
    np.testing.assert_allclose((u * s) @ vt, patterns, atol=1e-9)
    np.testing.assert_allclose(np.sort(s), np.sort(np.linalg.svd(tall, compute_uv=False))[1:], rtol=1e-9)


def test_too_few_repeats_tell_no_noise():
    assert noise_of_visits(prepared_null(repeats=1)) is None
