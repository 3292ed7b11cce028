"""A figure of a design: one object evaluates it, limits it, and holds all that other rooms must know of it.

A figure follows from a design in one of five ways: it is the worst error itself (`WorstError`); it follows from the
sums over the links (`OfDesign`); it follows from each link's section and material (`OfLinks`); it counts of how many
kinds they are (`OfKinds`); or it has a value at every pose, the worst of which counts (`ThroughPoses`). One function
serves symbols, floats and arrays, so that the optimiser, the evaluation and the rounding cannot disagree.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, ClassVar, Generic, Protocol, TypeAlias, TypeVar

from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError, Relation

from .design import DesignExpressions, Designs, DesignValues, Totals

if TYPE_CHECKING:
    from linkwright.core.arm.actuators import Actuator
    from linkwright.core.arm.avoid.obstacle import Obstacle
    from linkwright.core.arm.chain.chain import Arm, LoadCase
    from linkwright.core.arm.evaluation import Evaluation
    from linkwright.core.arm.worst.workspace import Workspace
    from linkwright.core.materials.material import Material, MaterialValues
    from linkwright.core.sections import Section

    from .limit import Limit


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
    def workspace(self) -> Workspace:
        """Where the arm works."""
        ...

    @property
    def limits(self) -> tuple[Limit, ...]:
        """The limits in the problem's order, by which they are numbered."""
        ...

    @property
    def avoid(self) -> tuple[Obstacle, ...]:
        """What it says is to be avoided; the arm has that as well."""
        ...

    @property
    def shapes(self) -> tuple[str, ...] | None:
        """The shapes that links may have; None keeps the arm's own."""
        ...

    @property
    def actuators(self) -> tuple[tuple[Actuator, ...], ...] | None:
        """What each joint's drive may be; None keeps all."""
        ...


FigureResult = TypeVar("FigureResult")
"""What a family tells of a design: its figures, where they are, and whatever else comes with them."""


class PoseFamily(ABC, Generic[FigureResult]):
    """Figures that have a value at every pose and share the work that finds it."""

    name: str
    needs: frozenset[str] = frozenset()
    """What it cannot do without of `masses` and `compliances`, where those of an arm are not known."""
    called: str = ""
    """What an evaluation calls it where it says why it is not known; nothing is said of one without."""
    bounds_many: ClassVar[bool] = True
    """Whether `at_pose` bounds many designs at once; otherwise designs are looked at one by one."""
    is_error: ClassVar[bool] = False
    """Whether it is an error of the tip, which smaller sections make greater."""
    stiffer_is_better: ClassVar[bool] = False
    """Whether no arm does better than a stiffer and lighter one, so that its figure with the stiffest and lightest
    links that may be chosen bounds every design; the quick refusals (`optimize.infeasible.quick`) then hold it too."""
    thinner_is_better: ClassVar[bool] = False
    """Whether no arm does better than one whose links have no thickness; the quick refusals then hold it too."""
    slope: ClassVar[float] = 1.0
    """By how many per cent a row gives way for one per cent of its limit."""

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and vars(self) == vars(other)

    def __hash__(self) -> int:
        return hash((type(self), self.name))

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
    def evaluate(self, design: DesignValues) -> FigureResult | None:
        """The worst of its figures over the workspace for a design; None where nothing has them. Raises
        `MissingProperty` for what they need of a material that alone needs it."""

    @abstractmethod
    def values(self, result: FigureResult) -> Mapping[str, float | None]:
        """Its figures (SI), by name; None where one is not known or nothing has it."""

    def of_links(self, result: FigureResult, name: str) -> Mapping[int, float | None]:
        """A figure of each link that has it (from 0), where a limit may ask different things of them."""
        del result, name
        return {}

    @abstractmethod
    def worst(self, prepared: Any, problem: Asked, design: DesignValues) -> list[Worst]:
        """The worst of each figure over the workspace for a design, with the poses that show it."""

    def unknown(self, result: FigureResult | None) -> Mapping[str, str]:
        """Why figures are not known, by what an evaluation calls them."""
        del result
        return {}

    def warnings(self, arm: Arm, result: FigureResult) -> Sequence[str]:
        """A line for each thing that fails as the arm is."""
        del arm, result
        return ()

    def load_case(self, cut: Cut) -> int:
        """The load case of a cut: its group, unless a family says otherwise."""
        return cut.group

    def first(self, result: Sequence[Worst]) -> list[Cut]:
        """The poses to begin an exchange with, of those that a first design shows."""
        return [item.cut for item in result]

    def at_pose(self, prepared: Any, group: int, q: Array, designs: Designs) -> Mapping[str, Array]:
        """The figures (N) of many designs, each at a pose of its q (N, n) under a load case."""
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
    have to keep a limit; empty where a link has nothing to limit, None where it is not known. `unknown` then says why
    ("the material of link {link} has no yield strength").

    >>> import linkwright as lw
    >>> aspect = lw.OfLinks(lambda section, material: (section.height / section.width,))
    >>> aspect.values(lw.shapes.Rectangle(width="40 mm", height="60 mm"), None)
    (1.5,)
    """

    values: Callable[[Section, MaterialValues], Sequence[Any] | None]
    unknown: Callable[[Section, MaterialValues], str] | None = None

    def why_unknown(self, arm: Arm) -> str | None:
        """Why the figure of an arm is not known; None where it is, or nobody says."""
        if self.unknown is None:
            return None
        why = {
            self.unknown(section, material).format(link=number): None
            for number, section, material in _ends(arm)
            if self.values(section, material) is None
        }
        return "; ".join(why) or None


def _ends(arm: Arm) -> Iterator[tuple[int, Section, MaterialValues]]:
    """The number, section and material of each elastic link, at both its ends where it tapers: there figures of a
    section are at their worst."""
    for number, link in enumerate(arm.links, start=1):
        if link.section is not None and link.material is not None:
            material = link.material.at(arm.temperature)
            yield from ((number, section, material) for section in link.section.ends)


@dataclass(frozen=True)
class OfKinds:
    """The number of different kinds among the links that have a section: `kind` says what a link of a shape (by name)
    and a material is. With `sized` kinds differ by the sections' dimensions as well.

    >>> import linkwright as lw
    >>> families = lw.OfKinds(lambda shape, material: material.family)
    >>> lw.Figure("families", "different families of materials", ("<=",), "families", families).unit
    ''
    """

    kind: Callable[[str, Material], Hashable]
    sized: bool = False

    def count(self, arm: Arm) -> int:
        """How many kinds an arm's links are of; 0 where none has a section."""
        kinds = {
            (self.kind(link.section.shape, link.material), link.section if self.sized else None)
            for link in arm.links
            if link.section is not None and link.material is not None
        }
        return len(kinds)


@dataclass(frozen=True)
class ThroughPoses:
    """A figure that has a value at every pose."""

    family: PoseFamily[Any]


Follows: TypeAlias = WorstError | OfDesign | OfLinks | OfKinds | ThroughPoses


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
        more_is_better: which way a trade-off pushes it.
        note: a few words for tables, beside the value.
        where: the pose at which its family found it, if that is worth telling.
        needs: the material properties without which a limit on it cannot be judged.
        titled, noted: the title and the note for a certain arm, where those differ.
        traded: whether a problem can minimise or maximise it, and a trade-off have it as an axis.
        at_poses: whether a limit may name the poses at which it holds, and its value (SI) there.
        assumed: the limit (SI) that a problem has on it without asking, if any.
        everywhere: whether any arm has it; where one that need not has none, nothing is told of it.
        by: how a limit on it can ask different things of links: by `link`, by `material`.
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
    more_is_better: bool = False
    note: str = ""
    where: Callable[[Any], tuple[float, ...]] | None = None
    needs: tuple[str, ...] = ()
    titled: Callable[[Arm], str] | None = None
    noted: Callable[[Arm], str] | None = None
    traded: bool = True
    at_poses: Callable[[Evaluation, Sequence[tuple[float, ...]]], float | None] | None = None
    assumed: Callable[[Asked], float | None] | None = None
    everywhere: bool = True
    by: tuple[str, ...] = ()
    digits: int = 4
    synonyms: tuple[str, ...] = ()

    def __reduce__(self) -> tuple[object, ...]:
        """To another process a figure that is shipped or registered goes by its name."""
        from linkwright.core.arm.figures import FIGURES

        if FIGURES.get(self.name) is self:
            return _by_name, (self.name,)
        return type(self), tuple(getattr(self, field.name) for field in fields(self))

    def value(self, evaluation: Evaluation) -> float | None:
        """The figure (SI) of an evaluated design; None where it is not known or nothing has it."""
        match self.follows:
            case OfDesign(value):
                result = float(value(evaluation.totals))
                return None if math.isnan(result) else result
            case OfKinds():
                return float(self.follows.count(evaluation.arm)) or None
            case OfLinks():
                result = self.of_links(evaluation.arm)
                return result if result or self.everywhere else None
            case ThroughPoses(family):
                posed = evaluation.of(family)
                return None if posed is None else family.values(posed)[self.name]
            case WorstError():
                return evaluation.max_error

    def pose(self, evaluation: Evaluation) -> tuple[float, ...] | None:
        """The pose at which an evaluation has it; None where it has none worth telling."""
        assert isinstance(self.follows, ThroughPoses)
        assert self.where is not None
        result = evaluation.by_family.get(self.follows.family.name)
        return None if result is None else self.where(result)

    def of_links(self, arm: Arm, limit: Limit | None = None) -> float | None:
        """The worst over an arm's links, with a limit relative to what that asks of each; 0 where no link has anything
        to limit, None where one is not known."""
        assert isinstance(self.follows, OfLinks)
        values: list[float] = []
        for number, section, material in _ends(arm):
            link_values = self.follows.values(section, material)
            if link_values is None:
                return None
            share = 1.0 if limit is None else limit.share_of(arm, number - 1)
            values += [float(value) / share for value in link_values]
        return self.worst(values) if values else 0.0

    def worst(self, values: Sequence[float]) -> float:
        """The worst of some values: the least where more is better."""
        return min(values) if self.more_is_better else max(values)

    def badness(self, value: float) -> float:
        """The value where less is better, its reciprocal where more is; its inverse."""
        return 1.0 / value if self.more_is_better else value

    @property
    def summed(self) -> bool:
        """Whether it is an objective by itself: the error, or a sum over the links of which less is better. Any other
        is an objective through the limit on it, made as tight as it can be."""
        return isinstance(self.follows, WorstError | OfDesign) and not self.more_is_better

    @property
    def is_error(self) -> bool:
        """Whether it is an error of the tip, which smaller sections make greater."""
        follows = self.follows
        return isinstance(follows, WorstError) or (isinstance(follows, ThroughPoses) and follows.family.is_error)

    def is_reported(self, evaluation: Evaluation) -> bool:
        """Whether there is anything to tell of it: a value, or a reason why none is known. A number of kinds is
        reported where a limit is on it, with that."""
        if isinstance(self.follows, OfKinds):
            return False
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
    from linkwright.core.arm.figures import FIGURES

    if name not in FIGURES:
        would_do = "install it on every worker, as a package with an entry point"
        raise InputError("", name, f"is a limit of one's own that a worker does not know; {would_do}")
    return FIGURES[name]
