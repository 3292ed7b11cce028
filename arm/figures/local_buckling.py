"""Whether walls buckle at the stress they bear: the least critical over true load of any wall, over poses and loads."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from linkwright.core.arm.chain.beam import STATIONS as TAPERED_STATIONS
from linkwright.core.arm.chain.kinematics import parts
from linkwright.core.arm.chain.similar_taper import similar_station
from linkwright.core.arm.chain.statics import LinkState, solve
from linkwright.core.arm.chain.vectors import dot
from linkwright.core.arm.compiled.vectorise import Expressions
from linkwright.core.arm.errors.model import beam_symbols, symbolic_beams
from linkwright.core.arm.errors.structure import by_structure
from linkwright.core.arm.limits.wall_modes import Mode, WallLoads, modes_of
from linkwright.core.arm.limits.weakest_poses import climbed
from linkwright.core.sections import SHAPES, is_solid
from linkwright.core.sections.numeric import Array
from linkwright.core.sections.taper import Tapered

from .design import DesignExpressions, Designs, DesignValues
from .figure import Asked, Cut, Figure, Held, PoseFamily, ThroughPoses, Worst
from .strength import STATIONS

if TYPE_CHECKING:
    from linkwright.core.arm.chain.beam import Beam
    from linkwright.core.arm.chain.chain import Arm, LoadCase
    from linkwright.core.arm.worst.search import WorstSearch

LOAD_FIELDS = 10
"""Of each link a `LoadsCase` tells force and moment at its far end and its weight, each along the link, its height and
its width (N, N*m), and its length (m)."""
_CLIMBS = 2
_FELT = 1e-9
"""A use below this is none."""
_EVERY = 4
"""Every so many of a tapered link's stations are looked at."""


@dataclass(frozen=True)
class LoadsCase(Expressions):
    """What acts on links under one load case, as functions of poses: (q, p) to `LOAD_FIELDS` for each of `links`."""

    links: tuple[int, ...]


@by_structure
def loads_case(arm: Arm, load: LoadCase) -> LoadsCase:
    """The loads of an arm's elastic links under a load case."""
    q = ca.SX.sym("q", arm.size)  # pyright: ignore[reportCallIssue]
    p = beam_symbols(arm)
    state = solve(arm, parts(q), symbolic_beams(arm, p), load)
    links = tuple(index for index, link in enumerate(arm.links) if link.elastic)
    column = [item for index in links for item in _at_far_end(state.links[index])]
    return LoadsCase((q, p), (ca.vertcat(ca.SX(0, 1), *[ca.SX(item) for item in column]),), links)


def _at_far_end(link: LinkState) -> list[Any]:
    axes = (link.along, link.height, link.width)
    acting = [dot(vector, axis) for vector in (link.force, link.moment, link.weight) for axis in axes]
    return [*acting, link.beam.length]


def loads_at(far: Sequence[Any], share: Any, weight_beyond: Any, moment_beyond: Any) -> WallLoads:
    """The loads at a share of a link's length from its joint, from those at its far end (`LOAD_FIELDS`): the share of
    its weight beyond, and that weight's moment about the cut (per weight and length)."""
    force, moment, weight, length = far[0:3], far[3:6], far[6:9], far[9]
    rest, lever = (1.0 - share) * length, moment_beyond * length
    carried = [item + weight_beyond * entry for item, entry in zip(force, weight, strict=True)]
    return WallLoads(
        pressing=-carried[0],
        in_height=moment[2] + rest * force[1] + lever * weight[1],
        in_width=-moment[1] + rest * force[2] + lever * weight[2],
        along_height=carried[1],
        along_width=carried[2],
        torque=moment[0],
        length=length,
    )


@dataclass(frozen=True)
class LinkModes:
    """How the walls of a link buckle: for each station (share of its length, weight and its moment beyond, (S,)) its
    modes, whose fields are arrays (S, K); `names` are those of the walls. `unknown` says why nothing is known."""

    stations: tuple[Array, Array, Array] = (np.zeros(0), np.zeros(0), np.zeros(0))
    modes: Mode | None = None
    names: tuple[str, ...] = ()
    unknown: str | None = None

    def uses(self, far: Array) -> Array:
        """The uses (N, S, K) for what acts at the far end (N, `LOAD_FIELDS`)."""
        assert self.modes is not None
        share, weight, moment = (station[:, None] for station in self.stations)
        columns = [far[:, k, None, None] for k in range(LOAD_FIELDS)]
        return self.modes.use(loads_at(columns, share, weight, moment))


def link_modes(arm: Arm, number: int, beam: Beam) -> LinkModes:
    """How the walls of an elastic link (from 0) buckle, for the beam that it is."""
    link = arm.links[number]
    assert link.section is not None
    assert link.material is not None
    material = link.material.at(arm.temperature)
    if isinstance(link.section, Tapered):
        stations = [beam.taper.stations[k] for k in range(0, len(TAPERED_STATIONS), _EVERY)]
        cuts = [link.section.cut(at.share) for at in stations]
        along = [[at.share, float(at.weight_beyond), float(at.moment_beyond)] for at in stations]
    else:
        cuts = [link.section]
        along = [[share, 1.0 - share, 0.5 * (1.0 - share) ** 2] for share in STATIONS]
    poisson_ratio = 0.3 if material.poisson_ratio is None else material.poisson_ratio
    every = [modes_of(cut, cut.properties(poisson_ratio), material) for cut in cuts]
    first = every[0]
    if first is None:
        shape = link.section.shape
        known = material.walls is None
        because = f"the stiffness of {link.material.name} across its walls is not known"
        because = because if known else f"the walls of link {number + 1} ({shape}) are not known"
        return LinkModes(unknown=f"link {number + 1}: {because}" if known else because)
    if not first:
        return LinkModes()
    columns = np.array(along).T
    rows = [np.array([values_of(mode) for _, mode in item or ()]) for item in every]
    stacked = np.array(rows if len(rows) > 1 else rows * len(STATIONS))
    return LinkModes((columns[0], columns[1], columns[2]), mode_of(stacked), tuple(name for name, _ in first))


def values_of(mode: Mode) -> list[float]:
    """A mode's fields as numbers."""
    return [float(getattr(mode, field.name)) for field in fields(Mode)]


def mode_of(values: Array) -> Mode:
    """The mode whose fields are along the last axis of an array."""
    return Mode(*np.moveaxis(values, -1, 0))


@dataclass(frozen=True)
class LinkBuckling:
    """The wall of a link (from 0) that is nearest to buckling: the `factor` by which its load could grow (infinite
    where nothing presses it, or the link is solid; None where that is not known, as `unknown` says), which it is (None
    where there is none), and the pose (q), the load case and the share of the link's length at which it is."""

    link: int
    factor: float | None = math.inf
    wall: str | None = None
    q: tuple[float, ...] = ()
    load_case: int = 0
    share: float = 0.0
    unknown: str | None = None


@dataclass(frozen=True)
class LocalBuckling:
    """The least critical over true load of the walls of each link that has a section."""

    links: tuple[LinkBuckling, ...]

    @property
    def least(self) -> float | None:
        """The least factor of any wall; None where no wall is pressed, or one is not known."""
        factors = [link.factor for link in self.links]
        if any(factor is None for factor in factors):
            return None
        pressed = [factor for factor in factors if factor is not None and math.isfinite(factor)]
        return min(pressed) if pressed else None

    @property
    def unknown(self) -> str | None:
        """Why the least is not known; None where it is."""
        return "; ".join(link.unknown for link in self.links if link.unknown is not None) or None


@dataclass(frozen=True)
class Buckling:
    """The walls of an arm under its load cases, for poses."""

    cases: tuple[LoadsCase, ...]
    modes: tuple[LinkModes, ...]

    def far(self, case: int, q: Array, p: Array) -> list[Array]:
        """What acts at each link's far end (N, `LOAD_FIELDS`) at poses q (N, n)."""
        loads = np.reshape(self.cases[case].vectorised(q, p)[0], (len(q), len(self.modes), LOAD_FIELDS))
        return [loads[:, entry] for entry in range(len(self.modes))]

    def greatest(self, case: int, q: Array, p: Array) -> Array:
        """The greatest use (N, links) of any wall of each link; zero where it has none that is known."""
        uses = np.zeros((len(q), len(self.modes)))
        for entry, (modes, far) in enumerate(zip(self.modes, self.far(case, q, p), strict=True)):
            if modes.modes is not None:
                uses[:, entry] = modes.uses(far).max(axis=(1, 2))
        return uses

    def shares(self, case: int, q: Array, p: Array) -> tuple[float, ...]:
        """Where along each link its walls are nearest to buckling at one pose (n,)."""
        shares: list[float] = []
        for modes, far in zip(self.modes, self.far(case, q[None], p), strict=True):
            if modes.modes is None:
                shares.append(0.0)
                continue
            station = np.unravel_index(int(np.argmax(modes.uses(far)[0])), modes.uses(far)[0].shape)[0]
            shares.append(float(modes.stations[0][station]))
        return tuple(shares)


def local_buckling(
    arm: Arm,
    cases: Sequence[LoadsCase],
    beams: Sequence[Beam],
    poses: Array,
    p: Array,
    search: WorstSearch,
    *,
    least: float = 0.0,
) -> LocalBuckling:
    """How near the walls of an arm are to buckling over a workspace, climbed to from poses (N, n); uses that are
    nowhere above `least` are not climbed on. Raises `OutOfRange` beyond a material's data."""
    links = cases[0].links
    buckling = Buckling(tuple(cases), tuple(link_modes(arm, number, beams[number]) for number in links))
    best = [
        LinkBuckling(number, math.inf if item.unknown is None else None, unknown=item.unknown)
        for number, item in zip(links, buckling.modes, strict=True)
    ]
    if all(item.modes is None for item in buckling.modes):
        return LocalBuckling(tuple(best))
    for case in range(len(cases)):
        top = climbed(search, lambda q, case=case: buckling.greatest(case, q, p), poses, p, _CLIMBS, least=least)
        every = np.vstack([poses, top])
        uses = buckling.greatest(case, every, p)
        for entry, item in enumerate(buckling.modes):
            place = int(np.argmax(uses[:, entry]))
            use, known = float(uses[place, entry]), best[entry].factor
            if item.modes is None or known is None or use * known <= 1.0 or use < _FELT:
                continue
            at = item.uses(buckling.far(case, every[place][None], p)[entry])[0]
            station, mode = np.unravel_index(int(np.argmax(at)), at.shape)
            share, q = float(item.stations[0][station]), tuple(every[place].tolist())
            best[entry] = LinkBuckling(links[entry], 1.0 / use, item.names[mode], q, case, share)
    return LocalBuckling(tuple(best))


_ASSUMED = 2.0
"""The least factor where nobody asks for one: linear theory knows nothing of what a wall's edges and flatness lack."""
_ENDS = (0.0, 1.0)
_CLIMBED_FROM = 0.5
"""A use that is nowhere above this share of what is allowed is not climbed on: a scan is not that far off."""


class Walls(PoseFamily[LocalBuckling]):
    """The walls of each link where they are nearest to buckling: a cut holds the place along each link."""

    name: str = "walls"

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
            far = [acting[LOAD_FIELDS * entry + k] for k in range(LOAD_FIELDS)]
            # The far end of a link that tapers is a smaller image of the one at its joint.
            at = similar_station(shares[entry], design.beams[link].log_taper)
            loads = loads_at(far, shares[entry], at.weight_beyond, at.moment_beyond)
            size = 1.0 + shares[entry] * (ca.exp(design.beams[link].log_taper) - 1.0)
            for mode in design.modes[link]:
                for number, value, slack in held.on(LOCAL_BUCKLING.name):
                    yield number, mode.use(loads.over(size)) * value - ca.exp(slack)

    def evaluate(self, design: DesignValues) -> LocalBuckling:
        """The wall of each link that is nearest to buckling. Raises `OutOfRange` beyond a material's data."""
        return self._over(design, [loads_case(design.arm, load) for load in design.load_cases], 0.0)

    def _over(self, design: DesignValues, cases: Sequence[LoadsCase], least: float) -> LocalBuckling:
        return local_buckling(design.arm, cases, design.beams, design.poses, design.p, design.search, least=least)

    def values(self, result: LocalBuckling) -> Mapping[str, float | None]:
        """The least factor of any wall."""
        return {LOCAL_BUCKLING.name: result.least}

    def unknown(self, result: LocalBuckling | None) -> Mapping[str, str]:
        """Of walls or of what their material does across them."""
        return {} if result is None or result.unknown is None else {LOCAL_BUCKLING.name: result.unknown}

    def warnings(self, arm: Arm, result: LocalBuckling) -> list[str]:
        """One line for each link whose walls buckle under what they bear."""
        del arm
        return [
            f"link {link.link + 1}: walls buckle under {link.factor:.3g} times what they bear ({link.wall})"
            for link in result.links
            if link.factor is not None and link.factor < 1.0
        ]

    def worst(self, prepared: tuple[LoadsCase, ...], problem: Asked, design: DesignValues) -> list[Worst]:
        """The wall of each link that is nearest to buckling."""
        limits = [limit.value for limit in problem.limits if limit.name == LOCAL_BUCKLING.name]
        worst = self._over(design, prepared, _CLIMBED_FROM / max(limits, default=_ASSUMED))
        entries = tuple(link_modes(design.arm, number, design.beams[number]) for number in prepared[0].links)
        modes = Buckling(prepared, entries)
        return [
            Worst(
                LOCAL_BUCKLING.name,
                link.factor,
                Cut(link.q, link.load_case, modes.shares(link.load_case, np.array(link.q), design.p)),
            )
            for link in worst.links
            if link.factor is not None and link.q
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
    shapes = [link.section.shape for link in problem.arm.links if link.section is not None]
    walled = any(not is_solid(SHAPES[shape]) for shape in problem.shapes or shapes)
    return _ASSUMED if walled else None


WALLS = Walls()
"""How near walls are to buckling."""

LOCAL_BUCKLING = Figure(
    name="local_buckling",
    title="local buckling",
    senses=(">=",),
    key="local_buckling",
    follows=ThroughPoses(WALLS),
    more_is_better=True,
    note="least, critical over true stress of any wall",
    # Where nothing presses it is infinite, which no axis can show.
    traded=False,
    assumed=_assumed,
)
