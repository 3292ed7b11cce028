"""A serial arm as arrays, read from an arm file in Denavit-Hartenberg or product-of-exponentials form, or from URDF."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import yaml
from numpy.typing import NDArray

Array = NDArray[np.float64]
_UNITS = {"m": 1.0, "mm": 1e-3, "deg": math.pi / 180.0, "rad": 1.0, "kg": 1.0, "m/s^2": 1.0, "kg*m^2": 1.0}


@dataclass(frozen=True)
class Chain:
    """n joints from the base out, at zero all frames as their transforms say.

    Args:
        fixed: (n + 1, 4, 4) transforms before each joint and behind the last.
        axes: (n, 3) unit vectors of the joints, in the frame before each.
        slides: (n,) whether a joint slides.
        gravity: (3,) m/s^2, in the base frame.
        mass: (n,) kg of what moves with each joint.
        centre: (n, 3) m of its centre of mass, in the frame behind the joint.
        inertia: (n, 3, 3) kg m^2 about that frame's origin.
        weighed: Whether the masses are known.
    """

    fixed: Array
    axes: Array
    slides: NDArray[np.bool_]
    gravity: Array
    mass: Array
    centre: Array
    inertia: Array
    weighed: bool

    @property
    def size(self) -> int:
        """The number of joints."""
        return len(self.axes)


def skew(vector: Array) -> Array:
    """Cross-product matrices (..., 3, 3) of vectors (..., 3)."""
    x, y, z = np.moveaxis(np.asarray(vector, dtype=float), -1, 0)
    zero = np.zeros_like(x)
    return np.stack([np.stack([zero, -z, y], -1), np.stack([z, zero, -x], -1), np.stack([-y, x, zero], -1)], -2)


def turned(vector: Array) -> Array:
    """Rotation matrices (..., 3, 3) of rotation vectors (..., 3), rad (Rodrigues)."""
    angle = np.linalg.norm(vector, axis=-1)[..., None, None]
    cross = skew(vector)
    small = angle < 1e-8
    safe = np.where(small, 1.0, angle)
    first = np.where(small, 1.0, np.sin(safe) / safe)
    second = np.where(small, 0.5, (1.0 - np.cos(safe)) / safe**2)
    return np.eye(3) + first * cross + second * (cross @ cross)


def transform(rotation: Array | None = None, place: Sequence[float] | Array = (0.0, 0.0, 0.0)) -> Array:
    """A (4, 4) transform."""
    result = np.eye(4)
    result[:3, 3] = place
    if rotation is not None:
        result[:3, :3] = rotation
    return result


def _number(value: Any) -> float:
    """A number with its unit (`400 mm`), in SI."""
    if isinstance(value, int | float):
        return float(value)
    figure, _, unit = str(value).partition(" ")
    return float(figure) * _UNITS[unit.strip()] if unit else float(figure)


def from_arm_file(path: Path) -> Chain:
    """The arm of an arm file.

    Args:
        path: An arm file that gives each joint `dh`, or the arm `product_of_exponentials`.

    Returns:
        The chain; a link's centre of mass lies half way to the next joint where the file does not say.

    Raises:
        ValueError: The file has another form.
    """
    said = yaml.safe_load(path.read_text(encoding="utf-8"))
    entries, gravity = said["chain"], [_number(item) for item in said.get("gravity", [0.0, 0.0, -9.81])]
    count = len(entries)
    if "product_of_exponentials" in said:
        form = said["product_of_exponentials"]
        axes = np.array(form["axes"], dtype=float)
        offsets = [[_number(item) for item in row] for row in form["offsets"]]
        offsets += [[0.0, 0.0, 0.0]] * (count + 1 - len(offsets))
        fixed = np.stack([transform(place=offset) for offset in offsets])
    elif all("dh" in entry for entry in entries):
        axes = np.tile([0.0, 0.0, 1.0], (count, 1))
        fixed = np.stack([np.eye(4)] * (count + 1))
        for k, entry in enumerate(entries):
            a, d, alpha, theta = (_number(entry["dh"].get(name, 0.0)) for name in ("a", "d", "alpha", "theta"))
            fixed[k] = fixed[k] @ transform(turned(np.array([0.0, 0.0, theta])))
            fixed[k + 1] = transform(turned(np.array([alpha, 0.0, 0.0])), (a, 0.0, d))
    else:
        raise ValueError(f"{path}: neither dh nor product_of_exponentials")
    links = [entry.get("link", {}) for entry in entries]
    weighed = all(link.get("mass", "unknown") != "unknown" for link in links)
    mass = np.array([_number(link["mass"]) if weighed else 0.0 for link in links])
    centre = np.stack([_centre(link, fixed[k + 1, :3, 3]) for k, link in enumerate(links)])
    slides = np.array([entry["joint"].get("type", "revolute") in ("prismatic", "slide") for entry in entries])
    axes = axes / np.linalg.norm(axes, axis=1, keepdims=True)
    return Chain(fixed, axes, slides, np.array(gravity), mass, centre, np.zeros((count, 3, 3)), weighed)


def _centre(link: Mapping[str, Any], onward: Array) -> Array:
    """A link's centre of mass, along the way to the next joint."""
    length = float(np.linalg.norm(onward))
    if "center_of_mass" not in link or length == 0.0:
        return onward / 2.0
    return onward / length * _number(link["center_of_mass"])


@dataclass(frozen=True)
class _Joint:
    """A joint of a URDF."""

    name: str
    kind: str
    parent: str
    child: str
    place: Array
    axis: Array


def from_urdf(path: Path, joints: Sequence[str]) -> Chain:
    """The arm that named joints of a URDF move, all others held at zero.

    Args:
        path: The file.
        joints: Names of the joints that move, from the base out.

    Returns:
        The chain. What hangs on a link by joints that do not move counts as part of it.

    Raises:
        ValueError: The joints are no chain.
    """
    root = ElementTree.parse(path).getroot()
    every = {item.name: item for item in map(_joint, root.findall("joint"))}
    bodies = {str(link.get("name")): _body(link) for link in root.findall("link")}
    above = {item.child: item for item in every.values()}
    fixed: list[Array] = []
    inside = np.eye(4)
    previous: str | None = None
    for name in joints:
        path_up, link = [every[name]], every[name].parent
        while link in above and link != previous:
            path_up.append(above[link])
            link = above[link].parent
        if previous is not None and link != previous:
            raise ValueError(f"{path}: {name} does not follow the joint before it")
        inside = np.eye(4)
        for item in reversed(path_up):
            inside = inside @ item.place
        fixed.append(inside)
        previous = every[name].child
    fixed.append(np.eye(4))
    sums = [_merged(every[name].child, set(joints), every, bodies) for name in joints]
    moving = [every[name] for name in joints]
    mass = np.array([item[0] for item in sums])
    first = np.array([item[1] for item in sums])
    return Chain(
        np.stack(fixed),
        np.stack([item.axis for item in moving]),
        np.array([item.kind == "prismatic" for item in moving]),
        np.array([0.0, 0.0, -9.81]),
        mass,
        first / np.where(mass > 0.0, mass, 1.0)[:, None],
        np.stack([item[2] for item in sums]),
        True,
    )


def _merged(
    link: str, moving: set[str], every: Mapping[str, _Joint], bodies: Mapping[str, tuple[float, Array, Array]]
) -> tuple[float, Array, Array]:
    """Mass, first moment and inertia about the origin of a link with all that is fixed to it."""
    mass, first, inertia = bodies[link]
    for item in every.values():
        if item.parent == link and item.name not in moving:
            more, there, about = _merged(item.child, moving, every, bodies)
            rotation, place = item.place[:3, :3], item.place[:3, 3]
            turned_first = rotation @ there
            # Steiner, from the child's origin to the parent's: both cross terms count.
            lever, moment = skew(place), skew(turned_first)
            inertia = inertia + rotation @ about @ rotation.T - (more * lever @ lever + lever @ moment + moment @ lever)
            mass, first = mass + more, first + turned_first + more * place
    return mass, first, inertia


def _numbers(element: ElementTree.Element | None, key: str, default: str) -> Array:
    text = default if element is None else element.get(key, default)
    return np.array([float(item) for item in text.split()])


def _origin(element: ElementTree.Element | None) -> Array:
    roll, pitch, yaw = _numbers(element, "rpy", "0 0 0")
    about_z, about_y, about_x = (
        turned(item) for item in (np.array([0, 0, yaw]), np.array([0, pitch, 0]), np.array([roll, 0, 0]))
    )
    return transform(about_z @ about_y @ about_x, _numbers(element, "xyz", "0 0 0"))


def _joint(element: ElementTree.Element) -> _Joint:
    axis = _numbers(element.find("axis"), "xyz", "1 0 0")
    parent, child = element.find("parent"), element.find("child")
    return _Joint(
        str(element.get("name")),
        str(element.get("type")),
        "" if parent is None else str(parent.get("link")),
        "" if child is None else str(child.get("link")),
        _origin(element.find("origin")),
        axis / max(float(np.linalg.norm(axis)), 1e-12),
    )


def _body(link: ElementTree.Element) -> tuple[float, Array, Array]:
    """Mass, first moment and inertia about the link's origin."""
    inertial = link.find("inertial")
    if inertial is None:
        return 0.0, np.zeros(3), np.zeros((3, 3))
    weight, tensor = inertial.find("mass"), inertial.find("inertia")
    mass = 0.0 if weight is None else float(weight.get("value", "0"))
    place = _origin(inertial.find("origin"))

    def moment(key: str) -> float:
        return 0.0 if tensor is None else float(tensor.get(key, "0"))

    xx, xy, xz, yy, yz, zz = (moment(key) for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
    about = place[:3, :3] @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ place[:3, :3].T
    lever = skew(place[:3, 3])
    return mass, mass * place[:3, 3], about - mass * lever @ lever
