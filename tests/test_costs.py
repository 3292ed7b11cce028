"""The suite's own plugin: CPU seconds in reports, shares of slow tests, and that no test is left to nobody."""

import re
import time
from pathlib import Path
from types import SimpleNamespace

import pytest

from tests.costs import Costs, Share, cpu, slow_but

ROOT = Path(__file__).resolve().parent.parent


def told(costs):
    """The seconds that a report of a test comes to have."""
    wrapped = costs.pytest_runtest_makereport()
    next(wrapped)
    with pytest.raises(StopIteration) as ended:
        wrapped.send(SimpleNamespace(duration=1e9))
    return ended.value.value.duration


def test_reports_tell_cpu_and_not_waiting():
    costs = Costs()
    costs.pytest_runtest_logstart()
    time.sleep(0.3)
    assert told(costs) < 0.2
    begun = cpu()
    while cpu() < begun + 0.15:  # more than is asked below: the clock counts in ticks
        pass
    assert told(costs) >= 0.1
    assert told(costs) < 0.1  # each phase is counted once


def test_files_that_cost_most_are_told():
    costs = Costs()
    for name, seconds in (("a.py::one", 1.0), ("b.py::one[2]", 16.0), ("a.py::two", 2.0)):
        costs.pytest_runtest_logreport(SimpleNamespace(nodeid=name, duration=seconds))
    lines = []
    reporter = SimpleNamespace(section=lines.append, write_line=lines.append)
    costs.pytest_terminal_summary(reporter, SimpleNamespace(option=SimpleNamespace(durations=2)))
    assert lines == [
        "CPU seconds: 19 in all, of the dearest files",
        "   16.0  b.py",
        "    3.0  a.py",
        "more than 15 s of CPU: b.py::one[2]",
    ]


def ordered(word):
    items = [SimpleNamespace(path=f"{name}.py", number=k) for name in "abcdefgh" for k in range(3)]
    Share(1.0, word).pytest_collection_modifyitems(items)
    return [(item.path, item.number) for item in items]


def test_each_commit_begins_with_other_files_and_the_same_with_the_same():
    assert ordered("one commit") == ordered("one commit")
    assert ordered("one commit") != ordered("another")
    assert sorted(ordered("one commit")) == sorted(ordered("another"))
    assert [number for _, number in ordered("another")] == [0, 1, 2] * 8


def test_nothing_begins_after_the_minutes_of_a_share():
    Share(10.0, "").pytest_runtest_setup()
    with pytest.raises(pytest.skip.Exception, match="beyond the minutes"):
        Share(0.0, "").pytest_runtest_setup()


def test_all_cases_but_those_kept_are_slow():
    cases = slow_but(range(3), 1)
    assert cases[1] == 1
    assert [case.values for case in (cases[0], cases[2])] == [(0,), (2,)]
    assert all(mark.name == "slow" for case in (cases[0], cases[2]) for mark in case.marks)


def test_what_one_target_leaves_the_other_runs():
    recipes = (ROOT / "Makefile").read_text(encoding="utf-8")
    assert '\ntest: $(DEV)\n\t@$(PYTEST) -m "not slow" ' in recipes
    assert re.search(r"^PYTEST := .* -n 2 --dist loadfile ", recipes, re.MULTILINE)  # what a file shares is made once
    assert "\ntest-all: $(DEV)\n\t@$(PYTEST) -m slow " in recipes
    build = (ROOT / ".ci" / "run").read_text(encoding="utf-8").splitlines()
    assert any(line.startswith("make test ") for line in build)
    assert any(line.startswith("make test-all ") for line in build)
