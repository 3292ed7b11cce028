"""Serial chains of geometrically exact rods with elastic drives, solved on their deformed shape for all rows at once.

Fixed-point iteration: shape from strains, loads on that shape, strains and drive deflections from those loads. It
contracts by about (deflection / length) a round, so four rounds leave nothing that a tracker sees.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from benchmarks.blind.generator.beams import NODES, RodShape, Section, internal_loads, rod_shape
from benchmarks.blind.generator.vectors import Array, cross, dot, product, rotation_of, turned, turned_back


@dataclass(frozen=True)
class Joint:
    """A joint: prismatic or not, its axis in its own frame, the drive's compliance (rad/(N*m), m/N), its mass in kg."""

    prismatic: bool
    axis: tuple[float, float, float]
    compliance: float = 0.0
    mass: float = 0.0


@dataclass(frozen=True)
class Link:
    """A link along `direction`; without a section it is rigid, `line_mass` in kg/m in either case."""

    length: float
    direction: tuple[float, float, float]
    line_mass: float
    section: Section | None = None
    elastic_modulus: float = 0.0
    poisson_ratio: float = 0.3
    density: float = 0.0
    expansion: float = 12e-6
    depth: float = 0.1


@dataclass(frozen=True)
class Arm:
    """A serial chain from the base out, gravity in m/s^2 in the base frame, payload in kg at the tip."""

    name: str
    family: str
    joints: tuple[Joint, ...]
    links: tuple[Link, ...]
    gravity: tuple[float, float, float]
    payload: float
    planar: bool
    leave_out: tuple[str, ...] = ()

    @property
    def count(self) -> int:
        """Number of joints."""
        return len(self.joints)


def material_frame(joint: Joint, link: Link) -> Array:
    """Columns: along the link, across it in the plane in which the joint turns it, and normal to both."""
    x = np.array(link.direction, dtype=float)
    x /= np.linalg.norm(x)
    y = np.cross(np.array(joint.axis, dtype=float), x)
    if joint.prismatic or np.linalg.norm(y) < 1e-9:
        y = np.cross(np.array([0.0, 0.0, 1.0]), x)
        y = y if np.linalg.norm(y) > 1e-9 else np.array([0.0, 1.0, 0.0])
    y /= np.linalg.norm(y)
    return np.stack([x, y, np.cross(x, y)], axis=1)


def flexibility(link: Link) -> Array:
    """1/EA, 1/(kappa G A) in and across the plane, 1/GJ, 1/EI across and in the plane; zeros for a rigid link."""
    section = link.section
    if section is None:
        return np.zeros(6)
    e = link.elastic_modulus
    g = e / (2.0 * (1.0 + link.poisson_ratio))
    stiff = [
        e * section.area,
        g * section.shear_area_in_plane,
        g * section.shear_area_across,
        g * section.torsion,
        e * section.inertia_across,
        e * section.inertia_in_plane,
    ]
    return 1.0 / np.array(stiff)


@dataclass(frozen=True)
class Inputs:
    """What acts on each of m rows; the last axis is m. Angles in rad, slides in m, the rest SI."""

    q: Array  # (n, m) true coordinates of the drives' motors
    payload: Array  # (m,)
    force: Array  # (3, m) at the tip, base frame
    gravity: Array  # (3, m)
    joint: Array  # (n, m) displacement of each joint beyond q
    compliance: Array  # (n, m) of each drive
    shift: Array  # (n, 3, m) of each joint's pin in its bore, base frame
    axial: Array  # (n, m) stress-free strain of each link
    curvature: Array  # (n, m) stress-free curvature in the plane of each link
    line_mass: Array  # (n, m)
    flexibility: Array  # (n, 6, m)
    tool: Array  # (3, m) of the tip in the last link's frame


def nominal_inputs(arm: Arm, q: Array, payload: Array, force: Array) -> Inputs:
    """The arm as its file has it, nothing concealed."""
    n, m = q.shape
    zero = np.zeros((n, m))
    flexible = np.stack([flexibility(link) for link in arm.links])
    return Inputs(
        q=q,
        payload=payload,
        force=force,
        gravity=np.repeat(np.array(arm.gravity, dtype=float)[:, None], m, axis=1),
        joint=zero,
        compliance=np.repeat(np.array([joint.compliance for joint in arm.joints])[:, None], m, axis=1),
        shift=np.zeros((n, 3, m)),
        axial=zero,
        curvature=zero,
        line_mass=np.repeat(np.array([link.line_mass for link in arm.links])[:, None], m, axis=1),
        flexibility=np.repeat(flexible[:, :, None], m, axis=2),
        tool=np.zeros((3, m)),
    )


def stacked(parts: list[Inputs]) -> Inputs:
    """Several sets of rows as one."""
    names = [field.name for field in fields(Inputs)]
    return Inputs(**{name: np.concatenate([getattr(part, name) for part in parts], axis=-1) for name in names})


@dataclass(frozen=True)
class Solution:
    """Where the arm comes to rest: base frame, m, rad, N, N*m."""

    tip: Array  # (3, m)
    rotation: Array  # (3, 3, m) of the last link's end
    joint_at: Array  # (n, 3, m)
    end_at: Array  # (n, 3, m) end of each link
    axis: Array  # (n, 3, m)
    torque: Array  # (n, m) of all beyond, about (a slide: along) each axis
    carried: Array  # (n, 3, m) force that each joint carries
    link_turn: Array  # (n, 3, m) rotation of each link's end by bending


def solve(arm: Arm, inputs: Inputs, rounds: int = 4) -> Solution:
    """Equilibrium on the deformed shape. `rounds` of the fixed point; 1 is first-order theory."""
    n, m = inputs.q.shape
    strain = np.zeros((n, 3, m, NODES))
    bend = np.zeros((n, 3, m, NODES))
    strain[:, 0] = inputs.axial[:, :, None]
    bend[:, 2] = inputs.curvature[:, :, None]
    give = inputs.joint
    pairs = zip(arm.joints, arm.links, strict=True)
    frames = [np.repeat(material_frame(joint, link)[:, :, None], m, axis=2) for joint, link in pairs]
    for _ in range(rounds):
        pose = _pose(arm, inputs, frames, strain, bend, give)
        torque, _, strain, bend = _loads(arm, inputs, pose)
        give = inputs.joint + inputs.compliance * torque
    pose = _pose(arm, inputs, frames, strain, bend, give)
    torque, carried, _, _ = _loads(arm, inputs, pose)
    turns = np.stack([turned(root, shape.end_psi) for root, shape in zip(pose.roots, pose.shapes, strict=True)])
    return Solution(pose.tip, pose.rotation, pose.joint_at, pose.end_at, pose.axis, torque, carried, turns)


@dataclass(frozen=True)
class _Pose:
    tip: Array
    rotation: Array
    joint_at: Array
    end_at: Array
    axis: Array
    roots: list[Array]
    shapes: list[RodShape]


def _pose(arm: Arm, inputs: Inputs, frames: list[Array], strain: Array, bend: Array, give: Array) -> _Pose:
    m = inputs.q.shape[1]
    rotation = np.repeat(np.eye(3)[:, :, None], m, axis=2)
    at = np.zeros((3, m))
    joint_at: list[Array] = []
    end_at: list[Array] = []
    axes: list[Array] = []
    roots: list[Array] = []
    shapes: list[RodShape] = []
    for i, (joint, link) in enumerate(zip(arm.joints, arm.links, strict=True)):
        own = np.array(joint.axis, dtype=float)
        own /= np.linalg.norm(own)
        axis = turned(rotation, np.repeat(own[:, None], m, axis=1))
        at = at + inputs.shift[i]
        moved = inputs.q[i] + give[i]
        joint_at.append(at)
        if joint.prismatic:
            at = at + axis * moved
        else:
            rotation = product(rotation, rotation_of(own[:, None] * moved))
        root = product(rotation, frames[i])
        shape = rod_shape(np.full(m, link.length), strain[i], bend[i])
        end = product(root, rotation_of(shape.end_psi))
        at = at + turned(root, shape.end_position)
        rotation = product(end, np.swapaxes(frames[i], 0, 1))
        end_at.append(at)
        axes.append(axis)
        roots.append(root)
        shapes.append(shape)
    tip = at + turned(rotation, inputs.tool)
    return _Pose(tip, rotation, np.stack(joint_at), np.stack(end_at), np.stack(axes), roots, shapes)


def _loads(arm: Arm, inputs: Inputs, pose: _Pose) -> tuple[Array, Array, Array, Array]:
    n, m = inputs.q.shape
    force = inputs.payload * inputs.gravity + inputs.force
    moment = cross(pose.tip - pose.end_at[-1], force)
    torque, carried = np.zeros((n, m)), np.zeros((n, 3, m))
    strain, bend = np.zeros((n, 3, m, NODES)), np.zeros((n, 3, m, NODES))
    for i in reversed(range(n)):
        root, shape = pose.roots[i], pose.shapes[i]
        weight = turned_back(root, inputs.line_mass[i] * inputs.gravity)
        node_force, node_moment, root_force, root_moment = internal_loads(
            np.full(m, arm.links[i].length), shape, turned_back(root, force), turned_back(root, moment), weight
        )
        soft = inputs.flexibility[i][:, :, None]
        strain[i], bend[i] = soft[:3] * node_force, soft[3:] * node_moment
        strain[i, 0] += inputs.axial[i][:, None]
        bend[i, 2] += inputs.curvature[i][:, None]
        force, moment = turned(root, root_force), turned(root, root_moment)
        torque[i] = dot(pose.axis[i], force if arm.joints[i].prismatic else moment)
        carried[i] = force
        if arm.joints[i].prismatic:
            start = pose.shapes[i]
            base_of_link = pose.end_at[i] - turned(root, start.end_position)
            moment = moment + cross(base_of_link - pose.joint_at[i], force)
        force = force + arm.joints[i].mass * inputs.gravity
    return torque, carried, strain, bend


def with_changes(inputs: Inputs, **changes: Array) -> Inputs:
    """The same rows with some inputs replaced."""
    return replace(inputs, **changes)
