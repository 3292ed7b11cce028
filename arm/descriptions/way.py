"""One way through a robot's tree, from a base to a tip, as an arm."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np

from linkwright.core.arm.bodies.bodies import Mass, together
from linkwright.core.arm.chain.balance import PointMass
from linkwright.core.arm.chain.chain import Arm, EffectEntry, FloatVector, Joint, Link
from linkwright.core.arm.chain.following import Following, Tie
from linkwright.core.arm.chain.kinematics import section_directions
from linkwright.core.arm.chain.vectors import (
    IDENTITY,
    ZERO,
    about,
    compose,
    dot,
    norm,
    rotate,
    scale,
    subtract,
    transpose,
    unit,
)
from linkwright.core.arm.effects.drives.armature import ARMATURE
from linkwright.core.arm.effects.drives.spring import SPRING
from linkwright.core.arm.effects.effect import Effect
from linkwright.core.arm.effects.friction.friction_coulomb import FRICTION_COULOMB
from linkwright.core.arm.effects.friction.friction_viscous import FRICTION_VISCOUS
from linkwright.core.units.quantities import InputError, shown

from .imported_arm import Imported, Lacking, one_line
from .plausible import doubts_of
from .reading.tree import NO_STEP, Frame, Mimic, Robot, TreeJoint, onward

_TURN = (-math.pi, math.pi)
_ENDLESS = 100.0
"""Limits beyond this (rad) are written where there are none."""
_ON_LINE = 1e-12
_ACROSS = 0.5
"""Of a link's length, what lies across it at most where the link is taken along its longest axis."""
INERTIAL = '<inertial pos="0.1 0 0" mass="1.2" diaginertia="0.01 0.01 0.01"/>'
"""What an MJCF says of a body's weight, say."""
_OF_A_DRIVE = (
    ("friction", "friction", "N*m or N"),
    ("damping", "damping", "N*m*s/rad or N*s/m"),
    ("armature", "armature", "kg*m^2 or kg"),
    ("springs", "stiffness", "N*m/rad or N/m"),
)
_OF_A_JOINT = ("origin", "parent", "child", "axis", "limit", "mimic", "dynamics")


def way_to(robot: Robot, start: str, end: str) -> list[TreeJoint]:
    """The joints from one link out to another."""
    joints: list[TreeJoint] = []
    here = end
    while here != start:
        joint = robot.above.get(here)
        if joint is None:
            raise InputError(robot.file, "tip", f"link {shown(end)} is not beyond {shown(start)}; name another --base")
        joints.append(joint)
        here = joint.parent
    return joints[::-1]


@dataclass
class Body:
    """What moves as one: its frame stands at its joint, `links` are those of the file that are rigid with it, each
    where it stands. `masses` are what they weigh, in the body's frame."""

    joint: TreeJoint
    origin: Frame
    masses: list[Mass] = field(default_factory=list[Mass])
    end: Frame = NO_STEP
    flange: Frame | None = None
    links: list[tuple[str, Frame]] = field(default_factory=list[tuple[str, Frame]])
    without_inertia: list[str] = field(default_factory=list[str])
    unplaced: float = 0.0
    """kg; what of it weighs so much nobody knows where."""
    beside: FloatVector = ZERO
    """Where its joint stands beside the end of the link before, m."""

    @property
    def whole(self) -> Mass | None:
        """All of it as one mass; None where the file says nothing of its weight."""
        return together(self.masses)


@dataclass
class Way:
    """The work of one import: a `chain` of joints from the link `start` to the link `end`."""

    robot: Robot
    start: str
    end: str
    chain: list[TreeJoint]
    beyond: frozenset[str] = frozenset()
    """Joints of other arms, whose weights are theirs."""

    def __post_init__(self) -> None:
        self.notes: list[str] = []
        self.folded: list[str] = []
        self.held: list[str] = []

    def made(self) -> Imported:
        """The arm of this way."""
        bodies = self._bodies()
        if not bodies:
            message = f"no joint between {shown(self.start)} and {shown(self.end)} moves; name another --tip"
            raise InputError(self.robot.file, "tip", message)
        unknown, askew = self._unknown(bodies), list[str]()
        joints: list[Joint] = []
        links: list[Link] = []
        for index, body in enumerate(bodies):
            joint = _joint(body, first=index == 0)
            if body.joint.mimic is not None:
                joint = self._following(body.joint, body.joint.mimic, joint, bodies[:index], joints)
            joints.append(joint)
            last = index + 1 == len(bodies)
            onward = body.flange or body.end if last else bodies[index + 1].origin
            if not last:
                onward, rest = _straight(onward)
                bodies[index + 1].beside = rest
                askew += [_askew(body, onward, rest)] if norm(rest) > 0.0 else []
            if body.unplaced:
                body.masses.append(Mass(body.unplaced, 0.5 * np.array(onward[1], dtype=float), np.zeros((3, 3))))
                body.without_inertia.append(body.joint.child)
            links.append(_link(body, joint, onward, last=last, unknown=index in unknown))
        tool = ZERO
        last = bodies[-1]
        if last.flange is not None:
            tool = rotate(transpose(last.end[0]), subtract(last.end[1], last.flange[1]))
        arm = Arm(
            name=one_line(self.robot.name) or "arm",
            joints=tuple(joints),
            links=tuple(links),
            gravity=self._gravity(),
            tool=tool,
            effects=_effects(bodies),
        )
        if self.folded:
            self.notes.insert(0, f"Fixed joints are folded into frames and tool: {', '.join(self.folded)}")
        if askew:
            note = "Links run along their longest axis, the rest is the origin of the next joint"
            self.notes.append(f"{note}: {'; '.join(askew)}")
        if twice := [joint.name for joint in self.chain if len(list(joint.element.all("origin"))) > 1]:
            self.notes.append(f"Of several origins of one joint the first counts, as in ROS: {', '.join(twice)}")
        if self.held:
            note = "Joints that do not lead to the tip stand at 0, their weight counts"
            self.notes.append(f"{note}: {', '.join(self.held)}")
        return Imported(
            arm,
            self.robot.file,
            self.start,
            self.end,
            tuple(body.joint.name for body in bodies),
            tuple(body.joint.child for body in bodies),
            (*self.notes, *(meshes := tuple(self._unread(bodies, unknown)))),
            self._lacking(bodies, unknown),
            self._lost(bodies),
            doubts_of(self.robot, [(body.links, body.whole) for body in bodies], arm.lengths),
            meshes,
        )

    def _unread(self, bodies: list[Body], unknown: frozenset[int]) -> Iterator[str]:
        """What stands for the weights of links whose meshes are not there, and what to write."""
        for index, body in enumerate(bodies):
            for name, _ in body.links:
                link = self.robot.links[name]
                if not link.unread:
                    continue
                stands = f"is {link.unplaced:.6g} kg as the file has it, and counts at the middle of link {index + 1}"
                stands = "is unknown" if index in unknown else stands
                lead = f"Not there as a closed STL: {', '.join(dict.fromkeys(link.unread))}"
                yield f"{lead}. The weight of {name} {stands}; write {INERTIAL} into body {name}"

    def _following(self, urdf: TreeJoint, mimic: Mimic, joint: Joint, bodies: list[Body], joints: list[Joint]) -> Joint:
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

    def _bodies(self) -> list[Body]:
        bodies: list[Body] = []
        step = NO_STEP
        on_way = {joint.name for joint in self.chain} | self.beyond
        for joint in self.chain:
            step = onward(step, joint.origin)
            value = self._standing(joint)
            if value is None:
                if bodies:
                    bodies[-1].end = step
                bodies.append(Body(joint, step))
                step = NO_STEP
            else:
                step = onward(step, _moved(joint, value))
            if bodies:
                self._weigh(bodies[-1], joint.child, step, on_way)
                body = bodies[-1]
                if value is not None and body.flange is None and norm(step[1]) > 0.0:
                    body.flange = step
        if bodies:
            bodies[-1].end = step
        return bodies

    def _standing(self, joint: TreeJoint) -> float | None:
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

    def _weigh(self, body: Body, link: str, step: Frame, on_way: set[str]) -> None:
        """The masses of a link and of all that hangs on it beside the way to the tip."""
        pending = [(link, step)]
        while pending:
            name, frame = pending.pop()
            body.links.append((name, frame))
            inertial = self.robot.links[name].inertial
            body.unplaced += self.robot.links[name].unplaced
            if inertial is not None and inertial.mass > 0.0:
                place, axes = onward(frame, (IDENTITY, inertial.center))[1], np.array(frame[0], dtype=float)
                inertia = np.zeros((3, 3)) if inertial.inertia is None else axes @ inertial.inertia @ axes.T
                body.masses.append(Mass(inertial.mass, np.array(place, dtype=float), inertia))
                if inertial.inertia is None:
                    body.without_inertia.append(name)
            for joint in self.robot.below[name]:
                if joint.name in on_way:
                    continue
                value = 0.0
                if joint.moves:
                    value = 0.0 if joint.mimic is None else joint.mimic.offset
                if joint.kind != "fixed":
                    self.held.append(joint.name)
                pending.append((joint.child, onward(onward(frame, joint.origin), _moved(joint, value))))

    def _gravity(self) -> FloatVector:
        """As it is at the root, all joints before the base at 0."""
        turned = IDENTITY
        before = way_to(self.robot, self.robot.root, self.start)
        for joint in before:
            turned = compose(turned, joint.origin[0])
        if any(joint.kind != "fixed" for joint in before):
            self.notes.append("Gravity is that with all joints before the base at 0")
        x, y, z = rotate(transpose(turned), self.robot.gravity)
        return (x + 0.0, y + 0.0, z + 0.0)

    def _unknown(self, bodies: list[Body]) -> frozenset[int]:
        """The bodies (from 0) whose weight the file does not say. One that it draws by nothing, while it draws others
        and weighs some, is a mere frame between two joints and weighs nothing."""
        drawn = [any(self.robot.links[name].shapes for name, _ in body.links) for body in bodies]
        frames = any(drawn) and any(body.masses for body in bodies)
        unknown: list[int] = []
        for index, body in enumerate(bodies):
            weighed = [self.robot.links[name].weighed for name, _ in body.links]
            said = bool(body.masses) or body.unplaced > 0.0 or (frames and not drawn[index]) or all(weighed)
            unknown += [index] if False in weighed or not said else []
        return frozenset(unknown)

    def _lost(self, bodies: list[Body]) -> tuple[str, ...]:
        """What of the file an arm file has no place for."""
        return (*self._lost_of_bodies(bodies), *self._lost_names(bodies))

    def _lost_of_bodies(self, bodies: list[Body]) -> Iterator[str]:
        pictured = [name for body in bodies for name, _ in body.links if self.robot.links[name].shapes]
        if pictured:
            yield f"what links are drawn by and collide with ({len(pictured)} links)"
        resting = {joint.parent for joint in self.chain[: self.chain.index(bodies[0].joint) + 1]}
        if weight := sum(self.robot.links[name].mass for name in resting):
            yield f"the weight of what stands still ({', '.join(sorted(resting))}: {weight:.6g} kg)"
        lost = [(number, body.joint) for number, body in enumerate(bodies, 1) if not _held(body.joint)]
        for name, attribute, units in _OF_A_DRIVE:
            values = [(number, float(getattr(joint, attribute))) for number, joint in lost]
            if listed := [f"joint {number}: {value:g}" for number, value in values if value]:
                yield f"{name} ({', '.join(listed)} {units})"
        endless = [str(number) for number, body in enumerate(bodies, 1) if body.joint.kind == "continuous"]
        if endless:
            yield f"that joints turn without end (joint {', '.join(endless)}): they have one turn"

    def _lost_names(self, bodies: list[Body]) -> Iterator[str]:
        folded = [name for body in bodies for name, _ in body.links if name not in (body.joint.child, self.end)]
        if folded:
            yield f"names of links that are rigid with others ({', '.join(folded)})"
        ends = [
            f"{name}, as `{usual_name}`"
            for name, usual_name in ((self.start, "base"), (self.end, "tip"))
            if name != usual_name
        ]
        if ends:
            yield f"names of the base and the tip in exports ({'; '.join(ends)})"
        tags = [child.tag for joint in self.robot.joints.values() for child in joint.element.children]
        tags_lost = [tag for tag in (*tags, *self.robot.beside) if tag not in _OF_A_JOINT]
        tags_lost += [tag for link in self.robot.links.values() for tag in link.beside]
        if tags_lost:
            yield f"what the tags {', '.join(dict.fromkeys(tags_lost))} say"

    def _lacking(self, bodies: list[Body], unknown: frozenset[int]) -> tuple[Lacking, ...]:
        def places(chosen: list[bool]) -> tuple[int, ...]:
            return tuple(number for number, item in enumerate(chosen, start=1) if item)

        lacking = [
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
        if unknown:
            words = "their weight in droop, torques and exports", "link: mass: 1.2 kg in place of unknown"
            lacking.append(Lacking("mass of links", tuple(sorted(index + 1 for index in unknown)), *words))
        if any(light := [bool(body.without_inertia) for body in bodies]):
            words = "how they turn in simulators", "link: inertia: {xx: 0.02 kg*m^2, yy: ..., zz: ...}"
            lacking.append(Lacking("inertia of links", places(light), *words))
        if any(endless := [_range(body.joint) is _TURN for body in bodies]):
            words = "the range of the joint, now one turn", "joint: range: [-360 deg, 360 deg]"
            lacking.append(Lacking("limits", places(endless), *words))
        if any(rubbed := [body.joint.friction > 0.0 for body in bodies]):
            figures = ", ".join(f"{body.joint.friction:g}" for body in bodies if body.joint.friction > 0.0)
            words = f"the file's friction ({figures} N*m or N) winds drives up", "effects: friction_windup"
            lacking.append(Lacking("what friction does", places(rubbed), *words))
        limits = [body.joint.limits for body in bodies]
        known = [limit is not None and limit.effort is not None and limit.effort > 0.0 for limit in limits]
        if any(known):
            figures = ", ".join(f"{limit.effort:g}" for limit in limits if limit is not None and limit.effort)
            words = f"the file's efforts ({figures} N*m or N) limit no design", "joint: actuator"
            lacking.append(Lacking("rated torques", places(known), *words))
        return tuple(lacking)


def _moved(joint: TreeJoint, value: float) -> Frame:
    if value == 0.0 or not joint.moves:
        return NO_STEP
    if joint.kind == "prismatic":
        return IDENTITY, scale(value, joint.axis)
    return about(joint.axis, math.cos(value), math.sin(value)), ZERO


def _range(joint: TreeJoint) -> tuple[float, float]:
    limits = joint.limits
    if limits is None or joint.kind == "continuous":
        return _TURN
    if joint.kind == "revolute" and max(-limits.lower, limits.upper) > _ENDLESS:
        return _TURN
    if not (math.isfinite(limits.lower) and math.isfinite(limits.upper)):
        raise joint.element.error("has no finite limits; write how far it slides (m)")
    return limits.lower, limits.upper


def _joint(body: Body, *, first: bool) -> Joint:
    """The joint; where it stands is told by the link before, but for the first and what is beside that link."""
    slides = body.joint.kind == "prismatic"
    return Joint(
        type="prismatic" if slides else "revolute",
        axis=body.joint.axis,
        range=_range(body.joint),
        origin_rotation=body.origin[0],
        origin_translation=body.origin[1] if first else body.beside,
        name=one_line(body.joint.name),
        effort=_known(None if body.joint.limits is None else body.joint.limits.effort),
        velocity=_known(None if body.joint.limits is None else body.joint.limits.velocity),
    )


def _joint_entries(joint: TreeJoint) -> tuple[tuple[Effect, Mapping[str, float]], ...]:
    """What a joint's drive has of its own, as effects with their parameters."""
    return (
        (FRICTION_COULOMB, {"torque": joint.friction}),
        (FRICTION_VISCOUS, {"coefficient": joint.damping}),
        (ARMATURE, {"inertia": joint.armature}),
        (SPRING, {"stiffness": joint.stiffness, "rest": joint.rest}),
    )


def _held(joint: TreeJoint) -> bool:
    """Whether an arm file holds them: of a joint with a separate drive, where they are finite."""
    values = [next(iter(parameters.values())) for _, parameters in _joint_entries(joint)]
    return joint.mimic is None and all(0.0 <= value < math.inf for value in values)


def _effects(bodies: list[Body]) -> tuple[EffectEntry, ...]:
    """What the joints have of their own, each joint by itself: what is found of one adds to it."""
    return tuple(
        EffectEntry(effect.id, (number,), MappingProxyType(dict(parameters)))
        for number, body in enumerate(bodies, start=1)
        for effect, parameters in _joint_entries(body.joint)
        if next(iter(parameters.values())) > 0.0 and _held(body.joint)
    )


def _straight(onward: Frame) -> tuple[Frame, FloatVector]:
    """A step to the next joint along its longest axis, as links are built, and the rest of it (m). Where the rest is
    more than half of that, the link is taken to be askew: there is no rest."""
    vector = onward[1]
    along = max(range(3), key=lambda axis: abs(vector[axis]))
    x, y, z = (0.0 if axis == along else value for axis, value in enumerate(vector))
    rest = (x, y, z)
    if not norm(rest) <= _ACROSS * abs(vector[along]):
        return onward, ZERO
    return (onward[0], subtract(vector, rest)), plain(rest)


def _askew(body: Body, onward: Frame, rest: FloatVector) -> str:
    """A link's length and the rest, in mm."""
    across = ", ".join(f"{1e3 * value:.4g}" for value in rest)
    return f"{body.joint.child} ({1e3 * norm(onward[1]):.4g} mm, rest {across} mm)"


def _known(greatest: float | None) -> float | None:
    """The most that a drive gives; nothing where the file has what stands for nothing."""
    return greatest if greatest is not None and math.isfinite(greatest) and greatest > 0.0 else None


def _link(body: Body, joint: Joint, onward: Frame, *, last: bool, unknown: bool) -> Link:
    """The link from its joint to the next, or to the flange; rigid, with the weights that it carries."""
    vector = onward[1]
    length = norm(vector)
    direction = unit(vector) if length > 0.0 else (1.0, 0.0, 0.0)
    link = Link(length, direction=direction, mass=None if unknown else 0.0, name=one_line(body.joint.child))
    if last:
        link = replace(link, end_rotation=body.end[0])
    whole = body.whole
    if whole is None or unknown:
        return link
    if len(body.without_inertia) < len(body.masses):
        least = max(_ON_LINE * float(np.abs(whole.inertia).max()), whole.mass * _ON_LINE**2)
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = np.where(np.abs(whole.inertia) < least, 0.0, whole.inertia).tolist()
        link = replace(link, inertia=(xx, yy, zz, xy, xz, yz))
    center: FloatVector = (float(whole.center[0]), float(whole.center[1]), float(whole.center[2]))
    along: FloatVector = link.direction
    height, width = section_directions(link, joint)
    at = (float(dot(center, along)), float(dot(center, height)), float(dot(center, width)))
    if math.hypot(at[1], at[2]) < _ON_LINE and 0.0 <= at[0] <= length:
        return replace(link, mass=whole.mass, center_of_mass=at[0])
    return replace(link, masses=(PointMass(whole.mass, plain(at)),))


def plain(at: FloatVector) -> FloatVector:
    """A vector without what rounding leaves of zero."""
    x, y, z = (0.0 if abs(value) < _ON_LINE else value for value in at)
    return (x, y, z)
