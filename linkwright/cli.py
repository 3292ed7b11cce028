"""The `linkwright` command: where a process starts and with which exit status it ends.

0 is done, 1 a well-formed question without an answer, 2 wrong input (one line, no traceback), 130 an interrupt, 141 a
reader that closed the output. Everything else is imported once an interrupt is caught, for importing takes a second.
"""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Sequence
from types import FrameType
from typing import NoReturn

INTERRUPTED = 130
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""What libraries of linear algebra read while they are loaded. What a command multiplies is small: threads that wait
for each other take longer than one does, and many times as long where anything else is running."""


def run(arguments: Sequence[str] | None = None) -> int:
    """Run the command line with these arguments (the process's own by default) and return the exit status."""
    try:
        from .command_line import outcome

        return outcome(arguments)
    except KeyboardInterrupt:
        return INTERRUPTED


def end_as_by_ctrl_c() -> None:
    """Let what ends a process politely (SIGTERM of a scheduler, SIGHUP of a terminal that is closed) do what Ctrl-C
    does at that moment; one that is ignored (nohup) stays so."""

    def interrupt(number: int, frame: FrameType | None) -> None:
        del number
        does = signal.getsignal(signal.SIGINT)
        (does if callable(does) else signal.default_int_handler)(signal.SIGINT, frame)

    for name in ("SIGTERM", "SIGHUP"):
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is signal.SIG_DFL:
            signal.signal(number, interrupt)


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """Run the command line, with one thread of linear algebra unless the environment says otherwise, and leave with its
    exit status."""
    for name in _THREADS:
        os.environ.setdefault(name, "1")
    end_as_by_ctrl_c()
    sys.exit(run(arguments))
