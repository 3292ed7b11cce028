"""python -m benchmarks.rules --page docs/rules.md | --work FOLDER [--cases 60] [--rules N] [--recordings 12] [--jobs 2]
[--so-far] [--found benchmarks/rules/found.json]

What moves when each rule of the diagnosis is perturbed by 20 % either way: on recordings of the proof's generator
(disclosed, of known truth) in which the rule is consulted. What was computed stays in FOLDER, so that a second run goes
on where the first one ended; so does the report, moved.md.
"""

from __future__ import annotations

import argparse
import json
import random
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

from benchmarks.blind.make import make
from benchmarks.rules.judge import as_text, from_text, tell
from benchmarks.rules.outcomes import Outcome, Run, as_json, report
from benchmarks.rules.page import page
from benchmarks.rules.watch import perturbed, watched
from linkwright.core.diagnose.rules.rule import TIME, Rule, rules_in
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.executors import Processes, plain

FACTORS = (0.8, 1.2)
SEED = 12

Job = tuple[str, str, float, str]
"""Case, rule's path (empty: the rules as they are), factor, file of the result."""


def _ask(job: Job) -> str:
    """One diagnosis; its result goes into the job's file as a whole."""
    case, path, factor, target = job
    folder, asked = Path(case), set[str]()
    truth = json.loads((folder.parents[1] / "truth" / f"{folder.name}.json").read_text(encoding="utf-8"))
    rule = next((each for each in rules_in(RULES) if each.path == path), None)
    rules = watched(RULES, asked) if rule is None else perturbed(RULES, rule, factor)
    text = as_text(tell(folder, truth, rules), asked)
    Path(f"{target}.part").write_text(text, encoding="utf-8")
    Path(f"{target}.part").replace(target)
    return target


def _all_done(jobs: Sequence[Job], workers: int, what: str) -> None:
    """Run what is not done yet, and say how far it is."""
    left = [job for job in jobs if not Path(job[3]).exists()]
    start = time.monotonic()
    with Processes(workers, patience=0.0) as processes:
        for done, _ in enumerate(processes.completed(plain(_ask), left), 1):
            if done % 10 == 0 or done == len(left):
                print(f"{what}: {done} of {len(left)}, {time.monotonic() - start:.0f} s", file=sys.stderr)


def _perturbations(work: Path, cases: Sequence[Path], rules: Sequence[Rule], recordings: int) -> Iterator[Job]:
    """Each rule either way, on so many recordings in which it was consulted."""
    asked = {case: from_text((work / "base" / f"{case.name}.json").read_text(encoding="utf-8"))[1] for case in cases}
    for rule in rules:
        consulted = [case for case in cases if rule.path in asked[case]]
        chosen = sorted(random.Random(f"{SEED} {rule.path}").sample(consulted, min(recordings, len(consulted))))
        for case in chosen:
            for factor in FACTORS:
                name = f"{rule.path}-{factor:g}-{case.name}.json"
                yield str(case), rule.path, factor, str(work / "moved" / name)


def _outcomes(work: Path, jobs: Sequence[Job], rules: Sequence[Rule]) -> dict[str, Outcome]:
    """What was tried of each rule, and what moved."""
    found = {rule.path: Outcome() for rule in rules}
    for case, path, factor, target in jobs:
        before = from_text((work / "base" / f"{Path(case).name}.json").read_text(encoding="utf-8"))[0]
        after = from_text(Path(target).read_text(encoding="utf-8"))[0]
        found[path] = found[path].and_one(f"x {factor:g}, case {Path(case).name}", before, after)
    return found


def main() -> int:
    """Write the page, or perturb and report; 0, or 1 where a right answer turned wrong."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.rules", description=__doc__)
    parser.add_argument("--page", type=Path, help="write the page of all rules there, and nothing else")
    parser.add_argument("--work", type=Path, default=Path("rules-out"))
    parser.add_argument("--cases", type=int, default=60, help="recordings to choose from")
    parser.add_argument("--seed", type=int, default=5, help="of the recordings")
    parser.add_argument("--rules", type=int, default=None, help="only so many rules, picked at random")
    parser.add_argument("--only", nargs="*", default=None, help="only these rules, by path (search.margin)")
    parser.add_argument("--recordings", type=int, default=12, help="for each rule, at most")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--so-far", action="store_true", help="report on what is done already, and compute nothing")
    parser.add_argument("--found", type=Path, default=None, help="what the page says of it goes there (JSON)")
    asked = parser.parse_args()
    if asked.page is not None:
        asked.page.write_text(page(), encoding="utf-8", newline="\n")
        return 0
    root: Path = asked.work / f"cases-{asked.seed}-{asked.cases}"
    if not (root / "seal.txt").exists():
        make(asked.cases, asked.seed, "disclosed", root, asked.jobs)
    for part in ("base", "moved"):
        (asked.work / part).mkdir(parents=True, exist_ok=True)
    cases = sorted((root / "cases").iterdir())
    # What only bounds computing time is perturbed too, but last: it should move nothing.
    rules = sorted(rules_in(RULES), key=lambda each: each.source == TIME)
    if asked.only is not None:
        rules = [each for each in rules if each.path in asked.only]
    if asked.rules is not None:
        rules = random.Random(SEED).sample(rules, min(asked.rules, len(rules)))
    base = [(str(case), "", 1.0, str(asked.work / "base" / f"{case.name}.json")) for case in cases]
    if not asked.so_far:
        _all_done(base, asked.jobs, "as they are")
    planned = list(_perturbations(asked.work, cases, rules, asked.recordings))
    if not asked.so_far:
        _all_done(planned, asked.jobs, "perturbed")
    outcomes = _outcomes(asked.work, [job for job in planned if Path(job[3]).exists()], rules)
    text = report(outcomes)
    (asked.work / "moved.md").write_text(text, encoding="utf-8")
    if asked.found is not None:
        consulted = {path for _, path, _, _ in planned}
        run = Run(asked.seed, asked.cases, asked.recordings, len(rules), len(consulted))
        asked.found.write_text(as_json(run, outcomes), encoding="utf-8", newline="\n")
    print(text)
    return 1 if "**turned wrong**" in text else 0


if __name__ == "__main__":
    raise SystemExit(main())
