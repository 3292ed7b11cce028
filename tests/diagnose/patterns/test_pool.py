"""Candidates as subspaces: projection, what is seen and what is not."""

import numpy as np
import pytest

from linkwright.core.diagnose.patterns.pool import (
    exchanged,
    inverse_root,
    length_along,
    make_pool,
    orthonormal,
    triangle,
    with_group,
)
from linkwright.core.diagnose.search.subsets import products
from linkwright.core.executors.shared import packed, unpacked
from tests.diagnose.core_cases import pattern, random_pool


def projected_by_hand(beside, vectors):
    return vectors - beside @ np.linalg.lstsq(beside, vectors, rcond=None)[0]


def test_groups_are_orthonormal_and_free_of_nuisances():
    rng = np.random.default_rng(1)
    pool, columns, beside = random_pool(rng, (1, 3, 2, 4))
    assert pool.nuisance.T @ pool.basis == pytest.approx(0.0, abs=1e-12)
    for group, part in zip(pool.groups, columns, strict=True):
        basis = pool.basis[:, group.start : group.stop]
        assert basis.T @ basis == pytest.approx(np.eye(group.rank), abs=1e-12)
        left = projected_by_hand(beside, part)
        assert basis @ (basis.T @ left) == pytest.approx(left, abs=1e-10)  # the same span
        seen = np.linalg.svd(left, compute_uv=False)[0] / np.linalg.svd(part, compute_uv=False)[0]
        assert group.visible <= 1.0
        if group.rank == 1:
            assert group.visible == pytest.approx(seen)
    assert pool.gram == pytest.approx(pool.basis.T @ pool.basis, abs=1e-12)
    vector = rng.standard_normal(60)
    assert pool.projected(vector) == pytest.approx(projected_by_hand(beside, vector), abs=1e-12)


def test_coefficients_become_sizes_again():
    rng = np.random.default_rng(2)
    pool, columns, beside = random_pool(rng, (1, 3), columns=[rng.standard_normal((60, d)) * 1e-4 for d in (1, 3)])
    for group, part in zip(pool.groups, columns, strict=True):
        sizes = rng.standard_normal(part.shape[1])
        coefficients = pool.basis[:, group.start : group.stop].T @ projected_by_hand(beside, part @ sizes)
        assert group.back @ coefficients == pytest.approx(sizes, rel=1e-9)


def test_what_the_nuisances_swallow_is_not_seen():
    rng = np.random.default_rng(3)
    beside = rng.standard_normal((40, 3))
    inside = beside @ rng.standard_normal((3, 2))
    half = np.column_stack([inside[:, 0], rng.standard_normal(40)])
    pool = make_pool(beside, [(pattern("in", 2), inside, None), (pattern("half", 2), half, None)])
    assert [group.candidate.effect for group in pool.groups] == ["half"]
    assert [candidate.effect for candidate in pool.invisible] == ["in"]
    assert pool.groups[0].rank == 1
    empty = make_pool(beside, [(pattern("in", 2), inside, None)])
    assert empty.groups == ()
    assert empty.basis.shape == (40, 0)


def test_a_size_that_would_not_be_seen_at_its_bound_is_left():
    """At its physical bound the pattern must be worth more than noise: five standard deviations in all."""
    rng = np.random.default_rng(4)
    column = rng.standard_normal((50, 1))
    column /= np.linalg.norm(column)
    none = np.zeros((50, 0))
    for bound, seen in ((4.0, False), (6.0, True)):
        pool = make_pool(none, [(pattern("x"), column, np.array([bound]))])
        assert bool(pool.groups) is seen
        assert bool(pool.invisible) is not seen


def test_one_more_group_is_as_if_it_had_been_there():
    rng = np.random.default_rng(5)
    pool, columns, beside = random_pool(rng, (1, 2, 3))
    patterns = [(group.candidate, part, None) for group, part in zip(pool.groups, columns, strict=True)]
    grown = with_group(make_pool(beside, patterns[:2]), *patterns[2])
    assert grown.gram == pytest.approx(pool.gram, abs=1e-12)
    assert [(g.start, g.stop) for g in grown.groups] == [(g.start, g.stop) for g in pool.groups]
    swallowed = with_group(grown, pattern("in"), beside[:, :1], None)
    assert len(swallowed.groups) == 3


def test_orthonormal_drops_what_repeats():
    columns = np.array([[1.0, 2.0, 0.0], [0.0, 0.0, 1e-9], [0.0, 0.0, 0.0]])
    assert orthonormal(columns).shape == (3, 2)
    assert orthonormal(np.zeros((3, 2))).shape == (3, 0)


@pytest.mark.parametrize("repeated", [False, True])
def test_a_root_of_the_inverse_leaves_out_what_repeats(repeated):
    """As the pseudoinverse, whether a triangle of the columns serves or one of them is another."""
    columns = np.random.default_rng(3).standard_normal((40, 5))
    columns /= np.linalg.norm(columns, axis=0)
    if repeated:
        columns[:, 4] = columns[:, 1]
    gram = columns.T @ columns
    root = inverse_root(gram)
    assert root.shape == (5, 4 if repeated else 5)
    assert root @ root.T == pytest.approx(np.linalg.pinv(gram, rcond=1e-9, hermitian=True), abs=1e-9)


def test_length_along_is_that_on_an_orthonormal_basis():
    rng = np.random.default_rng(4)
    columns = rng.normal(size=(40, 6)) * np.array([1.0, 1e6, 1e-6, 1.0, 1.0, 0.0])
    columns[:, 4] = columns[:, 0] + 1e-6 * columns[:, 1]
    vector = rng.normal(size=40)
    basis = orthonormal(columns)
    assert basis.shape[1] == 4
    assert length_along(columns, vector) == pytest.approx(np.linalg.norm(basis.T @ vector), rel=1e-9)
    assert length_along(np.zeros((40, 2)), vector) == 0.0
    assert orthonormal(np.zeros((3, 0))).shape == (3, 0)


@pytest.mark.parametrize("rows", [3, 5, 41, 700])
def test_a_triangle_of_blocks_is_that_of_all_rows(rows):
    """Unlike a Gram matrix it keeps what is small: columns of a size of 1e-9 beside others."""
    columns = np.random.default_rng(rows).standard_normal((rows, 5)) * [1.0, 1e-9, 1e3, 1.0, 1.0]
    columns[:, 4] = columns[:, 0] + 1e-9 * columns[:, 4]
    found, whole = triangle(columns), np.linalg.qr(columns, mode="r")
    assert found.shape == whole.shape
    assert np.abs(found) == pytest.approx(np.abs(whole), rel=1e-5, abs=1e-14)


def test_pools_that_grow_from_one_do_not_disturb_each_other():
    """What is put behind a pool's columns once is not written over by what is put there again."""
    rng = np.random.default_rng(9)
    pool, _, _ = random_pool(rng, (1, 2, 3))
    more = [rng.standard_normal((60, 2)) for _ in range(2)]
    one, other = (with_group(pool, pattern(name, 2), item, None) for name, item in zip("ab", more, strict=True))
    further = with_group(one, pattern("c", 2), more[1], None)
    for wider, each in ((one, more[0]), (other, more[1]), (further, more[1])):
        assert wider.gram == pytest.approx(wider.basis.T @ wider.basis, abs=1e-12)
        last = wider.groups[-1]
        basis = wider.basis[:, last.start : last.stop]
        left = projected_by_hand(pool.nuisance, each)
        assert basis @ (basis.T @ left) == pytest.approx(left, abs=1e-10)
    assert np.shares_memory(pool.basis, one.basis)
    sent = unpacked(packed(one))
    assert with_group(sent, pattern("c", 2), more[1], None).gram == pytest.approx(further.gram, abs=1e-12)


def test_groups_exchanged_are_as_if_the_pool_were_new():
    rng = np.random.default_rng(10)
    pool, columns, beside = random_pool(rng, (1, 2, 3))
    fresh = [(pattern("new", 2), rng.standard_normal((60, 2)), None), (pattern("in", 1), beside[:, :1], None)]
    result = exchanged(pool, (0, 2), fresh)
    kept = [(pool.groups[k].candidate, columns[k], None) for k in (0, 2)]
    anew = make_pool(beside, [*kept, *fresh])
    assert [group.candidate for group in result.groups] == [group.candidate for group in anew.groups]
    assert [candidate.effect for candidate in result.invisible] == ["in"]
    vector = pool.projected(rng.standard_normal(60))
    assert products(result, vector).gains() == pytest.approx(products(anew, vector).gains(), rel=1e-9)
