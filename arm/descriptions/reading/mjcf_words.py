"""What an MJCF file (https://mujoco.readthedocs.io/en/stable/XMLreference.html) tells its compiler: units, the order of
Euler angles, classes of defaults, and where its elements stand."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from types import MappingProxyType

import numpy as np

from linkwright.core.arm.descriptions.reading.tree import transform, turned
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import shown

from .elements import Element

_AXES = MappingProxyType({"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)})
_OF_OTHERS = ("attach", "replicate", "composite", "flexcomp")


class Mjcf:
    """An MJCF file's conventions: what its compiler is told, and the defaults that hold for each element."""

    def __init__(self, top: Element) -> None:
        self.compiler = _merged(top, "compiler")
        self.to_radians = 1.0 if self.compiler.get("angle", "degree") == "radian" else math.pi / 180.0
        self.order = self.compiler.get("eulerseq", "xyz")
        if len(self.order) != 3 or not set(self.order.lower()) <= set(_AXES):
            message = f"eulerseq is {shown(self.order)}; write three of x, y, z, X, Y and Z"
            raise next(item for item in top.all("compiler") if "eulerseq" in item.attributes).error(message)
        self.defaults: dict[str, dict[str, dict[str, str]]] = {}
        for element in top.all("default"):
            self._read_defaults(element, {}, "main")
        self.top = top

    def setting(self, name: str, default: str) -> Array:
        """The numbers of one of the compiler's settings. Raises `InputError`."""
        text = self.compiler.get(name, default)
        element = next((item for item in self.top.all("compiler") if name in item.attributes), self.top)
        return numbers(element, text, len(default.split()))

    def _read_defaults(self, element: Element, above: Mapping[str, dict[str, str]], name: str) -> None:
        local = {tag: dict(values) for tag, values in above.items()}
        for child in element.children:
            if child.tag != "default":
                local[child.tag] = {**local.get(child.tag, {}), **child.attributes}
        self.defaults[element.attributes.get("class", name)] = local
        for child in element.all("default"):
            self._read_defaults(child, local, name)

    def attributes(self, element: Element, inherited: str) -> dict[str, str]:
        """An element's attributes over those of its class."""
        local = element.attributes.get("class", inherited)
        return {**self.defaults.get(local, {}).get(element.tag, {}), **element.attributes}

    def frame(self, element: Element, said: Mapping[str, str] | None = None) -> Array:
        """Where an element stands in the body that it is in; `said` are its attributes where classes add to them."""
        said = element.attributes if said is None else said
        return transform(self._rotation(element, said), numbers(element, said.get("pos", "0 0 0"), 3))

    def inside(self, element: Element, inherited: str, step: Array) -> Iterator[tuple[Element, str, Array]]:
        """What stands in a body or in the world, with the class that it inherits and where its `<frame>`s put it."""
        for child in element.children:
            if child.tag in _OF_OTHERS:
                raise child.error(
                    "makes bodies that are not written here; let MuJoCo save the whole model (mj_saveLastXML)"
                )
            if child.tag == "frame":
                within = child.attributes.get("childclass", inherited)
                yield from self.inside(child, within, step @ self.frame(child))
            else:
                yield child, inherited, step

    def along(self, element: Element, center: Array, way: Array) -> Array:
        """Where what lies between two ends stands, its z along the `way` between them."""
        return transform(_turned_to(direction(element, way)), center)

    def _rotation(self, element: Element, attributes: Mapping[str, str]) -> Array:
        if "quat" in attributes:
            cosine, *vector = direction(element, numbers(element, attributes["quat"], 4))
            sine = float(np.linalg.norm(vector))
            return turned(np.array(vector), 2.0 * math.atan2(sine, cosine)) if sine else np.eye(3)
        if "axisangle" in attributes:
            *axis, angle = numbers(element, attributes["axisangle"], 4)
            return turned(direction(element, np.array(axis)), angle * self.to_radians)
        if "euler" in attributes:
            rotation = np.eye(3)
            for letter, angle in zip(self.order, numbers(element, attributes["euler"], 3), strict=True):
                step = turned(np.array(_AXES[letter.lower()]), angle * self.to_radians)
                rotation = rotation @ step if letter.islower() else step @ rotation
            return rotation
        if "xyaxes" in attributes:
            axes = numbers(element, attributes["xyaxes"], 6)
            x = direction(element, axes[:3])
            y = direction(element, axes[3:] - x * (x @ axes[3:]))
            return np.column_stack([x, y, np.cross(x, y)])
        if "zaxis" in attributes:
            return _turned_to(direction(element, numbers(element, attributes["zaxis"], 3)))
        return np.eye(3)


def direction(element: Element, vector: Array) -> Array:
    """A unit vector along one that an element gives. Raises `InputError`."""
    with np.errstate(over="ignore"):
        length = float(np.linalg.norm(vector))
    if not 0.0 < length < math.inf:
        raise element.error("has a direction without a length, or with one beyond all numbers")
    return vector / length


def numbers(element: Element, text: str, count: int) -> Array:
    """So many numbers (count,) of an element's text. Raises `InputError`."""
    try:
        values = np.array([float(word) for word in text.split()])
    except ValueError:
        values = np.zeros(0)
    if len(values) != count or not np.all(np.isfinite(values)):
        due = "a number is" if count == 1 else f"{count} numbers are"
        raise element.error(f"has {shown(text)} where {due} due")
    return values


def _turned_to(z: Array) -> Array:
    """The least turn (3, 3) that brings the z axis to a unit vector."""
    across = np.cross((0.0, 0.0, 1.0), z)
    angle = math.atan2(float(np.linalg.norm(across)), float(z[2]))
    return turned(across if across.any() else np.array((1.0, 0.0, 0.0)), angle)


def _merged(top: Element, tag: str) -> dict[str, str]:
    """The attributes of a section, which may be written in several parts, the last of which counts."""
    return {name: value for item in top.all(tag) for name, value in item.attributes.items()}
