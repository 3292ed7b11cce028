"""problem.yaml to `Problem`: what to minimise, over which poses and loads, within which limits, choosing what."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping as MappingLike
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import cast

from linkwright.core.arm.actuators import Actuator
from linkwright.core.arm.avoid.obstacle import Obstacle
from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.figures import (
    DIRECTED,
    FIGURES,
    PARTS,
    PAYLOAD,
    RANGES_CALLED,
    Figure,
    Limit,
    OfLinks,
)
from linkwright.core.arm.figures.motion.settling import SETTLING
from linkwright.core.arm.files.avoid import read_avoid
from linkwright.core.arm.files.origin import UNKNOWN_ORIGIN
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.worst.workspace import Workspace
from linkwright.core.materials.catalogue import Catalogue, load_catalogue
from linkwright.core.materials.material import Material
from linkwright.core.optimize.reading.conditions import LeftOut, without_lacking
from linkwright.core.optimize.reading.ranges import Ranges, Span
from linkwright.core.units.reading import Mapping, load_yaml

from .balance.balance import Balance
from .balance.motor_places import MotorChoice, read_motor_places
from .balance.read import read_balances
from .base.read import BaseSpans, read_base
from .exchange.cycles import check_cycles, space_of_cycles
from .reading.called import PROBLEM_CALLED
from .reading.choices import LinkLists, read_choices
from .reading.contradictions import check_problem
from .reading.limits import directed_figure, names_direction, read_directed, read_limit, read_settling
from .reading.load_cases import limits_of_cases, read_load_cases, relative_cases
from .reading.ranges import read_ranges, shared_ranges
from .reading.workspace import read_workspace
from .sizes.listed import Listed
from .uncertain import Uncertain, read_uncertain


@dataclass(frozen=True)
class Problem:
    """A design problem, in SI. `minimize` is the figure that is made as good as it can be. `shapes` and `materials` are
    what each link may be; None keeps the arm's own. `ranges` are those of each link's sizes.

    `same` holds what all links must agree in: `section` (the shape),
    `material`, `size` (the dimensions too), `actuator`. `actuators` are what each joint's drive may be, joint by joint
    (nothing for a joint that keeps its own); None keeps all. `figures` are those that can be limited, by name.
    `uncertain` is what the arm may be like instead; the error is then the worst, or a quantile, over that. `sizes` are
    the sections that each link may have (none for rigid ones); None leaves their dimensions free.
    `balances` are the numbers to choose of counterweights and counterbalances, which `arm` marks as chosen; `motors`
    the places to choose from for joints' motors. `avoid` are regions out of which proposed poses keep the arm.
    """

    file: str
    arm: Arm
    minimize: str
    workspace: Workspace
    load_cases: tuple[LoadCase, ...]
    limits: tuple[Limit, ...]
    ranges: tuple[Ranges, ...]
    shapes: tuple[str, ...] | None
    materials: tuple[Material, ...] | None
    same: frozenset[str]
    actuators: tuple[tuple[Actuator, ...], ...] | None = None
    figures: MappingLike[str, Figure] = field(default_factory=lambda: FIGURES)
    uncertain: Uncertain | None = None
    sizes: tuple[tuple[Listed, ...], ...] | None = None
    balances: tuple[Balance, ...] = ()
    motors: tuple[MotorChoice, ...] = ()
    avoid: tuple[Obstacle, ...] = ()
    base: BaseSpans | None = None
    """Where the base may stand; None where that is not chosen."""
    lists: tuple[LinkLists, ...] | None = None
    """What each link may be of the shapes and materials, where links have lists of their own."""
    left_out: tuple[LeftOut, ...] = ()
    """Materials that were named but cannot be chosen."""

    def shapes_of(self, link: int) -> tuple[str, ...]:
        """The shapes that a link (from 0) may have; none for a rigid one."""
        section = self.arm.links[link].section
        if section is None:
            return ()
        listed = None if self.lists is None else self.lists[link].shapes
        return listed or self.shapes or (section.shape,)

    def materials_of(self, link: int) -> tuple[Material, ...]:
        """The materials that a link (from 0) may be of."""
        given = self.arm.links[link].material
        listed = None if self.lists is None else self.lists[link].materials
        return listed or self.materials or (() if given is None else (given,))

    @property
    def objective(self) -> Figure:
        """What is minimised, or maximised where more of it is better."""
        return self.figures[self.minimize]

    @property
    def aimed(self) -> Problem:
        """The problem with a last limit on the objective, of a badness of one, where nothing else makes it least."""
        figure = self.objective
        if figure.summed or any(limit.aim for limit in self.limits):
            return self
        aim = Limit(figure, ">=" if figure.more_is_better else "<=", 1.0, aim=True)
        return replace(self, limits=(*self.limits, aim))

    @property
    def free_lengths(self) -> bool:
        """Whether the length of any link is to be chosen."""
        return any(link_ranges.link_length is not None for link_ranges in self.ranges)

    @property
    def stepped(self) -> bool:
        """Whether any link's walls are sold in steps."""
        return any(link_ranges.steps for link_ranges in self.ranges)

    @property
    def length_spans(self) -> tuple[Span, ...]:
        """The least and the greatest length (m) of each link, one and the same where it stays."""
        return tuple(
            link_ranges.link_length or (link.length, link.length)
            for link_ranges, link in zip(self.ranges, self.arm.links, strict=True)
        )

    @property
    def free_tapers(self) -> bool:
        """Whether the taper of any link is to be chosen."""
        return any(link_ranges.taper is not None for link_ranges in self.ranges)

    def with_ranges(self, **changed: Span | None) -> Problem:
        """The problem with some of the ranges of every link replaced."""
        return replace(self, ranges=tuple(replace(link_ranges, **changed) for link_ranges in self.ranges))

    @property
    def must_reach(self) -> bool:
        """Whether a design must reach all of the workspace: a box or a path stays where it is while lengths are free,
        and lengths that reach less of it would have less to be judged by."""
        return self.free_lengths and self.workspace.in_space

    def needs(self, name: str) -> bool:
        """Whether the question needs a property of the materials: it is minimised, or asked for by a limit."""
        asked = (limit.figure for limit in self.limits if not limit.assumed)
        return name in self.objective.needs or any(name in figure.needs for figure in asked)

    def strength_share(self, link: int, material: Material) -> float:
        """What is asked of the safety factor of a link (from 0) of a material, over what is asked of the others."""
        shares = (limit.share(link, material.name) for limit in self.limit("safety_factor"))
        return math.prod(shares)

    def limits_on_link(self, link: int) -> tuple[Limit, ...]:
        """The limits that a link's section and material keep or break by themselves, as they stand for it (from 0)."""
        on_links = (limit for limit in self.limits if isinstance(limit.figure.follows, OfLinks) and not limit.aim)
        return tuple(limit.on_link(link) for limit in on_links)

    def limit(self, name: str) -> tuple[Limit, ...]:
        """The limits on one quantity."""
        return tuple(limit for limit in self.limits if limit.name == name)


def read_problem(
    path: Path | str, catalogue: Catalogue | None = None, figures: MappingLike[str, Figure] = FIGURES
) -> Problem:
    """The problem that a YAML file describes; raises `InputError`, one line, for anything wrong.

    `figures` are what it can limit.
    """
    known = catalogue or load_catalogue()
    mapping = load_yaml(path)
    return problem_from(mapping, read_arm(arm_file(mapping), known), known, figures)


def arm_file(mapping: Mapping) -> Path:
    """The arm file that a problem file names, beside it. Raises `InputError` where it names none."""
    if mapping.content.get("chain") and not mapping.content.get("arm"):
        message = "is an arm file; a problem file names it (`arm: FILE`) and says what to minimize within which limits"
        raise mapping.error("", message)
    return Path(str(mapping.file)).parent / mapping.text("arm")


def problem_from(mapping: Mapping, arm: Arm, known: Catalogue, figures: MappingLike[str, Figure] = FIGURES) -> Problem:
    """The problem that a mapping describes, for an arm read already; every key of it but `arm` is accounted for."""
    if arm.unknown_origins:
        raise mapping.error("arm", f"chain[{arm.unknown_origins[0] + 1}].origin {UNKNOWN_ORIGIN}")
    with mapping.reading("arm"):
        mapping.also_called(PROBLEM_CALLED)
        minimize, figures = _objective(mapping, figures)
        workspace, of_points = read_workspace(mapping, arm)
        cases = read_load_cases(mapping, arm) or arm.cases
        if all(case.moving is not None for case in cases) and not mapping.has("workspace"):
            workspace = space_of_cycles(cases)
        if mapping.has("relative_to"):
            cases = relative_cases(mapping, arm, cases)
        limits, ranges, off = _subject_to(mapping, arm, {key: item for key, item in figures.items() if item.senses})
        of_cases = limits_of_cases(mapping, cases)
        limits = (*limits, *of_cases, *of_points)
        by_name = {limit.name: limit.figure for limit in limits if limit.name not in figures}
        figures = {**figures, **by_name} if by_name else figures
        avoid = read_avoid(mapping)
        arm = replace(arm, avoid=tuple(dict.fromkeys((*arm.avoid, *avoid))))
        needs = (figure.needs for figure in (figures[minimize], *(limit.figure for limit in limits)))
        chosen = read_choices(mapping, known, arm, frozenset(itertools.chain(*needs)), ranges)
        shapes, materials, lists, same, actuators, sizes = chosen
        if sizes is None:
            same |= _one_part(mapping, arm, limits)
        if "size" in same:
            ranges = shared_ranges(mapping, ranges)
        uncertain = read_uncertain(mapping, _as_driven(arm, actuators), cases, materials or ())
        arm, base, balances, motors = _placed(mapping, arm, workspace)
    problem = Problem(
        file=str(mapping.file),
        arm=arm,
        minimize=minimize,
        workspace=workspace,
        load_cases=cases,
        limits=limits,
        ranges=ranges,
        shapes=shapes,
        materials=materials,
        same=same,
        actuators=actuators,
        figures=figures,
        uncertain=uncertain,
        sizes=sizes,
        balances=balances,
        motors=motors,
        avoid=avoid,
        base=base,
        lists=lists,
    )
    check_cycles(mapping, problem)
    problem = without_lacking(mapping, replace(problem, limits=(*limits, *_assumed(problem, off))))
    check_problem(mapping, problem)
    return problem


def _placed(
    mapping: Mapping, arm: Arm, workspace: Workspace
) -> tuple[Arm, BaseSpans | None, tuple[Balance, ...], tuple[MotorChoice, ...]]:
    """The arm with what may balance it, where its base may stand, and where its motors may sit."""
    if not mapping.has("choose"):
        return arm, None, (), ()
    choose = mapping.mapping("choose")
    base = read_base(choose, arm, workspace)
    arm, balances = read_balances(choose, arm)
    motors = read_motor_places(choose, arm)
    return arm, base, balances, motors


def _objective(mapping: Mapping, figures: MappingLike[str, Figure]) -> tuple[str, MappingLike[str, Figure]]:
    """The figure that is minimised, or maximised where more of it is better, and all figures, it among them."""
    key = "maximize" if mapping.has("maximize") else "minimize"
    if mapping.has("minimize") and mapping.has("maximize"):
        raise mapping.error("maximize", "stands beside minimize; keep one, and limit the other in subject_to")
    traded = {name: figure for name, figure in figures.items() if figure.traded}
    if isinstance(mapping.content.get(key), dict):
        along = directed_figure(mapping, key)
        name, figures = along.name, {**figures, along.name: along}
    else:
        if mapping.content.get(key) in DIRECTED and mapping.content.get(key) not in traded:
            raise mapping.error(key, f"needs a direction: {{{mapping.content[key]}: [0, 0, 1]}}")
        name = mapping.choice(key, {**traded, PAYLOAD.name: PAYLOAD}, "max_error")
        if name == PAYLOAD.name:
            figures = {**figures, name: PAYLOAD}
    if figures[name].more_is_better != (key == "maximize"):
        more, other = ("less", "minimize") if key == "maximize" else ("more", "maximize")
        raise mapping.error(key, f"{name} is better the {more} there is of it; write {other}: {name}")
    return name, figures


def _one_part(mapping: Mapping, arm: Arm, limits: Sequence[Limit]) -> frozenset[str]:
    """What links of free dimensions must agree in where they may be no more than some different parts."""
    most = min((limit.value for limit in limits if limit.name == PARTS.name), default=math.inf)
    if most >= sum(link.elastic for link in arm.links):
        return frozenset()
    if most >= 2.0:
        would_do = "list the sizes to choose from (choose: {sizes: ...}), or write parts: '<= 1'"
        raise mapping.error("subject_to.parts", f"of dimensions that are free takes '<= 1'; {would_do}")
    return frozenset(("section", "material", "size"))


def _assumed(problem: Problem, off: frozenset[str]) -> tuple[Limit, ...]:
    """The limits that hold without being asked for, but for those that the file has or switches off."""
    limits: list[Limit] = []
    for name, figure in problem.figures.items():
        value = None if figure.assumed is None or name in off or problem.limit(name) else figure.assumed(problem)
        if value is not None:
            limits.append(Limit(figure, figure.senses[0], value, assumed=True))
    return tuple(limits)


def _as_driven(arm: Arm, actuators: Sequence[Sequence[Actuator]] | None) -> Arm:
    """The arm with drives that give and have play wherever one that may be chosen does: what may be uncertain of it."""
    if actuators is None:
        return arm
    joints = [
        joint
        if not joint_actuators
        else replace(
            joint,
            stiffness=max(actuator.stiffness for actuator in joint_actuators if actuator.stiffness is not None),
            backlash=max(actuator.backlash or 0.0 for actuator in joint_actuators),
        )
        for joint, joint_actuators in zip(arm.joints, actuators, strict=True)
    ]
    return replace(arm, joints=tuple(joints))


def _subject_to(
    mapping: Mapping, arm: Arm, figures: MappingLike[str, Figure]
) -> tuple[tuple[Limit, ...], tuple[Ranges, ...], frozenset[str]]:
    """The limits, the ranges of each link's sizes, and the names of limits that are switched off."""
    limits: list[Limit] = []
    off: set[str] = set()
    if not mapping.has("subject_to"):
        return (), (Ranges(),) * arm.size, frozenset()
    with mapping.mapping("subject_to").reading() as body:
        known = {name: item.synonyms for name, item in (*DIRECTED.items(), *figures.items())}
        body.also_called({**RANGES_CALLED, **known})
        ranges = read_ranges(body, arm)
        if body.has(SETTLING):
            limits.append(read_settling(body))
        for name in dict.fromkeys((*figures, *DIRECTED)):
            if not body.has(name):
                continue
            raw = body.raw(name)
            entries = cast(list[object], raw) if isinstance(raw, list) else [raw]
            figure = figures.get(name)
            if figure is None:
                limits += [read_directed(body, name, entry, arm) for entry in entries]
                continue
            if raw is False or raw == "off":  # YAML takes a bare `off` for false
                if figure.assumed is None:
                    raise body.error(name, "holds only where it is asked for; leave it out")
                off.add(name)
                continue
            limits += [
                read_directed(body, name, entry, arm)
                if names_direction(name, entry)
                else read_limit(body, figure, entry, arm)
                for entry in entries
            ]
    return tuple(limits), ranges, frozenset(off)
