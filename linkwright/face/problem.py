"""Design problems for programs: read from a file or stated in place, checked as a file is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from linkwright.core.arm.chain.chain import LoadCase
from linkwright.core.optimize.problem import Problem as Model
from linkwright.core.optimize.problem import arm_file, problem_from
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import Mapping as Reader
from linkwright.core.units.reading import load_yaml

from .arm import Arm, arm_of, catalogue_of, read_arm
from .plain_input import File, edited, path_of, plain


@dataclass(frozen=True, init=False, repr=False)
class Problem:
    """A design problem: what to make as good as it can be, over which poses and loads, within which limits, choosing
    what; frozen.

    `arm` is an arm or the path of an arm file; the other keywords are the keys of a problem file: `minimize` or
    `maximize` (a figure of `lw.limits`, the error by default), `workspace`, `load_cases`, `subject_to` with limits as
    text (`"<= 26 kg"`) and ranges as text or SI, `choose`. Raises `InputError`, one line with the key and what would
    do.

    >>> import linkwright as lw
    >>> lw.Problem(
    ...     arm="examples/welding-arm/arm.yaml",
    ...     minimize="mass",
    ...     subject_to={"max_error": "<= 0.5 mm", "section_size": [0.02, "150 mm"]},
    ...     choose={"section": ["circle"]},
    ... )
    <Problem: least mass of cathode-bus welding arm, max_error <= 0.5 mm>
    """

    arm: Arm
    model: Model
    """What the optimiser works with, SI."""
    _content: Mapping[str, Any] = field(compare=False)

    def __init__(self, arm: Arm | File, minimize: str | None = None, **keys: object) -> None:
        given = arm_of(arm, tips="every")
        content: dict[str, Any] = plain({**({} if minimize is None else {"minimize": minimize}), **keys})
        self._fill(given, Reader(content, file="Problem"))

    def _fill(self, arm: Arm, mapping: Reader) -> None:
        model = problem_from(mapping, arm.model, catalogue_of(arm.catalogue))
        for name, value in (("arm", arm), ("model", model), ("_content", mapping.content)):
            object.__setattr__(self, name, value)

    @property
    def arm_file(self) -> Path | None:
        """The arm file that the problem file names; None for a problem that was stated in place."""
        arm = self._content.get("arm")
        return Path(self.model.file).parent / arm if isinstance(arm, str) else None

    @classmethod
    def of(cls, arm: Arm, mapping: Reader) -> Problem:
        """The problem that a mapping of a problem file states for an arm."""
        made = cls.__new__(cls)
        made._fill(arm, mapping)
        return made

    def replace(self, key: str, value: object) -> Problem:
        """A new problem with one key of its file changed, such as `subject_to.mass`; `arm` takes another arm.

        Raises `InputError` for a key that nobody knows, with the nearest known one.
        """
        if key == "arm" and isinstance(value, Arm | str | Path):
            return Problem.of(arm_of(value, tips="every"), Reader(self._content, file=self.model.file))
        return Problem.of(self.arm, Reader(edited(self._content, key, value, "Problem"), file="Problem"))

    def __repr__(self) -> str:
        """One line."""
        limits = "".join(f", {limit.text}" for limit in self.model.limits)
        goal = self.model.minimize.replace("_", " ").replace("max error", "worst error")
        how = "most" if self.model.objective.more_is_better else "least"
        return f"<Problem: {how} {goal} of {' '.join(self.arm.name.split())}{limits}>"


def read_problem(path: File, *, catalogue: File | None = None) -> Problem:
    """The problem that a problem file states, with its arm file beside it; `catalogue` adds materials.

    Raises `InputError`, one line with the file, the key and what would do, for anything wrong.

    >>> import linkwright as lw
    >>> problem = lw.read_problem("examples/welding-arm/problem.yaml")
    >>> problem.arm.name
    'cathode-bus welding arm'
    >>> problem.replace("subject_to.mass", "<= 20 kg").model.limits[0].text
    'mass <= 20 kg'
    """
    mapping = load_yaml(path_of(path, "problem", "a Problem"))
    return Problem.of(read_arm(arm_file(mapping), catalogue=catalogue), mapping)


def problem_of(given: Problem | File) -> Problem:
    """A problem as given, or read from the file that is named."""
    return given if isinstance(given, Problem) else read_problem(given)


def cases_at(asked: Model, arm: Arm) -> tuple[LoadCase, ...]:
    """The load cases of a problem that are of an arm's tip: of one of several on one torso its own, else all. Raises
    `InputError` where there are none."""
    model = arm.model
    if not model.branches or model.every_tip:
        return asked.load_cases
    cases = tuple(case for case in asked.load_cases if case.tip == model.tip)
    if not cases:
        raise InputError(asked.file, "load_cases", f"hold none of the tip {model.tip}")
    return cases


def for_joints_of(arm: Arm, asked: Model) -> None:
    """Refuse a problem whose workspace, or what it calls uncertain, is of another number of joints. Raises
    `InputError`."""
    ranges = asked.workspace.ranges
    for key, size in (
        ("workspace", None if ranges is None else len(ranges)),
        ("uncertain", None if asked.uncertain is None else asked.arm.size),
    ):
        if size is not None and size != arm.model.size:
            raise InputError(asked.file, key, f"is for {size} joints; {arm.name} has {arm.model.size}")
