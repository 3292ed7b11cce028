"""The example script and the page on Python, run as people would."""

import doctest
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.slow
def test_script_runs(tmp_path):
    """From any folder; it evaluates, sweeps, optimises, diagnoses and predicts."""
    call = [sys.executable, str(ROOT / "examples" / "python" / "face.py")]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(call, cwd=tmp_path, capture_output=True, text=True, check=False, env=environment)
    assert (done.returncode, done.stderr) == (0, "")
    lines = done.stdout.splitlines()
    swept = [float(line.split()[2]) for line in lines if line[:3] in ("380", "400", "420")]
    assert swept == sorted(swept)
    assert len(set(swept)) == 3
    assert "<Diagnosis: backlash at joint 2, 97 % of 0.122 mm explained>" in lines
    kinds = [line.split(":")[0] for line in lines if line.startswith("<")]
    assert kinds == ["<Evaluation", "<Optimization", "<Diagnosis", "<Prediction", "<Prediction"]


@pytest.mark.slow
def test_page_on_python_holds(monkeypatch):
    """Its examples are run from the project's folder."""
    monkeypatch.chdir(ROOT)
    done = doctest.testfile(str(ROOT / "docs" / "how-to" / "python.md"), module_relative=False)
    assert done.attempted > 10
    assert done.failed == 0
