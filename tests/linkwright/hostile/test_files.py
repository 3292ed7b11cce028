"""Files that are none, or that never end: one line that names the file, and nothing is waited for."""

import os
import shlex
import threading

import pytest
import typer

from linkwright.command_line import command_line, commands

LONG = "a" * 300
INPUTS = [
    "evaluate {}",
    "evaluate arm.yaml --problem {}",
    "evaluate arm.yaml --catalogue {}",
    "evaluate arm.yaml --motion {}",
    "optimize {}",
    "optimize problem.yaml --catalogue {}",
    "seam {} --from '1m,0m' --to '1m,1m'",
    "seam arm.yaml --from '0.6m,0m' --to '0.6m,0.1m' --catalogue {}",
    "inverse {} '0.5 m' '0.2 m'",
    "inverse arm.yaml '0.5 m' '0.2 m' --catalogue {}",
    "simulate {} --poses 3 --out s.csv",
    "simulate arm.yaml --at {} --out s.csv",
    "simulate arm.yaml --poses 3 --out s.csv --catalogue {}",
    "tradeoff {}",
    "tradeoff problem.yaml --catalogue {}",
    "diagnose {} r.csv",
    "diagnose arm.yaml {}",
    "diagnose arm.yaml r.csv {}",
    "diagnose arm.yaml r.csv --recording-yaml {}",
    "diagnose arm.yaml r.csv --problem {}",
    "diagnose arm.yaml r.csv --catalogue {}",
    "columns {}",
    "columns r.csv --arm {}",
    "compare {} r.csv r.csv",
    "compare arm.yaml {} r.csv",
    "compare arm.yaml r.csv {}",
    "compare arm.yaml r.csv r.csv --recording-yaml {}",
    "compare arm.yaml r.csv r.csv --catalogue {}",
    "predict {} r.csv",
    "predict arm.yaml {}",
    "predict arm.yaml r.csv --recording-yaml {}",
    "predict arm.yaml r.csv --catalogue {}",
    "compensate {}",
    "compensate arm.yaml --poses {}",
    "compensate arm.yaml --catalogue {}",
    "plan {} --poses 9",
    "plan arm.yaml --poses 9 --after {}",
    "plan arm.yaml --poses 9 --after r.csv --after {}",
    "plan arm.yaml --instrument motion --at {}",
    "plan arm.yaml --poses 9 --catalogue {}",
    "budget {}",
    "budget arm.yaml --sheet {}",
    "budget arm.yaml --problem {}",
    "budget arm.yaml --catalogue {}",
    "watch {} r.csv r.csv r.csv",
    "watch arm.yaml r.csv r.csv {}",
    "watch arm.yaml r.csv r.csv r.csv --recording-yaml {}",
    "watch arm.yaml r.csv r.csv r.csv --catalogue {}",
    "import {} --out i.yaml",
    "export {} --to urdf",
    "export arm.yaml --into {} --out a.urdf",
    "export arm.yaml --to urdf --catalogue {} --out a.urdf",
    "materials list --catalogue {}",
    "materials show steel-s355 --catalogue {}",
    "materials compare steel-s355 aluminium-6061-t6 --catalogue {}",
    "materials add x elastic_modulus='70 GPa' poisson_ratio=0.3 density='2700 kg/m^3' --source a --catalogue {}",
    "materials edit x density '3000 kg/m^3' --source a --catalogue {}",
    "materials remove x --catalogue {}",
    "materials remove x --used-in {}",
    "materials check {}",
    "materials check --catalogue {}",
    "materials import {}",
    "materials import m.csv --catalogue {}",
    "materials export --catalogue {} --out e.csv",
    "sections list --catalogue {}",
    "sections show 'IPE 80' --catalogue {}",
    "sections compare 'IPE 80' 'IPE 100' --catalogue {}",
    "sections check {}",
    "sections import {}",
    "sections remove x --used-in {}",
    "sections export --catalogue {} --out e.csv",
    "actuators list --catalogue {}",
    "actuators show RV-20E --catalogue {}",
    "actuators check {}",
    "actuators import {}",
    "actuators remove x --used-in {}",
    "actuators export --catalogue {} --out e.yaml",
    "actuators edit x mass 3kg --catalogue {}",
    "tables --catalogue {}",
    "serve {}",
]
"""Every place of every command where a file is named that is read."""
WRITTEN = {"--out", "--json", "--markdown", "--pdf", "--csv", "--plot"}
NAMES = {
    "/dev/zero": "is a device",
    "loop": "Too many levels of symbolic links",
    LONG: "name too long",
    ".": "is a directory",
    "pipe": "pipe through which nothing came",
}


@pytest.fixture
def odd_names(bench, monkeypatch):
    """A loop and a pipe in a folder that has all else that the commands name."""
    os.symlink("loop", bench / "loop")
    os.mkfifo(bench / "pipe")
    (bench / "r.csv").write_text("q1_deg,q2_deg,x_mm,y_mm\n0,0,700,0\n")
    (bench / "m.csv").write_text("name,elastic_modulus,poisson_ratio,density,source\nmine,70 GPa,0.3,2700 kg/m^3,own\n")
    monkeypatch.setattr("linkwright.core.units.files._PATIENCE", 0.01)


@pytest.mark.usefixtures("odd_names")
@pytest.mark.parametrize("line", INPUTS)
def test_what_is_no_file_is_one_line(linkwright, line):
    """A device that never ends and a pipe through which nothing comes, as any file of any command; and other names."""
    few = line.startswith(("evaluate", "diagnose", "materials check"))
    for name in NAMES if few else ("/dev/zero", "pipe"):
        status, out, err = linkwright(*(word.format(name) for word in shlex.split(line)))
        assert (status, out, err.count("\n")) == (2, "", 1), name
        # What an ending or a folder should be is told before the file is opened.
        elsewise = line.startswith("serve") or " import " in line
        assert NAMES[name] in err or (name in err and elsewise)


def test_every_file_of_every_command_is_tried():
    for name in commands():
        for path, command in commands_of(typer.main.get_command(command_line(name)), ()):
            own = [line for line in INPUTS if line.startswith(" ".join(path))]
            for param in command.params:
                option = param.opts[-1]
                if "Path" not in repr(param.type_descriptor) or option in WRITTEN or edits(path):
                    continue
                named = f"{option} {{}}" if option.startswith("--") else "{}"
                assert any(named in line for line in own), (path, option)


def commands_of(command, path):
    """The commands below one, each with its words."""
    below = getattr(command, "commands", None)
    if below is None:
        yield path, command
    else:
        for name, item in below.items():
            yield from commands_of(item, (*path, name))


def edits(path):
    """Whether a command changes an own catalogue: those of materials, which are tried, stand for the others."""
    return len(path) == 2 and path[0] != "materials"


@pytest.mark.parametrize("option", ["--json", "--markdown", "--out"])
@pytest.mark.parametrize("name", ["loop", LONG, "b" * 253])
def test_what_cannot_be_written_is_said_before_anything_is_computed(linkwright, bench, monkeypatch, option, name):
    """A name that leaves no room for the neighbour, from which the file would be renamed, cannot be written either."""
    if (option, name) == ("--out", "b" * 253):
        pytest.skip("a folder has no neighbour")
    os.symlink("loop", bench / "loop")
    monkeypatch.setattr("linkwright.evaluate", lambda *_, **__: pytest.fail("computed"))
    status, out, err = linkwright("evaluate", "arm.yaml", option, name)
    assert (status, out, err.count("\n")) == (2, "", 1)


def test_settings_beside_a_recording_may_be_a_loop(linkwright, bench):
    """They are optional, and are not there."""
    os.symlink("recording.yaml", bench / "recording.yaml")
    (bench / "r.csv").write_text("q1_deg,q2_deg,x_mm,y_mm\n0,0,700,0\n")
    assert linkwright("predict", "arm.yaml", "r.csv")[0] == 0


def test_a_pipe_is_read_and_one_that_nobody_writes_to_is_given_up(linkwright, bench, monkeypatch):
    """`linkwright evaluate <(generate)` is a habit of shells; what was read is not opened again for the report."""
    os.mkfifo(bench / "pipe")
    text = (bench / "arm.yaml").read_text()
    writer = threading.Thread(target=(bench / "pipe").write_text, args=(text,))
    writer.start()
    assert linkwright("evaluate", "pipe", "--out", "out")[0] == 0
    writer.join()
    assert "pipe</th><td>no longer there" in (bench / "out" / "report.html").read_text()
    monkeypatch.setattr("linkwright.core.units.files._PATIENCE", 0.05)
    status, _, err = linkwright("evaluate", "pipe")
    assert status == 2
    assert "pipe through which nothing came" in err


def test_the_null_device_says_nothing(linkwright, bench):
    """`--recording-yaml /dev/null` stands for no settings."""
    (bench / "r.csv").write_text("q1_deg,q2_deg,x_mm,y_mm\n0,0,700,0\n")
    (bench / "recording.yaml").write_text("sigma: [wrong]\n")
    assert linkwright("predict", "arm.yaml", "r.csv")[0] == 2
    assert linkwright("predict", "arm.yaml", "r.csv", "--recording-yaml", "/dev/null")[0] == 0


def test_what_is_larger_than_it_says_is_refused(tmp_path):
    """What a file says of its size is not believed: it is read as far as its bound and no further."""
    from linkwright.core.units.files import read_bytes
    from linkwright.core.units.quantities import InputError

    path = tmp_path / "large"
    path.write_bytes(b"x" * (3 * 1024**2 + 1))
    assert len(read_bytes(path, 4 * 1024**2)) == 3 * 1024**2 + 1
    with pytest.raises(InputError, match="is larger than 3 MB"):
        read_bytes(path, 3 * 1024**2)


def test_a_left_over_neighbour_does_not_make_a_folder_somebody_elses(linkwright, bench):
    """What a kill leaves behind while `result.json` is first written, and later."""
    (bench / "out").mkdir()
    (bench / "out" / ".result.json.4711").write_text("{")
    assert linkwright("evaluate", "arm.yaml", "--out", "out")[0] == 0
    assert linkwright("evaluate", "arm.yaml", "--out", "out")[0] == 0
    (bench / "out" / ".mine.4711").write_text("")
    status, _, err = linkwright("evaluate", "arm.yaml", "--out", "out")
    assert status == 2
    assert "holds other files (.mine.4711)" in err


def test_a_catalogue_beside_a_left_over_neighbour_is_edited(linkwright, bench):
    """The neighbour of an edit that was killed is written over by the next."""
    (bench / ".own.yaml.new").write_text("half of a fi")
    (bench / ".own.yaml.lock").write_text("")
    given = ("elastic_modulus=70 GPa", "poisson_ratio=0.3", "density=2700 kg/m^3")
    status, _, err = linkwright(
        "materials", "add", "mine", *given, "--source", "A data sheet", "--catalogue", "own.yaml"
    )
    assert (status, err) == (0, "")
    assert not (bench / ".own.yaml.new").exists()


def test_results_are_on_the_disk_before_they_are_named(linkwright, monkeypatch):
    """Each file is flushed, then renamed, then its folder is flushed."""
    done = []
    flush, rename = os.fsync, os.replace
    monkeypatch.setattr(os, "fsync", lambda file: done.append("flush") or flush(file))
    monkeypatch.setattr(os, "replace", lambda *names: done.append("rename") or rename(*names))
    monkeypatch.setattr("pathlib.Path.replace", lambda self, to: os.replace(self, to))
    assert linkwright("evaluate", "arm.yaml", "--json", "result.json")[0] == 0
    assert done == ["flush", "rename", "flush"]
