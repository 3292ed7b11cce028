"""What commands cost, start of Python included."""

from __future__ import annotations

import os
import resource
import subprocess
import sys

from .row import Row, at_most

ARMS = {
    "6 joints (UR10)": ("examples/real/ur10/arm.yaml", 3.0),
    "7 joints (iiwa 7)": ("examples/real/iiwa7/arm.yaml", 4.0),
}
"""Arm files, and what `evaluate` may take (s of CPU)."""
BARE = {"--version": 0.15, "--help": 0.4}
"""Options, and what they may take (s of CPU)."""


def cpu(*arguments: str, rounds: int) -> float:
    """The least CPU time (s) of a command over some rounds."""
    results: list[float] = []
    for _ in range(rounds):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        command = [sys.executable, "-m", "linkwright", *arguments]
        subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True, env=os.environ)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        results.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return min(results)


def commands(*, quick: bool) -> list[Row]:
    """`--version`, `--help` and `evaluate`."""
    times = 2 if quick else 5
    bare = [
        at_most(f"linkwright {option}", cpu(option, rounds=times), "s of CPU", most) for option, most in BARE.items()
    ]
    arms = [
        at_most(f"linkwright evaluate, {what}", cpu("evaluate", path, rounds=1 if quick else 2), "s of CPU", most)
        for what, (path, most) in ARMS.items()
    ]
    return [*bare, *arms]
