"""python -m benchmarks.real.public CLONES [--out FOLDER] [NAME ...]

CLONES holds clones (bare ones do) of the repositories, each under its name. Each becomes a folder of FOLDER: the model,
recording.yaml and one CSV a recording.
"""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

from benchmarks.real.public.sources import SOURCES, MissingSourceError
from benchmarks.real.public.where import VARIABLE


def main() -> int:
    """Convert what is there; 1 where something that was asked for is not."""
    reader = argparse.ArgumentParser(prog="python -m benchmarks.real.public", description=__doc__)
    reader.add_argument("clones", type=Path, help="where the repositories are")
    reader.add_argument("names", nargs="*", choices=[*SOURCES, []], metavar="NAME", help=", ".join(SOURCES))
    reader.add_argument("--out", type=Path, default=os.environ.get(VARIABLE), help=f"default: {VARIABLE}")
    asked = reader.parse_args()
    if asked.out is None:
        reader.error(f"--out FOLDER, or {VARIABLE}")
    missing = 0
    for name in asked.names or SOURCES:
        source = SOURCES[name]
        folder = Path(asked.out) / name
        folder.mkdir(parents=True, exist_ok=True)
        try:
            source.convert(asked.clones / source.repository.rpartition("/")[2], folder)
        except MissingSourceError as error:
            print(f"{name}: {error}", file=sys.stderr)
            missing = 1
        else:
            print(f"{name}: {folder}, from github.com/{source.repository}, {source.licence}")
    return missing


if __name__ == "__main__":
    raise SystemExit(main())
