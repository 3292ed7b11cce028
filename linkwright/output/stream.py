"""Standard output and error when whoever reads them closes them, and what may be written to a terminal."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Generator, Sequence
from contextlib import contextmanager, suppress
from itertools import pairwise
from typing import Any, TextIO, cast

_TO_OUTPUT = (("--json", "-"), ("--markdown", "-"), ("--out", "-"))
_OBEYED = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069]")


class OutputClosed(Exception):
    """Whoever read the output has closed it (`| head`)."""


def drop_output() -> None:
    """Send what is still to be written to standard output nowhere."""
    _drop(sys.stdout.fileno())


def drop_errors() -> None:
    """Send what is still to be written to standard error nowhere."""
    with suppress(OSError, ValueError):
        _drop(sys.stderr.fileno())


def _drop(stream: int) -> None:
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, stream)
    os.close(nowhere)


def open_closed_streams() -> None:
    """Take the places of standard streams that the process was begun without (`>&-`), before a file gets them.

    Writing to standard output then fails as a device does that cannot be written; what standard error is told goes
    nowhere.
    """
    for stream, mode in ((0, os.O_RDONLY), (1, os.O_RDONLY), (2, os.O_WRONLY)):
        try:
            os.fstat(stream)
        except OSError:
            os.open(os.devnull, mode)  # gets the least free number, which is this one's
    if sys.stdin is None:
        sys.stdin = open(0, closefd=False)  # noqa: SIM115 - for as long as the process lives
    if sys.stdout is None:
        sys.stdout = open(1, "w", closefd=False)  # noqa: SIM115
    if sys.stderr is None:
        sys.stderr = open(2, "w", closefd=False)  # noqa: SIM115


def asked_measure(name: str) -> int | None:
    """What COLUMNS or LINES of the environment asks for, where that is a number of columns or lines."""
    value = os.environ.get(name, "")
    return int(value) if re.fullmatch("0*[1-9][0-9]{0,4}", value, re.ASCII) else None


def forget_odd_measures() -> None:
    """Take COLUMNS and LINES out of the environment where they are no measure: `rich` takes digits of any script."""
    for name in ("COLUMNS", "LINES"):
        if asked_measure(name) is None:
            os.environ.pop(name, None)


class _Aside:
    """Takes what is printed to standard error, so that `results`, the standard output, gets nothing but results."""

    def __init__(self, results: TextIO, errors: TextIO) -> None:
        self.results, self._errors = results, errors

    def __getattr__(self, name: str) -> Any:
        return getattr(self._errors, name)


@contextmanager
def results_alone(arguments: Sequence[str]) -> Generator[None]:
    """Print to standard error where an option hands a result to standard output (`--json -`), as pipes need it."""
    pairs = pairwise(arguments)
    if not (any(pair in _TO_OUTPUT for pair in pairs) or any(f"{name}=-" in arguments for name, _ in _TO_OUTPUT)):
        yield
        return
    before = sys.stdout
    sys.stdout = cast(TextIO, _Aside(before, sys.stderr))
    try:
        yield
    finally:
        sys.stdout = before


def write_result_out(text: str) -> None:
    """Write a result to standard output itself. Raises `OutputClosed`, and `OSError` where it cannot be written."""
    output: TextIO = getattr(sys.stdout, "results", sys.stdout)
    try:
        output.write(text)
        output.flush()
    except BrokenPipeError:
        _drop(output.fileno())
        raise OutputClosed from None


def printable(text: str) -> str:
    """The text with what a terminal would obey (escape sequences, turns of direction) written by its number."""
    return _OBEYED.sub(lambda result: result[0].encode("unicode_escape").decode("ascii"), text)
