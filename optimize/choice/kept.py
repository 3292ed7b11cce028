"""What a search has solved, kept in a journal: a search that was stopped is gone through again with the answers that it
had, each to the last digit, and so comes to where it was and ends as it would have ended.

An answer stands under all that it followed from: the combination, the poses known, the start, what was to beat.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields, is_dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.files.write import arm_to_yaml
from linkwright.core.arm.worst.search import WorstCase, WorstPose
from linkwright.core.optimize.exchange.binding_poses import Pool, Room, pool_of
from linkwright.core.optimize.exchange.exchange import Exchanged
from linkwright.core.optimize.exchange.program import Solution
from linkwright.core.optimize.exchange.scenarios import Scenarios
from linkwright.core.optimize.journal import Journal, Record
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.result import Iteration
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError

from .bounding import Bounded
from .picks import Combination

Key = tuple[str, ...]
_ASIDE = ("file", "figures", "sizes", "uncertain")
"""Fields of a problem that its search for a nominal design does not depend on."""


@dataclass(frozen=True)
class Answer:
    """What became of a combination solved for the poses known: its solution with the objective (SI), or neither, and
    whether the solver failed then; `relaxed` is where limits give way. `room` is that of the program."""

    room: Room
    objective: float | None
    solution: Solution | None
    unsolved: bool
    relaxed: Solution | None


@dataclass(frozen=True)
class Ended:
    """How an exchange ended (`done`, with its objective in SI), or did not: with lengths that lead nowhere
    (`unreachable`), for limits that no design near kept (`infeasible`), or for the solver; and its rounds."""

    room: Room
    done: Exchanged | None
    objective: float | None
    infeasible: bool
    unreachable: bool
    rounds: tuple[Iteration, ...]


class Kept:
    """The answers for one arm, and for the scenarios that a robust search holds designs against; the drives that are
    chosen make several arms."""

    def __init__(self, journal: Journal, arm: Arm, scenarios: Scenarios | None = None) -> None:
        held = [] if scenarios is None else [[asdict(each) for each in scenarios.held]]
        self._journal, self._arm = journal, _digest([arm_to_yaml(arm), *held])

    def key(self, what: str, pick: Combination, pool: Pool, *given: Any) -> Key:
        """Under what an answer stands; `given` are numbers and arrays."""
        plain = [each.tolist() if isinstance(each, np.ndarray) else each for each in given]
        names = [None if material is None else material.name for material in pick.materials]
        return self._arm, what, _digest([pick.shapes, names, asdict(pool), plain])

    def answer(self, key: Key) -> Answer | None:
        """What a combination came to; None where it is not known."""
        found = self._found(key)
        if found is None:
            return None
        own, relaxed = found["solution"], found["relaxed"]
        return Answer(
            _room(found["room"]),
            found["objective"],
            None if own is None else _solution(own),
            found["unsolved"],
            None if relaxed is None else _solution(relaxed),
        )

    def note_answer(self, key: Key, answer: Answer) -> None:
        """Keep what a combination came to."""
        self._journal.put(
            key,
            {
                "room": asdict(answer.room),
                "objective": answer.objective,
                "solution": None if answer.solution is None else _solution_record(answer.solution),
                "unsolved": answer.unsolved,
                "relaxed": None if answer.relaxed is None else _solution_record(answer.relaxed),
            },
        )

    def ended(self, key: Key) -> Ended | None:
        """How an exchange ended; None where it is not known."""
        found = self._found(key)
        if found is None:
            return None
        done = found["done"]
        rounds = tuple(Iteration(**each) for each in found["rounds"])
        return Ended(
            _room(found["room"]),
            None if done is None else _exchanged(done),
            found["objective"],
            found["infeasible"],
            found["unreachable"],
            rounds,
        )

    def note_ended(self, key: Key, ended: Ended) -> None:
        """Keep how an exchange ended."""
        self._journal.put(
            key,
            {
                "room": asdict(ended.room),
                "done": None if ended.done is None else _exchanged_record(ended.done),
                "objective": ended.objective,
                "infeasible": ended.infeasible,
                "unreachable": ended.unreachable,
                "rounds": [_plain(asdict(each)) for each in ended.rounds],
            },
        )

    def bounded(self, key: Key) -> Bounded | None:
        """What a combination came to elsewhere; None where it is not known."""
        found = self._found(key)
        return None if found is None else Bounded(found["objective"], tuple(found["x"]), found["outcome"])

    def note_bounded(self, key: Key, bounded: Bounded) -> None:
        """Keep what a combination came to elsewhere."""
        self._journal.put(key, asdict(bounded))

    def _found(self, key: Key) -> Record | None:
        return self._journal.get(key) if self._journal.has(key) else None


def search_journal(problem: Problem, path: Path | None, made_by: str) -> Journal | None:
    """The journal of a search for a problem's best design, gone on with where the file holds one; None without a file.

    Raises `InputError` where the file is of another problem, of another version (`made_by`), or no such journal, where
    another process holds it, and where sizes are listed, which are searched in one go.
    """
    if path is None:
        return None
    if problem.sizes is not None:
        raise InputError(problem.file, "choose.sizes", "are searched in one go; leave --resume (resume=) out")
    return Journal(
        path,
        digest_of(problem, made_by),
        resume=True,
        made_by=made_by,
        of="a search for a design",
        differs="problem or version differ",
        would_do="name another file, or remove this one to begin anew",
    )


def digest_of(problem: Problem, made_by: str) -> str:
    """SHA-256 over all that a search depends on: the arm, the problem, the materials' figures, and the version."""
    own = [link.material for link in problem.arm.links]
    materials = [*own, *(problem.materials or ())]
    told = {
        "arm": arm_to_yaml(problem.arm),
        "workspace": asdict(problem.workspace),
        "load_cases": [asdict(case) for case in problem.load_cases],
        "limits": [[limit.name, limit.relation, limit.value, limit.poses] for limit in problem.limits],
        "materials": [None if x is None else [x.name, asdict(x.at(problem.arm.temperature))] for x in materials],
        "actuators": [[asdict(each) for each in own] for own in problem.actuators or ()],
        "same": sorted(problem.same),
    }
    rest = {each.name: getattr(problem, each.name) for each in fields(problem) if each.name not in (*told, *_ASIDE)}
    return _digest([told, rest, made_by])


def _digest(content: Any) -> str:
    return hashlib.sha256(json.dumps(content, sort_keys=True, default=_as_list).encode()).hexdigest()


def _as_list(value: Any) -> Any:
    """What JSON has no word for: arrays, and numbers of NumPy."""
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    if isinstance(value, Mapping):
        return dict(value)
    if is_dataclass(value) and not isinstance(value, type):
        return asdict(value)
    return str(value)


def _plain(content: Any) -> Any:
    return json.loads(json.dumps(content, default=_as_list))


def _room(content: Record) -> Room:
    return Room(tuple(content["errors"]), tuple((name, tuple(slots)) for name, slots in content["held"]))


def _solution_record(solution: Solution) -> dict[str, Any]:
    found = {name: value for name, value in vars(solution).items() if name not in ("active", "multipliers")}
    multipliers = {name: value.tolist() for name, value in solution.multipliers.items()}
    return _plain({**found, "active": asdict(solution.active), "multipliers": multipliers})


def _solution(content: Record) -> Solution:
    multipliers = {name: _array(value) for name, value in content["multipliers"].items()}
    own: dict[str, Any] = {
        **content,
        "x": _array(content["x"]),
        "limit_prices": tuple(content["limit_prices"]),
        "bound_prices": _array(content["bound_prices"]),
        "shape_prices": tuple((text, price) for text, price in content["shape_prices"]),
        "slacks": tuple(content["slacks"]),
        "active": pool_of(content["active"]),
        "multipliers": MappingProxyType(multipliers),
    }
    return Solution(**own)


def _array(values: list[float]) -> Array:
    return np.array(values, dtype=float)


def _exchanged_record(done: Exchanged) -> dict[str, Any]:
    return _plain(
        {
            "x": done.x,
            "solution": _solution_record(done.solution),
            "pool": asdict(done.pool),
            "worst": None if done.worst is None else asdict(done.worst),
            "iterations": [asdict(each) for each in done.iterations],
            "certified": done.certified,
            "converged": done.converged,
            "bounded_out": done.bounded_out,
        }
    )


def _exchanged(content: Record) -> Exchanged:
    worst = content["worst"]
    return Exchanged(
        _array(content["x"]),
        _solution(content["solution"]),
        pool_of(content["pool"]),
        None if worst is None else _worst(worst),
        tuple(Iteration(**each) for each in content["iterations"]),
        content["certified"],
        content["converged"],
        content["bounded_out"],
    )


def _worst(content: Record) -> WorstCase:
    poses = tuple(
        WorstPose(
            tuple(each["q"]),
            each["load_case"],
            each["error"],
            (each["vector"][0], each["vector"][1], each["vector"][2]),
            tuple(each["signs"]),
            tuple((shift[0], shift[1], shift[2]) for shift in each["shifts"]),
        )
        for each in content["poses"]
    )
    return WorstCase(content["error"], content["upper_bound"], content["certified"], poses)
