"""python -m benchmarks.canonical make | record [--folder tests/canonical] [--field FOLDER]

`make` draws the recordings anew (twenty CPU minutes; FOLDER has the small inputs of known truth; without it those that
the archive holds stay) and writes what is asked for; `record` asks each and writes down which are missed today.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from pathlib import Path
from typing import Any

from benchmarks.canonical.asked import ARCHIVE, EXPECTED, answer, faults
from benchmarks.canonical.expected import asked_of
from benchmarks.canonical.make import drawn

DEAR = 6.0
"""s of CPU beyond which a recording is asked among the slow tests."""
FOLDER = Path(__file__).resolve().parents[2] / "tests" / "canonical"


def make(folder: Path, field: Path | None) -> None:
    """Draws recordings, and what is asked for of each by its truth."""
    truths = drawn(folder / ARCHIVE, field)
    cases = {name: asked_of(truth) for name, truth in truths.items()}
    _write(folder, {"cases": cases, "known_misses": {}, "dear": []})


def record(folder: Path) -> None:
    """Asks all, and writes down what is missed."""
    known = json.loads((folder / EXPECTED).read_text(encoding="utf-8"))
    misses: dict[str, Any] = {}
    dear: list[str] = []
    for name, asked in known["cases"].items():
        with tempfile.TemporaryDirectory() as scratch:
            start = time.process_time()
            given = answer(folder / ARCHIVE, name, Path(scratch))
            wrong = faults(name, asked, given)
            spent = time.process_time() - start
            print(f"{name}: {spent:.1f} s, {given.verdict}; {'; '.join(wrong) or 'right'}", flush=True)
        if spent > DEAR:
            dear.append(name)
        if wrong:
            misses[name] = {"wrong": wrong, **given.shown()}
    _write(folder, known | {"known_misses": misses, "dear": dear})
    print(f"{len(misses)} of {len(known['cases'])} are missed")


def _write(folder: Path, known: dict[str, Any]) -> None:
    lines = [
        f' "{part}": {{\n'
        + ",\n".join(f'  "{name}": {json.dumps(said)}' for name, said in sorted(known[part].items()))
        + "\n }"
        for part in ("cases", "known_misses")
    ]
    lines.append(f' "dear": {json.dumps(sorted(known["dear"]))}')
    (folder / EXPECTED).write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")


def main() -> int:
    """One of the two."""
    reader = argparse.ArgumentParser(prog="python -m benchmarks.canonical", description=__doc__)
    reader.add_argument("what", choices=["make", "record"])
    reader.add_argument("--folder", type=Path, default=FOLDER)
    reader.add_argument("--field", type=Path, default=None)
    asked = reader.parse_args()
    if asked.what == "make":
        make(asked.folder, asked.field)
    else:
        record(asked.folder)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
