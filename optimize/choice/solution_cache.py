"""The solutions of a search, cached in a journal. A search that was interrupted runs again from the start; what it had
solved is read from the cache, digit for digit, so that it ends as it would have without the interrupt.

The key of a solution is all that it depends on: the combination, the poses known, the start, the objective to beat.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields, is_dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any, cast

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.figures import Cut
from linkwright.core.arm.files.write import arm_to_yaml
from linkwright.core.arm.worst.search import WorstCase, WorstPose
from linkwright.core.optimize.exchange.binding_poses import Anchor, ErrorCut, Pool, Room
from linkwright.core.optimize.exchange.exchange import Exchanged
from linkwright.core.optimize.exchange.program import Solution
from linkwright.core.optimize.exchange.scenarios import Scenarios
from linkwright.core.optimize.journal import Journal
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.result import Iteration
from linkwright.core.units.quantities import InputError

from .bounding import Bounded
from .picks import Combination

Key = tuple[str, ...]
_RECORDS = 2
"""How answers are written: journals of another way are of another version."""
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
        held = [] if scenarios is None else [[asdict(scenario) for scenario in scenarios.held]]
        self._journal, self._arm = journal, _digest([arm_to_yaml(arm), *held])

    def key(self, what: str, pick: Combination, pool: Pool, *given: Any) -> Key:
        """Under what an answer stands; `given` are numbers and arrays."""
        plain = [item.tolist() if isinstance(item, np.ndarray) else item for item in given]
        names = [None if material is None else material.name for material in pick.materials]
        return self._arm, what, _digest([pick.shapes, names, asdict(pool), plain])

    def get(self, key: Key) -> Any:
        """The answer under a key; None where it is not known."""
        content = self._journal.get(key) if self._journal.has(key) else None
        return None if content is None else unpacked(content)

    def put(self, key: Key, answer: Answer | Ended | Bounded) -> None:
        """Keep an answer."""
        self._journal.put(key, packed(answer))


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
    content = {
        "arm": arm_to_yaml(problem.arm),
        "workspace": asdict(problem.workspace),
        "load_cases": [asdict(case) for case in problem.load_cases],
        "limits": [[limit.name, limit.relation, limit.value, limit.poses] for limit in problem.limits],
        "materials": [None if x is None else [x.name, asdict(x.at(problem.arm.temperature))] for x in materials],
        "actuators": [[asdict(item) for item in joint_actuators] for joint_actuators in problem.actuators or ()],
        "same": sorted(problem.same),
        "lists": [
            [link_list.shapes, [material.name for material in link_list.materials or ()]]
            for link_list in problem.lists or ()
        ],
    }
    rest = {
        field.name: getattr(problem, field.name) for field in fields(problem) if field.name not in (*content, *_ASIDE)
    }
    return _digest([content, rest, made_by, _RECORDS])


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


_KINDS = MappingProxyType(
    {
        kind.__name__: kind
        for kind in (
            *(Answer, Ended, Bounded, Room, Solution, Exchanged, Iteration),
            *(Pool, ErrorCut, Anchor, Cut, WorstCase, WorstPose),
        )
    }
)
"""What answers are made of."""


def packed(value: Any) -> Any:
    """A value as JSON holds it: dataclasses by their names, arrays and mappings marked, tuples as lists."""
    if isinstance(value, np.ndarray):
        return {"array": value.tolist()}
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, Mapping):
        return {"mapping": {str(name): packed(item) for name, item in cast(Mapping[object, Any], value).items()}}
    if isinstance(value, tuple):
        return [packed(item) for item in cast(tuple[Any, ...], value)]
    if is_dataclass(value) and not isinstance(value, type):
        own = {field.name: packed(getattr(value, field.name)) for field in fields(value)}
        return {"kind": type(value).__name__, **own}
    return value


def unpacked(content: Any) -> Any:
    """The value that `packed` made JSON of."""
    if isinstance(content, list):
        return tuple(unpacked(item) for item in cast(list[Any], content))
    if not isinstance(content, dict):
        return content
    own = cast(dict[str, Any], content)
    if "array" in own:
        return np.array(own["array"], dtype=float)
    if "mapping" in own:
        return MappingProxyType({name: unpacked(item) for name, item in own["mapping"].items()})
    return _KINDS[own["kind"]](**{name: unpacked(item) for name, item in own.items() if name != "kind"})
