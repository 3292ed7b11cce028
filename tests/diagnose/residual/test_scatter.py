"""What looks like a mismatch and is none: an arm that does not come back exactly, noise that remembers long."""

from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.arm.effects import Settings
from linkwright.core.diagnose.recording import since_the_reading_before
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.residual.visits import looks_quieter
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.costs import slow_but
from tests.diagnose.core_cases import SIGMA, recorded
from tests.diagnose.made_diagnosis import made_arm


def returning(recording, arm, rng, scatter):
    """The recording by an arm whose joints stand off by `scatter` (rad) anew at every visit."""
    observed = observe(arm, recording)
    visit = np.unique(observed.block, return_inverse=True)[1]
    tip = recording.tip.copy()
    for index in range(arm.size):
        off = scatter * rng.standard_normal(visit.max() + 1)[visit]
        unit = observed.signature("encoder_offset", Settings((index,), {"offset": 1.0}))
        tip += off[:, None] * unit[:, : tip.shape[1]]
    return replace(recording, tip=tip)


@pytest.mark.parametrize(("visits", "scatter"), [(1, 40e-6), (3, 60e-6)])
def test_an_arm_that_does_not_return_lacks_no_physics(visits, scatter):
    """Readings of one visit agree within the noise, visits do not: seen again (three visits to each pose), or not and
    by less than twice the noise."""
    arm = made_arm()
    plan = {"poses": 60 // visits, "repeats": 3, "payloads": (), "sides": "one", "temperature": None}
    once = [recorded(arm, **{**plan, "seed": 5}) for _ in range(visits)]
    rng = np.random.default_rng(7)
    parts = [replace(item, tip=item.tip + SIGMA * rng.standard_normal(item.tip.shape)) for item in once]
    q = np.concatenate([part.q for part in parts])
    whole = replace(
        parts[0],
        q=q,
        last_moves=since_the_reading_before(q),
        tip=np.concatenate([part.tip for part in parts]),
        sides=np.concatenate([part.sides for part in parts]),
        row=np.arange(1, 1 + sum(part.size for part in parts)),
        time=20.0 * np.arange(sum(part.size for part in parts)),
        sigma=None,
    )
    result = diagnose(arm, returning(whole, arm, rng, scatter))
    assert result.rms_before > (2.0 if visits > 1 else 1.5) * result.noise_floor
    assert result.verdict == "none"
    assert any("does not return" in note for note in result.notes)


def remembering(rng, shape, share):
    """Noise of unit variance of which each reading keeps `share` of the one before."""
    noise = rng.standard_normal(shape)
    for row in range(1, len(noise)):
        noise[row] = share * noise[row - 1] + np.sqrt(1.0 - share**2) * noise[row]
    return noise


@pytest.mark.parametrize("seed", slow_but([0, 8, 9], 8))
def test_noise_with_a_long_memory_is_noise(seed):
    """Repeats of three look half as noisy as they are, and whatever is smooth in time fits."""
    arm = made_arm()
    plain = recorded(arm, poses=33, repeats=3, payloads=(0.0, 5.0), sides="one", temperature=None, seed=seed)
    exact = plain.tip - observe(arm, plain).residual
    rng = np.random.default_rng(seed)
    noisy = replace(plain, tip=exact + SIGMA * remembering(rng, exact.shape, 0.8), sigma=None)
    assert diagnose(arm, noisy).verdict == "none"


def test_repeats_look_quieter_by_what_they_share():
    """Of three readings in a row the sample variance is 1 - (2 r + r^2) / 3 of the true one on average."""
    arm = made_arm()
    plain = recorded(arm, poses=33, repeats=3, payloads=(), sides="one", temperature=None)
    rng = np.random.default_rng(3)
    for share in (0.3, 0.8):
        observed = replace(observe(arm, plain), correlation=share)
        noise = remembering(rng, (30000, 1), share).reshape(-1, 3)
        assert looks_quieter(observed) == pytest.approx(1.0 / np.sqrt(noise.var(axis=1, ddof=1).mean()), rel=0.03)
    assert looks_quieter(observe(arm, plain)) == 1.0
