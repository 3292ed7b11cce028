"""What works on many things: a choice among millions, executors, scans against bounds."""

from __future__ import annotations

import math
import tempfile
import time
from functools import partial
from pathlib import Path

from benchmarks.choice_among_millions import COMMANDS, LIMITS, commanded, listed, problem
from benchmarks.executors_efficiency import TARGET, cluster, measured
from linkwright.core.executors import Cluster, Processes
from linkwright.core.optimize.choice.at_once.branching import Branching
from linkwright.core.optimize.choice.chooser import Chooser
from linkwright.core.optimize.choice.picks import count
from linkwright.core.optimize.exchange.exchange import context_of

from . import random_problems
from .row import Row, at_most

GAP = 0.01


def millions(*, quick: bool) -> list[Row]:
    """The best of millions of combinations to a proven gap."""
    rows: list[Row] = []
    for name, limits in LIMITS.items():
        with tempfile.TemporaryDirectory() as folder:
            asked = problem(Path(folder), limits, 10 if quick else 30)
            began = time.process_time()
            proof = Branching(Chooser(context_of(asked), None, None), GAP).run(40)
            seconds = time.process_time() - began
        what = f"{count(asked):,} combinations, limits on {name}: proven gap"
        gap = math.inf if proof is None else 100.0 * proof.gap
        rows.append(at_most(what, gap, "%", 100.0 * GAP, f"in {seconds:.1f} s"))
    for name, limits in COMMANDS.items():
        answer = commanded(partial(problem, limits=limits))
        what = f"linkwright optimize, {answer.combinations:,} combinations, {name}: proven gap"
        note = f"in {answer.cpu:.0f} s, near ties solved too, {answer.seconds:.0f} s by the wall"
        rows.append(at_most(what, 100.0 * answer.gap, "%", 100.0 * GAP, note))
    answer = commanded(listed)
    what = f"linkwright optimize, {answer.combinations:,} combinations of listed tubes, lengths with a sum: "
    note = f"in {answer.cpu:.0f} s, {answer.seconds:.0f} s by the wall"
    rows.append(at_most(f"{what}proven gap", 100.0 * answer.gap, "%", 100.0 * GAP, note))
    return rows


def executors(*, quick: bool) -> list[Row]:
    """The efficiency per worker of processes and of a dask scheduler, with tasks that sleep a second."""
    tasks = [1.0] * (8 if quick else 32)
    with Processes(2, patience=0.0) as processes:
        results = {"processes": measured("processes", processes, 2, tasks)}
    with cluster(2) as address, Cluster(address) as workers:
        results["dask, separate processes"] = measured("dask", workers, 2, tasks)
    note = f"2 workers, {len(tasks)} tasks of a second, by the wall"
    return [
        Row(what, f"{result:.3f}", f"at least {TARGET:g}", result >= TARGET, note) for what, result in results.items()
    ]


def random_scans(*, quick: bool, problems: int = 200) -> list[Row]:
    """Random problems whose bounds are held against finer scans."""
    problems = 10 if quick else problems
    results = [item for item in map(random_problems.run, range(problems)) if item is not None]
    bounded = [result for result in results if result.bound is not None]
    beaten = sum(item.worst > item.bound * (1.0 + 1e-9) for item in bounded if item.bound is not None)
    poses = sum(result.poses for result in results)
    note = f"{len(bounded)} answers with a bound of {problems} problems, {poses:,} poses; "
    note += f"the scan reaches {min(item.tight for item in bounded):.5f} of the bound at least"
    return [Row("bounds that a scan beats", str(beaten), "none", beaten == 0, note)]
