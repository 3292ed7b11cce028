"""Findings that mean nothing singly: by constructed recordings."""

import numpy as np
import pytest

from linkwright.core.diagnose.answer.sentences import nothing_singly, reading_of
from linkwright.core.diagnose.answer.together import may_be_nothing, only_with
from linkwright.core.diagnose.fitting.fit import fit
from linkwright.core.diagnose.fitting.refit import refit
from tests.diagnose.core_cases import group_of, noise_of, prepared_null, with_residual

OFFSET, GIVES, BENDS = ("encoder_offset", (1,)), ("joint_compliance", (2,)), ("link_bending", (2,))


@pytest.fixture(scope="module")
def null():
    return prepared_null(poses=24)


def refitted(null, moved, seed=1):
    """A fit of an offset, a drive and a link above it that give alike, which move the tip by such lengths (m)."""
    members = [group_of(null, *which) for which in (OFFSET, GIVES, BENDS)]
    residual = noise_of(null, np.random.default_rng(seed))
    for member, size in zip(members, moved, strict=True):
        pattern = null.columns[member][:, :, 0]
        residual = residual + size * pattern / np.sqrt(np.mean(np.sum(pattern**2, axis=1)))
    prepared = with_residual(null, residual)
    return prepared, refit(prepared, members, (), fit(prepared, members))


def test_two_that_only_balance_each_other_are_told(null):
    prepared, result = refitted(null, (1e-4, 0.0, 0.0))
    assert only_with(prepared, result) == {1: (2,), 2: (1,)}
    assert not may_be_nothing(result.parameters[0], result.terms[0].candidate.sizes)


def test_what_moves_more_than_the_mismatch_and_is_balanced_is_told(null):
    """A drive that gives against the bending of the link above it, alike but for a tenth: three times what is left."""
    prepared, result = refitted(null, (0.0, 6e-4, -4e-4))
    moved = [float(np.sqrt(np.mean(np.sum(term.moved**2, axis=1)))) for term in result.terms]
    mismatch = float(np.sqrt(np.mean(np.sum(prepared.observed.residual**2, axis=1))))
    assert min(moved[1:]) > 1.2 * mismatch
    assert only_with(prepared, result) == {1: (2,), 2: (1,)}


def test_what_stands_by_itself_is_left_alone(null):
    prepared, result = refitted(null, (1e-4, 0.0, 0.0))
    alone = refit(prepared, [group_of(null, *OFFSET)], (), fit(prepared, [group_of(null, *OFFSET)]))
    assert only_with(prepared, alone) == {}
    far = group_of(null, "backlash", (2,))
    both = [group_of(null, *OFFSET), far]
    pattern = null.columns[far][:, :, 0]
    moved = with_residual(null, prepared.observed.residual + 1e-4 * pattern / np.abs(pattern).max())
    assert only_with(moved, refit(moved, both, (), fit(moved, both))) == {}
    assert result.terms[1].candidate.effect == "joint_compliance"


def test_it_is_said_in_words(null):
    _, result = refitted(null, (1e-4, 0.0, 0.0))
    said = reading_of(*GIVES[:1], (3,), result.parameters[1], (), "", (("link_bending", (3,)),), nothing=True)
    assert said.endswith("Singly it means nothing: only together with bending of the links at link 3.")
    alone = reading_of(*GIVES[:1], (3,), result.parameters[1], (), nothing=True)
    assert alone.endswith("With room for what is not named, its sizes may be zero.")
    assert nothing_singly([("joint_compliance", (3,)), ("link_bending", (3,))], 2e-6) == (
        "These 2 together move the tip by 0.002 mm RMS. Singly they mean nothing, as others that are named would take "
        "their place: compliance of the drives at joint 3 and bending of the links at link 3."
    )
