"""Dynamic parameters identified of a moving arm, written into a URDF or MJCF: friction, rotor inertia, link masses."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from linkwright.core.arm.bodies.bodies import Mass
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.descriptions.file_frames import FileFrame
from linkwright.core.arm.descriptions.in_motion import Format, added_parameters, heavier, of_joint
from linkwright.core.arm.descriptions.reading.elements import Element
from linkwright.core.arm.descriptions.reading.mjcf import mjcf_tree
from linkwright.core.arm.descriptions.reading.mjcf_words import Mjcf
from linkwright.core.arm.descriptions.reading.urdf import read_urdf
from linkwright.core.arm.motion.rigid import INERTIA_PAIRS, in_frame
from linkwright.core.sections.numeric import Array

from .editor import Editor, text_of

_MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
_FULL = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


def write_joints(arm: Arm, elements: Sequence[Element], top: Element, editor: Editor) -> None:
    """Write what the arm's effects say of each joint into its element."""
    form: Format = "urdf" if top.tag == "robot" else "mjcf"
    for index, element in enumerate(elements):
        values = of_joint(arm, form, index)
        name = element.attributes["name"]
        if form == "urdf" and values:
            dynamics = element.one("dynamics")
            if dynamics is None:
                editor.insert(name, element, f"<dynamics {_attributes(values)}/>")
                continue
            element = dynamics
        if "springref" in values and arm.joints[index].revolute:
            values["springref"] /= Mjcf(top).to_radians
        for attribute, value in values.items():
            editor.number(name, element, attribute, value)


def write_weights(
    arm: Arm, frames: Sequence[FileFrame], standing: Sequence[Array], top: Element, editor: Editor
) -> Iterator[str]:
    """Write what the arm's effects say of each link's weight into its link or body; what could not be is reported.

    Args:
        arm: The arm with its effects.
        frames: Those of the file's joints.
        standing: Where each of the arm's links stands (4, 4) in the frame that its joint moves in the file.
        top: The file's root element.
        editor: What edits the file.
    """
    for index, added in enumerate(added_parameters(arm)):
        if not added.any():
            continue
        there = standing[index]
        moved = in_frame(added, there[:3, :3], there[:3, 3])
        write = _into_urdf if top.tag == "robot" else _into_mjcf
        if (why := write(frames[index], moved, top, editor)) is not None:
            yield f"what was found of the weight of link {index + 1}: {why}"


def _into_urdf(frame: FileFrame, added: Array, top: Element, editor: Editor) -> str | None:
    """Why it could not be written; None where it was."""
    robot = read_urdf(Path(top.file))
    name = robot.joints[frame.name].child
    element = next(link for link in top.all("link") if link.attributes["name"] == name)
    inertial, held = robot.links[name].inertial, element.one("inertial")
    tensor = np.zeros((3, 3)) if inertial is None or inertial.inertia is None else inertial.inertia
    new = heavier(None if inertial is None else Mass(inertial.mass, np.array(inertial.center), tensor), added)
    if new is None:
        return "no body has it"
    moments = dict(zip(_MOMENTS, (new.inertia[pair] for pair in INERTIA_PAIRS), strict=True))
    parts = {
        "origin": {"xyz": text_of(new.center), "rpy": "0 0 0"},
        "mass": {"value": text_of([new.mass])},
        "inertia": {key: text_of([value]) for key, value in moments.items()},
    }
    if held is None:
        inside = "".join(f"<{tag} {_quoted(values)}/>" for tag, values in parts.items())
        editor.insert(name, element, f"<inertial>{inside}</inertial>")
        return None
    for tag, values in parts.items():
        child = held.one(tag)
        if child is None:
            editor.insert(name, held, f"<{tag} {_quoted(values)}/>")
            continue
        for attribute, value in values.items():
            editor.word(name, child, attribute, value)
    return None


def _into_mjcf(frame: FileFrame, added: Array, top: Element, editor: Editor) -> str | None:
    """Why it could not be written; None where it was."""
    name = frame.element.attributes.get("name", frame.name)
    held = frame.element.one("inertial")
    if Mjcf(top).compiler.get("inertiafromgeom") == "true":
        return "its body weighs what its geoms do (inertiafromgeom); write it as auto there"
    if held is None:
        return _beside_geoms(frame, added, top, editor)
    stands = Mjcf(top).frame(held)
    tensor = np.zeros((3, 3))
    if "fullinertia" in held.attributes:
        for pair, word in zip(_FULL, held.attributes["fullinertia"].split(), strict=True):
            tensor[pair] = tensor[pair[::-1]] = float(word)
    else:
        tensor = np.diag([float(word) for word in held.attributes.get("diaginertia", "0 0 0").split()])
    turned = stands[:3, :3] @ tensor @ stands[:3, :3].T
    new = heavier(Mass(held.number("mass"), stands[:3, 3], turned), added)
    if new is None:
        return "no body has it"
    editor.word(name, held, "mass", text_of([new.mass]))
    editor.word(name, held, "pos", text_of(new.center))
    for attribute in ("quat", "euler", "axisangle", "xyaxes", "zaxis", "diaginertia"):
        editor.remove(held, attribute)
    editor.word(name, held, "fullinertia", _full(new))
    return None


def _beside_geoms(frame: FileFrame, added: Array, top: Element, editor: Editor) -> str | None:
    """Write an `<inertial>` with what a body's geoms weigh and what was added: MuJoCo takes it in their place."""
    robot = mjcf_tree(top)
    link = robot.links[robot.joints[frame.name].child]
    joints = [item for item, _, _ in Mjcf(top).inside(frame.element, "main", np.eye(4)) if item.tag == "joint"]
    if not link.weighed or link.unplaced or len(joints) > 1:
        why = "several joints" if len(joints) > 1 else "geoms that cannot be read"
        return f"its body has no <inertial>, and {why}; write one, as MuJoCo saves it"
    mass = None
    if (held := link.inertial) is not None and frame.point is not None:
        mass = Mass(held.mass, np.array(held.center) + frame.point, np.zeros((3, 3)))
        mass = mass if held.inertia is None else replace(mass, inertia=held.inertia)
    new = heavier(mass, added)
    if new is None:
        return "no body has it"
    values = {"mass": text_of([new.mass]), "pos": text_of(new.center), "fullinertia": _full(new)}
    editor.insert(frame.element.attributes.get("name", frame.name), frame.element, f"<inertial {_quoted(values)}/>")
    return None


def _full(mass: Mass) -> str:
    """A tensor as `fullinertia` has it."""
    return text_of([mass.inertia[pair] for pair in _FULL])


def _attributes(values: Mapping[str, float]) -> str:
    return _quoted({name: text_of([value]) for name, value in values.items()})


def _quoted(values: Mapping[str, str]) -> str:
    return " ".join(f'{name}="{value}"' for name, value in values.items())
