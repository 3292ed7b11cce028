"""What is not named widens what is: intervals beside small causes, and as they were where there are none."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from linkwright.core.diagnose.fitting.fit import fit
from linkwright.core.diagnose.fitting.refit import refit
from linkwright.core.diagnose.fitting.room.unnamed import unnamed, variances
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.diagnose.search.subsets import products
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.diagnose.by_cosines import file, noise, poses, recording, tips
from tests.diagnose.core_cases import group_of, noise_of, prepared_null, with_residual
from tests.diagnose.fitting.test_fit import within


def half_widths(prepared, members, room):
    return [
        (p.interval[1] - p.interval[0]) / 2.0
        for parameters in refit(prepared, members, (), fit(prepared, members), room).parameters
        for p in parameters
    ]


def room_of(prepared, members):
    return unnamed(prepared, members, (), np.arange(len(prepared.vector)))


def with_small_causes(null, among, count, rng):
    """Noise, and so many of some groups beside it, each of a third of the noise."""
    vector = null.pool.projected(null.observed.whitened(noise_of(null, rng)))
    for k in rng.choice(among, count, replace=False).tolist():
        group = null.pool.groups[k]
        way = rng.normal(size=group.rank)
        amount = np.sqrt(len(vector)) * rng.normal(scale=0.33) / np.linalg.norm(way)
        vector = vector + null.pool.basis[:, group.start : group.stop] @ way * amount
    return with_residual(null, (vector.reshape(null.observed.residual.shape)) * null.observed.scale)


def test_the_variances_are_those_of_the_dense_likelihood():
    """Against the likelihood of the whole covariance matrix, its mean over a grid of its own."""
    rng = np.random.default_rng(3)
    patterns = rng.normal(size=(30, 12)) / np.sqrt(30.0)
    left = patterns @ rng.normal(scale=3.0, size=12) + rng.normal(size=30)
    result, noise = variances(patterns.T @ patterns, patterns.T @ left, float(left @ left), 30, 30, 4.0)

    def likelihood(deviation):
        whole = np.eye(30) + 30.0 * deviation**2 * patterns @ patterns.T
        scale = left @ np.linalg.solve(whole, left) / 30.0
        return multivariate_normal(np.zeros(30), scale * whole).logpdf(left)

    deviations = np.linspace(0.0, 4.0, 400)
    weight = np.exp([likelihood(deviation) for deviation in deviations])
    everything = weight[0] + weight.mean()
    assert result == pytest.approx(30.0 * float(np.mean(weight * deviations**2)) / everything, rel=0.02)
    whole = np.eye(30) + result * patterns @ patterns.T
    assert noise == pytest.approx(float(left @ np.linalg.solve(whole, left)) / 30.0)


def test_intervals_cover_beside_small_causes_that_nobody_names():
    """A dozen causes of a third of the noise each: least squares by itself would be sure of the wrong size."""
    null = prepared_null()
    member = group_of(null, "joint_compliance", (2,))
    rng, trials = np.random.default_rng(21), 60
    own = null.pool.groups[member].candidate.family
    others = [k for k, g in enumerate(null.pool.groups) if not g.candidate.outside and g.candidate.family != own]
    plain, wide = 0, 0
    for _ in range(trials):
        prepared = with_small_causes(null, others, 12, rng)
        for room in (None, room_of(prepared, [member])):
            low, high = refit(prepared, [member], (), fit(prepared, [member]), room).parameters[0][0].interval
            plain, wide = (plain + (low <= 0.0 <= high), wide) if room is None else (plain, wide + (low <= 0.0 <= high))
    assert plain < 0.75 * trials
    assert within(wide, trials=trials)


def chosen(prepared, member, count, taken):
    """A member with so many others, each the one that explains most beside those before."""
    result, pool = [member], prepared.pool
    for _ in range(count):
        gained = products(pool, prepared.vector).beside(pool.columns(result)).gains()
        families = {pool.groups[m].candidate.family for m in result}
        free = [k for k in taken if pool.groups[k].candidate.family not in families]
        result.append(max(free, key=lambda k: gained[k]))
    return result


@pytest.mark.slow
def test_intervals_cover_though_names_were_chosen_to_leave_little():
    """Of a dozen small causes what three names take up is chosen; what is left says that next to nothing else is there,
    and the weak names themselves say that there is; so does the room that is usual where so much was found."""
    null = prepared_null()
    member = group_of(null, "joint_compliance", (2,))
    rng, trials = np.random.default_rng(31), 60
    own = null.pool.groups[member].candidate.family
    others = [k for k, g in enumerate(null.pool.groups) if not g.candidate.outside and g.candidate.family != own]
    covered = dict.fromkeys(("narrow", "sampled", "usual"), 0)
    for _ in range(trials):
        prepared = with_small_causes(null, others, 12, rng)
        members = chosen(prepared, member, 3, others)
        narrow = room_of(prepared, members)
        usual = narrow.at_least(RULES.fitting.least_unnamed)
        for room in (narrow, narrow.no_less_than(room_of(prepared, [member])), usual):
            low, high = refit(prepared, members, (), fit(prepared, members), room).parameters[0][0].interval
            covered[("narrow" if room is narrow else "usual" if room is usual else "sampled")] += low <= 0.0 <= high
    assert covered["narrow"] < 0.85 * trials
    assert within(covered["sampled"], trials=trials)
    assert within(covered["usual"], trials=trials)


@pytest.mark.slow
def test_intervals_cover_beside_one_more_name_that_was_chosen():
    """Of six small causes one was named beside the large one, for it left least."""
    null = prepared_null()
    member = group_of(null, "joint_compliance", (2,))
    rng, trials = np.random.default_rng(33), 80
    own = null.pool.groups[member].candidate.family
    others = [k for k, g in enumerate(null.pool.groups) if not g.candidate.outside and g.candidate.family != own]
    covered = dict.fromkeys(("none", "usual"), 0)
    for _ in range(trials):
        prepared = with_small_causes(null, others, 6, rng)
        members = chosen(prepared, member, 1, others)
        usual = room_of(prepared, members).at_least(RULES.fitting.least_unnamed)
        for name, room in (("none", None), ("usual", usual)):
            low, high = refit(prepared, members, (), fit(prepared, members), room).parameters[0][0].interval
            covered[name] += low <= 0.0 <= high
    assert covered["none"] < 0.85 * trials
    assert within(covered["usual"], trials=trials)


def test_intervals_cover_where_visits_differ():
    """An arm that returns to a pose twice as inexactly as readings of a visit differ: each visit counts once."""
    null = prepared_null(repeats=4)
    member = group_of(null, "joint_compliance", (2,))
    rng, trials, visit = np.random.default_rng(32), 80, null.visits
    plain, wide = 0, 0
    for _ in range(trials):
        apart = 2.0 * null.observed.scale * rng.standard_normal((visit[-1] + 1, null.observed.residual.shape[1]))
        prepared = with_residual(null, noise_of(null, rng) + apart[visit])
        for room in (None, room_of(prepared, [member])):
            low, high = refit(prepared, [member], (), fit(prepared, [member]), room).parameters[0][0].interval
            plain, wide = (plain + (low <= 0.0 <= high), wide) if room is None else (plain, wide + (low <= 0.0 <= high))
    assert plain < 0.75 * trials
    assert within(wide, trials=trials)


def test_intervals_stay_as_they_were_where_nothing_else_is():
    null = prepared_null()
    members = [group_of(null, "encoder_offset", (1,)), group_of(null, "joint_compliance", (2,))]
    rng = np.random.default_rng(22)
    times = []
    for _ in range(40):
        prepared = with_residual(null, noise_of(null, rng))
        wide, plain = half_widths(prepared, members, room_of(prepared, members)), half_widths(prepared, members, None)
        times += [a / b for a, b in zip(wide, plain, strict=True)]
    assert 0.98 < np.median(times) < 1.15


def test_declared_rivals_are_no_causes_beside_the_name():
    null = prepared_null()
    member, rival = group_of(null, "joint_compliance", (2,)), group_of(null, "servo_droop", (2,))
    with_it = unnamed(null, [member], (), np.arange(len(null.vector))).at.size
    without = unnamed(null, [member], (rival,), np.arange(len(null.vector))).at.size
    assert without < with_it


def widths_of(offsets, least):
    """How wide the intervals of encoders' zeros are that are off by so much, by a rule of how much room there is."""
    q = np.repeat(poses(5, 40), 3, axis=0)
    rules = replace(RULES, fitting=replace(RULES.fitting, least_unnamed=least))
    result = diagnose(file(), recording(q, tips(q + np.array(offsets)) + noise(5, len(q))), Options(rules=rules))
    assert [finding.effect for finding in result.findings] == ["encoder_offset"] * np.count_nonzero(offsets)
    return [finding.parameters[0].interval[1] - finding.parameters[0].interval[0] for finding in result.findings]


@pytest.mark.slow
def test_a_second_finding_makes_room_and_one_alone_does_not():
    two = (0.0, 2e-3, 1e-3)
    room = RULES.fitting.least_unnamed
    assert all(wide > 1.1 * narrow for wide, narrow in zip(widths_of(two, room), widths_of(two, 0.0), strict=True))
    assert widths_of((0.0, 2e-3, 0.0), room) == pytest.approx(widths_of((0.0, 2e-3, 0.0), 0.0), rel=1e-9)


def test_a_fit_is_moved_as_its_operator_says():
    null, rng = prepared_null(), np.random.default_rng(8)
    room = room_of(null, [group_of(null, "encoder_offset", (1,))]).at_least(0.2)
    design = rng.normal(size=(len(null.vector), 4)) * np.array([1.0, 1e3, 1e-3, 1.0])
    inverse = np.linalg.inv(design.T @ design)
    turned = np.linalg.cholesky(inverse)
    assert room.beside_fit(turned, design) == pytest.approx(room.beside(inverse @ design.T), rel=1e-9)
