"""An arm as the rigid pieces that other programs put together: frames, masses, drives and, where asked for, springs.

An elastic link becomes two pieces with springs at its middle: there the compliance of a uniform cantilever's end is
diagonal, EI/L against turning and 12 EI/L^3 across (with shear, stretch and torsion in series), so that forces and
moments at its end bend it exactly as the beam. Half of its weight acts at 5/6 of its length and half at 1/6, which
bends it as its spread weight does (deflection w L^4/8EI, slope w L^3/6EI).

A URDF is read back and held beside the arm that was meant.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np

from linkwright.core.arm.bodies.bodies import Mass, link_axes, link_before, masses_on_link, negative_moment, together
from linkwright.core.arm.chain.beam import Beam
from linkwright.core.arm.chain.chain import Arm, FloatVector, Joint, Link
from linkwright.core.arm.chain.following import completed, ties_to
from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.arm.chain.vectors import IDENTITY, ZERO, about, add, compose, norm, rotate, scale, unit
from linkwright.core.arm.descriptions.imported import import_robot
from linkwright.core.arm.descriptions.in_motion import Format, added_parameters, effects_in_motion, heavier
from linkwright.core.arm.descriptions.names import Names, names_of
from linkwright.core.arm.descriptions.reading.tree import Frame, onward
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.effects.angles.encoder_offset import ENCODER_OFFSET
from linkwright.core.arm.effects.elastic.axial import AXIAL
from linkwright.core.arm.effects.elastic.joint_compliance import JOINT_COMPLIANCE, drive_compliance
from linkwright.core.arm.effects.elastic.link_bending import LINK_BENDING
from linkwright.core.arm.effects.elastic.shear_deformation import SHEAR_DEFORMATION
from linkwright.core.arm.effects.elastic.slope_propagation import SLOPE_PROPAGATION
from linkwright.core.arm.effects.elastic.torsion import TORSION
from linkwright.core.arm.effects.geometry.axis_misalignment import AXIS_MISALIGNMENT, across_axis
from linkwright.core.arm.effects.geometry.link_length import LINK_LENGTH
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.errors.unknown_mass import of_unknown_mass, without_unknown
from linkwright.core.arm.evaluation import link_masses
from linkwright.core.sections.numeric import Array
from linkwright.core.sections.taper import Tapered
from linkwright.core.units.quantities import InputError, format_quantity

OUTER = 5.0 / 6.0
"""Where, as a share of the length, the outer half of a uniform link's weight bends it as the whole does."""
GEOMETRY = (ENCODER_OFFSET.id, LINK_LENGTH.id, AXIS_MISALIGNMENT.id)
"""The effects that turn and shift frames, which every format holds."""


Motion = Literal["hinge", "slide"]


@dataclass(frozen=True)
class Spring:
    """A spring that turns about an `axis` or slides along it: its stiffness in N*m/rad or N/m."""

    kind: Motion
    axis: FloatVector
    stiffness: float


@dataclass(frozen=True)
class Piece:
    """A rigid piece: where it stands in the one before (`on`; empty: the base) at coordinate 0, the `drive` (from 0)
    that moves it against that one, or the springs between them, and its mass."""

    name: str
    on: str
    origin: Frame
    drive: int | None
    springs: tuple[Spring, ...]
    mass: Mass | None


@dataclass(frozen=True)
class End:
    """A tip: its name, the piece `on` which it stands and where, the payload there (kg), and the name of the fixed
    joint that holds it."""

    name: str
    on: str
    frame: Frame
    payload: float
    joint: str


@dataclass(frozen=True)
class Structure:
    """An arm in pieces, those nearer the base before those that stand on them, with the `tips` on the last of each
    branch. `stiffness` are the drives' (None: rigid), `unweighed` the links (from 1) whose mass nobody knows.

    `lost` says what the format or the pieces cannot hold, `assumed` what stands there because something has to.
    """

    arm: Arm
    pieces: tuple[Piece, ...]
    tips: tuple[End, ...]
    stiffness: tuple[float | None, ...]
    lost: tuple[str, ...]
    assumed: tuple[str, ...]
    names: Names
    unweighed: tuple[int, ...]


def structure(arm: Arm, *, springs: bool, weighed: bool = True) -> Structure:
    """The pieces of an arm; with `springs`, elastic links are two pieces each.

    Raises `InputError` for angles that are absolute, `PropertyNeeded` for links of unknown mass; these may be where it
    need not be `weighed`, and are pieces without a mass then.
    """
    if arm.angles == "absolute":
        message = "are absolute: each drive holds its link against the base, which no such format knows"
        raise InputError("", "angles", message)
    if any(link.runs_out for link in arm.links):
        message = "runs out of a sleeve (bends_over), and no such format knows parts whose length changes"
        raise InputError("", f"link {[link.runs_out for link in arm.links].index(True) + 1}", message)
    arm, names = identified_geometry(arm), names_of(arm)
    unknown = () if weighed else of_unknown_mass(arm)
    beams = beams_of(without_unknown(arm, unknown))
    added, unlike = added_parameters(arm), list[int]()
    pieces: list[Piece] = []
    before = link_before(arm)

    def weighed_with(index: int, mass: Mass | None) -> Mass | None:
        if not added[index].any():
            return mass
        more = heavier(mass, added[index])
        if more is None:
            unlike.append(index + 1)
        return mass if more is None else more

    ends: dict[int | None, tuple[str, Frame]] = {None: ("", (IDENTITY, ZERO))}
    for index, (joint, link) in enumerate(zip(arm.joints, arm.links, strict=True)):
        name = names.links[index]
        on, place = ends[before[index]]
        axes = link_axes(joint, link)
        springs_here = _springs(arm, beams[index], axes) if springs else ()
        masses = masses_on_link(arm, index, beams[index])
        origin = onward(place, standing(joint))
        vector = scale(link.length, link.direction)
        end: Frame = (link.end_rotation, vector)
        if springs_here:
            middle = scale(0.5, vector)
            near, further = _halves(masses.body, beams[index], axes[:, 0])
            pieces.append(Piece(name, on, origin, index, (), weighed_with(index, together([near, *masses.at_joint]))))
            far = together(mass.moved(middle) for mass in (further, *masses.at_end))
            pieces.append(Piece(f"{name}_outer", name, (IDENTITY, middle), None, springs_here, far))
            ends[index] = (f"{name}_outer", (end[0], middle))
        else:
            inertial = None if index in unknown else weighed_with(index, masses.whole)
            pieces.append(Piece(name, on, origin, index, (), inertial))
            ends[index] = (name, end)
    compliance = [drive_compliance(arm, index) for index in range(arm.size)]
    stiffness = tuple(1.0 / item if item > 0.0 else None for item in compliance)
    lost = (*_lost(arm, beams, springs=springs), *_unlike_words(unlike), *names.lost)
    numbers = tuple(index + 1 for index in unknown)
    return Structure(arm, tuple(pieces), _tips(arm, ends, names), stiffness, lost, _assumed(arm), names, numbers)


def _tips(arm: Arm, ends: Mapping[int | None, tuple[str, Frame]], names: Names) -> tuple[End, ...]:
    if not arm.branches:
        on, place = ends[arm.size - 1]
        return (End(names.tips[0], on, onward(place, (IDENTITY, arm.tool)), arm.payload.mass, names.tools[0]),)
    results: list[End] = []
    for branch, name, tool in zip(arm.branches, names.tips, names.tools, strict=True):
        on, place = ends[branch.end - 1]
        frame = onward(place, (IDENTITY, branch.tool))
        results.append(End(name, on, frame, branch.payload.mass, tool))
    return tuple(results)


def standing(joint: Joint) -> Frame:
    """Where a joint stands in the frame of the link before at coordinate 0, its zero included."""
    rotation, translation = joint.origin_rotation, joint.origin_translation
    if joint.zero == 0.0:
        return rotation, translation
    if joint.revolute:
        return compose(rotation, about(joint.axis, math.cos(joint.zero), math.sin(joint.zero))), translation
    return rotation, add(translation, rotate(rotation, scale(joint.zero, joint.axis)))


def identified_geometry(arm: Arm) -> Arm:
    """The arm with what findings say of its zeros, lengths and axes in place."""
    joints, links, followers = list(arm.joints), list(arm.links), ties_to(arm)
    for entry in arm.effects:
        for index in range(arm.size):
            if entry.at and index + 1 not in entry.at:
                continue
            values = entry.parameters
            if entry.effect == ENCODER_OFFSET.id:
                offset = values.get("offset", 0.0)
                joints[index] = replace(joints[index], zero=joints[index].zero + offset)
                for follower, tie in followers.get(index, ()):
                    joints[follower] = replace(joints[follower], zero=joints[follower].zero + tie.weight * offset)
            elif entry.effect == LINK_LENGTH.id and not values.get("stretch", 0.0):
                links[index] = _ending_elsewhere(links[index], values)
            elif entry.effect == AXIS_MISALIGNMENT.id and index:
                joints[index] = _realigned(joints[index], values)
    return replace(arm, joints=tuple(joints), links=tuple(links))


def _ending_elsewhere(link: Link, values: Mapping[str, float]) -> Link:
    """A link whose far end lies elsewhere in its frame than its file has it."""
    offset = (values.get("x", 0.0), values.get("y", 0.0), values.get("z", 0.0))
    end = add(scale(link.length + values.get("length", 0.0), link.direction), offset)
    return replace(link, length=norm(end), direction=unit(end) if norm(end) > 0.0 else link.direction)


def _realigned(joint: Joint, values: Mapping[str, float]) -> Joint:
    """A joint whose axis stands askew and aside of where its file has it."""
    u, v = (rotate(joint.origin_rotation, item) for item in across_axis(joint))
    turn = add(scale(values.get("tilt_u", 0.0), u), scale(values.get("tilt_v", 0.0), v))
    shift = add(scale(values.get("shift_u", 0.0), u), scale(values.get("shift_v", 0.0), v))
    rotation, angle = joint.origin_rotation, norm(turn)
    if angle > 0.0:
        rotation = compose(about(unit(turn), math.cos(angle), math.sin(angle)), rotation)
    return replace(joint, origin_rotation=rotation, origin_translation=add(joint.origin_translation, shift))


def _halves(body: Mass, beam: Beam, along: Array) -> tuple[Mass, Mass]:
    """A link's mass in two halves, whose weights bend it as its spread weight does; with its inertia as near as that
    allows."""
    length = float(beam.length)
    middle = float(along @ body.center)
    apart = (OUTER - 0.5) * length
    # What the halves' distance gives is taken off the inertia across, as far as there is any.
    across = np.eye(3) - np.outer(along, along)
    axial = float(along @ body.inertia @ along)
    turned = body.inertia - min(body.mass * apart**2, _least(body.inertia, along) - 0.51 * axial) * across
    near, far = ((middle + side * apart) * along for side in (-1.0, 1.0))
    return Mass(0.5 * body.mass, near, 0.5 * turned), Mass(0.5 * body.mass, far, 0.5 * turned)


def _least(inertia: Array, along: Array) -> float:
    """The least moment of inertia across the link."""
    values, vectors = np.linalg.eigh(inertia)
    return float(min(value for value, vector in zip(values, vectors.T, strict=True) if abs(vector @ along) < 0.9))


def _springs(arm: Arm, beam: Beam, axes: Array) -> tuple[Spring, ...]:
    """The springs at the middle of an elastic link: what of its flexibility the model holds."""
    length = float(beam.length)
    if beam.flexural_rigidity_height is None or beam.flexural_rigidity_width is None or length == 0.0:
        return ()
    out = arm.leave_out
    motions: list[tuple[Motion, int, float]] = []
    if beam.axial_rigidity is not None and AXIAL.id not in out:
        motions.append(("slide", 0, length / float(beam.axial_rigidity)))
    shear = (beam.shear_rigidity_height, beam.shear_rigidity_width)
    for axis, rigidity, sheared in zip((1, 2), _rigidities(beam), shear, strict=True):
        give = 0.0 if LINK_BENDING.id in out else length**3 / (12.0 * rigidity)
        if sheared is not None and SHEAR_DEFORMATION.id not in out:
            give += length / float(sheared)
        motions.append(("slide", axis, give))
    if beam.torsional_rigidity is not None and TORSION.id not in out:
        motions.append(("hinge", 0, length / float(beam.torsional_rigidity)))
    if LINK_BENDING.id not in out:
        height, width = _rigidities(beam)
        motions.append(("hinge", 2, length / height))  # bending along the height turns about the width
        motions.append(("hinge", 1, length / width))
    return tuple(Spring(kind, _floats(axes[:, axis]), 1.0 / give) for kind, axis, give in motions if give > 0.0)


def _rigidities(beam: Beam) -> tuple[float, float]:
    return float(beam.flexural_rigidity_height or 0.0), float(beam.flexural_rigidity_width or 0.0)


def _floats(vector: Array) -> FloatVector:
    x, y, z = (float(value) for value in vector)
    return (x, y, z)


def mimicked(arm: Arm, index: int) -> tuple[int, float, float] | None:
    """The one joint (from 0) whose turn a joint (from 0) without a drive follows, by what multiplier and
    offset; None where it follows several, or the coordinate of one that follows others itself."""
    follows = arm.joints[index].follows
    if follows is None or follows.driven or len(follows.ties) != 1:
        return None
    if arm.joints[follows.ties[0].joint].follows is not None:
        return None
    return follows.ties[0].joint, follows.ties[0].weight, follows.constant


def _lost(arm: Arm, beams: Sequence[Beam], *, springs: bool) -> tuple[str, ...]:
    """What the pieces do not hold of an arm."""
    form: Format = "mjcf" if springs else "urdf"
    tied = [
        joint.follows is not None and (springs or mimicked(arm, index) is None)
        for index, joint in enumerate(arm.joints)
    ]
    lost = [
        *_of_joints("backlash", [joint.backlash > 0.0 for joint in arm.joints]),
        *_of_joints("clearance of bearings", [joint.clearance > 0.0 for joint in arm.joints]),
        *_of_joints("that bearings give in tilt", [joint.tilting_stiffness is not None for joint in arm.joints]),
        *_of_joints("that the beams of slides give", [joint.guide is not None for joint in arm.joints]),
        *_of_links("that flanges give", [link.flange is not None for link in arm.links]),
        *_of_links("that links given by their stiffness give", [link.compliance is not None for link in arm.links]),
        *_of_joints("balancers", [joint.counterbalance is not None for joint in arm.joints]),
        *_of_joints("that joints follow others: what is asked of each here is its turn against the link before", tied),
        *_of_joints("that joints are passive", [joint.passive for joint in arm.joints]),
    ]
    for number, link in enumerate(arm.links, start=1):
        if (moment := negative_moment(link)) is not None:
            text = f"a principal moment of {moment:.4g} kg*m^2, which no body has; a rod's stands there"
            lost.append(f"the inertia of link {number}: {text}")
    if any(arm.payload.force) or any(arm.payload.moment):
        lost.append("the force and moment at the tip")
    lost += effects_beside(arm, (*GEOMETRY, JOINT_COMPLIANCE.id, *effects_in_motion(form)))
    return tuple(dict.fromkeys([*lost, *_lost_flexibility(arm, beams, springs=springs)]))


def effects_beside(arm: Arm, held: Collection[str]) -> list[str]:
    """What an arm's `effects` say beside those that a format holds, in words; a link that is longer by a share of its
    length is held by none."""
    titles = (
        f"{EFFECTS[entry.effect].title} (effect {entry.effect})"
        for entry in arm.effects
        if entry.effect not in held or entry.parameters.get("stretch", 0.0)
    )
    return list(dict.fromkeys(titles))


def _unlike_words(links: Sequence[int]) -> tuple[str, ...]:
    """What was found of links' weights that no body has."""
    numbers = ", ".join(map(str, links))
    return (f"what was found of the weight of link {numbers}: no body has it",) if links else ()


def _of_joints(name: str, chosen: Sequence[bool]) -> list[str]:
    """What is not held of the chosen joints; nothing where there are none."""
    places = [str(number) for number, item in enumerate(chosen, start=1) if item]
    return [f"{name} (joint {', '.join(places)})"] if places else []


def _of_links(name: str, chosen: Sequence[bool]) -> list[str]:
    """The same of the chosen links."""
    places = [str(number) for number, item in enumerate(chosen, start=1) if item]
    return [f"{name} (link {', '.join(places)})"] if places else []


def _lost_flexibility(arm: Arm, beams: Sequence[Beam], *, springs: bool) -> Iterator[str]:
    """What pieces with springs, or rigid ones, do not hold of what gives."""
    if not springs:
        yield from _of_joints(
            "stiffness of the drives", [drive_compliance(arm, index) > 0.0 for index in range(arm.size)]
        )
        if bent := [str(number) for number, link in enumerate(arm.links, start=1) if link.elastic]:
            yield f"flexibility of the links ({', '.join(bent)})"
        return
    softest = "zones of the drives' stiffness, which is that of the softest"
    yield from _of_joints(softest, [bool(joint.zones) for joint in arm.joints])
    if SLOPE_PROPAGATION.id in arm.leave_out:
        yield "that slopes are not counted: what bends turns all beyond it"
    if any(isinstance(link.section, Tapered) for link in arm.links):
        yield "where along a tapered link it bends: at its middle, as a uniform one of the same rigidities"
    if any(float(beam.flexural_rigidity_coupling) != 0.0 for beam in beams):
        yield "that sections bend askew"


def _assumed(arm: Arm) -> tuple[str, ...]:
    assumed: list[str] = []
    shapeless = [
        link for link in arm.links if not link.elastic and (link.inertia is None or negative_moment(link) is not None)
    ]
    if rigid := [str(number) for number, link in enumerate(arm.links, start=1) if link in shapeless and link.mass]:
        assumed.append(f"links of unknown section ({', '.join(rigid)}) have the inertia of slender rods")
    hung = [mass for link in arm.links for mass in link.masses if link.inertia is None or mass.motor_of is not None]
    tips = [arm.payload.mass, *(branch.payload.mass for branch in arm.branches)]
    if hung or any(tips) or any(joint.mass for joint in arm.joints):
        assumed.append("masses without a shape have the inertia of steel balls")
    if any(joint.motor_on_base for joint in arm.joints):
        assumed.append("motors on the base are left to the base")
    return tuple(assumed)


_POSES = 16
_AWAY = 1e-6
"""How far (of the arm's reach, and of its mass) what is read back may be from what was meant."""


def unlike(meant: Arm, path: Path) -> Iterator[str]:
    """What a URDF says otherwise than the arm that was meant, with what its effects say of frames and weights: how many
    joints it has, where its tips and what is down are at poses spread over the ranges, however its base is turned, and
    what moves of its weight; nothing where it is the same. Raises `InputError`."""
    meant = identified_geometry(meant)
    back = import_robot(path, tip=names_of(meant).tips).arm
    if meant.size != back.size:
        yield f"it had {meant.size} joints and reads {back.size}"
        return
    low, high = (np.array([joint.range[end] for joint in meant.joints]) for end in (0, 1))
    q = completed(meant, low + (high - low) * np.random.default_rng(1).uniform(size=(_POSES, meant.size)))
    one, other = (_places(item, q, down=any(meant.gravity)) for item in (meant, back))
    left, _, right = np.linalg.svd(other.T @ one)
    left[:, -1] *= np.linalg.det(left @ right)  # a turn, and no mirror
    away = float(np.linalg.norm(other @ left @ right - one, axis=1).max())
    if away > _AWAY * (sum(meant.lengths) + 1.0):
        yield f"a tip is {format_quantity(away, 'length', digits=3)} away from where it was"
    masses = [_mass(item) for item in (meant, back)]
    if masses[0] is not None and masses[1] is not None and abs(masses[0] - masses[1]) > _AWAY * (masses[0] + 1.0):
        was, reads = (format_quantity(mass, "mass", digits=6) for mass in masses if mass is not None)
        yield f"{was} of it moved and {reads} move"


def _places(arm: Arm, q: Array, *, down: bool) -> Array:
    """Where each tip is at poses (N, n), a row each (M, 3) m; and, as one more, what is a metre `down`."""
    tips = [tip_position(arm.on(branch.name), q) for branch in arm.branches] or [tip_position(arm, q)]
    return np.vstack([*tips, *([unit(arm.gravity)] if down else [])])


def _mass(arm: Arm) -> float | None:
    """What all that moves weighs, kg; None where a link's mass is not known."""
    if of_unknown_mass(arm):
        return None
    first = arm.joints[0]  # one that turns stands on the base, a slide's mass rides on it
    still = (first.mass if first.revolute else 0.0) + (0.0 if first.guide is None else first.guide.mass)
    still += sum(joint.motor_on_base for joint in arm.joints)
    beams, added = beams_of(arm), added_parameters(arm)
    # What was found of a link's weight that no body has is in no file.
    bodies = (masses_on_link(arm, index, beam).whole for index, beam in enumerate(beams))
    more = (float(row[0]) for body, row in zip(bodies, added, strict=True) if heavier(body, row) is not None)
    return sum(link_masses(beams)) + arm.carried_mass + arm.payload.mass - still + sum(more)
