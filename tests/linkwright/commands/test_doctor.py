"""`linkwright doctor`: a sound installation, and each way in which one is not."""

import json
import os
import subprocess
import sys
from importlib import metadata

import pytest

from linkwright.core.executors.threads import VARIABLES


def checkup(linkwright, bench):
    status, out, err = linkwright("doctor", "--json", "doctor.json")
    assert err == ""
    content = json.loads((bench / "doctor.json").read_text())
    assert content["sound"] == (status == 0)
    wrong = [item for item in content["checks"] if item["state"] == "wrong"]
    assert all(item["would_do"] for item in wrong)
    assert all(item["name"] in out for item in wrong)
    return status, {item["name"]: item for item in content["checks"]}


def test_this_installation_is_sound(linkwright, bench):
    status, result = checkup(linkwright, bench)
    assert status == 0
    assert {"Python", "casadi", "solver (IPOPT)", "catalogue: materials", "threads of linear algebra"} <= set(result)


@pytest.mark.slow
@pytest.mark.parametrize(("asked", "taken"), [(None, "1"), ("2", "2")])
def test_a_command_takes_one_thread_of_linear_algebra_unless_told_otherwise(tmp_path, asked, taken):
    left = {name: value for name, value in os.environ.items() if name not in VARIABLES}
    given = left if asked is None else {**left, "OPENBLAS_NUM_THREADS": asked}
    told = tmp_path / "doctor.json"
    subprocess.run([sys.executable, "-m", "linkwright", "doctor", "--json", str(told)], env=given, check=True)
    results = {load["name"]: load["found"] for load in json.loads(told.read_text())["checks"]}
    assert results["threads of linear algebra"] == taken


def test_a_catalogue_that_cannot_be_read_is_named(linkwright, bench, monkeypatch):
    (bench / "own.yaml").write_text("materials: 3\n")
    monkeypatch.setenv("LINKWRIGHT_CATALOGUE", str(bench / "own.yaml"))
    status, result = checkup(linkwright, bench)
    assert status == 1
    assert result["catalogue: materials"]["state"] == "wrong"
    assert "own.yaml: format_version" in result["catalogue: materials"]["found"]


@pytest.mark.parametrize(
    ("version", "status", "casadi", "parquet"),
    [(None, 1, "wrong", "missing"), ("999.1", 0, "sound", "sound")],
)
def test_packages(linkwright, bench, monkeypatch, version, status, casadi, parquet):
    """One that is missing is wrong where it is needed; an optional one may be missing."""
    real = metadata.version

    def told(name):
        if name in ("casadi", "pyarrow"):
            if version is None:
                raise metadata.PackageNotFoundError(name)
            return version
        return real(name)

    monkeypatch.setattr(metadata, "version", told)
    ended, result = checkup(linkwright, bench)
    assert (ended, result["casadi"]["state"], result["pyarrow (extra parquet)"]["state"]) == (status, casadi, parquet)


def test_a_solver_that_answers_wrongly_is_no_solver(linkwright, bench, monkeypatch):
    """Far fewer steps than it needs."""
    options = {"print_time": False, "ipopt": {"print_level": 0, "sb": "yes", "max_iter": 1}}
    monkeypatch.setattr("linkwright.core.optimize.exchange.program.ipopt_options", lambda: options)
    status, result = checkup(linkwright, bench)
    assert status == 1
    assert "solves wrongly" in result["solver (IPOPT)"]["found"]
