"""What a command imports: no library that it does no work with, for each takes longer to import than the answer."""

import json
import os
import subprocess
import sys

import pytest

from linkwright.command_line import commands
from tests.linkwright.conftest import ROOT

HEAVY = {
    "casadi",
    "pandas",
    "plotly",
    "scipy.linalg",
    "scipy.optimize",
    "scipy.spatial",
    "scipy.special",
    "scipy.stats",
}
"""The bare package `scipy` is not among them: pint looks for it, and its parts are what takes time."""
RUN = """
import json, sys
from linkwright.cli import run
statuses = [run(line.split()) for line in sys.argv[1:]]
print(json.dumps([statuses, sorted(sys.modules)]), file=sys.stderr)
"""


def loaded(*lines):
    """Run the lines in a process of their own; the modules that are loaded in the end."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-c", RUN, *lines]
    ended = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=True)
    statuses, modules = json.loads(ended.stderr)
    assert statuses == [0] * len(lines)
    return set(modules)


@pytest.mark.parametrize(
    ("line", "also"),
    [
        ("--version", {"numpy", "pint", "rich", "yaml"}),
        ("--help", {"numpy", "pint"}),
        ("sections list", {"pint"}),
    ],
)
def test_a_command_that_only_looks_things_up_loads_no_solver(line, also):
    """Nor what is `also` of no use to it."""
    assert not loaded(line) & (HEAVY | also)


def test_no_look_up_loads_a_solver():
    """All of them in one process: what is loaded stays loaded."""
    lines = ("materials list", "materials show steel-s355", "effects list", "effects show backlash", "actuators list")
    assert not loaded(*lines) & HEAVY


def test_the_help_of_no_command_loads_a_solver():
    """In one process too."""
    assert not loaded(*(f"{name} --help" for name in commands())) & HEAVY


def test_a_command_with_work_to_do_loads_what_it_works_with():
    """So the absences above are none of the test's own making."""
    assert loaded("evaluate examples/welding-arm/arm.yaml") >= {"casadi", "numpy", "pint"}
