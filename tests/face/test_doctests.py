"""The examples in the docstrings of the face, run."""

import doctest
import importlib
import pkgutil
from pathlib import Path

import pytest

import linkwright.api
import linkwright.face

ROOT = Path(__file__).resolve().parents[2]
FACE = [
    *pkgutil.walk_packages(linkwright.face.__path__, "linkwright.face."),
    *pkgutil.walk_packages(linkwright.api.__path__, "linkwright.api."),
]
MODULES = [*(item.name for item in FACE), "linkwright.output.table_file"]


def examples(name):
    """The doctests of a module that hold any example."""
    return [test for test in doctest.DocTestFinder().find(importlib.import_module(name)) if test.examples]


DEAR = (
    "linkwright.api.design.tradeoff",
    "linkwright.api.diagnosis.compare",
    "linkwright.api.diagnosis.redesign",
    "linkwright.api.paper",
)
"""Examples that are slow: each of them has tests of its own."""
EXAMPLES = [test for name in MODULES for test in examples(name)]


@pytest.mark.parametrize(
    "example",
    [pytest.param(item, id=item.name, marks=[pytest.mark.slow] * item.name.startswith(DEAR)) for item in EXAMPLES],
)
def test_examples_hold(example, monkeypatch):
    """Run from the project's folder, whose examples they read."""
    monkeypatch.chdir(ROOT)
    assert not doctest.DocTestRunner().run(example).failed


def test_examples_are_found():
    """The check above checked."""
    assert any(test.name.endswith("read_arm") for test in examples("linkwright.face.arm"))
