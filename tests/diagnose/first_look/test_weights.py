"""A log is refused for another reading where that is likelier, and not for one that is less likely."""

from dataclasses import dataclass

import numpy as np
import pytest

from linkwright.core.diagnose.first_look import weights
from linkwright.core.diagnose.first_look.library import Library
from linkwright.core.diagnose.first_look.search import Judged
from linkwright.core.diagnose.reading.foreign.headers import Headers
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.units.quantities import InputError
from tests.diagnose.motion.plumb_arm import HAND, logged, plumb_arm

HEADERS = Headers({name: name for k in (1, 2) for name in (f"q{k}", f"tau{k}")})


@dataclass
class Evidence:
    """Torques that the log as it stands does not explain, and every other reading does, so much likelier."""

    library: Library
    gain: float
    free: bool = False

    rigid = torque = np.zeros((1, 2))
    joints = np.zeros(0, dtype=np.int64)

    def given(self):
        return Judged((), self.library.none, 15.0, 0.56, explains=False)

    def judged(self, several):
        none = self.library.none
        return [Judged(each, *(each or (none,)), 15.0 - self.gain * bool(each), 0.35, bool(each)) for each in several]

    def sized(self, parts):
        del parts
        return []

    def beam(self, depth, *, explained, gained):
        del depth, explained, gained
        return 0


@pytest.mark.parametrize(("gain", "said"), [(-2.3, "accepted"), (0.5, "doubted"), (3.0, "refused")])
def test_what_another_reading_must_gain(tmp_path, monkeypatch, gain, said):
    """That it alone leaves less than four tenths at the worst joint is not enough."""
    arm = plumb_arm(tmp_path)
    monkeypatch.setattr(weights.TorqueEvidence, "of", lambda _, library, __: Evidence(library, gain))
    log = logged(1, lambda t: np.full_like(t, HAND), lambda q, _: 0.0 * q)
    if said == "refused":
        with pytest.raises(InputError, match="goes against the arm's weights"):
            weights.look_at_weights([(log, HEADERS)], arm, Rules())
    else:
        (read,) = weights.look_at_weights([(log, HEADERS)], arm, Rules())
        assert any("leave doubt" in line for line in read.warnings) == (said == "doubted")
