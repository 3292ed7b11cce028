"""Every command that README, docs and examples show: it parses, names files that are there, and the quick ones print
what the page says."""

import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import urllib.request
from pathlib import Path

import pytest
import typer

from handbook.commands import command_named
from handbook.sources import ROOT
from linkwright.cli import run
from linkwright.command_line import command_line, commands
from tests.costs import slow_but
from tests.handbook.pages import PAGES, Shown, shown, spoken, told

ALL = [item for page in PAGES for item in shown(page)]


OPTIONS = {
    option for param in typer.main.get_command(command_line()).params for option in (*param.opts, *param.secondary_opts)
}
"""What stands before any command."""


def parsed(words):
    """What the command line itself makes of the words: the values by the parameters' names."""
    command, rest = command_named(words[0]), list(words[1:])
    if hasattr(command, "commands"):
        command, rest = command.commands[rest[0]], rest[1:]
    return command.make_context(words[0], rest).params


def test_commands_are_found():
    """The checks below would pass on none."""
    assert len(ALL) > 50
    assert {item.words[0] for item in ALL} > {"evaluate", "optimize", "diagnose", "materials", "sections", "simulate"}


@pytest.mark.parametrize("each", ALL, ids=str)
def test_shown_command_parses(each):
    """Options, arguments and their number; a file of an example that is named is there."""
    given = parsed(each.words).values()
    files = [value for values in given for value in (values if isinstance(values, list | tuple) else [values])]
    named = [value for value in files if isinstance(value, Path) and value.parts[:1] == ("examples",)]
    assert [value for value in named if not (ROOT / value).exists()] == []


@pytest.mark.parametrize("name", commands())
def test_examples_of_the_help_parse(name):
    """They are what `--help` and the reference show: one at least of each command that is no group, and its own."""
    command = command_named(name)
    for item in list(getattr(command, "commands", {}).values()) or [command]:
        texts = " ".join((item.help or "").split()).split("Example: linkwright ")[1:]
        examples = [shlex.split(text) for text in texts]
        assert examples, item.name
        assert {tuple(words[:2] if item is not command else words[:1]) for words in examples} == {
            (name, item.name) if item is not command else (name,)
        }
        assert all(isinstance(parsed(words), dict) for words in examples)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_spoken_commands_are_there(page):
    """Within sentences: the command, the command of its group, and every option that is named with it."""
    wrong = []
    for words in spoken(page, set(commands())):
        if not words or words[0].rstrip(",.") == "..." or words[0] in OPTIONS:
            continue
        if words[0] not in commands():
            wrong.append(words)
            continue
        command = command_named(words[0])
        if hasattr(command, "commands"):
            own = [command.commands[word] for word in words[1:2] if word in command.commands]
            if not own and re.fullmatch(r"[a-z]+", words[1] if len(words) > 1 else "..."):
                wrong.append(words)
            command = own[0] if own else command
        known = {option for parameter in command.params for option in parameter.opts} | {"--help"}
        asked = {found for word in words for found in re.findall(r"^\[?(--[a-z-]+)", word)}
        if not asked <= known and not hasattr(command, "commands"):
            wrong.append(words)
    assert wrong == []


def test_spoken_targets_are_there():
    """`make ...` within sentences and blocks."""
    targets = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))
    for page in PAGES:
        if page.name == "CHANGELOG.md":  # which speaks of what is gone, too
            continue
        text = page.read_text(encoding="utf-8")
        assert set(re.findall(r"(?:`|^)make ([a-z-]+)", text, re.MULTILINE)) <= targets, page


ARM = """\
chain:
  - joint: {range: [-90 deg, 90 deg]}
    link: {length: 400 mm, section: {shape: circle, diameter: 60 mm}, material: my-alloy}
"""


def agree(printed, status, out, err):
    """Nothing where all that the page shows is printed, in order, warnings first; a line `...` leaves lines out.
    Blanks count as one."""
    lines = [" ".join(line.split()) for line in (err + out).splitlines() if line.strip()]
    here = 0
    for wanted in (" ".join(line.split()) for line in printed if line.strip() and line.strip() != "..."):
        if wanted not in lines[here:]:
            return f"status {status}: '{wanted}' is not among\n" + "\n".join(lines[here:])
        here = lines.index(wanted, here) + 1
    return ""


def followed(page, folder, patch, capsys):
    """Run a page's commands in order in a folder; the sentences on those that print something else."""
    patch.chdir(folder)
    for name in ("LINKWRIGHT_CATALOGUE", "LINKWRIGHT_SECTIONS"):
        patch.delenv(name, raising=False)
    patch.setenv("XDG_CONFIG_HOME", str(folder))
    own = f"{folder}/linkwright/"  # pages name the files there by themselves
    wrong = []
    for item in shown(ROOT / page):
        status = run(item.words)
        printed = capsys.readouterr()
        assert status in (0, 2), item
        said = agree(item.printed, status, printed.out.replace(own, ""), printed.err.replace(own, ""))
        wrong += [f"{item}\n{said}"] if said else []
    return wrong


@pytest.mark.parametrize("page", ["docs/how-to/materials.md", "docs/how-to/sections.md"])
def test_catalogue_pages_print_what_they_show(page, tmp_path, monkeypatch, capsys):
    """All their commands, one after the other, from an empty catalogue."""
    (tmp_path / "arm.yaml").write_text(ARM, encoding="utf-8")
    table = re.search(r"^\$ cat supplier.csv\n(.*?)^\$", (ROOT / page).read_text(encoding="utf-8"), re.M | re.DOTALL)
    if table:
        (tmp_path / "supplier.csv").write_text(table[1], encoding="utf-8")
    assert followed(page, tmp_path, monkeypatch, capsys) == []


NOT_RUN = {
    "docs/how-to/browser.md: linkwright serve designs --open": "stays; run until it is told to end, below",
    **dict.fromkeys(
        (
            "docs/real-machines.md: linkwright diagnose examples/real/motoman-ma2010/arm.yaml "
            "$LINKWRIGHT_DATA/motoman-ma2010/grid_test0516_R1.csv "
            "--recording-yaml examples/real/motoman-ma2010/recording.yaml",
            "docs/real-machines.md: linkwright diagnose examples/real/ur10/arm.yaml "
            "$LINKWRIGHT_DATA/ur10/series_A.csv --recording-yaml examples/real/ur10/recording.yaml",
            "docs/real-machines.md: linkwright diagnose examples/real/voron/arm.yaml "
            "$LINKWRIGHT_DATA/voron-thermal/frame_exp_quant_v3_2021-06-13_05-41-53.csv "
            "--recording-yaml examples/real/voron/recording-2021-06-13.yaml",
            "docs/real-machines.md: linkwright diagnose examples/real/irb120/arm.yaml "
            "$LINKWRIGHT_DATA/irb120-faro/recording_both_angles.csv "
            "--recording-yaml examples/real/irb120/recording.yaml",
        ),
        "the recordings are not part of the project, as the page says; parsed above",
    ),
}
"""What a page shows and no test runs, and why. Shorten it."""
FOLLOWED = {
    "README.md": "",
    "docs/how-to/workshop.md": "",
    "docs/how-to/diagnosis.md": "hidden-backlash",
    "docs/how-to/recordings.md": "hidden-backlash",
    "docs/start/tutorial.md": "bench-arm",
    "docs/start/six-axis.md": "six-axis",
    "docs/start/printed-arm.md": "printed-arm",
    "docs/how-to/exchange.md": "",
    "docs/how-to/motion.md": "motion-log",
    "docs/how-to/design.md": "bench-arm",
    "examples/hobby-arm/README.md": "",
}
"""Pages whose commands run one after the other, from the project's folder or that of an example."""
ELSEWHERE = {
    "docs/how-to/materials.md": "tests/handbook/test_commands.py",
    "docs/how-to/sections.md": "tests/handbook/test_commands.py",
    "examples/hidden-backlash/README.md": "tests/linkwright/test_examples_diagnosis.py",
    "examples/left-out-slopes/README.md": "tests/linkwright/test_examples_diagnosis.py",
    "examples/cable-drag/README.md": "tests/test_distribution.py",
    "examples/range-difference/README.md": "tests/diagnose/instruments/test_kinds.py",
    "docs/how-to/tradeoff.md": "tests/handbook/test_front.py",
    "docs/paper.md": "tests/paper/test_commands.py",
}
"""Pages whose commands other tests run."""


def test_every_shown_command_runs_or_is_left_out_by_name():
    """A new page is followed, run elsewhere, or its commands stand above with why; what is gone goes from there too."""
    pages = {str(item.page.relative_to(ROOT)) for item in ALL if str(item) not in NOT_RUN}
    assert pages == {*FOLLOWED, *ELSEWHERE}
    assert set(NOT_RUN) <= {str(item) for item in ALL}
    assert len(NOT_RUN) == 5
    assert all((ROOT / test).exists() for test in ELSEWHERE.values())
    assert "not part of the project" in (ROOT / "docs" / "real-machines.md").read_text(encoding="utf-8")


def dated(months):
    """Write when each recording of a series was made."""
    for number, month in enumerate(months, start=1):
        with Path(month).with_suffix(".yaml").open("a", encoding="utf-8") as settings:
            settings.write(f"date: 2026-{number:02d}-05\n")


def jumped():
    """A recording in the midst of which a zero moves."""
    before, after = (Path(name).read_text("utf-8").splitlines(keepends=True) for name in ("before.csv", "after.csv"))
    Path("jumped.csv").write_text("".join([*before[:97], *after[-96:]]), "utf-8")


@pytest.mark.parametrize("page", slow_but(FOLLOWED, "examples/hobby-arm/README.md"))
def test_pages_print_what_they_show(page, tmp_path, monkeypatch, capsys):
    """All commands of a page, one after the other."""
    ignored = shutil.ignore_patterns("real", "notebooks")
    shutil.copytree(ROOT / "examples", tmp_path / "here" / "examples", ignore=ignored)
    monkeypatch.chdir(tmp_path / "here" / (f"examples/{FOLLOWED[page]}" if FOLLOWED[page] else ""))
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    for name in ("LINKWRIGHT_CATALOGUE", "LINKWRIGHT_SECTIONS", "LINKWRIGHT_ACTUATORS"):
        monkeypatch.delenv(name, raising=False)
    wrong = []
    for item in shown(ROOT / page):
        if str(item) in NOT_RUN:
            continue
        if item.words[0] == "watch":
            dated([word for word in item.words if word.endswith(".csv")])
        if "jumped.csv" in item.words:
            jumped()
        assert run(item.words) == 0, item
        printed = capsys.readouterr()
        shown_lines = [line.removeprefix("# ") for line in item.printed]
        out = (printed.err + printed.out).replace(f"{tmp_path}/linkwright/", "")  # pages name files there as they are
        wrong += [f"{item}: {part}" for part in told(shown_lines, out)]
    assert wrong == []


def test_what_stays_is_run_until_it_is_told_to_end(tmp_path):
    """`serve ... --open` of the page, at a free port: the browser that is opened finds the pages there."""
    typed = next(item for item in shown(ROOT / "docs" / "how-to" / "browser.md") if item.words[0] == "serve")
    assert str(typed) in NOT_RUN
    (tmp_path / "designs").mkdir()
    browser = tmp_path / "browser"
    browser.write_text('#!/bin/sh\necho "opened $1"\n', encoding="utf-8")
    browser.chmod(0o700)
    environment = {
        **os.environ,
        "PYTHONPATH": str(ROOT),
        "XDG_CONFIG_HOME": str(tmp_path),
        "BROWSER": str(browser),
        "COLUMNS": "10000",
    }
    command = [sys.executable, "-m", "linkwright", *typed.words, "--port", "0"]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with subprocess.Popen(command, cwd=tmp_path, env=environment, text=True, **pipes) as run_:
        said = run_.stdout.readline()
        place = said.partition(" at ")[2].strip()
        opened = next(line for line in run_.stdout if line.startswith("opened "))
        with urllib.request.build_opener(urllib.request.ProxyHandler({})).open(place) as answer:
            page = answer.read().decode("utf-8")
        run_.send_signal(signal.SIGINT)
        rest, complaints = run_.communicate(timeout=60)
    assert opened.split() == ["opened", place]
    assert "Linkwright" in page
    assert (run_.returncode, rest.splitlines()[-1:], complaints) == (0, ["stopped"], "")


def test_disagreement_is_seen():
    """The comparison compared."""
    assert told(("in 5 s.",), "in 0.7 s.") == []
    assert told(("a b 1.00 mm,", "c"), "x a b\n1.01 mm c d") == []
    assert told(("a", "...", "d 5 %"), "a b d 5 %") == []
    assert told(("a b 1.00 mm",), "a b 1.10 mm") == ["a b 1.00 mm"]
    assert told(("a 1", "", "c"), "a 2 c") == ["a 1"]
    assert agree(("a  b", "...", "d"), 0, "a b\nc\nd\n", "") == ""
    assert agree(("a", "d"), 0, "d\na\n", "") != ""
    assert not Shown(ROOT / "README.md", "linkwright doctor", ("doctor",), ()).printed
