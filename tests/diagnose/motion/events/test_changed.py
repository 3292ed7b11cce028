"""A load that is taken on the way: since when, and how much; and no change where a torque goes with the angle."""

import numpy as np
import pytest

from linkwright.core.diagnose.motion.diagnosis import diagnose_motion
from linkwright.json.motion import motion_json
from linkwright.results.document import Section
from linkwright.results.motion.answer import answer
from linkwright.results.motion.described import describe
from tests.diagnose.motion.plumb_arm import HAND, logged, plumb_arm, rough

TAKEN, SINCE, ROUNDING = 1.2, 17.0, 1e-9
"""A load that is taken at the tip (kg), and when (s)."""


def diagnosed(tmp_path, seed, hand_of, more_of):
    """`hand_of` time at the tip, `more_of` angles beside at joint 2."""
    log = logged(seed, hand_of, lambda q, _: np.stack([np.zeros_like(q[1]), more_of(q[1])]))
    return diagnose_motion(plumb_arm(tmp_path), [log])


@pytest.mark.parametrize("seed", [1, 2])
def test_a_load_that_is_taken_on_the_way(tmp_path, seed):
    """Payload, when and how much: the intervals hold the truth, and rows are 0.08 s apart."""
    result = diagnosed(tmp_path, seed, lambda t: HAND + TAKEN * (t >= SINCE), np.zeros_like)
    assert (result.verdict, result.unknown) == ("named", None)
    (event,) = result.events
    change = event.change
    assert (event.kind, change.effect, change.end, change.share > 0.9) == ("payload taken", "payload", None, True)
    assert change.start.interval[0] - ROUNDING <= SINCE <= change.start.interval[1] + ROUNDING
    assert change.start.time == pytest.approx(SINCE, abs=0.1)
    (mass,) = (item for item in change.parameters if item.parameter == "mass")
    assert mass.interval[0] <= TAKEN <= mass.interval[1]
    assert mass.value == pytest.approx(TAKEN, rel=0.03)
    assert f"from {change.start.time:.4g} s on" in result.sentence
    assert answer(result).lower().startswith(f"payload taken from {change.start.time:.4g} s on")
    assert "Events in the log" in [item.title for item in describe(result).items if isinstance(item, Section)]
    assert [(item["kind"], item["end_s"]) for item in motion_json(result)["events"]] == [("payload taken", None)]


@pytest.mark.parametrize("seed", [1, 2])
def test_a_small_load_under_rough_friction(tmp_path, seed):
    """A load that makes less torque than friction that nobody models: what it does is no noise."""
    log = logged(seed, lambda t: HAND + 0.4 * (t >= SINCE), rough(seed))
    (event,) = diagnose_motion(plumb_arm(tmp_path), [log]).events
    assert event.kind == "payload taken"
    assert event.change.start.interval[0] - ROUNDING <= SINCE <= event.change.start.interval[1] + ROUNDING
    (mass,) = (item for item in event.change.parameters if item.parameter == "mass")
    assert mass.interval[0] <= 0.4 <= mass.interval[1]


def test_what_differs_between_logs_is_no_event(tmp_path):
    """Each log has its load from beginning to end."""
    logs = [logged(seed, lambda t, kg=kg: np.full_like(t, kg), lambda q, _: 0.0 * q, f"{kg}.csv")
            for seed, kg in ((1, HAND), (2, HAND + TAKEN))]  # fmt: skip
    assert diagnose_motion(plumb_arm(tmp_path), logs).events == ()


def test_a_bump_over_the_angle_is_no_change(tmp_path):
    """Torque that goes with the angle is there from the beginning, and is named as that, small as it is."""
    result = diagnosed(tmp_path, 3, lambda t: np.full_like(t, HAND), lambda q: 0.5 * np.exp(-(((q - 0.3) / 0.2) ** 2)))
    assert [(item.effect, item.at) for item in result.findings] == [("torque_curve", (2,))]
    assert (result.verdict, result.unknown) == ("named", None)


def test_noise_is_no_structure(tmp_path):
    """The same motion with nothing beside."""
    assert diagnosed(tmp_path, 4, lambda t: np.full_like(t, HAND), np.zeros_like).verdict == "none"
