"""All benchmarks in one run: python -m benchmarks [--quick]

Every figure is a ratio against code that does the same work; results are compared before anything is timed. Exit status
1 where a target is missed. `--quick` takes fewer rounds; then timings are only printed, and only sizes can fail.
"""

from __future__ import annotations

import sys

from benchmarks.exchange_against_grid import exchange_against_grid
from benchmarks.symbolic_size import symbolic_size


def main() -> int:
    """Run all, print, and say which targets were missed."""
    unknown = [argument for argument in sys.argv[1:] if argument != "--quick"]
    if unknown:
        print(f"usage: python -m benchmarks [--quick], not {' '.join(unknown)}", file=sys.stderr)
        return 2
    quick = "--quick" in sys.argv[1:]
    missed = symbolic_size()
    print()
    timed = exchange_against_grid(quick=quick)
    for line in [*missed, *timed]:
        print(f"MISSED  {line}" + (" (a timing: only printed with --quick)" if quick and line in timed else ""))
    return 1 if missed or (timed and not quick) else 0


if __name__ == "__main__":
    raise SystemExit(main())
