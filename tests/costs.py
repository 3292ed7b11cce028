"""What tests cost, in CPU seconds, and which of the slow ones a build has time for.

Reports carry CPU seconds, those of child processes included, in place of seconds on the clock: `--durations` says the
same on a busy machine as on an idle one.
"""

import os
import random
import time
from collections import Counter
from collections.abc import Iterable

import pytest

DEAR = 15.0
"""What a test may cost (s of CPU)."""


def slow_but(cases: Iterable[object], *kept: object) -> list[object]:
    """Cases of a parametrised test, marked slow but for those that are kept."""
    return [case if case in kept else pytest.param(case, marks=pytest.mark.slow) for case in cases]


def cpu() -> float:
    """CPU seconds of this process and of its children that have ended."""
    spent = os.times()
    return spent.user + spent.system + spent.children_user + spent.children_system


class Costs:
    """CPU seconds in every report; files and tests that cost most, at the end."""

    def __init__(self) -> None:
        self.before = cpu()
        self.by_file: Counter[str] = Counter()
        self.by_test: Counter[str] = Counter()

    def pytest_runtest_logstart(self) -> None:
        self.before = cpu()

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(self):
        report = yield
        now = cpu()
        report.duration, self.before = now - self.before, now
        return report

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self.by_file[report.nodeid.partition("::")[0]] += report.duration
        self.by_test[report.nodeid] += report.duration

    def pytest_terminal_summary(self, terminalreporter, config: pytest.Config) -> None:
        if config.option.durations is None:
            return
        terminalreporter.section(f"CPU seconds: {self.by_file.total():.0f} in all, of the dearest files")
        for name, seconds in self.by_file.most_common(config.option.durations or None):
            terminalreporter.write_line(f"{seconds:7.1f}  {name}")
        for name, seconds in self.by_test.most_common():
            if seconds > DEAR:
                terminalreporter.write_line(f"more than {DEAR:g} s of CPU: {name}")


class Share:
    """As many files as there are minutes for, in an order that follows from the word (say, a commit)."""

    def __init__(self, minutes: float, word: str) -> None:
        self.end = time.monotonic() + 60.0 * minutes
        self.word = word

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        files = sorted({item.path for item in items})
        random.Random(self.word).shuffle(files)
        items.sort(key=lambda item: files.index(item.path))

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_setup(self) -> None:
        if time.monotonic() > self.end:
            pytest.skip("beyond the minutes of this share")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--minutes", type=float, help="begin no test after so many minutes; the others are skipped")
    parser.addoption("--share", default="", help="with --minutes: a word from which the order of the files follows")


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", "slow: left to `make test-all`; `make test` runs what is not")
    config.pluginmanager.register(Costs(), "costs")
    if config.option.minutes is not None:
        config.pluginmanager.register(Share(config.option.minutes, config.option.share), "share")
