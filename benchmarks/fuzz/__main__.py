"""Odd files of every kind: python -m benchmarks.fuzz [--inputs 100000] [--seed 1] [--jobs 2] [KIND ...]

Each is read or refused in one line, within 10 s and 1 GiB. Exit status 1 where one is not; it is shown, as small as it
could be made.
"""

from __future__ import annotations

import argparse
import sys
import time

from .held import Watched
from .kinds import kinds

SHARE = 2500
"""Inputs of one process: short enough that what it gathers stays small."""


def main() -> int:
    """Run all kinds, and say how many inputs were held."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("kinds", nargs="*", help="kinds of files; all by default")
    parser.add_argument("--inputs", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    asked = parser.parse_args()
    every = list(kinds())  # made once, for all processes
    names = asked.kinds or every
    if strangers := set(names) - set(every):
        parser.error(f"no kind is called {min(strangers)}; they are {', '.join(every)}")
    each = -(-asked.inputs // len(names))
    parts = [(name, min(SHARE, each - at), asked.seed + at) for at in range(0, each, SHARE) for name in names]
    counted = dict.fromkeys(names, 0)
    wrong: dict[str, str] = {}
    running: list[Watched] = []
    while parts or running:
        while parts and len(running) < asked.jobs:
            name, count, number = parts.pop(0)
            if name not in wrong:
                running.append(Watched(name, count, number))
        time.sleep(0.05)
        for each in [each for each in running if each.ended()]:
            running.remove(each)
            counted[each.name] += each.held
            print(f"{sum(counted.values())} inputs", file=sys.stderr, flush=True)
            if each.wrong:
                wrong[each.name] = each.wrong
    for name, count in counted.items():
        print(f"{name:12} {count:8} inputs  {wrong.get(name, 'each read or refused in one line')}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
