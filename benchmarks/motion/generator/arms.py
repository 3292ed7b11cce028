"""Arms of six and seven axes and a SCARA: drawn geometry and masses, as MuJoCo bodies and as the tool's arm file.

Every joint turns about, or slides along, the z axis of its frame; the next frame stands at (a, 0, d) and is turned by
alpha about x (J. Denavit & R. S. Hartenberg, J. Appl. Mech. 22 (1955), 215-221).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple
from xml.etree.ElementTree import Element, SubElement, tostring

import mujoco
import numpy as np
import yaml
from scipy.spatial.transform import Rotation

from benchmarks.blind.generator.vectors import Array

GRAVITY = 9.81
STEP = 2e-3  # s


@dataclass(frozen=True)
class Body:
    """A link's mass (kg), centre (m) and inertia about it (kg*m^2), in the axes of its joint's frame."""

    mass: float
    centre: Array
    inertia: Array

    def with_point(self, mass: float, at: Array) -> Body:
        """With a point mass fixed to it."""
        total = self.mass + mass
        centre = (self.mass * self.centre + mass * at) / total
        about = self.inertia + _steiner(self.mass, self.centre - centre) + _steiner(mass, at - centre)
        return Body(total, centre, about)


def _steiner(mass: float, way: Array) -> Array:
    return mass * (float(way @ way) * np.eye(3) - np.outer(way, way))


@dataclass(frozen=True)
class Axis:
    """A joint, the geometry of its link and how far and fast it moves."""

    slide: bool
    a: float
    d: float
    alpha: float
    reach: tuple[float, float]
    speed: float
    acceleration: float


@dataclass(frozen=True)
class Arm:
    """An arm, from the base out; `drives` (3, n): Coulomb and viscous friction and rotor inertia, by the arm file."""

    family: str
    axes: tuple[Axis, ...]
    bodies: tuple[Body, ...]
    drives: Array

    @property
    def count(self) -> int:
        """How many joints."""
        return len(self.axes)

    @property
    def reach(self) -> float:
        """Its length, stretched, m."""
        return sum(abs(axis.a) + abs(axis.d) for axis in self.axes)

    def with_point(self, joint: int, mass: float, at: Array) -> Arm:
        """With a point mass fixed to a link."""
        bodies = list(self.bodies)
        bodies[joint] = bodies[joint].with_point(mass, at)
        return replace(self, bodies=tuple(bodies))

    @property
    def tip(self) -> Array:
        """The flange in the last joint's frame."""
        last = self.axes[-1]
        return np.array([last.a, 0.0, last.d])


_ANTHROPOMORPHIC = ((90, 0, 0, 90, -90, 0), (0, 0.5, 0.42, 0, 0, 0), (0.16, 0.02, -0.02, 0.12, 0.1, 0.09))
_SPHERICAL = ((90, 0, 90, -90, 90, 0), (0.1, 0.5, 0.06, 0, 0, 0), (0.35, 0, 0, 0.45, 0, 0.09))
_SEVEN = ((-90, 90, -90, 90, -90, 90, 0), (0, 0, 0, 0, 0, 0.05, 0), (0.32, 0, 0.38, 0, 0.36, 0, 0.12))
_SCARA = ((0, 0, 0, 0), (0.38, 0.3, 0, 0), (0.2, 0.05, 0, -0.1))
FAMILIES = {
    "six_offset_wrist": (_ANTHROPOMORPHIC, (7.0, 11.0, 5.0, 2.2, 2.0, 0.6)),
    "six_spherical_wrist": (_SPHERICAL, (12.0, 9.0, 6.0, 3.0, 1.6, 0.5)),
    "seven": (_SEVEN, (5.0, 4.5, 3.6, 3.2, 2.6, 1.5, 0.7)),
    "scara": (_SCARA, (9.0, 5.0, 1.5, 0.5)),
}


def draw_arm(family: str, rng: np.random.Generator) -> Arm:
    """An arm of the family; lengths are whole millimetres, masses tens of grams."""
    (alphas, a, d), masses = FAMILIES[family]
    scale = float(rng.uniform(0.7, 1.3))
    axes, bodies = [], []
    for i, alpha in enumerate(alphas):
        slide = family == "scara" and i == 2
        ai, di = (round(float(x) * scale * float(rng.uniform(0.85, 1.15)), 3) for x in (a[i], d[i]))
        outer = i >= len(alphas) - 3
        reach, speed, acceleration = (
            ((-0.12, 0.12), 0.4, 1.5) if slide else ((-2.4, 2.4) if outer else (-1.5, 1.5), 2.4, 9.0 if outer else 5.0)
        )
        axes.append(Axis(slide, ai, di, math.radians(alpha), reach, speed, acceleration))
        bodies.append(_draw_body(masses[i] * scale**2, np.array([ai, 0.0, di]), slide, rng))
    return Arm(family, tuple(axes), tuple(bodies), np.zeros((3, len(axes))))


def _draw_body(mass: float, span: Array, slide: bool, rng: np.random.Generator) -> Body:
    """A link's body: a box from its joint to the next, off its line by centimetres, turned a little."""
    mass = round(mass * float(rng.uniform(0.75, 1.25)), 2)
    size = np.maximum(np.abs(span), 0.07) + rng.uniform(0.0, 0.03, 3)
    if slide:
        size[2] = 0.35
    off = rng.uniform(-0.02, 0.02, 3)
    squares = mass / 12.0 * (np.sum(size**2) - size**2) * rng.uniform(0.8, 1.2)
    turn = Rotation.from_rotvec(rng.normal(0.0, 0.15, 3)).as_matrix()
    return Body(mass, np.round(span * rng.uniform(0.35, 0.6) + off, 4), turn @ np.diag(squares) @ turn.T)


def with_drives(arm: Arm, drives: Array) -> Arm:
    """With what the arm file declares of its drives, to three digits."""
    return replace(arm, drives=np.array([[float(f"{x:.3g}") for x in drive] for drive in drives]))


class Elastic(NamedTuple):
    """A gear that gives: the stiffness (N*m/rad) and damping between a joint's rotor and its link."""

    stiffness: float
    damping: float


class Hung(NamedTuple):
    """A weight on a string: mass (kg), length (m), damping (N*m*s/rad)."""

    mass: float
    length: float
    damping: float


def mjcf(
    arm: Arm,
    *,
    drives: bool = True,
    elastic: dict[int, Elastic] | None = None,
    springs: dict[int, float] | None = None,
    hung: Hung | None = None,
    rocking: bool = False,
) -> str:
    """MJCF of an arm. Without `drives` only its bodies, for inverse dynamics. `rocking` puts it on two free hinges."""
    root = Element("mujoco")
    SubElement(root, "compiler", angle="radian", autolimits="false", balanceinertia="false")
    option = SubElement(root, "option", gravity=f"0 0 {-GRAVITY}", timestep=repr(STEP), integrator="implicitfast")
    SubElement(option, "flag", contact="disable")
    parent = SubElement(root, "worldbody")
    if rocking:
        parent = SubElement(parent, "body", name="base")
        for name, axis in (("rock_x", "1 0 0"), ("rock_y", "0 1 0")):
            SubElement(parent, "joint", name=name, axis=axis, type="hinge")
        SubElement(parent, "inertial", pos="0 0 0", mass="20", diaginertia="2 2 2")
    place, turn = "0 0 0", "1 0 0 0"
    for i, (axis, body) in enumerate(zip(arm.axes, arm.bodies, strict=True)):
        parent = SubElement(
            parent, "body", pos=place, quat=turn, name=f"link{i + 1}" + "_rotor" * (i in (elastic or {}))
        )
        joint = {"name": f"q{i + 1}", "type": "slide" if axis.slide else "hinge", "axis": "0 0 1"}
        if drives:
            names = ("frictionloss", "damping", "armature")
            joint |= {name: repr(float(x)) for name, x in zip(names, arm.drives[:, i], strict=True)}
            joint |= {"solreffriction": "0.004 1", "solimpfriction": "0.98 0.98 0.001 0.5 2"}
            joint |= {"stiffness": repr((springs or {}).get(i, 0.0)), "springref": "0"}
        SubElement(parent, "joint", joint)
        if i in (elastic or {}):
            gear = (elastic or {})[i]
            SubElement(parent, "inertial", pos="0 0 0", mass="1e-6", diaginertia="1e-8 1e-8 1e-8")
            parent = SubElement(parent, "body", name=f"link{i + 1}")
            giving = {"stiffness": repr(gear.stiffness), "damping": repr(gear.damping)}
            SubElement(parent, "joint", {"name": f"give{i + 1}", "type": joint["type"], "axis": "0 0 1", **giving})
        tensor = body.inertia
        six = [tensor[k] for k in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
        SubElement(parent, "inertial", pos=_text(body.centre), mass=repr(float(body.mass)), fullinertia=_text(six))
        place, half = _text([axis.a, 0.0, axis.d]), axis.alpha / 2.0
        turn = _text([math.cos(half), math.sin(half), 0.0, 0.0])
    SubElement(parent, "site", name="tip", pos=_text(arm.tip))
    if hung is not None:
        weight = SubElement(parent, "body", name="hung", pos=_text(arm.tip))
        for name, way in (("swing_x", "1 0 0"), ("swing_y", "0 1 0")):
            SubElement(weight, "joint", name=name, type="hinge", axis=way, damping=repr(hung.damping))
        SubElement(weight, "inertial", pos=f"0 0 {-hung.length}", mass=repr(hung.mass), diaginertia="1e-3 1e-3 1e-3")
    return tostring(root, encoding="unicode")


def _text(values: object) -> str:
    return " ".join(repr(float(v)) for v in values)  # pyright: ignore


class Rigid:
    """Inverse dynamics of the bodies alone."""

    def __init__(self, model: mujoco.MjModel) -> None:
        self.model = model
        self.data = mujoco.MjData(model)

    @classmethod
    def of(cls, arm: Arm, gravity: Array | None = None) -> Rigid:
        """Of an arm, its base frame's gravity perhaps another."""
        model = mujoco.MjModel.from_xml_string(mjcf(arm, drives=False))
        if gravity is not None:
            model.opt.gravity[:] = gravity
        return cls(model)

    def torque(self, q: Array, velocity: Array, acceleration: Array) -> Array:
        """(N, n) that drives without friction give."""
        model, data, out = self.model, self.data, np.empty_like(q)
        result = np.zeros(model.nv)
        for k in range(len(q)):
            data.qpos[:], data.qvel[:], data.qacc[:] = q[k], velocity[k], acceleration[k]
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            mujoco.mj_comVel(model, data)
            mujoco.mj_rne(model, data, 1, result)
            out[k] = result
        return out

    def inertia(self, q: Array) -> Array:
        """(n, n), the mass matrix."""
        self.data.qpos[:] = q
        mujoco.mj_forward(self.model, self.data)
        full = np.zeros((self.model.nv, self.model.nv))
        mujoco.mj_fullM(self.model, self.data, full)
        return full


def arm_file(arm: Arm, effects: list[dict[str, object]]) -> str:
    """The tool's arm.yaml; links run along x, and where the next frame stands beyond that is its joint's origin."""
    chain, origin = [], {"xyz": ["0 m"] * 3, "rpy": ["0 deg"] * 3}
    for axis, body in zip(arm.axes, arm.bodies, strict=True):
        per = "" if axis.slide else "rad"
        reach = [f"{x} {per or 'm'}" for x in axis.reach]
        six = zip(("xx", "yy", "zz", "xy", "xz", "yz"), ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)), strict=True)
        link = {
            "length": f"{max(axis.a, 0.0)} m",
            "rigid": True,
            "mass": "0 kg",
            "inertia": {name: f"{body.inertia[at]:.10g} kg*m^2" for name, at in six},
            "masses": [{"mass": f"{body.mass:.10g} kg", "at": [f"{x:.10g} m" for x in body.centre], "on": "joint"}],
        }
        joint = {"type": "prismatic" if axis.slide else "revolute", "axis": "z", "range": reach}
        chain.append({"joint": joint, "origin": origin, "link": link})
        beyond = [f"{min(axis.a, 0.0)} m", "0 m", f"{axis.d} m"]
        origin = {"xyz": beyond, "rpy": [f"{math.degrees(axis.alpha):.10g} deg", "0 deg", "0 deg"]}
    weight = ["0 m/s^2", "0 m/s^2", f"{-GRAVITY} m/s^2"]
    file: dict[str, object] = {"name": f"{arm.family} of the proof", "gravity": weight, "chain": chain}
    file["tool"] = {"xyz": origin["xyz"]}
    return yaml.safe_dump(file | ({"effects": effects} if effects else {}), sort_keys=False, width=200)
