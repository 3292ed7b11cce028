"""What a terminal is told while work goes on: that it does, for how long, and when a part of it ends."""

import threading

import pytest
from rich.console import Console

from linkwright.core.arm.compensation import table_over
from linkwright.core.arm.files.read import read_arm
from linkwright.screen import progress
from linkwright.screen.progress import Pace, Steps, in_words, waiting


def test_an_end_is_estimated_from_what_is_behind():
    pace = Pace(100.0)
    assert pace.left(130.0) is None
    pace.heard(0.25, 110.0)
    assert pace.left(110.0) == pytest.approx(30.0)
    assert pace.left(120.0) == pytest.approx(60.0)  # slower than thought, for nothing more was heard
    pace.heard(0.24, 120.0)  # more has to be done than was known: the same part
    assert pace.left(120.0) == pytest.approx(20.0 * 0.76 / 0.24)
    pace.heard(0.0, 200.0)  # another part
    assert pace.left(205.0) is None
    pace.heard(0.5, 210.0)
    assert pace.left(210.0) == pytest.approx(10.0)
    pace.heard(1.0, 220.0)
    assert pace.left(220.0) is None


@pytest.mark.parametrize(
    ("seconds", "said"),
    [
        (None, ""),
        (0.2, "about 1 s left"),
        (89, "about 89 s left"),
        (600, "about 10 min left"),
        (9000, "about 2 h left"),
    ],
)
def test_it_is_said_as_coarse_as_it_is(seconds, said):
    assert in_words(seconds) == said


@pytest.fixture
def terminal(monkeypatch):
    """A screen that counts as a terminal, and patience that is at an end at once."""
    screen = Console(stderr=True, force_terminal=True, width=100, color_system=None)
    monkeypatch.setattr(progress, "console", lambda **_: screen)
    monkeypatch.setattr(progress, "_PATIENCE", 0.0)
    return screen


def test_a_sign_of_life_needs_no_step(terminal, monkeypatch):
    """Reading or a solve that tells of nothing is not silent; what is over by then shows nothing."""
    shown = threading.Event()
    drawn = Steps._show
    monkeypatch.setattr(Steps, "_show", lambda self: (drawn(self), shown.set()))
    with terminal.capture() as seen, waiting("predicting"):
        assert shown.wait(30.0)
    assert "predicting" in seen.get()
    assert "left" not in seen.get()


def test_steps_tell_what_is_done_and_when_it_ends(terminal, monkeypatch):
    now = [100.0]
    monkeypatch.setattr("linkwright.screen.progress.time.monotonic", lambda: now[0])
    steps = Steps()
    steps._due.join()
    with terminal.capture() as seen:
        now[0] = 130.0
        steps("row \x1b[31m1 of 4", 0.25)
        with steps.aside():
            terminal.print("a line")
        steps.close()
    assert "row \\x1b[31m1 of 4" in seen.get()
    assert "about 90 s left" in seen.get() or "about 2 min left" in seen.get()


def test_bar_and_times_stay_whole_beside_long_words(terminal, monkeypatch):
    """Words that a narrow screen has no room for beside them go on in further lines."""
    terminal.width = 70
    shown = threading.Event()
    drawn = Steps._show
    monkeypatch.setattr(Steps, "_show", lambda self: (drawn(self), shown.set()))
    words = "provisional: backlash of the drives at joint 2; searching for what is missing"
    with terminal.capture() as seen, waiting("beginning") as steps:
        assert shown.wait(30.0)
        steps(words, 0.5)
        steps._bar.refresh()
    lines = [line for line in seen.get().splitlines() if "left" in line]
    assert lines
    for line in lines:
        assert "━" * 9 in line
        assert "0:00:0" in line
        assert " s left provisional: " in line
    told = seen.get()
    assert all(word in told for word in words.split())


def test_every_row_of_a_table_is_counted(bench, monkeypatch):
    monkeypatch.setattr("linkwright.core.arm.compensation._AT_ONCE", 4)
    heard = []
    table = table_over(read_arm(bench / "arm.yaml"), 3, (0.0, 2.0), lambda *counts: heard.append(counts))
    assert heard == [(4, 18), (8, 18), (9, 18), (13, 18), (17, 18), (18, 18)]
    monkeypatch.setattr("linkwright.core.arm.compensation._AT_ONCE", 1000)
    whole = table_over(read_arm(bench / "arm.yaml"), 3, (0.0, 2.0))
    for name in ("q", "payload", "error", "correction", "left"):
        assert getattr(table, name) == pytest.approx(getattr(whole, name), rel=1e-12, abs=1e-15)
