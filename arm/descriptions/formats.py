"""The pieces of an arm as URDF and MJCF."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from linkwright.core.arm.bodies.bodies import Mass, ball
from linkwright.core.arm.chain.chain import Arm, FloatVector, Joint
from linkwright.core.arm.chain.following import turn_range
from linkwright.core.arm.chain.vectors import IDENTITY, ZERO, Rotation, cross, norm, to_roll_pitch_yaw, unit
from linkwright.core.arm.effects.elastic.elastic_drive import RETARDATION
from linkwright.core.arm.effects.elastic.joint_compliance import drive_retardation
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.units.quantities import InputError, format_quantity, shown

from .exported import Piece, Structure, mimicked, structure
from .in_motion import of_joint
from .reading.tree import Frame

DAMPING_TIME = 1e-3
"""s; springs and drives are damped by their stiffness times this, which is 6 % of critical at 20 Hz."""
HELD = 1e-9
"""rad or m; a rigid drive gives no more than this under the arm's whole weight at its whole reach."""
_HARD: Mapping[str, str] = MappingProxyType({"solreffriction": "0.004 1", "solimpfriction": "0.9999 0.9999 0.001"})
"""How hard MuJoCo's dry friction is, as near to Coulomb's as steps of a millisecond hold; by default it creeps."""
_LEAST_MASS, _LEAST_INERTIA = 1e-9, 1e-12
_ROUNDING = 1e-9
_DOWN: FloatVector = (0.0, 0.0, -9.81)


@dataclass(frozen=True)
class Exported:
    """An arm in another format: the `text` of the file, what it could not carry and what had to be assumed."""

    arm: Arm
    format: str
    text: str
    carried: tuple[str, ...]
    lost: tuple[str, ...]
    assumed: tuple[str, ...]


def export_arm(arm: Arm, to: str) -> Exported:
    """An arm as `urdf` or `mjcf`. Raises `InputError` for another format and for an arm that none can hold."""
    if to not in _WRITERS:
        raise InputError("", "to", f"{shown(to)} is no format; write urdf or mjcf")
    return _WRITERS[to](arm)


def _numbers(values: Any) -> str:
    return " ".join(repr(float(value) + 0.0) for value in values)


def _pose(frame: Frame) -> dict[str, str]:
    return {"xyz": _numbers(frame[1]), "rpy": _numbers(to_roll_pitch_yaw(frame[0]))}


def _name(arm: Arm) -> str:
    text = "".join(c if c.isprintable() else " " for c in arm.name)
    return " ".join(text.split()) or "arm"


def _inertia(mass: Mass) -> dict[str, str]:
    pairs = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
    return {name: _numbers([mass.inertia[at]]) for name, at in pairs.items()}


def _mounting(arm: Arm) -> Rotation:
    """How a base is to stand in a world whose gravity points down along z, so that the arm feels its own."""
    if norm(arm.gravity) == 0.0:
        return IDENTITY
    down = unit(arm.gravity)
    if down == (0.0, 0.0, -1.0):
        return IDENTITY
    # The turn about what is normal to both; half a turn about x where they are opposite.
    axis = cross(down, (0.0, 0.0, -1.0))
    if norm(axis) == 0.0:
        return ((1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0))
    turning, cosine, sine = np.array(unit(axis)), -down[2], norm(axis)
    skew = np.array([[0.0, -turning[2], turning[1]], [turning[2], 0.0, -turning[0]], [-turning[1], turning[0], 0.0]])
    matrix = np.eye(3) + sine * skew + (1.0 - cosine) * skew @ skew
    x, y, z = ((float(row[0]), float(row[1]), float(row[2])) for row in matrix)
    return (x, y, z)


def _gravity_words(arm: Arm) -> tuple[str, ...]:
    if math.isclose(norm(arm.gravity), -_DOWN[2], rel_tol=1e-3):
        return ()
    return (f"the arm's gravity, {format_quantity(norm(arm.gravity), 'acceleration')}: the world's holds",)


def _drive_words(pieces: Structure) -> tuple[str, ...]:
    words: list[str] = []
    for number, (joint, stiffness) in enumerate(zip(pieces.arm.joints, pieces.stiffness, strict=True), start=1):
        if stiffness is not None:
            kind = "torsional_stiffness" if joint.revolute else "linear_stiffness"
            words.append(f"joint {number}: stiffness of the drive {format_quantity(stiffness, kind, digits=6)}")
    return tuple(words)


def _greatest(joint: Joint) -> tuple[float | None, float | None]:
    """The greatest effort and speed of a joint's drive, as far as they are known."""
    return joint.rating[0] if joint.effort is None else joint.effort, joint.velocity


def _greatest_words(arm: Arm) -> tuple[str, ...]:
    """Efforts and speeds where a position servo has no place for them."""
    texts: list[str] = []
    for number, joint in enumerate(arm.joints, start=1):
        kinds = ("torque", "angular_speed") if joint.revolute else ("force", "speed")
        for kind, greatest in zip(kinds, (joint.effort, joint.velocity), strict=True):
            if greatest is not None:
                texts.append(f"joint {number}: {format_quantity(greatest, kind, digits=6)}")
    return (f"the greatest efforts and speeds of the drives ({', '.join(texts)})",) if texts else ()


def _unweighed_words(pieces: Structure) -> tuple[str, ...]:
    if not pieces.unweighed:
        return ()
    links = ", ".join(map(str, pieces.unweighed))
    return (f"what links of unknown mass weigh (link {links}): simulators take them for weightless",)


def _for_mujoco(pieces: Structure) -> tuple[dict[str, str], list[str]]:
    """What MuJoCo's compiler has to be told, so that it takes masses and tensors as they are or mends what no body can
    have, and what it then does, in words."""
    options: dict[str, str] = {}
    words: list[str] = []
    weightless = [piece.name for piece in pieces.pieces if not _moves_mass(piece)]
    if weightless:
        options |= {"boundmass": f"{_LEAST_MASS:g}", "boundinertia": f"{_LEAST_INERTIA:g}"}
        text = f"at least {_LEAST_MASS:g} kg and {_LEAST_INERTIA:g} kg*m^2"
        words.append(f"MuJoCo is to give what weighs nothing, or has no inertia, {text} ({', '.join(weightless)})")
    impossible = [piece.name for piece in pieces.pieces if piece.mass is not None and not _loads(piece.mass)]
    if impossible:
        options |= {"balanceinertia": "true", "boundinertia": f"{_LEAST_INERTIA:g}"}
        text = "where one principal moment is more than the others together"
        words.append(f"MuJoCo is to put a ball's inertia {text} ({', '.join(impossible)})")
    return options, words


def _loads(mass: Mass) -> bool:
    """Whether MuJoCo takes a tensor: it allows no rounding where one moment is as much as the others together."""
    least, middle, greatest = mass.moments
    return bool(least >= 0.0 and greatest <= (least + middle) * (1.0 - _ROUNDING))


def _moves_mass(piece: Piece) -> bool:
    return piece.mass is not None and bool(np.all(np.diag(piece.mass.inertia) > 0.0))


def _written(root: Element, arm: Arm, lines: tuple[str, ...], lost: tuple[str, ...], assumed: tuple[str, ...]) -> str:
    """The document, with what it does not hold as its first comment."""
    words = [f"{_name(arm)}, written by linkwright. Units: m, kg, s, rad, N."]
    words += [f"Not in this file: {item}." for item in lost]
    words += [f"Assumed: {item}." for item in assumed]
    words += [f"{line}." for line in lines]
    comment = "\n  ".join(words).replace("--", "- -")
    root.insert(0, ElementTree.Comment(f"\n  {comment}\n"))
    ElementTree.indent(root)
    return '<?xml version="1.0"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"


def _urdf(arm: Arm) -> Exported:
    pieces = structure(arm, springs=False, weighed=False)
    arm, names = pieces.arm, pieces.names
    root = Element("robot", {"name": _name(arm)})
    simulated, for_mujoco = _for_mujoco(pieces)
    if simulated:
        SubElement(SubElement(root, "mujoco"), "compiler", simulated)
    base = names.base
    mounting = _mounting(arm)
    if mounting != IDENTITY:
        SubElement(root, "link", {"name": "world"})
        _fixed(root, names.mounting, "world", base, (mounting, ZERO))
    SubElement(root, "link", {"name": base})
    for piece in pieces.pieces:
        assert piece.drive is not None  # without springs every piece has a drive
        _inertial(SubElement(root, "link", {"name": piece.name}), piece.mass)
        driven = arm.joints[piece.drive]
        kind = "revolute" if driven.revolute else "prismatic"
        joint = SubElement(root, "joint", {"name": names.joints[piece.drive], "type": kind})
        SubElement(joint, "origin", _pose(piece.origin))
        SubElement(joint, "parent", {"link": piece.on or base})
        SubElement(joint, "child", {"link": piece.name})
        SubElement(joint, "axis", {"xyz": _numbers(driven.axis)})
        low, high = turn_range(arm, piece.drive)
        limits = {"lower": _numbers([low]), "upper": _numbers([high])}
        for name, greatest in zip(("effort", "velocity"), _greatest(driven), strict=True):
            limits[name] = "0" if greatest is None else _numbers([greatest])
        SubElement(joint, "limit", limits)
        if rubs := of_joint(arm, "urdf", piece.drive):
            SubElement(joint, "dynamics", {name: _numbers([value]) for name, value in rubs.items()})
        if (tie := mimicked(arm, piece.drive)) is not None:
            of = {"multiplier": _numbers([tie[1]]), "offset": _numbers([tie[2]])}
            SubElement(joint, "mimic", {"joint": names.joints[tie[0]], **of})
    for end in pieces.tips:
        tip = SubElement(root, "link", {"name": end.name})
        if end.payload:
            _inertial(tip, ball(end.payload, ZERO))
        _fixed(root, end.joint, end.on, end.name, end.frame)
    lost = (*pieces.lost, *_gravity_words(arm), *_unweighed_words(pieces))
    none = [str(number) for number, joint in enumerate(arm.joints, 1) if None in _greatest(joint)]
    assumed = (*pieces.assumed, *for_mujoco)
    if none:
        assumed = (*assumed, f"efforts and velocities of 0 are not known (joint {', '.join(none)})")
    carried = ("names, frames, limits, efforts, speeds, masses and inertias",)
    if any(of_joint(arm, "urdf", index) for index in range(arm.size)):
        carried = (*carried, "friction and damping of the joints")
    return Exported(arm, "urdf", _written(root, arm, _drive_words(pieces), lost, assumed), carried, lost, assumed)


def _fixed(root: Element, name: str, parent: str, child: str, frame: Frame) -> None:
    joint = SubElement(root, "joint", {"name": name, "type": "fixed"})
    SubElement(joint, "origin", _pose(frame))
    SubElement(joint, "parent", {"link": parent})
    SubElement(joint, "child", {"link": child})


def _inertial(link: Element, mass: Mass | None) -> None:
    if mass is not None:
        body = SubElement(link, "inertial")
        SubElement(body, "origin", {"xyz": _numbers(mass.center), "rpy": "0 0 0"})
        SubElement(body, "mass", {"value": _numbers([mass.mass])})
        SubElement(body, "inertia", _inertia(mass))


def _mjcf(arm: Arm) -> Exported:
    pieces = structure(arm, springs=True)
    root = _mujoco_tree(pieces)
    _mujoco_actuators(root, pieces)
    carried, assumed = _mujoco_words(pieces)
    lines = tuple(f"Carried: {item}" for item in carried)
    lost = (*pieces.lost, *_greatest_words(pieces.arm))
    text = _written(root, pieces.arm, lines, lost, assumed)
    return Exported(pieces.arm, "mjcf", text, carried, lost, assumed)


def under_torques(arm: Arm) -> str:
    """An arm as MJCF of rigid links without servos, for torques that act at its joints; these are named after their
    numbers, from 1. Its dry friction is as hard as MuJoCo makes it. Raises what `structure` raises."""
    pieces = structure(arm, springs=False)
    names = replace(pieces.names, joints=tuple(str(number + 1) for number in range(arm.size)))
    root = _mujoco_tree(replace(pieces, names=names))
    default = SubElement(root, "default")
    SubElement(default, "joint", dict(_HARD))
    return ElementTree.tostring(root, encoding="unicode")


def _mujoco_tree(pieces: Structure) -> Element:
    """The bodies of an arm in pieces, and what MuJoCo has to know beside."""
    arm, names = pieces.arm, pieces.names
    root = Element("mujoco", {"model": _name(arm)})
    compiler = {"angle": "radian", "boundmass": f"{_LEAST_MASS:g}", "boundinertia": f"{_LEAST_INERTIA:g}"}
    SubElement(root, "compiler", {**compiler, "balanceinertia": "true"})
    option = {"gravity": _numbers(arm.gravity), "integrator": "implicitfast", "timestep": repr(DAMPING_TIME)}
    SubElement(root, "option", option)
    bodies = {"": SubElement(SubElement(root, "worldbody"), "body", {"name": names.base})}
    for piece in pieces.pieces:
        body = SubElement(bodies[piece.on], "body", {"name": piece.name, **_mujoco_frame(piece.origin)})
        bodies[piece.name] = body
        _mujoco_inertial(body, piece.mass)
        if piece.drive is not None:
            _mujoco_joint(body, arm, piece.drive, names.joints[piece.drive])
        _mujoco_springs(body, piece)
    for end in pieces.tips:
        tip = SubElement(bodies[end.on], "body", {"name": end.name, **_mujoco_frame(end.frame)})
        if end.payload:
            _mujoco_inertial(tip, ball(end.payload, ZERO))
        SubElement(tip, "site", {"name": end.name})
    return root


def _mujoco_joint(body: Element, arm: Arm, index: int, name: str) -> None:
    driven = arm.joints[index]
    kind = "hinge" if driven.revolute else "slide"
    span = _numbers(turn_range(arm, index))
    about = {"axis": _numbers(driven.axis), "range": span, "limited": "false"}
    moved = {item: _numbers([value]) for item, value in of_joint(arm, "mjcf", index).items()}
    SubElement(body, "joint", {"name": name, "type": kind, **about, **moved})


def _mujoco_actuators(root: Element, pieces: Structure) -> None:
    """A position servo a joint, as stiff as its drive."""
    actuators = SubElement(root, "actuator")
    rigid = _rigid(pieces.arm)
    for index, stiffness in enumerate(pieces.stiffness):
        gain = rigid if stiffness is None else stiffness
        late = DAMPING_TIME if stiffness is None else drive_retardation(pieces.arm, index) or RETARDATION
        gains = {"kp": _numbers([gain]), "kv": _numbers([late * gain])}
        control = {"ctrlrange": _numbers(turn_range(pieces.arm, index)), "ctrllimited": "true"}
        joint = {"joint": pieces.names.joints[index]}
        SubElement(actuators, "position", {"name": f"drive{index + 1}", **joint, **gains, **control})


def _mujoco_words(pieces: Structure) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """What the file carries of the arm, and what was assumed."""
    arm = pieces.arm
    carried = ["names, frames, limits, masses and inertias", "gravity"]
    moving = [of_joint(arm, "mjcf", index) for index in range(arm.size)]
    if any(moving):
        carried.append(f"{', '.join(dict.fromkeys(name for item in moving for name in item))} of the joints")
    if any(pieces.stiffness):
        carried.append("stiffness of the drives, as position servos: what is asked of a joint goes to `ctrl`")
    if any(piece.springs for piece in pieces.pieces):
        carried.append("flexibility of the links, as springs at their middles")
    damped = f"springs and rigid drives are damped by {DAMPING_TIME:g} s times their stiffness"
    assumed = [*pieces.assumed, f"{damped}, drives that give by {RETARDATION:g} s where no retardation is known"]
    both = zip(pieces.names.joints, moving, pieces.stiffness, strict=True)
    if behind := [name for name, item, stiffness in both if stiffness is not None and "armature" in item]:
        assumed.append(f"rotors and friction of {', '.join(behind)} turn with the link, behind the drive's spring")
    still = [name for name, item in zip(pieces.names.joints, moving, strict=True) if "armature" not in item]
    if still:
        assumed.append(f"no armature is known of {', '.join(still)}")
    if None in pieces.stiffness:
        assumed.append(f"rigid drives hold to {HELD:g} rad or m under the whole weight at full reach")
    return tuple(carried), (*assumed, *_for_mujoco(pieces)[1])


def _rigid(arm: Arm) -> float:
    """The stiffness (N*m/rad, N/m) that stands for a rigid drive's."""
    mass = sum(float(beam.mass) for beam in beams_of(arm)) + arm.carried_mass + arm.payload.mass
    reach = max(1.0, sum(arm.lengths) + norm(arm.tool))
    return max(1.0, mass) * max(norm(arm.gravity), -_DOWN[2]) * reach / HELD


def _mujoco_frame(frame: Frame) -> dict[str, str]:
    attributes = {"pos": _numbers(frame[1])}
    if frame[0] != IDENTITY:
        # Columns of the rotation; MuJoCo makes the third.
        columns = [[row[axis] for row in frame[0]] for axis in (0, 1)]
        attributes["xyaxes"] = _numbers([*columns[0], *columns[1]])
    return attributes


def _mujoco_inertial(body: Element, mass: Mass | None) -> None:
    if mass is not None:
        values = _inertia(mass)
        full = " ".join(values[name] for name in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz"))
        held = {"pos": _numbers(mass.center), "mass": _numbers([mass.mass]), "fullinertia": full}
        SubElement(body, "inertial", held)


def _mujoco_springs(body: Element, piece: Piece) -> None:
    for number, spring in enumerate(piece.springs, start=1):
        values = {"stiffness": _numbers([spring.stiffness]), "damping": _numbers([DAMPING_TIME * spring.stiffness])}
        name = {"name": f"{piece.name}_{spring.kind}{number}", "type": spring.kind, "axis": _numbers(spring.axis)}
        SubElement(body, "joint", {**name, **values})


_WRITERS: Mapping[str, Callable[[Arm], Exported]] = MappingProxyType({"urdf": _urdf, "mjcf": _mjcf})
"""How each format is written."""
