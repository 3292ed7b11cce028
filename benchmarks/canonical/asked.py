"""One recording is asked, and the answer is held against what is asked for."""

from __future__ import annotations

import contextlib
import io
import json
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.blind import answers as of_tips
from benchmarks.blind.parameters import UNITS
from benchmarks.motion import names as of_torques
from linkwright.command_line import outcome

REFUSED = "refused"
ARCHIVE = "recordings.zip"
EXPECTED = "expected.json"


@dataclass(frozen=True)
class Answer:
    """The verdict (`refused` where the input was), what is said to be missing, and the last line of a refusal."""

    verdict: str
    missing: tuple[Mapping[str, Any], ...]
    line: str = ""

    def shown(self) -> dict[str, Any]:
        """Verdict and names, as they are recorded of a miss."""
        return {"verdict": self.verdict, "names": sorted(_shown(entry) for entry in self.missing)}


def _shown(entry: Mapping[str, Any]) -> str:
    at = ",".join(str(number) for number in entry.get("at") or [])
    return f"{entry['effect']}{f' {at}' if at else ''}"


def answer(archive: Path, name: str, scratch: Path) -> Answer:
    """What `linkwright diagnose` says of a recording in the archive."""
    with zipfile.ZipFile(archive) as held:
        for file in held.namelist():
            if file.startswith(f"{name}/"):
                (scratch / Path(file).name).write_bytes(held.read(file))
    words, result = io.StringIO(), scratch / "answer.json"
    recordings = [str(path) for path in sorted(scratch.glob("recording*.csv"))]
    asked = ["diagnose", str(scratch / "arm.yaml"), *recordings, "--json", str(result)]
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(words):
        status = outcome(asked)
    if status:
        return Answer(REFUSED, (), (words.getvalue().strip().splitlines() or [""])[-1])
    said = json.loads(result.read_text(encoding="utf-8"))
    return Answer(said["verdict"], (*said["missing"], *said.get("events", ())))


def faults(name: str, asked: Mapping[str, Any], given: Answer) -> list[str]:
    """What is wrong with an answer, in words; empty where it is as asked for.

    Args:
        name: The recording; its first word is the world.
        asked: `verdict` those that will do; `names` each large cause as effect and places, to be named or among the
            alternatives of a name; `others` small ones that may be named; `sizes` by parameter the true value in SI
            units and the relative tolerance; `joints` how many the arm has; `line` what a refusal has to say.
        given: The answer.
    """
    results = [] if given.verdict in asked["verdict"] else [f"{given.verdict}, not {' or '.join(asked['verdict'])}"]
    results += [f"the refusal does not say {words!r}" for words in asked.get("line", ()) if words not in given.line]
    truth = {
        "effects": [{"effect": effect, "at": at} for effect, at in (*asked["names"], *asked["others"])],
        "joints": asked["joints"],
    }
    torques = name.startswith("torques")

    def right(entry: Mapping[str, Any], true: Mapping[str, Any]) -> bool:
        return of_torques.in_class(entry, true, truth) if torques else of_tips.in_class(entry, true)

    results += [
        f"{true['effect']} {true['at']} is not named"
        for true in truth["effects"][: len(asked["names"])]
        if not any(right(entry, true) for entry in given.missing)
    ]
    if given.verdict in of_tips.NAMES:
        for entry in given.missing:
            alike = torques and of_torques.is_alike(entry, truth)
            if not alike and not any(right(entry, true) for true in truth["effects"]):
                results.append(f"{_shown(entry)} is no cause")
    return [*results, *_sizes(asked["sizes"], asked["names"], given.missing)]


def _sizes(
    asked: Mapping[str, Sequence[float]], names: Sequence[Any], missing: Sequence[Mapping[str, Any]]
) -> list[str]:
    """Sizes of the true names that are off, in SI units; what an interval holds is right."""
    results: list[str] = []
    effects = {effect for effect, _ in names}
    for entry in missing:
        for parameter, size in (entry.get("parameters") or {}).items():
            if entry["effect"] not in effects or f"{entry['effect']}.{parameter}" not in asked:
                continue
            value, tolerance = asked[f"{entry['effect']}.{parameter}"]
            _, unit = UNITS[size.get("unit") or ""]
            given = unit * size["value"]
            ends = [unit * end for end in size.get("ci95") or [size["value"]]]
            close = abs(given - value) <= tolerance * abs(value)
            if not close and not min(ends) <= value <= max(ends):
                results.append(f"{entry['effect']}.{parameter} is {given:.3g}, not {value:.3g}")
    return results
