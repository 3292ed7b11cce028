"""What a process of its own does for a page: one question of the public face, progress told line by line.

Started as `python -m linkwright.browser.server.work`; the question comes as JSON on standard input, what happens goes
as a JSON object a line to standard output. An interrupt leaves the best so far, as everywhere.
"""

from __future__ import annotations

import json
import os
import signal
import sys
import time
from pathlib import Path
from typing import Any

import linkwright as lw
from linkwright.cli import end_as_by_ctrl_c
from linkwright.core.executors import WorkersLost
from linkwright.core.units.quantities import InputError, NoAnswer
from linkwright.face.result import Reported

from .folder import called_plainly

_OFTEN = 0.1
"""Seconds between two signs of progress."""


class _Told:
    """Passes progress on, not more often than is looked at."""

    def __init__(self) -> None:
        self._last = 0.0

    def __call__(self, text: str, share: float) -> None:
        now = time.monotonic()
        if now - self._last >= _OFTEN:
            self._last = now
            say(text=text, share=share)


def say(**told: Any) -> None:
    """A line for the process that asked; where that is gone, so is this one."""
    try:
        print(json.dumps(told), flush=True)
    except BrokenPipeError:
        os._exit(1)


def evaluate(root: Path, out: Path, asked: dict[str, Any]) -> None:
    """Evaluate an arm: its report, and its worst poses drawn."""
    from linkwright.browser.server.drawings import worst_poses

    arm = root / asked["arm"]
    found = lw.evaluate(lw.read_arm(arm))
    _kept(found, out, arm, complete=True)
    (out / "poses.json").write_text(json.dumps(worst_poses(found.found)), encoding="utf-8")


def optimize(root: Path, out: Path, asked: dict[str, Any]) -> None:
    """Optimise a problem: report, arm file; every round told."""
    from linkwright.results.optimization import iteration_line

    problem = lw.read_problem(root / asked["problem"])
    rounding: dict[str, Any] = {"round_to": asked["round_to"]} if asked.get("round_to") else {}
    with lw.Processes() as crew:
        found = lw.optimize(
            problem,
            **rounding,
            progress=_Told(),
            log=lambda each: say(line=iteration_line(each, problem.model.minimize)),
            out_of_reach=lambda text: say(line=f"{text}; now looking for what the limits would have to be"),
            executor=crew,
        )
    _kept(found, out, *_read(root, asked), complete=not found.interrupted, lost=crew.lost)


def tradeoff(root: Path, out: Path, asked: dict[str, Any]) -> None:
    """Trace a front: report, and every design drawn."""
    from linkwright.browser.server.drawings import front_to_click

    problem = lw.read_problem(root / asked["problem"])
    with lw.Processes() as crew:
        found = lw.tradeoff(
            problem,
            x=asked["x"],
            y=asked["y"],
            by=asked.get("by") or None,
            accuracy=asked["accuracy"],
            progress=_Told(),
            executor=crew,
        )
    _kept(found, out, *_read(root, asked), complete=not found.interrupted, lost=crew.lost)
    (out / "front.json").write_text(json.dumps(front_to_click(found)), encoding="utf-8")


def diagnose(root: Path, out: Path, asked: dict[str, Any]) -> None:
    """Diagnose a recording, or several at once: report, corrected arm, residuals, the settings as they were told."""
    arm = root / asked["arm"]
    recordings, settings = ([root / name for name in asked[key]] for key in ("recordings", "settings"))
    found = lw.diagnose(
        lw.read_arm(arm),
        recordings,
        settings=settings,
        thorough=asked["thorough"],
        units=asked["units"],
        progress=_Told(),
    )
    _kept(found, out, arm, *recordings, *settings, complete=True)
    for number, own in enumerate(settings, start=1):
        name = own.name if len(settings) == 1 else f"{own.stem}-{number}{own.suffix}"
        (out / name).write_bytes(own.read_bytes())


def _kept(found: Reported, out: Path, *read: Path, complete: bool, lost: WorkersLost | None = None) -> None:
    """Tell what was found, and whether workers lost cut it short, then save it: a full disk does not take the answer
    along. An interrupt comes too late to."""
    for name in ("SIGINT", "SIGTERM", "SIGHUP"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_IGN)
    answer = repr(found).removeprefix("<").removesuffix(">")
    say(answer=answer if lost is None else f"{answer}; {lost}", complete=complete)
    found.save(out, made_from=read)


def _read(root: Path, asked: dict[str, Any]) -> list[Path]:
    return [root / asked["problem"], *(root / name for name in asked.get("beside", ()))]


def main() -> int:
    """Answer the question on standard input; gives the exit status."""
    end_as_by_ctrl_c()
    asked: dict[str, Any] = json.loads(sys.stdin.read())
    root, out = Path(asked["root"]), Path(asked["out"])
    ways = {"evaluate": evaluate, "optimize": optimize, "tradeoff": tradeoff, "diagnose": diagnose}
    try:
        ways[asked["kind"]](root, out, asked)
    except WorkersLost as error:
        say(refused=str(error))
        return 1
    except KeyboardInterrupt:
        say(refused="stopped before anything was finished, so there is nothing to keep")
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
