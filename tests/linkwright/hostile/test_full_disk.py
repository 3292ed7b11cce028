"""A disk that is full when an answer is written: the answer is shown, one line says what is wrong."""

from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
ARM = ROOT / "examples" / "hidden-backlash" / "arm.yaml"
RECORDING = ROOT / "examples" / "hidden-backlash" / "after-service.csv"
SMALL = ROOT / "linkwright" / "browser" / "starters" / "example-arm.yaml"


@pytest.mark.parametrize(
    "command",
    [f"evaluate {SMALL}", f"compensate {SMALL} --grid 3", f"predict {ARM} {RECORDING}", f"budget {SMALL}"],
)
@pytest.mark.parametrize("option", ["--json", "--markdown"])
def test_the_answer_is_shown_where_its_file_cannot_be_written(process, command, option):
    """/dev/full is a disk without room."""
    shown = process(f"$PYTHON -m linkwright {command}")
    found = process(f"$PYTHON -m linkwright {command} {option} /dev/full")
    assert found.returncode == 2
    assert found.stderr == "/dev/full: cannot be written: No space left on device\n"
    assert shown.returncode == 0
    assert found.stdout == shown.stdout


def test_the_answer_is_shown_where_its_folder_cannot_hold_it(process, bench):
    """A limit of 8 kB a file: the result fits, the report does not."""
    found = process(f"ulimit -f 8; $PYTHON -m linkwright evaluate {SMALL} --out out")
    assert found.returncode == 2
    assert "Worst position error" in found.stdout
    assert found.stderr.count("\n") == 1
    assert "report.html: cannot be written" in found.stderr
    assert not (bench / "out" / "report.html").exists()
