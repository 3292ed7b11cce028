"""A limit on a figure, how far a value is beyond it, and the figures of an evaluated design."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from linkwright.core.units.quantities import Relation, format_quantity

from .figure import Figure, OfLinks, ThroughPoses

if TYPE_CHECKING:
    from linkwright.core.arm.chain.chain import Arm
    from linkwright.core.arm.evaluation import Evaluation

KEPT_WITHIN = 1e-9
"""A limit counts as kept within this, relative."""
_LOOSE = 1e9
"""A limit that is looser by this factor holds nothing back."""


@dataclass(frozen=True)
class Demands:
    """The values (SI) of a limit that asks different things of links: of each link from the base, or of those of some
    materials (by name)."""

    links: tuple[float, ...] = ()
    materials: tuple[tuple[str, float], ...] = ()

    def of(self, link: int, material: str) -> float | None:
        """What is asked of a link (from 0) of a material; None where nothing is said of it."""
        return self.links[link] if self.links else dict(self.materials).get(material)


@dataclass(frozen=True)
class Limit:
    """A limit on a figure of the whole design, in SI.

    With `demands` the limit asks other things of some links; `value` is then that of the others, and the figure is that
    of the link which is worst relative to what is asked of it, as if `value` were. `poses` are the joint coordinates
    (rad, m) at which alone it holds; None is everywhere in the workspace. `assumed`: nobody asked for it, so that what
    it needs may be missing. `aim`: it is what is minimised or maximised, and holds nothing back.
    """

    figure: Figure
    relation: Relation
    value: float
    poses: tuple[tuple[float, ...], ...] | None = None
    assumed: bool = False
    aim: bool = False
    demands: Demands | None = None

    def share(self, link: int, material: str = "") -> float:
        """What is asked of a link (from 0) of a material, over `value`."""
        demand = None if self.demands is None else self.demands.of(link, material)
        return 1.0 if demand is None else demand / self.value

    def share_of(self, arm: Arm, link: int) -> float:
        """The same of a link of an arm."""
        made_of = arm.links[link].material
        return self.share(link, "" if made_of is None else made_of.name)

    def on_link(self, link: int) -> Limit:
        """The limit as it stands for one link (from 0), said by link."""
        return self if self.demands is None else replace(self, value=self.value * self.share(link), demands=None)

    @property
    def loosened(self) -> Limit:
        """The limit so loose that it holds nothing back, where it is the aim."""
        if not self.aim:
            return self
        return replace(self, value=self.figure.badness(_LOOSE * self.figure.badness(self.value)))

    @property
    def name(self) -> str:
        """The figure's name."""
        return self.figure.name

    @property
    def text(self) -> str:
        """The limit as people write it."""
        at = "" if self.poses is None else f" at {len(self.poses)} pose{'' if len(self.poses) == 1 else 's'}"
        return f"{self.name} {self.relation} {format_quantity(self.value, self.figure.kind)}{at}{self._others}"

    @property
    def _others(self) -> str:
        if self.demands is None:
            return ""
        named = [(f"link {number}", value) for number, value in enumerate(self.demands.links, start=1)]
        named += self.demands.materials
        texts = [f"{name}: {format_quantity(value, self.figure.kind)}" for name, value in named if value != self.value]
        return f" ({', '.join(texts)})" if texts else ""

    def of(self, evaluation: Evaluation) -> float:
        """The figure (SI) that the limit is on, in an evaluation; NaN where it is not known."""
        if self.poses is not None:
            assert self.figure.at_poses is not None
            value = self.figure.at_poses(evaluation, self.poses)
        elif self.demands is not None or isinstance(self.figure.follows, OfLinks):
            value = self._of_links(evaluation)
        else:
            value = self.figure.value(evaluation)
        return math.nan if value is None else value

    def _of_links(self, evaluation: Evaluation) -> float | None:
        """The figure of the link that is worst relative to what is asked of it."""
        follows = self.figure.follows
        if not isinstance(follows, ThroughPoses):
            return self.figure.of_links(evaluation.arm, self)
        posed = evaluation.by_family.get(follows.family.name)
        by_link = {} if posed is None else follows.family.of_links(posed, self.name)
        values = [
            None if item is None else item / self.share_of(evaluation.arm, link) for link, item in by_link.items()
        ]
        known = [value for value in values if value is not None]
        return self.figure.worst(known) if known and len(known) == len(values) else None


def figures_of(evaluation: Evaluation, figures: Mapping[str, Figure]) -> dict[str, float]:
    """Every figure that a problem can limit, by its name (SI); NaN where it cannot be known or nothing has it."""
    values = {name: figure.value(evaluation) for name, figure in figures.items()}
    return {name: math.nan if value is None else value for name, value in values.items()}


def excess(limit: Limit, value: float) -> float:
    """How far a value (SI) is beyond a limit, relative to it; not above zero where it keeps the limit, as an aim is
    kept by anything; NaN for NaN."""
    if limit.aim:
        return -math.inf
    ratio = value / limit.value - 1.0
    return abs(ratio) if limit.relation == "==" else -ratio if limit.relation == ">=" else ratio


def shortfall(limit: Limit, value: float) -> float:
    """By how much a value (SI) would have to improve to keep a limit, relative to the value itself or the limit."""
    return limit.value / value - 1.0 if limit.relation == ">=" else value / limit.value - 1.0


def broken(limits: Sequence[Limit], evaluation: Evaluation) -> tuple[Limit, ...]:
    """The limits that an evaluated design breaks; one on a figure that is not known is not judged."""
    return tuple(limit for limit in limits if excess(limit, limit.of(evaluation)) > KEPT_WITHIN)
