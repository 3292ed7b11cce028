"""How much the screen shows: `LINKWRIGHT_SHOW`, which `--quiet` and `--verbose` set for one command."""

from __future__ import annotations

import os
from collections.abc import Generator
from contextlib import contextmanager
from typing import Literal

from linkwright.core.units.quantities import InputError

SHOW = "LINKWRIGHT_SHOW"
Loudness = Literal["answer", "usual", "all"]


def loudness() -> Loudness:
    """`answer`: the answer and warnings alone; `usual`; `all`: what is else left to the report too. Raises `InputError`
    where the environment says something else."""
    level = os.environ.get(SHOW) or "usual"
    for known in ("answer", "usual", "all"):
        if level == known:
            return known
    raise InputError("", SHOW, f"is 'answer', 'usual' or 'all', not {level!r}; or leave it unset")


@contextmanager
def showing(*, quiet: bool, verbose: bool) -> Generator[None]:
    """For the length of a command. Raises `InputError` for both at once."""
    if quiet and verbose:
        raise InputError("", "--quiet", "goes without --verbose; leave one out")
    before = os.environ.get(SHOW)
    if quiet or verbose:
        os.environ[SHOW] = "answer" if quiet else "all"
    try:
        loudness()
        yield
    finally:
        if before is None:
            os.environ.pop(SHOW, None)
        else:
            os.environ[SHOW] = before
