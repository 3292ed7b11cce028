"""The poses asked for next tell names apart better than poses picked at random do."""

from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.arm.avoid.obstacle import frames_and_tips
from linkwright.core.arm.avoid.poses import Room, meets
from linkwright.core.arm.avoid.regions import between, beyond
from linkwright.core.diagnose.answer.next_poses import (  # pyright: ignore[reportPrivateUsage]
    _greedy,
    _noncentrality,
    _Pair,
    _pair,
    _tried,
    _worth_taking,
    next_poses,
)
from linkwright.core.diagnose.fitting.prepare import prepare
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.diagnose.search.aliases import Rival
from linkwright.core.diagnose.search.naming import Namer
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.diagnose.core_cases import group_of, recorded, with_effects
from tests.diagnose.made_diagnosis import made_arm


def narrow(arm, share=0.2):
    """The arm with a small part of its joint ranges, where many things look alike."""
    joints = tuple(replace(j, range=(share * j.range[0], share * j.range[1])) for j in arm.joints)
    return replace(arm, joints=joints)


@pytest.fixture(scope="module")
def asked():
    """Compliance of drive 2 recorded in a corner of the workspace, against what resembles it there."""
    arm = made_arm()
    true = with_effects(arm, ("joint_compliance", (2,), {"compliance": 1e-5}))
    recording = recorded(narrow(true))
    namer = Namer(prepare(observe(arm, recording), Options()), thorough=False, seed=1)
    member = group_of(namer.prepared, "joint_compliance", (1,))
    others = [
        group_of(namer.prepared, "encoder_offset", (1,)),
        group_of(namer.prepared, "joint_compliance", (2,)),
        group_of(namer.prepared, "payload"),
    ]
    return namer, member, others


def test_greedy_choice_beats_random_poses(asked):
    """In the smallest non-centrality over all pairs of names."""
    namer, member, others = asked
    tried = _tried(namer.prepared.observed, Room(), 1)
    width = tried.residual.shape[1]
    pairs = [_pair(namer, tried, [member], member, other) for other in others]
    assert None not in pairs
    taken = _greedy(pairs, width, 6)
    assert len(set(taken)) == len(taken) == 6
    best = min(_noncentrality(pair, taken, width) for pair in pairs)
    rng = np.random.default_rng(1)
    random = []
    for _ in range(40):
        rows = rng.choice(tried.rows, 6, replace=False).tolist()
        random.append(min(_noncentrality(pair, rows, width) for pair in pairs))
    before = min(_noncentrality(pair, [], width) for pair in pairs)
    assert best > 1.5 * np.median(random)
    assert best >= 0.99 * max(random)
    assert best > before


def test_noncentrality_is_what_the_other_name_misses(asked):
    """By hand: least squares of the other name's columns on old and new readings together."""
    namer, member, others = asked
    tried = _tried(namer.prepared.observed, Room(), 1)
    width = tried.residual.shape[1]
    pair = _pair(namer, tried, [member], member, others[0])
    rows = [3, 17]
    at = [width * row + axis for row in rows for axis in range(width)]
    matrix = np.vstack([pair.columns, pair.tried_columns[at]])
    signal = np.concatenate([pair.signal, pair.tried_signal[at]])
    left = signal - matrix @ np.linalg.lstsq(matrix, signal, rcond=None)[0]
    assert _noncentrality(pair, rows, width) == pytest.approx(float(left @ left))


def test_poses_lie_in_the_ranges_and_say_what_they_decide(asked):
    namer, member, others = asked
    rivals = [Rival(other, 0.99, 1.0) for other in others]
    result = next_poses(namer, [member], [(member, rivals)], 1)
    assert len(result.poses) == 6
    for pose in result.poses:
        for value, joint in zip(pose.q, namer.prepared.observed.arm.joints, strict=True):
            assert joint.range[0] <= value <= joint.range[1]
        assert pose.side in (-1, 1)
        assert "compliance of the drives at joint 2 from" in pose.decides
    assert "non-centrality" in result.note
    assert result.enough == ("Record each several times." not in result.note)


def test_exact_aliases_need_another_sensor(asked):
    namer, member, _ = asked
    droop = group_of(namer.prepared, "servo_droop", (1,))
    result = next_poses(namer, [member], [(member, [Rival(droop, 1.0, 0.0)])], 1)
    assert result.poses == ()
    assert not result.enough
    assert "Only another sensor would" in result.note
    assert "non-centrality" not in result.note


def proposed(namer, member, others, avoid=()):
    """The poses asked for, of a recording whose settings name regions to avoid."""
    observed = namer.prepared.observed
    told = replace(observed, recording=replace(observed.recording, avoid=avoid))
    again = namer.with_prepared(replace(namer.prepared, observed=told))
    return next_poses(again, [member], [(member, [Rival(other, 0.99, 1.0) for other in others])], 1)


def test_where_nobody_says_what_to_avoid_poses_stay_where_the_arm_was(asked):
    """Joints and tip, in the box of theirs over the recording: of a corner of the workspace a small one."""
    namer, member, others = asked
    arm, recording = namer.prepared.observed.arm_given, namer.prepared.observed.recording
    result = proposed(namer, member, others)
    there, here = (frames_and_tips(arm, q).reshape(-1, 3) for q in (recording.q, np.array([p.q for p in result.poses])))
    q = np.array([pose.q for pose in result.poses])
    assert (q >= recording.q.min(axis=0) - 1e-4).all()
    assert (q <= recording.q.max(axis=0) + 1e-4).all()
    assert (here >= there.min(axis=0) - 1e-8).all()
    assert (here <= there.max(axis=0) + 1e-8).all()
    assert "not checked for collisions" in result.note


def test_poses_keep_clear_of_what_is_to_be_avoided(asked):
    """Then the whole of the joint ranges is open: with a floor a little below the base half of it."""
    namer, member, others = asked
    arm, floor = namer.prepared.observed.arm_given, beyond("below", "y", -0.15)
    result = proposed(namer, member, others, (floor,))
    q = np.array([pose.q for pose in result.poses])
    assert len(q) == 6
    assert not meets(arm, q, (floor,)).any()
    recorded = frames_and_tips(arm, namer.prepared.observed.recording.q)
    assert np.abs(frames_and_tips(arm, q)).max() > 1.1 * np.abs(recorded[..., 1]).max()
    assert "Nothing else is checked" in result.note
    everywhere = between((-9.0, -9.0, -9.0), (9.0, 9.0, 9.0))
    nothing = proposed(namer, member, others, (everywhere,))
    assert nothing.poses == ()
    assert nothing.note == "What is to be avoided leaves no pose to record next."


def test_no_payload_is_proposed_that_was_not_carried(asked):
    namer, member, others = asked
    carried = namer.prepared.observed.recording.payload_mass
    payloads = {pose.payload_mass for pose in proposed(namer, member, others).poses}
    assert payloads <= {0.0, float(carried.max())}


def test_no_gain_no_advice():
    """A rival of two sizes of which the recorded readings see one: each reading by itself seems to tell (what they do
    not see is left at nought), but with any of them the rival fits all. One that differs is told in any case."""
    rng = np.random.default_rng(5)
    seen, unseen = rng.standard_normal((40, 2)).T
    recorded = rng.standard_normal(12)
    alike = _Pair(
        "this from that", 0.7 * recorded, 0.7 * seen + 0.4 * unseen,
        np.column_stack([recorded, np.zeros(12)]), np.column_stack([seen, unseen]),
    )  # fmt: skip
    differs = replace(alike, label="this from another", tried_signal=alike.tried_signal + rng.standard_normal(40))
    rules = RULES.answer
    assert _worth_taking({(0, 1): alike}, 1, rules) == ([], {})
    taken, helped = _worth_taking({(0, 1): alike, (0, 2): differs}, 1, rules)
    assert list(helped) == [(0, 2)]
    assert len(taken) == 6
    assert _noncentrality(differs, taken, 1) > _noncentrality(differs, [], 1) + 1.0


def test_nothing_is_asked_where_nothing_is_doubtful():
    arm = made_arm()
    result = diagnose(arm, recorded(arm))
    assert result.verdict == "none"
    assert result.next_poses == ()
