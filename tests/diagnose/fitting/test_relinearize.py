"""Sizes fitted about the arm as they make it: right however many readings there are, by springs in balance."""

from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.fitting.fit import fit
from linkwright.core.diagnose.fitting.prepare import Prepared, packed_up, set_up
from linkwright.core.diagnose.fitting.refit import refit
from linkwright.core.diagnose.fitting.relinearize import relinearized
from linkwright.core.diagnose.patterns.library import Candidate, columns_of
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.sections import Tube
from tests.diagnose.recorded import planar_arm, poses, sagging_tip

STIFFNESS = np.array([400.0, 250.0, 150.0])
SIGMA = 15e-6

ZERO = ("encoder_offset", (1,), "offset")
SOFT = ("joint_compliance", (1,), "compliance")
HEAVY = ("payload", (), "mass")
SIZES = {ZERO: 0.9e-3, SOFT: 4e-4, HEAVY: 0.3}


def soft_arm() -> Arm:
    """Three joints that sag by 20 mm under what they carry."""
    arm = planar_arm()
    joints = tuple(replace(j, stiffness=float(k)) for j, k in zip(arm.joints, STIFFNESS, strict=True))
    return replace(arm, joints=joints, gravity=(0.0, -9.81, 0.0))


def prepared(count: int, causes: tuple[tuple[str, tuple[int, ...], str], ...], seed: int, sigma: float) -> Prepared:
    """Readings of the arm with these causes, ready for the fit of them alone."""
    rng = np.random.default_rng(seed)
    q, payload = poses(count, seed), rng.choice([0.5, 1.5], count)
    zeros, give = np.zeros(3), 1.0 / STIFFNESS
    zeros[1] = SIZES[ZERO] if ZERO in causes else 0.0
    give[1] += SIZES[SOFT] if SOFT in causes else 0.0
    tip = sagging_tip(q + zeros, 1.0 / give, payload + (SIZES[HEAVY] if HEAVY in causes else 0.0))
    tip = tip + sigma * rng.standard_normal(tip.shape)
    recording = Recording("r.csv", q, tip, np.arange(1, count + 1), payload_mass=payload)
    observed = observe(soft_arm(), recording, scale=np.full(2, SIGMA))
    wanted = [Candidate(effect, at, (size,), {}) for effect, at, size in causes]
    patterns = [(candidate, columns_of(observed, candidate)) for candidate in wanted]
    return set_up(observed, packed_up((candidate, columns) for candidate, columns in patterns if columns is not None))


def off(found, causes):
    """How far each size is from what was planted, as a share of it, and its interval."""
    names = [(term.candidate.effect, term.candidate.at) for term in found.terms]
    told = dict(zip(names, (parameter[0] for parameter in found.parameters), strict=True))
    return {cause: (told[cause[:2]].value / SIZES[cause] - 1.0, told[cause[:2]].interval) for cause in causes}


@pytest.mark.parametrize("causes", [(ZERO,), (SOFT,), (HEAVY,), (ZERO, SOFT), (SOFT, HEAVY), (ZERO, SOFT, HEAVY)])
def test_readings_without_noise_give_the_sizes_themselves(causes):
    """Whatever turns what the loads bend, and whatever loads bend what gives more than the file says."""
    ready, members = prepared(60, causes, 1, 0.0), range(len(causes))
    result = relinearized(ready, members, ())
    for share, _ in off(result.refit, causes).values():
        assert abs(share) < 1e-5
    first = refit(ready, members, (), fit(ready, members))
    assert max(abs(share) for share, _ in off(first, causes).values()) > 1e-3


@pytest.mark.parametrize("count", [200, 2000, pytest.param(10000, marks=pytest.mark.slow)])
def test_intervals_hold_what_was_planted_however_many_readings(count):
    causes, held = (ZERO, SOFT), 0
    for seed in range(5):
        ready = prepared(count, causes, seed, SIGMA)
        result = off(relinearized(ready, range(2), ()).refit, causes)
        held += sum(low < SIZES[cause] < high for cause, (_, (low, high)) in result.items())
    # Of ten intervals of 95 %; fewer than eight would be one chance in ninety.
    assert held >= 8


def test_to_first_order_ten_thousand_readings_are_sure_of_a_wrong_size():
    """What the one above would say, were sizes fitted about the arm file alone."""
    ready = prepared(10000, (ZERO, SOFT), 0, SIGMA)
    low, high = off(refit(ready, (0, 1), (), fit(ready, (0, 1))), (SOFT,))[SOFT][1]
    assert not low < SIZES[SOFT] < high


def test_a_link_that_would_give_less_than_nothing_ends_at_finite_sizes():
    """No modulus makes a link push against its load: the fit stays among numbers, and what it leaves is said."""
    metal = load_catalogue(user=False).find("aluminium-6061-t6")
    arm = replace(
        soft_arm(), links=tuple(replace(link, section=Tube(0.04, 0.002), material=metal) for link in soft_arm().links)
    )
    count = 60
    recording = Recording("r.csv", poses(count, 1), np.zeros((count, 2)), np.arange(1, count + 1))
    observed = observe(arm, recording, scale=np.full(2, SIGMA))
    stiffer = Candidate("link_modulus", (1,), ("excess",), {})
    columns = columns_of(observed, stiffer)
    assert columns is not None
    observed = replace(observed, residual=1.2 * columns[:, :, 0])
    ready = set_up(observed, packed_up([(stiffer, columns)]))
    result = refit(ready, (0,), (), fit(ready, (0,)))
    assert np.isfinite(result.terms[0].sizes).all()
    assert result.terms[0].sizes[0] > 1.0
    assert 0.0 < result.rss < np.inf
