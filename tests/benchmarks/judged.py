"""A proof and what it judges have nothing in common: no import, no template of what is unknown."""

import ast
import re
import sys
from collections.abc import Collection, Iterable
from pathlib import Path

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"
ALLOWED = {"benchmarks", "mujoco", "numpy", "scipy", "pandas", "yaml", *sys.stdlib_module_names}
SPREADS = "linkwright.core.executors"  # where work is done; it knows nothing of arms
JUDGED = ("units", "registries", "sections", "materials", "catalogues", "arm", "optimize", "diagnose", "linkwright")


def imported(path: Path) -> list[str]:
    """The modules that a file names in its imports, none of them relative."""
    results = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            results += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0
            results.append(node.module or "")
    return results


def nothing_judged(package: str, asks: Collection[str]) -> None:
    """Assert that nothing which a proof's files import, or these imports within benchmarks, is of the tool, but for
    files that ask it by its command line."""
    files, seen = sorted((BENCHMARKS / package).rglob("*.py")), set()
    while files:
        path = files.pop()
        if path in seen:
            continue
        seen.add(path)
        source = path.read_text(encoding="utf-8")
        assert "import_module" not in source
        assert "__import__" not in source
        for name in imported(path):
            top = name.split(".")[0]
            asked = name == "linkwright.command_line" and path.name in asks
            assert top in ALLOWED or name == SPREADS or asked, (path, name)
            if top == "benchmarks":
                stem = BENCHMARKS.parent.joinpath(*name.split("."))
                files.append(stem / "__init__.py" if stem.is_dir() else stem.with_suffix(".py"))
    assert len([path for path in seen if BENCHMARKS / package in path.parents]) > 15


def no_templates(classes: Iterable[str], judged: Collection[str] = JUDGED) -> None:
    """Assert that no file of the rooms which are judged has the name of a class of unknowns."""
    files = [path for room in judged for path in (BENCHMARKS.parent / room).rglob("*.py")]
    assert len(files) > 100
    names = "|".join(name for name in classes if "_" in name)
    assert not [path for path in files if re.search(rf"\b({names})\b", path.read_text(encoding="utf-8"))]
