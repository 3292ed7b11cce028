"""The examples in the docstrings of the face, run."""

import doctest
import importlib
import pkgutil
from pathlib import Path

import pytest

import linkwright.api
import linkwright.face
from tests.costs import slow_but

ROOT = Path(__file__).resolve().parents[2]
FACE = [
    *pkgutil.walk_packages(linkwright.face.__path__, "linkwright.face."),
    *pkgutil.walk_packages(linkwright.api.__path__, "linkwright.api."),
]
MODULES = [*(each.name for each in FACE), "linkwright.output.table_file"]


def examples(name):
    """The doctests of a module that hold any example."""
    return [test for test in doctest.DocTestFinder().find(importlib.import_module(name)) if test.examples]


DEAR = tuple(f"linkwright.{name}" for name in ("face.design", "face.diagnosis", "face.tradeoff", "paper.face"))


@pytest.mark.parametrize("name", slow_but(MODULES, *(set(MODULES) - set(DEAR))))
def test_examples_hold(name, monkeypatch):
    """Run from the project's folder, whose examples they read."""
    monkeypatch.chdir(ROOT)
    failed = [test.name for test in examples(name) if doctest.DocTestRunner().run(test).failed]
    assert failed == []


def test_examples_are_found():
    """The check above checked."""
    assert any(test.name.endswith("read_arm") for test in examples("linkwright.face.arm"))
