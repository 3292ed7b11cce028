"""Figures of many designs of one structure: expressions built once, poses scanned and climbed for all designs together.

The designs differ in their links' lengths, sections and materials. A figure that follows from the links is summed; one
that has a value at every pose is scanned over poses spread over the joint ranges, and Newton climbs go from the worst
of them for all designs at once. It certifies nothing: `arm.evaluation` does, for one design.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.avoid.obstacle import Obstacle
from linkwright.core.arm.chain.chain import Arm, Link, LoadCase
from linkwright.core.arm.errors.lost_motion import played
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.arm.evaluation import heaviest_carried, link_masses, material_cost
from linkwright.core.arm.figures import (
    Designs,
    DesignValues,
    Figure,
    Limit,
    OfDesign,
    OfLinks,
    PoseFamily,
    ThroughPoses,
    Totals,
)
from linkwright.core.arm.figures.local_buckling import values_of
from linkwright.core.arm.figures.strength import strength_values
from linkwright.core.arm.limits.wall_modes import Mode, modes_of
from linkwright.core.arm.worst.refine import uphill_each
from linkwright.core.arm.worst.search import WorstSearch
from linkwright.core.arm.worst.workspace import Workspace, climbing_bounds
from linkwright.core.sections.numeric import Array

Integers = NDArray[np.intp]
Badness = Callable[[int, Array, Integers], Array]
"""Of some designs, each at a separate pose, in a group of poses (a load case)."""
Report = Callable[[float], None]
"""Hears what share of the work is behind (0 to 1)."""
_POSES, _STARTS = 512, 3
"""Poses scanned for each design, and how many of the worst are climbed from."""
_AT_ONCE = 256
"""Designs whose climbs go together; between such groups work can be stopped."""


@dataclass(frozen=True)
class _Question:
    """What the families of figures see of a problem: all of the figures, limited by nothing."""

    arm: Arm
    load_cases: tuple[LoadCase, ...]
    limits: tuple[Limit, ...]
    avoid: tuple[Obstacle, ...] = ()
    shapes: None = None
    actuators: None = None
    workspace: Workspace = field(default_factory=Workspace)


class Sweep:
    """Designs that have the links in `rows` (N, one index for each link) of `options`, link by link; all else as `arm`,
    whose structure they share."""

    def __init__(self, arm: Arm, options: Sequence[Sequence[Link]], rows: Integers) -> None:
        self.arm, self.options, self.rows = arm, options, rows
        self.cases = arm.cases
        self.search = WorstSearch(error_model(arm, self.cases), Workspace())

    def design(self, number: int) -> Arm:
        """One of the designs."""
        return self.arm.with_links(
            tuple(item[option] for item, option in zip(self.options, self.rows[number].tolist(), strict=True))
        )

    def _by_link(self, of: Callable[[int, Link], object]) -> list[Array]:
        """A value of each option, link by link, as arrays of one row for each design."""
        columns: list[Array] = []
        for index, link_options in enumerate(self.options):
            used = np.unique(self.rows[:, index])
            values = {int(option): of(index, link_options[int(option)]) for option in used}
            columns.append(
                np.array([values[int(option)] for option in used])[np.searchsorted(used, self.rows[:, index])]
            )
        return columns

    def _alone(self, index: int, link: Link) -> Arm:
        """The arm with one link in its place, the others as they are."""
        links = list(self.arm.links)
        links[index] = link
        return self.arm.with_links(tuple(links))

    @cached_property
    def p(self) -> Array:
        """The beam values (N, ...) of all designs."""

        def values(index: int, link: Link) -> Array:
            return beam_values([beams_of(self._alone(index, link), self.cases)[index]])

        return np.hstack(self._by_link(values))

    @cached_property
    def _designs(self) -> Designs:
        def strong(_: int, link: Link) -> Array:
            # The moduli that count for strength are those of `evaluate`.
            return strength_values([None if link.section is None else link.section.properties(0.3)])

        def yields(_: int, link: Link) -> float:
            if link.section is None or link.material is None:
                return np.inf
            return link.material.at(self.arm.temperature).yield_strength or np.nan

        sections, strengths = np.hstack(self._by_link(strong)), np.stack(self._by_link(yields), axis=1)
        return Designs(self.p, sections, strengths, lambda link: self._modes[link])

    @cached_property
    def _modes(self) -> list[Array]:
        """How the walls of each link buckle: (N, K, F), zeros where a design has fewer modes."""
        width = len(fields(Mode))

        def link_modes(link: Link) -> Array:
            if link.section is None or link.material is None:
                return np.zeros((0, width))
            material = link.material.at(self.arm.temperature)
            ratio = 0.3 if material.poisson_ratio is None else material.poisson_ratio
            modes = modes_of(link.section, link.section.properties(ratio), material) or ()
            return np.array([values_of(mode) for _, mode in modes]).reshape(-1, width)

        most = [max(len(link_modes(link)) for link in links) for links in self.options]

        def padded(index: int, link: Link) -> Array:
            modes = link_modes(link)
            return np.vstack([modes, np.zeros((most[index] - len(modes), width))])

        return self._by_link(padded)

    def figure(self, figure: Figure, report: Report) -> Array:
        """A figure (N,) of all designs, SI; NaN where it is not known."""
        match figure.follows:
            case OfDesign(value):
                return np.broadcast_to(np.asarray(value(self._totals), dtype=float), len(self.rows))
            case OfLinks():
                return self._of_links(figure)
            case ThroughPoses(family):
                return self._through_poses(figure, family, report)
            case _:
                return self._worst(self._error, 1, report)

    @cached_property
    def _totals(self) -> Totals:
        masses, costs, reaches = (np.empty(len(self.rows)) for _ in range(3))
        of_links = np.stack(self._by_link(self._mass), axis=1)
        for number, item in enumerate(of_links.tolist()):
            design = self.design(number)
            cost = material_cost(design, item)
            masses[number], costs[number] = sum(item), np.nan if cost is None else cost
            reaches[number] = max(sum(design.lengths[k] for k in design.on(case.tip).to_tip) for case in self.cases)
        return Totals(masses, costs, reaches, heaviest_carried(self.arm, self.cases))

    def _mass(self, index: int, link: Link) -> float:
        return link_masses(beams_of(self._alone(index, link), self.cases))[index]

    def _of_links(self, figure: Figure) -> Array:
        empty = np.inf if figure.more_is_better else -np.inf

        def value(_: int, link: Link) -> float:
            alone = self.arm.with_links((link,) * self.arm.size)
            if link.section is None or link.material is None:
                return empty
            values = figure.of_links(alone)
            return np.nan if values is None else values

        columns = np.stack(self._by_link(value), axis=1)
        worst = columns.min(axis=1) if figure.more_is_better else columns.max(axis=1)
        return np.where(np.isinf(worst), 0.0, worst)

    def _through_poses(self, figure: Figure, family: PoseFamily[Any], report: Report) -> Array:
        limit = Limit(figure, figure.senses[0], 1.0)
        question = _Question(self.arm, self.cases, (limit,))
        prepared = family.prepare(question)
        if not family.bounds_many:
            return self._one_by_one(figure, family, report)
        less = figure.more_is_better

        def badness(group: int, q: Array, designs: Integers) -> Array:
            every = self._designs
            some = Designs(
                every.p[designs],
                every.sections[designs],
                every.allowed_stresses[designs],
                lambda link: every.walls(link)[designs],
            )
            value = family.at_pose(prepared, group, q, some)[figure.name]
            with np.errstate(divide="ignore"):
                return 1.0 / value if less else value

        worst = self._worst(badness, family.groups(question), report)
        return np.where(worst > 0.0, 1.0 / np.where(worst > 0.0, worst, 1.0), np.nan) if less else worst

    def _one_by_one(self, figure: Figure, family: PoseFamily[Any], report: Report) -> Array:
        result = np.full(len(self.rows), np.nan)
        for number in range(len(self.rows)):
            arm = self.design(number)
            design = DesignValues(arm, self.cases, self.search, self.p[number])
            question = _Question(arm, self.cases, (Limit(figure, figure.senses[0], 1.0),))
            worst = family.worst(family.prepare(question), question, design)
            values = [item.value for item in worst if item.name == figure.name]
            result[number] = figure.worst(values) if values else np.nan
            report((number + 1) / len(self.rows))
        return result

    def _error(self, group: int, q: Array, designs: Integers) -> Array:
        """The error (m) of some designs, each at a separate pose, in a load case."""
        case, model = self.search.model.cases[group], self.search.model
        same = np.ptp(designs) == 0 if len(designs) else False
        arrays = case.arrays(q, self.p[designs[0]] if same else self.p[designs])
        return played(arrays, case.radii, self.arm.play, planar=model.planar, statistics=self.arm.statistics).error

    def _worst(self, badness: Badness, groups: int, report: Report) -> Array:
        """The greatest badness (N,) of each design over the joint ranges and all groups of poses."""
        poses = self.search.poses(self.p[0], _POSES)
        bounds = climbing_bounds(self.arm, self.search.lower, self.search.upper)
        worst, count = np.full(len(self.rows), -np.inf), len(self.rows)
        for start in range(0, count, _AT_ONCE):
            rows = np.arange(start, min(start + _AT_ONCE, count))
            for group in range(groups):
                scanned = np.stack([badness(group, poses, np.full(len(poses), row)) for row in rows])
                first = np.argsort(-scanned, axis=1)[:, :_STARTS]
                designs = np.repeat(rows, first.shape[1])
                reached = uphill_each(partial(_of_starts, badness, group, designs), poses[first.ravel()], bounds)
                top = badness(group, reached, designs).reshape(first.shape)
                worst[rows] = np.maximum.reduce([worst[rows], scanned.max(axis=1), top.max(axis=1)])
            report((rows[-1] + 1) / count)
        return worst


def _of_starts(badness: Badness, group: int, designs: Integers, q: Array, starts: Integers) -> Array:
    return badness(group, q, designs[starts])
