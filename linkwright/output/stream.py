"""Standard output when whoever reads it closes it."""

from __future__ import annotations

import os
import sys


class OutputClosed(Exception):
    """Whoever read the output has closed it (`| head`)."""


def drop_output() -> None:
    """Send what is still to be written to standard output nowhere."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, sys.stdout.fileno())
    os.close(nowhere)
