"""What a trade-off asks: two figures of a design, which way each is better, and the problem with a limit on both."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

from linkwright.core.arm.figures import Figure, Limit
from linkwright.core.optimize.problem import Problem
from linkwright.core.units.names import meant, nearest
from linkwright.core.units.quantities import InputError, format_quantity

By = Literal["material", "shape"]
Reach = Literal["long", "short"]

_LOOSE = 1e9
"""A limit at this value (or its reciprocal, where more is better) holds nothing back."""


@dataclass(frozen=True)
class Axis:
    """A figure of a design, and whether more of it is better.

    A figure's *badness* is the figure itself where less is better and its reciprocal where more is: less badness is
    always better, and relative changes keep their size.
    """

    figure: Figure
    more_is_better: bool

    @property
    def name(self) -> str:
        """The figure's name."""
        return self.figure.name

    @property
    def title(self) -> str:
        """Words for the figure."""
        return self.figure.title

    @property
    def unit(self) -> str:
        """The unit that people read; empty for a pure number."""
        return self.figure.unit

    @property
    def factor(self) -> float:
        """What one SI unit is in the unit that people read."""
        return self.figure.factor

    @property
    def heading(self) -> str:
        """Words with the unit."""
        return f"{self.title} in {self.unit}" if self.unit else self.title

    def badness(self, value: float) -> float:
        """The badness of a value (SI); its inverse."""
        return 1.0 / value if self.more_is_better else value

    def limit(self, badness: float = _LOOSE) -> Limit:
        """The limit that allows no more badness than that; without one, it holds nothing back."""
        return Limit(self.figure, ">=" if self.more_is_better else "<=", self.badness(badness))

    def written(self, value: float, digits: int = 4) -> str:
        """A value (SI) with its unit."""
        return format_quantity(value, self.figure.kind, self.unit or None, digits)


def axes_of(figures: Mapping[str, Figure]) -> dict[str, Axis]:
    """The figures between which a trade-off can be asked for, by name."""
    return {name: Axis(figure, figure.more_is_better) for name, figure in figures.items() if figure.traded}


@dataclass(frozen=True)
class Question:
    """A trade-off: `problem` carries the limits on both figures as its last two, x then y.

    `x_cap` and `y_cap` are the badness that the problem itself allows (None: any). `given` is the problem as written.
    """

    given: Problem
    problem: Problem
    x: Axis
    y: Axis
    x_cap: float | None
    y_cap: float | None
    by: By | None

    @property
    def x_limit(self) -> int:
        """Where the limit on x stands among the problem's."""
        return len(self.problem.limits) - 2

    @property
    def y_limit(self) -> int:
        """Where the limit on y stands among the problem's."""
        return len(self.problem.limits) - 1

    def limits(self, push: int, held: float) -> tuple[Limit, ...]:
        """The problem's limits where one figure (the number of its limit) is pushed, from a badness of one on, and the
        other has at most the badness `held`."""
        held = min(held, _LOOSE)
        on_x = self.x.limit(1.0 if push == self.x_limit else held)
        on_y = self.y.limit(1.0 if push == self.y_limit else held)
        return (*self.problem.limits[:-2], on_x, on_y)

    def cap(self, number: int) -> float:
        """The badness of a figure (the number of its limit) that the problem itself allows."""
        cap = self.x_cap if number == self.x_limit else self.y_cap
        return math.inf if cap is None else cap

    def groups(self) -> list[tuple[str, Problem]]:
        """The problems whose fronts are asked for, by name: one for each material or shape, or one for all."""
        if self.by == "material" and self.given.materials is not None:
            return [(m.name, replace(self.problem, materials=(m,))) for m in self.given.materials]
        if self.by == "shape" and self.given.shapes is not None:
            return [(shape, self._of_shape(shape)) for shape in self.given.shapes]
        return [("all", self.problem)]

    def _of_shape(self, shape: str) -> Problem:
        """The problem whose links are all of a shape, sections from lists among them."""
        sizes = self.problem.sizes
        if sizes is not None:
            sizes = tuple(tuple(item for item in link_sizes if item.section.shape == shape) for link_sizes in sizes)
        return replace(self.problem, shapes=(shape,), sizes=sizes)

    def unlimited(self, group: Problem) -> Problem:
        """A group's problem with the limits that were given, for saying why it has no answer."""
        return replace(group, limits=self.given.limits)


def question(problem: Problem, x: str, y: str, *, by: By | None = None, reach: Reach = "long") -> Question:
    """The trade-off between two figures of a problem's designs (names of `axes_of`).

    The problem's limits on them bound the front; what it minimises plays no part. Raises `InputError` where there
    is nothing to trade.
    """
    known = axes_of(problem.figures)
    x, y = (_along(known, name) for name in (x, y))
    _check(problem, x, y, known, by)
    axes = [replace(known[n], more_is_better=reach == "long") if n == "reach" else known[n] for n in (x, y)]
    caps: list[float | None] = []
    rest = problem.limits
    for axis in axes:
        if axis.name == "reach" and not problem.free_lengths:
            raise InputError(problem.file, "subject_to", "gives no link_length, so that the reach cannot change")
        same = [
            limit
            for limit in problem.limit(axis.name)
            if limit.relation == axis.limit().relation and limit.poses is None
        ]
        if any(limit.relation == "==" for limit in problem.limit(axis.name)):
            would_do = "a trade-off needs it free, or limited by <= or >="
            raise InputError(problem.file, axis.name, f"is fixed by ==; {would_do}")
        caps.append(min((axis.badness(limit.value) for limit in same), default=None))
        rest = tuple(limit for limit in rest if limit not in same)
    limits = (*rest, axes[0].limit(), axes[1].limit())
    return Question(
        given=problem,
        # The two limits carry the question: what the file minimises must not ask for figures of its own.
        problem=replace(problem, minimize="mass", limits=limits),
        x=axes[0],
        y=axes[1],
        x_cap=caps[0],
        y_cap=caps[1],
        by=by,
    )


def _along(known: Mapping[str, Axis], name: str) -> str:
    """The name of a figure along a direction, where a problem has one only."""
    along = [key for key in known if key.startswith(f"{name} (")]
    return along[0] if name not in known and len(along) == 1 else name


def _check(problem: Problem, x: str, y: str, known: Mapping[str, Axis], by: By | None) -> None:
    """What a trade-off does not go with."""
    if problem.uncertain is not None:
        message = "goes with `optimize` and `evaluate`; leave it and robust out for a trade-off"
        raise InputError(problem.file, "uncertain", message)
    if problem.stepped:
        raise InputError(problem.file, "subject_to.thickness", "takes a range for a trade-off, no steps")
    if problem.balances:
        message = "is settled by `optimize` alone: balance can bring the error to nothing, where a front has no end"
        raise InputError(problem.file, "choose", f"balancer or counterweight {message}; write it into the arm file")
    if problem.sizes is not None:
        _check_listed(problem, (x, y))
    _check_names(problem, x, y, known)
    if by is not None and problem.lists is not None:
        raise InputError(problem.file, "choose", f"says what each link may be; --by {by} needs one list for all links")
    if by == "material" and problem.materials is None:
        raise InputError(problem.file, "choose", "names no materials for --by material, e.g. {material: [...]}")
    if by == "shape" and problem.shapes is None:
        raise InputError(problem.file, "choose", "names no shapes for --by shape, e.g. {section: [circle, tube]}")


def _check_names(problem: Problem, x: str, y: str, known: Mapping[str, Axis]) -> None:
    """Names of figures that are none, and pairs between which nothing is to be traded."""
    for option, name in (("--x", x), ("--y", y)):
        if name not in known:
            figures = {key: axis.figure for key, axis in known.items()}
            hint = nearest(name, figures) if meant(name, figures) else f"; take one of {', '.join(known)}"
            raise InputError("", option, f"there is no figure '{name}'{hint}")
    shared = next((limit for name in (x, y) for limit in problem.limit(name) if limit.demands is not None), None)
    if shared is not None:
        would_do = "give it one value in subject_to"
        raise InputError(problem.file, f"subject_to.{shared.name}", f"asks different things of links; {would_do}")
    if x == y:
        raise InputError("", "--y", f"is the same as --x ({x}); name two figures")
    if {x, y} == {"mass", "total_mass"}:
        raise InputError("", "--y", "total_mass is mass and a constant, so there is nothing to trade between them")


def _check_listed(problem: Problem, names: tuple[str, str]) -> None:
    """What does not go with sections from a list."""
    if problem.free_lengths:
        message = "goes with a trade-off where lengths stay; leave link_length out, or sizes"
        raise InputError(problem.file, "choose.sizes", message)
    summed = [name for name, figure in problem.figures.items() if figure.summed]
    other = next((name for name in names if name in problem.figures and name not in summed), None)
    if other is not None:
        message = f"goes with trade-offs between {', '.join(summed)}, not with {other}"
        raise InputError(problem.file, "choose.sizes", message)
