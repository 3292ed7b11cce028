"""--thorough: the whole search calibrated on recordings that hold nothing."""

from dataclasses import replace

import numpy as np

from linkwright.core.diagnose.diagnosis import diagnose
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.search.naming import Named, Namer
from linkwright.core.diagnose.search.whole_search import whole_search_p
from linkwright.core.executors import Processes
from tests.diagnose.core_cases import prepared_null, recorded
from tests.diagnose.made_diagnosis import made_arm

PLAIN = {"poses": 24, "payloads": (), "repeats": 2, "sides": "one", "temperature": None}


def test_the_best_of_a_null_is_nothing_rare():
    namer = Namer(prepared_null(**PLAIN), thorough=False, seed=1)
    best = namer.best(namer.library, 1)[1]
    named = Named(best.members, (), (0.5,), namer.test(()), None)
    assert whole_search_p(namer, named, 3, print) > 0.02


def test_draws_are_the_same_whoever_searches_them():
    namer = Namer(prepared_null(**PLAIN), thorough=False, seed=1)
    named = Named(namer.best(namer.library, 1)[1].members, (), (0.5,), namer.test(()), None)
    told: list[float] = []
    with Processes(2, patience=0.0) as processes:
        shared = whole_search_p(namer, named, 3, told.append, processes)
        assert len(processes.processes()) == 2
    assert shared == whole_search_p(namer, named, 3, print)
    assert told == sorted(told)


def test_a_clear_effect_stands_against_the_whole_search():
    arm = made_arm(False)
    recording = recorded(arm, **PLAIN)
    moved = recording.tip + np.array([4e-4, -3e-4])
    found = diagnose(arm, replace(recording, tip=moved), Options(thorough=True))
    assert found.verdict in ("named", "alias_class")
    assert found.gate_p < 0.01
