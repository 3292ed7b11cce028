"""What was named is held to what its fit has not seen: of several findings those that do not carry over go."""

import numpy as np
import pytest

from linkwright.core.diagnose.answer.confirmation import Confirmed
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.residual.noise import noise_floor
from linkwright.core.diagnose.search.naming import Named, Namer
from tests.diagnose.core_cases import group_of, noise_of, prepared_null, with_residual

OFFSET, PLAY, GIVES = ("encoder_offset", (1,)), ("backlash", (2,)), ("joint_compliance", (0,))


@pytest.fixture(scope="module")
def many_poses():
    return prepared_null(poses=40)


def named_in(null, sizes, seed=3):
    """What is left of names of these sizes, in RMS of the noise, once they are held to readings held out."""
    rng = np.random.default_rng(seed)
    members = tuple(group_of(null, *which) for which in sizes)
    residual = noise_of(null, rng)
    level = float(np.sqrt(np.mean(np.sum(residual**2, axis=1))))
    for member, size in zip(members, sizes.values(), strict=True):
        moved = null.columns[member] @ np.ones(null.columns[member].shape[2])
        residual = residual + size * level * moved / np.sqrt(np.mean(np.sum(moved**2, axis=1)))
    prepared = with_residual(null, residual)
    namer = Namer(prepared, thorough=False, seed=1)
    named = Named(members, (), (0.001,) * len(members), namer.test((), 99), None)
    noise = noise_floor(prepared.observed.recording, prepared.observed.arm)
    result = Confirmed(namer, named, noise, Options(), whole=None, progress=lambda *_: None)
    return [result.prepared.pool.groups[member].candidate.effect for member in result.members], result


def test_what_is_there_is_kept_and_what_only_fits_goes(many_poses):
    effects, result = named_in(many_poses, {OFFSET: 5.0, PLAY: 0.0, GIVES: 0.0})
    assert effects == ["encoder_offset"]
    assert len(result.unconfirmed) == 2


def test_several_that_carry_over_stay_small_ones_too(many_poses):
    effects, result = named_in(many_poses, {OFFSET: 5.0, PLAY: 0.7})
    assert len(effects) == 2
    assert not result.unconfirmed


def test_few_poses_tell_nothing_of_what_carries_over():
    """Twelve poses are too few parts of the workspace to drop a finding for; it would have to do harm."""
    _, result = named_in(prepared_null(), {OFFSET: 5.0, PLAY: 0.7, GIVES: 0.0})
    assert not result.unconfirmed


@pytest.mark.slow
def test_what_moves_next_to_nothing_beside_others_goes():
    """A fifth of the noise floor and less; all there is stays, however small, since it was tested against nothing."""
    effects, result = named_in(prepared_null(), {OFFSET: 5.0, PLAY: 0.7, GIVES: 0.0})
    assert sorted(effects) == ["backlash", "encoder_offset"]
    assert result.too_little
    effects, result = named_in(prepared_null(), {GIVES: 0.1})
    assert len(effects) == 1
