"""`linkwright doctor`: is the installation sound, each check with its result and what to do where it is wrong."""

from __future__ import annotations

import platform
import re
from collections.abc import Callable, Iterator
from importlib import metadata
from typing import Any, NamedTuple

from linkwright.commands.options import JsonFile, write_content
from linkwright.core.units.extras import PROGRAM
from linkwright.core.units.quantities import InputError
from linkwright.output.files import check_target

HELP = """Is the installation sound: packages, solver, catalogues, threads, optional parts; what to do if not.

Exit status 0 where it is, 1 where something is wrong. Versions that do not fit together: pip check.

Example: linkwright doctor
"""
_REINSTALL = "pip install --force-reinstall casadi"


class Check(NamedTuple):
    """What was looked at, its state (`sound`, `wrong`, of an optional part `missing`), the result, what would do."""

    name: str
    state: str
    found: str
    would_do: str = ""


def _packages() -> Iterator[Check]:
    """The program's version, and that of each package that it needs or that an extra of it brings."""
    try:
        needs = metadata.requires(PROGRAM) or []
    except metadata.PackageNotFoundError:
        yield Check(PROGRAM, "wrong", "not installed, only run", "pip install . in its folder")
        return
    for need in (PROGRAM, *needs):
        requirement, _, marker = need.partition(";")
        name, extra = re.split(r"[^\w.-]", requirement.strip())[0], re.search(r"extra == .(\w+)", marker)
        label = f"{name} (extra {extra[1]})" if extra else name
        try:
            yield Check(label, "sound", metadata.version(name))
        except metadata.PackageNotFoundError:
            yield Check(label, "missing" if extra else "wrong", "not installed", f"pip install '{requirement.strip()}'")


def _solver() -> str:
    """Solve what has a known solution: the point of the unit disc that is nearest to (3, 4)."""
    import casadi as ca

    from linkwright.core.optimize.exchange.program import ipopt_options

    at: Any = ca.MX.sym("at", 2)
    program = {"x": at, "f": (at[0] - 3.0) ** 2 + (at[1] - 4.0) ** 2, "g": ca.dot(at, at)}
    solution = ca.nlpsol("check", "ipopt", program, ipopt_options())(x0=[0.1, 0.1], ubg=1.0)["x"].full().ravel()
    if max(abs(solution - [0.6, 0.8])) > 1e-6:
        raise RuntimeError(f"solves wrongly: {solution}")
    return "solves a program of known solution"


def _threads() -> str:
    """How many threads linear algebra takes, once its libraries are loaded. One is best; none is wrong."""
    import scipy.linalg

    from linkwright.core.executors.threads import threads

    scipy.linalg.lu([[1.0]])
    return ", ".join(str(count) for count in sorted(set(threads()))) or "unknown"


def _checks() -> Iterator[Check]:
    from linkwright.core.arm.actuators.catalogue import load_actuators
    from linkwright.core.materials.catalogue import load_catalogue
    from linkwright.core.sections.stock.tables import load_stock
    from linkwright.report.page import need_browser

    looks: tuple[tuple[str, Callable[[], str], str, str], ...] = (
        ("solver (IPOPT)", _solver, "wrong", _REINSTALL),
        ("catalogue: materials", lambda: f"{len(load_catalogue().names)} read", "wrong", "mend the file"),
        ("catalogue: stock sizes", lambda: f"{len(load_stock())} read", "wrong", "mend the file"),
        ("catalogue: actuators", lambda: f"{len(load_actuators())} read", "wrong", "mend the file"),
        ("threads of linear algebra", _threads, "wrong", ""),
        ("reports as PDF (--pdf)", need_browser, "missing", "install Chromium, Chrome or Edge"),
    )
    yield Check("Python", "sound", platform.python_version())
    yield from _packages()
    for name, look, otherwise, would_do in looks:
        try:
            yield Check(name, "sound", look())
        except (InputError, ImportError, RuntimeError) as error:
            yield Check(name, otherwise, (str(error).strip().splitlines() or ["fails"])[-1], would_do)


def doctor(json: JsonFile = None) -> int:
    """Run the command."""
    from linkwright.screen.console import console, table

    check_target(json)
    checks = list(_checks())
    wrong = [check.name for check in checks if check.state == "wrong"]
    write_content(json, "doctor", {"sound": not wrong, "checks": [check._asdict() for check in checks]})
    shown = table("what", "state", "found", "what would do")
    for check in checks:
        shown.add_row(check.name, check.state.upper() if check.state == "wrong" else check.state, *check[2:])
    console().print(shown)
    console().print(f"wrong: {', '.join(wrong)}" if wrong else "The installation is sound.", soft_wrap=True)
    if json is not None:
        console().print(f"written: {json}", soft_wrap=True)
    return 1 if wrong else 0
