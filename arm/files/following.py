"""`follows: "-(q2 + q3)"`: what a joint follows, read from an expression and written as one."""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Iterator, Sequence
from collections.abc import Mapping as MappingLike
from dataclasses import dataclass, replace
from typing import cast

import numpy as np

from linkwright.core.arm.chain.branches import ways
from linkwright.core.arm.chain.chain import Arm, Joint
from linkwright.core.arm.chain.following import Following, Tie
from linkwright.core.arm.chain.kinematics import place
from linkwright.core.units.quantities import format_quantity, read_quantity
from linkwright.core.units.reading import Mapping

_QUANTITY = re.compile(r"(?<![\w.])((?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(deg|arcmin|mrad|rad|mm|um|cm|m)\b")
_COORDINATE = re.compile(r"q([1-9]\d*)")
_LONGEST = 500
_ALONGSIDE = 1e-9
_POSES = 5
_NO_SUM = "only sums of coordinates times numbers"


@dataclass(frozen=True)
class _Sum:
    """sum_j weight_j q_j + constant, a plain number where there is neither (`number`)."""

    weights: dict[int, float]
    constant: float = 0.0
    number: float | None = None

    def scaled(self, factor: float) -> _Sum:
        weights = {joint: factor * weight for joint, weight in self.weights.items()}
        return _Sum(weights, factor * self.constant, None if self.number is None else factor * self.number)

    def plus(self, other: _Sum) -> _Sum:
        if (self.number is None) != (other.number is None):
            raise ValueError("a bare number is added")
        if self.number is not None and other.number is not None:
            return _Sum({}, 0.0, self.number + other.number)
        joints = {*self.weights, *other.weights}
        weights = {joint: self.weights.get(joint, 0.0) + other.weights.get(joint, 0.0) for joint in sorted(joints)}
        return _Sum(weights, self.constant + other.constant)


def read_following(mapping: Mapping, size: int, *, turns: bool) -> Following | None:
    """What the joint of a mapping follows in an arm of so many; whether it may is checked by `tied`."""
    if not mapping.has("follows"):
        return None
    text = mapping.text("follows")
    constants: list[float] = []

    def held(quantity: re.Match[str]) -> str:
        kind = "angle" if turns else "length"
        constants.append(read_quantity(quantity[0], kind, file=mapping.file, key=mapping.path_of("follows")))
        return f"_{len(constants) - 1}"

    would_do = f"coordinates times numbers, and {'angles' if turns else 'lengths'}: -(q2 + q3), or 0.5*q2"
    if len(text) > _LONGEST:
        raise mapping.error("follows", f"is too long; write {would_do}")
    try:
        total = _sum(ast.parse(_QUANTITY.sub(held, text), mode="eval").body, constants)
    except (SyntaxError, ValueError, RecursionError, ZeroDivisionError, OverflowError) as error:
        reason = f" ({error})" if type(error) is ValueError else ""
        raise mapping.error("follows", f"is no such sum{reason}; write {would_do}") from None
    if not all(map(math.isfinite, [*total.weights.values(), total.constant])):
        raise mapping.error("follows", f"is not finite; write {would_do}")
    weights = {joint: weight for joint, weight in total.weights.items() if weight}
    if not weights:
        raise mapping.error("follows", f"names no joint; write {would_do}")
    if max(weights) >= size:
        raise mapping.error("follows", f"names q{max(weights) + 1}, but the arm has {size} joints")
    return Following(tuple(Tie(joint, weight) for joint, weight in weights.items()), total.constant)


def _sum(node: ast.expr, constants: Sequence[float]) -> _Sum:
    if isinstance(node, ast.Name):
        name = _COORDINATE.fullmatch(node.id)
        if name is not None:
            return _Sum({int(name[1]) - 1: 1.0})
        if node.id.startswith("_") and node.id[1:].isdecimal() and int(node.id[1:]) < len(constants):
            return _Sum({}, constants[int(node.id[1:])])
        raise ValueError(f"there is no {node.id}")
    if isinstance(node, ast.Constant) and type(node.value) in (int, float):
        return _Sum({}, 0.0, float(cast(float, node.value)))
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.UAdd | ast.USub):
        return _sum(node.operand, constants).scaled(-1.0 if isinstance(node.op, ast.USub) else 1.0)
    if isinstance(node, ast.BinOp):
        return _combined(node.op, _sum(node.left, constants), _sum(node.right, constants))
    raise ValueError(_NO_SUM)


def _combined(operator: ast.operator, left: _Sum, right: _Sum) -> _Sum:
    """Two sums added, or one of them times a number."""
    if isinstance(operator, ast.Add | ast.Sub):
        return left.plus(right.scaled(-1.0 if isinstance(operator, ast.Sub) else 1.0))
    if isinstance(operator, ast.Mult) and (left.number is not None or right.number is not None):
        return right.scaled(left.number) if left.number is not None else left.scaled(right.number or 0.0)
    if isinstance(operator, ast.Div) and right.number is not None:
        return left.scaled(1.0 / right.number)
    raise ValueError(_NO_SUM)


def tied(mapping: Mapping, arm: Arm) -> Arm:
    """The arm with what its joints follow checked and worked out; raises `InputError` where a joint cannot."""
    if all(joint.follows is None for joint in arm.joints):
        return arm
    if arm.angles == "absolute":
        raise mapping.error("angles", "can be absolute only where no joint follows others; write relative")
    joints: list[Joint] = []
    for index, joint in enumerate(arm.joints):
        for tie in () if joint.follows is None else joint.follows.ties:
            if arm.links[tie.joint].runs_out:
                message = (
                    f"names q{tie.joint + 1}, whose link runs out of a sleeve (bends_over): nothing can follow that"
                )
                raise mapping.error(f"chain[{index + 1}].joint.follows", message)
        joints.append(joint if joint.follows is None else _checked(mapping, arm, index, joint, joint.follows))
    return along_links(replace(arm, joints=tuple(joints)))


def along_links(arm: Arm) -> Arm:
    """The arm with whether each coupling runs along the links between (see `Tie.along`), which its axes tell."""
    joints = list(arm.joints)
    q = np.random.default_rng(1).uniform(-2.0, 2.0, (_POSES, arm.size))
    for way in ways(arm):
        placed = place(way.arm, list(q.T[list(way.joints)])).joints
        axes = [np.stack(np.broadcast_arrays(*item.axis, np.zeros(_POSES))[:3]) for item in placed]
        at = dict(zip(way.joints, axes, strict=True))
        for index in way.joints:
            joint = joints[index]
            if joint.follows is not None and joint.revolute:
                ties = tuple(replace(tie, along=_parallel(at[tie.joint], at[index])) for tie in joint.follows.ties)
                joints[index] = replace(joint, follows=replace(joint.follows, ties=ties))
    return replace(arm, joints=tuple(joints))


def _parallel(one: object, other: object) -> bool:
    return bool(np.abs(np.cross(np.asarray(one), np.asarray(other), axis=0)).max() <= _ALONGSIDE)


def _checked(mapping: Mapping, arm: Arm, index: int, joint: Joint, follows: Following) -> Joint:
    given, base, key = _given(mapping, arm, index)
    reason = next(_refusals(arm, index, follows, base), None)
    if reason is not None:
        raise mapping.error(f"{key}.follows", reason)
    follows_itself = any(tie.joint == index for tie in follows.ties)
    ties = tuple(tie for tie in follows.ties if tie.joint != index)
    following = Following(ties, follows.constant, driven=follows_itself)
    if following.driven and not joint.revolute and "range" not in given:
        raise mapping.error(f"{key}.range", "is missing; a slide needs its range, e.g. [0 mm, 1 m]")
    if not following.driven and "range" in given:
        raise mapping.error(f"{key}.range", "comes of the joints that this one follows; leave it out")
    if following.driven:
        return replace(joint, follows=following if ties else None)
    if joint.actuator is not None or joint.counterbalance is not None:
        what = "actuator" if joint.actuator is not None else "balancer"
        raise mapping.error(f"{key}.follows", f"leaves the joint no drive of its own; leave out its {what}")
    return replace(joint, follows=following, range=_reached(arm, following))


def _refusals(arm: Arm, index: int, follows: Following, base: int) -> Iterator[str]:
    """Why a joint (from 0) cannot follow what its file says; `base` is the joint whose coordinate is q1 there."""
    for tie in follows.ties:
        if tie.joint != index:
            continue
        if abs(tie.weight - 1.0) > 1e-12:
            times = f"{tie.weight:g} times; once, or not at all where it only follows"
            yield f"has its own coordinate q{index + 1 - base} {times}"
        if follows.constant:
            yield "has a constant beside its own coordinate; write it as the joint's zero"
    for tie in follows.ties:
        other, name = arm.joints[tie.joint], f"q{tie.joint + 1 - base}"
        if tie.joint == index:
            continue
        if tie.joint > index:
            yield f"names {name}, which comes after it; a joint follows those nearer the base"
        if other.follows is not None and not any(item.joint == tie.joint for item in other.follows.ties):
            yield f"names {name}, which itself only follows; write what that follows"
        if other.revolute != arm.joints[index].revolute:
            yield f"names {name}, which {'turns' if other.revolute else 'slides'} where it does not"


def _given(mapping: Mapping, arm: Arm, index: int) -> tuple[MappingLike[str, object], int, str]:
    """What the file says of a joint (from 0), the number from which its coordinates count there, and its key."""
    for number, branch in enumerate(arm.branches):
        if branch.first <= index < branch.end:
            entry = mapping.mappings("branches")[number].mappings("chain")[index - branch.first]
            key = f"branches[{number + 1}].chain[{index - branch.first + 1}].joint"
            return entry.mapping("joint").content, branch.first, key
    return mapping.mappings("chain")[index].mapping("joint").content, 0, f"chain[{index + 1}].joint"


def _reached(arm: Arm, follows: Following) -> tuple[float, float]:
    """Where a joint that only follows can come, whatever the joints that it follows do."""
    ends = [sorted(tie.weight * end for end in arm.joints[tie.joint].range) for tie in follows.ties]
    return follows.constant + sum(low for low, _ in ends), follows.constant + sum(high for _, high in ends)


def following_text(index: int, joint: Joint, base: int = 0) -> str | None:
    """The expression that an arm file has for what a joint (from 0) follows; None where it follows nothing. `base` is
    the joint whose coordinate is q1 there: the first of its branch."""
    follows = joint.follows
    if follows is None:
        return None
    terms = [(1.0, index)] if follows.driven else []
    terms += [(tie.weight, tie.joint) for tie in follows.ties]
    text = ""
    for weight, other in terms:
        size = "" if abs(weight) == 1.0 else f"{abs(weight)!r}*"
        text += f" {'-' if weight < 0.0 else '+'} {size}q{other + 1 - base}"
    if follows.constant:
        size = format_quantity(abs(follows.constant), "angle" if joint.revolute else "length")
        text += f" {'-' if follows.constant < 0.0 else '+'} {size}"
    text = text.strip()
    return text[2:] if text.startswith("+") else "-" + text[2:]
