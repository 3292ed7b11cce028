"""How much of a result the screen shows: `--quiet`, `--verbose`, and the environment's word for them."""

import pytest

from linkwright.cli import run
from linkwright.screen.console import SHOW

ARM = """
name: hook
chain:
  - joint: {type: revolute, range: [-30 deg, 60 deg], stiffness: 100 kN*m/rad}
    link: {length: 1 m, section: {shape: tube, diameter: 80 mm, thickness: 4 mm}, material: steel-s355}
temperature: 60 degC
payload: {mass: 10 kg}
"""


@pytest.fixture
def arm(tmp_path):
    path = tmp_path / "arm.yaml"
    path.write_text(ARM, encoding="utf-8")
    return str(path)


def lines_of(capsys, *words):
    assert run(list(words)) == 0
    return capsys.readouterr().out.splitlines()


def test_quiet_is_the_answer_and_its_warnings(arm, capsys, tmp_path):
    """No table, no file that was written; what an arm at 60 degC leaves out is a warning, and stays."""
    result = lines_of(capsys, "evaluate", arm, "--quiet", "--json", str(tmp_path / "result.json"))
    assert result[:1] == ["hook"]
    assert result[1].startswith("Worst position error")
    assert len(result) > 2
    assert all(line.startswith("WARNING: ") for line in result[2:])
    assert (tmp_path / "result.json").exists()


def test_verbose_holds_all_that_is_usual_and_more(arm, capsys):
    usual, more = lines_of(capsys, "evaluate", arm), lines_of(capsys, "evaluate", arm, "-v")
    assert set(usual) - set(more) == set()
    assert len(more) > len(usual)


def test_the_environment_says_it_for_every_command(arm, capsys, monkeypatch):
    usual = lines_of(capsys, "evaluate", arm)
    monkeypatch.setenv(SHOW, "answer")
    quiet = lines_of(capsys, "evaluate", arm)
    assert quiet == lines_of(capsys, "evaluate", arm, "--quiet")
    assert len(quiet) < len(usual)
    # A command's own word counts before it, and for that command alone.
    assert len(lines_of(capsys, "evaluate", arm, "--verbose")) > len(usual)
    assert lines_of(capsys, "evaluate", arm) == quiet


@pytest.mark.parametrize("words", [("-q", "-v"), ()])
def test_what_cannot_be_meant_is_one_line(arm, capsys, monkeypatch, words):
    if not words:
        monkeypatch.setenv(SHOW, "loud")
    assert run(["evaluate", arm, *words]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1
