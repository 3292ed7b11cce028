"""--thorough: every test made with more draws."""

from dataclasses import replace

import numpy as np

from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.search.naming import Namer
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.diagnose.core_cases import prepared_null, recorded
from tests.diagnose.made_diagnosis import made_arm

PLAIN = {"poses": 24, "payloads": (), "repeats": 2, "sides": "one", "temperature": None}


def test_a_gate_is_made_with_more_draws():
    drawn = [len(Namer(prepared_null(**PLAIN), thorough=item, seed=1).test(())[0].drawn) for item in (False, True)]
    assert drawn[1] > 5 * drawn[0]


def test_a_clear_effect_is_named():
    arm = made_arm(False)
    recording = recorded(arm, **PLAIN)
    moved = recording.tip + np.array([4e-4, -3e-4])
    result = diagnose(arm, replace(recording, tip=moved), Options(thorough=True))
    assert result.verdict in ("named", "alias_class")
    assert result.gate_p < 0.01
