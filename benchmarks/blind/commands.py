"""The command line: python -m benchmarks.blind make | run | score | remake | publish."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from benchmarks.blind.answers import load
from benchmarks.blind.make import HALVES, make
from benchmarks.blind.proof.publish import publish
from benchmarks.blind.proof.remade import REGIONS, NotTheCaseError, remade, rng_of, session, table_of
from benchmarks.blind.run import SealedTwiceError, run
from benchmarks.blind.score import score
from benchmarks.blind.seal import BrokenSealError, half_of
from benchmarks.blind.tables import as_json, as_markdown


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.blind", description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    making = commands.add_parser("make", help="write recordings of concealed physics and seal their truths")
    making.add_argument("--cases", type=int, default=2000)
    making.add_argument("--seed", type=int, required=True)
    making.add_argument("--half", choices=HALVES, required=True)
    making.add_argument("--out", type=Path, required=True)
    making.add_argument("--jobs", type=int, default=2)
    running = commands.add_parser("run", help="ask the tool about each recording by its command line")
    running.add_argument("cases", type=Path)
    running.add_argument("--answers", type=Path, required=True)
    running.add_argument("--jobs", type=int, default=2)
    running.add_argument("--limit", type=int, default=None)
    running.add_argument("--timeout", type=float, default=120.0, help="seconds for one case")
    scoring = commands.add_parser("score", help="open the truths and score the answers")
    scoring.add_argument("cases", type=Path)
    scoring.add_argument("--answers", type=Path, required=True)
    scoring.add_argument("--json", type=Path, default=None)
    scoring.add_argument("--markdown", type=Path, default=None)
    scoring.add_argument("--partial", action="store_true", help="score a disclosed half that is not all answered")
    again = commands.add_parser("remake", help="record a case anew at other poses, free of noise")
    again.add_argument("cases", type=Path)
    again.add_argument("case", help="its name, as in the folder of cases; of a sealed half only once it is scored")
    again.add_argument("--out", type=Path, required=True, help="the new recording, a CSV file")
    publishing = commands.add_parser("publish", help="docs/proof.md from folders of cases and answers")
    for half in HALVES:
        publishing.add_argument(f"--{half}", type=Path, nargs=2, metavar=("CASES", "ANSWERS"), default=None)
    publishing.add_argument("--work", type=Path, required=True, help="keeps what was computed, case by case")
    publishing.add_argument("--docs", type=Path, default=Path("docs"))
    publishing.add_argument("--jobs", type=int, default=2)
    return parser


def _remake(root: Path, name: str, out: Path) -> str:
    """Records a case anew; says which rows are where. Raises SealedTwiceError while its truths are shut."""
    if half_of(root) == "sealed" and not (root / "scored.txt").exists():
        raise SealedTwiceError(f"{root}: its truths are shut until they are scored")
    truth = json.loads((root / "truth" / f"{name}.json").read_text(encoding="utf-8"))
    case = remade(truth, root / "cases" / name)
    made = session(case, rng_of(truth, 1))
    table_of(case, made).to_csv(out, index=False, lineterminator="\n")
    return "\n".join(f"{region}: {made.region.count(region)} rows" for region in REGIONS)


def main(arguments: list[str] | None = None) -> int:
    """Runs one command; exit status 0, or 2 with one line where the input is wrong."""
    asked = _parser().parse_args(arguments)
    try:
        if asked.command == "make":
            print(make(asked.cases, asked.seed, asked.half, asked.out, asked.jobs))
        elif asked.command == "run":
            done = run(asked.cases, asked.answers, asked.jobs, asked.limit, asked.timeout)
            print(f"{done} cases answered")
        elif asked.command == "remake":
            print(_remake(asked.cases, asked.case, asked.out))
        elif asked.command == "publish":
            folders = [tuple(pair) for pair in (asked.disclosed, asked.sealed) if pair]
            if not folders:
                raise FileNotFoundError("name the folders of at least one half: --disclosed CASES ANSWERS")
            for path in publish(folders, asked.work, asked.docs, asked.jobs):
                print(f"written: {path}")
        else:
            result = score(*load(asked.cases, asked.answers, partial=asked.partial))
            text = as_markdown(result)
            if asked.json:
                asked.json.write_text(as_json(result), encoding="utf-8")
            if asked.markdown:
                asked.markdown.write_text(text, encoding="utf-8")
            print(text)
    except (FileExistsError, FileNotFoundError, BrokenSealError, SealedTwiceError, NotTheCaseError) as error:
        print(f"benchmarks.blind: {error}", file=sys.stderr)
        return 2
    return 0
