"""The command line as people and scripts meet it: exit statuses, one-line errors, quiet ends."""

import json
import math
import re

import pytest

import linkwright as lw
from linkwright import command_line
from linkwright.cli import INTERRUPTED
from linkwright.command_line import NO_ANSWER, READER_GONE, WRONG_INPUT
from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.face.evaluation import pose_of
from linkwright.screen.console import PLAIN_WIDTH

COMMANDS = (
    ("evaluate",),
    ("optimize",),
    ("simulate",),
    ("diagnose",),
    ("compare",),
    ("compensate",),
    ("inverse",),
    ("materials", "list"),
    ("materials", "show"),
    ("sections", "list"),
    ("sections", "show"),
    ("effects", "list"),
    ("effects", "show"),
)


INTERRUPTED_AT = """
import signal, sys, time
from linkwright.cli import main

class Interrupt:
    def find_spec(self, name, path=None, target=None):
        if name == sys.argv[1]:
            signal.raise_signal(signal.SIGINT)

signal.signal(signal.SIGINT, signal.default_int_handler)
time.monotonic = lambda began=time.monotonic(): began
sys.meta_path.insert(0, Interrupt())
main(sys.argv[2:])
"""
"""A run that a keyboard interrupts as it looks for a module, heard even where the tests run in the background. No time
passes in it: after a second of work an interrupt says what it stopped, and imports alone may take that long."""


@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_help_shows_an_example(linkwright, command):
    """The example is a line that could be typed as it stands."""
    status, out, err = linkwright(*command, "--help")
    assert (status, err) == (0, "")
    assert f"Example: linkwright {' '.join(command)}" in " ".join(out.split())


def test_bare_command_and_bare_group_show_their_help(linkwright):
    """Nothing was asked, so nothing is wrong."""
    for arguments in ((), ("materials",)):
        status, out, _ = linkwright(*arguments)
        assert status == 0
        assert "Usage: linkwright" in out


WRONG = [
    (("evaluate", "missing.yaml"), "missing.yaml"),
    (("evaluate", "."), "."),
    (("evaluate",), "ARM"),
    (("evaluate", "arm.yaml", "--colour"), "--colour"),
    (("evalute", "arm.yaml"), "evalute"),
    (("evaluate", "arm.yaml", "--pose", "10"), "--pose"),
    (("evaluate", "arm.yaml", "--pose", "10 x"), "'x'"),
    (("evaluate", "arm.yaml", "--pose", "10 nan"), "'nan'"),
    (
        ("evaluate", "arm.yaml", "--pose", "10 deg, 20 deg, 5 deg"),
        "for each joint, and 3 are given",
    ),
    (("evaluate", "arm.yaml", "--pose", "10 deg"), "2 values are needed, one for each joint, and 1 is given"),
    (("evaluate", "arm.yaml", "--json", "."), "folder"),
    (("evaluate", "arm.yaml", "--json", "arm.yaml"), "input"),
    (("evaluate", "arm.yaml", "--json", "no/where.json"), "no/where.json"),
    (("evaluate", "arm.yaml", "--problem", "missing.yaml"), "missing.yaml"),
    (("evaluate", "arm.yaml", "--catalogue", "missing.yaml"), "missing.yaml"),
    (("evaluate", "arm.yaml", "--out", "arm.yaml"), "arm.yaml"),
    (("evaluate", "arm.yaml", "--out", "."), "other files"),
    (("optimize", "missing.yaml"), "missing.yaml"),
    (("optimize", "arm.yaml"), "arm.yaml: is an arm file; a problem file names it"),
    (("evaluate", "problem.yaml"), "problem.yaml: is a problem file; the arm file is the one that it names"),
    (("optimize", "problem.yaml", "--json", "problem.yaml"), "input"),
    (("optimize", "problem.yaml", "--workers", "0"), "--workers"),
    (("optimize", "problem.yaml", "--dask", "tcp://127.0.0.1:1", "--workers", "2"), "--workers"),
    (("optimize", "problem.yaml", "--dask", "tcp://127.0.0.1:1"), "no dask scheduler answers at tcp://127.0.0.1:1"),
    (("materials", "show", "aluminum-6061-t6"), "aluminium-6061-t6"),
    (("sections", "show", "circel"), "circle"),
    (("effects", "show", "baklash"), "backlash"),
]


@pytest.mark.parametrize(("arguments", "named"), WRONG, ids=[" ".join(arguments) for arguments, _ in WRONG])
def test_wrong_input_is_one_line(linkwright, arguments, named):
    """Status 2, nothing on standard output, one line on standard error that names what is wrong."""
    status, out, err = linkwright(*arguments)
    assert status == 2
    assert out == ""
    assert err.count("\n") == 1
    assert err.endswith("\n")
    assert named in err
    assert "Traceback" not in err


def test_a_key_that_nobody_knows_names_file_and_key(linkwright, bench):
    """FILE: KEY: message."""
    path = bench / "arm.yaml"
    path.write_text(path.read_text().replace("backlash:", "backlsh:"), encoding="utf-8")
    status, _, err = linkwright("evaluate", "arm.yaml")
    assert status == 2
    assert re.match(r"arm\.yaml: chain\[1\]\.joint: [^:]*'backlsh'.*'backlash'", err)


@pytest.mark.parametrize(
    ("key", "message"),
    [
        ("type: hinge", "'hinge' is not one of revolute, prismatic, slide; did you mean 'revolute'?"),
        (
            "rail_pitch: 1 mrad",
            "'rail_pitch'; it is an effect, which stands in the arm file's list `effects`",
        ),
        (
            "type: slide, range: [0 mm, 1 mm], tilting_stiffness: 1 kN*m/rad",
            "of a slide write rail_pitch under `effects`",
        ),
    ],
)
def test_a_word_of_somebody_else_is_answered_with_ours(linkwright, bench, key, message):
    text = f"chain:\n  - joint: {{{key}}}\n    link: {{length: 1 m, rigid: true, mass: 1 kg}}\n"
    (bench / "other.yaml").write_text(text, encoding="utf-8")
    assert message in linkwright("evaluate", "other.yaml")[2]


def test_a_missing_figure_names_the_arm_file(linkwright, bench):
    """A rigid link of unknown mass is fine in the file; the question cannot be put."""
    text = (bench / "arm.yaml").read_text()
    start = text.index("link: {length: 300 mm")
    rigid = text[:start] + "link: {length: 300 mm, rigid: true, mass: unknown}\npayload: {mass: 2 kg}\n"
    (bench / "arm.yaml").write_text(rigid, encoding="utf-8")
    status, out, err = linkwright("evaluate", "arm.yaml")
    assert (status, out) == (2, "")
    assert err.startswith("arm.yaml: ")
    assert "link 2" in err


def test_a_path_out_of_reach_has_no_answer(linkwright, bench):
    """Status 1: the question is well-formed."""
    path = bench / "problem.yaml"
    path.write_text(path.read_text().replace("500 mm, 200 mm", "1500 mm, 200 mm"), encoding="utf-8")
    status, out, err = linkwright("evaluate", "arm.yaml", "--problem", "problem.yaml")
    assert (status, out) == (1, "")
    assert "cannot be reached" in err
    assert err.count("\n") == 1


def test_limits_that_no_design_keeps_have_no_answer(linkwright, bench):
    """Status 1, and the line says which limit blocks."""
    path = bench / "problem.yaml"
    path.write_text(path.read_text().replace("<= 3 kg", "<= 0.05 kg"), encoding="utf-8")
    status, _, err = linkwright("optimize", "problem.yaml", "--out", "result")
    assert status == 1
    assert "mass" in err
    assert err.count("\n") == 1


def test_ctrl_c_is_quiet(linkwright, monkeypatch):
    """130, and no word, for what was at work for less than a second."""

    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(lw, "read_arm", interrupted)
    assert linkwright("evaluate", "arm.yaml") == (130, "", "")


def test_pose_is_read_in_degrees(linkwright, bench):
    """Negative numbers and commas too; the compliance is asked there."""
    status, _, _ = linkwright("evaluate", "arm.yaml", "--pose", "-10, 20.5", "--json", "result.json")
    assert status == 0
    content = json.loads((bench / "result.json").read_text(encoding="utf-8"))
    assert content["compliance"]["q_deg"] == pytest.approx([-10.0, 20.5])


def test_output_that_is_no_terminal_is_plain(process, linkwright, monkeypatch):
    """No colour codes, tables of at most 100 columns, each sentence one line; COLUMNS fits sentences too."""
    done = process('"$PYTHON" -m linkwright evaluate arm.yaml')
    monkeypatch.setenv("COLUMNS", "100")
    _, fitted, _ = linkwright("evaluate", "arm.yaml")
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    assert "\x1b" not in done.stdout
    wider = [line.strip() for line in done.stdout.splitlines() if len(line) > PLAIN_WIDTH]
    assert not any("  " in line or "──" in line for line in wider), "a table"
    assert max(len(line) for line in fitted.splitlines()) <= PLAIN_WIDTH
    assert fitted.split() == done.stdout.split()
    assert "Worst position error" in done.stdout


def test_a_reader_that_leaves_is_no_trouble(process):
    """`| head` ends the command without a word, whether it leaves early or late."""
    done = process('"$PYTHON" -m linkwright materials list | head -c 1')
    assert done.stderr == ""
    assert len(done.stdout) == 1
    done = process('"$PYTHON" -m linkwright sections list | true')
    assert done.stderr == ""


def test_a_yielding_link_is_said_plainly(linkwright, bench):
    """A wire of a link under a heavy payload."""
    path = bench / "arm.yaml"
    text = path.read_text().replace("diameter: 60 mm", "diameter: 5 mm").replace("mass: 2 kg", "mass: 80 kg")
    path.write_text(text, encoding="utf-8")
    status, out, _ = linkwright("evaluate", "arm.yaml")
    assert status == 0
    assert "WARNING: link 1 yields" in out


def test_poses_of_slides_are_lengths():
    """Degrees for what turns, millimetres for what slides."""
    slide = Joint("prismatic", (1.0, 0.0, 0.0), (0.0, 0.5))
    arm = Arm("slide", (slide, Joint()), (Link(0.1, mass=1.0), Link(0.1, mass=1.0)))
    assert pose_of(arm, "250 90") == pytest.approx((0.25, math.pi / 2))


def test_usage_errors_have_one_known_ancestor():
    """The look-up must not fall back to an exception that everything derives from."""
    kind = command_line._usage_error()
    assert kind not in (Exception, BaseException)
    assert not issubclass(OSError, kind)
    assert not issubclass(ValueError, kind)


def test_output_that_cannot_be_written_is_one_line(process):
    """A full device, for the screen and for a file."""
    for line in (
        '"$PYTHON" -m linkwright effects list > /dev/full',
        '"$PYTHON" -m linkwright effects list --json /dev/full',
    ):
        done = process(line)
        assert done.returncode == 2
        assert done.stderr.count("\n") == 1
        assert "No space left" in done.stderr


def test_an_interrupt_while_modules_load_is_quiet(process):
    """It comes as the module of the command is looked for, and as CasADi is: much of a short run goes into imports."""
    for module in ("linkwright.commands.from_face", "casadi"):
        done = process(f"\"$PYTHON\" -c '{INTERRUPTED_AT}' {module} evaluate arm.yaml")
        assert (done.returncode, done.stdout, done.stderr) == (130, "", "")


@pytest.mark.parametrize(
    ("words", "expected"),
    [("linkwright opt", ["optimize"]), ("linkwright materials sh", ["show"]), ("linkwright evaluate --js", ["--json"])],
)
def test_a_shell_completes_commands_and_options(process, words, expected):
    """By the protocol of click's completion scripts: the words so far, and which of them is meant."""
    text = f"COMP_WORDS='{words}' COMP_CWORD={words.count(' ')} _LINKWRIGHT_COMPLETE=complete_bash"
    assert process(f"{text} $PYTHON -m linkwright").stdout.split() == expected


def test_help_tells_the_exit_statuses(linkwright):
    """Those that `linkwright.cli` and `linkwright.command_line` give."""
    _, out, _ = linkwright("--help")
    assert all(str(status) in out for status in (0, NO_ANSWER, WRONG_INPUT, INTERRUPTED, READER_GONE))
