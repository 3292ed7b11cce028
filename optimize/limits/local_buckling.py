"""How far the walls of links are from buckling at the stress that they bear."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar

import casadi as ca
import numpy as np

from linkwright.core.arm.chain.similar_taper import similar_station
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.limits.local_buckling import (
    LOAD_FIELDS,
    Buckling,
    LoadsCase,
    link_modes,
    loads_at,
    loads_case,
    local_buckling,
    mode_of,
)
from linkwright.core.arm.limits.wall_modes import modes_of
from linkwright.core.sections import SHAPES, is_solid
from linkwright.core.sections.numeric import Array

from .design import DesignExpressions, Designs
from .figure import Asked, Cut, Figure, Held, PoseFamily, ThroughPoses, Worst
from .strength import POSES

if TYPE_CHECKING:
    from linkwright.core.arm.chain.chain import Arm
    from linkwright.core.arm.worst.search import WorstSearch

_ASSUMED = 2.0
"""The least factor where nobody asks for one: linear theory knows nothing of what a wall's edges and flatness lack."""
_ENDS = (0.0, 1.0)
_CLIMBED_FROM = 0.5
"""A use that is nowhere above this share of what is allowed is not climbed on: a scan is not that far off."""


class Walls(PoseFamily):
    """The walls of each link where they are nearest to buckling: a cut holds the place along each link."""

    name: ClassVar[str] = "walls"

    def prepare(self, problem: Asked) -> tuple[LoadsCase, ...]:
        """The loads of each load case."""
        return tuple(loads_case(problem.arm, load) for load in problem.load_cases)

    def more(self, prepared: tuple[LoadsCase, ...]) -> int:
        """A share of each link's length."""
        return len(prepared[0].links)

    def rows(
        self, prepared: tuple[LoadsCase, ...], group: int, pose: tuple[Any, Any], design: DesignExpressions, held: Held
    ) -> Iterator[tuple[int, Any]]:
        """The use of each mode of each link's walls, over what is allowed."""
        case = prepared[group]
        q, shares = pose
        acting = case.function(q, design.beam_column)
        for entry, link in enumerate(case.links):
            section, material, found = design.sections[link], design.materials[link], design.properties[link]
            assert section is not None
            assert material is not None
            assert found is not None
            far = [acting[LOAD_FIELDS * entry + k] for k in range(LOAD_FIELDS)]
            # The far end of a link that tapers is a smaller image of the one at its joint.
            at = similar_station(shares[entry], design.beams[link].log_taper)
            loads = loads_at(far, shares[entry], at.weight_beyond, at.moment_beyond)
            size = 1.0 + shares[entry] * (ca.exp(design.beams[link].log_taper) - 1.0)
            for _, mode in modes_of(section, found, material) or ():
                for number, value, slack in held.on(LOCAL_BUCKLING.name):
                    yield number, mode.use(loads.over(size)) * value - ca.exp(slack)

    def worst(
        self, prepared: tuple[LoadsCase, ...], problem: Asked, search: WorstSearch, arm: Arm, p: Array
    ) -> list[Worst]:
        """The wall of each link that is nearest to buckling."""
        beams, poses = beams_of(arm, problem.load_cases), search.poses(p, POSES)
        limits = [limit.value for limit in problem.limits if limit.name == LOCAL_BUCKLING.name]
        least = _CLIMBED_FROM / max(limits, default=_ASSUMED)
        found = local_buckling(arm, prepared, beams, poses, p, search, least=least)
        modes = Buckling(prepared, tuple(link_modes(arm, number, beams[number]) for number in prepared[0].links))
        return [
            Worst(
                LOCAL_BUCKLING.name,
                each.factor,
                Cut(each.q, each.load_case, modes.shares(each.load_case, np.array(each.q), p)),
            )
            for each in found.links
            if each.factor is not None and each.q
        ]

    def at_pose(self, prepared: tuple[LoadsCase, ...], group: int, q: Array, designs: Designs) -> Mapping[str, Array]:
        """The least factor over the links, at either of their ends."""
        case = prepared[group]
        acting = np.reshape(case.vectorised(q, designs.p)[0], (len(q), len(case.links), LOAD_FIELDS))
        worst = np.zeros(len(q))
        for entry, link in enumerate(case.links):
            modes = mode_of(designs.walls(link))
            far = [acting[:, entry, k, None] for k in range(LOAD_FIELDS)]
            for share in _ENDS:
                loads = loads_at(far, share, 1.0 - share, 0.5 * (1.0 - share) ** 2)
                worst = np.maximum(worst, modes.use(loads).max(axis=1, initial=0.0))
        with np.errstate(divide="ignore"):
            return {LOCAL_BUCKLING.name: 1.0 / worst}


def _assumed(problem: Asked) -> float | None:
    """A design whose walls buckle under its load is none, whether or not anybody asks for it."""
    own = [link.section.shape for link in problem.arm.links if link.section is not None]
    walled = any(not is_solid(SHAPES[shape]) for shape in problem.shapes or own)
    return _ASSUMED if walled else None


LOCAL_BUCKLING = Figure(
    name="local_buckling",
    title="local buckling",
    senses=(">=",),
    key="local_buckling",
    follows=ThroughPoses(Walls()),
    of=lambda evaluation: evaluation.local_buckling.least,
    more_is_better=True,
    note="least, critical over true stress of any wall",
    # Where nothing presses it is infinite, which no axis can show.
    traded=False,
    assumed=_assumed,
)
