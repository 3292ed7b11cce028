"""Bytes led by coverage: python -m benchmarks.fuzz.covered [--runs 20000] [--seed 1] [--jobs 2] [KIND/FILE ...]

libFuzzer, by atheris (https://github.com/google/atheris), keeps what reaches lines that nothing reached before and goes
on from there. Each file of each kind is read or refused in one line, within 10 s and 1 GiB, as in `benchmarks.fuzz`;
the other files of its kind stay good. Exit status 1 where one is not; the bytes that did it are kept and shown.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import os
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from importlib.util import find_spec
from pathlib import Path

SECONDS, MEGABYTES, LONGEST = 10, 2048, 20_000
"""Of one input; the memory is that of the program with its libraries and 1 GiB; bytes of a file."""
OWN = ["arm", "catalogues", "diagnose", "linkwright", "materials", "optimize", "sections", "units", "yaml", "openpyxl"]
"""Packages whose lines lead the way."""


def main() -> int:
    """Run all files of all kinds, and say what became of each."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="*", help="KIND/FILE, or KIND; all by default")
    parser.add_argument("--runs", type=int, default=20_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--alone", type=Path, help=argparse.SUPPRESS)  # the folder of a process of its own
    asked = parser.parse_args()
    if asked.alone is not None:
        _fuzz(asked.files[0], asked.runs, asked.seed, asked.alone)
        return 0
    if find_spec("atheris") is None:
        parser.error("atheris is not installed; `make fuzz` does that, on Linux")
    from .kinds import kinds

    every = [f"{name}/{file}" for name, kind in kinds().items() for file in kind.odd]
    chosen = [each for each in every if not asked.files or {each, each.partition("/")[0]} & set(asked.files)]
    wrong = False
    with ThreadPoolExecutor(asked.jobs) as together:
        for name, said in together.map(lambda each: (each, _apart(each, asked.runs, asked.seed)), chosen):
            wrong |= bool(said)
            print(f"{name:32} {said or 'each read or refused in one line'}", flush=True)
    return int(wrong)


def _apart(name: str, runs: int, seed: int) -> str:
    """Run one file in a process of its own; empty where all is well, else the end of what it said."""
    folder = Path(tempfile.mkdtemp(prefix=f"fuzz-{name.replace('/', '-')}-"))
    given = [name, "--runs", str(runs), "--seed", str(seed), "--alone", str(folder)]
    command = [sys.executable, "-m", "benchmarks.fuzz.covered", *given]
    done = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)
    if done.returncode == 0:
        shutil.rmtree(folder, ignore_errors=True)
        return ""
    return f"is not (in {folder}), exit status {done.returncode}\n{done.stderr[-4000:]}"


def _fuzz(name: str, runs: int, seed: int, folder: Path) -> None:
    """Lead bytes of one file through its reader; ends the process."""
    import atheris  # pyright: ignore[reportMissingImports] - `make fuzz` installs it, where there is one

    with atheris.instrument_imports(include=OWN), contextlib.redirect_stderr(io.StringIO()):
        from .held import hold
        from .kinds import kinds
    kind_name, _, file = name.partition("/")
    kind = kinds()[kind_name]
    rest = {each: seeds[0].encode() for each, seeds in kind.odd.items() if each != file}
    known = folder / "known"
    known.mkdir()
    for number, text in enumerate(kind.odd[file]):
        (known / str(number)).write_bytes(text.encode()[:LONGEST])
    (folder / "read").mkdir()

    def read(content: bytes) -> None:
        hold(kind, {**rest, file: content}, folder / "read")

    bounds = [f"-runs={runs}", f"-seed={seed}", f"-timeout={SECONDS}", f"-rss_limit_mb={MEGABYTES}"]
    told = [f"-max_len={LONGEST}", f"-artifact_prefix={folder}{os.sep}", "-verbosity=0"]
    atheris.Setup([sys.argv[0], *bounds, *told, str(known)], read)
    atheris.Fuzz()


if __name__ == "__main__":
    sys.exit(main())
