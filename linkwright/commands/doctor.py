"""`linkwright doctor`: is the installation sound, each check with what it found and what to do where it is wrong."""

from __future__ import annotations

import os
import re
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib import import_module, metadata
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal

from linkwright.commands.options import JsonFile, write_content
from linkwright.core.units.extras import install_line
from linkwright.core.units.quantities import InputError
from linkwright.json.fields import fields
from linkwright.output.files import check_target
from linkwright.report.pdf import need_browser

State = Literal["sound", "left out", "wrong"]

_NEEDS = re.compile(r"([A-Za-z0-9._-]+)(?:[^;]*>=([0-9.]+))?")
_MODULES = MappingProxyType({"PyYAML": "yaml", "mcap-ros2-support": "mcap_ros2"})
"""The names by which packages are imported that go by another."""
_PARTS = (
    ("the browser (serve)", ("nicegui",), "browser"),
    ("drawings (export --to dxf)", ("ezdxf",), "dxf"),
    ("solids (export --to step)", ("build123d",), "step"),
    ("ROS bags and MCAP files", ("mcap", "mcap-ros2-support", "rosbags"), "logs"),
    ("parquet recordings", ("pyarrow",), "parquet"),
    ("clusters (--dask)", ("dask", "distributed"), "cluster"),
)
"""What is optional, its packages and the extra that brings them."""
OLDEST_PYTHON = (3, 11)


@dataclass(frozen=True)
class Check:
    """What was looked at, how it stands (an optional part may be left out), what was found, and what would do."""

    name: str
    state: State
    found: str
    would_do: str = ""


@dataclass(frozen=True)
class Checkup:
    """All checks of one installation."""

    checks: tuple[Check, ...]

    @property
    def sound(self) -> bool:
        """Whether nothing is wrong."""
        return all(check.state != "wrong" for check in self.checks)


def checked() -> Checkup:
    """Look at everything."""
    return Checkup(
        (
            _python(),
            *_packages(),
            _solver(),
            *_catalogues(),
            *_folders(),
            _threads(),
            *(_part(*item) for item in _PARTS),
            _printer(),
        )
    )


def _printer() -> Check:
    name = "reports as PDF (--pdf)"
    try:
        return Check(name, "sound", need_browser())
    except InputError:
        return Check(name, "left out", "no browser that prints", "install Chromium, Chrome or Edge")


def _python() -> Check:
    version = ".".join(str(part) for part in sys.version_info[:3])
    if sys.version_info < OLDEST_PYTHON:
        return Check("Python", "wrong", version, f"install Python {'.'.join(map(str, OLDEST_PYTHON))} or newer")
    return Check("Python", "sound", version)


def _packages() -> Iterator[Check]:
    """Each package that the distribution needs: there, new enough, and importable."""
    try:
        needs = metadata.requires("linkwright") or []
    except metadata.PackageNotFoundError:
        yield Check("linkwright", "wrong", "not installed, only run", "pip install . in its folder")
        return
    yield Check("linkwright", "sound", metadata.version("linkwright"))
    for need in needs:
        parsed = None if "extra ==" in need else _NEEDS.match(need)
        if parsed is not None:
            yield _package(parsed[1], parsed[2] or "0")


def _package(name: str, oldest: str) -> Check:
    would_do = f"pip install '{name}>={oldest}'"
    try:
        version = metadata.version(name)
        import_module(_MODULES.get(name, name))
    except (ImportError, OSError) as error:
        return Check(name, "wrong", f"cannot be used: {error}", would_do)
    if _numbers(version) < _numbers(oldest):
        return Check(name, "wrong", version, would_do)
    return Check(name, "sound", version)


def _numbers(version: str) -> tuple[int, ...]:
    return tuple(int(part) for part in re.findall(r"[0-9]+", version.partition("+")[0])[:3])


def _solver() -> Check:
    """Solve what has a known solution: the point of the unit disc that is nearest to (3, 4)."""
    import casadi as ca

    from linkwright.core.optimize.exchange.program import ipopt_options

    try:
        at: Any = ca.MX.sym("at", 2)
        program = {"x": at, "f": (at[0] - 3.0) ** 2 + (at[1] - 4.0) ** 2, "g": ca.dot(at, at)}
        solve = ca.nlpsol("check", "ipopt", program, ipopt_options())
        solution = solve(x0=[0.1, 0.1], ubg=1.0)["x"].full().ravel()
    except RuntimeError as error:  # CasADi's own, whatever was wrong
        lines = str(error).strip().splitlines()
        return Check("solver (IPOPT)", "wrong", lines[-1] if lines else "fails", "pip install --force-reinstall casadi")
    if abs(solution[0] - 0.6) > 1e-6 or abs(solution[1] - 0.8) > 1e-6:
        return Check("solver (IPOPT)", "wrong", f"solves wrongly: {solution}", "pip install --force-reinstall casadi")
    return Check("solver (IPOPT)", "sound", "solves a program of known solution")


def _catalogues() -> Iterator[Check]:
    from linkwright.core.arm.actuators.catalogue import USER_ACTUATORS, load_actuators
    from linkwright.core.materials.catalogue import USER_CATALOGUE, load_catalogue
    from linkwright.core.sections.stock.tables import USER_STOCK, load_stock

    own_materials, own_stock = USER_CATALOGUE.path(), USER_STOCK.path()
    yield _catalogue("materials", lambda: len(load_catalogue().names), own_materials)
    yield _catalogue("stock sizes", lambda: len(load_stock()), own_stock)
    yield _catalogue("actuators", lambda: len(load_actuators()), USER_ACTUATORS.path())


def _catalogue(name: str, count: Callable[[], int], path: Path | None) -> Check:
    there = path is not None and os.path.exists(path)
    try:
        number = count()
    except InputError as error:
        return Check(f"catalogue: {name}", "wrong", str(error), "mend the file, or move it away")
    return Check(f"catalogue: {name}", "sound", f"{number} read" + (f", those of {path} among them" if there else ""))


def _folders() -> Iterator[Check]:
    """Where own catalogues go, and where temporary files do."""
    from linkwright.core.materials.catalogue import USER_CATALOGUE

    yield _folder("folder of own catalogues", USER_CATALOGUE.path().parent)
    try:
        temporary = Path(tempfile.gettempdir())
    except OSError as error:
        yield Check("folder of temporary files", "wrong", str(error), "set TMPDIR to a folder that can be written")
        return
    yield _folder("folder of temporary files", temporary)


def _folder(name: str, folder: Path) -> Check:
    """Write a file there; a folder that is not there yet is made in the nearest one that is."""
    there = next((parent for parent in (folder, *folder.parents) if os.path.isdir(parent)), folder)
    try:
        with tempfile.TemporaryFile(dir=there):
            pass
    except OSError as error:
        would_do = f"make {there} writable, or name another file by LINKWRIGHT_CATALOGUE and LINKWRIGHT_SECTIONS"
        return Check(name, "wrong", f"{folder}: {error.strerror or error}", would_do)
    return Check(name, "sound", f"{folder}" + ("" if there == folder else " (made when it is first needed)"))


def _threads() -> Check:
    """How many threads linear algebra takes. One is best; none is wrong."""
    import numpy as np
    import scipy.linalg

    from linkwright.core.executors.threads import threads

    scipy.linalg.lu(np.linalg.inv(np.eye(2)))  # now the libraries are loaded
    counts = sorted(set(threads()))
    cores = os.cpu_count() or 1
    text = f"{', '.join(map(str, counts)) or 'unknown'} of {cores} cores"
    hint = "without OPENBLAS_NUM_THREADS one is taken, which serves better" if max(counts, default=1) > 1 else ""
    return Check("threads of linear algebra", "sound", text, hint)


def _part(name: str, packages: tuple[str, ...], extra: str) -> Check:
    """An optional part: it may be left out, but what is there must be importable."""
    would_do, versions = install_line(extra), list[str]()
    for package in packages:
        try:
            version = metadata.version(package)
        except metadata.PackageNotFoundError:
            return Check(name, "left out", f"{package} is not installed", would_do)
        try:
            import_module(_MODULES.get(package, package))
        except (ImportError, OSError) as error:
            return Check(name, "wrong", f"{package} cannot be used: {error}", would_do)
        versions.append(f"{package} {version}")
    return Check(name, "sound", ", ".join(versions))


HELP = """Is the installation sound: versions, solver, catalogues, folders, threads, optional parts; what to do if not.

Exit status 0 where it is, 1 where something is wrong.

Example: linkwright doctor
"""


def doctor(json: JsonFile = None) -> int:
    """Run the command."""
    from linkwright.screen.console import console, table

    check_target(json)
    found = checked()
    checks = [{**fields(check, "name", "state", "found"), "would_do": check.would_do or None} for check in found.checks]
    write_content(json, "doctor", {"sound": found.sound, "checks": checks})
    shown = table("what", "state", "found", "what would do")
    for item in found.checks:
        shown.add_row(item.name, item.state.upper() if item.state == "wrong" else item.state, item.found, item.would_do)
    screen = console()
    screen.print(shown)
    wrong = [check.name for check in found.checks if check.state == "wrong"]
    screen.print(f"wrong: {', '.join(wrong)}" if wrong else "The installation is sound.", soft_wrap=True)
    if json is not None:
        screen.print(f"written: {json}", soft_wrap=True)
    return 0 if found.sound else 1
