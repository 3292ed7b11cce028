"""A disk that is full when an answer is written: the answer is shown, one line says what is wrong."""

import resource
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
ARM = ROOT / "examples" / "hidden-backlash" / "arm.yaml"
RECORDING = ROOT / "examples" / "hidden-backlash" / "after-service.csv"
SMALL = ROOT / "linkwright" / "browser" / "starters" / "example-arm.yaml"


@pytest.mark.parametrize(
    "command",
    [
        ("evaluate", SMALL),
        ("compensate", SMALL, "--grid", "3"),
        ("predict", ARM, RECORDING),
        ("budget", SMALL),
    ],
    ids=lambda command: command[0],
)
def test_the_answer_is_shown_where_its_file_cannot_be_written(linkwright, command):
    """/dev/full is a disk without room."""
    status, shown, _ = linkwright(*command)
    assert status == 0
    for option in ("--json", "--markdown"):
        result = linkwright(*command, option, "/dev/full")
        assert result == (2, shown, "/dev/full: cannot be written: No space left on device\n")


def test_the_answer_is_shown_where_its_folder_cannot_hold_it(linkwright, bench):
    """A limit of 8 kB a file: the result fits, the report does not."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (8192, hard))
    try:
        status, shown, error = linkwright("evaluate", SMALL, "--out", "out")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert status == 2
    assert "Worst position error" in shown
    assert error.count("\n") == 1
    assert "report.html: cannot be written" in error
    assert not (bench / "out" / "report.html").exists()
