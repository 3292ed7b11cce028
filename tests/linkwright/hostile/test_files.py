"""Files that are none, or that never end: one line that names the file, and nothing is waited for."""

import os
import threading

import pytest

LONG = "a" * 300
INPUTS = [
    ("evaluate", "{}"),
    ("diagnose", "arm.yaml", "{}"),
    ("diagnose", "{}", "r.csv"),
    ("diagnose", "arm.yaml", "r.csv", "--recording-yaml", "{}"),
    ("evaluate", "arm.yaml", "--problem", "{}"),
    ("evaluate", "arm.yaml", "--catalogue", "{}"),
    ("compensate", "arm.yaml", "--poses", "{}"),
    ("materials", "check", "{}"),
    ("sections", "check", "{}"),
]
NAMES = {
    "/dev/zero": "is a device",
    "loop": "Too many levels of symbolic links",
    LONG: "name too long",
    ".": "is a directory",
}


@pytest.mark.parametrize("name", NAMES, ids=["device", "loop", "long", "folder"])
@pytest.mark.parametrize("arguments", INPUTS, ids=" ".join)
def test_what_is_no_file_is_one_line(linkwright, bench, arguments, name):
    os.symlink("loop", bench / "loop")
    (bench / "r.csv").write_text("q1_deg,q2_deg,x_mm,y_mm\n0,0,700,0\n")
    status, out, err = linkwright(*(word.format(name) for word in arguments))
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert NAMES[name] in err


@pytest.mark.parametrize("option", ["--json", "--markdown", "--out"])
@pytest.mark.parametrize("name", ["loop", LONG, "b" * 250])
def test_what_cannot_be_written_is_said_before_anything_is_computed(linkwright, bench, monkeypatch, option, name):
    """A name that leaves no room for the neighbour, from which the file would be renamed, cannot be written either."""
    if (option, name) == ("--out", "b" * 250):
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
    """`linkwright evaluate <(generate)` is a habit of shells."""
    os.mkfifo(bench / "pipe")
    text = (bench / "arm.yaml").read_text()
    writer = threading.Thread(target=(bench / "pipe").write_text, args=(text,))
    writer.start()
    assert linkwright("evaluate", "pipe")[0] == 0
    writer.join()
    monkeypatch.setattr("units.files._PATIENCE", 0.05)
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
    from units.files import read_bytes
    from units.quantities import InputError

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
