"""How a command ends: status, what it printed, and what it printed as an error."""

from linkwright.cli import run


def of_catalogue(group, tmp_path, tmp_path_factory, monkeypatch, capsys):
    """Runs `linkwright GROUP` in a folder of its own with a catalogue of its own, in `configuration` there."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path_factory.mktemp("drafts")))
    for name in ("LINKWRIGHT_CATALOGUE", "LINKWRIGHT_SECTIONS", "VISUAL", "EDITOR"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "configuration"))
    monkeypatch.setattr(
        "linkwright.core.units.files.user_config_dir", lambda name: str(tmp_path / "configuration" / name)
    )

    def command(*arguments):
        status = run([group, *(str(argument) for argument in arguments)])
        printed = capsys.readouterr()
        return status, printed.out, printed.err

    return command


def ok(result):
    status, out, err = result
    assert (status, err) == (0, "")
    return out


def wrong(result, words):
    status, out, err = result
    assert status == 2
    assert words in err
    assert err.count("\n") == 1
    assert out == ""
