"""A figure of a design that can be limited: one object holds all that other rooms must know of it.

A figure follows from a design in one of four ways: it is the worst error itself (`WorstError`); it follows from the
sums over the links (`OfDesign`); it follows from each link's section and material (`OfLinks`); or it has a value at
every pose, the worst of which counts (`ThroughPoses`). One function serves symbols, floats and arrays, so that the
optimiser, the evaluation and the rounding cannot disagree.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, TypeAlias

from linkwright.core.sections.numeric import Array
from linkwright.core.sections.taper import Tapered
from linkwright.core.units.quantities import InputError, Relation, format_quantity

from .design import DesignExpressions, Designs, Totals

if TYPE_CHECKING:
    from linkwright.core.arm.actuators import Actuator
    from linkwright.core.arm.chain.chain import Arm, LoadCase
    from linkwright.core.arm.evaluation import Evaluation
    from linkwright.core.arm.worst.search import WorstSearch
    from linkwright.core.materials.material import MaterialValues
    from linkwright.core.sections import Section


@dataclass(frozen=True)
class Cut:
    """A pose at which a figure binds: joint coordinates, the group that it belongs to (a load case, say), and what
    else its rows take as parameters."""

    q: tuple[float, ...]
    group: int = 0
    more: tuple[float, ...] = ()


@dataclass(frozen=True)
class Worst:
    """The worst of a figure (by its name) somewhere in the workspace: the value (SI) and the pose that shows it.

    `limit` numbers the problem's limit that alone it speaks of; None for all limits on the figure.
    """

    name: str
    value: float
    cut: Cut
    limit: int | None = None


class Asked(Protocol):
    """What a figure sees of a problem."""

    @property
    def arm(self) -> Arm:
        """The arm as given."""
        ...

    @property
    def load_cases(self) -> tuple[LoadCase, ...]:
        """The payloads and forces."""
        ...

    @property
    def limits(self) -> tuple[Limit, ...]:
        """The limits in the problem's order, by which they are numbered."""
        ...

    @property
    def shapes(self) -> tuple[str, ...] | None:
        """The shapes that links may have; None keeps the arm's own."""
        ...

    @property
    def actuators(self) -> tuple[tuple[Actuator, ...], ...] | None:
        """What each joint's drive may be; None keeps all."""
        ...


class PoseFamily(ABC):
    """Figures that have a value at every pose and share the work that finds it."""

    name: ClassVar[str]
    bounds_many: ClassVar[bool] = True
    """Whether `at_pose` bounds many designs at once; otherwise designs are looked at one by one."""
    slope: ClassVar[float] = 1.0
    """By how many per cent a row gives way for one per cent of its limit."""

    @abstractmethod
    def prepare(self, problem: Asked) -> Any:
        """What is set up once for a problem; the other methods get it back."""

    def groups(self, problem: Asked) -> int:
        """How many groups of poses there are: the load cases, unless a family says otherwise."""
        return len(problem.load_cases)

    def more(self, prepared: Any) -> int:
        """How many numbers a cut's rows take beside the pose."""
        del prepared
        return 0

    @abstractmethod
    def rows(
        self, prepared: Any, group: int, pose: tuple[Any, Any], design: DesignExpressions, held: Held
    ) -> Iterable[tuple[int, Any]]:
        """The rows (each <= 0) of one pose (its coordinates and further numbers, as symbols), each with the number of
        the limit that it holds."""

    @abstractmethod
    def worst(self, prepared: Any, problem: Asked, search: WorstSearch, arm: Arm, p: Array) -> list[Worst]:
        """The worst of each figure over the workspace for a design, with the poses that show it."""

    def load_case(self, cut: Cut) -> int:
        """The load case of a cut: its group, unless a family says otherwise."""
        return cut.group

    def first(self, found: Sequence[Worst]) -> list[Cut]:
        """The poses to begin an exchange with, of those that a first design shows."""
        return [each.cut for each in found]

    def at_pose(self, prepared: Any, group: int, q: Array, designs: Designs) -> Mapping[str, Array]:
        """The figures (N) of many designs, each at a pose of its own q (N, n) under a load case."""
        del prepared, group, q, designs
        return {}

    def at_cut(self, prepared: Any, problem: Asked, arm: Arm, cut: Cut) -> float | None:
        """The figure of one design at a pose known from another, for a family that looks at designs one by one."""
        del prepared, problem, arm, cut
        return None

    def exactly(self, prepared: Any, limit: Limit, designs: Designs) -> Array | None:
        """The figure (N) that a limit is on, where no search for poses is needed for it."""
        del prepared, limit, designs
        return None


@dataclass(frozen=True)
class Held:
    """The limits of a problem as a program has them: values and slacks as symbols."""

    limits: tuple[Limit, ...]
    slack: Any

    def on(self, name: str) -> list[tuple[int, Any, Any]]:
        """The number, the value and the slack of each limit on a figure."""
        return [(k, limit.value, self.slack[k]) for k, limit in enumerate(self.limits) if limit.name == name]


@dataclass(frozen=True)
class WorstError:
    """The worst error: the exchange has it at hand."""


@dataclass(frozen=True)
class OfDesign:
    """A figure of the sums over a design.

    >>> import linkwright as lw
    >>> isinstance(lw.limits["mass"].follows, lw.OfDesign)
    True
    """

    value: Callable[[Totals], Any]


@dataclass(frozen=True)
class OfLinks:
    """A figure of each link: `values` are one or more of a section and its material (floats or symbols), all of which
    have to keep a limit; empty where a link has nothing to limit, None where it is not known.

    >>> import linkwright as lw
    >>> aspect = lw.OfLinks(lambda section, material: (section.height / section.width,))
    >>> aspect.values(lw.shapes.Rectangle(width="40 mm", height="60 mm"), None)
    (1.5,)
    """

    values: Callable[[Section, MaterialValues], Sequence[Any] | None]


@dataclass(frozen=True)
class ThroughPoses:
    """A figure that has a value at every pose."""

    family: PoseFamily


Follows: TypeAlias = WorstError | OfDesign | OfLinks | ThroughPoses


@dataclass(frozen=True)
class Figure:
    """A figure of a design that can be limited.

    Attributes:
        name: as in problem files.
        title: a phrase for tables and axes.
        senses: the relations that a limit may have.
        key: its name in JSON, with the unit.
        follows: how it follows from a design.
        kind: the kind of quantity, a name in `units.kinds()`.
        unit: what people read it in; empty for a pure number.
        factor: what one SI unit is in `unit`.
        of: its value (SI) in an evaluation, None where it is not known; left out where it follows from the links.
        more_is_better: which way a trade-off pushes it.
        note: a few words for tables, beside the value.
        where: the pose at which an evaluation has it, if that is worth telling.
        needs: the material properties without which a limit on it cannot be judged.
        titled, noted: the title and the note for a certain arm, where those differ.
        minimised: whether a problem can minimise it.
        traded: whether a trade-off can have it as an axis.
        at_poses: whether a limit may name the poses at which it holds, and its value (SI) there.
        assumed: the limit (SI) that a problem has on it without asking, if any.
        everywhere: whether any arm has it; where one that need not has none, nothing is told of it.
        digits: significant digits where it stands alone.
        synonyms: what people call it as well, for who is told its name.

    >>> import linkwright as lw
    >>> girth = lw.OfLinks(lambda section, material: (2.0 * (section.width + section.height),))
    >>> lw.Figure("girth", "greatest girth", ("<=",), "girth_mm", girth, "length", "mm", 1e3).unit
    'mm'
    """

    name: str
    title: str
    senses: tuple[Relation, ...]
    key: str
    follows: Follows
    kind: str = "dimensionless"
    unit: str = ""
    factor: float = 1.0
    of: Callable[[Evaluation], float | None] | None = None
    more_is_better: bool = False
    note: str = ""
    where: Callable[[Evaluation], tuple[float, ...] | None] | None = None
    needs: tuple[str, ...] = ()
    titled: Callable[[Arm], str] | None = None
    noted: Callable[[Arm], str] | None = None
    minimised: bool = False
    traded: bool = True
    at_poses: Callable[[Evaluation, Sequence[tuple[float, ...]]], float | None] | None = None
    assumed: Callable[[Asked], float | None] | None = None
    everywhere: bool = True
    digits: int = 4
    synonyms: tuple[str, ...] = ()

    def __reduce__(self) -> tuple[object, ...]:
        """To another process a figure that is shipped or registered goes by its name."""
        from linkwright.core.optimize.limits import FIGURES

        if FIGURES.get(self.name) is self:
            return _by_name, (self.name,)
        return type(self), tuple(getattr(self, each.name) for each in fields(self))

    def value(self, evaluation: Evaluation) -> float | None:
        """The figure (SI) of an evaluated design; None where it is not known or nothing has it."""
        if self.of is not None:
            return self.of(evaluation)
        assert isinstance(self.follows, OfLinks)
        return self.of_links(self.follows, evaluation.arm)

    def of_links(self, follows: OfLinks, arm: Arm) -> float | None:
        """The worst over an arm's links; 0 where no link has anything to limit, None where one is not known."""
        found: list[float] = []
        for link in arm.links:
            if link.section is None or link.material is None:
                continue
            material = link.material.at(arm.temperature)
            # Along a taper the worst is at one of the ends.
            ends = (link.section.near, link.section.far) if isinstance(link.section, Tapered) else (link.section,)
            for section in ends:
                own = follows.values(section, material)
                if own is None:
                    return None
                found += [float(value) for value in own]
        return self.worst(found) if found else 0.0

    def worst(self, values: Sequence[float]) -> float:
        """The worst of some values: the least where more is better."""
        return min(values) if self.more_is_better else max(values)

    def told(self, evaluation: Evaluation) -> bool:
        """Whether there is anything to tell of it: a value, or a reason why none is known."""
        if self.value(evaluation) is not None or self.name in evaluation.unknown:
            return True
        return self.everywhere and self.assumed is None

    def note_for(self, arm: Arm) -> str:
        """The note beside the figure of an arm."""
        return self.note if self.noted is None else self.noted(arm)

    def title_for(self, arm: Arm) -> str:
        """The title for a certain arm."""
        return self.title if self.titled is None else self.titled(arm)

    def shown(self, value: float | None) -> float | None:
        """A value (SI) in the unit that people read; None where it is not known."""
        return None if value is None or math.isnan(value) else self.factor * value


def _by_name(name: str) -> Figure:
    from linkwright.core.optimize.limits import FIGURES

    if name not in FIGURES:
        would_do = "install it on every worker, as a package with an entry point"
        raise InputError("", name, f"is a limit of one's own that a worker does not know; {would_do}")
    return FIGURES[name]


@dataclass(frozen=True)
class Limit:
    """A limit on a figure of the whole design, in SI.

    `poses` are the joint coordinates (rad, m) at which alone it holds; None is everywhere in the workspace. `assumed`:
    nobody asked for it, so that what it needs may be missing.
    """

    figure: Figure
    relation: Relation
    value: float
    poses: tuple[tuple[float, ...], ...] | None = None
    assumed: bool = False

    @property
    def name(self) -> str:
        """The figure's name."""
        return self.figure.name

    @property
    def text(self) -> str:
        """The limit as people write it."""
        at = "" if self.poses is None else f" at {len(self.poses)} pose{'' if len(self.poses) == 1 else 's'}"
        return f"{self.name} {self.relation} {format_quantity(self.value, self.figure.kind)}{at}"

    def of(self, evaluation: Evaluation) -> float:
        """The figure (SI) that the limit is on, in an evaluation; NaN where it is not known."""
        if self.poses is not None:
            assert self.figure.at_poses is not None
            found = self.figure.at_poses(evaluation, self.poses)
        else:
            found = self.figure.value(evaluation)
        return math.nan if found is None else found
