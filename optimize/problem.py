"""problem.yaml to `Problem`: what to minimise, over which poses and loads, within which limits, choosing what."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping as MappingLike
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal, TypeVar, cast, get_args

from linkwright.core.arm.actuators import Actuator, load_actuators
from linkwright.core.arm.avoid.regions import Region
from linkwright.core.arm.chain.chain import Arm, Calibrated, LoadCase
from linkwright.core.arm.chain.vectors import ZERO
from linkwright.core.arm.errors.parts import Part
from linkwright.core.arm.figures import (
    DIRECTED,
    FIGURES,
    PARTS,
    PAYLOAD,
    RANGES_CALLED,
    Figure,
    Limit,
    OfLinks,
    error_at_point,
    error_of_case,
)
from linkwright.core.arm.figures.motion.settling import SETTLING
from linkwright.core.arm.files.avoid import read_avoid
from linkwright.core.arm.files.branches import tip_named
from linkwright.core.arm.files.origin import UNKNOWN_ORIGIN
from linkwright.core.arm.files.poses import read_poses
from linkwright.core.arm.files.read import read_arm, read_load
from linkwright.core.arm.worst.workspace import Workspace
from linkwright.core.materials.catalogue import Catalogue, load_catalogue
from linkwright.core.materials.material import Material
from linkwright.core.optimize.reading.conditions import LeftOut, without_lacking
from linkwright.core.optimize.reading.ranges import Ranges, Span
from linkwright.core.sections import SHAPES
from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import read_quantity, shown
from linkwright.core.units.reading import Mapping, load_yaml

from .balance.balance import Balance
from .balance.motor_places import MotorChoice, read_motor_places
from .balance.read import check_balances, read_balances
from .base.read import BaseSpans, read_base
from .exchange.cycles import check_cycles, moving_cases, space_of_cycles
from .reading.by_link import ByLink
from .reading.by_link import by_link as _by_link
from .reading.called import CHOICES_CALLED, PROBLEM_CALLED
from .reading.conditions import materials_where
from .reading.contradictions import can_be_chosen, check_problem
from .reading.limits import directed_figure, names_direction, read_coordinates, read_directed, read_limit, read_settling
from .reading.ranges import read_ranges, shared_ranges
from .sizes.listed import Listed, read_sizes
from .uncertain import Uncertain, read_uncertain

_MOST_POINTS = 2000
Item = TypeVar("Item")


@dataclass(frozen=True)
class LinkLists:
    """The shapes and materials of a link's own; None where it may be of all that the problem names."""

    shapes: tuple[str, ...] | None
    materials: tuple[Material, ...] | None


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
    avoid: tuple[Region, ...] = ()
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
        workspace, of_points = _workspace(mapping, arm)
        cases = _load_cases(mapping, arm) or arm.cases
        if all(case.moving is not None for case in cases) and not mapping.has("workspace"):
            workspace = space_of_cycles(cases)
        if mapping.has("relative_to"):
            cases = _relative(mapping, arm, cases)
        limits, ranges, off = _subject_to(mapping, arm, {key: item for key, item in figures.items() if item.senses})
        of_cases = _limits_of_cases(mapping, cases)
        limits = (*limits, *of_cases, *of_points)
        by_name = {limit.name: limit.figure for limit in limits if limit.name not in figures}
        figures = {**figures, **by_name} if by_name else figures
        avoid = read_avoid(mapping)
        needs = (figure.needs for figure in (figures[minimize], *(limit.figure for limit in limits)))
        chosen = _choose(mapping, known, arm, frozenset(itertools.chain(*needs)), ranges)
        shapes, materials, lists, same, actuators, sizes = chosen
        if sizes is None:
            same |= _one_part(mapping, arm, limits)
        if "size" in same:
            ranges = shared_ranges(mapping, ranges)
        uncertain = read_uncertain(mapping, _as_driven(arm, actuators), cases, materials or ())
        arm, base, balances, motors = _placed(mapping, arm, workspace, frozenset(limit.name for limit in limits))
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
    mapping: Mapping, arm: Arm, workspace: Workspace, limited: frozenset[str]
) -> tuple[Arm, BaseSpans | None, tuple[Balance, ...], tuple[MotorChoice, ...]]:
    """The arm with what may balance it, where its base may stand, and where its motors may sit."""
    if not mapping.has("choose"):
        return arm, None, (), ()
    choose = mapping.mapping("choose")
    base = read_base(choose, arm, workspace)
    arm, balances = read_balances(choose, arm)
    motors = read_motor_places(choose, arm)
    check_balances(choose, balances, limited)
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


def _workspace(mapping: Mapping, arm: Arm) -> tuple[Workspace, tuple[Limit, ...]]:
    """Where the arm works, and the limits that its points have of their own."""
    if not mapping.has("workspace"):
        return Workspace(), ()
    with mapping.mapping("workspace").reading() as body:
        kinds = [name for name in ("joints", "poses", "path", "points", "box") if body.has(name)]
        if len(kinds) != 1:
            raise body.error("", "needs one of joints, poses, path, points and box, e.g. {joints: range}")
        if kinds[0] in ("joints", "poses"):
            if body.has("error"):
                raise body.error("error", "is for a path, whose direction tells what is across and along")
            return (_joint_ranges(body, arm) if kinds[0] == "joints" else _listed_poses(body, arm)), ()
        points, limits, weights = _points(body, kinds[0], arm)
        flat = len(points[0]) == 2
        full = tuple((point[0], point[1], point[2] if len(point) == 3 else 0.0) for point in points)
        counted = cast(Part, body.choice("error", get_args(Part), "whole"))
        kind: Literal["path", "box"] = "box" if kinds[0] == "box" else "path"
        space = Workspace(kind, full, None, flat or arm.flat, counted, kinds[0] == "points", weights=weights)
        if counted != "whole" and not space.segments:
            raise body.error(
                "error", f"{counted} needs a direction: a path of two points or more, path: [[x, y], [x, y]]"
            )
        return space, limits


def _listed_poses(body: Mapping, arm: Arm) -> Workspace:
    """Poses by their joint coordinates: from a table, which may give them weights, or as they stand in the file."""
    weights: tuple[float, ...] = ()
    if isinstance(body.raw("poses"), str):
        result, given = read_poses(Path(str(body.file)).parent / body.text("poses"), arm)
        poses = tuple(tuple(row) for row in result.tolist())
        weights = () if given is None else tuple(given.tolist())
    else:
        poses = read_coordinates(body, arm)
    if len(poses) > _MOST_POINTS:
        raise body.error("poses", f"has {len(poses)} poses; at most {_MOST_POINTS} are looked at")
    spans = tuple((min(column), max(column)) for column in zip(*poses, strict=True))
    return Workspace("poses", ranges=spans, poses=poses, weights=weights)


def _points(body: Mapping, kind: str, arm: Arm) -> tuple[list[tuple[float, ...]], tuple[Limit, ...], tuple[float, ...]]:
    """The corners of a box or the points of a path (m), all of two components or all of three; of points that stand
    alone the limits that they have of their own, and their weights (none where they are alike)."""
    points: list[tuple[float, ...]] = []
    limits: list[Limit] = []
    weights: list[float] = []
    for number, entry in enumerate(body.items(kind), start=1):
        key = f"{kind}[{number}]"
        if kind != "points" or not isinstance(entry, dict):
            points.append(_point(entry, body, key))
            weights.append(1.0)
            continue
        with Mapping(cast(object, entry), file=body.file, key=body.path_of(key)).reading() as point_keys:
            points.append(_point(point_keys.raw("at", "at: [400 mm, 300 mm]"), point_keys, "at"))
            weights.append(point_keys.number("weight", 1.0))
            if weights[-1] <= 0.0:
                raise point_keys.error("weight", "must be above zero; leave the point out where it does not count")
            if point_keys.has("max_error"):
                limits.append(_tolerance(point_keys, number))
    _check_points(points, body, kind, arm)
    return points, tuple(limits), tuple(weights) if len(set(weights)) > 1 else ()


def _tolerance(point_keys: Mapping, number: int) -> Limit:
    """The limit that a point (from 1) has on the error there."""
    bound = point_keys.bound("max_error", "length")
    if bound.relation != "<=" or bound.value <= 0.0:
        whole = shown(point_keys.raw("max_error"))
        raise point_keys.error("max_error", f"needs a limit from above, e.g. '<= 0.1 mm', not {whole}")
    return Limit(error_at_point(number - 1), "<=", bound.value)


def _check_points(points: Sequence[tuple[float, ...]], body: Mapping, kind: str, arm: Arm) -> None:
    if kind == "box" and len(points) != 2:
        raise body.error("box", f"needs two corners, [[x, y], [x, y]], not {len(points)}")
    if not points:
        raise body.error(kind, "needs at least one point, [[x, y], ...]")
    if arm.branches:
        message = "is of one tip, and the arm has several; use the joint ranges (workspace: {joints: range})"
        raise body.error(kind, f"{message}, or write the arm of one branch by itself")
    if len(points) > _MOST_POINTS:
        message = f"has {len(points)} points; at most {_MOST_POINTS} are followed, straight from each to the next"
        raise body.error(kind, f"{message}: leave out those in between")
    if len({len(point) for point in points}) != 1:
        raise body.error(kind, "mixes points of two and of three components")
    flat = len(points[0]) == 2
    if not flat and arm.flat and any(point[2] != 0.0 for point in points):
        raise body.error(kind, "leaves the plane in which the arm moves: z must be 0 mm")
    if flat and not arm.flat:
        raise body.error(kind, "needs three components (x, y, z): the arm moves in space")


def _joint_ranges(body: Mapping, arm: Arm) -> Workspace:
    raw = body.raw("joints")
    if raw == "range":
        return Workspace()
    if not isinstance(raw, list) or len(cast(list[object], raw)) != arm.size:
        raise body.error("joints", f"is `range`, or a range for each of the {arm.size} joints, not {shown(raw)}")
    ranges: list[tuple[float, float]] = []
    for number, (pair, joint) in enumerate(zip(cast(list[object], raw), arm.joints, strict=True), start=1):
        single = Mapping({"range": pair}, file=body.file, key=body.path_of(f"joints[{number}]"))
        ranges.append(single.range("range", "angle" if joint.revolute else "length"))
    return Workspace(ranges=tuple(ranges))


def _point(value: object, body: Mapping, key: str) -> tuple[float, ...]:
    if not isinstance(value, list) or len(cast(list[object], value)) not in (2, 3):
        raise body.error(key, f"is a point of two or three lengths, e.g. [400 mm, 300 mm], not {shown(value)}")
    path = body.path_of(key)
    return tuple(
        read_quantity(part, "length", file=body.file, key=f"{path}[{number}]")
        for number, part in enumerate(cast(list[object], value), start=1)
    )


def _load_cases(mapping: Mapping, arm: Arm) -> tuple[LoadCase, ...]:
    """Each case replaces the arm's payload wholly; a force may stand inside `payload` or beside it. Of several arms on
    one torso a case that names no `tip` is one of each tip that counts, the others with their payloads."""
    if not mapping.has("load_cases"):
        return ()
    cases: list[LoadCase] = []
    for body in mapping.mappings("load_cases"):
        with body.reading("subject_to"):
            case, named = _load_case(body)
            if body.has("motion"):
                cases += moving_cases(body, arm, case if named else replace(case, mass=arm.payload.mass))
                continue
            if body.has("tip") and not arm.branches:
                raise body.error("tip", "is of arms with branches, and this one has a single tip; leave it out")
            tips = [""]
            if body.has("tip"):
                tips = [tip_named(body, arm.branches, body.text("tip"))]
            elif arm.every_tip:
                tips = [branch.name for branch in arm.branches]
            cases += [replace(case, tip=tip, leaves_off=0.0 if named else arm.on(tip).payload.mass) for tip in tips]
    if not cases:
        raise mapping.error("load_cases", "is empty; leave it out to use the arm's own payload")
    return tuple(sorted(cases, key=lambda case: case.moving is not None))


def _limits_of_cases(mapping: Mapping, cases: Sequence[LoadCase]) -> tuple[Limit, ...]:
    """The limits that load cases have of their own: on the worst error under them."""
    limits: list[Limit] = []
    bodies = mapping.mappings("load_cases") if mapping.has("load_cases") else ()
    for number, body in enumerate(bodies):
        if not body.has("subject_to"):
            continue
        with body.mapping("subject_to").reading() as limit_body:
            if len(cases) != len(mapping.mappings("load_cases")):
                raise limit_body.error("", "goes with one tip; name the `tip` of each load case")
            bound = limit_body.bound("max_error", "length")
            if bound.relation != "<=" or bound.value <= 0.0:
                whole = shown(limit_body.raw("max_error"))
                raise limit_body.error("max_error", f"needs a limit from above, e.g. '<= 0.1 mm', not {whole}")
            limits.append(Limit(error_of_case(number), "<=", bound.value))
    return tuple(limits)


def _load_case(body: Mapping) -> tuple[LoadCase, bool]:
    """The load of one case, and whether it says a mass."""
    inner = read_load(body.mapping("payload")) if body.has("payload") else LoadCase()
    outer = {name: value for name, value in body.content.items() if name in ("mass", "force", "moment")}
    for name in outer:
        body.has(name)
    beside = read_load(Mapping(outer, file=body.file, key=body.key)) if outer else LoadCase()
    for name, empty in (("mass", 0.0), ("force", ZERO), ("moment", ZERO)):
        if getattr(inner, name) != empty and getattr(beside, name) != empty:
            raise body.error(name, "is given twice: inside payload and beside it")
    inside = body.content.get("payload")
    case = LoadCase(
        mass=inner.mass or beside.mass,
        force=inner.force if any(inner.force) else beside.force,
        moment=inner.moment if any(inner.moment) else beside.moment,
    )
    return case, "mass" in outer or (isinstance(inside, dict) and "mass" in inside)


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


def _relative(mapping: Mapping, arm: Arm, cases: tuple[LoadCase, ...]) -> tuple[LoadCase, ...]:
    """The load cases with errors that count from the calibrated state of `relative_to`."""
    with mapping.mapping("relative_to").reading() as body:
        payload = read_load(body.mapping("payload")) if body.has("payload") else None
        temperature = body.quantity("temperature", "temperature") if body.has("temperature") else None
        if payload is None and temperature is None:
            would_do = (
                "give the payload or the temperature at which the arm was calibrated, e.g. {payload: {mass: 2 kg}}"
            )
            raise body.error("", f"names no calibrated state; {would_do}")
        if (temperature is None or temperature == arm.temperature) and all(payload in (None, case) for case in cases):
            message = (
                "is the state in which the arm works, so that nothing changes; name another payload or temperature"
            )
            raise body.error("", message)
    state = Calibrated(payload, temperature)
    return tuple(replace(case, relative_to=state) for case in cases)


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


def _choose(
    mapping: Mapping,
    catalogue: Catalogue,
    arm: Arm,
    needs: frozenset[str],
    ranges: Sequence[Ranges],
) -> tuple[
    tuple[str, ...] | None,
    tuple[Material, ...] | None,
    tuple[LinkLists, ...] | None,
    frozenset[str],
    tuple[tuple[Actuator, ...], ...] | None,
    tuple[tuple[Listed, ...], ...] | None,
]:
    if not mapping.has("choose"):
        return None, None, None, frozenset(), None, None
    with mapping.mapping("choose").reading("balancer", "base", "counterweight", "motor") as body:
        body.also_called(CHOICES_CALLED)
        shapes = _by_link(body, "section", arm, _shapes)
        materials = _by_link(body, "material", arm, lambda item, key: _materials(item, key, catalogue, arm, needs))
        same = body.items("same", [])
        for name in same:
            if name not in ("section", "material", "size", "actuator"):
                raise body.error("same", f"takes section, material, size and actuator, not {shown(name)}")
        uniform = shapes.alike and materials.alike
        lists = None if uniform else tuple(map(LinkLists, shapes.each, materials.each))
        sizes = read_sizes(body, arm, shapes.each, ranges)
        agree = frozenset(str(name) for name in same)
        return _all(shapes), _all(materials), lists, agree, _actuators(body, arm), sizes


def _all(by_link: ByLink[tuple[Item, ...]]) -> tuple[Item, ...] | None:
    """What any link may be; None where nothing is said."""
    return tuple(dict.fromkeys(item for entry in by_link.each for item in entry or ())) or None


def _shapes(body: Mapping, key: str) -> tuple[str, ...]:
    names = _names(body, key)
    free = {name: kind for name, kind in SHAPES.items() if can_be_chosen(name)}
    for number, name in enumerate(names, start=1):
        if name in SHAPES and name not in free:
            would_do = "name stock sizes without a shape: choose: {sizes: [...]}"
            raise body.error(f"{key}[{number}]", f"the dimensions of a {name} cannot be chosen; {would_do}")
        if name not in free:
            raise body.error(f"{key}[{number}]", f"there is no shape '{name}' to choose{nearest(name, free)}")
    return tuple(dict.fromkeys(names))


def _materials(body: Mapping, name: str, catalogue: Catalogue, arm: Arm, needs: frozenset[str]) -> tuple[Material, ...]:
    """The materials to choose from, by name, in place, or by their properties."""
    values = body.raw(name)
    entries = cast(list[object], values) if isinstance(values, list) else [values]
    if not entries:
        raise body.error(name, "is empty; name at least one material")
    read: list[Material] = []
    for number, entry in enumerate(entries, start=1):
        key = body.path_of(name if entry is values else f"{name}[{number}]")
        if isinstance(entry, dict) and "where" in entry:
            with Mapping(cast(object, entry), file=body.file, key=key).reading() as conditions:
                read += materials_where(conditions, catalogue, arm, needs)
        else:
            read.append(catalogue.read(entry, file=body.file, key=f"{body.path_of(name)}[{number}]"))
    materials = tuple(dict.fromkeys(read))
    for material in materials:
        if any(other.name == material.name and other != material for other in materials):
            message = f"calls two materials {material.name}; give each a name of its own (name: ...)"
            raise body.error(name, message)
    return materials


def _actuators(body: Mapping, arm: Arm) -> tuple[tuple[Actuator, ...], ...] | None:
    """What each joint's drive may be: one list for all joints that turn, or a list for each joint."""
    if not body.has("actuator"):
        return None
    raw = body.raw("actuator")
    entries = cast(list[object], raw) if isinstance(raw, list) else [raw]
    if not any(isinstance(entry, list) for entry in entries):
        entries = [entries if joint.revolute else [] for joint in arm.joints]
    if len(entries) != arm.size:
        raise body.error("actuator", f"is one list of names, or a list for each of the {arm.size} joints")
    known, path = load_actuators(), body.path_of("actuator")
    actuators: list[tuple[Actuator, ...]] = []
    for number, (entry, joint) in enumerate(zip(entries, arm.joints, strict=True), start=1):
        names = cast(list[object], entry) if isinstance(entry, list) else [entry]
        if not all(isinstance(name, str) for name in names):
            raise body.error("actuator", f"needs names, e.g. [RV-20E, RV-40E], not {shown(entry)}")
        if names and not joint.revolute:
            raise body.error("actuator", f"joint {number} slides, and no actuator drives a slide; write [] for it")
        chosen = [known.find(str(name), file=body.file, key=path) for name in names]
        for item in chosen:
            if unknown := item.lacks("rated_torque", "stiffness", "backlash", "mass"):
                missing = ", ".join(unknown).replace("_", " ")
                raise body.error("actuator", f"cannot choose {item.name}, whose {missing} the catalogue does not know")
        actuators.append(tuple({actuator.name: actuator for actuator in chosen}.values()))
    if not any(actuators):
        raise body.error("actuator", "is empty; name at least one actuator")
    return tuple(actuators)


def _names(body: Mapping, key: str) -> list[str]:
    raw = body.raw(key)
    entries = cast(list[object], raw) if isinstance(raw, list) else [raw]
    if not entries or not all(isinstance(entry, str) for entry in entries):
        raise body.error(key, f"needs names, e.g. [circle, tube], not {shown(raw)}")
    return [str(entry) for entry in entries]
