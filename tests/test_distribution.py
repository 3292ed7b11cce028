"""What people install: the wheel, built from the sdist, in a clean environment far from the repository."""

import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from dataclasses import dataclass
from pathlib import Path

import pytest
import yaml

from tests.test_house import CORE, MAY_USE, ROOT, tracked_files

ROOMS = tuple(MAY_USE)

ARM = """\
name: two links on a bench
gravity: [0 m/s^2, -9.81 m/s^2, 0 m/s^2]
temperature: 20 degC
chain:
  - joint: {type: revolute, range: [-90 deg, 90 deg], clearance: 0.03 mm, backlash: 3 arcmin}
    link: {length: 400 mm, section: {shape: circle, diameter: 60 mm}, material: aluminium-6061-t6}
  - joint: {type: revolute, range: [-2 rad, 2 rad], clearance: 0.02 mm, stiffness: 50 kN*m/rad, mass: 3 kg}
    link: {length: 300 mm, section: {shape: tube, diameter: 50 mm, thickness: 4 mm}, material: steel-s355}
payload: {mass: 2 kg, force: [0 N, 0 N, 0 N]}
"""


@dataclass(frozen=True)
class Built:
    """The built archives."""

    wheel: Path
    sdist: Path


@dataclass(frozen=True)
class Installed:
    """The environment in which the wheel is installed."""

    wheel: Path
    environment: Path

    def run(self, *command: str, cwd: Path) -> subprocess.CompletedProcess[str]:
        """Run a program of the environment there, with nothing of this process's paths."""
        program = self.environment / ("Scripts" if os.name == "nt" else "bin") / command[0]
        return subprocess.run([str(program), *command[1:]], cwd=cwd, env=clean_surroundings(), **CAPTURED)


CAPTURED = {"capture_output": True, "text": True, "check": False, "stdin": subprocess.DEVNULL}


def clean_surroundings() -> dict[str, str]:
    """The environment variables without those through which a Python finds modules of ours."""
    return {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "VIRTUAL_ENV")}


def must(command: list[str], cwd: Path) -> None:
    """Run a preparing command; what it printed is shown where it fails."""
    done = subprocess.run(command, cwd=cwd, env=clean_surroundings(), **CAPTURED)
    if done.returncode != 0:
        pytest.fail(f"{' '.join(command)}\n{done.stdout}\n{done.stderr}")


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Built:
    """Copy the tracked files and build from the copy."""
    place = tmp_path_factory.mktemp("distribution")
    tree = place / "tree"
    for path in tracked_files():
        copy = tree / path.relative_to(ROOT)
        copy.parent.mkdir(parents=True, exist_ok=True)
        copy.write_bytes(path.read_bytes())
    for link in (item for item in CORE.iterdir() if item.is_symlink()):
        (tree / link.relative_to(ROOT)).symlink_to(link.readlink())
    # Told of neither, `build` makes the wheel from the sdist: a file missing there is missing in both.
    must([sys.executable, "-m", "build", "--no-isolation", "--outdir", str(place / "dist"), str(tree)], place)
    (wheel,) = (place / "dist").glob("*.whl")
    (sdist,) = (place / "dist").glob("*.tar.gz")
    return Built(wheel, sdist)


@pytest.fixture(scope="module")
def installed(built: Built, tmp_path_factory: pytest.TempPathFactory) -> Installed:
    """Install the wheel on the pinned dependencies and nothing else.

    pip gets no index for the wheel itself, so a dependency that the lock lacks is an error.
    """
    place = tmp_path_factory.mktemp("environment")
    environment = place / "environment"
    must([sys.executable, "-m", "venv", str(environment)], place)
    result = Installed(built.wheel, environment)
    pip = ("python", "-m", "pip", "install", "--quiet", "--disable-pip-version-check")
    for arguments in (
        ("--require-hashes", "-r", str(ROOT / "requirements.lock")),
        ("--no-index", str(built.wheel)),
    ):
        done = result.run(*pip, *arguments, cwd=place)
        assert done.returncode == 0, done.stderr
    return result


def installed_as(path: Path) -> str:
    """Where a file or folder of a room stands in the wheel and the sdist."""
    own = path.relative_to(ROOT).as_posix()
    return own if own.startswith("linkwright") else f"linkwright/core/{own}"


def answer(installed: Installed, cwd: Path, *command: str) -> str:
    """What a command prints, which must end with exit status 0 and without a traceback."""
    done = installed.run(*command, cwd=cwd)
    assert done.returncode == 0, f"{done.stdout}\n{done.stderr}"
    assert "Traceback" not in done.stderr
    return done.stdout


def test_wheel_holds_every_file_of_the_packages(built):
    """Modules, catalogues, page templates: whatever lies in a package's folder, and nothing else."""
    with zipfile.ZipFile(built.wheel) as archive:
        packed = {name for name in archive.namelist() if ".dist-info/" not in name}
    expected = {installed_as(path) for path in tracked_files() if path.relative_to(ROOT).parts[0] in ROOMS}
    assert packed == expected
    assert any(name.startswith("linkwright/core/materials/catalogue/") and name.endswith(".yaml") for name in packed)
    assert {name.split("/")[0] for name in packed} == {"linkwright"}


def test_sdist_holds_what_a_build_needs(built):
    """The source archive has the packages and their build file, and the tests with all that they read."""
    with tarfile.open(built.sdist) as archive:
        packed = {name.partition("/")[2] for name in archive.getnames()}
    rooms = (installed_as(ROOT / room / "__init__.py") for room in ROOMS)
    assert {"pyproject.toml", "README.md", *rooms} <= packed
    folders = ("tests", "benchmarks", "examples", "handbook", "docs")
    tracked = {path.relative_to(ROOT) for path in tracked_files()}
    assert {path.as_posix() for path in tracked if path.parts[0] in folders} <= packed


def test_the_conda_recipe_asks_for_what_the_wheel_asks_for():
    """The same packages with the same versions, and the same version of this one."""
    recipe = (ROOT / "packaging" / "recipe.yaml").read_text(encoding="utf-8")
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    asked = yaml.safe_load(recipe)
    python, *packages = (line.replace(" ", "").lower() for line in asked["requirements"]["run"])
    assert packages == [line.lower() for line in project["dependencies"]]
    assert python == f"python{project['requires-python']}"
    assert asked["context"]["version"] == project["version"]


def test_what_is_an_extra_says_the_line_to_type(tmp_path):
    """Without NiceGUI and ezdxf all else works, and their commands say how to get them: by the packages' own names,
    which an index has wherever this program came from."""
    arm = tmp_path / "arm.yaml"
    arm.write_text(ARM, encoding="utf-8")
    for missing, command, line in (
        ("nicegui", ["serve", "."], "pip install 'nicegui<4,>=3.5'"),
        ("ezdxf", ["export", str(arm), "--to", "dxf", "--out", "a.dxf"], "pip install 'ezdxf<2,>=1.3'"),
    ):
        ask = f"import sys; sys.modules[{missing!r}] = None; from linkwright.cli import main; main({command!r})"
        environment = {**os.environ, "PYTHONPATH": str(ROOT)}
        done = subprocess.run([sys.executable, "-c", ask], cwd=tmp_path, env=environment, **CAPTURED)
        assert done.returncode == 2, done.stderr
        assert line in done.stderr
        assert done.stderr.count("\n") == 1


def test_a_major_that_nobody_tried_is_not_taken():
    """What breaks with every major has an upper bound, and the lock is within it."""
    with (ROOT / "pyproject.toml").open("rb") as file:
        project = tomllib.load(file)["project"]
    needs = [*project["dependencies"], *project["optional-dependencies"]["browser"]]
    pins = dict(re.findall(r"^([a-z]+)==([0-9]+)", (ROOT / "requirements.lock").read_text(encoding="utf-8"), re.M))
    for name in ("casadi", "nicegui", "plotly"):
        (bound,) = (re.search(r"<([0-9]+)", need) for need in needs if need.startswith(name))
        assert bound is not None
        assert int(pins[name]) == int(bound[1]) - 1


UNPACKED = """\
import linkwright as lw
from linkwright.core.units import reading

print(lw.__file__, reading.__file__, sep="\\n")
found = lw.evaluate(lw.read_arm("arm.yaml"))
print(found.max_error_mm, found.mass_kg, lw.materials["steel-s355"].name, lw.sections["IPE 80"].name)
"""


def test_a_wheel_that_is_unpacked_evaluates_an_arm(built, tmp_path):
    """Its own modules and data files are all that it needs of ours."""
    place = tmp_path / "unpacked"
    with zipfile.ZipFile(built.wheel) as archive:
        archive.extractall(place)
    (tmp_path / "arm.yaml").write_text(ARM, encoding="utf-8")
    environment = {**clean_surroundings(), "PYTHONPATH": str(place)}
    done = subprocess.run([sys.executable, "-P", "-c", UNPACKED], cwd=tmp_path, env=environment, **CAPTURED)
    assert (done.returncode, done.stderr) == (0, "")
    *files, figures = done.stdout.splitlines()
    assert all(Path(file).is_relative_to(place) for file in files)
    error, mass, *names = figures.split(maxsplit=3)
    assert 0.01 < float(error) < 10
    assert float(mass) == pytest.approx(4.416, abs=0.1)
    assert names == ["steel-s355", "IPE 80"]


@pytest.mark.slow
def test_modules_come_from_the_environment(installed, tmp_path):
    """An import that found the repository instead would prove nothing."""
    names = [installed_as(ROOT / room).replace("/", ".") for room in ROOMS]
    report = f"import importlib, json; print(json.dumps([importlib.import_module(n).__file__ for n in {names}]))"
    files = json.loads(answer(installed, tmp_path, "python", "-P", "-c", report))
    for file in files:
        assert Path(file).resolve().is_relative_to(installed.environment.resolve())


@pytest.mark.slow
def test_version_is_that_of_the_distribution(installed, tmp_path):
    """`python -m linkwright --version` and the command agree with the archive's name."""
    version = installed.wheel.name.split("-")[1]
    assert version in answer(installed, tmp_path, "python", "-P", "-m", "linkwright", "--version")
    assert version in answer(installed, tmp_path, "linkwright", "--version")


@pytest.mark.slow
def test_material_catalogue_is_installed(installed, tmp_path):
    """At least fifteen materials, by their names."""
    answer(installed, tmp_path, "linkwright", "materials", "list", "--json", "materials.json")
    content = json.loads((tmp_path / "materials.json").read_text(encoding="utf-8"))
    entries = content["materials"] if isinstance(content, dict) else content
    names = {entry if isinstance(entry, str) else entry["name"] for entry in entries}
    assert len(names) >= 15
    assert {"aluminium-6061-t6", "steel-s355"} <= names


@pytest.mark.slow
def test_section_list_is_installed(installed, tmp_path):
    """The shapes and the stock sizes, which lie in data files."""
    listing = answer(installed, tmp_path, "linkwright", "sections", "list")
    assert "circle" in listing
    assert "IPE 80" in listing


@pytest.mark.slow
def test_an_arm_is_evaluated(installed, tmp_path):
    """A file that someone wrote at home, far from any example: an error of a plausible size comes out."""
    (tmp_path / "arm.yaml").write_text(ARM, encoding="utf-8")
    answer(installed, tmp_path, "linkwright", "evaluate", "arm.yaml", "--json", "result.json")
    result = json.loads((tmp_path / "result.json").read_text(encoding="utf-8"))
    assert 0.01 < result["max_error_mm"] < 10
    assert result["mass_kg"] == pytest.approx(4.416, abs=0.1)


SCRIPT = """\
import linkwright as lw

print(f"{lw.evaluate(lw.read_arm('bench.yaml')).max_error_mm:.4f}")
print(lw.materials["steel-s355"].name, lw.sections["IPE 80"].name, lw.effects["backlash"].id)
"""


@pytest.mark.slow
@pytest.mark.parametrize("way", ["wheel", "editable"])
def test_files_named_like_our_packages_may_stand_beside_a_script(installed, tmp_path, way):
    """One name is installed, so nobody's `arm.py` is taken for ours, nor ours for theirs."""
    for room in set(ROOMS) - {"linkwright"}:
        (tmp_path / f"{room}.py").write_text(f"raise SystemExit('{room}.py of the user was imported')\n", "utf-8")
    (tmp_path / "bench.yaml").write_text(ARM, encoding="utf-8")
    script = tmp_path / "script.py"
    script.write_text(SCRIPT, encoding="utf-8")
    if way == "wheel":
        printed = answer(installed, tmp_path, "python", str(script))
    else:
        # The environment of these tests has the checkout installed by `pip install --editable`.
        done = subprocess.run([sys.executable, str(script)], cwd=tmp_path, env=clean_surroundings(), **CAPTURED)
        assert done.returncode == 0, done.stderr
        printed = done.stdout
    error, names = printed.splitlines()
    assert 0.01 < float(error) < 10
    assert names == "steel-s355 IPE 80 backlash"


# ---- a package of somebody else's that brings an effect


@pytest.fixture(scope="module")
def with_cable_drag(installed: Installed, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the example's arm and recording; its wheel, built from a copy, is installed beside ours."""
    place = tmp_path_factory.mktemp("cable-drag")
    tree = place / "tree"
    shutil.copytree(ROOT / "examples" / "cable-drag", tree)
    build = [sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", str(place / "dist"), str(tree)]
    must(build, place)
    (wheel,) = (place / "dist").glob("*.whl")
    pip = ("python", "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-index", str(wheel))
    done = installed.run(*pip, cwd=place)
    assert done.returncode == 0, done.stderr
    return tree


@pytest.mark.slow
@pytest.mark.usefixtures("with_cable_drag")
def test_an_installed_package_brings_its_effect(installed, tmp_path):
    """It is listed with those that are shipped, and keeps their contract."""
    answer(installed, tmp_path, "linkwright", "effects", "list", "--json", "effects.json")
    listed = [load["id"] for load in json.loads((tmp_path / "effects.json").read_text(encoding="utf-8"))["effects"]]
    assert "joint_compliance" in listed
    assert listed[-1] == "cable_drag"
    ask = "import linkwright as lw; lw.effects.check(lw.effects['cable_drag'])"
    answer(installed, tmp_path, "python", "-P", "-c", ask)


@pytest.mark.slow
def test_an_installed_effect_is_simulated_and_named(installed, with_cable_drag, tmp_path):
    """The example's commands, from the recording that they make to the joint and the pull."""
    entry = "{effect: cable_drag, at: 3, pull: 60 N}"
    arm, recording = str(with_cable_drag / "arm.yaml"), with_cable_drag / "recording.csv"
    plan = ("--poses", "40", "--payloads", "1 kg, 4 kg", "--repeats", "2", "--with", entry, "--out", "again.csv")
    answer(installed, tmp_path, "linkwright", "simulate", arm, *plan)
    assert (tmp_path / "again.csv").read_bytes() == recording.read_bytes()
    answer(installed, tmp_path, "linkwright", "diagnose", arm, str(recording), "--json", "result.json")
    result = (tmp_path / "result.json").read_text(encoding="utf-8")
    missing = json.loads(result)["missing"]
    assert [(item["effect"], item["at"]) for item in missing] == [("cable_drag", [3])]
    low, high = missing[0]["parameters"]["pull_3"]["ci95"]
    assert low < 60.0 < high
