"""A chain of a URDF's tree as an arm: frames, limits and weights, and a list of what the arm file still lacks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from arm.chain.balance import PointMass
from arm.chain.chain import Arm, Branch, FloatVector, Joint, Link
from arm.chain.following import Following, Tie
from arm.chain.kinematics import section_directions
from arm.chain.vectors import (
    IDENTITY,
    ZERO,
    about,
    add,
    compose,
    dot,
    norm,
    rotate,
    scale,
    subtract,
    transpose,
    unit,
)
from arm.files.write import arm_to_yaml
from units.quantities import InputError, shown
from units.reading import nearest

from .urdf import NO_STEP, Frame, Mimic, Robot, UrdfJoint, read_urdf

_STANDARD = 9.81
_TURN = (-math.pi, math.pi)
_ENDLESS = 100.0
"""Limits beyond this (rad) are written where there are none."""
_ON_LINE = 1e-12


@dataclass(frozen=True)
class Lacking:
    """Something that the file does not say: `what`, of which joints or links (from 1; none: of all), what it `shows`
    and what to `add` to the arm file."""

    what: str
    at: tuple[int, ...]
    shows: str
    add: str


@dataclass(frozen=True)
class Imported:
    """An arm from another description: which joints and links of it are the arm's, what was decided, what is lacking.

    `joint_names` and `link_names` are those of the file, from the base out; `notes` say what was folded or held.
    """

    arm: Arm
    file: Path
    base: str
    tip: str
    joint_names: tuple[str, ...]
    link_names: tuple[str, ...]
    notes: tuple[str, ...]
    lacking: tuple[Lacking, ...]

    def to_yaml(self) -> str:
        """The arm file, with the names of the description and what is lacking as comments."""
        lines = [f"# From {_one_line(self.file.name)}, {_one_line(self.base)} to {_one_line(self.tip)}."]
        lines += [f"# {_one_line(note)}." for note in self.notes]
        lines += ["#", "# What it does not say:"]
        lines += [f"# - {each.what}{_at(each.at)}: {each.shows}; add {each.add}" for each in self.lacking]
        named = iter(zip(self.joint_names, self.link_names, strict=True))
        number = 0
        for line in arm_to_yaml(self.arm).splitlines():
            if line.lstrip().startswith("- joint:"):
                number += 1
                joint, link = next(named)
                indent = line[: len(line) - len(line.lstrip())]
                lines.append(f"{indent}# joint {number}: {_one_line(joint)}, link {_one_line(link)}")
            lines.append(line)
        return "\n".join(lines) + "\n"


def import_urdf(path: Path | str, *, base: str | None = None, tip: str | Sequence[str] | None = None) -> Imported:
    """The arm from a link `base` (the root by default) to a link `tip` of a URDF file; to several tips, as many arms on
    the torso that they share.

    Raises `InputError` for a file that is no URDF, for a tip that is ambiguous or not beyond the base, for joints on
    the way that an arm cannot have, and for tips that share no joint that moves or part at several places.
    """
    robot = read_urdf(path)
    start = _named(robot, base, "base") if base is not None else robot.root
    tips = [tip] if isinstance(tip, str) else list(tip or ())
    ends = [_named(robot, each, "tip") for each in tips] or [_only_tip(robot, start)]
    if len(set(ends)) < len(ends):
        raise InputError(robot.file, "tip", "names a link twice; name each tip once")
    chains = [_way(robot, start, end) for end in ends]
    if len(ends) == 1:
        return _Import(robot, start, ends[0], chains[0]).made()
    return _several(robot, start, ends, chains)


def _several(robot: Robot, start: str, ends: Sequence[str], chains: Sequence[Sequence[UrdfJoint]]) -> Imported:
    """Several arms on one torso: each way read by itself, without the weights of the others, and put together."""
    moving = [[joint.name for joint in chain if joint.kind != "fixed"] for chain in chains]
    ways: list[Imported] = []
    for number, chain in enumerate(chains):
        beyond = {name for k, names in enumerate(moving) if k != number for name in names}
        ways.append(_Import(robot, start, ends[number], list(chain), frozenset(beyond)).made())
    shared = _shared(robot, ends, [way.joint_names for way in ways])
    first = ways[0].arm
    joints, links = list(first.joints), list(first.links)
    foot = scale(first.links[shared - 1].length, first.links[shared - 1].direction)
    numbers = [list(range(first.size))]
    branches = [Branch(_branch_name(ends[0], ()), shared, first.size, first.tool)]
    for end, way in zip(ends[1:], ways[1:], strict=True):
        at, own = len(joints), way.arm
        places = {k: at + k - shared for k in range(shared, own.size)}
        onward = own.links[shared - 1]
        standing = subtract(scale(onward.length, onward.direction), foot)
        for k in range(shared, own.size):
            joint = own.joints[k]
            if k == shared:
                joint = replace(joint, origin_translation=_plain(standing))
            if joint.follows is not None:
                if joint.follows.ties[0].joint < shared:
                    _refuse_torso(robot, way.joint_names[k])
                joint = replace(joint, follows=joint.follows.moved(places))
            joints.append(joint)
            links.append(own.links[k])
        numbers.append([*range(shared), *places.values()])
        branches.append(
            Branch(_branch_name(end, [each.name for each in branches]), at, len(joints), own.tool, away=1.0)
        )
    for k in range(shared, first.size):
        if (follows := first.joints[k].follows) is not None and follows.ties[0].joint < shared:
            _refuse_torso(robot, ways[0].joint_names[k])
    arm = replace(first, joints=tuple(joints), links=tuple(links), branches=tuple(branches), every_tip=True)
    names = [(way.joint_names, way.link_names) for way in ways]
    return Imported(
        arm,
        robot.file,
        start,
        ", ".join(ends),
        (*names[0][0], *(name for own, _ in names[1:] for name in own[shared:])),
        (*names[0][1], *(name for _, own in names[1:] for name in own[shared:])),
        tuple(dict.fromkeys(note for way in ways for note in way.notes)),
        _together([way.lacking for way in ways], numbers),
    )


def _shared(robot: Robot, ends: Sequence[str], names: Sequence[Sequence[str]]) -> int:
    """How many joints several ways have in common, all of them the same; raises `InputError` for none, and for more."""
    count = 0
    while all(len(own) > count + 1 for own in names) and len({own[count] for own in names}) == 1:
        count += 1
    listed = ", ".join(map(shown, ends))
    if not count:
        message = f"{listed} share no joint that moves, so that none loads another; import each by itself"
        raise InputError(robot.file, "tip", message)
    if len({own[count] for own in names}) < len(names):
        raise InputError(robot.file, "tip", f"{listed} part at several places; name tips that part at one")
    return count


def _refuse_torso(robot: Robot, name: str) -> None:
    message = "mimics a joint that its arm shares with others, which no branch can; import its arm by itself"
    raise robot.joints[name].element.error(message)


def _branch_name(link: str, taken: Sequence[str]) -> str:
    """A branch's name, which begins columns: letters and digits of the link's."""
    plain = "".join(c if c.isascii() and c.isalnum() else "_" for c in link).strip("_")
    plain = plain if plain[:1].isalpha() else f"arm_{plain}"
    return plain if plain not in taken else f"{plain}_{len(taken) + 1}"


def _together(each: Sequence[Sequence[Lacking]], numbers: Sequence[Sequence[int]]) -> tuple[Lacking, ...]:
    """What several ways lack, said once, with the numbers of joints and links in the whole arm."""
    found: dict[tuple[str, str], Lacking] = {}
    for own, places in zip(each, numbers, strict=True):
        for one in own:
            at = tuple(places[number - 1] + 1 for number in one.at)
            before = found.get((one.what, one.shows))
            merged = at if before is None else tuple(sorted({*before.at, *at}))
            found[one.what, one.shows] = replace(one, at=merged)
    return tuple(found.values())


def _one_line(text: str) -> str:
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())


def _at(places: tuple[int, ...]) -> str:
    return f" ({', '.join(map(str, places))})" if places else ""


def _named(robot: Robot, name: str, option: str) -> str:
    if name not in robot.links:
        raise InputError(robot.file, option, f"there is no link {shown(name)}{nearest(name, list(robot.links))}")
    return name


def _way(robot: Robot, start: str, end: str) -> list[UrdfJoint]:
    """The joints from one link out to another."""
    found: list[UrdfJoint] = []
    here = end
    while here != start:
        joint = robot.above.get(here)
        if joint is None:
            raise InputError(robot.file, "tip", f"link {shown(end)} is not beyond {shown(start)}; name another --base")
        found.append(joint)
        here = joint.parent
    return found[::-1]


def _only_tip(robot: Robot, start: str) -> str:
    """The only end of the tree that joints move. Raises `InputError` with all of them where there are several."""
    ends: list[tuple[str, int]] = []
    ways: list[list[str]] = []
    pending = [([start], 0)]
    while pending:
        way, moving = pending.pop()
        onward = robot.below[way[-1]]
        if not onward and moving:
            ends.append((way[-1], moving))
            ways.append(way)
        pending += [([*way, joint.child], moving + joint.moves) for joint in onward]
    if not ends:
        raise InputError(robot.file, "", f"no joint beyond {shown(start)} moves; an arm has at least one that does")
    if len(ends) > 1:
        listed = sorted(ends, key=lambda each: (-each[1], each[0]))
        words = ", ".join(f"{name} ({count} joint{'s' if count > 1 else ''})" for name, count in listed[:12])
        more = f" and {len(listed) - 12} more" if len(listed) > 12 else ""
        example = next((name for name, _ in listed if (body := robot.links[name]) is None or body.mass == 0.0), None)
        parting = [names[0] for names in zip(*ways, strict=False) if len(set(names)) == 1][-1]
        if example is None and any(joint.moves for joint in _way(robot, start, parting)):
            example = f"{parting}, where they part"  # an arm with a gripper's fingers
        message = f"has {len(ends)} ends: {words}{more}; name one, e.g. --tip {example or listed[0][0]}"
        raise InputError(robot.file, "tip", message)
    return ends[0][0]


def after(first: Frame, second: Frame) -> Frame:
    """Where a frame stands that stands at `second` in a frame that stands at `first`."""
    return compose(first[0], second[0]), add(first[1], rotate(first[0], second[1]))


@dataclass
class _Body:
    """What moves as one: its frame stands at its joint; masses (kg, place in m), and what its links are called."""

    joint: UrdfJoint
    origin: Frame
    masses: list[tuple[float, FloatVector]]
    end: Frame = NO_STEP
    flange: Frame | None = None
    weighed: bool = False


@dataclass
class _Import:
    """The work of one import."""

    robot: Robot
    start: str
    end: str
    chain: list[UrdfJoint]
    beyond: frozenset[str] = frozenset()
    """Joints of other arms, whose weights are theirs."""

    def __post_init__(self) -> None:
        self.notes: list[str] = []
        self.folded: list[str] = []
        self.held: list[str] = []

    def made(self) -> Imported:
        bodies = self._bodies()
        if not bodies:
            message = f"no joint between {shown(self.start)} and {shown(self.end)} moves; name another --tip"
            raise InputError(self.robot.file, "tip", message)
        joints, links = [], []
        for index, body in enumerate(bodies):
            joint = _joint(body, first=index == 0)
            if body.joint.mimic is not None:
                joint = self._following(body.joint, body.joint.mimic, joint, bodies[:index], joints)
            joints.append(joint)
            last = index + 1 == len(bodies)
            links.append(_link(body, joints[-1], body.flange or body.end if last else bodies[index + 1].origin, last))
        tool = ZERO
        last = bodies[-1]
        if last.flange is not None:
            tool = rotate(transpose(last.end[0]), subtract(last.end[1], last.flange[1]))
        arm = Arm(
            name=_one_line(self.robot.name) or "arm",
            joints=tuple(joints),
            links=tuple(links),
            gravity=self._gravity(),
            tool=tool,
        )
        if self.folded:
            self.notes.insert(0, f"Fixed joints are folded into frames and tool: {', '.join(self.folded)}")
        if self.held:
            told = "Joints that do not lead to the tip stand at 0, their weight counts"
            self.notes.append(f"{told}: {', '.join(self.held)}")
        return Imported(
            arm,
            self.robot.file,
            self.start,
            self.end,
            tuple(body.joint.name for body in bodies),
            tuple(body.joint.child for body in bodies),
            tuple(self.notes),
            self._lacking(bodies),
        )

    def _following(
        self, urdf: UrdfJoint, mimic: Mimic, joint: Joint, bodies: list[_Body], joints: list[Joint]
    ) -> Joint:
        """A joint that mimics one nearer the base; of one that itself mimics, what that follows."""
        leader = next((k for k, body in enumerate(bodies) if body.joint.name == mimic.joint), None)
        if leader is None:
            would_do = "take the mimic out, or name a --base and a --tip with both on the way"
            message = f"mimics {shown(mimic.joint)}, which does not lead to it from the base"
            raise urdf.element.error(f"{message}; {would_do}")
        if joints[leader].revolute != joint.revolute:
            raise urdf.element.error(f"mimics {shown(mimic.joint)}, but one of them turns and the other slides")
        if mimic.multiplier == 0.0:
            raise urdf.element.error("mimics with a multiplier of 0; make it fixed")
        tie, constant = Tie(leader, mimic.multiplier), mimic.offset
        if (above := joints[leader].follows) is not None:
            tie = Tie(above.ties[0].joint, mimic.multiplier * above.ties[0].weight)
            constant = mimic.offset + mimic.multiplier * above.constant
        ends = sorted(tie.weight * end + constant for end in joints[tie.joint].range)
        self.notes.append(f"Joint {urdf.name} mimics {mimic.joint} and has no drive of its own")
        return replace(joint, follows=Following((tie,), constant), range=(ends[0], ends[1]))

    def _bodies(self) -> list[_Body]:
        found: list[_Body] = []
        step = NO_STEP
        on_way = {joint.name for joint in self.chain} | self.beyond
        for joint in self.chain:
            step = after(step, joint.origin)
            value = self._standing(joint)
            if value is None:
                if found:
                    found[-1].end = step
                found.append(_Body(joint, step, []))
                step = NO_STEP
            else:
                step = after(step, _moved(joint, value))
            if found:
                self._weigh(found[-1], joint.child, step, on_way)
                body = found[-1]
                if value is not None and body.flange is None and norm(step[1]) > 0.0:
                    body.flange = step
        if found:
            found[-1].end = step
        return found

    def _standing(self, joint: UrdfJoint) -> float | None:
        """The coordinate of a joint on the way that does not move; None of one that does."""
        if joint.kind == "fixed":
            self.folded.append(joint.name)
            return 0.0
        if not joint.moves:
            raise joint.element.error(f"is {joint.kind}; an arm has revolute, continuous and prismatic joints")
        if joint.mimic is not None:
            return None
        if joint.limits is not None and joint.kind != "continuous" and joint.limits.lower == joint.limits.upper:
            self.notes.append(f"Joint {joint.name} has lower = upper and is held there")
            return joint.limits.lower
        return None

    def _weigh(self, body: _Body, link: str, step: Frame, on_way: set[str]) -> None:
        """The masses of a link and of all that hangs on it beside the way to the tip."""
        pending = [(link, step)]
        while pending:
            name, frame = pending.pop()
            inertial = self.robot.links[name]
            if inertial is not None and inertial.mass > 0.0:
                body.masses.append((inertial.mass, after(frame, (IDENTITY, inertial.center))[1]))
            for joint in self.robot.below[name]:
                if joint.name in on_way:
                    continue
                value = 0.0
                if joint.moves:
                    value = 0.0 if joint.mimic is None else joint.mimic.offset
                if joint.kind != "fixed":
                    self.held.append(joint.name)
                pending.append((joint.child, after(after(frame, joint.origin), _moved(joint, value))))

    def _gravity(self) -> FloatVector:
        """Down along z of the root, all joints before the base at 0."""
        turned = IDENTITY
        before = _way(self.robot, self.robot.root, self.start)
        for joint in before:
            turned = compose(turned, joint.origin[0])
        if any(joint.kind != "fixed" for joint in before):
            self.notes.append("Gravity is that with all joints before the base at 0")
        x, y, z = rotate(transpose(turned), (0.0, 0.0, -_STANDARD))
        return (x + 0.0, y + 0.0, z + 0.0)

    def _lacking(self, bodies: list[_Body]) -> tuple[Lacking, ...]:
        def places(chosen: list[bool]) -> tuple[int, ...]:
            return tuple(number for number, each in enumerate(chosen, start=1) if each)

        found = [
            Lacking(
                "stiffness of the drives",
                (),
                "how far the arm droops under load",
                "joint: stiffness: 12 kN*m/rad, or joint: actuator: a name of `linkwright actuators list`",
            ),
            Lacking("backlash", (), "lost motion on reversal", "joint: backlash: 3 arcmin"),
            Lacking("play of the bearings", (), "lost motion across the axes", "joint: clearance: 0.02 mm"),
            Lacking(
                "sections and materials",
                (),
                "bending, strength, frequencies, and what `optimize` chooses",
                "link: section and material in place of rigid, mass and masses",
            ),
            Lacking(
                "repeatability and tolerances",
                (),
                "what arms of this make differ by",
                "a data sheet: linkwright budget ARM --sheet sheet.yaml",
            ),
            Lacking("payload", (), "what it carries", "payload: {mass: 2 kg}"),
        ]
        if any(massless := [not body.masses for body in bodies]):
            words = "their weight in droop and torques", "link: mass: 1.2 kg"
            found.append(Lacking("mass of links", places(massless), *words))
        if any(endless := [_range(body.joint) is _TURN for body in bodies]):
            words = "the range of the joint, now one turn", "joint: range: [-360 deg, 360 deg]"
            found.append(Lacking("limits", places(endless), *words))
        if any(rubbed := [body.joint.friction > 0.0 for body in bodies]):
            figures = ", ".join(f"{body.joint.friction:g}" for body in bodies if body.joint.friction > 0.0)
            words = f"the file's friction ({figures} N*m or N) winds drives up", "effects: friction_windup"
            found.append(Lacking("what friction does", places(rubbed), *words))
        limits = [body.joint.limits for body in bodies]
        known = [each is not None and each.effort is not None and each.effort > 0.0 for each in limits]
        if any(known):
            figures = ", ".join(f"{each.effort:g}" for each in limits if each is not None and each.effort)
            words = f"the file's efforts ({figures} N*m or N) limit no design", "joint: actuator"
            found.append(Lacking("rated torques", places(known), *words))
        return tuple(found)


def _moved(joint: UrdfJoint, value: float) -> Frame:
    """The step of a joint at a coordinate."""
    if value == 0.0 or not joint.moves:
        return NO_STEP
    if joint.kind == "prismatic":
        return IDENTITY, scale(value, joint.axis)
    return about(joint.axis, math.cos(value), math.sin(value)), ZERO


def _range(joint: UrdfJoint) -> tuple[float, float]:
    limits = joint.limits
    if limits is None or joint.kind == "continuous":
        return _TURN
    if joint.kind == "revolute" and max(-limits.lower, limits.upper) > _ENDLESS:
        return _TURN
    if not (math.isfinite(limits.lower) and math.isfinite(limits.upper)):
        raise joint.element.error("has no finite limits; write how far it slides (m)")
    return limits.lower, limits.upper


def _joint(body: _Body, *, first: bool) -> Joint:
    """The joint; where it stands is told by the link before, but for the first."""
    slides = body.joint.kind == "prismatic"
    return Joint(
        type="prismatic" if slides else "revolute",
        axis=body.joint.axis,
        range=_range(body.joint),
        origin_rotation=body.origin[0],
        origin_translation=body.origin[1] if first else ZERO,
    )


def _link(body: _Body, joint: Joint, onward: Frame, last: bool) -> Link:
    """The link from its joint to the next, or to the flange; rigid, with the weights that it carries."""
    vector = onward[1]
    length = norm(vector)
    link = Link(length, direction=unit(vector) if length > 0.0 else (1.0, 0.0, 0.0), mass=0.0)
    if last:
        link = replace(link, end_rotation=body.end[0])
    if not body.masses:
        return link
    total = sum(mass for mass, _ in body.masses)
    center = ZERO
    for mass, place in body.masses:
        center = add(center, scale(mass / total, place))
    along: FloatVector = link.direction
    height, width = section_directions(link, joint)
    at = (float(dot(center, along)), float(dot(center, height)), float(dot(center, width)))
    if math.hypot(at[1], at[2]) < _ON_LINE and 0.0 <= at[0] <= length:
        return replace(link, mass=total, center_of_mass=at[0])
    return replace(link, masses=(PointMass(total, _plain(at)),))


def _plain(at: FloatVector) -> FloatVector:
    x, y, z = (0.0 if abs(value) < _ON_LINE else value for value in at)
    return (x, y, z)
