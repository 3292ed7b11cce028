"""Pushes in closed form on two links in a plumb plane: when, on which link, how much; and none where there is none."""

import numpy as np
import pytest

from linkwright.core.diagnose.motion.diagnosis import diagnose_motion
from linkwright.json.motion import motion_json
from linkwright.results.document import Section
from linkwright.results.motion.answer import answer
from linkwright.results.motion.described import describe
from tests.costs import slow_but
from tests.diagnose.motion.plumb_arm import FORE, HAND, UPPER, logged, plumb_arm, rough

CONTACT, COLLISION = (8.0, 10.5), (12.0, 12.15)
"""From when to when (s)."""
STEP = 0.1
"""s: rows are 0.08 s apart, and the low-pass is of 4 Hz."""
SHORT = 0.02
"""s: two samples."""


def push(force, span, along=1.0):
    """What a force (2,) N takes of both joints (2, N) while it acts on the second link, so far `along` it: -J^T f."""

    def more(q, _):
        on = (np.arange(len(q[0])) / 100.0 >= span[0]) & (np.arange(len(q[0])) / 100.0 < span[1])
        elbow = UPPER * np.array([-np.sin(q[0]), np.cos(q[0])])
        beyond = along * FORE * np.array([-np.sin(q[0] + q[1]), np.cos(q[0] + q[1])])
        return -np.array([force @ (elbow + beyond), force @ beyond]) * on

    return more


def diagnosed(tmp_path, seed, more_of):
    """A load that stays, and what comes beside it."""
    return diagnose_motion(plumb_arm(tmp_path), [logged(seed, lambda t: np.full_like(t, HAND), more_of)])


@pytest.mark.parametrize(("seed", "along"), [pytest.param(1, 1.0, marks=pytest.mark.slow), (2, 0.5)])
def test_a_contact(tmp_path, seed, along):
    """At the tip, and half way along the link: when, which link and joints, and how much; nothing else is named."""
    force = np.array([12.0, 16.0])
    result = diagnosed(tmp_path, seed, push(force, CONTACT, along))
    assert (result.verdict, result.findings, result.unknown) == ("none", (), None)
    (event,) = result.events
    assert (event.kind, event.links, event.joints) == ("contact", (2,), (1, 2))
    assert (event.change.start.time, event.change.end.time) == pytest.approx(CONTACT, abs=STEP)
    (size,) = event.change.parameters
    assert size.interval[0] <= np.linalg.norm(force) <= size.interval[1]
    assert size.value == pytest.approx(np.linalg.norm(force), rel=0.2)


def test_a_collision_is_said_and_set_aside(tmp_path):
    """Of 0.15 s: on the screen and in the JSON; what is left is what is left of the rest."""
    result = diagnosed(tmp_path, 1, push(np.array([0.0, 150.0]), COLLISION))
    (event,) = result.events
    assert (event.kind, event.links, result.verdict) == ("collision", (2,), "none")
    said = motion_json(result)["events"]
    assert [(item["kind"], item["links"], item["effect"]) for item in said] == [("collision", [2], "push")]
    assert (said[0]["start_s"], said[0]["end_s"]) == pytest.approx(COLLISION, abs=SHORT)
    assert answer(result).lower().startswith("collision at link 2 from")
    assert "Events in the log" in [item.title for item in describe(result).items if isinstance(item, Section)]
    assert result.rms_after == pytest.approx(diagnosed(tmp_path, 1, lambda q, _: 0.0 * q).rms_after, rel=0.3)


@pytest.mark.parametrize(
    ("seed", "span"),
    [
        pytest.param(1, (12.0, 12.15), marks=pytest.mark.slow),
        (2, (12.034, 12.184)),
        pytest.param(4, (9.01, 9.36), marks=pytest.mark.slow),
    ],
)
def test_how_hard_a_collision_is(tmp_path, seed, span):
    """A push that is shorter than what the low-pass of 4 Hz blurs is told with its full force and its instants, by
    samples of 0.01 s: cut to its window after the low-pass it would be half of that."""
    force = np.array([120.0, -90.0])
    (event,) = diagnosed(tmp_path, seed, push(force, span)).events
    (size,) = event.change.parameters
    assert size.interval[0] <= 150.0 <= size.interval[1]
    assert size.value == pytest.approx(150.0, rel=0.1)
    for instant, true in zip((event.change.start, event.change.end), span, strict=True):
        assert instant.interval[0] <= true <= instant.interval[1]
        assert instant.time == pytest.approx(true, abs=SHORT)


@pytest.mark.parametrize(
    ("seed", "force", "span"), [(3, (120.0, -90.0), (7.0, 7.1)), (36, (60.0, 81.0), (22.9, 23.03))]
)
def test_what_acts_for_a_tenth_of_a_second_is_no_load(tmp_path, seed, force, span):
    """A mass that is taken for as long has more numbers, and may explain as much."""
    (event,) = diagnosed(tmp_path, seed, push(np.array(force), span)).events
    assert (event.kind, event.links) == ("collision", (2,))
    assert event.change.start.time == pytest.approx(span[0], abs=STEP)


@pytest.mark.parametrize("seed", slow_but([5, 6, 7], 6))
def test_rough_friction_is_no_event(tmp_path, seed):
    """Friction of any kind is of the joints."""
    assert diagnosed(tmp_path, seed, rough(seed)).events == ()


def test_what_one_joint_has_alone_is_no_push(tmp_path):
    """Five newton metres at joint 2 for a while are of its drive: nothing beyond loads one joint alone."""

    def more(q, _):
        time = np.arange(len(q[0])) / 100.0
        return np.array([0.0 * time, 5.0 * ((time >= CONTACT[0]) & (time < CONTACT[1]))])

    result = diagnosed(tmp_path, 8, more)
    assert (result.events, result.verdict) == ((), "unknown")
