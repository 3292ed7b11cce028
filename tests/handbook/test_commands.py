"""Every command that README, docs and examples show: it parses, names files that are there, and the quick ones print
what the page says."""

import re
import shlex
import shutil
from pathlib import Path

import pytest
import typer

from handbook.commands import command_named
from handbook.sources import ROOT
from linkwright.cli import run
from linkwright.command_line import COMMANDS, command_line
from tests.handbook.pages import PAGES, Shown, shown, spoken

ALL = [each for page in PAGES for each in shown(page)]


OPTIONS = {
    option for each in typer.main.get_command(command_line()).params for option in (*each.opts, *each.secondary_opts)
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
    assert {each.words[0] for each in ALL} > {"evaluate", "optimize", "diagnose", "materials", "sections", "simulate"}


@pytest.mark.parametrize("each", ALL, ids=str)
def test_shown_command_parses(each):
    """Options, arguments and their number; a file of an example that is named is there."""
    given = parsed(each.words).values()
    files = [value for values in given for value in (values if isinstance(values, list | tuple) else [values])]
    named = [value for value in files if isinstance(value, Path) and value.parts[:1] == ("examples",)]
    assert [value for value in named if not (ROOT / value).exists()] == []


@pytest.mark.parametrize("name", COMMANDS)
def test_examples_of_the_help_parse(name):
    """They are what `--help` and the reference show."""
    command = command_named(name)
    for each in [command, *getattr(command, "commands", {}).values()]:
        text = " ".join((each.help or "").split())
        for example in text.split("Example: linkwright ")[1:]:
            parsed(shlex.split(example))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_spoken_commands_are_there(page):
    """Within sentences: the command, the command of its group, and every option that is named with it."""
    wrong = []
    for words in spoken(page, set(COMMANDS)):
        if not words or words[0].rstrip(",.") == "..." or words[0] in OPTIONS:
            continue
        if words[0] not in COMMANDS:
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


def followed(page, folder, patch, capsys, *, only=None):
    """Run a page's commands in order in a folder; the sentences on those that print something else."""
    patch.chdir(folder)
    for name in ("LINKWRIGHT_CATALOGUE", "LINKWRIGHT_SECTIONS"):
        patch.delenv(name, raising=False)
    patch.setenv("XDG_CONFIG_HOME", str(folder))
    own = f"{folder}/linkwright/"  # pages name the files there by themselves
    wrong = []
    for each in shown(ROOT / page):
        if only is None or each.words[0] in only:
            status = run(each.words)
            printed = capsys.readouterr()
            assert status in (0, 2), each
            said = agree(each.printed, status, printed.out.replace(own, ""), printed.err.replace(own, ""))
            wrong += [f"{each}\n{said}"] if said else []
    return wrong


@pytest.mark.parametrize("page", ["docs/materials.md", "docs/sections.md"])
def test_catalogue_pages_print_what_they_show(page, tmp_path, monkeypatch, capsys):
    """All their commands, one after the other, from an empty catalogue."""
    (tmp_path / "arm.yaml").write_text(ARM, encoding="utf-8")
    table = re.search(r"^\$ cat supplier.csv\n(.*?)^\$", (ROOT / page).read_text(encoding="utf-8"), re.M | re.DOTALL)
    if table:
        (tmp_path / "supplier.csv").write_text(table[1], encoding="utf-8")
    assert followed(page, tmp_path, monkeypatch, capsys) == []


@pytest.mark.parametrize("page", ["README.md", "docs/formats.md", "docs/workshop.md", "docs/recordings.md"])
def test_quick_commands_print_what_is_shown(page, monkeypatch, capsys, tmp_path):
    """From the project's folder, as there: what evaluates, lists or draws."""
    shutil.copytree(ROOT / "examples", tmp_path / "examples", ignore=shutil.ignore_patterns("real", "notebooks"))
    quick = {"evaluate", "actuators", "effects", "materials", "sections", "export", "import", "inverse"}
    assert followed(page, tmp_path, monkeypatch, capsys, only=quick) == []


def words(lines):
    """Words and numbers, wherever lines break; rules and bars are none."""
    return [word for line in lines for word in line.split() if not set(word) <= set("─█▉▊▋▌▍▎▏")]


def same(word, other):
    """Whether two words are the same, numbers in them within three per cent, which processors may differ by; what is
    nothing but for rounding is alike nothing."""
    one, two = (re.split(r"([0-9]+(?:\.[0-9]+)?(?:e−?[0-9]+)?)", each.rstrip(".,;:")) for each in (word, other))
    numbers = [
        (float(a.replace("−", "-")), float(b.replace("−", "-"))) for a, b in zip(one[1::2], two[1::2], strict=False)
    ]
    return one[::2] == two[::2] and all(abs(a - b) <= max(0.03 * max(abs(a), abs(b)), 1e-8) for a, b in numbers)


def told(printed, out):
    """The paragraphs of a page that a command does not print, whatever the width; a line `...` leaves lines out."""
    have, missing = words(out.splitlines()), []
    for part in re.split(r"\n(?: *\n| *\.\.\. *\n)+", "\n" + "\n".join(printed) + "\n"):
        wanted = words([line for line in part.splitlines() if line.strip() != "..."])
        found = any(
            all(same(*pair) for pair in zip(wanted, have[at:], strict=False)) and at + len(wanted) <= len(have)
            for at in range(len(have))
        )
        missing += [] if found or not wanted else [" ".join(wanted)]
    return missing


@pytest.mark.parametrize("page", ["docs/diagnosis.md", "docs/recordings.md"])
def test_diagnoses_print_what_is_shown(page, tmp_path, monkeypatch, capsys):
    """All commands of a page, one after the other, where its example is; a watch needs a series of its own."""
    shutil.copytree(ROOT / "examples" / "hidden-backlash", tmp_path / "here")
    monkeypatch.chdir(tmp_path / "here")
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    wrong = []
    for each in shown(ROOT / page):
        if each.words[0] == "watch":
            continue
        if "jumped.csv" in each.words:
            before, after = (
                Path(name).read_text("utf-8").splitlines(keepends=True) for name in ("before.csv", "after.csv")
            )
            Path("jumped.csv").write_text("".join([*before[:97], *after[-96:]]), "utf-8")
        assert run(each.words) == 0, each
        printed = capsys.readouterr()
        wrong += [
            f"{each}: {part}"
            for part in told([line.removeprefix("# ") for line in each.printed], printed.err + printed.out)
        ]
    assert wrong == []


def test_disagreement_is_seen():
    """The comparison compared."""
    assert told(("a b 1.00 mm,", "c"), "x a b\n1.01 mm c d") == []
    assert told(("a", "...", "d 5 %"), "a b d 5 %") == []
    assert told(("a b 1.00 mm",), "a b 1.10 mm") == ["a b 1.00 mm"]
    assert told(("a 1", "", "c"), "a 2 c") == ["a 1"]
    assert agree(("a  b", "...", "d"), 0, "a b\nc\nd\n", "") == ""
    assert agree(("a", "d"), 0, "d\na\n", "") != ""
    assert not Shown(ROOT / "README.md", "linkwright doctor", ("doctor",), ()).printed
