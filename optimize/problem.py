"""problem.yaml to `Problem`: what to minimise, over which poses and loads, within which limits, choosing what."""

from __future__ import annotations

import itertools
from collections.abc import Mapping as MappingLike
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal, cast, get_args

from linkwright.core.arm.actuators import Actuator, load_actuators
from linkwright.core.arm.avoid.regions import Region
from linkwright.core.arm.chain.chain import Arm, Calibrated, LoadCase
from linkwright.core.arm.chain.vectors import ZERO
from linkwright.core.arm.errors.parts import Part
from linkwright.core.arm.files.avoid import read_avoid
from linkwright.core.arm.files.branches import tip_named
from linkwright.core.arm.files.origin import UNKNOWN_ORIGIN
from linkwright.core.arm.files.read import read_arm, read_load
from linkwright.core.arm.worst.workspace import Workspace
from linkwright.core.materials.catalogue import Catalogue, load_catalogue
from linkwright.core.materials.material import Material
from linkwright.core.sections import SHAPES
from linkwright.core.sections.taper import MOST_TAPER
from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import format_quantity, read_quantity, shown
from linkwright.core.units.reading import Mapping, load_yaml

from .balance.balance import Balance
from .balance.motor_places import MotorChoice, read_motor_places
from .balance.read import check_balances, read_balances
from .limits import FIGURES, RANGES, RANGES_CALLED, Figure, Limit
from .limits.read import read_limit
from .reading.called import CHOICES_CALLED, PROBLEM_CALLED
from .reading.conditions import materials_where
from .reading.contradictions import can_be_chosen, check_problem
from .sizes.listed import Listed, read_sizes
from .uncertain import Uncertain, read_uncertain

_MOST_POINTS = 2000
_SMALLEST, _LARGEST = 1e-6, 1e4
"""What a link or a wall can measure at all, m; beyond it, the powers in a search are not finite."""


@dataclass(frozen=True)
class Problem:
    """A design problem, in SI. `shapes` and `materials` are what each link may be; None keeps the arm's own.

    `link_length` is None where lengths stay. `same` holds what all links must agree in: `section` (the shape),
    `material`, `size` (the dimensions too), `actuator`. `actuators` are what each joint's drive may be, joint by joint
    (nothing for a joint that keeps its own); None keeps all. `figures` are those that can be limited, by name.
    `uncertain` is what the arm may be like instead; the error is then the worst, or a quantile, over that. `sizes` are
    the sections that each link may have (none for rigid ones); None leaves their dimensions free. `taper` is the least
    and the greatest size of a link's far end over that at its joint; None keeps links as uniform as they are.
    `balances` are the numbers to choose of counterweights and counterbalances, which `arm` marks as chosen; `motors`
    the places to choose from for joints' motors. `avoid` are regions out of which proposed poses keep the arm.
    """

    file: str
    arm: Arm
    minimize: str
    workspace: Workspace
    load_cases: tuple[LoadCase, ...]
    limits: tuple[Limit, ...]
    link_length: tuple[float, float] | None
    section_size: tuple[float, float]
    thickness: tuple[float, float]
    shapes: tuple[str, ...] | None
    materials: tuple[Material, ...] | None
    same: frozenset[str]
    actuators: tuple[tuple[Actuator, ...], ...] | None = None
    figures: MappingLike[str, Figure] = field(default_factory=lambda: FIGURES)
    uncertain: Uncertain | None = None
    sizes: tuple[tuple[Listed, ...], ...] | None = None
    taper: tuple[float, float] | None = None
    balances: tuple[Balance, ...] = ()
    motors: tuple[MotorChoice, ...] = ()
    avoid: tuple[Region, ...] = ()

    @property
    def objective(self) -> Figure:
        """What is minimised."""
        return self.figures[self.minimize]

    @property
    def must_reach(self) -> bool:
        """Whether a design must reach all of the workspace: a box or a path stays where it is while lengths are free,
        and lengths that reach less of it would have less to be judged by."""
        free = self.link_length is not None and any(link.elastic for link in self.arm.links)
        return free and self.workspace.kind != "joints"

    def needs(self, name: str) -> bool:
        """Whether the question needs a property of the materials: it is minimised, or asked for by a limit."""
        asked = (limit.figure for limit in self.limits if not limit.assumed)
        return name in self.objective.needs or any(name in figure.needs for figure in asked)

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
    arm = read_arm(Path(path).parent / mapping.text("arm"), known)
    return problem_from(mapping, arm, known, figures)


def problem_from(mapping: Mapping, arm: Arm, known: Catalogue, figures: MappingLike[str, Figure] = FIGURES) -> Problem:
    """The problem that a mapping describes, for an arm read already; every key of it but `arm` is accounted for."""
    if arm.unknown_origins:
        raise mapping.error("arm", f"chain[{arm.unknown_origins[0] + 1}].origin {UNKNOWN_ORIGIN}")
    with mapping.reading("arm"):
        mapping.also_called(PROBLEM_CALLED)
        objectives = {name: figure for name, figure in figures.items() if figure.minimised}
        minimize = mapping.choice("minimize", objectives, "max_error")
        workspace = _workspace(mapping, arm)
        cases = _load_cases(mapping, arm) or arm.cases
        if mapping.has("relative_to"):
            cases = _relative(mapping, arm, cases)
        limits, ranges, off = _subject_to(mapping, arm, figures)
        avoid = read_avoid(mapping)
        needs = (figure.needs for figure in (figures[minimize], *(limit.figure for limit in limits)))
        chosen = _choose(mapping, known, arm, frozenset(itertools.chain(*needs)), ranges)
        shapes, materials, same, actuators, sizes = chosen
        uncertain = read_uncertain(mapping, _as_driven(arm, actuators))
        balances: tuple[Balance, ...] = ()
        motors: tuple[MotorChoice, ...] = ()
        if mapping.has("choose"):
            arm, balances = read_balances(mapping.mapping("choose"), arm)
            motors = read_motor_places(mapping.mapping("choose"), arm)
            check_balances(mapping.mapping("choose"), balances, frozenset(limit.name for limit in limits))
    problem = Problem(
        file=str(mapping.file),
        arm=arm,
        minimize=minimize,
        workspace=workspace,
        load_cases=cases,
        limits=limits,
        link_length=ranges.get("link_length"),
        section_size=ranges.get("section_size", RANGES["section_size"]),
        thickness=ranges.get("thickness", RANGES["thickness"]),
        shapes=shapes,
        materials=materials,
        same=same,
        actuators=actuators,
        figures=figures,
        uncertain=uncertain,
        sizes=sizes,
        taper=ranges.get("taper"),
        balances=balances,
        motors=motors,
        avoid=avoid,
    )
    problem = replace(problem, limits=(*limits, *_assumed(problem, off)))
    check_problem(mapping, problem)
    return problem


def _assumed(problem: Problem, off: frozenset[str]) -> tuple[Limit, ...]:
    """The limits that hold without being asked for, but for those that the file has or switches off."""
    found: list[Limit] = []
    for name, figure in problem.figures.items():
        value = None if figure.assumed is None or name in off or problem.limit(name) else figure.assumed(problem)
        if value is not None:
            found.append(Limit(figure, figure.senses[0], value, assumed=True))
    return tuple(found)


def _workspace(mapping: Mapping, arm: Arm) -> Workspace:
    if not mapping.has("workspace"):
        return Workspace()
    with mapping.mapping("workspace").reading() as body:
        kinds = [name for name in ("joints", "path", "box") if body.has(name)]
        if len(kinds) != 1:
            raise body.error("", "needs one of joints, path and box, e.g. {joints: range}")
        if kinds[0] == "joints":
            if body.has("error"):
                raise body.error("error", "is for a path, whose direction tells what is across and along")
            return _joint_ranges(body, arm)
        points = _points(body, kinds[0], arm)
        flat = len(points[0]) == 2
        full = tuple((point[0], point[1], point[2] if len(point) == 3 else 0.0) for point in points)
        counted = cast(Part, body.choice("error", get_args(Part), "whole"))
        space = Workspace(cast(Literal["path", "box"], kinds[0]), full, None, flat or arm.planar(), counted)
        if counted != "whole" and not space.segments:
            raise body.error(
                "error", f"{counted} needs a direction: a path of two points or more, path: [[x, y], [x, y]]"
            )
        return space


def _points(body: Mapping, kind: str, arm: Arm) -> list[tuple[float, ...]]:
    """The corners of a box or the points of a path (m), all of two components or all of three."""
    points = [_point(point, body, f"{kind}[{number}]") for number, point in enumerate(body.items(kind), start=1)]
    if kind == "box" and len(points) != 2:
        raise body.error("box", f"needs two corners, [[x, y], [x, y]], not {len(points)}")
    if not points:
        raise body.error("path", "needs at least one point, [[x, y], ...]")
    if arm.branches:
        message = "is of one tip, and the arm has several; use the joint ranges (workspace: {joints: range})"
        raise body.error(kind, f"{message}, or write the arm of one branch by itself")
    if len(points) > _MOST_POINTS:
        message = f"has {len(points)} points; at most {_MOST_POINTS} are followed, straight from each to the next"
        raise body.error("path", f"{message}: leave out those in between")
    if len({len(point) for point in points}) != 1:
        raise body.error(kind, "mixes points of two and of three components")
    flat = len(points[0]) == 2
    if not flat and arm.planar() and any(point[2] != 0.0 for point in points):
        raise body.error(kind, "leaves the plane in which the arm moves: z must be 0 mm")
    if flat and not arm.planar():
        raise body.error(kind, "needs three components (x, y, z): the arm moves in space")
    return points


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
    one torso a case that names no `tip` is one of each tip that counts, the others with their own payloads."""
    if not mapping.has("load_cases"):
        return ()
    cases: list[LoadCase] = []
    for body in mapping.mappings("load_cases"):
        with body.reading():
            case, named = _load_case(body)
            if body.has("tip") and not arm.branches:
                raise body.error("tip", "is of arms with branches, and this one has a single tip; leave it out")
            tips = [""]
            if body.has("tip"):
                tips = [tip_named(body, arm.branches, body.text("tip"))]
            elif arm.every_tip:
                tips = [each.name for each in arm.branches]
            cases += [replace(case, tip=tip, leaves_off=0.0 if named else arm.on(tip).payload.mass) for tip in tips]
    if not cases:
        raise mapping.error("load_cases", "is empty; leave it out to use the arm's own payload")
    return tuple(cases)


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
        if not own
        else replace(joint, stiffness=max(each.stiffness for each in own), backlash=max(each.backlash for each in own))
        for joint, own in zip(arm.joints, actuators, strict=True)
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
) -> tuple[tuple[Limit, ...], dict[str, tuple[float, float]], frozenset[str]]:
    """The limits, the ranges of sizes, and the names of limits that are switched off."""
    limits: list[Limit] = []
    ranges: dict[str, tuple[float, float]] = {}
    off: set[str] = set()
    if not mapping.has("subject_to"):
        return (), {}, frozenset()
    with mapping.mapping("subject_to").reading() as body:
        body.also_called({**RANGES_CALLED, **{name: figure.synonyms for name, figure in figures.items()}})
        for name, default in RANGES.items():
            if body.has(name):
                ranges[name] = _range(body, name, default)
        if body.has("taper"):
            ranges["taper"] = _taper(body)
        for name, figure in figures.items():
            if not body.has(name):
                continue
            raw = body.raw(name)
            if raw is False or raw == "off":  # YAML takes a bare `off` for false
                if figure.assumed is None:
                    raise body.error(name, "holds only where it is asked for; leave it out")
                off.add(name)
                continue
            entries = cast(list[object], raw) if isinstance(raw, list) else [raw]
            limits += [read_limit(body, figure, entry, arm) for entry in entries]
    return tuple(limits), ranges, frozenset(off)


def _range(body: Mapping, name: str, default: tuple[float, float]) -> tuple[float, float]:
    if isinstance(body.content[name], str):
        bound = body.bound(name, "length")
        low = bound.value if bound.relation != "<=" else min(default[0], bound.value)
        high = bound.value if bound.relation != ">=" else max(default[1], bound.value)
    else:
        low, high = body.range(name, "length")
    if low <= 0.0:
        raise body.error(name, f"must be above zero, not {shown(body.content[name])}")
    if low < _SMALLEST or high > _LARGEST:
        ends = f"{format_quantity(_SMALLEST, 'length')} and {format_quantity(_LARGEST, 'length')}"
        raise body.error(name, f"must lie between {ends}, not {shown(body.content[name])}")
    return low, high


def _taper(body: Mapping) -> tuple[float, float]:
    """The least and the greatest size of a far end over that at the joint."""
    low, high = body.range("taper", "dimensionless")
    if not 1.0 / MOST_TAPER <= low <= high <= MOST_TAPER:
        would_do = f"sizes of the far end over those at the joint between {1.0 / MOST_TAPER:g} and {MOST_TAPER:g}"
        raise body.error("taper", f"holds {would_do}, e.g. [0.4, 1], not {shown(body.content['taper'])}")
    return low, high


def _choose(
    mapping: Mapping,
    catalogue: Catalogue,
    arm: Arm,
    needs: frozenset[str],
    ranges: MappingLike[str, tuple[float, float]],
) -> tuple[
    tuple[str, ...] | None,
    tuple[Material, ...] | None,
    frozenset[str],
    tuple[tuple[Actuator, ...], ...] | None,
    tuple[tuple[Listed, ...], ...] | None,
]:
    if not mapping.has("choose"):
        return None, None, frozenset(), None, None
    with mapping.mapping("choose").reading("balancer", "counterweight", "motor") as body:
        body.also_called(CHOICES_CALLED)
        shapes: tuple[str, ...] | None = None
        if body.has("section"):
            names = _names(body, "section")
            free = {name: kind for name, kind in SHAPES.items() if can_be_chosen(name)}
            for number, name in enumerate(names, start=1):
                if name not in free:
                    raise body.error(f"section[{number}]", f"there is no shape '{name}' to choose{nearest(name, free)}")
            shapes = tuple(dict.fromkeys(names))
        materials = _materials(body, catalogue, arm, needs) if body.has("material") else None
        same = body.items("same", [])
        for name in same:
            if name not in ("section", "material", "size", "actuator"):
                raise body.error("same", f"takes section, material, size and actuator, not {shown(name)}")
        sizes = read_sizes(body, arm, shapes, ranges.get("section_size"), ranges.get("thickness"))
        return shapes, materials, frozenset(str(name) for name in same), _actuators(body, arm), sizes


def _materials(body: Mapping, catalogue: Catalogue, arm: Arm, needs: frozenset[str]) -> tuple[Material, ...]:
    """The materials to choose from, by name, in place, or by their properties."""
    values = body.raw("material")
    entries = cast(list[object], values) if isinstance(values, list) else [values]
    if not entries:
        raise body.error("material", "is empty; name at least one material")
    read: list[Material] = []
    for number, entry in enumerate(entries, start=1):
        key = body.path_of("material" if entry is values else f"material[{number}]")
        if isinstance(entry, dict) and "where" in entry:
            with Mapping(cast(object, entry), file=body.file, key=key).reading() as own:
                read += materials_where(own, catalogue, arm, needs)
        else:
            read.append(catalogue.read(entry, file=body.file, key=f"{body.path_of('material')}[{number}]"))
    materials = tuple(dict.fromkeys(read))
    for material in materials:
        if any(other.name == material.name and other != material for other in materials):
            message = f"calls two materials {material.name}; give each a name of its own (name: ...)"
            raise body.error("material", message)
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
    found: list[tuple[Actuator, ...]] = []
    for number, (entry, joint) in enumerate(zip(entries, arm.joints, strict=True), start=1):
        names = cast(list[object], entry) if isinstance(entry, list) else [entry]
        if not all(isinstance(name, str) for name in names):
            raise body.error("actuator", f"needs names, e.g. [RV-20E, RV-40E], not {shown(entry)}")
        if names and not joint.revolute:
            raise body.error("actuator", f"joint {number} slides, and no actuator drives a slide; write [] for it")
        chosen = [known.find(str(name), file=body.file, key=path) for name in names]
        found.append(tuple({actuator.name: actuator for actuator in chosen}.values()))
    if not any(found):
        raise body.error("actuator", "is empty; name at least one actuator")
    return tuple(found)


def _names(body: Mapping, key: str) -> list[str]:
    raw = body.raw(key)
    entries = cast(list[object], raw) if isinstance(raw, list) else [raw]
    if not entries or not all(isinstance(entry, str) for entry in entries):
        raise body.error(key, f"needs names, e.g. [circle, tube], not {shown(raw)}")
    return [str(entry) for entry in entries]
