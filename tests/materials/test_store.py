"""Files that several writers change at once: nothing is lost, and no instant leaves half a file."""

import json
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import pytest

from linkwright.core.catalogues import editor
from linkwright.core.catalogues.materials import MATERIALS
from linkwright.core.materials.catalogue import load_layer
from linkwright.core.units.quantities import InputError

ROOT = Path(__file__).resolve().parents[2]
HEAD = "# a comment\nformat_version: 1\nreferences: {s: some source}\nmaterials:\n"


def entry(name, density=0.5):
    return f"  {name}: {{source: s, elastic_modulus: 1 GPa, density: {density} kg/m^3}}  # of {name}\n"


def write_many(path: str, name: str, edits: int) -> None:
    for number in range(101 - edits, 101):
        MATERIALS.set_keys(path, name, {"density": f"{number} kg/m^3"})
        if number % 10 == 0:  # no other writer has brought an old value back
            assert load_layer(path).materials[name].need("density") == number


@pytest.mark.parametrize(("writers", "edits"), [(3, 20), pytest.param(8, 100, marks=pytest.mark.slow)])
def test_several_writers_lose_no_edit(tmp_path, writers, edits):
    path = tmp_path / "c.yaml"
    names = [f"m{index}" for index in range(writers)]
    path.write_text(HEAD + "".join(entry(name) for name in names), encoding="utf-8")
    with ProcessPoolExecutor(writers) as pool:
        for done in [pool.submit(write_many, str(path), name, edits) for name in names]:
            done.result()
    expected = HEAD + "".join(entry(name, 100) for name in names)
    assert path.read_text(encoding="utf-8") == expected


@pytest.mark.skipif(sys.platform == "win32", reason="kills by signal")
def test_a_kill_before_any_line_leaves_the_old_or_the_new_file(tmp_path):
    (tmp_path / "given").mkdir()
    (tmp_path / "given" / "c.yaml").write_text(HEAD + entry("x", 0), encoding="utf-8")
    script = Path(__file__).with_name("killed_writer.py")
    done = subprocess.run(
        [sys.executable, str(script), str(tmp_path)],
        cwd=ROOT,
        env={"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    kills = [json.loads(line) for line in done.stdout.splitlines()]
    lines, landed = [line for line, _ in kills], [new for _, new in kills]
    # The old file before the rename of the file itself, the new one from the next line on.
    rename = lines.index("beside.replace(target)")
    assert landed == [False] * (rename + 1) + [True] * (len(lines) - rename - 1)
    assert {"stream.write(content)", "os.fsync(stream.fileno())", "lock.release()"} <= set(lines)
    assert lines[-1] is None  # the last one was not killed


def test_links_and_permissions_stay(tmp_path):
    real, link = tmp_path / "real.yaml", tmp_path / "link.yaml"
    real.write_text("a")
    real.chmod(0o640)
    link.symlink_to(real)
    editor.edit_text(link, lambda _: ("b", "wrote b"))
    assert link.is_symlink()
    assert real.read_text() == "b"
    assert real.stat().st_mode & 0o777 == 0o640


def test_a_folder_in_the_way_is_wrong_input(tmp_path):
    (tmp_path / "c.yaml").mkdir()
    with pytest.raises(InputError, match="directory"):
        editor.edit_text(tmp_path / "c.yaml", lambda _: ("a", "x"))
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be"):
        editor.edit_text(tmp_path / "file" / "c.yaml", lambda _: ("a", "x"))
