"""`workspace` of a problem file: ranges of joints, poses, boxes, points and paths of the tip."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Literal, cast, get_args

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.errors.parts import Part
from linkwright.core.arm.figures import (
    Limit,
    error_at_point,
)
from linkwright.core.arm.files.poses import read_poses
from linkwright.core.arm.worst.workspace import Workspace
from linkwright.core.optimize.reading.limits import (
    read_coordinates,
)
from linkwright.core.units.quantities import read_quantity, shown
from linkwright.core.units.reading import Mapping

_MOST_POINTS = 2000


def read_workspace(mapping: Mapping, arm: Arm) -> tuple[Workspace, tuple[Limit, ...]]:
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
