"""Docstrings as pages show them: their examples set as code."""

from __future__ import annotations

import ast
from typing import Any

import griffe


def fenced(text: str) -> str:
    """The text with every run of doctest lines between fences."""
    lines: list[str] = []
    inside = False
    for line in text.split("\n"):
        begins = line.lstrip().startswith(">>>")
        if begins and not inside:
            lines += ["", "```pycon"]
        elif inside and not line.strip():
            lines.append("```")
        inside = begins or (inside and bool(line.strip()))
        lines.append(line)
    return "\n".join([*lines, "```"] if inside else lines)


def _first_words(call: str) -> str:
    """What the first argument of a call says."""
    made = ast.parse(call, mode="eval").body
    assert isinstance(made, ast.Call)
    return str(ast.literal_eval(made.args[0]))


class FencedExamples(griffe.Extension):
    """Sets the examples in docstrings as code while they are read."""

    def on_object(self, *, obj: griffe.Object, **kwargs: Any) -> None:  # noqa: ARG002 - what it is called with
        """Called for every object with what it is."""
        if isinstance(obj, griffe.Attribute) and str(obj.value).startswith("Field["):
            obj.docstring = griffe.Docstring(_first_words(str(obj.value)), parent=obj)
        if obj.docstring is not None:
            obj.docstring.value = fenced(obj.docstring.value)
