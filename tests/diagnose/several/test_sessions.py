"""Recordings that go on from one another: cut in two, a recording says the same as whole."""

from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linkwright.core.arm.chain.conditions import Conditions
from linkwright.core.diagnose.reading.read import read_recording
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.several.recordings import Several, together
from linkwright.core.diagnose.several.sessions import gone_on_from
from linkwright.core.diagnose.steps.diagnosis import diagnose
from linkwright.core.sections.numeric import Array
from tests.diagnose.recorded import LENGTHS, planar_tip, poses, table, written
from tests.diagnose.several.days import arm, day

CREEP, CONSTANT, SIGMA = 60e-6, 2400.0, 15e-6


def _files(folder: Path, q: Array, tip: Array, cut: int, **columns: Array) -> tuple[Recording, Several]:
    """A recording as one file, and the same rows as two files of the same clock."""

    def read(name: str, rows: slice) -> Recording:
        further = {key: values[rows] for key, values in columns.items()}
        return read_recording(written(folder / name, table(q[rows], tip[rows], **further)), arm())

    whole = read("whole.csv", slice(None))
    return whole, together([read("one.csv", slice(cut)), read("two.csv", slice(cut, None))], arm())


def _conditions(recording: Recording) -> Conditions:
    return observe(arm(), recording).state.conditions


@given(seed=st.integers(0, 10**6), cut=st.integers(3, 37), start=st.sampled_from([0.0, -50.0, 1.7e9]))
def test_cut_in_two_a_recording_remembers_the_same(seed: int, cut: int, start: float):
    rng = np.random.default_rng(seed)
    q, time = poses(40, seed), start + np.cumsum(rng.uniform(1.0, 60.0, 40))
    payload = rng.choice([0.0, 5.0], 40, p=[0.3, 0.7])
    warmth = 20.0 + np.cumsum(rng.normal(0.0, 0.3, 40))
    with TemporaryDirectory() as folder:
        columns = {"time_s": time, "payload_kg": payload, "temperature_degC": warmth}
        whole, two = _files(Path(folder), q, planar_tip(q), cut, **columns)
    assert two.before == (None, 0)
    told, again = _conditions(whole), _conditions(two)
    assert np.allclose(np.asarray(again.loaded_for), np.asarray(told.loaded_for), atol=1e-5)
    assert np.allclose(np.asarray(again.time), np.asarray(told.time), atol=1e-5)
    for lag in (30.0, 600.0):
        assert np.allclose(np.asarray(again.lagged_warming(0, lag)), np.asarray(told.lagged_warming(0, lag)), atol=1e-6)


def test_what_goes_on_from_what():
    one = replace(day(1), started=0.0)
    after = float(np.max(one.time)) if one.time is not None else 0.0
    two = replace(day(2), started=after + 100.0)
    assert gone_on_from([one, two]) == (None, 0)
    assert gone_on_from([two, one]) == (1, None)
    # Another clock, a night between them, another day, another arm, the same stretch of time: begun anew.
    for other in (
        replace(two, started=0.0),
        replace(two, started=after + 4e4),
        replace(two, date="2026-05-17"),
        replace(two, unit="B"),
        replace(two, started=after - 5.0),
        replace(two, started=None),
    ):
        assert gone_on_from([one, other]) == (None, None)
    three = replace(day(3), started=after + 100.0 + after + 30.0)
    assert gone_on_from([one, two, three]) == (None, 0, 1)
    assert together([one, two, three], arm()).parts()[2].earlier is not None


def test_stamps_of_one_day_are_one_clock(tmp_path):
    q = poses(6)
    settings = tmp_path / "recording.yaml"
    settings.write_text('columns: {time_s: at}\ntime_format: "%Y-%m-%d %H:%M:%S"\n')
    for name, hour in (("one", 9), ("two", 10)):
        columns = table(q, planar_tip(q)) | {"at": [f"2026-05-16 {hour:02}:{10 * k:02}:00" for k in range(6)]}
        written(tmp_path / f"{name}.csv", columns)
    one, two = (read_recording(tmp_path / f"{name}.csv", arm(), settings) for name in ("one", "two"))
    assert one.started is not None
    assert two.started == one.started + 3600.0
    assert two.time is not None
    assert two.time[0] == 0.0
    assert two.time[-1] == 3000.0
    assert gone_on_from([one, two]) == (None, 0)


@pytest.mark.slow
def test_creep_goes_on_where_the_tracker_is_set_up_anew(tmp_path):
    """A drive creeps under a payload that was taken up before the tracker was moved: by the textbook, from sums of
    cosines, the drive turned by c tau (1 - exp(-t/tc)). Begun anew with the second file, creep would not be what it
    is: its time constant is found, and nothing else is said."""
    rng = np.random.default_rng(7)
    q = np.repeat(rng.uniform(-1.5, 1.5, (40, 3)), 2, axis=0)
    time = 60.0 * np.arange(80)
    payload = np.where(time < 600.0, 0.0, 8.0)
    angles = np.cumsum(q, axis=1)
    arms = (np.cos(angles) * LENGTHS)[:, 1:].sum(axis=1)
    turned = q.copy()
    turned[:, 1] -= (
        CREEP * (1.0 - np.exp(-np.where(time < 600.0, time, time - 600.0) / CONSTANT)) * 9.81 * payload * arms
    )
    tip = planar_tip(turned) + SIGMA * rng.standard_normal((80, 2))
    tip[40:] += (0.3, -0.2)
    files = []
    for name, rows in (("one", slice(40)), ("two", slice(40, None))):
        columns = table(q[rows], tip[rows], time_s=time[rows], payload_kg=payload[rows])
        files.append(written(tmp_path / f"{name}.csv", columns))
        (tmp_path / f"{name}.yaml").write_text("frame: free\n")
    two = together([read_recording(file, arm(), file.with_suffix(".yaml")) for file in files], arm())
    result = diagnose(arm(), two)
    assert [(finding.effect, finding.at) for finding in result.findings] == [("creep", (2,))]
    told = {parameter.parameter: parameter for parameter in result.findings[0].parameters}
    for name, true in (("compliance", CREEP), ("time_constant", CONSTANT)):
        low, high = told[name].interval
        assert low < true < high
        assert told[name].value == pytest.approx(true, rel=0.1)
    assert any("two.csv goes on from one.csv" in warning for warning in two.warnings)
    # The same rows on clocks of their own are another story, which creep begun anew does not tell.
    anew = diagnose(arm(), together([replace(item, started=None) for item in two.each], arm()))
    assert anew.rms_after > 1.2 * result.rms_after
