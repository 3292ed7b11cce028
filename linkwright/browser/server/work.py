"""The process of a job: one call of the public functions for a page, its progress reported line by line.

Started as `python -m linkwright.browser.server.work`; the question comes as JSON on standard input, what happens goes
as a JSON object a line to standard output. An interrupt leaves the best so far, as everywhere.
"""

from __future__ import annotations

import inspect
import json
import os
import signal
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import linkwright as lw
from linkwright.cli import end_as_by_ctrl_c
from linkwright.commands.made import parameters_of, paths_in
from linkwright.core.executors import WorkersLost
from linkwright.core.units.quantities import InputError, NoAnswer
from linkwright.face.design import Optimization
from linkwright.face.evaluation import Evaluation
from linkwright.face.result import Result
from linkwright.face.tradeoff import Tradeoff
from linkwright.results.document import plain

from .folder import called_plainly

if TYPE_CHECKING:
    from linkwright.core.optimize.result import Iteration

_OFTEN = 0.1
"""Seconds between two signs of progress."""


class _Progress:
    """Passes progress on, not more often than is looked at."""

    def __init__(self) -> None:
        self._last = 0.0

    def __call__(self, text: str, share: float) -> None:
        now = time.monotonic()
        if now - self._last >= _OFTEN:
            self._last = now
            say(text=text, share=share)


def say(**event: Any) -> None:
    """A line for the process that asked; where that is gone, so is this one."""
    try:
        print(json.dumps(event), flush=True)
    except BrokenPipeError:
        os._exit(1)


def answered(kind: str, root: Path, out: Path, asked: Mapping[str, Any]) -> None:
    """Call the function of that name with what is asked, by its parameters, files below `root`; tell what was found and
    whether workers lost cut it short, then save it with what its page shows: a full disk does not take it along."""
    function = getattr(lw, kind)
    parameters = [parameter for parameter in parameters_of(function) if asked.get(parameter.name) not in (None, "", [])]
    words = {
        parameter.name: _placed(asked[parameter.name], root) if parameter.kind is Path else asked[parameter.name]
        for parameter in parameters
    }
    reads: dict[str, Callable[[Any], Any]] = {"arm": lw.read_arm, "problem": lw.read_problem, "": lambda word: word}
    arguments = {parameter.name: reads[parameter.option.reads](words[parameter.name]) for parameter in parameters}
    named = [path for parameter in parameters for path in paths_in(words[parameter.name])]
    problem: lw.Problem | None = arguments.get("problem")
    with lw.Processes() as crew:
        hears = {**_heard(problem), "progress": _Progress(), "executor": crew}
        takes = inspect.signature(function).parameters
        result = function(**arguments, **{name: heard for name, heard in hears.items() if name in takes})
    for name in ("SIGINT", "SIGTERM", "SIGHUP"):  # an interrupt comes too late
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_IGN)
    lost = "" if crew.lost is None else f"; {crew.lost}"
    say(answer=_verdict(result) + lost, complete=not getattr(result, "interrupted", False))
    arm = None if problem is None else problem.arm_file
    result.save(out, made_from=[*named, *([] if arm is None else [arm])])
    _beside(result, out, words.get("settings", ()))


def _verdict(result: Result) -> str:
    """The sentence that heads the result's report; of a search that was stopped, that it was."""
    if getattr(result, "interrupted", False):
        return repr(result)[1:-1]
    words = " ".join(plain(result.description.headline).split())
    return words[:1].upper() + words[1:]


def _placed(names: str | list[str], root: Path) -> Path | list[Path]:
    return root / names if isinstance(names, str) else [root / name for name in names]


def _heard(problem: lw.Problem | None) -> dict[str, Any]:
    """What `optimize` tells of on the way."""
    if problem is None:
        return {}
    from linkwright.results.optimization import iteration_line

    def log(iteration: Iteration) -> None:
        say(line=iteration_line(iteration, problem.model.objective))

    def out_of_reach(text: str) -> None:
        say(line=text)

    return {"log": log, "out_of_reach": out_of_reach}


def _beside(result: Any, out: Path, settings: Sequence[Path]) -> None:
    """What only the pages show: worst poses, fronts and near ties to click on; and the settings as they were
    reported."""
    from linkwright.browser.server.drawings import choices_to_click, front_to_click, worst_poses

    if isinstance(result, Evaluation):
        (out / "poses.json").write_text(json.dumps(worst_poses(result.found)), encoding="utf-8")
    if isinstance(result, Tradeoff):
        (out / "front.json").write_text(json.dumps(front_to_click(result)), encoding="utf-8")
    if isinstance(result, Optimization) and result.found.near_ties:
        designs, arms = choices_to_click(result)
        (out / "choices.json").write_text(json.dumps(designs), encoding="utf-8")
        for name, arm in arms.items():
            (out / name).parent.mkdir(exist_ok=True)
            lw.Arm.of(arm, catalogue=result.problem.arm.catalogue).save(out / name)
    for number, file in enumerate(settings, start=1):
        name = file.name if len(settings) == 1 else f"{file.stem}-{number}{file.suffix}"
        (out / name).write_bytes(file.read_bytes())


def main() -> int:
    """Answer the question on standard input; gives the exit status."""
    # A server that a script began in the background ignores interrupts, and passes that on.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    end_as_by_ctrl_c()
    request: dict[str, Any] = json.loads(sys.stdin.read())
    say(text="starting", share=0.0)
    root, out = Path(request["root"]), Path(request["out"])
    try:
        answered(request["kind"], root, out, request)
    except WorkersLost as error:
        say(refused=str(error))
        return 1
    except KeyboardInterrupt:
        say(stopped=True)
        return 1
    except InputError as error:
        say(refused=str(called_plainly(error, root)))
        return 2
    except OSError as error:
        say(refused=f"its files cannot be written: {error.strerror or error}")
        return 1
    except NoAnswer as error:
        say(refused=" ".join(str(error).split()))
        return 1
    except MemoryError:
        say(refused="there is not enough memory for this; ask for less at once")
        return 1
    say(done=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
