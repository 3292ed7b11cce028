"""Linear fits of findings: sizes, their intervals, and what is physically impossible."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import binom

from linkwright.core.diagnose.fitting.fit import (
    bounds,
    displacement,
    fit,
    impossible,
    remaining,
    t_quantile,
    typical,
    why_impossible,
)
from linkwright.core.diagnose.fitting.prepare import prepare
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.materials.catalogue import load_catalogue
from tests.diagnose.core_cases import group_of, noise_of, prepared_null, recorded, with_effects, with_residual
from tests.diagnose.made_diagnosis import made_arm

CASES = 200


@pytest.fixture(scope="module")
def null():
    return prepared_null()


def within(count, share=0.95, trials=CASES):
    """Whether a count is one that chance gives all but once in a thousand times."""
    return binom.ppf(0.0005, trials, share) <= count <= binom.ppf(0.9995, trials, share)


def test_intervals_of_a_linear_fit_cover(null):
    """Two effects at once, 200 draws of noise: the truth lies in 95 % of the intervals."""
    members = [group_of(null, "encoder_offset", (1,)), group_of(null, "joint_compliance", (2,))]
    truth = (2e-5, 4e-6)
    rng = np.random.default_rng(1)
    inside = np.zeros(2)
    for _ in range(CASES):
        residual = noise_of(null, rng) + sum(null.columns[m][:, :, 0] * x for m, x in zip(members, truth, strict=True))
        fitted = fit(with_residual(null, residual), members)
        reach = t_quantile(fitted.freedom)
        for k in range(2):
            inside[k] += abs(fitted.sizes[k][0] - truth[k]) <= reach * fitted.errors[k][0]
    assert within(inside[0])
    assert within(inside[1])


def test_fit_is_least_squares_beside_the_nuisances():
    arm = made_arm()
    free = prepare(observe(arm, recorded(arm, free_frame=True)), Options())
    members = [group_of(free, "encoder_offset", (1,)), group_of(free, "link_length", (0,))]
    fitted = fit(free, members)
    white = free.observed.whitened
    matrix = np.concatenate([white(free.beside), *(white(free.columns[m]) for m in members)], axis=1)
    target = white(free.observed.residual)
    values, _, _, _ = np.linalg.lstsq(matrix, target, rcond=1e-12)
    assert [float(size[0]) for size in fitted.sizes] == pytest.approx(values[-2:].tolist(), rel=1e-6)
    left = target - matrix @ values
    assert fitted.rss == pytest.approx(float(left @ left))
    assert fitted.freedom == len(target) - matrix.shape[1]
    variance = float(left @ left) / fitted.freedom
    covariance = np.linalg.inv(matrix.T @ matrix) * variance
    errors = np.sqrt(np.diag(covariance))[-2:]
    assert [float(error[0]) for error in fitted.errors] == pytest.approx(errors.tolist(), rel=1e-5)
    assert white(remaining(free, fitted)) == pytest.approx(left, abs=1e-6)
    both = displacement(free, fitted, members[:1]) + displacement(free, fitted, members[1:])
    assert both == pytest.approx(displacement(free, fitted), abs=1e-15)


def test_sizes_beyond_their_bounds_are_impossible(null):
    """A drive of 60 kN*m/rad may come out stiffer, but not stiffer than rigid; backlash is not negative."""
    rng = np.random.default_rng(2)
    compliance, backlash = group_of(null, "joint_compliance", (1,)), group_of(null, "backlash", (1,), held_below=0.0)
    low, high = bounds(null.pool.groups[compliance].candidate, "compliance", null)
    assert low == pytest.approx(-1.0 / 60e3)
    for member, possible, not_possible in (
        (compliance, -0.9 / 60e3, -2.0 / 60e3),
        (compliance, 1e-4, 2.0 * high),
        (backlash, 1e-4, -1e-4),
    ):
        for size, works in ((possible, True), (not_possible, False)):
            residual = noise_of(null, rng) + null.columns[member][:, :, 0] * size
            trial = with_residual(null, residual)
            assert (impossible(trial, fit(trial, [member])) is None) is works


def test_no_less_hangs_at_the_tip_than_was_recorded():
    """A file's payload of 2 kg is not there in readings without any: only the last link could be lighter."""
    arm = made_arm()
    for payloads, most in (((0.0, 5.0), 0.0), ((3.0, 5.0), 3.0)):
        prepared = prepare(observe(arm, recorded(arm, payloads=payloads)), Options())
        candidate = prepared.pool.groups[group_of(prepared, "payload")].candidate
        link = math.pi * (0.04**2 - 0.036**2) * 0.3 * 2700.0  # a tube of aluminium
        assert bounds(candidate, "mass", prepared)[0] == pytest.approx(-most - link)


def test_a_link_expands_by_little_more_than_its_material_does():
    """Of aluminium by 69 um/(m*K) at most, of steel by 48; where the file is silent, by what anything does."""
    catalogue, arm = load_catalogue(user=False), made_arm()
    aluminium = catalogue.find("aluminium-6061-t6")
    silent = {name: value for name, value in aluminium.properties.items() if name != "thermal_expansion"}
    for material, most in (
        (aluminium, 3.0 * 23e-6),
        (catalogue.find("steel-s355"), 2.0 * 24e-6),
        (replace(aluminium, properties=silent), 3e-4),
    ):
        links = tuple(replace(link, material=material) for link in arm.links)
        prepared = prepare(observe(replace(arm, links=links), recorded(arm)), Options())
        member = group_of(prepared, "thermal_expansion", (1,), lag=0.0)
        candidate = prepared.pool.groups[member].candidate
        assert bounds(candidate, "expansion", prepared)[1] == pytest.approx(most)
        for size, possible in ((0.9 * most, True), (1.6 * most, False)):
            trial = with_residual(
                prepared, 0.01 * prepared.observed.residual + prepared.columns[member][:, :, 0] * size
            )
            assert (impossible(trial, fit(trial, [member])) is None) is possible


def test_usual_sizes(null):
    candidate = null.pool.groups[group_of(null, "joint_compliance", (1,))].candidate
    assert typical(candidate, np.array([1e-5]))
    assert not typical(candidate, np.array([1e-9]))


def test_two_names_of_one_pattern_share_it_without_an_error_of_their_own(null):
    """servo_droop and joint_compliance are one pattern to the tip: together they fit like one."""
    members = [group_of(null, "joint_compliance", (1,)), group_of(null, "servo_droop", (1,))]
    rng = np.random.default_rng(3)
    trial = with_residual(null, noise_of(null, rng) + null.columns[members[0]][:, :, 0] * 1e-5)
    both, one = fit(trial, members), fit(trial, members[:1])
    assert both.rss == pytest.approx(one.rss, rel=1e-6)
    assert both.sizes[0][0] + both.sizes[1][0] == pytest.approx(one.sizes[0][0], rel=1e-3)


def test_a_true_effect_is_found_at_its_size():
    arm = made_arm()
    prepared = prepare(observe(arm, recorded(with_effects(arm, ("encoder_offset", (2,), {"offset": 1e-4})))), Options())
    fitted = fit(prepared, [group_of(prepared, "encoder_offset", (1,))])
    assert abs(fitted.sizes[0][0] - 1e-4) <= 4.0 * fitted.errors[0][0]
    assert fitted.unit == pytest.approx(1.0, abs=0.25)


def test_no_more_hangs_on_a_link_than_its_mass_allows(null):
    """A link of known mass carries a usual extra (5 kg) and as much again as it weighs, however badly that shows."""
    candidate = null.pool.groups[group_of(null, "link_mass", (1,))].candidate
    own = float(null.observed.state.links[1].beam.mass)
    for mass, possible in ((5.0 + 0.9 * own, True), (5.0 + 1.1 * own, False)):
        sizes = np.array([mass if name == "mass" else 0.0 for name in candidate.sizes])
        reason = why_impossible(null, candidate, sizes, np.abs(sizes), 0.0)
        assert (reason is None) is possible


def test_no_link_weighs_nothing(null):
    """A tenth of what the file says is left of it at least; at the tip all of the payload recorded may be lacking."""
    link = null.pool.groups[group_of(null, "link_mass", (1,))].candidate
    own = float(null.observed.state.links[1].beam.mass)
    assert bounds(link, "mass", null)[0] == pytest.approx(-0.9 * own)
    bending = null.pool.groups[group_of(null, "link_bending", (1,))].candidate
    beam = null.observed.state.links[1].beam
    softest = min(item for item in (beam.flexural_rigidity_height, beam.flexural_rigidity_width) if item is not None)
    assert bounds(bending, "flexibility", null)[0] == pytest.approx(-1.0 / softest)  # a link may be rigid
    tip = null.pool.groups[group_of(null, "payload", ())].candidate
    last = float(null.observed.state.links[2].beam.mass)
    least = float(np.min(null.observed.recording.payload_mass))
    assert bounds(tip, "mass", null)[0] == pytest.approx(-least - last)


def test_no_more_hangs_at_the_tip_than_an_arm_lifts(null):
    """What its links weigh, or what hangs on the last one: a usual 5 kg and as much as it weighs."""
    candidate = null.pool.groups[group_of(null, "payload", ())].candidate
    own = [float(link.beam.mass) for link in null.observed.state.links]
    at_the_tip = own[-1] + null.observed.arm_given.payload.mass
    most = max(sum(own), 5.0 + own[-1], 3.0 + at_the_tip)
    for mass, possible in ((0.95 * most, True), (1.05 * most, False)):
        reason = why_impossible(null, candidate, np.array([mass]), np.array([mass]), 0.0)
        assert (reason is None) is possible


def test_what_hangs_on_the_last_link_of_a_light_arm_may_hang_at_its_tip(null):
    """Three kilograms of links lift no 5 kg by weight, yet a hose of that weight is usual on the last one."""
    observed = null.observed
    bare = replace(observed.arm, payload=replace(observed.arm.payload, mass=0.0))
    light = replace(null, observed=replace(observed, arm=bare))
    tip = null.pool.groups[group_of(null, "payload", ())].candidate
    last = null.pool.groups[group_of(null, "link_mass", (2,))].candidate
    own = float(observed.state.links[2].beam.mass)
    assert sum(float(link.beam.mass) for link in observed.state.links) < 4.0
    for mass, possible in ((4.9 + own, True), (5.1 + own, False)):
        on_the_link = np.array([mass if name == "mass" else 0.0 for name in last.sizes])
        assert (why_impossible(light, last, on_the_link, np.abs(on_the_link), 0.0) is None) is possible
        assert (why_impossible(light, tip, np.array([mass]), np.array([mass]), 0.0) is None) is possible
