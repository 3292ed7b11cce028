"""What a terminal is told while work goes on: that it does, for how long, and when a part of it ends."""

import threading

import pytest
from rich.console import Console

from linkwright.core.arm.compensation import table_over
from linkwright.core.arm.files.read import read_arm
from linkwright.screen import progress
from linkwright.screen.progress import Steps, waiting


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


def test_steps_tell_what_is_done_and_when_it_ends(terminal):
    now = [100.0]
    terminal.get_time = lambda: now[0]
    steps = Steps()
    steps._due.join()
    with terminal.capture() as seen:
        steps("row \x1b[31m1 of 4", 0.25)
        now[0] = 130.0
        steps("row \x1b[31m2 of 4", 0.5)
        steps._bar.refresh()
        with steps.aside():
            terminal.print("a line")
        steps.close()
    assert "row \\x1b[31m2 of 4, 60 s left" in seen.get()


def test_the_bar_stays_whole_beside_long_words(terminal, monkeypatch):
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
    lines = [line for line in seen.get().splitlines() if "provisional" in line]
    assert lines
    for line in lines:
        assert "━" * 9 in line
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
