"""What a YAML parser stumbles over, in the words of somebody who writes files by hand."""

from __future__ import annotations

import re

import yaml

_BESIDE = 24
"""Characters shown on either side of the place."""
_INDENT = re.compile(r"[ -]*([\t\u00a0])[ \t\u00a0]*\S")
_COMMA_IN_NUMBER = re.compile(r"(?<=\d),\d")
_WORDS = (
    (r"found character '\\t'", "a tab stands here; write blanks"),
    (r"found character '(.)'", "a text that begins with {0} needs quotes"),
    (r"expected ',' or '(.)', but got '<stream end>'", "the bracket that opens here is never closed; '{0}' is missing"),
    (r"expected ',' or '(.)'", "a comma or '{0}' is missing before this (the bracket of line {opened} is still open)"),
    (r"could not find expected ':'", "no colon follows this; write 'key: value'"),
    (r"sequence entries are not allowed", "an entry ('- ') of a list begins on a line of its own"),
    (r"found unexpected end of stream", "the quote that opens here is never closed"),
    (r"expected chomping|indentation indicator", "a text that begins with > or | needs quotes"),
    (r"found unknown escape", "in double quotes a backslash has a meaning of its own; write single quotes"),
    (r"expected the node content", "a value is missing before this"),
    (r"found another document", "a second document begins; one file holds one, without '---'"),
)
"""The parser's problems, and what is said of them."""
_AT_CONTEXT = ("could not find", "found unexpected end", "'<stream end>'")
"""Problems whose cause is where the thing began, not where the parser gave up."""
_OUT_OF_COLUMN = (
    "does not begin in the column of the lines that it belongs to; begin all keys of a mapping, and all '- ' of a list,"
    " in one column, with a blank after each '-' and ':'"
)
_NO_KEY = "goes on from the line above, which lacks its colon or the blank after it, or is indented less"
_SECOND_COLON = "a second colon stands here; a text that holds ': ' needs quotes"
_AFTER_AN_END = "follows a value that has ended; a colon, bracket or quote is missing before it"


def in_words(error: yaml.MarkedYAMLError, text: str) -> str:
    """What is wrong, with its line and what stands there, and what would do."""
    problem, lines = error.problem or "", text.splitlines()
    at_context = error.context_mark is not None and any(part in problem for part in _AT_CONTEXT)
    mark = error.context_mark if at_context else error.problem_mark or error.context_mark
    if mark is None:
        return problem or "is not YAML"
    for number, line in enumerate(lines[: mark.line + 1], start=1):
        if indented := _INDENT.match(line):
            by = "a tab" if indented[1] == "\t" else "a no-break space"
            return f"line {number}: is indented by {by}; YAML is indented by blanks only"
    line = lines[mark.line] if mark.line < len(lines) else ""
    said = _said(error, problem, line[: mark.column])
    return f"line {mark.line + 1}{_near(line, mark.column) if said else ''}: {said or problem or 'is not YAML'}"


def comma_in_number(node: yaml.Node) -> str | None:
    """The number that a decimal comma before this node has cut in two (`0,4 m`), None where there is none."""
    buffer, start = node.start_mark.buffer, node.start_mark.pointer
    if buffer is None or start < 2 or not _COMMA_IN_NUMBER.match(buffer, start - 1):
        return None
    before = re.search(r"[-+0-9.]+$", buffer[max(0, start - 40) : start - 1])
    return "" if before is None else f"{before[0]},{buffer[start : node.end_mark.pointer]}"


def _said(error: yaml.MarkedYAMLError, problem: str, before: str) -> str | None:
    """The words for the parser's problem; None where it is in words already."""
    if "expected <block end>" in problem:
        return _AFTER_AN_END if before.strip(" -") else _OUT_OF_COLUMN
    if "mapping values are not allowed" in problem:
        return _SECOND_COLON if re.search(r":\s", before) else _NO_KEY
    opened = error.context_mark.line + 1 if error.context_mark is not None else ""
    for pattern, words in _WORDS:
        if result := re.search(pattern, problem):
            return words.format(*result.groups(), opened=opened)
    return None


def _near(line: str, column: int) -> str:
    """What stands at a place of a line, in quotes; nothing of an empty line."""
    start, end = max(0, column - _BESIDE), column + _BESIDE
    shown = line[start:end].strip()
    return f" near '{'...' if start else ''}{shown}{'...' if end < len(line) else ''}'" if shown else ""
