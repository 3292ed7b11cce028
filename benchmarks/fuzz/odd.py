"""Odd files: a good one with a few of its lines, words, figures or bytes exchanged for what nobody should write."""

from __future__ import annotations

import re

from hypothesis import strategies as st
from hypothesis.strategies import DrawFn, SearchStrategy

_WORD = re.compile(r"[A-Za-z0-9_.+-]+")
FIGURES = (
    "0",
    "-0",
    "-1",
    "1e200",
    "1e-200",
    "1e308",
    "1e400",
    "-1e30",
    "1e-30",
    "1e12",
    "1e-12",
    "nan",
    ".nan",
    "inf",
    "-.inf",
    "0x10",
    "1_000",
    "1,5",
    "1.5.2",
    "9" * 4000,
    "9" * 5000,
    "0." + "0" * 400 + "1",
    "1e",
    "--1",
    "१२",
    "½",
    "1e-9999999",
)
WORDS = (
    "",
    "''",
    "null",
    "~",
    "true",
    "yes",
    "[]",
    "{}",
    "[[[[]]]]",
    "{a: {b: {c: d}}}",
    "[1, 2, 3]",
    "&a",
    "*a",
    "<<: *a",
    "!!python/object:os.system",
    "!!binary aGk=",
    "!!set {a}",
    "!!timestamp 2026-01-01",
    "2026-01-01",
    "? a",
    "- -",
    "|",
    ">",
    "'",
    '"',
    "#",
    "%",
    "@",
    "`",
    ",",
    ";",
    ":",
    "\t",
    "\x00",
    "\x1b[31m",
    "\ufeff",
    "\u202e",
    "\ud7ff",
    "\U0001f9be",
    "=1+1",
    "../../etc/passwd",
    "/dev/zero",
    "a" * 300,
    "q1",
    "x*(y",
    "mm",
    "1 mm",
    "1e200 mm",
    "-5 deg",
    "1e12 kg",
    "1e-30 mm",
    "90 deg",
    "0 mm",
    "steel-s355",
    "unknown",
    "free",
    "worst",
    "statistical",
    "-(q2 + q3)",
    "<= 0 kg",
    "== 1e12 mm",
    "0.5 %",
    "20 degC",
    "-400 degC",
    "NUL",
    "con",
    "\\",
    "\\N",
    "<!DOCTYPE a [<!ENTITY b 'c'>]>&b;",
)


def _exchanged(draw: DrawFn, text: str) -> str:
    """A word of the text exchanged for another, for a word of the text itself or for any text."""
    results = list(_WORD.finditer(text))
    if not results:
        return text + draw(st.sampled_from(WORDS))
    word = draw(st.sampled_from(results))
    other = draw(
        st.one_of(
            st.sampled_from(FIGURES),
            st.sampled_from(WORDS),
            st.sampled_from([result[0] for result in results]),
            st.floats().map(repr),
            st.integers().map(str),
            st.text(max_size=12),
        )
    )
    return text[: word.start()] + other + text[word.end() :]


def _shifted(draw: DrawFn, text: str) -> str:
    """A line taken out, said twice, put elsewhere or indented."""
    lines = text.splitlines(keepends=True) or [""]
    at, to = (draw(st.integers(0, len(lines) - 1)) for _ in range(2))
    match draw(st.sampled_from(("out", "twice", "elsewhere", "indented", "cut", "joined"))):
        case "out":
            del lines[at]
        case "twice":
            lines.insert(to, lines[at])
        case "elsewhere":
            lines.insert(to, lines.pop(at))
        case "indented":
            lines[at] = " " * draw(st.integers(1, 5)) + lines[at].lstrip(" ")
        case "cut":
            return "".join(lines[:at])
        case _:
            lines[at] = lines[at].rstrip("\n")
    return "".join(lines)


def _spliced(draw: DrawFn, text: str) -> str:
    """A few characters put in or taken away."""
    at = draw(st.integers(0, len(text)))
    return text[:at] + draw(st.text(max_size=4)) + text[at + draw(st.integers(0, 4)) :]


@st.composite
def odd(draw: DrawFn, seeds: tuple[str, ...]) -> bytes:
    """A file made from one of the good ones."""
    text = draw(st.sampled_from(seeds))
    for _ in range(draw(st.integers(0, 4))):
        text = draw(st.sampled_from((_exchanged, _exchanged, _exchanged, _shifted, _spliced)))(draw, text)
    content = text.encode("utf-8", "surrogatepass")
    if draw(st.integers(0, 19)) == 0:
        at = draw(st.integers(0, len(content)))
        content = content[:at] + draw(st.binary(max_size=6)) + content[at:]
    return content if draw(st.integers(0, 49)) else content.decode("utf-8", "replace").encode("utf-16")


def odd_files(kinds: dict[str, tuple[str, ...]]) -> SearchStrategy[dict[str, bytes]]:
    """Files by name, each made odd from its good ones."""
    return st.fixed_dictionaries({name: odd(seeds) for name, seeds in kinds.items()})
