"""Logs of one machine are graded alike: what is doubted of one is doubted of all that may be meant so.

Torques are those of two point masses by Lagrange's equations, with much friction at the second joint."""

from __future__ import annotations

import numpy as np
import pytest

from linkwright.core.diagnose.motion.reading.read import logs_from, table_of_log
from linkwright.core.units.quantities import InputError
from tests.diagnose.motion.reading import test_conventions as logs


def said(folder, *cases):
    """What is doubted of each of several logs: by how far joint 2 swings, its zero (rad) and its dry friction (N*m)."""
    tables = []
    for number, (swing, zero, friction) in enumerate(cases):
        columns = logs.motion((swing, -0.5))
        noise = 0.3 * friction * np.random.default_rng(1).normal(size=len(columns["t_s"]))
        columns["tau2_Nm"] = columns["tau2_Nm"] + (friction - 1.5) * np.sign(columns["dq2_radps"]) + noise
        columns["q2_rad"] = columns["q2_rad"] + zero
        place = folder / f"{number}"
        place.mkdir()
        file = logs.written(place, columns).rename(place / f"log{number}.csv")
        tables.append(table_of_log(file))
    return [" ".join(log.warnings) for log in logs_from(tables, logs.arm())]


def test_what_one_log_doubts_is_doubted_of_a_log_that_does_not_contradict_it(tmp_path):
    quarter = np.pi / 2.0
    assert said(tmp_path, (0.15, quarter, 12.0)) == [""]
    (tmp_path / "both").mkdir()
    first, second = said(tmp_path / "both", (0.3, quarter, 12.0), (0.15, quarter, 12.0))
    for sentence in (first, second):
        assert "The arm's weights leave doubt" in sentence
        assert "q2_rad counts from another zero, -90 deg away" in sentence
        assert "write `columns: {q2_rad: q2_rad - 1.57079633}`" in sentence
    assert "as in log0.csv" in second


def test_a_log_that_contradicts_it_is_not_doubted(tmp_path):
    first, second = said(tmp_path, (0.3, np.pi / 2.0, 12.0), (0.9, 0.0, 1.5))
    assert "leave doubt" in first
    assert second == ""


def test_a_refusal_names_the_other_logs_that_can_be_read_so(tmp_path):
    quarter = np.pi / 2.0
    with pytest.raises(InputError, match=r"-90 deg away \(log0.csv can be read so too\)"):
        said(tmp_path, (0.15, quarter, 12.0), (0.9, quarter, 1.5), (0.9, 0.0, 1.5))
