"""What people who live in a shell expect: results in pipes, no colours where none are wanted, narrow terminals."""

import json
import os
import pty
import re
import subprocess
import sys

import pytest

from linkwright.screen.progress import Steps
from tests.linkwright.conftest import ROOT


@pytest.mark.parametrize("option", [("--json", "-"), ("--json=-",)])
def test_a_result_in_a_pipe_is_alone_there(linkwright, bench, option):
    """What is printed goes to standard error; no file of that name is made."""
    status, out, err = linkwright("evaluate", "arm.yaml", *option)
    assert status == 0
    assert json.loads(out)["max_error_mm"] > 0.0
    assert "Worst position error" in err
    assert not (bench / "-").exists()


def test_tables_in_a_pipe(linkwright):
    status, out, _ = linkwright("compensate", "arm.yaml", "--grid", "2", "--out", "-")
    assert status == 0
    assert out.splitlines()[0].startswith("q1_deg,q2_deg")
    status, out, _ = linkwright("effects", "list")
    assert "backlash" in out


def test_a_recording_needs_a_name(linkwright):
    status, _, err = linkwright("simulate", "arm.yaml", "--poses", "2", "--out", "-")
    assert (status, err) == (2, "--out: needs the name of a file; the settings are written beside it\n")


def test_a_pipe_that_closes_or_is_full(process):
    for reader, status in (("| true", 141), ("> /dev/full", 2)):
        done = process(f'"$PYTHON" -m linkwright effects list --json - 2>/dev/null {reader}')
        assert (done.returncode, done.stdout) == (status, "")


@pytest.mark.parametrize("measure", ["²", "0", "2000000000", "wide"])
def test_help_on_a_terminal_of_odd_measures(linkwright, monkeypatch, measure):
    plain = linkwright("--help")
    assert plain[0] == 0
    for name in ("COLUMNS", "LINES"):
        monkeypatch.setenv(name, measure)
    assert linkwright("--help") == plain


def on_a_terminal(bench, columns, **environment):
    """What `evaluate` shows on a terminal of so many columns."""
    ours, theirs = pty.openpty()
    values = {**os.environ, "PYTHONPATH": str(ROOT), "COLUMNS": str(columns), "TERM": "xterm-256color", **environment}
    command = [sys.executable, "-m", "linkwright", "evaluate", "arm.yaml"]
    with subprocess.Popen(command, cwd=bench, env=values, stdout=theirs, stderr=subprocess.DEVNULL) as run:
        os.close(theirs)
        shown = b""
        while True:
            try:
                piece = os.read(ours, 65536)
            except OSError:  # its other end is closed
                break
            if not piece:
                break
            shown += piece
        assert run.wait() == 0
    os.close(ours)
    return shown.decode()


@pytest.mark.slow
def test_narrow_terminals_and_no_colour(bench):
    """60 columns hold every table, no bar is folded, and nothing has a colour (30 to 49) where NO_COLOR is set."""
    shown = on_a_terminal(bench, 60, NO_COLOR="1")
    assert not re.search(r"\x1b\[(?:[0-9]+;)*(?:3|4|9|10)[0-9]", shown)
    lines = [re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", line).rstrip() for line in shown.splitlines()]
    start = next(at for at, line in enumerate(lines) if line.startswith("each effect alone"))
    tables = lines[start:]
    assert max(len(line) for line in tables if not line.startswith(("  ", "WARNING"))) <= 60
    bars = [line for line in lines if "█" in line]
    assert bars
    assert all(re.search(r"[0-9] mm +█", line) for line in bars)


def test_progress_is_told_to_terminals_only(capsys, monkeypatch):
    """However long it takes."""
    steps = Steps()
    monkeypatch.setattr("time.monotonic", lambda: 1e9)
    steps("trying", 0.5)
    steps.close()
    assert capsys.readouterr() == ("", "")
