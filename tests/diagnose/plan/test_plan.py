"""Plans: what is chosen is seen smaller than at random, the promise is kept by the diagnosis, boxes are kept clear."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from linkwright.core.arm.avoid.obstacle import frames_and_tips
from linkwright.core.arm.avoid.poses import NoRoom, Room, approach, meets, room_of
from linkwright.core.arm.avoid.regions import between
from linkwright.core.arm.chain.chain import Link
from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.diagnose.plan.design import Patterns, _Score, chosen_visits
from linkwright.core.diagnose.plan.order import in_order, returns_of, with_time
from linkwright.core.diagnose.plan.plan_request import Asked, seen_axes
from linkwright.core.diagnose.plan.planning import NothingToSee, plan
from linkwright.core.diagnose.plan.promise import _sound, promised, rivals_of
from linkwright.core.diagnose.plan.simulate import Plan, simulate
from linkwright.core.diagnose.plan.tried import tried_visits
from linkwright.core.diagnose.plan.written import plan_text, read_plan, to_record
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.diagnose.search.aliases import likenesses
from linkwright.core.diagnose.search.naming import Namer
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.diagnose.core_cases import with_effects
from tests.diagnose.instruments.six_joint_arm import six_joint_arm
from tests.diagnose.made_diagnosis import made_arm

FAST = replace(RULES, plan=replace(RULES.plan, tried=64, rivals=3, passes=1), search=replace(RULES.search, draws=199))
ASKED = Asked(24, (("backlash", ()), ("joint_compliance", ())), payloads=(0.0, 5.0), rules=FAST)


def silent(what, share):
    del what, share


@pytest.fixture(scope="module")
def found():
    return plan(made_arm(), ASKED, silent)


def test_sizes_are_smaller_than_at_random(found):
    """On average clearly, and no cause's by much larger; no fewer pairs are told apart, but for one in a hundred."""
    ratio = np.array([found.at_random(item) / item.smallest for item in found.promise.shown])
    assert {item.effect for item in found.promise.shown} == {"backlash", "joint_compliance"}
    assert np.exp(np.mean(np.log(ratio))) > 1.25
    assert ratio.min() > 0.75
    told, pairs = found.separated_at_random
    assert found.promise.separated * pairs >= 0.99 * told * found.promise.pairs


def test_the_promise_is_of_the_readings_alone(found):
    """The same readings in a new file promise the same; twice the noise, twice the sizes."""
    again = promised(found.arm, found.recording, found.axes, ASKED)
    assert again == found.promise
    louder = promised(found.arm, found.recording, found.axes, replace(ASKED, sigma=2 * ASKED.sigma))
    sizes = {(item.effect, item.at): item.smallest for item in louder.shown}
    assert [sizes[item.effect, item.at] for item in again.shown] == pytest.approx(
        [2.0 * item.smallest for item in again.shown], rel=1e-3
    )


def measured(arm, found):
    """What is recorded at a plan's readings."""
    return simulate(arm, Plan(1, at=found.recording, noise=ASKED.sigma, seed=3)).recording


@pytest.mark.parametrize(
    ("effect", "at"), [("joint_compliance", (2,)), pytest.param("backlash", (1,), marks=pytest.mark.slow)]
)
def test_what_is_promised_is_found(found, effect, at):
    """Planted at twice the smallest size, measured at the plan's readings, a diagnosis sees it; at a fifth not, and by
    its own account it would see what was promised."""
    each = next(one for one in found.promise.shown if (one.effect, one.at) == (effect, at))
    large, small = (
        diagnose(
            found.arm, measured(with_effects(found.arm, (effect, at, {each.parameter: times * each.smallest})), found)
        )
        for times in (2.0, 0.2)
    )
    assert large.verdict in ("named", "alias_class")
    names = [(one.effect, one.at) for finding in large.findings for one in (finding, *finding.alternatives)]
    assert (effect, at) in names
    assert small.verdict == "none"
    own = next(one for one in small.detectable if (one.effect, one.at) == (effect, at))
    assert own.value == pytest.approx(each.smallest, rel=0.25)


def test_rivals_are_as_alike_as_the_diagnosis_says(found):
    """The likeness of a pattern that is all there is, from the search's own aliases."""
    prepared = _sound(found.arm, found.recording, found.axes, ASKED)
    number = next(k for k, g in enumerate(prepared.pool.groups) if g.candidate.effect == "joint_compliance")
    group = prepared.pool.groups[number]
    rivals = rivals_of(prepared, number, "compliance", ASKED)
    signal = replace(prepared, vector=prepared.pool.basis[:, group.start])
    shared, _ = likenesses(Namer(signal, thorough=False, seed=1), [number], number)
    assert rivals
    for rival in rivals:
        own = [
            float(shared[k])
            for k, other in enumerate(prepared.pool.groups)
            if (other.candidate.effect, other.candidate.numbers) == (rival.effect, rival.at)
        ]
        assert min(abs(rival.likeness - value) for value in own) < 1e-6


def test_the_file_is_the_recording(found, tmp_path):
    """Blank where the tip is to be filled in, all else read back; a plan that was measured is read as one too."""
    path = tmp_path / "plan.csv"
    path.write_text(plan_text(found.recording, found.arm, found.axes), encoding="utf-8")
    rows = path.read_text(encoding="utf-8").splitlines()
    assert rows[0].endswith(",payload_kg,x_mm,y_mm")
    assert all(row.endswith(",,") for row in rows[1:])
    read = read_plan(path, found.arm)
    assert read.q == pytest.approx(found.recording.q, abs=1e-8)
    for name in ("sides", "payload_mass", "time"):
        assert getattr(read, name) == pytest.approx(getattr(found.recording, name))


def test_time_tells_drift_from_place(found):
    """Returns to one pose in all parts of the recording, payloads in blocks, no joint that goes with time."""
    visits = found.visits
    assert found.with_time == pytest.approx(with_time(visits.q, visits.sides))
    assert found.with_time < 0.25
    back = [k - 1 for k in found.returns]
    assert len(back) == 4
    assert np.ptp(visits.q[back], axis=0).max() == 0.0
    assert back[-1] - back[0] > 0.4 * visits.size
    assert np.count_nonzero(np.diff(visits.payload_mass)) <= 3
    low, high = np.array([joint.range for joint in found.arm.joints]).T
    assert ((visits.q > low) & (visits.q < high)).all()


def test_orders_of_one_payload_return_in_the_middle():
    arm, asked = made_arm(), replace(ASKED, payloads=(2.0,))
    tried = tried_visits(arm, asked)
    count = asked.poses - returns_of(asked)
    order = in_order(range(1, count + 1), [0], tried.payload, tried.q, tried.sides, asked).tolist()
    assert len(order) == asked.poses
    assert [place for place, visit in enumerate(order) if visit == 0] == [0, 11, 23]


@pytest.mark.parametrize("instrument", ["x", "tracker"])
def test_an_instrument_sees_its_components(instrument):
    """The information of x and y add up, by the patterns themselves."""
    arm, asked = made_arm(), replace(ASKED, instrument=instrument, poses=12)
    tried = tried_visits(arm, asked)
    made = to_record(arm, tried, np.arange(12), asked)
    axes = seen_axes(instrument, arm)
    prepared = _sound(arm, made, axes, asked)
    assert len(prepared.vector) == 36 * len(axes)
    number = next(k for k, g in enumerate(prepared.pool.groups) if g.candidate.effect == "encoder_offset")
    columns = prepared.columns[number][:, : len(axes), 0] / asked.sigma
    assert prepared.pool.groups[number].length[0] == pytest.approx(np.linalg.norm(columns))


def test_out_of_the_plane_there_is_nothing_to_see():
    with pytest.raises(ValueError, match="out of the plane"):
        plan(made_arm(), replace(ASKED, instrument="z"), silent)
    with pytest.raises(NothingToSee):
        plan(made_arm(), replace(ASKED, effects=(("thermal_expansion", ()),)), silent)


BOX = ((0.5, 0.2, -0.1), (0.8, 0.7, 0.1))
REGION = between(*BOX)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_boxes_are_met_where_points_of_the_arm_are_inside(seed):
    """By points along the links, from the tips of the arm cut off behind each of them; a hair aside of the edges."""
    arm, rng = made_arm(), np.random.default_rng(seed)
    arm = arm.with_links(tuple(Link(link.length, mass=1.0) for link in arm.links))  # lines, of no known section
    q = rng.uniform([joint.range[0] for joint in arm.joints], [joint.range[1] for joint in arm.joints])
    ends = [np.zeros(3)]
    for count in range(1, arm.size + 1):
        cut = replace(arm, joints=arm.joints[:count], links=arm.links[:count], tool=(0.0, 0.0, 0.0), effects=())
        ends.append(tip_position(cut, q[:count])[0])
    share = np.linspace(0.0, 1.0, 2001)[:, None]
    points = np.concatenate([one + share * (other - one) for one, other in pairwise(ends)])
    low, high = np.array(BOX)
    depth = np.minimum(points - low, high - points).min(axis=1).max()  # of the deepest point within all planes
    if abs(depth) > 1e-3:
        assert bool(meets(arm, q[None, :], (REGION,))[0]) == bool(depth > 0.0)


def test_poses_keep_clear_of_boxes():
    arm, asked = made_arm(), replace(ASKED, room=Room((REGION,)))
    free, kept = tried_visits(arm, ASKED), tried_visits(arm, asked)
    assert meets(arm, free.q, (REGION,)).any()
    assert not meets(arm, kept.q, (REGION,)).any()
    everywhere = Room((between((-9.0, -9.0, -9.0), (9.0, 9.0, 9.0)),))
    with pytest.raises(NoRoom, match="leaves 0 poses"):
        tried_visits(arm, replace(ASKED, room=everywhere))


def test_a_plan_after_a_recording_stays_where_that_was():
    """Joints and tip in the box of theirs, there and where they are come from; a small one holds poses enough."""
    arm = made_arm()
    recorded = np.random.default_rng(4).uniform(0.2, 0.6, (12, arm.size))
    room = room_of(arm, recorded)
    held = np.concatenate([frames_and_tips(arm, recorded), np.zeros((12, 1, 3))], axis=1).reshape(-1, 3)
    result = tried_visits(arm, replace(ASKED, room=room))
    run = approach(arm)
    for q in (result.q, result.q + run, result.q - run):
        points = frames_and_tips(arm, q)
        assert (points >= held.min(axis=0) - 1e-8).all()
        assert (points <= held.max(axis=0) + 1e-8).all()
    assert result.size >= 4 * FAST.plan.tried


def turning_wrist():
    """Six axes that may each turn once around and back, as those of many robots."""
    arm = six_joint_arm()
    return replace(arm, joints=tuple(replace(joint, range=(-2.0 * np.pi, 2.0 * np.pi)) for joint in arm.joints))


@pytest.mark.parametrize("instrument", ["tracker", "same_point"])
@pytest.mark.parametrize("seed", range(4))
def test_no_pose_leaves_the_recorded_box_of_joints(instrument, seed):
    """Where the joints may turn around, as a turn that puts all frames back where they were recorded must not; a joint
    that stood still stays so."""
    arm, rng = turning_wrist(), np.random.default_rng(seed)
    middle, half = rng.uniform(-4.0, 4.0, arm.size), rng.uniform(0.8, 1.8, arm.size)
    half[rng.integers(arm.size)] = 0.0
    recorded = middle + rng.uniform(-1.0, 1.0, (60, arm.size)) * half
    asked = replace(ASKED, poses=6, instrument=instrument, room=room_of(arm, recorded), seed=seed)
    q = tried_visits(arm, asked).q
    written = np.deg2rad(1e-3)
    assert (q >= recorded.min(axis=0) - written).all()
    assert (q <= recorded.max(axis=0) + written).all()


def random_patterns(rng, visits=40, columns=7, nuisances=2):
    rows = rng.standard_normal((visits, 2, columns)) * rng.uniform(0.2, 3.0, visits)[:, None, None]
    own = columns - nuisances
    against = np.ones((own, own), dtype=bool) & ~np.eye(own, dtype=bool)
    rivals = tuple(slice(k, k + 1) for k in range(own))
    return Patterns(rows, nuisances, np.zeros((columns, columns)), np.arange(own), rivals, against, 13.0)


def test_slopes_are_those_of_the_score():
    """By small shares of each visit added."""
    patterns = random_patterns(np.random.default_rng(5))
    score = _Score(patterns, RULES.plan)
    total = score.beforehand + score.of(range(12))
    by_shares = [(score(total) - score(total + 1e-6 * score.of([visit]))) / 1e-6 for visit in range(40)]
    assert score._slopes(total) == pytest.approx(np.array(by_shares), rel=1e-3)


def test_the_score_is_of_least_squares():
    """What shows of a column beside nuisances and a rival is what a regression on those leaves of it."""
    patterns = random_patterns(np.random.default_rng(6))
    score = _Score(patterns, replace(RULES.plan, known=1e-12))
    total = score.beforehand + score.of(range(20))
    flat = patterns.rows[:20].reshape(-1, 7)
    _, told, _, _ = score._shown(total)
    for index in range(5):
        for rival in range(5):
            if index != rival:
                beside = flat[:, [0, 1, 2 + rival]]
                left = flat[:, 2 + index] - beside @ np.linalg.lstsq(beside, flat[:, 2 + index])[0]
                assert told[index, rival] == pytest.approx(float(left @ left), rel=1e-6)


def test_exchange_betters_any_choice_at_random():
    rng = np.random.default_rng(7)
    patterns = random_patterns(rng)
    score = _Score(patterns, RULES.plan)
    chosen, back, _ = chosen_visits(patterns, 10, lambda _: (), RULES.plan, rng, lambda _: None)
    assert back == []
    assert len(set(chosen)) == 10
    reached = score(score.beforehand + score.of(chosen))
    others = [score(score.beforehand + score.of(rng.permutation(40)[:10])) for _ in range(200)]
    assert reached < min(others)


@pytest.mark.parametrize("heard", [10, 13])
def test_an_interrupt_of_the_exchange_leaves_the_visits_that_stand(heard):
    """No fewer than were asked for, none twice, and no worse than before the exchange; earlier there is no plan."""
    patterns, score = random_patterns(np.random.default_rng(7)), RULES.plan
    steps = []

    def stops(share):
        steps.append(share)
        if len(steps) == heard + 1:
            raise KeyboardInterrupt

    chosen, _, stopped = chosen_visits(patterns, 10, lambda _: (), score, np.random.default_rng(7), stops)
    greedy, _, whole = chosen_visits(
        patterns, 10, lambda _: (), replace(score, passes=0), np.random.default_rng(7), lambda _: None
    )
    assert (stopped, whole) == (True, False)
    assert len(set(chosen)) == 10
    reached = _Score(patterns, score)
    assert reached(reached.beforehand + reached.of(chosen)) <= reached(reached.beforehand + reached.of(greedy))


def test_an_interrupt_before_there_are_visits_enough_leaves_nothing():
    def stops(_):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        chosen_visits(
            random_patterns(np.random.default_rng(7)), 10, lambda _: (), RULES.plan, np.random.default_rng(7), stops
        )
