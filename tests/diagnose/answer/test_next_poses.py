"""The poses asked for next tell names apart better than poses picked at random do."""

from dataclasses import replace

import numpy as np
import pytest

from diagnose.answer.next_poses import _greedy, _noncentrality, _pair, _tried, next_poses  # pyright: ignore[reportPrivateUsage]
from diagnose.diagnosis import diagnose
from diagnose.fitting.prepare import prepare
from diagnose.options import Options
from diagnose.residual.observe import observe
from diagnose.rules.rules import RULES
from diagnose.search.aliases import Rival
from diagnose.search.naming import Namer
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
    tried = _tried(namer.prepared.observed, 1)
    width = tried.residual.shape[1]
    pairs = [_pair(namer, tried, [member], member, other) for other in others]
    assert None not in pairs
    taken = _greedy(pairs, width, RULES.answer.taken)
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
    tried = _tried(namer.prepared.observed, 1)
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
    poses, note = next_poses(namer, [member], [(member, rivals)], 1)
    assert len(poses) == 6
    for pose in poses:
        for value, joint in zip(pose.q, namer.prepared.observed.arm.joints, strict=True):
            assert joint.range[0] <= value <= joint.range[1]
        assert pose.side in (-1, 1)
        assert "compliance of the drives at joint 2 from" in pose.decides
    assert "non-centrality" in note


def test_exact_aliases_need_another_sensor(asked):
    namer, member, _ = asked
    droop = group_of(namer.prepared, "servo_droop", (1,))
    poses, note = next_poses(namer, [member], [(member, [Rival(droop, 1.0, 0.0)])], 1)
    assert poses == ()
    assert "only another sensor would" in note


def test_nothing_is_asked_where_nothing_is_doubtful():
    arm = made_arm()
    found = diagnose(arm, recorded(arm))
    assert found.verdict == "none"
    assert found.next_poses == ()
