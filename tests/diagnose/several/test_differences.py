"""What differs between recordings is found as such: a drive that softened, a zero that moved, another arm."""

from dataclasses import replace

import pytest

from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.several.recordings import together
from linkwright.core.diagnose.steps.diagnosis import diagnose
from linkwright.json.diagnosis import diagnosis_json
from linkwright.results.diagnoses.answer import answer, to_do
from tests.costs import slow_but
from tests.diagnose.recorded import LENGTHS
from tests.diagnose.several.days import arm, day

SOFT = 40e-6


def _diagnosed(*days, units=False):
    dated = [replace(item, date=date) for item, date in zip(days, ("2026-05-16", "2026-08-02"), strict=True)]
    return diagnose(arm(), together(dated, arm(), units=units))


def test_a_drive_that_softened_beside_a_zero_that_both_days_have():
    zeros = {3: 3e-4}
    result = _diagnosed(day(1, compliance={2: SOFT}, zeros=zeros), day(2, compliance={2: 1.2 * SOFT}, zeros=zeros))
    assert {(finding.effect, finding.at, finding.recording) for finding in result.findings} == {
        ("joint_compliance", (2,), ""),
        ("joint_compliance", (2,), "2026-08-02"),
        ("encoder_offset", (3,), ""),
    }
    (differs,) = result.differences
    for item, true in zip(differs.each, (SOFT, 1.2 * SOFT), strict=True):
        assert item.interval[0] < true < item.interval[1]
    assert differs.p_value < 0.01
    assert "compliance 40" in result.sentence
    assert "in 2026-05-16 and 47" in result.sentence
    # The file holds what is common, and says so by leaving the rest out.
    entries = {(effect.effect, tuple(effect.at)): effect.parameters for effect in result.corrected.effects}
    assert entries["joint_compliance", (2,)]["compliance"] == pytest.approx(SOFT, rel=0.02)
    told = diagnosis_json(result)
    assert [each["values"]["2026-08-02"]["value"] for each in told["differences"]] == pytest.approx([48e-6], rel=0.02)
    assert sorted(each["recording"] or "" for each in told["missing"]) == ["", "", "2026-08-02"]


def test_a_zero_that_moved_and_nothing_else():
    result = _diagnosed(day(1), day(2, zeros={3: 3e-4}))
    assert [(finding.effect, finding.at, finding.recording) for finding in result.findings] == [
        ("encoder_offset", (3,), "2026-08-02")
    ]
    before, after = result.differences[0].each
    assert before.interval[0] < 0.0 < before.interval[1]
    assert after.interval[0] < 3e-4 < after.interval[1]
    assert not result.corrected.effects


@pytest.mark.parametrize("seed", slow_but([1, 5], 1))
def test_nothing_differs_where_nothing_does(seed):
    result = _diagnosed(day(seed), day(seed + 1, sigma=30e-6))
    assert result.verdict == "none"
    assert not result.differences


@pytest.mark.slow
def test_what_lasts_as_long_as_an_arm_differs_between_units_alone():
    """Links of another length: no day makes them; two arms of one type may have them."""
    other = tuple(length + more for length, more in zip(LENGTHS, (1e-3, -1.5e-3, 0.0), strict=True))
    pair = (day(1, poses=12, compliance={2: SOFT}), day(2, poses=12, compliance={2: SOFT}, lengths=other))
    days = _diagnosed(*pair)
    assert days.verdict == "unknown"
    assert "of different arms" in days.sentence
    assert "--units" in days.sentence
    # That is what is said first, and what to do about it.
    text = "All links weigh 0 kg here. The recordings look as if they were of different arms: lasting sizes"
    assert answer(days).startswith(text)
    (line,) = to_do(days)
    assert "by itself" in line
    assert "--units" in line
    assert all(EFFECTS[finding.effect].watch.lasts != "the arm" for finding in days.findings if finding.recording)
    units = _diagnosed(*pair, units=True)
    own = {(difference.effect, difference.at): difference.each for difference in units.differences}
    assert set(own) == {("link_length", (1,)), ("link_length", (2,))}
    assert own["link_length", (1,)][1].value == pytest.approx(1e-3, abs=3e-5)
    assert own["link_length", (2,)][1].value == pytest.approx(-1.5e-3, abs=3e-5)
    common = [(finding.effect, finding.at) for finding in units.findings if not finding.recording]
    assert common == [("joint_compliance", (2,))]
    assert units.recordings[1].rms_after < 1.2 * units.recordings[1].noise_floor
