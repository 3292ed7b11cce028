"""The reference of `import linkwright as lw`, for mkdocstrings to fill from the docstrings."""

from __future__ import annotations

import inspect
import pkgutil
from collections.abc import Iterator
from importlib import import_module

import linkwright as lw
import linkwright.face
import linkwright.paper
from linkwright.face.result import Reported, Result


def homes() -> dict[str, list[str]]:
    """The public names by the module where each stands."""
    found: dict[str, list[str]] = {}
    for name in lw.__all__:
        home = next(module for module, names in lw.HOMES.items() if name in names)
        found.setdefault(home, []).append(name)
    return dict(sorted(found.items(), key=lambda item: item[1][0].lower()))


def results(names: list[str]) -> Iterator[str]:
    """Where the results stand that functions of these names give."""
    for package in (linkwright.face, linkwright.paper):
        for walk_package in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            import_module(walk_package.name)
    known = {kind.__name__: f"{kind.__module__}.{kind.__name__}" for kind in _kinds(Result)}
    for name in names:
        given = getattr(getattr(lw, name), "__annotations__", {}).get("return")
        if isinstance(given, str):
            yield from (known[item] for item in given.split(" | ") if item in known)


def _kinds(kind: type) -> Iterator[type]:
    for subclass in kind.__subclasses__():
        yield subclass
        yield from _kinds(subclass)


def python_pages() -> dict[str, str]:
    """A page for each home, by its place on the site, and one that lists all names."""
    pages: dict[str, str] = {}
    rows: list[str] = []
    for home, names in homes().items():
        page = f"{names[0].lower()}.md"
        parts = [f"# {', '.join(f'lw.{name}' for name in names)}", ""]
        for place in [*(f"{home}.{name}" for name in names), *results(names)]:
            parts += [f"::: {place}", ""]
        pages[f"python/{page}"] = "\n".join(parts)
        rows += [f"| [`lw.{name}`]({page}) | {first_sentence(getattr(lw, name))} |" for name in names]
    common = [f"::: {item.__module__}.{item.__name__}" for item in (Result, Reported)]
    pages["python/results.md"] = "\n\n".join(["# What results have in common", *common, ""])
    start = [
        "# The Python face",
        "",
        "Written from the code. [From Python](../how-to/python.md) shows it at work; [results](results.md) are alike.",
        "",
    ]
    return {
        "python/index.md": "\n".join([*start, "| name | |", "|---|---|", *sorted(rows, key=str.lower), ""]),
        **pages,
    }


def first_sentence(value: object) -> str:
    """What its documentation begins with."""
    paragraph = (inspect.getdoc(value) or "").split("\n\n")[0]
    return " ".join(paragraph.split()).replace("|", "\\|")
