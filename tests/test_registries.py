"""Open lists: what is shipped, registered and brought by installed packages, and what is refused."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from multiprocessing import get_context
from pathlib import Path

import pytest

import linkwright as lw
from linkwright.core.arm.effects import EFFECTS, Effect
from linkwright.core.arm.figures import FIGURES
from linkwright.core.registries import Registry
from linkwright.core.sections import SHAPES
from linkwright.core.sections.shapes.circle import Circle
from linkwright.core.units.quantities import InputError
from tests.test_house import ROOT

OFFSET = EFFECTS["encoder_offset"]


def fruit(*names: str, group: str = "linkwright.no_such_group") -> Registry[str]:
    """A registry of texts that are their own names."""
    made: Registry[str] = Registry(
        "fruit", group, str, lambda entry: None if isinstance(entry, str) else f"{entry!r} is no text"
    )
    made.ship(*names)
    return made


def test_order_is_shipped_then_registered():
    listed = fruit("pear", "apple")
    listed.register("fig")
    assert list(listed) == ["pear", "apple", "fig"]
    assert len(listed) == 3
    assert listed["fig"] == "fig"
    assert "plum" not in listed
    assert listed.get("plum") is None


@pytest.mark.parametrize(
    ("entry", "line"),
    [
        ("pear", "there is a fruit 'pear' already; choose another name"),
        ("fig", "there is a fruit 'fig' already; another name, or withdraw('fig') first"),
        ("Big Fig", "the name of fruit 'Big Fig' needs small letters"),
        (3, "3 is no text"),
    ],
)
def test_wrong_entries_are_refused_in_one_line(entry, line):
    listed = fruit("pear")
    listed.register("".join(["f", "ig"]))
    # The same name by another object: the very same object may be registered twice.
    with pytest.raises(InputError, match=line.replace("(", r"\(").replace(")", r"\)")):
        listed.register("".join(list(entry)) if isinstance(entry, str) else entry)
    assert list(listed) == ["pear", "fig"]


def test_what_is_registered_can_be_withdrawn_and_what_is_shipped_cannot():
    listed = fruit("pear")
    listed.register("fig")
    listed.withdraw("fig")
    assert list(listed) == ["pear"]
    with pytest.raises(InputError, match="'pear' is shipped, and stays"):
        listed.withdraw("pear")
    with pytest.raises(InputError, match="'fig' is not registered"):
        listed.withdraw("fig")


def test_effects_and_shapes_are_such_lists():
    own = replace(OFFSET, id="my_offset")
    EFFECTS.register(own)
    try:
        assert EFFECTS["my_offset"] is own
        assert list(EFFECTS)[-1] == "my_offset"
    finally:
        EFFECTS.withdraw("my_offset")
    assert "my_offset" not in EFFECTS
    with pytest.raises(InputError, match="an effect must be an Effect"):
        EFFECTS.register("backlash")  # type: ignore[arg-type]
    round_bar = type("RoundBar", (Circle,), {"shape": "round_bar"})
    SHAPES.register(round_bar)
    try:
        assert SHAPES["round_bar"] is round_bar
    finally:
        SHAPES.withdraw("round_bar")
    with pytest.raises(InputError, match="a shape must be a class derived from"):
        SHAPES.register(Circle(diameter=0.1))  # type: ignore[arg-type]


# ---- installed packages: a folder with the metadata that an installer would have written


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({}, "there is a limit 'mass' already"),
        ({"name": "thickness"}, "the name of a range of sizes"),
        ({"name": "weight", "kind": "heaviness"}, "no kind of quantity 'heaviness'"),
        ({"name": "weight", "senses": ()}, "needs senses"),
        ({"name": "weight", "follows": lw.at_poses("heft", list)}, "values called 'heft'; give both one name"),
    ],
)
def test_a_limit_that_could_not_be_held_is_refused(changed, said):
    """And one that can be is a limit like any other, until it is withdrawn."""
    with pytest.raises(InputError, match=re.escape(said)):
        lw.limits.register(replace(FIGURES["mass"], **changed))
    lw.limits.register(replace(FIGURES["mass"], name="weight"))
    try:
        assert list(lw.limits)[-1] == "weight"
    finally:
        lw.limits.withdraw("weight")
    assert "weight" not in lw.limits


def install(folder: Path, name: str, module: str, entry: str, group: str = "linkwright.effects") -> None:
    """Lay out a package as an installer does: its module and its `dist-info`."""
    (folder / f"{name}.py").write_text(module, encoding="utf-8")
    info = folder / f"{name}-1.2.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.2\n", encoding="utf-8")
    (info / "entry_points.txt").write_text(f"[{group}]\n{name} = {name}:{entry}\n", encoding="utf-8")


GOOD = """
from dataclasses import replace
from linkwright.core.arm.effects import EFFECTS
MINE = replace(EFFECTS["encoder_offset"], id="installed_offset")
PAIR = (MINE, replace(MINE, id="second_offset"))
"""


def ask(folder: Path, code: str) -> subprocess.CompletedProcess[str]:
    """What a fresh interpreter says that finds packages in a folder."""
    paths = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), str(folder)])}
    return subprocess.run(
        [sys.executable, "-c", code], env=paths, cwd=folder, capture_output=True, text=True, check=False
    )


LIST = "from linkwright.cli import run; import sys; sys.exit(run(['effects', 'list', '--json', 'all.json']))"


def test_an_installed_package_brings_effects(tmp_path):
    install(tmp_path, "brings", GOOD, "PAIR")
    done = ask(tmp_path, "import linkwright as lw; print(list(lw.effects)[-2:], 'installed_offset' in lw.effects)")
    assert done.stdout.strip() == "['installed_offset', 'second_offset'] True", done.stderr


def test_packages_are_loaded_only_when_asked_for(tmp_path):
    install(tmp_path, "loud", f"print('loaded')\n{GOOD}", "MINE")
    quiet = ask(tmp_path, "from linkwright.core.arm.effects import EFFECTS; EFFECTS['backlash']")
    assert quiet.stdout == "", quiet.stderr
    asked = ask(tmp_path, "from linkwright.core.arm.effects import EFFECTS; EFFECTS['installed_offset']; len(EFFECTS)")
    assert asked.stdout == "loaded\n", asked.stderr


@pytest.mark.parametrize(
    ("module", "entry", "said"),
    [
        ("import no_such_module", "MINE", "cannot be loaded: ModuleNotFoundError: No module named 'no_such_module'"),
        pytest.param("def broken(:\n", "MINE", "cannot be loaded: SyntaxError", marks=pytest.mark.slow),
        pytest.param("1 / 0", "MINE", "cannot be loaded: ZeroDivisionError", marks=pytest.mark.slow),
        pytest.param(GOOD, "THEIRS", "cannot be loaded: AttributeError", marks=pytest.mark.slow),
        pytest.param(
            "MINE = 'backlash'", "MINE", "an effect must be an Effect, not 'backlash'", marks=pytest.mark.slow
        ),
        (GOOD.replace("installed_offset", "backlash"), "MINE", "there is an effect 'backlash' already"),
    ],
)
def test_a_broken_package_is_named_in_one_line(tmp_path, module, entry, said):
    install(tmp_path, "breaks", module, entry)
    done = ask(tmp_path, LIST)
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert line.startswith(f"the installed package breaks 1.2 (entry point breaks = breaks:{entry})")
    assert said in line


def test_shapes_come_from_packages_too(tmp_path):
    module = "from linkwright.core.sections.shapes.circle import Circle\nclass Bar(Circle):\n    shape = 'round_bar'\n"
    install(tmp_path, "bars", module, "Bar", "linkwright.sections")
    done = ask(tmp_path, "import linkwright as lw; print(lw.shapes.RoundBar(diameter=0.1).shape)")
    assert done.stdout.strip() == "round_bar", done.stderr


# ---- worker processes


def known(name: str) -> bool:
    return name in EFFECTS


def bring(effect: Effect) -> None:
    EFFECTS.register(effect)


def test_workers_know_what_was_registered():
    """Forked ones by themselves, fresh ones through the pool's initializer."""
    own = replace(OFFSET, id="workers_offset")
    EFFECTS.register(own)
    try:
        if sys.platform == "linux":
            with ProcessPoolExecutor(1, mp_context=get_context("fork")) as pool:
                assert pool.submit(known, own.id).result()
        with ProcessPoolExecutor(1, mp_context=get_context("spawn"), initializer=bring, initargs=(own,)) as pool:
            assert pool.submit(known, own.id).result()
    finally:
        EFFECTS.withdraw(own.id)
