"""Sixty small recordings of known truth, tips and torques. A moved rule shows here.

What the tool misses today stands in `known_misses` with today's answer: a case that is mended, or answers otherwise,
fails until that is decided and written down (`python -m benchmarks.canonical record`).
"""

import json
from pathlib import Path
from typing import Any

import pytest

from benchmarks.canonical.asked import ARCHIVE, EXPECTED, Answer, answer, faults

FOLDER = Path(__file__).parent
KNOWN = json.loads((FOLDER / EXPECTED).read_text(encoding="utf-8"))
CASES, MISSES, DEAR = KNOWN["cases"], KNOWN["known_misses"], KNOWN["dear"]


def test_there_are_thirty_of_each():
    """Some of them of links of unknown weight, with a free tool and seven poses a cell."""
    worlds = [name.split("-")[0] for name in CASES]
    assert (worlds.count("tips"), worlds.count("torques")) == (30, 30)
    assert sum(name.startswith("tips-cells") for name in CASES) == 5
    assert set(MISSES) <= set(CASES)


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] if name in DEAR else []) for name in sorted(CASES)]
)
def test_a_canonical_recording(name: str, tmp_path: Path):
    """Verdict, names and sizes are as asked for; of a known miss, the answer is the recorded one."""
    given = answer(FOLDER / ARCHIVE, name, tmp_path)
    wrong = faults(name, CASES[name], given)
    if name not in MISSES:
        assert not wrong, f"{'; '.join(wrong)} ({given.shown()}) {given.line}"
        return
    today = {key: MISSES[name][key] for key in ("verdict", "names")}
    assert wrong, f"mended: take it off the known misses ({given.shown()})"
    assert given.shown() == today, f"answers otherwise, and still {'; '.join(wrong)}"


def _entry(effect: str, at: list[int], **sizes: float) -> dict[str, Any]:
    parameters = {
        name: {"value": value, "unit": "rad/(N*m)", "ci95": [0.99 * value, 1.01 * value]}
        for name, value in sizes.items()
    }
    return {"effect": effect, "at": at, "alternatives": [], "parameters": parameters}


ASKED: dict[str, Any] = {
    "verdict": ["named"],
    "names": [["joint_compliance", [2]]],
    "others": [["encoder_offset", [1]]],
    "sizes": {"joint_compliance.compliance_2": [1e-5, 0.2]},
    "joints": 3,
}


def test_faults_are_seen():
    """Each kind of fault by itself, and none where all is right."""
    right = _entry("joint_compliance", [2], compliance_2=1.1e-5)
    assert faults("tips", ASKED, Answer("named", (right, _entry("encoder_offset", [1])))) == []
    assert faults("tips", ASKED, Answer("none", (right,))) == ["none, not named"]
    assert faults("tips", ASKED, Answer("named", ())) == ["joint_compliance [2] is not named"]
    assert faults("tips", ASKED, Answer("named", (right, _entry("backlash", [3])))) == ["backlash 3 is no cause"]
    off = _entry("joint_compliance", [2], compliance_2=2e-5)
    in_other_units = off | {"parameters": {"compliance_2": {"value": 10.0, "unit": "urad/(N*m)"}}}
    assert faults("tips", ASKED, Answer("named", (in_other_units,))) == []
    assert faults("tips", ASKED, Answer("named", (off,))) == ["joint_compliance.compliance_2 is 2e-05, not 1e-05"]


def test_an_alternative_counts():
    """A cause among the alternatives of a name is named."""
    entry = _entry("servo_droop", [2]) | {"alternatives": [["joint_compliance", [2]]]}
    assert faults("tips", ASKED, Answer("named", (entry,))) == []
