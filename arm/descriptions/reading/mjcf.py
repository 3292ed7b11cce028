"""MJCF, MuJoCo's format, as links and joints, as its compiler takes them
(https://mujoco.readthedocs.io/en/stable/XMLreference.html)."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path, PurePosixPath
from types import MappingProxyType

import numpy as np

from linkwright.core.arm.bodies.bodies import Mass, together
from linkwright.core.arm.chain.chain import FloatVector
from linkwright.core.arm.chain.vectors import ZERO
from linkwright.core.arm.descriptions.reading.tree import transform, turned
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError, shown

from .elements import Element, read_elements
from .meshes import solid
from .mjcf_words import Mjcf, direction, numbers
from .tree import NO_STEP, Frame, Inertial, Kind, Limits, Mimic, Robot, Shape, TreeJoint, TreeLink

_WORLD = "world"
_KINDS: Mapping[str, Kind] = MappingProxyType(
    {"hinge": "revolute", "slide": "prismatic", "ball": "ball", "free": "floating"}
)
_READ = ("compiler", "option", "default", "asset", "worldbody", "size", "visual", "statistic")
_OF_A_BODY = ("inertial", "joint", "freejoint", "geom", "site", "body", "frame")
_WEIGHTLESS = ("plane", "hfield")
_WATER = "1000"
"""kg/m^3: the density of a geom that has none."""
_FULL = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
"""What the numbers of `fullinertia` are in a tensor."""


def mjcf_tree(top: Element) -> Robot:
    """The tree below the root element of an MJCF, whose bodies without joints are fixed and whose sites are links
    without weight; bodies weigh what their inertials say, or else their geoms.

    Raises:
        InputError: An element is wrong, or another file's parts make bodies that are not in this one.
    """
    return _Reading(with_includes(top)).robot()


def with_includes(top: Element) -> Element:
    """A root element with what its `<include>`s name in their places; files beside it or below its folder."""
    return _included(top, top.file.parent, frozenset({top.file.resolve()}))


def _included(element: Element, folder: Path, read: frozenset[Path]) -> Element:
    children: list[Element] = []
    for child in element.children:
        if child.tag != "include":
            children.append(_included(child, folder, read))
            continue
        file = (folder / child.text("file", 'file="arm.xml", say')).resolve()
        if not file.is_relative_to(folder.resolve()) or file in read:
            raise child.error("names this file again, or one outside its folder; put what it holds into this file")
        children += _included(read_elements(file), folder, read | {file}).children
    return replace(element, children=children)


_Geom = tuple[Element, Mapping[str, str], Array]
"""A geom with its attributes, and where its frame stands in the body."""


@dataclass(frozen=True)
class _Weight:
    """A body's mass as far as it is `placed` (None: nothing is), the meshes that are `unread`, the mass (kg) that these
    have somewhere (`unplaced`), and whether all of it is `known`."""

    placed: Mass | None
    unread: tuple[str, ...] = ()
    unplaced: float = 0.0
    known: bool = True


@dataclass
class _Reading:
    top: Element
    links: dict[str, TreeLink] = field(default_factory=dict[str, TreeLink])
    joints: dict[str, TreeJoint] = field(default_factory=dict[str, TreeJoint])
    below: dict[str, list[TreeJoint]] = field(default_factory=dict[str, list[TreeJoint]])
    above: dict[str, TreeJoint] = field(default_factory=dict[str, TreeJoint])

    def __post_init__(self) -> None:
        self.words = Mjcf(self.top)
        self.file = self.top.file
        self.meshes = {
            said.get("name") or PurePosixPath(said.get("file", "")).stem: said
            for assets in self.top.all("asset")
            for mesh in assets.all("mesh")
            for said in [self.words.attributes(mesh, "main")]
        }

    def robot(self) -> Robot:
        """The whole tree."""
        self._link(_WORLD, TreeLink(None, (), (), weighed=True))
        worlds = list(self.top.all("worldbody"))
        for world in worlds:
            for child, inherited, step in self.words.inside(world, "main", np.eye(4)):
                if child.tag == "body":
                    self._body(child, _WORLD, inherited, step)
        if not worlds:
            raise InputError(self.file, "", "holds no <worldbody>")
        self._tie()
        self._scale()
        unread = [tag for item in self.top.children if (tag := item.tag) not in _READ and not self._is_tie(item)]
        gravity = next((item for item in reversed(list(self.top.all("option"))) if "gravity" in item.attributes), None)
        down: FloatVector = (0.0, 0.0, -9.81) if gravity is None else gravity.triple("gravity", ZERO)
        name = " ".join(self.top.attributes.get("model", "").split()) or self.file.stem
        below = {key: tuple(value) for key, value in self.below.items()}
        beside = tuple(dict.fromkeys(unread))
        return Robot(name, self.file, _WORLD, self.links, self.joints, self.above, below, down, beside)

    def _link(self, name: str, link: TreeLink) -> None:
        self.links[name] = link
        self.below[name] = []

    def _joint(self, joint: TreeJoint, *, ends: bool = True) -> None:
        """Take up a joint; without `ends` its child is there for whom names it, and no end of the tree."""
        self.joints[joint.name] = self.above[joint.child] = joint
        if ends:
            self.below[joint.parent].append(joint)

    def _body(self, element: Element, parent: str, inherited: str, step: Array) -> None:
        """Take up a body and all that hangs on it; the frame that it is in stands at `step` in the link `parent`."""
        inherited = element.attributes.get("childclass", inherited)
        name = _unlike(element.attributes.get("name") or f"body{len(self.links)}", self.links)
        parts = list(self.words.inside(element, inherited, np.eye(4)))
        moving = [part for part in parts if part[0].tag in ("joint", "freejoint")]
        here = step @ self.words.frame(element)
        for number, (joint, class_, placed) in enumerate(moving, start=1):
            link = name if number == len(moving) else _unlike(f"{name}_{number}", self.links)
            here = self._moving(joint, self.words.attributes(joint, class_), placed, parent, link, here)
            self._link(link, TreeLink(None, (), (), weighed=True))
            parent = link
        if not moving:
            bare = replace(element, children=[])
            self._link(name, TreeLink(None, (), (), weighed=True))
            self._joint(_fixed(_unlike(f"{name} (fixed)", self.joints), parent, name, here, bare))
            here = np.eye(4)
        self.links[name] = self._weighed(element, parts, here)
        for child, class_, placed in parts:
            if child.tag == "body":
                self._body(child, name, class_, here @ placed)
        self._sites(name, [part for part in parts if part[0].tag == "site"], here)

    def _moving(
        self, joint: Element, attributes: Mapping[str, str], placed: Array, parent: str, link: str, here: Array
    ) -> Array:
        """Take up a joint, the body of which stands at `here` in the link `parent` at the joint's reference; returns
        where it stands in the link that the joint carries, which has its origin on the joint's axis."""
        kind = _KINDS.get(attributes.get("type", "hinge") if joint.tag == "joint" else "free")
        if kind is None:
            raise joint.error(f"type {shown(attributes['type'])} is none of {', '.join(_KINDS)}")
        turns = kind == "revolute"
        unit = self.words.to_radians if turns else 1.0
        axis = placed[:3, :3] @ direction(joint, numbers(joint, attributes.get("axis", "0 0 1"), 3))
        point = placed[:3, :3] @ numbers(joint, attributes.get("pos", "0 0 0"), 3) + placed[:3, 3]
        first = {name: self._first(joint, attributes, name) for name in ("ref", "springref", "damping", "stiffness")}
        back = np.eye(4)
        if turns:
            back = transform(turned(axis, -first["ref"] * unit), ZERO)
        elif kind == "prismatic":
            back = transform(np.eye(3), -first["ref"] * axis)
        limits = self._limits(joint, attributes, unit)
        if turns and not math.isfinite(limits.upper):
            kind = "continuous"
        name = joint.attributes.get("name") or _unlike(f"{link}_joint", self.joints)
        if name in self.joints:
            raise joint.error("is there already; names are unique")
        self._joint(
            TreeJoint(
                name,
                kind,
                parent,
                link,
                _frame(here @ transform(np.eye(3), point) @ back),
                _vector(axis),
                limits,
                None,
                self._first(joint, attributes, "frictionloss"),
                first["damping"],
                joint,
                self._first(joint, attributes, "armature"),
                first["stiffness"],
                first["springref"] * unit,
            )
        )
        return transform(np.eye(3), -point)

    def _first(self, element: Element, attributes: Mapping[str, str], name: str) -> float:
        """A number, 0 by default; of a polynomial in speed or deflection its linear part."""
        words = attributes.get(name, "0").split()
        return float(numbers(element, words[0] if words else "", 1)[0])

    def _limits(self, joint: Element, attributes: Mapping[str, str], unit: float) -> Limits:
        """The range (where there is none, all numbers), and the greatest effort of joint and actuators."""
        low, high = (unit * number for number in numbers(joint, attributes.get("range", "0 0"), 2))
        if low > high:
            raise joint.error("has a range that ends below where it begins; turn it round")
        if low == high:
            low, high = -math.inf, math.inf
        efforts: list[float] = []
        if self._limited(attributes, "actuatorfrclimited", "actuatorfrcrange"):
            efforts.append(float(np.abs(numbers(joint, attributes["actuatorfrcrange"], 2)).max()))
        for actuators in self.top.all("actuator"):
            for child in actuators.children:
                drive = self.words.attributes(child, "main")
                if drive.get("joint", "") == joint.attributes.get("name") and self._limited(
                    drive, "forcelimited", "forcerange"
                ):
                    geared = abs(self._first(child, drive, "gear")) if "gear" in drive else 1.0
                    efforts.append(geared * float(np.abs(numbers(child, drive["forcerange"], 2)).max()))
        return Limits(low, high, min(efforts, default=None), None)

    def _limited(self, attributes: Mapping[str, str], switch: str, bounds: str) -> bool:
        switch_value = attributes.get(switch, "auto")
        if switch_value == "auto" and self.words.compiler.get("autolimits", "true") == "true":
            return bounds in attributes
        return switch_value == "true"

    def _sites(self, link: str, sites: list[tuple[Element, str, Array]], here: Array) -> None:
        """Take up the sites of a body; the only one of a body that carries no other is its end."""
        ends = len(sites) == 1 and not self.below[link]
        for site, class_, placed in sites:
            name = site.attributes.get("name", "")
            if not name or name in self.links:
                continue
            at = here @ placed @ self.words.frame(site, self.words.attributes(site, class_))
            self._link(name, TreeLink(None, (), (), weighed=True))
            self._joint(_fixed(_unlike(f"{name} (site)", self.joints), link, name, at, site), ends=ends)

    def _weighed(self, body: Element, parts: list[tuple[Element, str, Array]], here: Array) -> TreeLink:
        """A link with the weight that the compiler gives its body, which stands at `here` in it."""
        geoms = [
            (item, self.words.attributes(item, class_), placed) for item, class_, placed in parts if item.tag == "geom"
        ]
        weight = self._weight(body, geoms)
        whole = weight.placed if weight.unplaced else self._bounded(weight.placed)
        beside = [item.tag for item, _, _ in parts if item.tag not in _OF_A_BODY]
        beside += ["gravcomp"] if body.number("gravcomp", 0.0) else []
        inertial = _placed(whole, here) if weight.known and whole is not None else None
        unplaced = weight.unplaced if weight.known else 0.0
        return TreeLink(inertial, self._shapes(geoms, here), tuple(beside), weight.known, weight.unread, unplaced)

    def _weight(self, body: Element, geoms: Sequence[_Geom]) -> _Weight:
        """What a body weighs by its inertial, or else by its geoms."""
        from_geoms, inertial = self.words.compiler.get("inertiafromgeom", "auto"), body.one("inertial")
        if inertial is not None and from_geoms != "true":
            return _Weight(self._inertial(inertial))
        if from_geoms == "false":
            return _Weight(None)
        counted = [geom for geom in geoms if self._counts(*geom[:2])]
        masses = [self._of_geom(*geom) for geom in counted]
        lacking = [geom for geom, mass in zip(counted, masses, strict=True) if mass is None]
        meshes = [self._unread_mesh(self._shape(*geom)) for geom in lacking]
        return _Weight(
            together(mass for mass in masses if mass is not None),
            tuple(mesh for mesh in meshes if mesh is not None),
            sum((float(numbers(geom, entry.get("mass", "0"), 1)[0]) for geom, entry, _ in lacking), 0.0),
            None not in meshes and all("mass" in entry for _, entry, _ in lacking),
        )

    def _unread_mesh(self, shape: Shape) -> str | None:
        """The file of a mesh that is not there as a closed STL; None of any other shape."""
        made = solid(shape, self.file) if shape.kind == "mesh" else None
        return shape.file if shape.kind == "mesh" and (made is None or made.volume is None) else None

    def _shapes(self, geoms: Sequence[_Geom], here: Array) -> tuple[Shape, ...]:
        """What a body is drawn by: geoms that collide with nothing, where it has such."""
        drawn = [geom for geom in geoms if not self._collides(geom[1])] or geoms
        shapes = (self._shape(*geom, here) for geom in drawn)
        return tuple(shape for shape in shapes if shape.kind not in _WEIGHTLESS)

    def _inertial(self, element: Element) -> Mass:
        stands = self.words.frame(element)
        tensor = np.zeros((3, 3))
        if "fullinertia" in element.attributes:
            for pair, value in zip(_FULL, numbers(element, element.attributes["fullinertia"], 6), strict=True):
                tensor[pair] = tensor[pair[::-1]] = value
        else:
            tensor = np.diag(element.triple("diaginertia", ZERO))
        mass = element.number("mass")
        if mass < 0.0:
            raise element.error("has a negative mass")
        return Mass(mass, stands[:3, 3], stands[:3, :3] @ tensor @ stands[:3, :3].T)

    def _bounded(self, whole: Mass | None) -> Mass | None:
        """A body's weight as the compiler bounds and balances it."""
        least, small = (float(self.words.setting(name, "0")[0]) for name in ("boundmass", "boundinertia"))
        if whole is None:
            return Mass(least, np.zeros(3), small * np.eye(3)) if least else None
        moments, axes = np.linalg.eigh(whole.inertia)
        if self.words.compiler.get("balanceinertia") == "true" and moments[0] + moments[1] < moments[2]:
            moments = np.full(3, moments.mean())
        if least > whole.mass or small > moments[0] or not np.allclose(moments, np.linalg.eigvalsh(whole.inertia)):
            return Mass(max(least, whole.mass), whole.center, axes @ np.diag(np.maximum(moments, small)) @ axes.T)
        return whole

    def _counts(self, geom: Element, attributes: Mapping[str, str]) -> bool:
        """Whether a geom is of the groups that weigh."""
        low, high = self.words.setting("inertiagrouprange", "0 5")
        return bool(low <= self._first(geom, attributes, "group") <= high)

    @staticmethod
    def _collides(attributes: Mapping[str, str]) -> bool:
        return attributes.get("contype", "1") != "0" or attributes.get("conaffinity", "1") != "0"

    def _of_geom(self, geom: Element, attributes: Mapping[str, str], placed: Array) -> Mass | None:
        """What a geom weighs, in its body; None where that depends on what cannot be read."""
        mass = None if "mass" not in attributes else float(numbers(geom, attributes["mass"], 1)[0])
        density = float(numbers(geom, attributes.get("density", _WATER), 1)[0])
        if mass == 0.0 or (mass is None and density == 0.0) or attributes.get("type", "sphere") in _WEIGHTLESS:
            return Mass(0.0, np.zeros(3), np.zeros((3, 3)))
        shape = self._shape(geom, attributes, placed)
        made = solid(shape, self.file)
        if made is None or made.volume is None or attributes.get("shellinertia") == "true":
            return None
        return made.weighing(density if mass is None else mass / made.volume)

    def _shape(self, geom: Element, attributes: Mapping[str, str], placed: Array, here: Array | None = None) -> Shape:
        """A geom as a shape in its body, or in the link in which that stands at `here`; without sizes where those
        depend on what cannot be read."""
        kind = attributes.get("type", "sphere")
        stands = self.words.frame(geom, attributes)
        size = [
            *numbers(geom, attributes.get("size", "0 0 0"), len(attributes.get("size", "0 0 0").split())),
            0.0,
            0.0,
            0.0,
        ][:3]
        if "fromto" in attributes:
            ends = numbers(geom, attributes["fromto"], 6).reshape(2, 3)
            way = ends[0] - ends[1]
            stands = self.words.along(geom, ends.mean(axis=0), way)
            half = float(np.linalg.norm(way)) / 2.0
            size = [size[0], half, 0.0] if kind in ("capsule", "cylinder") else [size[0], size[0], half]
        at = placed @ stands if here is None else here @ placed @ stands
        origin = _frame(at)
        if kind == "mesh":
            asset = self.meshes.get(attributes.get("mesh", ""), {})
            weighs = asset.get("inertia", "legacy")
            plain = "refpos" not in asset and "refquat" not in asset and weighs in ("legacy", "exact")
            scale = tuple(map(float, numbers(geom, asset.get("scale", "1 1 1"), 3))) if plain else ()
            folder = self.words.compiler.get("meshdir", self.words.compiler.get("assetdir", ""))
            file = str(PurePosixPath(folder) / asset.get("file", ""))
            return Shape("mesh", scale, origin, file, hulls=weighs == "legacy")
        if "mesh" in attributes:
            return Shape(kind, (), origin)
        sizes = {
            "sphere": size[:1],
            "capsule": [size[0], 2.0 * size[1]],
            "cylinder": [size[0], 2.0 * size[1]],
            "box": [2.0 * item for item in size],
            "ellipsoid": size,
        }
        return Shape(kind, tuple(map(float, sizes.get(kind, ()))), origin)

    def _is_tie(self, section: Element) -> bool:
        return section.tag == "equality" and all(child.tag == "joint" for child in section.children)

    def _tie(self) -> None:
        """Joints that follow others by a straight line."""
        for section in self.top.all("equality"):
            for item in section.all("joint"):
                attributes = self.words.attributes(item, "main")
                joint, of = self.joints.get(attributes.get("joint1", "")), self.joints.get(attributes.get("joint2", ""))
                if joint is None or of is None or attributes.get("active", "true") == "false":
                    continue
                words = attributes.get("polycoef", "0 1 0 0 0").split()
                constant, slope, *bent = numbers(item, " ".join(words), len(words))
                if any(bent):
                    raise item.error(f"ties {shown(joint.name)} by a curve; an arm's joints follow straight lines")
                # Both coordinates count from their references.
                reference, others = (self._reference(one) for one in (joint, of))
                mimic = Mimic(of.name, float(slope), float(constant + reference - slope * others))
                tied = replace(joint, mimic=mimic)
                self.joints[joint.name] = self.above[joint.child] = tied
                beside = self.below[joint.parent]
                beside[next(k for k, one in enumerate(beside) if one.name == joint.name)] = tied

    def _reference(self, joint: TreeJoint) -> float:
        unit = self.words.to_radians if joint.kind in ("revolute", "continuous") else 1.0
        return unit * self._first(joint.element, joint.element.attributes, "ref")

    def _scale(self) -> None:
        """Bring all masses together to what the compiler is told that they are."""
        total = float(self.words.setting("settotalmass", "-1")[0])
        if total <= 0.0:
            return
        held = sum(link.mass for link in self.links.values())
        if held == 0.0 or any(link.weighed is False for link in self.links.values()):
            raise InputError(self.file, "compiler", "has settotalmass, but what some bodies weigh is not known")
        for name, link in self.links.items():
            share = total / held
            link = replace(link, unplaced=share * link.unplaced)
            if (inertial := link.inertial) is not None:
                tensor = None if inertial.inertia is None else share * inertial.inertia
                link = replace(link, inertial=Inertial(share * inertial.mass, inertial.center, tensor))
            self.links[name] = link


def _fixed(name: str, parent: str, child: str, at: Array, element: Element) -> TreeJoint:
    return TreeJoint(name, "fixed", parent, child, _frame(at), (0.0, 0.0, 1.0), None, None, 0.0, 0.0, element)


def _frame(matrix: Array) -> Frame:
    if np.array_equal(matrix, np.eye(4)):
        return NO_STEP
    x, y, z = (_vector(row) for row in matrix[:3, :3])
    return (x, y, z), _vector(matrix[:3, 3])


def _placed(whole: Mass, at: Array) -> Inertial:
    """A mass in the axes of the link that holds its body at `at` (4, 4)."""
    axes, shift = at[:3, :3], at[:3, 3]
    tensor = axes @ whole.inertia @ axes.T if whole.inertia.any() else None
    return Inertial(whole.mass, _vector(axes @ whole.center + shift), tensor)


def _vector(values: Array) -> FloatVector:
    x, y, z = (float(value) + 0.0 for value in values)
    return (x, y, z)


def _unlike(name: str, taken: Mapping[str, object]) -> str:
    while name in taken:
        name += "_"
    return name
