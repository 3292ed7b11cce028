"""The command line: python -m benchmarks.blind make | run | score | remake."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from benchmarks.blind.answers import load
from benchmarks.blind.front import answer, options
from benchmarks.blind.make import HALVES, make
from benchmarks.blind.remade import REGIONS, NotTheCaseError, remade, rng_of, session, table_of
from benchmarks.blind.run import SealedTwiceError, run
from benchmarks.blind.score import score
from benchmarks.blind.seal import half_of
from benchmarks.blind.tables import as_json, as_markdown


def _parser() -> argparse.ArgumentParser:
    parser, commands, known = options("python -m benchmarks.blind", __doc__, HALVES, 2000, 120.0)
    known["score"].add_argument("--markdown", type=Path, default=None)
    again = commands.add_parser("remake", help="record a case anew at other poses, free of noise")
    again.add_argument("cases", type=Path)
    again.add_argument("case", help="its name, as in the folder of cases; of a sealed half only once it is scored")
    again.add_argument("--out", type=Path, required=True, help="the new recording, a CSV file")
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
    return answer("benchmarks.blind", lambda: _done(asked), NotTheCaseError)


def _done(asked: argparse.Namespace) -> str:
    """What a command comes to, in words."""
    if asked.command == "make":
        return make(asked.cases, asked.seed, asked.half, asked.out, asked.jobs)
    if asked.command == "run":
        return f"{run(asked.cases, asked.answers, asked.jobs, asked.limit, asked.timeout)} cases answered"
    if asked.command == "remake":
        return _remake(asked.cases, asked.case, asked.out)
    result = score(*load(asked.cases, asked.answers, partial=asked.partial))
    text = as_markdown(result)
    if asked.json:
        asked.json.write_text(as_json(result), encoding="utf-8")
    if asked.markdown:
        asked.markdown.write_text(text, encoding="utf-8")
    return text
