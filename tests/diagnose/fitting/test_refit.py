"""The joint refit: shapes between the points of the grid, sizes that are not proportional, intervals that cover."""

from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import EffectEntry
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.fitting.fit import fit
from linkwright.core.diagnose.fitting.prepare import prepare
from linkwright.core.diagnose.fitting.refit import impossible_term, refit
from linkwright.core.diagnose.fitting.room.unnamed import unnamed
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.patterns.library import columns_of
from linkwright.core.diagnose.patterns.pool import make_pool
from linkwright.core.diagnose.residual.observe import observe
from tests.diagnose.core_cases import (
    group_of,
    noise_of,
    prepared_null,
    recorded,
    with_effects,
    with_residual,
)
from tests.diagnose.fitting.test_fit import CASES, within
from tests.diagnose.made_diagnosis import made_arm


def refitted(prepared, members):
    return refit(prepared, members, (), fit(prepared, members))


def parameter(found, name, place=0):
    return next(p for p in found.parameters[place] if p.parameter == name)


def of(arm, *entries, **changed):
    """A recording of the arm with effects that the model lacks, prepared."""
    return prepare(observe(arm, recorded(with_effects(arm, *entries), **changed)), Options())


def test_intervals_cover():
    """200 draws of noise over two linear effects: the truth lies in 95 % of the intervals."""
    null = prepared_null()
    members = [group_of(null, "encoder_offset", (1,)), group_of(null, "joint_compliance", (2,))]
    truth = (2e-5, 4e-6)
    rng = np.random.default_rng(11)
    inside = np.zeros(2)
    for _ in range(CASES):
        residual = noise_of(null, rng) + sum(null.columns[m][:, :, 0] * x for m, x in zip(members, truth, strict=True))
        result = refitted(with_residual(null, residual), members)
        for k in range(2):
            low, high = result.parameters[k][0].interval
            inside[k] += low <= truth[k] <= high
    assert within(inside[0])
    assert within(inside[1])


@pytest.mark.slow
def test_intervals_cover_beside_a_lag():
    """The size's interval holds the shape's own uncertainty, and the shape's is its profile's."""
    null = prepared_null(hours=6.0, poses=16, temperature=(293.15, 313.15))
    member = group_of(null, "thermal_expansion", (0, 1, 2), lag=2700.0)
    exact = of(made_arm(), ("thermal_expansion", (1, 2, 3), {"expansion": 15e-6, "lag": 2400.0}), hours=6.0, poses=16,
               temperature=(293.15, 313.15), noise=0.0)  # fmt: skip
    signal = exact.observed.residual
    rng = np.random.default_rng(12)
    trials, inside = 40, np.zeros(2)
    for _ in range(trials):
        result = refitted(with_residual(null, signal + noise_of(null, rng)), [member])
        for k, (name, truth) in enumerate((("expansion", 15e-6), ("lag", 2400.0))):
            low, high = parameter(result, name).interval
            inside[k] += low <= truth <= high
    assert within(inside[0], trials=trials)
    assert within(inside[1], trials=trials)


def test_neighbours_that_tell_as_much_as_one_count_once_against_what_is_usual():
    """By the normal equations, each size held to the largest that is usual as strongly as nine readings count for."""
    null = replace(prepared_null(space=True), together=9)
    member, rng = group_of(null, "axis_misalignment", (1,)), np.random.default_rng(13)
    prepared = with_residual(null, 100.0 * noise_of(null, rng))
    linear = fit(prepared, [member])
    room = unnamed(prepared, [member], (), np.arange(len(prepared.vector)))
    result = refit(prepared, [member], (), linear, room).terms[0]
    usual = [max(map(abs, size.typical)) for size in EFFECTS["axis_misalignment"].sizes]
    white = prepared.pool.projected(prepared.observed.whitened(prepared.columns[member]))
    products = white.T @ white + 9.0 * np.diag((linear.unit / np.array(usual)) ** 2)
    assert result.candidate.sizes == tuple(size.name for size in EFFECTS["axis_misalignment"].sizes)
    assert result.sizes == pytest.approx(np.linalg.solve(products, white.T @ prepared.vector), rel=1e-6)


def test_a_lag_between_the_grid_is_found():
    arm = made_arm()
    entry = ("thermal_expansion", (1, 2, 3), {"expansion": 23e-6, "lag": 2250.0})
    prepared = of(arm, entry, hours=6.0, poses=24, temperature=(293.15, 318.15), noise=2e-6)
    member = group_of(prepared, "thermal_expansion", (0, 1, 2), lag=1800.0)
    result = refitted(prepared, [member])
    lag, expansion = parameter(result, "lag"), parameter(result, "expansion")
    assert lag.value == pytest.approx(2250.0, rel=0.03)
    assert lag.interval[0] < 2250.0 < lag.interval[1]
    assert expansion.value == pytest.approx(23e-6, rel=0.02)
    assert result.rss < 0.9 * fit(prepared, [member]).rss


def test_a_soft_material_is_not_a_small_excess():
    """30 % less modulus bends 43 % more: the size is found, not its linear image."""
    arm = made_arm()
    prepared = of(arm, ("link_modulus", (1, 2, 3), {"excess": -0.3}), payloads=(0.0, 15.0), noise=2e-6)
    member = group_of(prepared, "link_modulus", (0, 1, 2))
    linear = float(fit(prepared, [member]).sizes[0][0])
    assert linear == pytest.approx(-(1.0 / 0.7 - 1.0), rel=0.02)
    result = parameter(refitted(prepared, [member]), "excess")
    assert result.value == pytest.approx(-0.3, abs=0.005)
    assert result.interval[0] <= -0.3 <= result.interval[1]


def hardening_refitted(prepared):
    """The best of the soft knees at joint 2 on the grid, refitted."""
    groups = [
        number
        for number, group in enumerate(prepared.pool.groups)
        if (group.candidate.effect, group.candidate.at) == ("joint_hardening", (1,))
        and group.candidate.shapes["sharp"] == 0.0
    ]
    return refitted(prepared, [min(groups, key=lambda m: fit(prepared, [m]).rss)])


def test_a_knee_of_a_hardening_drive_is_found():
    """The drive turns by milliradians, micrometres of the tip beyond first order: so about what was found."""
    arm = made_arm()
    values = {"compliance": 4e-5, "remaining": 5e-6, "knee": 17.0}
    recording = recorded(
        with_effects(arm, ("joint_hardening", (2,), values)), payloads=(0.0, 10.0), noise=1e-6, poses=32
    )
    first = hardening_refitted(prepare(observe(arm, recording), Options()))
    near = EffectEntry("joint_hardening", (2,), {name: parameter(first, name).value for name in values})
    result = hardening_refitted(prepare(observe(arm, recording, about=(near,)), Options()))
    for name, truth in values.items():
        got = parameter(result, name)
        assert got.value == pytest.approx(truth, rel=0.1)
        assert got.interval[0] <= truth <= got.interval[1]


def test_no_drive_turns_against_its_load():
    """What is left of a drive's give under high load is not less than nought where the arm file calls it rigid."""
    arm = made_arm()
    arm = replace(arm, joints=tuple(replace(joint, stiffness=None) for joint in arm.joints))
    values = {"compliance": 2e-5, "remaining": -3e-6, "knee": 17.0}
    recording = recorded(with_effects(arm, ("joint_hardening", (2,), values)), payloads=(0.0, 10.0), noise=1e-6)
    result = hardening_refitted(prepare(observe(arm, recording), Options()))
    assert {item.parameter for item in result.parameters[0]} == {"compliance", "knee", "sharp"}
    assert 0.0 < parameter(result, "compliance").value < 2e-5
    assert impossible_term(prepare(observe(arm, recording), Options()), result) is None


@pytest.mark.slow
def test_no_windup_pushes_on():
    """Where play runs with the load alone, chance would have the rest of it run the other way: it is held at nought."""
    below = 0
    for seed in range(6):
        values = {"windup": 0.0, "windup_per_load": 1e-5}
        prepared = of(made_arm(), ("friction_windup", (2,), values), noise=2e-5, seed=seed)
        member = group_of(prepared, "friction_windup", (1,))
        below += fit(prepared, [member]).sizes[0][0] < 0.0
        result = refitted(prepared, [member])
        assert all(item.value >= 0.0 for item in result.parameters[0])
        assert parameter(result, "windup_per_load").value == pytest.approx(1e-5, rel=0.3)
    assert 0 < below < 6


def test_a_time_constant_ends_where_the_effect_does():
    """Creep that grows as fast as it began has a time constant beyond any: the greatest that an arm file may hold."""
    prepared = prepared_null(hours=6.0)
    group = prepared.pool.groups[group_of(prepared, "creep", (1,))]
    candidate = replace(group.candidate, shapes={**group.candidate.shapes, "time_constant": 7e5})
    columns, observed = columns_of(prepared.observed, candidate), prepared.observed
    assert columns is not None
    time = np.asarray(observed.state.conditions.loaded_for)
    share = -np.expm1(-time / 7e5)
    growing = columns[:, :, 0] * np.divide(time / 7e5, share, out=np.zeros_like(time), where=share > 0.0)[:, None]
    pool = make_pool(observed.whitened(prepared.beside), [(candidate, observed.whitened(columns), None)])
    alone = with_residual(replace(prepared, pool=pool, columns=(columns,)), 1e-3 * growing)
    result = refitted(alone, [0])
    bounds = next(item for item in EFFECTS["creep"].parameters if item.name == "time_constant")
    assert bounds.lower < parameter(result, "time_constant").value <= bounds.upper
    assert parameter(result, "time_constant").value > 0.9 * bounds.upper


def test_a_shape_that_the_data_do_not_bound_says_so():
    """Without any such effect the lag may be anything."""
    null = prepared_null(hours=4.0)
    member = group_of(null, "thermal_expansion", (0, 1, 2), lag=1800.0)
    low, high = parameter(refitted(null, [member]), "lag").interval
    assert low == 0.0 or high == np.inf


def test_beside_a_size_at_its_bound_the_others_are_fitted_anew():
    """A drive that came out a little stiffer than rigid, by noise, stands at rigid; the next one, which had made up for
    that, is where least squares put it beside a rigid drive."""
    null = prepared_null()
    members = [group_of(null, "joint_compliance", (place,)) for place in (1, 2)]
    one, other = (null.columns[m][:, :, 0] for m in members)
    rigid = -1.0 / 60e3
    error = float(fit(with_residual(null, noise_of(null, np.random.default_rng(4))), members).errors[0][0])
    residual = noise_of(null, np.random.default_rng(4)) + one * (rigid - 1.5 * error) + other * 4e-6
    trial = with_residual(null, residual)
    free, result = fit(trial, members), refitted(trial, members)
    assert float(free.sizes[0][0]) < rigid
    assert parameter(result, "compliance").value == pytest.approx(rigid)
    assert parameter(result, "compliance").at_bound
    white = null.observed.whitened
    design = np.concatenate([white(null.beside), white(null.columns[members[1]])], axis=1)
    wanted = np.linalg.lstsq(design, white(residual - rigid * one), rcond=None)[0][-1]
    apart = abs(float(free.sizes[1][0]) - wanted)
    assert apart > 0.2 * float(free.errors[1][0])
    assert parameter(result, "compliance", 1).value == pytest.approx(wanted, abs=0.1 * apart)


def test_what_a_size_at_its_bound_takes_beyond_its_own_stands_there_too():
    """Beside a drive that is held at rigid the next one would come out stiffer than rigid, where it did not before."""
    null = prepared_null()
    members = [group_of(null, "joint_compliance", (place,)) for place in (1, 2)]
    one, other = (null.columns[m][:, :, 0] for m in members)
    rigid = [-1.0 / float(null.observed.arm.joints[k].stiffness or 0.0) for k in (0, 1)]
    noise, white = noise_of(null, np.random.default_rng(4)), null.observed.whitened
    spread = fit(with_residual(null, noise), members)
    first = rigid[0] - float(spread.sizes[0][0]) - 1.5 * float(spread.errors[0][0])
    design = np.concatenate([white(null.beside), white(other)[:, None]], axis=1)
    taken = float(
        np.linalg.lstsq(design, white((first + float(spread.sizes[0][0]) - rigid[0]) * one), rcond=None)[0][-1]
    )
    assert taken < 0.0
    second = rigid[1] - float(spread.sizes[1][0]) - 0.5 * taken
    trial = with_residual(null, noise + first * one + second * other)
    free, result = fit(trial, members), refitted(trial, members)
    assert float(free.sizes[0][0]) < rigid[0]
    assert float(free.sizes[1][0]) > rigid[1]
    assert [parameter(result, "compliance", place).value for place in (0, 1)] == pytest.approx(rigid)
