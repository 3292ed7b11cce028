"""Sentences for people: short, without semicolons, without the words that stopped readers.

Every string of the product is looked at but docstrings and what a `source=` cites. Error lines have a form of their
own ("what is wrong; write what would do"): they begin in lower case, and a semicolon ends a thought there.
"""

import ast
import re
from collections.abc import Iterator, Mapping
from types import MappingProxyType

import pytest

from tests.test_house import MODULES, ROOT, syntax

MOST_WORDS = 25
OPENINGS = (
    "rigid, weightless links would leave",
    "first order is",
    "than the arm as given worse",
    "it could as well be",
    "what is left free swallows",
    "the poses listed raise",
    "lack of fit p",
    "what was found is so large",
    "they stay in the box",
    "only samples where the joint moves",
    "what counts is which torques",
    "four times the readings find",
    "by default it lies in the plane",
    "no design found goes further",
    "value; empty takes it out",
    "not of the arm:",
    "play lies where the load seats it",
)


def strings(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """The strings of a module with their lines, a placeholder as {}, without docstrings and what is cited."""
    silent: set[int] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            silent.add(id(node.value))
        if isinstance(node, ast.keyword) and node.arg == "source":
            silent.update(map(id, ast.walk(node.value)))
        if isinstance(node, ast.JoinedStr):
            silent.update(map(id, node.values))
    for node in ast.walk(tree):
        if id(node) in silent:
            continue
        if isinstance(node, ast.JoinedStr):
            yield node.lineno, "".join(_part(value) for value in node.values)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.lineno, node.value


def _part(value: ast.expr) -> str:
    return value.value if isinstance(value, ast.Constant) and isinstance(value.value, str) else "{}"


def is_long(text: str) -> bool:
    """Whether one of its sentences has too many words."""
    ends = r"(?<=[.!?])\s|\n" if text[:1].isupper() else r"(?<=[.!?])\s|\n|; "
    return any(len(sentence.split()) > MOST_WORDS for sentence in re.split(ends, text))


def has_semicolon(text: str) -> bool:
    """Whether it is a sentence, and no error line, in which a semicolon stands for a full stop."""
    return re.search(r"[^.]\.\s*$", text) is not None and "; " in text


def opens_badly(text: str) -> bool:
    """Whether one of its sentences begins as no sentence should."""
    sentences = re.split(r"(?<=[.!?:;])\s|\n", text.lower())
    return any(sentence.startswith(OPENINGS) for sentence in (text.lower(), *sentences))


RULES = MappingProxyType(
    {
        "more than 25 words": is_long,
        "a semicolon": has_semicolon,
        "left out": lambda text: "left out" in text.lower(),
        "an opening of old": opens_badly,
    }
)
BAD: Mapping[str, str] = MappingProxyType(
    {
        "more than 25 words": f"Short. {'word ' * 26}.",
        "a semicolon": "The frame is free; nothing else is.",
        "left out": "Rows that were left out.",
        "an opening of old": "The table holds all. Play lies where the load seats it.",
    }
)
GOOD = (
    f"{'word ' * 24}end. Another sentence.",
    "is 12 m, which is beyond the reach; write a length of at most 2 m, " + "a word " * 8,
    "No pose is worse than 0.996 mm. Four readings are missing.",
)


def test_sentences_are_plain():
    bad = [
        f"{file.relative_to(ROOT)}:{line}: {rule}: {text[:100]}"
        for file in MODULES.values()
        for line, text in strings(syntax(file.read_text()))
        for rule, broken in RULES.items()
        if broken(text)
    ]
    assert len(MODULES) > 800
    assert bad == []


@pytest.mark.parametrize("rule", RULES)
def test_each_rule_can_fail(rule: str):
    assert [name for name, broken in RULES.items() if broken(BAD[rule])] == [rule]
    assert not any(RULES[rule](text) for text in GOOD)


def test_placeholders_count_and_docstrings_and_sources_do_not():
    module = '"""Left out; said."""\nrule(f"{a} of {b} rows", source="A. Author, A title; a journal")\n'
    assert list(strings(ast.parse(module))) == [(2, "{} of {} rows")]
