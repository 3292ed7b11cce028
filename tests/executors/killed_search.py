"""A search in a process of its own, which kills itself once its workers have found so much; its answer in a file.

`python -m tests.executors.killed_search PROBLEM JOURNAL ANSWER ADDRESS KILL_AT`: no ADDRESS is two processes, and 0 for
KILL_AT no kill. Told on standard output: the processes' ids, once there are two.
"""

from __future__ import annotations

import os
import pickle
import signal
import sys
from contextlib import ExitStack
from pathlib import Path

from linkwright.core.executors import Cluster, Processes
from linkwright.core.optimize.choice.solution_cache import search_journal
from linkwright.core.optimize.problem import read_problem
from linkwright.core.optimize.run import optimise


def main(problem: str, journal: str, answer: str, address: str, kill_at: str) -> None:
    """Run it."""
    asked = read_problem(Path(problem))
    with ExitStack() as stack:
        crew = Cluster(address, patience=60.0) if address else Processes(2, patience=0.0)
        stack.enter_context(crew)
        book = search_journal(asked, Path(journal), "linkwright 0")
        assert book is not None
        stack.enter_context(book)

        def progress(done: int, total: int, text: str) -> None:
            del total
            if text == "bounding combinations" and done >= int(kill_at) > 0:
                if isinstance(crew, Processes):
                    print(*crew.processes(), flush=True)
                os.kill(os.getpid(), signal.SIGKILL)

        result = optimise(asked, progress=progress, executor=crew, journal=book)
    Path(answer).write_bytes(pickle.dumps((result.arm, result.objective, result.lower_bound, result.candidates)))


if __name__ == "__main__":
    main(*sys.argv[1:])
